//! Errors of contacts that do not determine the shape of a patch.

use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Largest number whose square does not overflow; the square of its inverse does not vanish.
pub(crate) const LARGEST: f64 = 1e150;

/// Reasons why a set of contacts does not determine a surface.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum Ep2Error {
    /// Fewer contacts than the method has unknowns to find.
    #[error(
        "{contacts} contact(s) give {equations} equation(s); the method needs at least 3 contacts and {needed} equations"
    )]
    TooFewContacts {
        /// Number of contacts.
        contacts: usize,
        /// Number of equations: one for each contact, three where it has a normal.
        equations: usize,
        /// Number of equations needed.
        needed: usize,
    },
    /// A coordinate, a normal or a weight is not a finite number, or too large to be squared.
    #[error("contact {contact} (counting from 0): a number is not finite, or beyond 1e150")]
    NotFinite {
        /// Number of the contact, counted from 0.
        contact: usize,
    },
    /// A weight that weighs nothing.
    #[error(
        "contact {contact} (counting from 0): the weight is {weight}; it must be > 0",
        weight = Number(*weight)
    )]
    BadWeight {
        /// Number of the contact, counted from 0.
        contact: usize,
        /// Its weight.
        weight: f64,
    },
    /// A normal of no length, or of one too small to have a direction.
    #[error(
        "contact {contact} (counting from 0): the normal has no direction: its largest component is {length}",
        length = Number(*length)
    )]
    BadNormal {
        /// Number of the contact, counted from 0.
        contact: usize,
        /// Its largest component.
        length: f64,
    },
    /// Some contacts have a normal and some have none.
    #[error("contact {contact} (counting from 0) has no normal, but others have one")]
    MissingNormal {
        /// The first without one.
        contact: usize,
    },
    /// All contacts lie on one point.
    #[error("all {contacts} contacts lie on one point, within {}", Number::rounded(*extent))]
    Coincident {
        /// Number of contacts.
        contacts: usize,
        /// Largest distance of a coordinate from the mean contact, length.
        extent: f64,
    },
    /// All contacts lie on one line, so they do not determine the shape across it.
    #[error(
        "all {contacts} contacts lie on a line: across it they spread {} times as far as along it",
        Number::rounded(*spread)
    )]
    Collinear {
        /// Number of contacts.
        contacts: usize,
        /// Root-mean-square spread across the line over that along it.
        spread: f64,
    },
    /// The patch is not a graph over the plane of its mean normal (or, without normals, through its points).
    #[error(
        "the patch is not a graph over its mean plane: at contact {contact} (counting from 0) the \
         normal stands {angle_deg:.1} degrees from the mean normal, more than 85; split the patch"
    )]
    Folded {
        /// The contact that stands out most.
        contact: usize,
        /// Angle between its normal and the mean normal, degrees.
        angle_deg: f64,
    },
    /// The points spread as far in all directions: a closed shape has no mean plane.
    #[error(
        "the contacts have no mean plane: across it they would spread {spread:.2} times as far as \
         along it; split the patch, or give normals"
    )]
    NoPlane {
        /// Root-mean-square spread across the plane over the smaller one within it; or, from
        /// normals, one minus the length of their mean.
        spread: f64,
    },
    /// The outward direction lies in the patch's plane and fixes no side of it.
    #[error(
        "the outward direction lies in the patch's plane (within {} degrees): it does not tell the outside",
        Number::rounded(*angle_deg)
    )]
    NoSide {
        /// Angle between the direction and the plane, degrees.
        angle_deg: f64,
    },
    /// The tip is too large for the path of its centre: no object makes it turn so sharply.
    #[error(
        "the tip's centre turns as on a ball of radius {turns:.6}, which a tip of radius \
         {tip_radius} on an object cannot; is the radius too large, or is it the contact that is told?",
        turns = Number(*turns), tip_radius = Number(*tip_radius)
    )]
    TipTooLarge {
        /// Radius of the tip, length.
        tip_radius: f64,
        /// Radius of curvature of the surface on which the tip's centre moves, length.
        turns: f64,
    },
    /// The contacts do not determine the unknowns of the method.
    #[error(
        "the {contacts} contacts do not determine the surface: {rank} of its {unknowns} unknowns \
         are fixed"
    )]
    Undetermined {
        /// Number of contacts.
        contacts: usize,
        /// Number of independent combinations of unknowns that are determined.
        rank: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A setting of a method is out of its range.
    #[error(transparent)]
    BadSetting(#[from] BadSetting),
    /// The numbers leave the range of doubles.
    #[error("the contacts are too large, too small or too steep to be worked with")]
    OutOfRange,
}

impl Ep2Error {
    /// [`Ep2Error::BadSetting`] unless the setting is good.
    pub(crate) fn unless_good(
        setting: &'static str,
        value: f64,
        is_good: bool,
        expected: &'static str,
    ) -> Result<(), Self> {
        BadSetting::unless(is_good, setting, value, expected)?;
        Ok(())
    }

    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}
