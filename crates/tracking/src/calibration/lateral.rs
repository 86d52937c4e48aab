//! Calibration of tangential displacements, which are computed from the shift of a marker's centroid in the image.

use serde::{Deserialize, Serialize};

use super::CalibrationError;
use super::line::{Line, Words, finite, fit};
use super::normal::range;

/// A marker with a known tangential displacement, and the shift of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateralPoint {
    /// Displacement of the marker along the skin (length). The components are along the axes at the marker's place.
    pub tangential: [f64; 2],
    /// Shift (px) of the marker's image along the same axes: the angle by which the image moves, multiplied by the
    /// focal length (px per radian).
    pub shift_px: [f64; 2],
    /// Inward displacement of the marker (length); `None` if it was not measured.
    pub normal: Option<f64>,
}

/// Calibration of tangential displacements. The ratio of the centroid's shift to the tangential displacement is p₀ + p₁
/// u, where u is the normal displacement, and p₀ and p₁ are fitted.
///
/// ```
/// use palpate_tracking::{LateralCalibration, LateralPoint};
///
/// // The centroid shifts by 12 px per unit of length at every normal displacement.
/// let points = [0.5, 1.0, 2.0].map(|length| LateralPoint {
///     tangential: [length, 0.0],
///     shift_px: [12.0 * length, 0.0],
///     normal: None,
/// });
/// let lateral = LateralCalibration::fit(&points)?;
/// assert!((lateral.px_per_length - 12.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LateralCalibration {
    /// Coefficient p₀: the ratio of the centroid's shift to the tangential displacement, at a normal displacement of 0,
    /// px per length.
    pub px_per_length: f64,
    /// Standard error of `px_per_length`, px per length; `None` without degrees of freedom.
    pub px_per_length_std: Option<f64>,
    /// Coefficient p₁: the derivative, with respect to the normal displacement, of the ratio of the centroid's shift to
    /// the tangential displacement, px per length squared. `None` if the points have fewer than two different normal
    /// displacements.
    pub per_indentation: Option<f64>,
    /// Standard error of `per_indentation`, px per length squared; `None` without degrees of freedom, or if
    /// `per_indentation` is not fitted.
    pub per_indentation_std: Option<f64>,
    /// Root mean square of the residuals, converted to a length: each residual of the centroid's shift (px) is divided
    /// by the fitted ratio of the shift to the tangential displacement (px per length).
    pub residual_rms: f64,
    /// Standard deviation (corrected for the degrees of freedom) of the residuals, converted to a length as in
    /// `residual_rms`; `None` if there are no degrees of freedom.
    pub residual_std: Option<f64>,
    /// Line through the origin that is fitted to the centroid's shift as a function of the tangential displacement. The
    /// line is fitted to the points of all normal displacements together, so its slope does not depend on the normal
    /// displacement.
    pub line: Line,
    /// Line with an intercept that is fitted to the same points, for comparison with `line`; `None` if the points do
    /// not determine it.
    pub with_intercept: Option<Line>,
    /// Smallest and largest tangential displacement (length) of the calibration points.
    pub range: [f64; 2],
    /// Smallest and largest normal displacement (length) of the calibration points. For a normal displacement outside
    /// of this range, the ratio of the centroid's shift to the tangential displacement is computed at the nearer end of
    /// the range.
    pub normal_range: [f64; 2],
}

const WORDS: Words = Words {
    displacement: "tangential",
    signal: "the centroid",
};

impl LateralCalibration {
    /// Fits the ratio of the centroid's shift to the known tangential displacement. Only the component of the shift in
    /// the direction of the displacement is used.
    ///
    /// # Errors
    /// [`CalibrationError`] for fewer than two points, for equal displacements, for numbers that are not finite, and if
    /// the ratio is 0 or changes its sign in the range of normal displacements.
    pub fn fit(points: &[LateralPoint]) -> Result<Self, CalibrationError> {
        let numbers: Vec<[f64; 5]> = points
            .iter()
            .map(|point| {
                let [tangential, shift] = [point.tangential, point.shift_px];
                let normal = point.normal.unwrap_or(0.0);
                [tangential[0], tangential[1], shift[0], shift[1], normal]
            })
            .collect();
        finite(numbers.iter().map(|numbers| &numbers[..]))?;
        let along: Vec<[f64; 2]> = points.iter().map(along).collect();
        let line = fit(&along, false, WORDS)?;
        let normal: Option<Vec<f64>> = points.iter().map(|point| point.normal).collect();
        let varying = normal
            .as_ref()
            .and_then(|normal| WithIndentation::fit(&along, normal));
        let alone = Self {
            px_per_length: line.slope,
            px_per_length_std: line.slope_std,
            per_indentation: None,
            per_indentation_std: None,
            residual_rms: line.residual_rms,
            residual_std: line.residual_std,
            line,
            with_intercept: fit(&along, true, WORDS).ok(),
            range: range(along.iter().map(|point| point[0])),
            normal_range: normal.map_or([0.0, 0.0], |normal| range(normal.into_iter())),
        };
        let calibration = match varying {
            None => alone,
            Some(varying) => Self {
                px_per_length: varying.coefficients[0],
                px_per_length_std: varying.stds.map(|stds| stds[0]),
                per_indentation: Some(varying.coefficients[1]),
                per_indentation_std: varying.stds.map(|stds| stds[1]),
                residual_rms: varying.residual_rms,
                residual_std: varying.residual_std,
                ..alone
            },
        };
        calibration.checked()
    }

    /// Ratio of the centroid's shift to the tangential displacement, px per length, for a marker with the inward
    /// displacement `normal`.
    fn slope(&self, normal: f64) -> f64 {
        let [low, high] = self.normal_range;
        let normal = normal.max(low).min(high);
        self.px_per_length + self.per_indentation.unwrap_or(0.0) * normal
    }

    pub(super) fn read(&self, shift_px: [f64; 2], normal: f64) -> Option<[f64; 2]> {
        let slope = self.slope(normal);
        let tangential = shift_px.map(|shift| shift / slope);
        tangential
            .iter()
            .all(|one| one.is_finite())
            .then_some(tangential)
    }

    pub(super) fn checked(self) -> Result<Self, CalibrationError> {
        self.line.checked()?;
        if let Some(line) = self.with_intercept {
            line.checked()?;
        }
        let [low, high] = self.normal_range;
        let numbers = [self.residual_rms, low, high, self.range[0], self.range[1]];
        let optional = [
            self.px_per_length_std,
            self.per_indentation_std,
            self.residual_std,
        ];
        let mut all = numbers.into_iter().chain(optional.into_iter().flatten());
        if let Some(value) = all.find(|number| !number.is_finite()) {
            let what = "a number of the lateral calibration";
            return Err(CalibrationError::out_of_range(what, value, "finite"));
        }
        match self.normal_range.map(|end| self.slope(end)) {
            [at_low, at_high] if at_low.is_normal() && at_low * at_high > 0.0 => Ok(self),
            [at_low, at_high] if at_low.is_finite() && at_high.is_finite() => {
                Err(CalibrationError::NoSlope { what: WORDS.signal })
            }
            [at_low, _] => {
                let needed = "finite over all calibrated indentations";
                Err(CalibrationError::out_of_range(
                    "px per length",
                    at_low,
                    needed,
                ))
            }
        }
    }
}

/// The magnitude (length) of a calibration point's tangential displacement, and the component (px) of the image's shift
/// in the direction of this displacement.
fn along(point: &LateralPoint) -> [f64; 2] {
    let [x, y] = point.tangential;
    let length = libm::hypot(x, y);
    let [along_x, along_y] = if length > 0.0 {
        [x / length, y / length]
    } else {
        [1.0, 0.0]
    };
    let [shift_x, shift_y] = point.shift_px;
    [length, along_x * shift_x + along_y * shift_y]
}

/// Fit of p₀ and p₁, where p₀ + p₁ u is the ratio of the centroid's shift (px) to the tangential displacement, and u is
/// the normal displacement.
struct WithIndentation {
    coefficients: [f64; 2],
    stds: Option<[f64; 2]>,
    residual_rms: f64,
    residual_std: Option<f64>,
}

impl WithIndentation {
    /// Fits the coefficients p₀ and p₁ of the ratio p₀ + p₁ u; `None` if the normal displacements do not determine
    /// both, for example if all are equal.
    fn fit(along: &[[f64; 2]], normal: &[f64]) -> Option<Self> {
        let largest = |numbers: &mut dyn Iterator<Item = f64>| {
            numbers.fold(0.0, |largest: f64, one| largest.max(one.abs()))
        };
        let length = largest(&mut along.iter().map(|point| point[0]));
        let depth = largest(&mut normal.iter().copied());
        if depth == 0.0 {
            return None;
        }
        // Divide the displacements of each kind by their largest magnitude. The fitted equation is then y = x (c_0 +
        // c_1 u), with the shift y, the scaled tangential displacement x and the scaled normal displacement u.
        let rows = || {
            let points = along.iter().zip(normal);
            points.map(|([x, y], u)| (x / length, x / length * (u / depth), *y))
        };
        let sum = |of: &dyn Fn((f64, f64, f64)) -> f64| rows().map(of).sum::<f64>();
        let [aa, ab, bb] = [
            sum(&|(a, _, _)| a * a),
            sum(&|(a, b, _)| a * b),
            sum(&|(_, b, _)| b * b),
        ];
        let [ay, by] = [sum(&|(a, _, y)| a * y), sum(&|(_, b, y)| b * y)];
        let determinant = aa * bb - ab * ab;
        if determinant.is_nan() || determinant <= 1e-10 * aa * bb {
            return None;
        }
        let [c_0, c_1] = [
            (bb * ay - ab * by) / determinant,
            (aa * by - ab * ay) / determinant,
        ];
        let residuals = sum(&|(a, b, y)| (y - c_0 * a - c_1 * b).powi(2));
        let in_length = along.iter().zip(normal).map(|([x, y], u)| {
            let slope = (c_0 + c_1 * u / depth) / length;
            (y / slope - x).powi(2)
        });
        let sum_in_length: f64 = in_length.sum();
        let freedom = along.len() - 2;
        let per_freedom = |sum: f64| (freedom > 0).then(|| (sum / freedom as f64).sqrt());
        Some(Self {
            coefficients: [c_0 / length, c_1 / length / depth],
            stds: per_freedom(residuals).map(|std| {
                let scale = std / determinant.sqrt() / length;
                [scale * bb.sqrt(), scale * aa.sqrt() / depth]
            }),
            residual_rms: (sum_in_length / along.len() as f64).sqrt(),
            residual_std: per_freedom(sum_in_length),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_slope_follows_the_indentation() {
        let points: Vec<LateralPoint> = (0..12)
            .map(|step| {
                let (angle, normal) = (f64::from(step), 0.1 * f64::from(step % 4));
                let tangential = [0.3 * libm::cos(angle), 0.05 * angle * libm::sin(angle)];
                let slope = 7.0 + 2.0 * normal;
                LateralPoint {
                    tangential,
                    shift_px: tangential.map(|one| slope * one),
                    normal: Some(normal),
                }
            })
            .collect();
        let fitted = LateralCalibration::fit(&points).expect("a slope");
        assert_relative_eq!(fitted.px_per_length, 7.0, max_relative = 1e-9);
        let p_1 = fitted.per_indentation.expect("several indentations");
        assert_relative_eq!(p_1, 2.0, max_relative = 1e-9);
        assert!(fitted.residual_rms < 1e-12);
        let read = fitted.read([7.4, -3.7], 0.2).expect("finite");
        assert_relative_eq!(read[0], 1.0, max_relative = 1e-9);
        assert_relative_eq!(read[1], -0.5, max_relative = 1e-9);
        // For a normal displacement outside of the fitted range, the slope is that at the nearer end of the range.
        assert_relative_eq!(fitted.slope(10.0), 7.6, max_relative = 1e-9);
        assert!(fitted.slope(f64::NAN).is_finite());
    }

    #[test]
    fn one_indentation_determines_one_number() {
        let points = [0.1, 0.2, 0.4].map(|tangential| LateralPoint {
            tangential: [0.0, tangential],
            shift_px: [0.3, 7.0 * tangential],
            normal: Some(1.0),
        });
        let fitted = LateralCalibration::fit(&points).expect("a slope");
        assert_relative_eq!(fitted.px_per_length, 7.0, max_relative = 1e-12);
        assert_eq!(fitted.per_indentation, None);
    }
}
