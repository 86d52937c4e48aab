//! Whether `auto` keeps its word: the rung that it takes errs by at most the tolerance, and costs at most twice the
//! instructions of the cheapest rung that does.
//!
//! | kind | what is counted | error | against | rivals |
//! |---|---|---|---|---|
//! | roll | the rolls of one trial without noise | contacts at the end, relative to the contact's length scale | Montana's equations in the charts of both bodies | every chart-free setting of every rung |
//! | glide | the touches of all fingers | contacts, relative to the tip's radius | the offset surface written out; a closed form against Newton's method, and the other way round | closed form, Newton's method in steps of ten |
//! | press | the press, and how the markers move | displacements, relative to the largest | quadrature over wavenumbers, which no rung uses | Hertz, half-space, layer |
//!
//! Setting up a scene is not counted, nor is a roll's rival that evaluates the contact equations more than three times
//! as often as the rung that is taken: what a method does around an evaluation makes it 2.1 times as dear at most.

mod cost;
mod promised;
mod rivals;
mod scenes;
mod verdict;

use std::path::Path;

use anyhow::{Result, bail};

use crate::measured::{self, Evaluation};
pub use promised::{Promise, SCENES};
pub use rivals::Rival;
pub use scenes::{Kind, text};
use verdict::Verdict;

/// All scenes, kind by kind.
///
/// # Errors
/// As [`Promise::of`].
pub fn promises() -> Result<Vec<Promise>> {
    let numbered = |kind| (0..SCENES).map(move |number| Promise::of(kind, number));
    Kind::ALL.into_iter().flat_map(numbered).collect()
}

/// Judges all scenes and writes `promise.csv`; `counted` as in [`measured::instructions`]. Says how many kept their
/// word.
///
/// # Errors
/// If a scene breaks the promise, after the table is written; if counting fails, or the table cannot be written.
pub fn run(out: &Path, counted: bool) -> Result<String> {
    let promises = promises()?;
    let evaluations: Vec<Vec<Evaluation>> = promises
        .iter()
        .map(Promise::evaluations)
        .collect::<Result<_>>()?;
    if counted {
        measured::count(evaluations.into_iter().flatten());
        return Ok(String::new());
    }
    let scales: Vec<u32> = evaluations
        .iter()
        .flatten()
        .map(Evaluation::scale)
        .collect();
    let Some(counts) = measured::instructions(&scales)? else {
        bail!("{}", measured::NO_VALGRIND);
    };
    let mut counts = counts.into_iter();
    let verdicts: Vec<Verdict> = promises
        .iter()
        .map(|promise| Verdict::of(promise, counts.by_ref()))
        .collect();
    verdict::write(&verdicts, out)?;
    verdict::words(&verdicts).map_err(|words| anyhow::anyhow!("{words}: see {}", out.display()))
}
