//! Errors of measured rotations: quantisation by encoders, and noise of the angular velocity.

use nalgebra::Vector2;
use palpate_statistics::BadSetting;

use crate::{Distribution, Stream};

/// Joint encoders, which round the rotation at the end of a roll to the nearest encoder step. The start of the roll has
/// no error. It lies between two encoder steps, at a random position that is different for every roll.
///
/// ```
/// use nalgebra::Vector2;
/// use palpate_sensing::{Channel, Encoder, Stream};
///
/// let encoder = Encoder::new(0.25)?;
/// let mut stream = Stream::new(1, 0, Channel::EncoderPhase);
/// let read = encoder.read(&mut stream, &Vector2::new(0.7, 0.0));
/// assert!((read.x - 0.7).abs() <= 0.125 && read.y.abs() <= 0.125);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    step_rad: f64,
}

impl Encoder {
    /// Encoders that count in steps of `step_rad`.
    ///
    /// # Errors
    /// [`BadSetting`] unless the step is finite and positive.
    pub fn new(step_rad: f64) -> Result<Self, BadSetting<String>> {
        let holds = step_rad > 0.0 && step_rad.is_finite();
        BadSetting::unless(holds, "step_rad", step_rad, "finite and > 0")?;
        Ok(Self { step_rad })
    }

    /// The rotation (rad) that the encoders report for a roll by `rotation`. The error of each component is uniform,
    /// at most half a step, and does not depend on the rotation.
    pub fn read(&self, stream: &mut Stream, rotation: &Vector2<f64>) -> Vector2<f64> {
        rotation.map(|angle| {
            let start = 0.5 * stream.symmetric_uniform();
            let reported = ((angle / self.step_rad + start).round() - start) * self.step_rad;
            // If the number of steps overflows, return the exact angle, because the steps are then extremely small.
            if reported.is_finite() {
                reported
            } else {
                angle
            }
        })
    }

    /// Standard deviation of the error of each component of a reported rotation (rad).
    pub fn std_rad(&self) -> f64 {
        self.step_rad / 12.0_f64.sqrt()
    }
}

/// Independent errors of the components ω_x and ω_y of the angular velocity, in proportion to the angular speed
/// (Charlebois, Gupta and Payandeh 1996, section 4.1.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularVelocityError {
    /// Distribution of the error of the angular velocity.
    pub distribution: Distribution,
    fraction: f64,
}

impl AngularVelocityError {
    /// An error in proportion to the angular speed |ω|. `fraction` is the bound (uniform) or the standard deviation
    /// (Gaussian) of the error, divided by |ω|.
    ///
    /// # Errors
    /// [`BadSetting`] unless the fraction is from 0 to 1e150.
    pub fn new(distribution: Distribution, fraction: f64) -> Result<Self, BadSetting<String>> {
        let holds = (0.0..=1e150).contains(&fraction);
        BadSetting::unless(holds, "fraction", fraction, "from 0 to 1e150")?;
        Ok(Self {
            distribution,
            fraction,
        })
    }

    /// Bound (uniform) or standard deviation (Gaussian) of the error of the angular velocity, divided by the angular
    /// speed |ω|.
    pub const fn fraction(&self) -> f64 {
        self.fraction
    }

    /// Standard deviation of the error of each component of the angular velocity, relative to the angular speed |ω|.
    pub fn relative_std(&self) -> f64 {
        self.distribution.std(self.fraction)
    }

    /// Draws the errors of the components `(ω_x, ω_y)` of the angular velocity for the angular speed `rate_rad_per_s`.
    /// The errors are finite for speeds up to 1e150 rad/s.
    #[inline]
    pub fn draw(&self, stream: &mut Stream, rate_rad_per_s: f64) -> Vector2<f64> {
        let size = self.fraction * rate_rad_per_s;
        Vector2::new(
            self.distribution.draw(stream),
            self.distribution.draw(stream),
        ) * size
    }
}
