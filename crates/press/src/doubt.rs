//! Warnings about an estimate: ways in which the readings contradict the fitted model.

use std::fmt;

use palpate_statistics::{GoodnessOfFit, Percent};
use strum::{IntoStaticStr, VariantNames};

/// Way in which readings contradict the model of a press. Where the model holds each arises by chance in
/// [`Doubt::LEVEL`] of all presses, and the likeliest of `OtherIndentation`, `OtherBody` and `NotRound` where these
/// together, or presses in a row as of an edge, are as unlikely as [`Doubt::LEVEL_OF_ALL`].
///
/// A wrong gain of all displacements makes none of these where the indentation is fitted: no reading tells it from another
/// curvature and indentation.
#[derive(Clone, Copy, Debug, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum Doubt {
    /// The residuals are larger than the stated noise makes them.
    LargeResiduals {
        /// Probability of residuals as large where the model holds.
        p_value: f64,
    },
    /// The displacements do not depend on the distance from the contact as in this body: the thickness or the depth of the
    /// markers is different, or the displacements have a gain or an offset.
    OtherBody {
        /// Probability of a dependence as strong where the model holds.
        p_value: f64,
    },
    /// The displacements depend on the direction from the contact: the object is an edge, a cylinder or a saddle, not a ball.
    NotRound {
        /// Probability of a dependence as strong where the model holds.
        p_value: f64,
    },
    /// The stated indentation differs from that of the displacements.
    OtherIndentation {
        /// Probability of a difference as large where the model holds.
        p_value: f64,
    },
    /// One marker contradicts the others, but not enough for rejection.
    SlippedMarker {
        /// Number of the marker, counted from 0.
        marker: usize,
        /// Probability that one of all markers contradicts the others as much where the model holds.
        p_value: f64,
    },
}

impl Doubt {
    /// Probability of each doubt if the model holds.
    pub const LEVEL: f64 = palpate_statistics::SIGNIFICANCE_LEVEL;

    /// Probability by chance of all that depends on distance and direction together, or of presses in a row, below which the
    /// likeliest cause is told.
    pub const LEVEL_OF_ALL: f64 = palpate_statistics::SIGNIFICANCE_LEVEL_OF_ALL;

    /// Doubts if only the size of the residuals can be tested.
    pub(crate) fn of_size(goodness: Option<GoodnessOfFit>) -> Vec<Self> {
        let doubted = goodness.filter(|goodness| goodness.p_value < Self::LEVEL);
        let large = doubted.map(|GoodnessOfFit { p_value, .. }| Self::LargeResiduals { p_value });
        large.into_iter().collect()
    }

    /// The stable name.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Probability of readings that contradict the model as much in this way where it holds.
    pub const fn p_value(self) -> f64 {
        match self {
            Self::LargeResiduals { p_value }
            | Self::OtherBody { p_value }
            | Self::NotRound { p_value }
            | Self::OtherIndentation { p_value }
            | Self::SlippedMarker { p_value, .. } => p_value,
        }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::LargeResiduals { .. } => {
                "the residuals are larger than the stated noise makes them"
            }
            Self::OtherBody { .. } => {
                "the displacements fall off with the distance from the contact otherwise than in this body: its kind, its \
                 thickness, the depth of the markers or the scale of the displacements is another"
            }
            Self::NotRound { .. } => {
                "the displacements depend on the direction from the contact: this is not the press of a ball, but of an edge, \
                 a cylinder or a saddle"
            }
            Self::OtherIndentation { .. } => {
                "the stated indentation is not the one that the displacements tell"
            }
            Self::SlippedMarker { marker, .. } => {
                &format!("marker {marker} (counting from 0) contradicts the others")
            }
        };
        let share = Percent(self.p_value());
        write!(f, "{text} (chance does as much in {share} of presses)")
    }
}
