//! How much is asked of intervals.

/// How much is asked.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Seed of the scenes and the noise.
    pub seed: u64,
    /// Number of scenes of each case: of EP2 surfaces, of which every fifth is a ball.
    pub scenes: u64,
    /// Number of trials of each scene.
    pub trials: u64,
    /// Only cases whose names hold each of these words.
    pub only: &'a str,
}
