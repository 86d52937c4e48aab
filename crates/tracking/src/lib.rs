//! Frames of a camera that watches colour markers, to the markers' displacements. Knows nothing of how frames come about.

mod marker;

pub use marker::{Change, Marker, Status, Track};
