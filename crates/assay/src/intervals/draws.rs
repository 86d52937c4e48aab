//! Draws by which scenes are made.

use palpate_sensing::{Channel, Stream};

/// Numbers that are uniform between limits.
pub(super) struct Draws(Stream);

impl Draws {
    /// Draws of the scene of this number.
    pub(super) fn new(seed: u64, index: u64, channel: Channel) -> Self {
        Self(Stream::new(seed, index, channel))
    }

    pub(super) fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + 0.5 * (high - low) * (1.0 + self.0.symmetric_uniform())
    }

    /// A number whose logarithm is uniform.
    pub(super) fn log_between(&mut self, limits: [f64; 2]) -> f64 {
        libm::exp(self.between(limits.map(libm::log)))
    }
}
