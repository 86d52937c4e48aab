//! Random rolls, and how many of the objects' normal curvatures are within the intervals that the least squares state; and
//! whether readings that contradict the model are doubted.

mod case;
mod flaw;
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
        let is_asked = |word| name.contains(word);
        if !options.only.split_whitespace().all(is_asked) {
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

/// Names of the families whose readings are those of a sensor as a study tells it, of whatever rolls.
pub(super) fn sound_families() -> Vec<String> {
    sound().map(|family| family.name()).collect()
}

fn sound() -> impl Iterator<Item = Family> {
    Family::all().into_iter().filter(Family::is_sound)
}

/// Rolls at the ends of what the sound families draw, as configs with the family's name; with lengths, angles and noise that
/// are so many times as large, or as small.
#[cfg(test)]
pub(super) fn texts(times: f64) -> Vec<(String, String)> {
    let ends = |family: Family| [0, 1].map(|end| (family.name(), family.text(end, times)));
    sound().flat_map(ends).collect()
}
