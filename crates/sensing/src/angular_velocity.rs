//! Error of the angular velocity.

use nalgebra::Vector2;

use crate::{Distribution, InvalidSensor, Stream};

/// An independent error on each of ω_x and ω_y, proportional to the rate of rotation (1996 paper,
/// section 4.1.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularVelocityError {
    distribution: Distribution,
    fraction: f64,
}

impl AngularVelocityError {
    /// An error whose size is `fraction` of |ω|.
    ///
    /// # Errors
    /// [`InvalidSensor`] unless the fraction is from 0 to 10¹⁵⁰.
    pub fn new(distribution: Distribution, fraction: f64) -> Result<Self, InvalidSensor> {
        let holds = (0.0..=1e150).contains(&fraction);
        InvalidSensor::unless(holds, "fraction", fraction, "from 0 to 1e150")?;
        Ok(Self {
            distribution,
            fraction,
        })
    }

    /// Distribution of the error.
    pub const fn distribution(&self) -> Distribution {
        self.distribution
    }

    /// The size, as a fraction of |ω|.
    pub const fn fraction(&self) -> f64 {
        self.fraction
    }

    /// Standard deviation of each component, as a fraction of |ω|.
    pub fn relative_std(&self) -> f64 {
        self.distribution.std(self.fraction)
    }

    /// Draws the errors of `(ω_x, ω_y)`, for a rate |ω| in rad/s, finite for rates up to 1e150.
    #[inline]
    pub fn draw(&self, stream: &mut Stream, rate_rad_per_s: f64) -> Vector2<f64> {
        let size = self.fraction * rate_rad_per_s;
        Vector2::new(
            self.distribution.draw(stream),
            self.distribution.draw(stream),
        ) * size
    }
}
