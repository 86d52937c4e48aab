//! Closed forms in more digits than a double has: 57 of them.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use astro_float_num::{BigFloat, Consts, RoundingMode, Sign};

/// Bits of a mantissa.
const BITS: usize = 192;
const ROUND: RoundingMode = RoundingMode::ToEven;

thread_local! {
    /// π and ln 2, which the functions keep at the digits that they needed so far.
    static CONSTANTS: RefCell<Consts> =
        RefCell::new(Consts::new().expect("a cache of constants takes a few bytes"));
}

/// A number of 57 digits, with an exponent that no double over- or underflows.
#[derive(Clone, Debug)]
pub struct Precise(BigFloat);

impl Precise {
    /// A double, exactly. NaN and infinities stay what they are.
    pub fn new(value: f64) -> Self {
        if value.is_subnormal() {
            // The crate below takes these for 0.
            let shift = 2f64.powi(100);
            return Self(BigFloat::from_f64(value * shift, BITS)) / Self::new(shift);
        }
        Self(BigFloat::from_f64(value, BITS))
    }

    /// π.
    pub fn pi() -> Self {
        with_constants(|constants| constants.pi(BITS, ROUND))
    }

    /// The nearest double; infinite beyond their range, 0 below it.
    pub fn to_f64(&self) -> f64 {
        if self.0.is_nan() {
            return f64::NAN;
        }
        if self.0.is_inf() {
            return if self.0.is_inf_pos() {
                f64::INFINITY
            } else {
                f64::NEG_INFINITY
            };
        }
        let Some((words, _, sign, exponent, _)) = self.0.as_raw_parts() else {
            return f64::NAN;
        };
        // The mantissa is 0.1… in binary, its most significant word last. What lies below the upper
        // word only tells a tie from more than one.
        let (&upper, lower) = words.split_last().unwrap_or((&0, &[]));
        let sticky = u64::from(lower.iter().any(|&word| word != 0));
        let magnitude = libm::scalbn((upper | sticky) as f64, exponent - 64);
        match sign {
            Sign::Pos => magnitude,
            Sign::Neg => -magnitude,
        }
    }

    /// Whether it is below 0.
    pub fn is_negative(&self) -> bool {
        self.0.is_negative() && !self.0.is_zero()
    }

    /// Magnitude of the number.
    #[must_use]
    pub fn abs(&self) -> Self {
        Self(self.0.abs())
    }

    /// The square root; NaN below 0.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        Self(self.0.sqrt(BITS, ROUND))
    }

    /// The square.
    #[must_use]
    pub fn squared(&self) -> Self {
        self * self
    }

    /// The power: `exp(exponent · ln self)`.
    #[must_use]
    pub fn powf(&self, exponent: &Self) -> Self {
        with_constants(|constants| self.0.pow(&exponent.0, BITS, ROUND, constants))
    }
}

macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident;)*) => {
        impl Precise {
            $(
                $(#[$doc])*
                #[must_use]
                pub fn $name(&self) -> Self {
                    with_constants(|constants| self.0.$name(BITS, ROUND, constants))
                }
            )*
        }
    };
}

functions! {
    /// Sine of radians.
    sin;
    /// Cosine of radians.
    cos;
    /// Tangent of radians.
    tan;
    /// Angle of that sine, radians; NaN beyond ±1.
    asin;
    /// Angle of that tangent, radians.
    atan;
    /// Area hyperbolic sine.
    asinh;
    /// Exponential.
    exp;
    /// Natural logarithm; NaN below 0.
    ln;
}

impl From<f64> for Precise {
    fn from(value: f64) -> Self {
        Self::new(value)
    }
}

impl From<&Self> for Precise {
    fn from(value: &Self) -> Self {
        value.clone()
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<T: Into<Precise>> $trait<T> for &Precise {
            type Output = Precise;
            fn $method(self, other: T) -> Precise {
                Precise(self.0.$method(&other.into().0, BITS, ROUND))
            }
        }
        impl<T: Into<Precise>> $trait<T> for Precise {
            type Output = Precise;
            fn $method(self, other: T) -> Precise {
                (&self).$method(other)
            }
        }
        impl $trait<Precise> for f64 {
            type Output = Precise;
            fn $method(self, other: Precise) -> Precise {
                Precise::new(self).$method(other)
            }
        }
        impl $trait<&Precise> for f64 {
            type Output = Precise;
            fn $method(self, other: &Precise) -> Precise {
                Precise::new(self).$method(other)
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Precise {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.neg())
    }
}

fn with_constants(function: impl FnOnce(&mut Consts) -> BigFloat) -> Precise {
    CONSTANTS.with_borrow_mut(|constants| Precise(function(constants)))
}

#[cfg(test)]
mod tests {
    use super::Precise;

    #[test]
    fn doubles_survive_the_way_there_and_back() {
        for value in [
            0.0,
            1.0,
            -1.5,
            0.1,
            1e-300,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::from_bits(1),
            -f64::from_bits(3 << 40),
        ] {
            assert_eq!(Precise::new(value).to_f64(), value);
        }
        assert!(Precise::new(f64::NAN).to_f64().is_nan());
        assert_eq!(Precise::new(f64::NEG_INFINITY).to_f64(), f64::NEG_INFINITY);
        let huge = Precise::new(1e300);
        assert_eq!((&huge * &huge).to_f64(), f64::INFINITY);
        assert_eq!((Precise::new(1.0) / (&huge * &huge)).to_f64(), 0.0);
        assert_eq!((&huge * &huge / &huge).to_f64(), 1e300);
    }

    #[test]
    fn cancellation_costs_no_digits() {
        let tiny = Precise::new(1e-30);
        assert_eq!(((Precise::new(1.0) + &tiny) - 1.0).to_f64(), 1e-30);
        let versine = Precise::new(1.0) - Precise::new(1e-12).cos();
        assert_eq!(versine.to_f64(), 5e-25);
    }

    #[test]
    fn functions_have_known_values() {
        assert_eq!(Precise::pi().to_f64(), std::f64::consts::PI);
        assert_eq!(
            (Precise::new(1.0).atan() * 4.0).to_f64(),
            std::f64::consts::PI
        );
        assert_eq!(Precise::new(1.0).exp().to_f64(), std::f64::consts::E);
        assert_eq!(Precise::new(2.0).ln().to_f64(), std::f64::consts::LN_2);
        assert_eq!(Precise::new(2.0).sqrt().to_f64(), std::f64::consts::SQRT_2);
        let (sin, cos) = (Precise::new(1e6).sin(), Precise::new(1e6).cos());
        assert!((sin.squared() + cos.squared() - 1.0).abs().to_f64() < 1e-50);
        assert!((Precise::new(0.3).sin().asin() - 0.3).abs().to_f64() < 1e-50);
    }
}
