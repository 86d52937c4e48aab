//! Calibration: converts changes of the markers' images to displacements.

mod lateral;
mod line;
mod normal;

use palpate_statistics::Number;
use strum::IntoStaticStr;
use thiserror::Error;

use crate::Change;

pub use lateral::{LateralCalibration, LateralPoint};
pub use line::Line;
pub use normal::{MarkerGain, NormalCalibration, NormalFrom, NormalPoint};

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
    /// The calibration for normal displacements; `None` if there is none.
    pub normal_part: Option<NormalCalibration>,
    /// The calibration for tangential displacements; `None` if there is none.
    pub lateral_part: Option<LateralCalibration>,
    /// Number of markers that the sensor shows at rest; `None` if the number is not known.
    pub markers: Option<usize>,
    /// Mean hue of the markers at rest, turns; `None` if the mean is not known.
    pub hue_turns: Option<f64>,
}

/// Known displacements of a marker in a press, and the change of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationPoint {
    /// Index of the marker.
    pub marker: usize,
    /// Displacement of the marker into the skin (length).
    pub normal: f64,
    /// Displacement of the marker along the skin (length).
    pub tangential: [f64; 2],
    /// Change of the marker's image from rest to the press.
    pub change: Change,
}

impl Calibration {
    /// Creates a calibration for normal displacements, for tangential displacements, or for both kinds. `markers` is
    /// the number of markers that the sensor shows at rest; `None` if the number is not known.
    ///
    /// # Errors
    /// [`CalibrationError::TooFewPoints`] if both `normal` and `lateral` are `None`; [`CalibrationError::OutOfRange`]
    /// for a number that is not finite, or for a slope of 0.
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
            normal_part: normal.map(NormalCalibration::checked).transpose()?,
            lateral_part: lateral.map(LateralCalibration::checked).transpose()?,
            markers,
            hue_turns: None,
        })
    }

    /// Checks that `found`, the number of markers in a frame at rest, fits this calibration. The number may differ by
    /// 10 % from the number in the calibration, because some markers may be hidden. If the calibration uses a separate
    /// slope for each marker, both numbers must be equal, because the slopes are stored by marker index.
    ///
    /// # Errors
    /// [`CalibrationError::AnotherLayout`] if the number of markers does not fit.
    pub fn fits(&self, found: usize) -> Result<(), CalibrationError> {
        let Some(calibrated) = self.markers else {
            return Ok(());
        };
        let by_number = self
            .normal_part
            .as_ref()
            .is_some_and(|normal| normal.uses_gains);
        let allowed = if by_number { 0 } else { calibrated / 10 };
        if calibrated.abs_diff(found) > allowed {
            return Err(CalibrationError::AnotherLayout { calibrated, found });
        }
        Ok(())
    }

    /// The inward displacement (length) of a marker, computed from the change of its image. The result is `None` if
    /// there is no calibration for normal displacements, or if a number of the change is not finite.
    pub fn normal(&self, marker: usize, change: &Change) -> Option<f64> {
        self.normal_part.as_ref()?.read(marker, change)
    }

    /// The displacement of a marker along the skin (length). `normal` is the marker's inward displacement. `shift_px`
    /// is the shift (px) of the marker's image along the axes at the marker's place. This shift is the angle by which
    /// the image moves, multiplied by the focal length (px per radian). The result is `None` if there is no calibration
    /// for tangential displacements, or if a number is not finite.
    pub fn tangential(&self, shift_px: [f64; 2], normal: f64) -> Option<[f64; 2]> {
        self.lateral_part.as_ref()?.read(shift_px, normal)
    }

    /// Fits a calibration to the markers of several presses. All markers are used for tangential displacements. For
    /// normal displacements, only the marker with the index `only` is used; all markers if `only` is `None`. Normal
    /// displacements are computed from the feature `from` of the images. Also returns the root mean square errors of
    /// normal and of tangential displacements near the contacts; `None` for an error that is 0 or cannot be computed.
    ///
    /// # Errors
    /// [`CalibrationError`] if the points do not determine a slope, or if a number is not finite.
    pub fn of_presses(
        presses: &[Vec<CalibrationPoint>],
        only: Option<usize>,
        from: NormalFrom,
    ) -> Result<(Self, [Option<f64>; 2]), CalibrationError> {
        let all = || presses.iter().flatten();
        let normal = all().filter(|point| only.is_none_or(|only| only == point.marker));
        let normal = normal.map(|point| NormalPoint {
            marker: Some(point.marker),
            normal: point.normal,
            hue_turns: point.change.hue_turns,
            growth: point.change.growth,
        });
        let lateral = all().map(|point| LateralPoint {
            tangential: point.tangential,
            shift_px: point.change.shift_px,
            normal: Some(point.normal),
        });
        let normal = NormalCalibration::fit(&normal.collect::<Vec<_>>(), from)?;
        let lateral = LateralCalibration::fit(&lateral.collect::<Vec<_>>())?;
        let calibration = Self::new(Some(normal), Some(lateral), None)?;
        let stds = calibration.residual_stds(presses);
        Ok((calibration, stds))
    }

    /// Root mean square errors of normal and of tangential displacements in the presses; `None` if an error is 0 or
    /// cannot be computed. Only markers whose displacement is at least half of the largest displacement of their press
    /// are used. These markers are near the contact. There, the motions of a marker's two discs differ most, and the
    /// readings depend most on the object's shape.
    fn residual_stds(&self, presses: &[Vec<CalibrationPoint>]) -> [Option<f64>; 2] {
        let inward = |point: &CalibrationPoint| point.normal.abs();
        let along =
            |point: &CalibrationPoint| libm::hypot(point.tangential[0], point.tangential[1]);
        let mut errors = [Vec::new(), Vec::new()];
        for points in presses {
            let half_of_largest = |sizes: Vec<f64>| 0.5 * sizes.into_iter().fold(0.0, f64::max);
            let normal_limit = half_of_largest(points.iter().map(inward).collect());
            let tangential_limit = half_of_largest(points.iter().map(along).collect());
            for point in points {
                let Some(normal) = self.normal(point.marker, &point.change) else {
                    continue;
                };
                if inward(point) >= normal_limit {
                    errors[0].push(normal - point.normal);
                }
                if along(point) >= tangential_limit
                    && let Some([x, y]) = self.tangential(point.change.shift_px, normal)
                {
                    errors[1].extend([x - point.tangential[0], y - point.tangential[1]]);
                }
            }
        }
        errors.map(|errors| {
            let squares = errors.iter().map(|error: &f64| error * error);
            let mean = squares.sum::<f64>() / errors.len() as f64;
            Some(mean.sqrt()).filter(|std| *std > 0.0)
        })
    }
}

/// Reason why a calibration cannot be computed, or does not apply to a sensor.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum CalibrationError {
    /// There are fewer calibration points than a fit of a line needs, or the calibration is for neither normal nor
    /// tangential displacements.
    #[error("{count} {what}; a calibration needs at least {needed}")]
    TooFewPoints {
        /// Text that states what was counted: calibration points, or parts (normal and tangential) of the calibration.
        what: &'static str,
        /// Number of points or parts that were counted.
        count: usize,
        /// Smallest number of points or parts that a calibration needs.
        needed: usize,
    },
    /// All calibration points have the same displacement.
    #[error(
        "all {count} points have a {what} displacement of {displacement}; a slope needs at least two",
        displacement = Number(*displacement)
    )]
    OneDisplacement {
        /// Kind of displacement: normal or tangential.
        what: &'static str,
        /// Displacement that all calibration points have (length).
        displacement: f64,
        /// Number of calibration points.
        count: usize,
    },
    /// A number of a calibration point is not finite or too large.
    #[error("point {point} (counting from 0): a number is not finite, or beyond 1e100")]
    NotFinite {
        /// Index of the point that contains the number, counted from 0.
        point: usize,
    },
    /// The signal of the markers, such as the hue, does not change with the displacement.
    #[error("{what} does not change with the displacement: there is no slope to calibrate")]
    NoSlope {
        /// Name of the signal from which displacements are computed, such as hue or size.
        what: &'static str,
    },
    /// A number of a calibration or of a camera is out of its range.
    #[error("{what} is {value}; it must be {needed}", value = Number(*value))]
    OutOfRange {
        /// Name of the setting or reading that is out of its range.
        what: &'static str,
        /// The number that is out of its range.
        value: f64,
        /// Allowed values, as text.
        needed: &'static str,
    },
    /// The calibration was made with a sensor that has another number of markers.
    #[error(
        "the calibration is for a sensor with {calibrated} markers, but the frame at rest shows \
         {found}"
    )]
    AnotherLayout {
        /// Number of markers of the calibrated sensor.
        calibrated: usize,
        /// Number of markers found in the frame.
        found: usize,
    },
}

impl CalibrationError {
    pub(crate) const fn out_of_range(what: &'static str, value: f64, needed: &'static str) -> Self {
        Self::OutOfRange {
            what,
            value,
            needed,
        }
    }
}
