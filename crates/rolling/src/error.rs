//! Errors that end a roll early.

use nalgebra::Point3;
use palpate_geometry::SurfaceError;
use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Reasons for which a roll ends early.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum RollFault {
    /// The relative curvature is singular or indefinite: the object is at least as hollow as the probe is round, so
    /// there is no single point of contact.
    #[error(
        "the bodies conform: the smallest relative curvature is {relative_curvature}",
        relative_curvature = Number(*relative_curvature)
    )]
    Conforming {
        /// The smaller eigenvalue of `K₁ + K̃₂`, 1/length.
        relative_curvature: f64,
    },
    /// A part of the object beside the contact reaches into the probe. [`RollError::on_object`] is then the deepest
    /// point of the overlap instead of the last contact.
    #[error("the probe overlaps the object by {depth}", depth = Number::rounded(*depth))]
    Overlapping {
        /// Depth of the overlap, length.
        depth: f64,
    },
    /// The contact left the object's domain.
    #[error("the contact left the object: {0}")]
    #[strum(transparent)]
    Surface(#[from] SurfaceError),
    /// The integrator reached its largest number of steps.
    #[error("the integration needs more than {steps} steps")]
    TooManySteps {
        /// Number of steps, including rejected ones.
        steps: usize,
    },
    /// The integrator's step became too short: the motion is singular here.
    #[error("the motion is singular")]
    Singular,
    /// A number overflowed or is NaN.
    #[error("the motion is outside the range of numbers")]
    NotFinite,
}

/// A roll that ended early: why, when and where.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("{fault}, {time_s} s into the motion{}", place(on_object), time_s = Number(*time_s))]
pub struct RollError {
    /// Reason for which the roll ended.
    pub fault: RollFault,
    /// Time since the motion began.
    pub time_s: f64,
    /// The last contact on the object, or the deepest point of an overlap, in the object's frame.
    pub on_object: Point3<f64>,
}

/// Text of a place for the message; a remark if its coordinates are not finite.
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

impl RollFault {
    /// The stable name of this kind of fault.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}
