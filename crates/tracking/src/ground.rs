//! Ground of a frame.

/// Background that markers are seen on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ground {
    /// Dark markers on a bright ground: they take light from it.
    Bright,
    /// Bright markers on a dark ground: they add light to it.
    Dark,
}
