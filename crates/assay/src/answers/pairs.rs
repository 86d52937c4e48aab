//! Probabilities of telling objects apart against pairs of fresh trials.

use anyhow::{Context, Result};
use palpate::{RunOptions, Runner, SceneTrial, Scenes, distinguish, parse};

use super::scenes::Objects;
use super::score::{Options, Score};

pub(super) const COMMAND: &str = "distinguish";
/// Number of the first fresh trial; each object has its own.
const FRESH: u64 = 1 << 50;
const APART: u64 = 1 << 40;

/// Holds the probability of each pair of a scene's objects, by each seed, against so many pairs of single trials.
pub(super) fn score(scene: &Objects, options: Options<'_>) -> Result<Score> {
    let runner = Runner::new(&RunOptions::default())?;
    let mut study = parse(scene.name, scene.config)?;
    let mut fresh = Vec::new();
    for cell in 0..study.cell_count() {
        let trial = SceneTrial::new(study.estimable_scene(cell)?);
        let mut names = trial.scene.quantities().iter();
        let place = names.position(|one| one.name == scene.quantity);
        let place = place.with_context(|| format!("{} has no {}", scene.name, scene.quantity))?;
        let first = FRESH + cell as u64 * APART;
        fresh.push(runner.told(&trial, place, first..first + options.pairs));
    }
    let mut score = Score {
        command: COMMAND,
        scene: scene.name,
        cases: 0,
        right: 0,
    };
    for seed in 0..options.seeds {
        study.override_seed(seed)?;
        let told = distinguish(&study, Some(scene.quantity), 0.95, &runner, &|_, _| ())?;
        for group in &told.groups {
            for pair in &group.pairs {
                let order = pair
                    .order
                    .with_context(|| format!("{} has twins", scene.name))?;
                let [low, high] =
                    [pair.first, pair.second].map(|one| &fresh[group.objects[one].cell]);
                let in_order = low.iter().zip(high).filter(|(low, high)| {
                matches!((low, high), (Some((low, _)), Some((high, _))) if low < high)
            });
                let share = in_order.count() as f64 / low.len().max(1) as f64;
                score.cases += 1;
                score.right += u64::from((order.low..=order.high).contains(&share));
            }
        }
    }
    Ok(score)
}
