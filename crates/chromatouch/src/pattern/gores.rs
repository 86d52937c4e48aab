//! Numbers of gores.

/// Least number of gores of a pattern.
pub const FEWEST_GORES: u32 = 3;

/// Largest number of gores of a pattern.
pub const MOST_GORES: u32 = 360;
