//! Coverage of 50, 80 and 95 % intervals on random scenes, and of the warnings of estimates whose model is wrong.
//!
//! Each harness draws scenes of several families, makes noisy readings of them, and counts how often the intervals of the
//! estimates contain the true value. Its table has a row for each family, scene or quantity.

mod best_test;
pub mod camera;
mod camera_case;
mod camera_score;
mod coverage;
mod coverage_table;
mod false_alarms;
pub mod glide;
mod glide_contacts;
mod glide_flaws;
pub mod patch;
pub mod press;
mod press_case;
mod press_readings;
pub mod roll;
mod roll_case;
mod surface;

pub use coverage_table::{CoverageRow, coverage_table};

use anyhow::Result;
use palpate_sensing::{Channel, Stream};
use rayon::prelude::*;

/// Size of a run.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Seed of the scenes and the noise.
    pub seed: u64,
    /// Number of scenes of each case. For EP2 these are surfaces, every fifth of them a ball.
    pub scenes: u64,
    /// Number of trials of each scene.
    pub trials: u64,
    /// Only cases whose names contain each of these words.
    pub only: &'a str,
}

/// Scores the cases whose names contain all words of `options.only`, and passes each score to `report` when it is ready.
fn case_scores<C, S, R: IntoIterator<Item = S>>(
    cases: impl IntoIterator<Item = C>,
    name: impl Fn(&C) -> String,
    options: Options<'_>,
    report: impl Fn(&S) -> Result<()>,
    score: impl Fn(&C) -> Result<R>,
) -> Result<Vec<S>> {
    let mut scores = Vec::new();
    for case in cases {
        let name = name(&case);
        if !options
            .only
            .split_whitespace()
            .all(|word| name.contains(word))
        {
            continue;
        }
        for score in score(&case)? {
            report(&score)?;
            scores.push(score);
        }
    }
    Ok(scores)
}

/// Results of all scenes of a family, computed in parallel, by the number of the scene.
fn scenes<T: Send>(
    options: Options<'_>,
    scene: impl Fn(u64) -> Result<T> + Send + Sync,
) -> Result<Vec<T>> {
    (0..options.scenes).into_par_iter().map(scene).collect()
}

/// Random numbers between limits.
struct Draws(Stream);

impl Draws {
    /// Draws of the scene with this number.
    fn new(seed: u64, index: u64, channel: Channel) -> Self {
        Self(Stream::new(seed, index, channel))
    }

    fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + 0.5 * (high - low) * (1.0 + self.0.symmetric_uniform())
    }

    /// A number whose logarithm is uniform.
    fn log_between(&mut self, limits: [f64; 2]) -> f64 {
        libm::exp(self.between(limits.map(libm::log)))
    }

    /// Unit vector in a random direction.
    fn direction(&mut self) -> [f64; 2] {
        let (sine, cosine) = libm::sincos(self.between([0.0, std::f64::consts::TAU]));
        [cosine, sine]
    }
}
