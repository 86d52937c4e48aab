//! Quantisation of the measured rotation.

use nalgebra::Vector2;

use crate::{InvalidSensor, Stream};

/// Joint encoders that count steps: a roll begins anywhere within a step, so the same rotation may count one step more or
/// less in the next roll.
///
/// ```
/// use nalgebra::Vector2;
/// use palpate_sensing::{Channel, Encoder, Stream};
///
/// let encoder = Encoder::new(0.25)?;
/// let mut stream = Stream::new(1, 0, Channel::EncoderPhase);
/// let read = encoder.read(&mut stream, &Vector2::new(0.7, 0.0));
/// // Two or three steps; a joint that does not turn counts none.
/// assert!((read.x == 0.5 || read.x == 0.75) && read.y == 0.0);
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

    /// The rotation that the encoders count during a roll by `rotation`, rad: each component between a start anywhere
    /// within a step and the end. It errs by less than a step, and by nothing on average.
    pub fn read(&self, stream: &mut Stream, rotation: &Vector2<f64>) -> Vector2<f64> {
        rotation.map(|angle| {
            let start = 0.5 * stream.symmetric_uniform();
            let counted = (angle / self.step_rad + start).round() * self.step_rad;
            // A step too fine to count in doubles quantises nothing.
            if counted.is_finite() { counted } else { angle }
        })
    }

    /// Standard deviation of the error of a component, rad: uniform over a step at the start and at the end.
    pub fn std_rad(&self) -> f64 {
        self.step_rad / 6.0_f64.sqrt()
    }
}
