//! Odd terms of a fisheye, from distances in the picture back to angles.

use std::f64::consts::PI;

/// Least slope of a lens, as a share of that on its axis: where it is less, no picture tells angles.
const LEAST_SLOPE: f64 = 0.01;
/// Steps of Newton's method, which halves the bracket where it would leave it.
const STEPS: usize = 64;

/// Odd terms of a fisheye: r = f (θ + k3 θ³ + k5 θ⁵).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OddTerms {
    k3: f64,
    k5: f64,
    /// Largest angle, at most half a turn, up to which r grows.
    reach: f64,
}

impl OddTerms {
    /// Terms of any size that are numbers.
    pub(crate) fn new(k3: f64, k5: f64) -> Self {
        let terms = Self { k3, k5, reach: PI };
        Self {
            reach: terms.least_root(),
            ..terms
        }
    }

    /// Angle at which the slope falls to its least: the lesser positive root of 5 k5 u² + 3 k3 u + 1 in u = θ².
    fn least_root(self) -> f64 {
        let (square, linear, constant) = (5.0 * self.k5, 3.0 * self.k3, 1.0 - LEAST_SLOPE);
        let inside = linear * linear - 4.0 * square * constant;
        if inside < 0.0 {
            return PI;
        }
        let sum = -0.5 * (linear + inside.sqrt().copysign(linear));
        let roots = [sum / square, constant / sum];
        let positive = roots.into_iter().filter(|root| *root > 0.0);
        positive.fold(PI * PI, f64::min).sqrt().min(PI)
    }

    /// r / (f θ) and r′ / f at an angle.
    pub(crate) fn stretches(self, angle: f64) -> [f64; 2] {
        let square = angle.min(self.reach).powi(2);
        let term =
            |third: f64, fifth: f64| 1.0 + square * (third * self.k3 + square * (fifth * self.k5));
        [term(1.0, 1.0), term(3.0, 5.0)]
    }

    /// The angle that is seen at a distance r / f from the middle; `None` beyond those that are seen once.
    pub(crate) fn angle(self, scaled: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, self.reach);
        let seen = |angle: f64| angle * self.stretches(angle)[0];
        let is_seen = scaled <= seen(high);
        if !is_seen {
            return None;
        }
        let mut angle = scaled.min(high);
        for _ in 0..STEPS {
            let error = seen(angle) - scaled;
            if error > 0.0 {
                high = angle;
            } else {
                low = angle;
            }
            let newton = angle - error / self.stretches(angle)[1];
            let next = if (low..=high).contains(&newton) {
                newton
            } else {
                0.5 * (low + high)
            };
            if (next - angle).abs() <= f64::EPSILON * next {
                return Some(next);
            }
            angle = next;
        }
        Some(angle)
    }
}
