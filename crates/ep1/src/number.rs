//! Numbers of one set of readings, or of several side by side.

use std::ops::{Add, AddAssign, BitAnd, Div, Mul, Neg, Sub};

/// A type that the fit computes with: one number, or [`Lanes`] of them. On every processor a lane gives, to the last
/// bit, the result that a single number gives.
pub trait Number:
    Copy
    + Default
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A truth value: one for the number, or one for each lane.
    type Holds: Copy + BitAnd<Output = Self::Holds>;

    /// This number, in every lane.
    fn of(number: f64) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Absolute value.
    fn abs(self) -> Self;

    /// The larger; `other` where there is none.
    fn larger(self, other: Self) -> Self;

    /// Whether it is below `other`.
    fn is_below(self, other: Self) -> Self::Holds;

    /// Whether it holds in every lane.
    fn all(holds: Self::Holds) -> bool;
}

impl Number for f64 {
    type Holds = bool;

    #[inline(always)]
    fn of(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn is_below(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn all(holds: bool) -> bool {
        holds
    }
}

/// Number of sets of readings that are worked on side by side, with vector instructions.
pub const LANES: usize = 4;

/// A number of each of [`LANES`] sets of readings.
///
/// ```
/// use palpate_ep1::{Lanes, Number};
///
/// let areas = Lanes([1.0, 4.0, 9.0, 16.0]);
/// assert_eq!(areas.sqrt(), Lanes([1.0, 2.0, 3.0, 4.0]));
/// assert_eq!(areas + Lanes::of(1.0), Lanes([2.0, 5.0, 10.0, 17.0]));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes(pub [f64; LANES]);

/// Whether something holds in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LanesHold([bool; LANES]);

// Written out: iterators over lanes are not reliably turned into vector instructions.
impl Lanes {
    #[inline(always)]
    fn each(self, of: impl Fn(f64) -> f64) -> Self {
        let [a, b, c, d] = self.0;
        Self([of(a), of(b), of(c), of(d)])
    }

    #[inline(always)]
    fn with<T>(self, other: Self, of: impl Fn(f64, f64) -> T) -> [T; LANES] {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        [of(a, e), of(b, f), of(c, g), of(d, h)]
    }
}

impl BitAnd for LanesHold {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        Self([a & e, b & f, c & g, d & h])
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident $function:ident),*) => {$(
        impl $operator for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(self.with(other, f64::$function))
            }
        }
    )*};
}

lane_by_lane!(Add add, Sub sub, Mul mul, Div div);

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for Lanes {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.each(f64::neg)
    }
}

impl Number for Lanes {
    type Holds = LanesHold;

    #[inline(always)]
    fn of(number: f64) -> Self {
        Self([number; LANES])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.each(f64::sqrt)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.each(f64::abs)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(self.with(other, Number::larger))
    }

    #[inline(always)]
    fn is_below(self, other: Self) -> LanesHold {
        LanesHold(self.with(other, |own, other| own < other))
    }

    #[inline(always)]
    fn all(holds: LanesHold) -> bool {
        // Not `&&`, which would take a branch for every lane.
        let [a, b, c, d] = holds.0;
        a & b & c & d
    }
}
