//! Whether stated intervals hold on scenes that nobody chose: of random surfaces, the share of curvatures within what
//! EP2 states.

mod case;
mod score;
mod surface;

pub use case::{Case, cases};
pub use score::Score;

use anyhow::Result;
use surface::Surface;

/// How much is asked.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Seed of the surfaces, the fingers' places and the noise.
    pub seed: u64,
    /// Number of surfaces of each case; every fifth is a ball.
    pub surfaces: u64,
    /// Number of trials on each surface.
    pub trials: u64,
    /// Only cases whose names hold each of these words.
    pub only: &'a str,
}

/// The scores of all cases; `say` is told each as it is known.
///
/// # Errors
/// A case that cannot be asked.
pub fn scores(options: Options<'_>, say: impl Fn(&Score)) -> Result<Vec<Score>> {
    let mut scores = Vec::new();
    let is_asked = |case: &Case| {
        let name = case.name();
        options.only.split_whitespace().all(|word| name.contains(word))
    };
    for case in cases().filter(is_asked) {
        let surfaces: Vec<Surface> = (0..options.surfaces)
            .map(|index| Surface::random(options.seed, index))
            .collect();
        for score in score::scores(&case, &surfaces, options)? {
            say(&score);
            scores.push(score);
        }
    }
    Ok(scores)
}

/// Table of the scores.
///
/// # Errors
/// It cannot be written.
pub fn table(scores: &[Score]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for score in scores {
        writer.serialize(score)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
