//! Random glides over the surfaces of EP2, and whether contacts that contradict the model are doubted, where the intervals of
//! curvatures hold and where they do not.

mod best_test;
mod family;
mod flaw;
mod score;

pub use score::Score;

use anyhow::Result;

use super::options::Options;
use family::Family;

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
            of_scenes.push(score::tally(&family, number, options)?);
        }
        let score = Score::of(&family, &of_scenes);
        say(&score);
        scores.push(score);
    }
    Ok(scores)
}
