//! Random numbers for the noise of readings.

use nalgebra::Vector2;
use palpate_ep1::{ProbeReading, ReadingNoise};

/// A simple linear congruential generator, which is sufficient for these tests.
pub(crate) struct Draws(pub(crate) u64);

impl Draws {
    /// A random number, uniformly distributed between 0 and 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The sum of twelve uniform numbers minus six, which is nearly normal with variance 1.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// Adds Gaussian noise to the readings, and returns them.
    pub(crate) fn noisy(
        &mut self,
        exact: &[ProbeReading],
        noise: &ReadingNoise,
    ) -> Vec<ProbeReading> {
        let noisy = exact.iter().map(|reading| {
            let rotation_std = libm::hypot(
                noise.relative_rotation_std * reading.rotation.norm(),
                noise.rotation_std_rad,
            );
            ProbeReading {
                rotation: reading.rotation + self.pair() * rotation_std,
                shift: reading.shift + self.pair() * noise.shift_std,
            }
        });
        noisy.collect()
    }

    fn pair(&mut self) -> Vector2<f64> {
        Vector2::new(self.normal(), self.normal())
    }
}
