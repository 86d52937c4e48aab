//! Random numbers for random scenes.

use palpate_sensing::Stream;

/// The random numbers of one scene.
pub(crate) struct Draws(pub(crate) Stream);

impl Draws {
    pub(crate) fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * (0.5 + 0.5 * self.0.symmetric_uniform())
    }

    /// A random number between `from` and `to`, uniform on a logarithmic scale.
    pub(crate) fn log_between(&mut self, from: f64, to: f64) -> f64 {
        libm::pow(10_f64, self.between(libm::log10(from), libm::log10(to)))
    }

    pub(crate) fn index(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }
}
