//! A fingertip, its touch, and the reasons for which there is none.

use nalgebra::{Point3, Vector2, Vector3};
use palpate_geometry::{CurvatureForm, SurfaceError};
use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// The shape of a fingertip that glides over an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fingertip {
    /// A point.
    Point,
    /// A sphere.
    Sphere {
        /// Its radius.
        radius: f64,
    },
}

/// A contact of a fingertip, in the object's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The contact.
    pub point: Point3<f64>,
    /// The object's unit normal there, out of the object.
    pub normal: Vector3<f64>,
    /// The centre of the tip, `point + radius · normal`; of a point, the contact itself.
    pub tip_centre: Point3<f64>,
    /// The object's curvature there, in the orthonormal tangent basis along the level line and up
    /// the slope, right-handed with the normal: x and y where the ground is level.
    pub curvature: CurvatureForm,
}

/// Reasons for which a finger held at a place has no contact to report.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum GlideError {
    /// The contact would lie where the object is not defined; for a point, also beside a closed
    /// object.
    #[error("the finger left the object: {0}")]
    #[strum(transparent)]
    Surface(#[from] SurfaceError),
    /// The tip passes beside the object: the offset surface does not reach there, or only where the
    /// object's normal is horizontal.
    #[error(
        "a tip of radius {radius} at x = {x}, y = {y} passes beside the object",
        radius = Number(*radius), x = Number(*x), y = Number(*y)
    )]
    ContactLost {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
    },
    /// The tip rests on two places at once, or on a continuum of them: a dish, valley or hole
    /// that is as tight as the tip or tighter.
    #[error(
        "a tip of radius {radius} at x = {x}, y = {y} touches at more than one place",
        radius = Number(*radius), x = Number(*x), y = Number(*y)
    )]
    TwoContacts {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
    },
    /// The search for the contact came to no end: lengths too far apart for double precision, or an
    /// object too rough for the tip.
    #[error(
        "no contact found for a tip of radius {radius} at x = {x}, y = {y}: off by {miss}",
        radius = Number(*radius), x = Number(*x), y = Number(*y), miss = Number(*miss)
    )]
    NoConvergence {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
        /// Horizontal distance by which the best contact found misses.
        miss: f64,
    },
}

impl GlideError {
    pub(super) fn two(radius: f64, centre: &Vector2<f64>) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::TwoContacts { x, y, radius }
    }

    pub(super) fn unsettled(radius: f64, centre: &Vector2<f64>, miss: f64) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::NoConvergence { x, y, radius, miss }
    }

    pub(super) fn lost(radius: f64, centre: &Vector2<f64>) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::ContactLost { x, y, radius }
    }

    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}
