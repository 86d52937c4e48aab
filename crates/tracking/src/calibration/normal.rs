//! Calibration of normal displacements, which are computed from the hue and the size of a marker's image.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

use super::CalibrationError;
use super::line::{Line, Words, finite, fit};
use crate::Change;

/// Feature of a marker's image from which its normal displacement is computed.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, IntoStaticStr, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum NormalFrom {
    /// Mean hue of the marker's image. It depends on the overlap of the marker's two discs, and so on the difference
    /// between the displacements of these discs.
    #[default]
    Hue,
    /// Size of the marker's image. If a disc at the distance ρ from the camera moves inward by u, the diameter of its
    /// image grows by the factor ρ/(ρ − u). The logarithm of this factor is called growth. Displacements are computed
    /// from the nearness 1 − 1/e^growth, because it equals u/ρ and so is proportional to u.
    Size,
    /// Mean hue and nearness (see `Size`), with the weights that fit the known displacements best. Hue and nearness
    /// depend on displacements at different depths, so the best weights depend on the shape of the contact.
    Both,
}

impl NormalFrom {
    /// All features from which normal displacements can be computed, starting with the default.
    pub const ALL: [Self; 3] = [Self::Hue, Self::Size, Self::Both];

    const fn words(self) -> Words {
        Words {
            displacement: "normal",
            signal: match self {
                Self::Hue => "the hue",
                Self::Size => "the size",
                Self::Both => "the weighted sum of hue and size",
            },
        }
    }
}

/// Calibration point: a known normal displacement of a marker, and the change of the marker's image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalPoint {
    /// Index of the marker in the sensor; `None` if it is not known.
    pub marker: Option<usize>,
    /// Known inward displacement of the marker (length).
    pub normal: f64,
    /// Change of the hue of the marker's image, turns.
    pub hue_turns: f64,
    /// Change of the natural logarithm of the diameter of the marker's image.
    pub growth: f64,
}

/// Calibration of the normal displacement. The displacement is the signal divided by the slope of the line, multiplied
/// by the marker's gain (see [`MarkerGain`]). The signal is the weighted sum of the change of hue and the nearness (see
/// [`NormalFrom::Size`]).
#[derive(Clone, Debug, PartialEq)]
pub struct NormalCalibration {
    /// Feature from which normal displacements are computed.
    pub from: NormalFrom,
    /// Weights of the hue (per turn) and of the nearness in the signal. If only the hue is used, the weights are 1 and
    /// 0, and the signal is in turns. If both features are used, the signal is in the unit of length.
    pub weights: [f64; 2],
    /// Line through the origin that is fitted to the signal as a function of the displacement. Displacements are
    /// computed from this line.
    pub line: Line,
    /// Line with an intercept that is fitted to the same points, for comparison with `line`; `None` if the points do
    /// not determine it.
    pub with_intercept: Option<Line>,
    /// Smallest and largest normal displacement (length) of the calibration points.
    pub range: [f64; 2],
    /// Lines of single markers: signal as a function of displacement, fitted to the points of one marker. Sorted by the
    /// index of the marker.
    pub gains: Vec<MarkerGain>,
    /// Whether the displacement of a marker is computed with the slope of its own line in `gains`. Otherwise it is
    /// computed with the slope of `line`, which is the same for all markers.
    pub uses_gains: bool,
}

/// Slope of the line (signal as a function of displacement) that is fitted to the calibration points of one marker.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MarkerGain {
    /// Index of the marker in the sensor.
    pub marker: usize,
    /// Slope of the line that is fitted to the points of all markers, divided by the slope of this marker's line.
    pub gain: f64,
    /// Line through the origin that is fitted to the points of this marker alone.
    pub line: Line,
}

impl NormalCalibration {
    /// Fits a line (signal as a function of displacement) to the points of all markers. In addition, fits a line to the
    /// points of each marker that has at least three different displacements. The marker's slope is stored if it is at
    /// least twice its standard error. It is used only after a call of [`NormalCalibration::per_marker`].
    ///
    /// # Errors
    /// [`CalibrationError`] for fewer than two points, for equal displacements, for numbers that are not finite, or for
    /// a signal that never changes.
    pub fn fit(points: &[NormalPoint], from: NormalFrom) -> Result<Self, CalibrationError> {
        let numbers: Vec<[f64; 3]> = points
            .iter()
            .map(|point| [point.normal, point.hue_turns, nearness(point.growth)])
            .collect();
        finite(numbers.iter().map(|numbers| &numbers[..]))?;
        let weights = match from {
            NormalFrom::Hue => [1.0, 0.0],
            NormalFrom::Size => [0.0, 1.0],
            NormalFrom::Both => best_weights(&numbers),
        };
        let signals: Vec<[f64; 2]> = numbers
            .iter()
            .map(|&[normal, hue, nearness]| [normal, signal(weights, hue, nearness)])
            .collect();
        let line = fit(&signals, false, from.words())?;
        let calibration = Self {
            from,
            weights,
            line,
            with_intercept: fit(&signals, true, from.words()).ok(),
            range: range(signals.iter().map(|point| point[0])),
            gains: gains(points, &signals, line.slope, from.words()),
            uses_gains: false,
        };
        calibration.checked()
    }

    /// The same calibration, but with a separate slope for each marker. A marker without a slope of its own keeps the
    /// common slope.
    pub fn per_marker(self) -> Self {
        Self {
            uses_gains: true,
            ..self
        }
    }

    /// Weighted sum of a marker's hue change and nearness (see [`nearness`]), from which the displacement is computed.
    fn signal(&self, change: &Change) -> f64 {
        signal(self.weights, change.hue_turns, nearness(change.growth))
    }

    pub(super) fn read(&self, marker: usize, change: &Change) -> Option<f64> {
        let own = self.gains.iter().find(|gain| gain.marker == marker);
        let gain = own.filter(|_| self.uses_gains).map_or(1.0, |own| own.gain);
        let normal = self.signal(change) / self.line.slope * gain;
        Some(normal).filter(|normal| normal.is_finite())
    }

    pub(super) fn checked(self) -> Result<Self, CalibrationError> {
        self.line.checked()?;
        if let Some(line) = self.with_intercept {
            line.checked()?;
        }
        for gain in &self.gains {
            gain.line.checked()?;
        }
        let gains = self.gains.iter().map(|gain| ("a gain", gain.gain));
        let weights = self.weights.map(|weight| ("a weight", weight));
        let range = self.range.map(|end| ("an end of the range", end));
        let mut numbers = weights.into_iter().chain(range).chain(gains);
        match numbers.find(|(_, number)| !number.is_finite()) {
            Some((what, value)) => Err(CalibrationError::out_of_range(what, value, "finite")),
            None => Ok(self),
        }
    }
}

/// Nearness: relative decrease of a marker's distance from the camera, 1 - 1/e^growth.
fn nearness(growth: f64) -> f64 {
    -libm::expm1(-growth)
}

fn signal(weights: [f64; 2], hue_turns: f64, nearness: f64) -> f64 {
    let [per_turn, per_nearness] = weights;
    // A feature whose weight is 0 is skipped, because the feature's value may be NaN, and 0 · NaN is NaN.
    let part = |weight: f64, number: f64| if weight == 0.0 { 0.0 } else { weight * number };
    part(per_turn, hue_turns) + part(per_nearness, nearness)
}

pub(super) fn range(displacements: impl Iterator<Item = f64>) -> [f64; 2] {
    displacements.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], one| {
        [low.min(one), high.max(one)]
    })
}

/// The two weights, of hue change and [`nearness`], with which their weighted sum fits the known displacements best. If
/// hue change and nearness are always proportional to each other, several pairs of weights fit equally well, and the
/// pair with the smallest norm is returned. If neither hue nor nearness changes, both weights are 0.
fn best_weights(numbers: &[[f64; 3]]) -> [f64; 2] {
    let largest = |part: usize| {
        numbers
            .iter()
            .fold(0.0, |largest: f64, one| largest.max(one[part].abs()))
    };
    let spans = [0, 1, 2].map(largest);
    if spans[0] == 0.0 {
        return [0.0, 0.0];
    }
    let scaled = |number: f64, span: f64| if span > 0.0 { number / span } else { 0.0 };
    let mut squares = Matrix2::zeros();
    let mut products = Vector2::zeros();
    for [normal, hue, nearness] in numbers {
        let parts = Vector2::new(scaled(*hue, spans[1]), scaled(*nearness, spans[2]));
        squares += parts * parts.transpose();
        products += parts * (normal / spans[0]);
    }
    let eigen = squares.symmetric_eigen();
    let least = 1e-10 * eigen.eigenvalues.max();
    let mut weights = Vector2::zeros();
    for (value, vector) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if *value > least {
            weights += vector * (vector.dot(&products) / value);
        }
    }
    [
        scaled(spans[0] * weights.x, spans[1]),
        scaled(spans[0] * weights.y, spans[2]),
    ]
}

const DIFFERENT_DISPLACEMENTS: usize = 3;

fn gains(
    points: &[NormalPoint],
    signals: &[[f64; 2]],
    slope: f64,
    words: Words,
) -> Vec<MarkerGain> {
    let mut of_marker: BTreeMap<usize, Vec<[f64; 2]>> = BTreeMap::new();
    for (point, signal) in points.iter().zip(signals) {
        if let Some(marker) = point.marker {
            of_marker.entry(marker).or_default().push(*signal);
        }
    }
    of_marker
        .into_iter()
        .filter_map(|(marker, signals)| {
            let mut displacements: Vec<f64> = signals.iter().map(|point| point[0]).collect();
            displacements.sort_by(f64::total_cmp);
            displacements.dedup();
            if displacements.len() < DIFFERENT_DISPLACEMENTS {
                return None;
            }
            let line = fit(&signals, false, words).ok()?;
            let gain = slope / line.slope;
            let is_clear = line
                .slope_std
                .is_some_and(|std| line.slope.abs() >= 2.0 * std);
            (is_clear && gain.is_finite()).then_some(MarkerGain { marker, gain, line })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn point(marker: usize, normal: f64, hue_turns: f64, growth: f64) -> NormalPoint {
        NormalPoint {
            marker: Some(marker),
            normal,
            hue_turns,
            growth,
        }
    }

    /// Calibration points of two markers at the distance 18 from the camera. The hue of the second marker changes twice
    /// as much per length as the hue of the first marker.
    fn two_markers() -> Vec<NormalPoint> {
        (0..4)
            .flat_map(|step| {
                let normal = 0.4 * f64::from(step);
                let growth = libm::log(18.0 / (18.0 - normal));
                [
                    point(4, normal, 0.02 * normal, growth),
                    point(9, normal, 0.04 * normal, growth),
                ]
            })
            .collect()
    }

    fn change(hue_turns: f64, growth: f64) -> Change {
        Change {
            hue_turns,
            growth,
            ..Change::default()
        }
    }

    #[test]
    fn markers_have_slopes_of_their_own_only_if_requested() {
        let fitted = NormalCalibration::fit(&two_markers(), NormalFrom::Hue).expect("a slope");
        assert_relative_eq!(fitted.line.slope, 0.03, max_relative = 1e-12);
        let sight = change(0.03, 0.0);
        for marker in [4, 9] {
            assert_relative_eq!(
                fitted.read(marker, &sight).expect("finite"),
                1.0,
                epsilon = 1e-12
            );
        }
        let fitted = fitted.per_marker();
        for (marker, normal) in [(4, 1.5), (9, 0.75), (0, 1.0)] {
            let read = fitted.read(marker, &sight).expect("finite");
            assert_relative_eq!(read, normal, epsilon = 1e-12);
        }
    }

    #[test]
    fn both_features_have_their_weights() {
        // The displacements u are 10 hue + 5 nearness, and hue and nearness vary independently. Therefore the points
        // determine both weights.
        let points: Vec<NormalPoint> = [(0.01, 0.02), (0.02, 0.01), (0.03, 0.05), (-0.01, 0.04)]
            .map(|(hue, nearness): (f64, f64)| {
                let normal = 10.0 * hue + 5.0 * nearness;
                point(0, normal, hue, -libm::log1p(-nearness))
            })
            .to_vec();
        let fitted = NormalCalibration::fit(&points, NormalFrom::Both).expect("a slope");
        assert_relative_eq!(fitted.weights[0], 10.0, max_relative = 1e-9);
        assert_relative_eq!(fitted.weights[1], 5.0, max_relative = 1e-9);
        assert_relative_eq!(fitted.line.slope, 1.0, max_relative = 1e-9);
    }

    #[test]
    fn both_that_always_change_together_share() {
        let points: Vec<NormalPoint> = (1..5)
            .map(|step| {
                let normal = f64::from(step);
                point(0, normal, 0.01 * normal, -libm::log1p(-0.002 * normal))
            })
            .collect();
        let fitted = NormalCalibration::fit(&points, NormalFrom::Both).expect("a slope");
        assert_relative_eq!(0.01 * fitted.weights[0], 0.5, max_relative = 1e-9);
        assert_relative_eq!(0.002 * fitted.weights[1], 0.5, max_relative = 1e-9);
    }
}
