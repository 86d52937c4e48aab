//! Distributions of errors.

use crate::Stream;

/// The distribution of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Uniform; the stated size is the bound.
    Uniform,
    /// Gaussian; the stated size is the standard deviation.
    Gaussian,
}

impl Distribution {
    /// An error of size 1.
    #[inline(always)]
    pub fn draw(self, stream: &mut Stream) -> f64 {
        match self {
            Self::Uniform => stream.symmetric_uniform(),
            Self::Gaussian => stream.standard_normal(),
        }
    }

    /// Standard deviation of an error of this size.
    pub(crate) fn std(self, size: f64) -> f64 {
        match self {
            Self::Uniform => size / 3.0_f64.sqrt(),
            Self::Gaussian => size,
        }
    }
}
