//! Doubts about an estimate: ways in which readings contradict the model that was fitted to them.

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
    /// Displacements depend on the distance from the contact otherwise than in this body: it has another thickness or none,
    /// markers at another depth, a gain or an offset.
    OtherBody {
        /// Probability of a dependence as strong where the model holds.
        p_value: f64,
    },
    /// Displacements depend on the direction from the contact: an edge, a cylinder or a saddle pressed, not a ball.
    NotRound {
        /// Probability of a dependence as strong where the model holds.
        p_value: f64,
    },
    /// The given indentation is not the one that the displacements tell.
    OtherIndentation {
        /// Probability of a difference as large where the model holds.
        p_value: f64,
    },
    /// One marker contradicts the others, by too little to be left out.
    SlippedMarker {
        /// Number of the marker, counted from 0.
        marker: usize,
        /// Probability that one of all markers contradicts the others as much where the model holds.
        p_value: f64,
    },
}

impl Doubt {
    /// Probability with which each doubt arises where the model holds.
    pub const LEVEL: f64 = palpate_statistics::SIGNIFICANCE_LEVEL;

    /// Probability by chance of all that depends on distance and direction together, or of presses in a row, below which the
    /// likeliest cause is told.
    pub const LEVEL_OF_ALL: f64 = palpate_statistics::SIGNIFICANCE_LEVEL_OF_ALL;

    /// Doubts where only the size of the residuals can be tested.
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
        match self {
            Self::LargeResiduals { .. } => {
                write!(
                    f,
                    "the residuals are larger than the stated noise makes them"
                )
            }
            Self::OtherBody { .. } => write!(
                f,
                "the displacements fall off with the distance from the contact otherwise than in this body: its kind, its \
                 thickness, the depth of the markers or the scale of the displacements is another"
            ),
            Self::NotRound { .. } => write!(
                f,
                "the displacements depend on the direction from the contact: this is not the press of a ball, but of an edge, \
                 a cylinder or a saddle"
            ),
            Self::OtherIndentation { .. } => write!(
                f,
                "the stated indentation is not the one that the displacements tell"
            ),
            Self::SlippedMarker { marker, .. } => write!(
                f,
                "marker {marker} (counting from 0) contradicts the others"
            ),
        }?;
        write!(
            f,
            " (chance does as much in {} of presses)",
            Percent(self.p_value())
        )
    }
}
