//! Settings of a fit.

use super::reading::{Measured, Reading};
use crate::{Body, PressError};

/// Knowledge of a nuisance parameter of the readings: of the baseline or the gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prior {
    /// It has its ideal value: 0 for a baseline, 1 for a gain.
    Exact,
    /// It has its ideal value within this standard deviation (> 0, in its own unit), and is fitted.
    Within(f64),
    /// It is unknown, and fitted.
    Free,
}

/// The least-squares fit of one press: over relative curvature, place of the contact, indentation, and the baseline and
/// gain where they are not exact.
///
/// ```
/// use palpate_press::{Body, ForwardFit, Markers, Reading, Skin};
///
/// // 81 markers, 2 apart and 2 under a skin of radius 20, that an object of radius 80 moves.
/// let positions: Vec<[f64; 2]> =
///     (0..81).map(|i| [2.0 * f64::from(i % 9 - 4), 2.0 * f64::from(i / 9 - 4)]).collect();
/// let (skin, body) = (Skin::new(20.0)?, Body::half_space(0.5, 2.0)?);
/// let markers = Markers::new(skin, &positions)?;
/// let moved = markers.displacements(&skin.contact(&body, 1.0 / 80.0, 1.0)?, [0.0; 2]);
/// let normal: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
/// let reading = Reading { markers: &markers, normal: &normal, tangential: None, indentation: None };
/// let estimate = ForwardFit::new(body).estimate(&reading)?;
/// assert!((estimate.most_likely_object_curvature() - 1.0 / 80.0).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ForwardFit {
    /// The forward law.
    pub body: Body,
    /// Offset common to all normal displacements, length; ideally 0.
    pub baseline: Prior,
    /// Factor on all normal displacements; ideally 1.
    pub gain: Prior,
    /// Standard deviation of normal displacements, length; found from the residuals if `None` or 0. Less than 1e-10 of the
    /// largest normal displacement counts as that.
    pub normal_std: Option<f64>,
    /// Standard deviation of either tangential component, length; found from the residuals if `None` or 0. Less than 1e-10 of
    /// the largest normal displacement counts as that.
    pub tangential_std: Option<f64>,
    /// Largest distance from the contact at which a marker counts, length; `None` for all markers.
    pub window: Option<f64>,
}

impl ForwardFit {
    /// A fit of a body, with nothing off and the noise to be found.
    pub const fn new(body: Body) -> Self {
        Self {
            body,
            baseline: Prior::Exact,
            gain: Prior::Exact,
            normal_std: None,
            tangential_std: None,
            window: None,
        }
    }

    /// Refuses settings and readings that are out of range.
    pub(super) fn validate(&self, reading: &Reading<'_>) -> Result<(), PressError> {
        let at_least_0 = |setting, value: f64| {
            let good = (0.0..=1e100).contains(&value);
            PressError::unless_good(setting, value, good, "at least 0 and at most 1e100")
                .map(|_| ())
        };
        for (setting, std) in [
            ("normal_std", self.normal_std),
            ("tangential_std", self.tangential_std),
            (
                "indentation_std",
                reading.indentation.map(|known| known.std),
            ),
        ] {
            std.map_or(Ok(()), |std| at_least_0(setting, std))?;
        }
        for (setting, prior) in [("baseline_std", self.baseline), ("gain_std", self.gain)] {
            if let Prior::Within(std) = prior {
                let good = std > 0.0 && std <= 1e100;
                PressError::unless_good(setting, std, good, "> 0 and at most 1e100")?;
            }
        }
        if let Some(window) = self.window {
            let good = window > 0.0;
            PressError::unless_good("window", window, good, "> 0")?;
        }
        if let Some(Measured { value, .. }) = reading.indentation {
            if !value.is_finite() {
                return Err(PressError::OutOfRange);
            }
            if value <= 0.0 {
                return Err(PressError::NoIndentation { indentation: value });
            }
        }
        let markers = reading.markers.places().len();
        let lengths = [
            Some(reading.normal.len()),
            reading.tangential.map(<[_]>::len),
        ];
        for given in lengths.into_iter().flatten() {
            let good = given == markers;
            PressError::unless_good("readings", given as f64, good, "one for each marker")?;
        }
        let sound = |value: f64| value.abs() <= 1e50;
        let is_bad = |marker: &usize| {
            let tangential = reading.tangential.map_or([0.0; 2], |given| given[*marker]);
            !(sound(reading.normal[*marker]) && tangential.into_iter().all(sound))
        };
        match (0..markers).find(is_bad) {
            Some(marker) => Err(PressError::NotFinite { marker }),
            None => Ok(()),
        }
    }
}
