//! Quantisation of the measured rotation.

use nalgebra::Vector2;

use crate::InvalidSensor;

/// Joint encoders that report each component of the rotation to the nearest step.
///
/// ```
/// use nalgebra::Vector2;
/// use palpate_sensing::Encoder;
///
/// let encoder = Encoder::new(0.25)?;
/// assert_eq!(encoder.read(&Vector2::new(0.7, -0.1)), Vector2::new(0.75, 0.0));
/// // The error is uniform over a step.
/// assert!((encoder.std_rad() - 0.25 / 12.0_f64.sqrt()).abs() < 1e-15);
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
    /// [`InvalidSensor`] unless the step is finite and positive.
    pub fn new(step_rad: f64) -> Result<Self, InvalidSensor> {
        let holds = step_rad > 0.0 && step_rad.is_finite();
        InvalidSensor::unless(holds, "step_rad", step_rad, "finite and > 0")?;
        Ok(Self { step_rad })
    }

    /// The rotation that the encoders report, rad: each component to the nearest step.
    pub fn read(&self, rotation: &Vector2<f64>) -> Vector2<f64> {
        rotation.map(|angle| {
            let steps = (angle / self.step_rad).round() * self.step_rad;
            // A step too fine to count in doubles quantises nothing.
            if steps.is_finite() { steps } else { angle }
        })
    }

    /// Standard deviation of the quantisation error, rad.
    pub fn std_rad(&self) -> f64 {
        self.step_rad / 12.0_f64.sqrt()
    }
}
