//! Readings of a press.

use crate::Markers;

/// The readings of one press.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// Markers, with their places under the skin.
    pub markers: &'a Markers,
    /// Inward displacement of each, length.
    pub normal: &'a [f64],
    /// Displacement of each along the skin, in the marker's axes, if it is sensed. Length.
    pub tangential: Option<&'a [[f64; 2]]>,
    /// The indentation, if something else tells it (a robot's pose).
    pub indentation: Option<Measured>,
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Its standard deviation; 0 for exact.
    pub std: f64,
}
