//! Forms of the contact equations.

use nalgebra::Point3;

use crate::integrator::System;
use crate::{Contact, RollFault};

/// The form of the contact equations that an integrator works on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Chart {
    /// Chart-free: no poles.
    #[default]
    Free,
    /// Montana's chart form, with the motion steady in the given frame.
    Montana(HeldAxis),
}

/// The frame in which a motion is steady.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HeldAxis {
    /// Parallel-transported along the path: "a fixed axis in the instantaneous contact frame".
    #[default]
    Transported,
    /// The Gauss frame of the probe's chart, which twists away from the poles of the path. The two
    /// agree along a line of symmetry.
    Chart,
}

impl Chart {
    /// The name of the form, in words that follow an integrator's.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Free => "chart-free",
            Self::Montana(_) => "in charts",
        }
    }
}

/// A form of the contact equations.
pub(crate) trait Form<const N: usize>: System<N> {
    fn contact(&self, state: &[f64; N]) -> Result<Contact, RollFault>;

    /// The contact on the object, also where there is no contact any more.
    fn place(&self, state: &[f64; N]) -> Option<Point3<f64>>;
}
