//! Errors of palpate on fixed scenes and seeds: of every rung against closed forms, of the estimators against the truth
//! of the scenes, and of the tracker against the true places of the discs in its frames.
//!
//! `cargo xtask bench-check` compares them with `baseline/accuracy.csv`, so that no change makes an answer worse
//! unseen.

mod curvatures;
mod figure;
mod presses;
pub(crate) mod rolls;
mod sights;

use anyhow::{Result, ensure};

pub use figure::Figure;
pub(crate) use figure::rms;

/// All figures, in the order of the chain from contact to answer.
///
/// # Errors
/// If a scene cannot be run, or an error is not finite.
pub fn figures() -> Result<Vec<Figure>> {
    let mut figures = rolls::figures()?;
    figures.extend(curvatures::figures()?);
    figures.extend(presses::figures()?);
    figures.extend(sights::figures()?);
    for Figure { name, error } in &figures {
        ensure!(error.is_finite() && *error >= 0.0, "{name}: error {error}");
    }
    Ok(figures)
}

/// The figures as CSV: `name`, `error`.
///
/// # Errors
/// As [`figures`].
pub fn table() -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["name", "error"])?;
    for Figure { name, error } in figures()? {
        writer.write_record([name, format!("{error:e}")])?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
