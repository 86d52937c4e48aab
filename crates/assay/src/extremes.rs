//! Every public entry point at its extremes: a value within its stated bound, or a named error.

mod case;
pub mod precise;

use std::path::Path;

use anyhow::{Result, bail};

pub use case::{Answer, Case, Judged, Outcome, Truth, Verdict};

/// All cases, in the order of their crates.
pub fn cases() -> Vec<Case> {
    Vec::new()
}

/// Runs all cases and writes their table.
///
/// # Errors
/// If a case breaks a promise, after the table is written; if the table cannot be written.
pub fn run(out: &Path) -> Result<()> {
    let rows: Vec<Judged> = cases().into_iter().map(Case::judge).collect();
    case::write(&rows, out)?;
    let broken = rows.iter().filter(|row| row.verdict.is_broken()).count();
    if broken > 0 {
        bail!(
            "{broken} of {} cases break a promise: see {}",
            rows.len(),
            out.display()
        );
    }
    Ok(())
}
