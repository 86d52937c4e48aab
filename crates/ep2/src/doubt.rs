//! Doubts about an estimate: ways in which contacts contradict the model that was fitted to them.

use std::fmt;

use palpate_statistics::{GoodnessOfFit, Percent};
use strum::{IntoStaticStr, VariantNames};

/// Agreement of contacts with the fit to them; of more than 2,000 contacts, with as many that are taken evenly.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Goodness of fit; `None` where the noise is found and not stated.
    pub goodness: Option<GoodnessOfFit>,
    /// Ways in which the contacts contradict the model; none where the noise is found of fewer than 10 contacts.
    pub doubts: Vec<Doubt>,
}

/// Way in which contacts contradict the model of a fit. Where the model holds each arises by chance in [`Doubt::LEVEL`] of
/// all glides, a stray contact in a tenth of that: one that matters is far off.
///
/// A wrong radius of round tips makes none of these: their lowest points and centres lie on a surface too, with the same
/// normals. Nor does a gain of all positions, or without normals one finger of three that is displaced.
#[derive(Clone, Copy, Debug, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum Doubt {
    /// The distances to the surface are larger than the stated noise makes them.
    LargeResiduals {
        /// Probability of distances as large where the model holds.
        p_value: f64,
    },
    /// The normals are those of another surface than the positions: their frame is turned, or a sign or column is wrong.
    ContradictingNormals {
        /// Probability of a difference as large where the model holds.
        p_value: f64,
    },
    /// One finger is displaced against the others.
    DisplacedFinger {
        /// Its number, as in its contacts.
        finger: usize,
        /// Probability that one of all fingers is displaced as far where the model holds.
        p_value: f64,
    },
    /// The surface that a quadric was fitted to is none: contacts depend on the place by third and fourth powers too.
    NotAQuadric {
        /// Probability of as much of these powers where the model holds.
        p_value: f64,
    },
    /// One contact contradicts the others.
    StrayContact {
        /// Its number, counted from 0.
        contact: usize,
        /// Probability that one of all contacts contradicts the others as much where the model holds.
        p_value: f64,
    },
}

impl Doubt {
    /// Probability with which each doubt arises where the model holds, but that of a stray contact.
    pub const LEVEL: f64 = palpate_statistics::SIGNIFICANCE_LEVEL;

    /// Probability with which this doubt arises where the model holds.
    pub const fn level(self) -> f64 {
        match self {
            Self::StrayContact { .. } => 0.1 * Self::LEVEL,
            _ => Self::LEVEL,
        }
    }

    /// The stable name.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Probability of contacts that contradict the model as much in this way where it holds.
    pub const fn p_value(self) -> f64 {
        match self {
            Self::LargeResiduals { p_value }
            | Self::ContradictingNormals { p_value }
            | Self::NotAQuadric { p_value }
            | Self::DisplacedFinger { p_value, .. }
            | Self::StrayContact { p_value, .. } => p_value,
        }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LargeResiduals { .. } => write!(
                f,
                "the contacts are farther from the fitted surface than the stated noise takes them"
            ),
            Self::ContradictingNormals { .. } => write!(
                f,
                "the normals are not those of the surface that the positions tell: is their frame turned, or a sign wrong?"
            ),
            Self::DisplacedFinger { finger, .. } => {
                write!(f, "finger {finger} is displaced against the others")
            }
            Self::NotAQuadric { .. } => write!(
                f,
                "the surface is no quadric: the curvature changes over the patch, and `quadric` states too little uncertainty"
            ),
            Self::StrayContact { contact, .. } => write!(
                f,
                "contact {contact} (counting from 0) contradicts the others"
            ),
        }?;
        write!(
            f,
            " (chance does as much in {} of glides)",
            Percent(self.p_value())
        )
    }
}
