//! A straight line that is fitted to a signal (hue, size or shift of markers) at known displacements.

use serde::{Deserialize, Serialize};

use super::CalibrationError;

/// Largest allowed magnitude of the numbers in a fit. The squares of such numbers can be added without overflow.
const LARGEST: f64 = 1e100;

/// A line that is fitted by least squares: a signal as a function of a known displacement. The signal is, for example,
/// the hue in turns or the shift in px.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Change of the signal per length of displacement.
    pub slope: f64,
    /// Standard error of the slope; `None` if there are no degrees of freedom.
    pub slope_std: Option<f64>,
    /// The signal at zero displacement; `None` for a line through the origin.
    pub intercept: Option<f64>,
    /// Share of the signal's variance that the line explains. It is negative if a line through the origin fits worse
    /// than the mean of the signal.
    pub r_squared: f64,
    /// Root mean square of the signal's residuals, divided by the slope. The result is a length.
    pub residual_rms: f64,
    /// Standard deviation of the signal's residuals (corrected for the degrees of freedom), divided by the slope. The
    /// result is a length; `None` if there are no degrees of freedom.
    pub residual_std: Option<f64>,
    /// Number of points to which the line was fitted.
    #[serde(rename = "points")]
    pub count: usize,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Words {
    pub(super) displacement: &'static str,
    pub(super) signal: &'static str,
}

/// Fits a line to points (displacement, signal). The 2020 paper fits lines with an intercept (Fig. 6b and c). A line
/// without an intercept goes through the origin, because displacement and signal are 0 at rest.
pub(super) fn fit(
    points: &[[f64; 2]],
    has_intercept: bool,
    words: Words,
) -> Result<Line, CalibrationError> {
    let [length, signal] = spans(points, words)?;
    let count = points.len() as f64;
    let scaled = || points.iter().map(|[x, y]| [x / length, y / signal]);
    let mean = |axis: usize| scaled().map(|point| point[axis]).sum::<f64>() / count;
    let [mean_x, mean_y] = [mean(0), mean(1)];
    let [x_0, y_0] = match has_intercept {
        true => [mean_x, mean_y],
        false => [0.0; 2],
    };
    let sum = |of: &dyn Fn([f64; 2]) -> f64| scaled().map(of).sum::<f64>();
    let squares = sum(&|[x, _]| (x - x_0).powi(2));
    let slope = sum(&|[x, y]| (x - x_0) * (y - y_0)) / squares;
    let residuals = sum(&|[x, y]| (y - y_0 - slope * (x - x_0)).powi(2));
    let variance = sum(&|[_, y]| (y - mean_y).powi(2));
    let freedom = points.len() - 1 - usize::from(has_intercept);
    let mean_square = (freedom > 0).then(|| residuals / freedom as f64);
    let unit = signal / length;
    // The slope is in units of the largest signal per largest displacement. A slope below 1e-12 is only a rounding
    // error: the signal does not depend on the displacement.
    if slope.abs() < 1e-12 {
        return Err(CalibrationError::NoSlope { what: words.signal });
    }
    let line = Line {
        slope: slope * unit,
        slope_std: mean_square.map(|square| (square / squares).sqrt() * unit),
        intercept: has_intercept.then_some((y_0 - slope * x_0) * signal),
        r_squared: 1.0 - residuals / variance,
        residual_rms: (residuals / count).sqrt() / slope.abs() * length,
        residual_std: mean_square.map(|square| square.sqrt() / slope.abs() * length),
        count: points.len(),
    };
    line.checked()
}

impl Line {
    pub(super) fn checked(self) -> Result<Self, CalibrationError> {
        let optional = [self.slope_std, self.intercept, self.residual_std];
        if !self.slope.is_normal() {
            let needed = "finite and further from 0 than 1e-300";
            return Err(CalibrationError::out_of_range(
                "a line's slope",
                self.slope,
                needed,
            ));
        }
        let others = [self.r_squared, self.residual_rms].into_iter();
        let mut numbers = others.chain(optional.into_iter().flatten());
        let bad = |value| CalibrationError::out_of_range("a number of a line", value, "finite");
        let infinite = numbers.find(|number| !number.is_finite());
        infinite.map_or(Ok(self), |value| Err(bad(value)))
    }
}

/// Largest magnitudes of the displacements and of the signals. Returns an error if the points (displacement, signal) do
/// not determine a slope.
fn spans(points: &[[f64; 2]], words: Words) -> Result<[f64; 2], CalibrationError> {
    finite(points.iter().map(|point| &point[..]))?;
    if points.len() < 2 {
        return Err(CalibrationError::TooFewPoints {
            what: "points",
            count: points.len(),
            needed: 2,
        });
    }
    let [x, y] = points[0];
    if points.iter().all(|point| point[0] == x) {
        return Err(CalibrationError::OneDisplacement {
            what: words.displacement,
            displacement: x,
            count: points.len(),
        });
    }
    if points.iter().all(|point| point[1] == y) {
        return Err(CalibrationError::NoSlope { what: words.signal });
    }
    Ok([0, 1].map(|axis| {
        points
            .iter()
            .fold(0.0, |largest: f64, point| largest.max(point[axis].abs()))
    }))
}

/// Checks that all numbers are finite, and small enough that the sum of their squares does not overflow.
pub(super) fn finite<'a>(
    mut points: impl Iterator<Item = &'a [f64]>,
) -> Result<(), CalibrationError> {
    let bad = |point: &[f64]| point.iter().any(|one| one.is_nan() || one.abs() > LARGEST);
    let bad = points.position(bad);
    bad.map_or(Ok(()), |point| Err(CalibrationError::NotFinite { point }))
}
