//! Models by which the contact of a gliding fingertip is found.

use palpate_geometry::{InvalidShape, Shape};
use palpate_statistics::Number;
use thiserror::Error;

use super::closed_form::Offset;
use super::touch::Fingertip;
use crate::Model;

/// A model by which the contact of a fingertip is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TouchModel {
    /// The closed form where there is one, else Newton's method at this tolerance.
    Auto {
        /// Largest error of the contact's place, relative to the tip's radius: from
        /// [`Model::SMALLEST_TOLERANCE`] to [`Model::LARGEST_TOLERANCE`].
        tolerance: f64,
    },
    /// The closed form alone, which points have everywhere, and round tips on planes, spheres, dishes
    /// and cylinders.
    ClosedForm,
    /// Newton's method on the offset surface of a round tip.
    Newton {
        /// Largest error of the contact's place, relative to the tip's radius, in the same range as that of
        /// [`TouchModel::Auto`].
        tolerance: f64,
    },
}

impl Default for TouchModel {
    fn default() -> Self {
        Self::Auto {
            tolerance: Self::DEFAULT_TOLERANCE,
        }
    }
}

impl TouchModel {
    /// Default tolerance, relative to the tip's radius.
    pub const DEFAULT_TOLERANCE: f64 = 1e-12;
}

/// A glide that cannot be set up.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum InvalidTouch {
    /// No such fingertip.
    #[error("{0}")]
    Tip(#[from] InvalidShape),
    /// A rung was asked for that cannot do this.
    #[error("the {rung} rung cannot do this: {reason}")]
    Unsupported {
        /// Name of the rung.
        rung: &'static str,
        /// Reason for which the rung cannot, in words.
        reason: String,
    },
    /// A tolerance that means nothing.
    #[error(
        "tolerance is {tolerance}; it must be from {} to {}",
        Number(Model::SMALLEST_TOLERANCE),
        Number(Model::LARGEST_TOLERANCE),
        tolerance = Number(*tolerance)
    )]
    Tolerance {
        /// Its value.
        tolerance: f64,
    },
}

/// A way to find the contacts of round tips, ready to be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TouchRung {
    /// A point touches straight below.
    Point,
    Offset(Offset),
    Newton {
        radius: f64,
        tolerance: f64,
    },
}

impl TouchRung {
    pub(super) fn cheapest(object: &Shape, fingertip: Fingertip, tolerance: f64) -> Self {
        match fingertip {
            Fingertip::Point => Self::Point,
            Fingertip::Sphere { radius } => {
                let newton = Self::Newton { radius, tolerance };
                Offset::of(object, radius).map_or(newton, Self::Offset)
            }
        }
    }

    /// The rung that `model` takes.
    pub(super) fn of(
        model: TouchModel,
        object: &Shape,
        fingertip: Fingertip,
    ) -> Result<Self, InvalidTouch> {
        let unsupported = |rung, reason| Err(InvalidTouch::Unsupported { rung, reason });
        let tolerance = match model {
            TouchModel::Auto { tolerance } | TouchModel::Newton { tolerance } => tolerance,
            TouchModel::ClosedForm => TouchModel::DEFAULT_TOLERANCE,
        };
        if !(Model::SMALLEST_TOLERANCE..=Model::LARGEST_TOLERANCE).contains(&tolerance) {
            return Err(InvalidTouch::Tolerance { tolerance });
        }
        match (
            model,
            fingertip,
            Self::cheapest(object, fingertip, tolerance),
        ) {
            (TouchModel::ClosedForm, _, Self::Newton { .. }) => {
                let reason = format!("a round tip on a {} has no closed form", object.name());
                unsupported("closed form", reason)
            }
            (TouchModel::Newton { .. }, Fingertip::Point, _) => {
                unsupported("Newton", "a point touches straight below".to_owned())
            }
            (TouchModel::Newton { .. }, Fingertip::Sphere { radius }, _) => {
                Ok(Self::Newton { radius, tolerance })
            }
            (TouchModel::Auto { .. } | TouchModel::ClosedForm, _, cheapest) => Ok(cheapest),
        }
    }
}
