//! Probabilities of telling objects apart against pairs of fresh trials.

use anyhow::{Context, Result};
use palpate::{Order, RunOptions, Runner, SceneTrial, Scenes, distinguish, parse};

use super::scenes::Objects;
use super::score::{Options, Score};

pub(super) const COMMAND: &str = "distinguish";
/// Number of the first fresh trial; each object has its own.
const FRESH: u64 = 1 << 50;
const APART: u64 = 1 << 40;

/// Holds the probability of each pair of a scene's objects, by each seed, against so many pairs of single trials.
pub(super) fn score(scene: &Objects, options: Options<'_>) -> Result<Score> {
    let runner = Runner::new(&RunOptions::default())?;
    let (config, radii) = (scene.config, scene.radii);
    let sweep = format!("[[sweep]]\npath = \"scene.object.radius\"\nvalues = {radii:?}\n");
    let mut study = parse(scene.name, &format!("{config}{sweep}"))?;
    study.override_trials(scene.trials)?;
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
                score.right += u64::from(is_right(order, share, low.len()));
            }
        }
    }
    Ok(score)
}

/// Whether a probability and the share of so many pairs agree within the interval of the one and the error of the other:
/// the share errs as well, and alike for every seed, so that an interval that held it as often as it should hold the truth
/// would be too wide.
fn is_right(order: Order, share: f64, pairs: usize) -> bool {
    const WITHIN_95: f64 = 1.96;
    let side = match share < order.probability {
        true => order.probability - order.low,
        false => order.high - order.probability,
    };
    let of_share = WITHIN_95 * WITHIN_95 * share * (1.0 - share) / pairs.max(1) as f64;
    let apart = share - order.probability;
    apart * apart <= side * side + of_share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_may_err_by_its_own_error_as_well() {
        let order = Order {
            probability: 0.5,
            low: 0.4,
            high: 0.52,
        };
        let far = 1 << 40;
        for (share, pairs, right) in [
            (0.401, far, true),
            (0.399, far, false),
            (0.519, far, true),
            (0.521, far, false),
            // A standard error of 0.005 on 0.02: 0.0223 together.
            (0.522, 10_000, true),
            (0.5225, 10_000, false),
        ] {
            assert_eq!(is_right(order, share, pairs), right, "{share}");
        }
    }
}
