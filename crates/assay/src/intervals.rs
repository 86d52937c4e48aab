//! Random surfaces, and how many of their curvatures are within the intervals that EP2 states: whether intervals hold
//! on scenes that nobody chose.

pub mod camera;
mod case;
mod doubted;
mod draws;
pub mod glide;
mod options;
pub mod press;
pub mod roll;
mod score;
mod sums;
mod surface;
mod tested;

pub use options::Options;
pub use score::Score;
pub use tested::{Tested, tested};

use anyhow::Result;
use case::{Case, cases};
use serde::Serialize;
use surface::Surface;

/// The scores of all cases; `say` is told each as it is known.
///
/// # Errors
/// A case that cannot be asked.
pub fn scores(options: Options<'_>, say: impl Fn(&Score)) -> Result<Vec<Score>> {
    let mut scores = Vec::new();
    let is_asked = |case: &Case| {
        let name = case.name();
        options
            .only
            .split_whitespace()
            .all(|word| name.contains(word))
    };
    for case in cases().filter(is_asked) {
        let surfaces: Vec<Surface> = (0..options.scenes)
            .map(|index| Surface::random(options.seed, index))
            .collect();
        for score in score::scores(&case, &surfaces, options)? {
            say(&score);
            scores.push(score);
        }
    }
    Ok(scores)
}

/// Number of figures within their limits, in words.
pub fn summary(scores: &[Score]) -> String {
    let judged = scores.iter().filter_map(|score| score.is_within_limits);
    let (all, within) = judged.fold((0, 0), |(all, within), is_within| {
        (all + 1, within + u64::from(is_within))
    });
    format!("{within} of {all} cases within the limits")
}

/// CSV table of the scores. A value that cannot be computed is an empty field.
///
/// # Errors
/// The table cannot be written.
pub fn table<S: Serialize>(scores: &[S]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for score in scores {
        writer.serialize(score)?;
    }
    // A NaN becomes an empty field. No name starts with `NaN`.
    Ok(String::from_utf8(writer.into_inner()?)?.replace(",NaN", ","))
}
