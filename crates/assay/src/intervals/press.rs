//! Random presses whose displacements are read directly, and how many of the objects' curvatures are within the intervals
//! that the fit states: seen well and barely, where nothing touches, and where the readings are not what the fit believes.

mod best_test;
mod case;
mod readings;
mod score;

pub use score::Score;

use anyhow::Result;
use rayon::prelude::*;

use super::options::Options;
use case::{Case, Family};

/// Names of the families whose presses are well seen, by readings that are as the fit believes.
pub(super) fn sound_families() -> Vec<String> {
    let families = Family::all().into_iter();
    let is_sound = |family: &Family| family.is_well_seen() && !family.is_wrong();
    families
        .filter(is_sound)
        .map(|family| family.name())
        .collect()
}

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
        let of_scene = |number| {
            let case = Case::random(family, options.seed, number)?;
            score::tally(&case, options.trials)
        };
        let numbers = (0..options.scenes).into_par_iter();
        let score = Score::of(&family, &numbers.map(of_scene).collect::<Result<Vec<_>>>()?);
        say(&score);
        scores.push(score);
    }
    Ok(scores)
}

/// Presses at the ends of what the sound families draw, as configs with the family's name; with lengths, angles and noise
/// that are so many times as large.
#[cfg(test)]
pub(super) fn texts(times: f64) -> Vec<(String, String)> {
    let families = Family::all().into_iter();
    let sound = families.filter(|family| family.is_well_seen() && !family.is_wrong());
    let ends = |family: Family| [0, 1].map(|end| (family.name(), family.text(end, times)));
    sound.flat_map(ends).collect()
}
