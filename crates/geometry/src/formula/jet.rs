//! Numbers with their first and second derivatives with respect to x and y.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A function's value at a point (x, y) with its first and second partial derivatives there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Value of the function f.
    pub value: f64,
    /// First derivatives f_x, f_y.
    pub gradient: [f64; 2],
    /// Second derivatives f_xx, f_xy, f_yy.
    pub hessian: [f64; 3],
}

impl Jet {
    /// Whether the value and all derivatives are finite.
    pub fn is_finite(&self) -> bool {
        self.value.is_finite()
            && self.gradient.iter().all(|d| d.is_finite())
            && self.hessian.iter().all(|d| d.is_finite())
    }

    pub(super) fn x(value: f64) -> Self {
        Self {
            value,
            gradient: [1.0, 0.0],
            hessian: [0.0; 3],
        }
    }

    pub(super) fn y(value: f64) -> Self {
        Self {
            value,
            gradient: [0.0, 1.0],
            hessian: [0.0; 3],
        }
    }

    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            value: f(self.value),
            gradient: self.gradient.map(&f),
            hessian: self.hessian.map(&f),
        }
    }

    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let ([ax, ay], [bx, by]) = (self.gradient, other.gradient);
        let ([axx, axy, ayy], [bxx, bxy, byy]) = (self.hessian, other.hessian);
        Self {
            value: f(self.value, other.value),
            gradient: [f(ax, bx), f(ay, by)],
            hessian: [f(axx, bxx), f(axy, bxy), f(ayy, byy)],
        }
    }
}

/// Number type with which a formula is evaluated: `f64` for the value of the formula alone, [`Jet`] for the value and
/// its derivatives.
pub(super) trait Number:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    fn constant(value: f64) -> Self;

    /// The composition `outer(self)`. The argument `outer` is a function that returns three numbers: its value, its
    /// first and its second derivative.
    fn compose(self, outer: impl FnOnce(f64) -> [f64; 3]) -> Self;

    /// The composition `outer(self, other)`. The argument `outer` is a function that returns its value and its first
    /// and second derivatives with respect to its two arguments.
    fn compose2(self, other: Self, outer: impl FnOnce(f64, f64) -> Jet) -> Self;
}

impl Number for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline]
    fn compose(self, outer: impl FnOnce(f64) -> [f64; 3]) -> Self {
        outer(self)[0]
    }

    #[inline]
    fn compose2(self, other: Self, outer: impl FnOnce(f64, f64) -> Jet) -> Self {
        outer(self, other).value
    }
}

impl Number for Jet {
    #[inline]
    fn constant(value: f64) -> Self {
        Self {
            value,
            gradient: [0.0; 2],
            hessian: [0.0; 3],
        }
    }

    #[inline]
    fn compose(self, outer: impl FnOnce(f64) -> [f64; 3]) -> Self {
        let [value, first, second] = outer(self.value);
        let ([x, y], [xx, xy, yy]) = (self.gradient, self.hessian);
        Self {
            value,
            gradient: [first * x, first * y],
            hessian: [
                first * xx + second * x * x,
                first * xy + second * x * y,
                first * yy + second * y * y,
            ],
        }
    }

    #[inline]
    fn compose2(self, other: Self, outer: impl FnOnce(f64, f64) -> Jet) -> Self {
        let Jet {
            value,
            gradient: [fa, fb],
            hessian: [faa, fab, fbb],
        } = outer(self.value, other.value);
        let ([ax, ay], [bx, by]) = (self.gradient, other.gradient);
        let ([axx, axy, ayy], [bxx, bxy, byy]) = (self.hessian, other.hessian);
        Self {
            value,
            gradient: [fa * ax + fb * bx, fa * ay + fb * by],
            hessian: [
                fa * axx + fb * bxx + faa * ax * ax + 2.0 * fab * ax * bx + fbb * bx * bx,
                fa * axy + fb * bxy + faa * ax * ay + fab * (ax * by + ay * bx) + fbb * bx * by,
                fa * ayy + fb * byy + faa * ay * ay + 2.0 * fab * ay * by + fbb * by * by,
            ],
        }
    }
}

impl Neg for Jet {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Add for Jet {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Jet {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Jet {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        let ([ax, ay], [bx, by]) = (self.gradient, other.gradient);
        let ([axx, axy, ayy], [bxx, bxy, byy]) = (self.hessian, other.hessian);
        Self {
            value: a * b,
            gradient: [a * bx + b * ax, a * by + b * ay],
            hessian: [
                a * bxx + b * axx + 2.0 * ax * bx,
                a * bxy + b * axy + (ax * by + ay * bx),
                a * byy + b * ayy + 2.0 * ay * by,
            ],
        }
    }
}

impl Div for Jet {
    type Output = Self;
    /// The derivatives of the quotient q = a/b follow from the equation q b = a. The usual formula is not used, because
    /// it contains b², which may overflow.
    #[inline]
    fn div(self, other: Self) -> Self {
        let b = other.value;
        let ([ax, ay], [bx, by]) = (self.gradient, other.gradient);
        let ([axx, axy, ayy], [bxx, bxy, byy]) = (self.hessian, other.hessian);
        let q = self.value / b;
        let (qx, qy) = ((ax - q * bx) / b, (ay - q * by) / b);
        Self {
            value: q,
            gradient: [qx, qy],
            hessian: [
                (axx - q * bxx - 2.0 * qx * bx) / b,
                (axy - q * bxy - (qx * by + qy * bx)) / b,
                (ayy - q * byy - 2.0 * qy * by) / b,
            ],
        }
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    #[inline]
    fn add(self, constant: f64) -> Self {
        Self {
            value: self.value + constant,
            ..self
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    #[inline]
    fn mul(self, constant: f64) -> Self {
        self.map(|a| a * constant)
    }
}

impl Div<f64> for Jet {
    type Output = Self;
    #[inline]
    fn div(self, constant: f64) -> Self {
        self.map(|a| a / constant)
    }
}
