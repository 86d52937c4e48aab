//! Determines the shape class of a place from its curvature, and the probabilities of the classes from the standard
//! errors.

use palpate_geometry::{ShapeClass, ShapeThresholds};
use palpate_statistics::normal_tail;
use strum::IntoStaticStr;

use crate::{Curvature, Uncertainty};

/// The class probabilities are integrated over a range of the mean curvature around its estimate. This constant is half
/// the width of the range, in standard errors of the mean curvature.
const REACH: f64 = 8.0;
/// Number of intervals of Simpson's rule in each part of the range of integration. It must be even.
const INTERVALS: usize = 64;

/// Shape class by the signs of the Gaussian and the mean curvature, without thresholds.
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum SignClass {
    /// Gaussian and mean curvature are above 0: both principal curvatures are positive.
    Convex,
    /// Gaussian curvature is above 0 and mean curvature below 0: both principal curvatures are negative.
    Concave,
    /// Gaussian curvature is at most 0.
    Saddle,
}

impl Curvature {
    /// The shape class of the place by the signs of the Gaussian and the mean curvature, without thresholds.
    pub fn sign_class(&self) -> SignClass {
        match (self.gaussian > 0.0, self.mean > 0.0) {
            (true, true) => SignClass::Convex,
            (true, false) => SignClass::Concave,
            (false, _) => SignClass::Saddle,
        }
    }

    /// The probability of each of the eight classes, in the order of [`ShapeClass::ALL`]. The errors of the Gaussian
    /// curvature K and the mean curvature H are assumed to be normally distributed. `None` if the method computes no
    /// standard errors, or if numbers are beyond the range of doubles. A value of K above H² is impossible and is
    /// replaced by H².
    pub fn class_probabilities(&self, thresholds: &ShapeThresholds) -> Option<[f64; 8]> {
        let uncertainty = self.uncertainty?;
        // Integrate over the mean curvature H. For each value of H, the Gaussian curvature K is normally distributed,
        // so the probability of each class is computed by a formula.
        let given_mean = GivenMean::of(self, &uncertainty, thresholds);
        let mut result = [0.0; 8];
        let mut add = |mean: f64, weight: f64| {
            for (class, probability) in given_mean.classes(mean) {
                result[class as usize] += weight * probability;
            }
        };
        let (centre, std) = (self.mean, uncertainty.mean_std);
        let (low, high) = (centre - REACH * std, centre + REACH * std);
        let is_sound = self.is_finite()
            && given_mean.slope.is_finite()
            && uncertainty.correlation.is_finite()
            && low.is_finite()
            && high.is_finite();
        if !is_sound {
            return None;
        }
        // The standard deviation of H may be so small that `low` and `high`, the ends of the range of H, are equal
        // after rounding. Then treat it as 0.
        if low < high && std >= f64::MIN_POSITIVE {
            let edges = [-thresholds.mean(), thresholds.mean()].map(|edge| edge.clamp(low, high));
            for (start, end) in [(low, edges[0]), (edges[0], edges[1]), (edges[1], high)] {
                let step = (end - start) / INTERVALS as f64;
                // Skip a part of the range of H if its width is 0, because rounding could put the middle of this part
                // into a neighbouring class.
                if step <= 0.0 {
                    continue;
                }
                for node in 0..=INTERVALS {
                    let simpson = match node {
                        0 | INTERVALS => 1.0,
                        node if node % 2 == 1 => 4.0,
                        _ => 2.0,
                    };
                    // Move the first and the last node of an interval of H slightly inwards. At an end of the interval,
                    // rounding could select the class of the neighbouring interval.
                    let inside = (node as f64).clamp(1e-9, INTERVALS as f64 - 1e-9);
                    let mean = start + step * inside;
                    let deviate = (mean - centre) / std;
                    add(
                        mean,
                        simpson * step / std * libm::exp(-0.5 * deviate * deviate),
                    );
                }
            }
        } else {
            add(centre, 1.0);
        }
        let total: f64 = result.iter().sum();
        let is_sound = total > 0.0 && total.is_finite();
        is_sound.then(|| result.map(|sum| sum / total))
    }
}

/// The distribution of the Gaussian curvature K for a given mean curvature H.
struct GivenMean<'a> {
    curvature: &'a Curvature,
    /// Derivative, with respect to the mean curvature H, of the expected value of the Gaussian curvature K for a given
    /// H.
    slope: f64,
    std: f64,
    thresholds: &'a ShapeThresholds,
}

impl<'a> GivenMean<'a> {
    fn of(
        curvature: &'a Curvature,
        uncertainty: &Uncertainty,
        thresholds: &'a ShapeThresholds,
    ) -> Self {
        let Uncertainty {
            gaussian_std,
            mean_std,
            correlation,
        } = *uncertainty;
        let slope = if mean_std > 0.0 {
            correlation * gaussian_std / mean_std
        } else {
            0.0
        };
        Self {
            curvature,
            slope,
            std: gaussian_std * (1.0 - correlation * correlation).max(0.0).sqrt(),
            thresholds,
        }
    }

    /// Three classes and their probabilities, if the mean curvature is `mean`. The classes belong to a Gaussian
    /// curvature below zero, near zero (within its threshold) and above zero.
    fn classes(&self, mean: f64) -> [(ShapeClass, f64); 3] {
        let edge = self.thresholds.gaussian();
        let below = self.below(-edge, mean);
        let above = if mean * mean > edge {
            1.0 - self.below(edge, mean)
        } else {
            0.0
        };
        let class = |gaussian: f64| self.thresholds.classify(gaussian, mean);
        [
            (class(f64::MIN), below),
            (class(0.0), 1.0 - below - above),
            (class(f64::MAX), above),
        ]
    }

    /// The probability that the Gaussian curvature is below `edge`, given the mean curvature `mean`. The numerical
    /// error is at most 1e-15.
    fn below(&self, edge: f64, mean: f64) -> f64 {
        let centre = self.curvature.gaussian + self.slope * (mean - self.curvature.mean);
        if self.std > 0.0 {
            normal_tail((centre - edge) / self.std)
        } else {
            f64::from(u8::from(centre <= edge))
        }
    }
}
