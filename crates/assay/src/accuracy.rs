//! Errors of palpate on fixed scenes and seeds: of every rung against closed forms, of the estimators against the truth
//! of the scenes, and of the tracker against the true places of the discs in its frames.
//!
//! `cargo xtask bench-check` compares them with `baseline/accuracy.csv`, so that no change makes an answer worse
//! unseen.

mod curvatures;
mod presses;
pub(crate) mod rolls;
mod sights;

use anyhow::{Result, ensure};

/// An error of palpate: relative, or in the unit that its name ends with.
pub struct Figure {
    /// Name of the estimate and of the scene.
    pub name: String,
    /// Finite and at least 0.
    pub error: f64,
}

impl Figure {
    fn new(name: impl Into<String>, error: f64) -> Self {
        Self {
            name: name.into(),
            error,
        }
    }
}

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

/// Root of the mean square.
pub(crate) fn rms(errors: impl IntoIterator<Item = f64>) -> f64 {
    let square = |(sum, count): (f64, u32), error: f64| (sum + error * error, count + 1);
    let (sum, count) = errors.into_iter().fold((0.0, 0), square);
    (sum / f64::from(count)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn root_of_the_mean_square() {
        assert_eq!(rms([3.0, -4.0, 0.0, 0.0]), 2.5);
    }
}
