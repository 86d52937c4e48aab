//! Values of one quantity at several places, which are processed together.

use std::array;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// Number of places.
pub(crate) const LANES: usize = 2;

/// Values at several places. The compiler translates operations on them to vector instructions (SIMD).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(16))]
pub(crate) struct Lanes([f64; LANES]);

impl Lanes {
    pub(crate) const ZERO: Self = Self::splat(0.0);
    pub(crate) const ONE: Self = Self::splat(1.0);

    /// The same value at all places.
    #[inline(always)]
    pub(crate) const fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub(crate) const fn to_array(self) -> [f64; LANES] {
        self.0
    }

    #[inline(always)]
    pub(crate) fn map(self, function: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(function))
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    pub(crate) fn zip(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        Self(array::from_fn(|lane| function(self.0[lane], other.0[lane])))
    }
}

impl From<[f64; LANES]> for Lanes {
    #[inline(always)]
    fn from(values: [f64; LANES]) -> Self {
        Self(values)
    }
}

impl From<f64> for Lanes {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self::splat(value)
    }
}

impl Neg for Lanes {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(f64::neg)
    }
}

/// Implements an operator for two [`Lanes`], and for [`Lanes`] and a number that is the same at all places.
macro_rules! operators {
    ($($operator:ident $function:ident),*) => {
        $(impl<T: Into<Lanes>> $operator<T> for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: T) -> Self {
                self.zip(other.into(), f64::$function)
            }
        })*
    };
}

macro_rules! assignments {
    ($($operator:ident $function:ident $plain:ident),*) => {
        $(impl $operator for Lanes {
            #[inline(always)]
            fn $function(&mut self, other: Self) {
                *self = self.zip(other, f64::$plain);
            }
        })*
    };
}

operators!(Add add, Sub sub, Mul mul, Div div);
assignments!(AddAssign add_assign add, SubAssign sub_assign sub, MulAssign mul_assign mul);
