//! How much is asked of intervals.

/// How much is asked.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Seed of the surfaces, the fingers' places and the noise.
    pub seed: u64,
    /// Number of surfaces of each case; every fifth is a ball.
    pub surfaces: u64,
    /// Number of trials on each surface.
    pub trials: u64,
    /// Only cases whose names hold each of these words.
    pub only: &'a str,
}
