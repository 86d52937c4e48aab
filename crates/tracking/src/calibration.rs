//! Calibration: converts changes of the markers' images to displacements.

mod error;
mod lateral;
mod line;
mod normal;

pub use error::CalibrationError;
pub use lateral::{LateralCalibration, LateralPoint};
pub use line::Line;
pub use normal::{MarkerGain, NormalCalibration, NormalFrom, NormalPoint};

use crate::Change;

/// Converts changes of the markers' images to displacements of the markers.
///
/// ```
/// use palpate_tracking::{Calibration, Change, NormalCalibration, NormalFrom, NormalPoint};
///
/// // The hue turns back by 0.05 per unit of normal displacement.
/// let points = [0.0, 0.5, 1.0].map(|normal| NormalPoint {
///     marker: None,
///     normal,
///     hue_turns: -0.05 * normal,
///     growth: 0.0,
/// });
/// let normal = NormalCalibration::fit(&points, NormalFrom::Hue)?;
/// let calibration = Calibration::new(Some(normal), None, None)?;
/// let change = Change { hue_turns: -0.02, ..Change::default() };
/// let read = calibration.normal(0, &change).ok_or("not calibrated")?;
/// assert!((read - 0.4).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    normal: Option<NormalCalibration>,
    lateral: Option<LateralCalibration>,
    markers: Option<usize>,
    /// Mean hue of the markers at rest, turns; `None` if the mean is not known.
    pub hue_turns: Option<f64>,
}

impl Calibration {
    /// A calibration for normal displacements, for tangential displacements, or for both. `markers` is the number of
    /// markers that the sensor shows at rest; `None` if the number is not known.
    ///
    /// # Errors
    /// [`CalibrationError::TooFewPoints`] if both parts are missing; [`CalibrationError::OutOfRange`] for a number that
    /// is not finite, or for a slope of 0.
    pub fn new(
        normal: Option<NormalCalibration>,
        lateral: Option<LateralCalibration>,
        markers: Option<usize>,
    ) -> Result<Self, CalibrationError> {
        if normal.is_none() && lateral.is_none() {
            return Err(CalibrationError::TooFewPoints {
                what: "parts",
                count: 0,
                needed: 1,
            });
        }
        Ok(Self {
            normal: normal.map(NormalCalibration::checked).transpose()?,
            lateral: lateral.map(LateralCalibration::checked).transpose()?,
            markers,
            hue_turns: None,
        })
    }

    /// The calibration for normal displacements, if there is one.
    pub const fn normal_part(&self) -> Option<&NormalCalibration> {
        self.normal.as_ref()
    }

    /// The calibration for tangential displacements, if there is one.
    pub const fn lateral_part(&self) -> Option<&LateralCalibration> {
        self.lateral.as_ref()
    }

    /// Number of markers that the sensor shows at rest; `None` if the number is not known.
    pub const fn markers(&self) -> Option<usize> {
        self.markers
    }

    /// Checks the number of markers that a sensor shows at rest. The number `found` may differ by 10 % from the number
    /// in the calibration, because some markers may be hidden. If the calibration uses a separate slope for each
    /// marker, both numbers must be equal, because the slopes are stored by marker index.
    ///
    /// # Errors
    /// [`CalibrationError::AnotherLayout`] if the number of markers does not fit.
    pub fn fits(&self, found: usize) -> Result<(), CalibrationError> {
        let Some(calibrated) = self.markers else {
            return Ok(());
        };
        let by_number = self.normal.as_ref().is_some_and(|normal| normal.uses_gains);
        let allowed = if by_number { 0 } else { calibrated / 10 };
        if calibrated.abs_diff(found) > allowed {
            return Err(CalibrationError::AnotherLayout { calibrated, found });
        }
        Ok(())
    }

    /// The inward displacement (length) of a marker, computed from the change of its image. The result is `None` if
    /// there is no calibration for normal displacements, or if the change is not finite.
    pub fn normal(&self, marker: usize, change: &Change) -> Option<f64> {
        self.normal.as_ref()?.read(marker, change)
    }

    /// The displacement of a marker along the skin (length). `normal` is the marker's inward displacement. `shift_px`
    /// is the shift (px) of the marker's image along the axes at its place. This shift is the focal length (px per
    /// radian) multiplied by the angle of the shift. The result is `None` if there is no calibration for tangential
    /// displacements, or if a number is not finite.
    pub fn tangential(&self, shift_px: [f64; 2], normal: f64) -> Option<[f64; 2]> {
        self.lateral.as_ref()?.read(shift_px, normal)
    }
}
