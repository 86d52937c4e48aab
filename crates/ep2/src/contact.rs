//! Contacts that gliding fingers report.

use nalgebra::{Point3, Vector3};

/// One contact of a finger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Number of the finger; the contacts of a finger stand in the order in which it made them.
    pub finger: usize,
    /// Place where it touched, length.
    pub position: Point3<f64>,
    /// The sensed normal, out of the object, of any length; all contacts have one, or none has.
    pub normal: Option<Vector3<f64>>,
    /// Weight of the contact relative to the others, an inverse variance; finite and > 0, usually 1.
    pub weight: f64,
}

impl Contact {
    /// A contact of weight 1.
    pub const fn new(finger: usize, position: Point3<f64>, normal: Option<Vector3<f64>>) -> Self {
        Self {
            finger,
            position,
            normal,
            weight: 1.0,
        }
    }
}
