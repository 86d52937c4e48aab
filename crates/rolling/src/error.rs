//! Errors that end a roll early.

use nalgebra::Point3;
use palpate_geometry::SurfaceError;
use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Reasons why a roll ends early.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum RollFault {
    /// The relative curvature is singular or indefinite. The object is concave and at least as curved as the probe, so
    /// there is no single point of contact.
    #[error(
        "the bodies conform: the smallest relative curvature is {relative_curvature}; it must be \
         > 0",
        relative_curvature = Number(*relative_curvature)
    )]
    Conforming {
        /// The smaller eigenvalue of the relative curvature (1/length), which is the sum of the curvature forms of
        /// probe and object.
        relative_curvature: f64,
    },
    /// A part of the object beside the contact extends into the probe. [`RollError::on_object`] is then the deepest
    /// point of the overlap and not the last contact.
    #[error("the probe overlaps the object by {depth}", depth = Number::rounded(*depth))]
    Overlapping {
        /// Depth (length) of the overlap.
        depth: f64,
    },
    /// The contact has left the region in which the object's surface is defined.
    #[error("the contact left the object: {0}")]
    #[strum(transparent)]
    Surface(#[from] SurfaceError),
    /// The integrator has reached its maximum number of steps.
    #[error("the integration needs more than {steps} steps")]
    TooManySteps {
        /// Number of integration steps, including rejected steps.
        steps: usize,
    },
    /// The step of the integrator has become too short, because the contact equations are singular at this place.
    #[error("the motion is singular")]
    Singular,
    /// A number of the computation has overflowed or is NaN.
    #[error("a number of the motion is not finite")]
    NotFinite,
}

/// A roll that ended early: the reason, the time and the place.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("{fault}, {time_s} s into the motion{}", place(on_object), time_s = Number(*time_s))]
pub struct RollError {
    /// Reason why the roll ended.
    pub fault: RollFault,
    /// Time (s) from the start of the first motion to the end of the roll.
    pub time_s: f64,
    /// The last contact point on the object, or the deepest point of an overlap, in the object's frame.
    pub on_object: Point3<f64>,
}

/// The coordinates of a place as text for an error message, or a remark if they are not finite.
fn place(place: &Point3<f64>) -> String {
    let [x, y, z] = [place.x, place.y, place.z];
    match [x, y, z].iter().all(|one| one.is_finite()) {
        true => format!(" at ({}, {}, {})", Number(x), Number(y), Number(z)),
        false => ", beyond the range of numbers".to_owned(),
    }
}

impl RollError {
    pub(crate) const fn new(fault: RollFault, time_s: f64, on_object: Point3<f64>) -> Self {
        Self {
            fault,
            time_s,
            on_object,
        }
    }
}

impl RollFault {}
