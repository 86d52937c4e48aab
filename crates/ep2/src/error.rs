//! Errors for contacts that do not determine the shape of a patch.

use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Largest allowed magnitude of a number in the contacts or the settings. Its square does not overflow, and the square
/// of its inverse does not underflow.
pub(crate) const LARGEST: f64 = 1e150;

/// Reasons for which a set of contacts does not determine a surface.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum Ep2Error {
    /// There are fewer equations from the contacts than the method has unknowns.
    #[error(
        "{contacts} contact(s) give {equations} equation(s); the method needs at least 3 contacts and {needed} equations"
    )]
    TooFewContacts {
        /// Number of contacts in the patch.
        contacts: usize,
        /// Number of equations: one per contact, or three per contact with a normal.
        equations: usize,
        /// Number of equations that the method needs.
        needed: usize,
    },
    /// A coordinate, a component of a normal or a weight is not finite, or its square would overflow.
    #[error("contact {contact} (counting from 0): a number is not finite, or beyond 1e150")]
    NotFinite {
        /// Index of the contact, counted from 0.
        contact: usize,
    },
    /// The weight of a contact is not above 0.
    #[error(
        "contact {contact} (counting from 0): the weight is {weight}; it must be > 0",
        weight = Number(*weight)
    )]
    BadWeight {
        /// Index of the contact, counted from 0.
        contact: usize,
        /// The weight of the contact, which is not above 0.
        weight: f64,
    },
    /// A normal is zero, or so short that it has no direction.
    #[error(
        "contact {contact} (counting from 0): the normal has no direction: its largest component is {length}",
        length = Number(*length)
    )]
    BadNormal {
        /// Index of the contact, counted from 0.
        contact: usize,
        /// Largest component of the normal, as an absolute value.
        length: f64,
    },
    /// Some contacts have a normal and some do not.
    #[error("contact {contact} (counting from 0) has no normal, but others have one")]
    MissingNormal {
        /// Index (from 0) of the first contact without a normal.
        contact: usize,
    },
    /// All contacts are at one point.
    #[error("all {contacts} contacts lie on one point, within {}", Number::rounded(*extent))]
    Coincident {
        /// Number of contacts in the patch.
        contacts: usize,
        /// Largest difference between a coordinate of a contact and the same coordinate of the mean contact (length).
        extent: f64,
    },
    /// All contacts are on one line, so they do not determine the shape across this line.
    #[error(
        "all {contacts} contacts lie on a line: their spread across it is {} times the spread \
         along it",
        Number::rounded(*spread)
    )]
    Collinear {
        /// Number of contacts in the patch.
        contacts: usize,
        /// Root-mean-square spread of the contacts across the line, divided by their spread along the line.
        spread: f64,
    },
    /// The patch is not a graph over its mean plane. This plane is perpendicular to the mean normal or, without
    /// normals, fitted to the contacts.
    #[error(
        "the patch is not a graph over its mean plane: at contact {contact} (counting from 0) the \
         angle between normal and mean normal is {angle_deg:.1} degrees, more than 85; split the \
         patch"
    )]
    Folded {
        /// Index (from 0) of the contact with the largest angle between its normal and the mean normal.
        contact: usize,
        /// Largest angle between the normal of a contact and the mean normal (degrees).
        angle_deg: f64,
    },
    /// The points spread almost equally in all directions, as on a closed shape, so they have no mean plane.
    #[error(
        "the contacts have no mean plane: their spread across it would be {spread:.2} times the \
         spread along it; split the patch, or state normals"
    )]
    NoPlane {
        /// Without normals: root-mean-square spread of the contacts across the plane, divided by their smaller spread
        /// within the plane. With normals: 1 minus the length of the mean of the unit normals.
        spread: f64,
    },
    /// The outward direction is nearly parallel to the patch's plane, so it does not determine which side of the plane
    /// is outside.
    #[error(
        "the outward direction lies in the patch's plane (within {} degrees), so it does not \
         determine the outer side",
        Number::rounded(*angle_deg)
    )]
    NoSide {
        /// Angle between the outward direction and the plane of the patch (degrees).
        angle_deg: f64,
    },
    /// The path of the tip's centre has a smaller radius of curvature than the tip. This is impossible on any object,
    /// so the stated radius of the tip is probably too large.
    #[error(
        "the path of the tip's centre has a radius of curvature of {turns:.6}, which is \
         impossible for a tip of radius {tip_radius} on an object; is the radius too large or \
         in another unit, or are the readings contact points?",
        turns = Number(*turns), tip_radius = Number(*tip_radius)
    )]
    TipTooLarge {
        /// Stated radius (length) of the tip.
        tip_radius: f64,
        /// Radius of curvature of the surface on which the tip's centre moves (length).
        turns: f64,
    },
    /// The contacts do not determine all unknowns of the method.
    #[error(
        "the {contacts} contacts do not determine the surface: only {rank} of its {unknowns} \
         unknowns are determined"
    )]
    Undetermined {
        /// Number of contacts.
        contacts: usize,
        /// Rank of the method's equations: the number of linearly independent combinations of the unknowns that the
        /// contacts determine.
        rank: usize,
        /// Number of unknowns of the method.
        unknowns: usize,
    },
    /// A setting of a method is out of its range.
    #[error(transparent)]
    BadSetting(#[from] BadSetting),
    /// A number in the contacts or in the computation is beyond the range of doubles.
    #[error("the contacts are too large, too small or too steep for double precision")]
    OutOfRange,
}

impl Ep2Error {
    pub(crate) fn unless_good(
        setting: &'static str,
        value: f64,
        is_good: bool,
        expected: &'static str,
    ) -> Result<(), Self> {
        BadSetting::unless(is_good, setting, value, expected)?;
        Ok(())
    }
}
