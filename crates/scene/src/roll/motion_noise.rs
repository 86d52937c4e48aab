//! Error of the angular velocity of a probe. It is an error of the motion or of the measurement.

use nalgebra::Vector2;
use palpate_rolling::{Motion, RollError, Roller, Terrain};
use palpate_sensing::{AngularVelocityError, Channel, Distribution, Stream};
use palpate_study::config::Side;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotionNoise {
    pub(super) error: AngularVelocityError,
    pub(super) instants: u32,
    /// Whether the motion or the measurement has the error. `Motion`: the probe moves with the error, and the sensor
    /// reports the commanded rotation. `Measurement`: the probe moves as commanded, and the reported rotation has the
    /// error.
    pub(super) side: Side,
}

#[derive(Clone, Debug)]
pub(super) struct Roll {
    pub(super) command: Motion,
    /// Rotation of the probe over the whole roll, summed in the contact frame, rad.
    pub(super) rotation: Vector2<f64>,
    pub(super) displacement: Vector2<f64>,
    /// Terrain (height of the object) along the roll. `None` if the probe cannot overlap the object, even with noise.
    pub(super) terrain: Option<Terrain>,
}

pub(super) struct NoiseTrial(Option<(MotionNoise, Stream)>);

impl MotionNoise {
    pub(super) fn is_of_motion(&self) -> bool {
        self.side == Side::Motion
    }

    /// Number of pieces into which a roll's motion is divided, because each piece has its own error. It is 1 if the
    /// noise is an error of the measurement.
    pub(super) const fn pieces(&self) -> u32 {
        match self.side {
            Side::Motion => self.instants,
            Side::Measurement => 1,
        }
    }

    /// Upper bound on the distance (length) by which noise moves a probe's centre away from its commanded position. The
    /// probe has the radius `radius` and rolls by `rotation` (rad). The bound is the largest possible distance, but at
    /// most six standard deviations of the distance.
    pub(super) fn stray(&self, radius: f64, rotation: &Vector2<f64>) -> f64 {
        if self.side == Side::Measurement {
            return 0.0;
        }
        let bound = match self.error.distribution {
            Distribution::Uniform => self.error.fraction(),
            Distribution::Gaussian => f64::INFINITY,
        };
        // The centre of the probe moves by the probe's radius times the rotation. The factor √2 accounts for the two
        // components of the noise, and the factor 2 for the curvature of the path on the object.
        let share = 2.0 * std::f64::consts::SQRT_2 * bound.min(6.0 * self.relative_rotation_std());
        share * radius * rotation.norm()
    }

    /// Standard deviation of each component of a probe's rotation, summed over a roll, as a share of the rotation's
    /// magnitude.
    pub(super) fn relative_rotation_std(&self) -> f64 {
        self.error.relative_std() / f64::from(self.instants).sqrt()
    }

    pub(super) fn need(&self) -> String {
        let side = match self.side {
            Side::Motion => "noisy motion; the command is reported",
            Side::Measurement => "exact motion; a noisy measurement is reported",
        };
        let when = match self.instants {
            1 => "once per probe".to_owned(),
            instants => format!("at {instants} instants"),
        };
        let percent = 100.0 * self.error.fraction();
        format!("angular velocity noise of {percent} % {when}: {side}")
    }
}

impl NoiseTrial {
    #[inline]
    pub(super) fn new(noise: Option<MotionNoise>, seed: u64, trial: Option<u64>) -> Self {
        let stream = |trial| Stream::new(seed, trial, Channel::AngularVelocity);
        Self(noise.zip(trial.map(stream)))
    }

    /// Displacement of the contact on a probe, and the rotation that the sensor reports. The reported rotation has an
    /// error only if the noise is an error of the measurement.
    #[inline]
    pub(super) fn roll(
        &mut self,
        roller: &Roller,
        roll: &Roll,
    ) -> Result<(Vector2<f64>, Vector2<f64>), RollError> {
        let (command, terrain) = (&roll.command, &roll.terrain);
        let displacement = match self.of_side(Side::Motion) {
            None => roll.displacement,
            Some((noise, stream)) if noise.instants == 1 => {
                let motion = [disturbed(command, &noise.error, stream)];
                cleared_shift(roller, &motion, terrain)?
            }
            Some(_) => cleared_shift(roller, &self.motions(command), terrain)?,
        };
        Ok((displacement, self.rotation(roll)))
    }

    /// Rotation that the sensor reports for a roll. It has an error only if the noise is an error of the measurement.
    #[inline]
    pub(super) fn rotation(&mut self, roll: &Roll) -> Vector2<f64> {
        let Some((noise, stream)) = self.of_side(Side::Measurement) else {
            return roll.rotation;
        };
        let (rate, duration_s) = (
            roll.command.angular_velocity.norm(),
            roll.command.duration_s,
        );
        let sum: Vector2<f64> = (0..noise.instants)
            .map(|_| noise.error.draw(stream, rate))
            .sum();
        roll.rotation + sum * (duration_s / f64::from(noise.instants))
    }

    #[inline]
    fn of_side(&mut self, side: Side) -> Option<&mut (MotionNoise, Stream)> {
        self.0.as_mut().filter(|(noise, _)| noise.side == side)
    }

    /// Errors of the measured rotation (rad) at the given fractions of a roll. The errors are 0 if the noise is an
    /// error of the motion.
    pub(super) fn measured(&mut self, command: &Motion, fractions: &[f64]) -> Vec<Vector2<f64>> {
        let Some((noise, stream)) = self.of_side(Side::Measurement) else {
            return vec![Vector2::zeros(); fractions.len()];
        };
        let rate = command.angular_velocity.norm();
        let pieces = f64::from(noise.instants);
        let mut sums = vec![Vector2::zeros()];
        for _ in 0..noise.instants {
            let last = sums[sums.len() - 1];
            sums.push(last + noise.error.draw(stream, rate) * (command.duration_s / pieces));
        }
        let at = |fraction: &f64| {
            let piece = (fraction * pieces).clamp(0.0, pieces);
            let before = (piece as usize).min(sums.len() - 2);
            sums[before] + (sums[before + 1] - sums[before]) * (piece - before as f64)
        };
        fractions.iter().map(at).collect()
    }

    pub(super) fn motions(&mut self, command: &Motion) -> Vec<Motion> {
        let Some((noise, stream)) = self.of_side(Side::Motion) else {
            return vec![*command];
        };
        let piece = lasting(command, command.duration_s / f64::from(noise.instants));
        (0..noise.instants)
            .map(|_| disturbed(&piece, &noise.error, stream))
            .collect()
    }
}

/// The same motion with another duration (s).
pub(super) fn lasting(motion: &Motion, duration_s: f64) -> Motion {
    Motion {
        duration_s,
        ..*motion
    }
}

/// Displacement of the contact on a probe. Returns an error if the probe overlaps the terrain, which would be a second
/// contact.
#[inline]
fn cleared_shift(
    roller: &Roller,
    motions: &[Motion],
    terrain: &Option<Terrain>,
) -> Result<Vector2<f64>, RollError> {
    if let Some(terrain) = terrain {
        roller.clearance(motions, terrain, 0.0)?;
    }
    Ok(roller.shift(motions)?.displacement)
}

#[inline]
fn disturbed(command: &Motion, error: &AngularVelocityError, stream: &mut Stream) -> Motion {
    let draw = error.draw(stream, command.angular_velocity.norm());
    let mut motion = *command;
    motion.angular_velocity.x += draw.x;
    motion.angular_velocity.y += draw.y;
    motion
}
