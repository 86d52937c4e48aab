//! Designs against references.

use std::time::Instant;

use anyhow::{Context, Result};
use palpate::{Answer, Question, RunOptions, Runner, Side, design, parse};

use super::scenes::Design;
use super::score::Score;

pub(super) const COMMAND: &str = "design";
/// Part of the gap that a reference has: its trials at a crossing are 100 times as many.
const FINER: f64 = 0.1;
/// Seed of references.
const REFERENCE: u64 = 1_000_003;

/// Asks a scene with so many seeds.
pub(super) fn score(scene: &Design, seeds: u64) -> Result<Score> {
    let runner = Runner::new(&RunOptions::default())?;
    let ask = |seed: u64, finer: f64| -> Result<Answer> {
        let mut study = parse(scene.name, scene.config)?;
        study.override_seed(seed)?;
        let mut question = Question::new(scene.target.parse()?, scene.vary.parse()?);
        question.gap = scene.gap * finer;
        question.most_trials = 1 << 32;
        let start = Instant::now();
        let answer = design(&study, &question, &runner, &|| start.elapsed(), &|_, _| ());
        answer.with_context(|| scene.name)
    };
    let reference = ask(REFERENCE, FINER)?;
    let mut right = 0;
    for seed in 0..seeds {
        right += u64::from(is_right(&ask(seed, 1.0)?, &reference));
    }
    Ok(Score {
        command: COMMAND,
        scene: scene.name,
        cases: seeds,
        right,
    })
}

/// Whether an answer tells both sides, and no end of a side lies on the other one by the reference.
fn is_right(answer: &Answer, reference: &Answer) -> bool {
    let told = [Side::Meets, Side::Misses].map(|side| answer.on(side).next().is_some());
    let is_wrong = |value: f64, side: Side| {
        let mut runs = reference.runs.iter();
        runs.any(|run| run.side != side && (run.from..=run.to).contains(&value))
    };
    let mut ends = answer
        .runs
        .iter()
        .flat_map(|run| [(run.from, run.side), (run.to, run.side)]);
    told == [true; 2] && !ends.any(|(value, side)| is_wrong(value, side))
}
