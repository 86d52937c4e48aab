//! Fisheye lenses with odd terms in addition to the equidistant term.

use std::f64::consts::PI;

use super::error::{MOST_TERM, OpticsError};

/// Smallest allowed slope dr/dθ of a lens, relative to the slope on its axis, where r is the image radius at the angle
/// θ from the axis. If the slope is smaller, the image hardly resolves angles.
const LEAST_SLOPE: f64 = 0.01;
/// Maximum number of Newton steps for the inversion of the lens's map r(θ). A step that leaves the interval of the
/// solution is replaced by a bisection. This number of steps suffices for a result that is exact to the last digit,
/// even if all steps are bisections.
const STEPS: usize = 64;

/// Odd terms of a fisheye lens, in addition to the equidistant term: the lens maps θ to r = f (θ + k3 θ³ + k5 θ⁵). Here
/// θ is the angle from the axis, r the distance from the image's centre and f the focal length. Both coefficients are 0
/// for an equidistant lens. k3 is -1/24 for an equisolid, 1/12 for a stereographic and -1/6 for an orthographic lens
/// (Kannala and Brandt, *A generic camera model*, IEEE Trans. Pattern Anal. Mach. Intell. 28, 2006).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OddTerms {
    /// Coefficient k3 of the third power of the angle, per rad².
    pub k3: f64,
    /// Coefficient k5 of the fifth power of the angle, per rad⁴.
    pub k5: f64,
}

impl OddTerms {
    /// Map of the lens: converts an angle from the axis to the distance from the image's centre, divided by the focal
    /// length (r / f).
    #[inline]
    pub(super) fn map(self, polar: f64) -> f64 {
        polar * self.stretch(polar * polar)
    }

    /// Ratio of the image radius r / f of the lens to the angle from the axis, as a function of the squared angle.
    #[inline]
    pub(super) fn stretch(self, square: f64) -> f64 {
        1.0 + square * (self.k3 + square * self.k5)
    }

    /// Derivative of the image radius r / f with respect to the angle from the axis, as a function of the squared
    /// angle.
    #[inline]
    pub(super) fn slope(self, square: f64) -> f64 {
        1.0 + square * (3.0 * self.k3 + square * (5.0 * self.k5))
    }

    /// Inverse of [`Self::map`]. It converts a distance from the image's centre, divided by the focal length
    /// (`scaled`), to the angle from the axis, which is at least 0. The map must increase up to the angle `rim`. For
    /// distances beyond the rim, the map is continued as a straight line.
    #[inline]
    pub(super) fn angle(self, scaled: f64, rim: f64) -> f64 {
        let beyond = scaled - self.map(rim);
        if beyond >= 0.0 {
            return rim + beyond / self.slope(rim * rim);
        }
        let (mut low, mut high) = (0.0, rim);
        let mut angle = scaled.min(rim);
        for _ in 0..STEPS {
            let error = self.map(angle) - scaled;
            if error > 0.0 {
                high = angle;
            } else {
                low = angle;
            }
            let newton = angle - error / self.slope(angle * angle);
            let next = if newton >= low && newton <= high {
                newton
            } else {
                0.5 * (low + high)
            };
            if (next - angle).abs() <= f64::EPSILON * next {
                return next;
            }
            angle = next;
        }
        angle
    }

    /// Largest angle up to which the slope of the lens's map is at least [`LEAST_SLOPE`] everywhere. The result is at
    /// most half a turn.
    pub(super) fn reach(self) -> f64 {
        // A lens's map r(θ) is invertible up to the angle θ at which its slope d(r/f)/dθ decreases to `LEAST_SLOPE`.
        // With u = θ², the slope minus `LEAST_SLOPE` is the polynomial a u² + b u + c. The smallest positive root of
        // this polynomial is computed without cancellation.
        let (a, b, c) = (5.0 * self.k5, 3.0 * self.k3, 1.0 - LEAST_SLOPE);
        let square = b * b - 4.0 * a * c;
        if square < 0.0 {
            return PI;
        }
        let sum = -0.5 * (b + square.sqrt().copysign(b));
        let roots = [sum / a, c / sum].into_iter();
        let positive = roots.filter(|root| *root > 0.0);
        positive.fold(PI * PI, f64::min).sqrt().min(PI)
    }

    pub(super) fn least_slope(self, rim: f64) -> f64 {
        let square = rim * rim;
        let ends = self.slope(square).min(1.0);
        let turn = -0.3 * self.k3 / self.k5;
        if turn > 0.0 && turn < square {
            ends.min(self.slope(turn))
        } else {
            ends
        }
    }

    /// Upper bound of both the slope d(r/f)/dθ of the lens's map and the ratio (r/f)/θ, for angles from 0 to `rim`.
    pub(super) fn most_slope(self, rim: f64) -> f64 {
        let square = rim * rim;
        1.0 + square * (3.0 * self.k3.max(0.0) + square * (5.0 * self.k5.max(0.0)))
    }

    /// Smallest coefficient k3 for which the lens's map increases up to the angle `rim`. The coefficient k5 is that of
    /// this lens.
    fn least_k3(self, rim: f64) -> f64 {
        let (square, constant) = (rim * rim, 1.0 - LEAST_SLOPE);
        let k5 = 5.0 * self.k5;
        let turn = (constant / k5).sqrt();
        let at = if turn < square { turn } else { square };
        -(constant / at + k5 * at) / 3.0
    }

    pub(super) fn checked(self, rim: f64) -> Result<Self, OpticsError> {
        for (setting, term) in [("k3", self.k3), ("k5", self.k5)] {
            OpticsError::unless(term.abs() <= MOST_TERM, setting, term, "from -100 to 100")?;
        }
        let reach = self.reach();
        if rim <= reach {
            return Ok(self);
        }
        Err(OpticsError::FoldedLens {
            k3: self.k3,
            k5: self.k5,
            reach_deg: reach.to_degrees(),
            field_deg: rim.to_degrees(),
            least_k3: self.least_k3(rim),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Odd terms of lenses whose map increases up to 1.5 rad. Some are textbook projections. The others have terms
    /// close to the limits of the valid range.
    const TERMS: [OddTerms; 7] = [
        OddTerms { k3: 0.0, k5: 0.0 },
        OddTerms {
            k3: -1.0 / 24.0,
            k5: 1.0 / 1920.0,
        },
        OddTerms {
            k3: 1.0 / 12.0,
            k5: 1.0 / 120.0,
        },
        OddTerms { k3: -0.14, k5: 0.0 },
        OddTerms { k3: -0.5, k5: 0.12 },
        OddTerms { k3: 0.3, k5: -0.1 },
        OddTerms {
            k3: 100.0,
            k5: 100.0,
        },
    ];

    #[test]
    fn angles_come_back() {
        for terms in TERMS {
            terms.checked(1.5).unwrap();
            for step in 0..=160 {
                let angle = 0.01 * f64::from(step);
                // `map` computes the image radius for an angle up to the rim at 1.5 rad. The inverse function `angle`
                // also accepts larger image radii: it continues `map` beyond the rim by its tangent.
                let beyond = (angle - 1.5_f64).max(0.0);
                let mapped = terms.map(angle.min(1.5)) + beyond * terms.slope(2.25);
                let back = terms.angle(mapped, 1.5);
                assert!((back - angle).abs() < 1e-13, "{terms:?} {angle} {back}");
            }
        }
    }

    #[test]
    fn slopes_are_differences() {
        for terms in TERMS {
            for step in 1..30 {
                let (angle, more) = (0.05 * f64::from(step), 1e-5);
                let slope = terms.slope(angle * angle);
                let difference = (terms.map(angle + more) - terms.map(angle - more)) / (2.0 * more);
                assert!(
                    (slope - difference).abs() < 1e-7 * slope.abs().max(1.0),
                    "{terms:?} {angle}"
                );
                let [least, most] = [terms.least_slope(1.5), terms.most_slope(1.5)];
                assert!(slope >= least && slope <= most, "{terms:?} {angle}");
            }
        }
    }

    #[test]
    fn lenses_fold_where_their_slope_ends() {
        // The reach of a lens is the angle θ at which the slope d(r/f)/dθ of its map has decreased to 0.01. With u =
        // θ², the slope of the first lens is 1 − 0.6 u, which is 0.01 at u = 1.65. The slope of the second lens is 1 −
        // u + 0.24 u².
        let terms = OddTerms { k3: -0.2, k5: 0.0 };
        assert!((terms.reach() - 1.65_f64.sqrt()).abs() < 1e-15);
        let terms = OddTerms {
            k3: -1.0 / 3.0,
            k5: 0.048,
        };
        let root = (1.0 - (1.0 - 4.0 * 0.24 * 0.99_f64).sqrt()) / 0.48;
        assert!((terms.reach() - root.sqrt()).abs() < 1e-14);
        assert_eq!(OddTerms { k3: 0.1, k5: 0.0 }.reach(), PI);
        assert_eq!(OddTerms { k3: -0.1, k5: 0.1 }.reach(), PI);
        assert!(OddTerms { k3: 0.0, k5: -0.1 }.reach() < PI);
    }

    #[test]
    fn the_advised_k3_is_valid() {
        for (k3, k5) in [
            (-0.6, 0.0),
            (-0.6, 0.05),
            (-2.0, 0.4),
            (0.1, -0.5),
            (-1.0, -1.0),
        ] {
            let folded = OddTerms { k3, k5 }.checked(1.2);
            let Err(OpticsError::FoldedLens { least_k3, .. }) = folded else {
                panic!("{k3} {k5}: {folded:?}");
            };
            let at_least = |k3| OddTerms { k3, k5 }.checked(1.2);
            at_least(least_k3 + 1e-9).unwrap();
            at_least(least_k3 - 1e-9).unwrap_err();
            let said = OpticsError::to_string(&OddTerms { k3, k5 }.checked(1.2).unwrap_err());
            let printed = said
                .split("at least ")
                .nth(1)
                .and_then(|rest| rest.split(' ').next());
            at_least(printed.unwrap().parse().unwrap()).unwrap();
        }
        for k3 in [f64::NAN, f64::INFINITY, 101.0] {
            let refused = OddTerms { k3, k5: 0.0 }.checked(1.0);
            assert!(matches!(refused, Err(OpticsError::BadSetting(_))), "{k3}");
        }
    }
}
