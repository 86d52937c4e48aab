//! Doubts about an estimate: ways in which readings contradict the model that was fitted to them.

use std::fmt;

use palpate_statistics::Percent;
use strum::{IntoStaticStr, VariantNames};

/// Way in which readings contradict the model `Δp = B g` of rolls. Where the model holds each arises by chance in
/// [`Doubt::LEVEL`] of all sets of rolls, and the likeliest of the first ones where all together are as unlikely as
/// [`Doubt::LEVEL_OF_ALL`].
///
/// A wrong gain of all shifts or rotations, or a wrong radius of the probe, makes none of these: no reading tells it from
/// another curvature. Nor does a third power of the rotations that is the same in all directions.
#[derive(Clone, Copy, Debug, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum Doubt {
    /// The residuals are larger than the stated noise makes them.
    LargeResiduals {
        /// Probability of residuals as large where the model holds.
        p_value: f64,
    },
    /// All shifts have a part in common, which no rotation makes: a slip, a drift or a first contact that is off.
    CommonShift {
        /// Probability of a part as large where the model holds.
        p_value: f64,
    },
    /// Shifts are turned against the rotations, alike in all probes: the frames of both are not the same, or the probes spin.
    Twist {
        /// Probability of a turn as large where the model holds.
        p_value: f64,
    },
    /// Shifts depend on squares or third powers of the rotations: the curvature changes along the rolls.
    VaryingCurvature {
        /// Probability of a dependence as strong where the model holds.
        p_value: f64,
    },
    /// One probe contradicts the others.
    SlippedProbe {
        /// Number of the probe, counted from 0.
        probe: usize,
        /// Probability that one of all probes contradicts the others as much where the model holds.
        p_value: f64,
    },
}

impl Doubt {
    /// Probability with which each doubt arises where the model holds.
    pub const LEVEL: f64 = palpate_statistics::SIGNIFICANCE_LEVEL;

    /// Probability by chance of all patterns together, below which the likeliest cause is told.
    pub const LEVEL_OF_ALL: f64 = palpate_statistics::SIGNIFICANCE_LEVEL_OF_ALL;

    /// The stable name.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Probability of readings that contradict the model as much in this way where it holds.
    pub const fn p_value(self) -> f64 {
        match self {
            Self::LargeResiduals { p_value }
            | Self::CommonShift { p_value }
            | Self::Twist { p_value }
            | Self::VaryingCurvature { p_value }
            | Self::SlippedProbe { p_value, .. } => p_value,
        }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LargeResiduals { .. } => write!(
                f,
                "the residuals are larger than the stated noise makes them"
            ),
            Self::CommonShift { .. } => write!(
                f,
                "all contacts moved by a part in common, which no rotation makes: the probes slipped or drifted, or their \
                 first contacts are off"
            ),
            Self::Twist { .. } => write!(
                f,
                "the contacts moved askew to the rotations, alike in all probes: the frames of shifts and rotations are \
                 turned against each other, or the probes spin"
            ),
            Self::VaryingCurvature { .. } => write!(
                f,
                "the shifts are not in proportion to the rotations: the rolls are too long for the object, whose curvature \
                 changes along them"
            ),
            Self::SlippedProbe { probe, .. } => {
                write!(f, "probe {probe} (counting from 0) contradicts the others")
            }
        }?;
        write!(
            f,
            " (chance does as much in {} of rolls)",
            Percent(self.p_value())
        )
    }
}
