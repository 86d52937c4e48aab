//! Random presses whose displacements are read directly, and how many of the objects' curvatures are within the intervals
//! that the fit states: seen well and barely, where nothing touches, and where the readings are not what the fit believes.

mod case;
mod readings;
mod score;

pub use score::Score;

use anyhow::Result;

use super::options::Options;
use case::{Case, Family};

/// The scores of all families; `say` is told each as it is known.
///
/// # Errors
/// A case that cannot be asked.
pub fn scores(options: Options<'_>, say: impl Fn(&Score)) -> Result<Vec<Score>> {
    let mut scores = Vec::new();
    for family in Family::all() {
        let name = family.name();
        if !options
            .only
            .split_whitespace()
            .all(|word| name.contains(word))
        {
            continue;
        }
        let mut of_scenes = Vec::new();
        for number in 0..options.scenes {
            let case = Case::random(family, options.seed, number)?;
            of_scenes.push(score::tally(&case, options.trials)?);
        }
        let score = Score::of(&family, &of_scenes);
        say(&score);
        scores.push(score);
    }
    Ok(scores)
}
