//! Every public entry point at its extremes: a value within its stated bound, or a named error.

mod answer;
mod case;
mod scene;
mod table;

use std::path::Path;

use anyhow::{Result, bail};

pub use answer::{Answer, Outcome, Truth};
pub use case::{Case, Judged, Verdict};
pub use palpate_verdict::Precise;

/// All cases, in the order of their crates.
pub fn cases() -> Vec<Case> {
    let crates = [scene::cases()];
    crates.into_iter().flatten().collect()
}

/// Runs all cases, writes their table and says how many there are of each verdict.
///
/// # Errors
/// If a case breaks a promise, after the table is written; if the table cannot be written.
pub fn run(out: &Path) -> Result<String> {
    let rows: Vec<Judged> = cases().into_iter().map(Case::judge).collect();
    table::write(&rows, out)?;
    let summary = table::summary(&rows);
    if rows.iter().any(|row| row.verdict.is_broken()) {
        bail!("a promise is broken ({summary}): see {}", out.display());
    }
    Ok(summary)
}
