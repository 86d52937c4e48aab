//! Searches the smoothing parameter p for which the residual sum F(p) has the required value.

const MOST_TRIALS: usize = 20;
/// Factor for steps of the search while the smoothing parameter is far from the root. A parameter that is too large is
/// multiplied by this factor, and a parameter that is too small is divided by it.
const FAR: f64 = 0.04;
/// A step by the factor [`FAR`] may pass a bound of the search. Then the next parameter lies between the last tried
/// parameter and the bound. Its distance from the bound, divided by the distance between the last parameter and the
/// bound, is this value.
const NEAR: f64 = 0.1;

/// A parameter that was tried. `excess` is its residual sum minus the required sum.
#[derive(Clone, Copy)]
pub(super) struct Trial {
    pub(super) parameter: f64,
    pub(super) excess: f64,
}

/// Tries parameters until the `excess` of one of them is within `tolerance`. Returns whether such a parameter was
/// found.
///
/// The residual sum F decreases with p. At p = 0, F is the residual sum of the polynomial without interior knots;
/// `below` is this sum minus the required sum. At p = ∞, F is the residual sum of the least-squares spline; `above` is
/// this sum minus the required sum. First, a parameter that is far from the root is multiplied or divided by [`FAR`].
/// As soon as the tried parameters include one on each side of the root, a function `(a p + b)/(p + c)` is computed
/// from three of them. The root of this function is the next parameter.
pub(super) fn search(
    below: f64,
    above: f64,
    first: f64,
    tolerance: f64,
    mut excess: impl FnMut(f64) -> f64,
) -> bool {
    let mut low = Trial {
        parameter: 0.0,
        excess: below,
    };
    let mut high = Trial {
        parameter: f64::INFINITY,
        excess: above,
    };
    let (mut is_low_near, mut is_high_near) = (false, false);
    let mut parameter = first;
    for _ in 0..MOST_TRIALS {
        if !(parameter > 0.0 && parameter.is_finite()) {
            return false;
        }
        let trial = Trial {
            parameter,
            excess: excess(parameter),
        };
        if trial.excess.abs() <= tolerance {
            return true;
        }
        if !is_high_near {
            if trial.excess - high.excess <= tolerance {
                high = trial;
                parameter *= FAR;
                if parameter <= low.parameter {
                    parameter = low.parameter * (1.0 - NEAR) + trial.parameter * NEAR;
                }
                continue;
            }
            is_high_near = trial.excess < 0.0;
        }
        if !is_low_near {
            if low.excess - trial.excess <= tolerance {
                low = trial;
                parameter /= FAR;
                if parameter >= high.parameter {
                    parameter = trial.parameter * NEAR + high.parameter * (1.0 - NEAR);
                }
                continue;
            }
            is_low_near = trial.excess > 0.0;
        }
        if !(high.excess < trial.excess && trial.excess < low.excess) {
            return false;
        }
        parameter = rational_root(low, trial, high);
        if trial.excess < 0.0 {
            high = trial;
        } else {
            low = trial;
        }
    }
    false
}

/// The root p of the function `(a p + b)/(p + c)` that passes through three trials. The parameter of the trial `high`
/// may be infinite.
fn rational_root(low: Trial, middle: Trial, high: Trial) -> f64 {
    let (p, f) = (
        [low.parameter, middle.parameter, high.parameter],
        [low.excess, middle.excess, high.excess],
    );
    if p[2].is_infinite() {
        let (first, second) = (f[1] * (f[0] - f[2]), f[0] * (f[1] - f[2]));
        return (p[0] * first - p[1] * second) / ((f[0] - f[1]) * f[2]);
    }
    let weights = [
        f[0] * (f[1] - f[2]),
        f[1] * (f[2] - f[0]),
        f[2] * (f[0] - f[1]),
    ];
    let pairs = p[1] * p[2] * weights[0] + p[2] * p[0] * weights[1] + p[0] * p[1] * weights[2];
    -pairs / (p[0] * weights[0] + p[1] * weights[1] + p[2] * weights[2])
}
