//! Error of the angular velocity, in the motion or in its measurement.

use nalgebra::Vector2;
use palpate_rolling::{Motion, RollError, Roller, Terrain};
use palpate_sensing::{AngularVelocityError, Channel, Distribution, Stream};

/// Error of the angular velocity: in the motion, or in its measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MotionNoise {
    /// No error: nothing is drawn.
    None,
    /// The motion differs from the command; the command is reported.
    Motion {
        error: AngularVelocityError,
        instants: u32,
    },
    /// The probe moves as commanded; a noisy rotation is reported.
    Measurement {
        error: AngularVelocityError,
        instants: u32,
    },
}

/// The roll of one probe as commanded, without noise.
#[derive(Clone, Debug)]
pub(super) struct Roll {
    pub(super) command: Motion,
    /// The rotation, summed in the contact frame.
    pub(super) rotation: Vector2<f64>,
    /// The contact's displacement on the probe.
    pub(super) displacement: Vector2<f64>,
    /// The relief along the roll, if noise may move the probe into the object.
    pub(super) terrain: Option<Terrain>,
}

/// The noise of one trial.
pub(super) enum NoiseTrial {
    None,
    Motion {
        error: AngularVelocityError,
        instants: u32,
        stream: Stream,
    },
    Measurement {
        error: AngularVelocityError,
        instants: u32,
        stream: Stream,
    },
}

impl MotionNoise {
    pub(super) fn is_random(&self) -> bool {
        !matches!(self, Self::None)
    }

    /// Number of pieces into which noise cuts a roll.
    pub(super) fn pieces(&self) -> u32 {
        match self {
            Self::Motion { instants, .. } => *instants,
            Self::None | Self::Measurement { .. } => 1,
        }
    }

    /// Distance (length) by which noise moves the centre of a probe of `radius` away from a commanded roll by
    /// `rotation` (rad): the maximum for uniform noise, six standard deviations for Gaussian noise.
    pub(super) fn stray(&self, radius: f64, rotation: &Vector2<f64>) -> f64 {
        let Self::Motion { error, .. } = self else {
            return 0.0;
        };
        let bound = match error.distribution() {
            Distribution::Uniform => error.fraction(),
            Distribution::Gaussian => f64::INFINITY,
        };
        // The centre moves by the radius times the rotation. The factor √2 is for the two components of the noise,
        // the factor 2 for the curvature of the path on the object.
        let share = 2.0 * std::f64::consts::SQRT_2 * bound.min(6.0 * self.relative_rotation_std());
        share * radius * rotation.norm()
    }

    /// Standard deviation of each component of a summed rotation, as a fraction of its magnitude.
    pub(super) fn relative_rotation_std(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Motion { error, instants } | Self::Measurement { error, instants } => {
                error.relative_std() / f64::from(*instants).sqrt()
            }
        }
    }

    #[inline]
    pub(super) fn begin(&self, seed: u64, trial: u64) -> NoiseTrial {
        let stream = || Stream::new(seed, trial, Channel::AngularVelocity);
        match *self {
            Self::None => NoiseTrial::None,
            Self::Motion { error, instants } => NoiseTrial::Motion {
                error,
                instants,
                stream: stream(),
            },
            Self::Measurement { error, instants } => NoiseTrial::Measurement {
                error,
                instants,
                stream: stream(),
            },
        }
    }

    pub(super) fn need(&self) -> Option<String> {
        let (error, instants, side) = match self {
            Self::None => return None,
            Self::Motion { error, instants } => {
                (error, *instants, "noisy motion; the command is reported")
            }
            Self::Measurement { error, instants } => (
                error,
                *instants,
                "exact motion; a noisy measurement is reported",
            ),
        };
        let when = if instants == 1 {
            "once per probe".to_owned()
        } else {
            format!("at {instants} instants")
        };
        Some(format!(
            "angular velocity noise of {} % {when}: {side}",
            100.0 * error.fraction()
        ))
    }
}

impl NoiseTrial {
    /// The contact's displacement on a probe, and the reported rotation of the probe. The reported rotation contains
    /// the noise only if the noise is an error of measurement.
    #[inline]
    pub(super) fn roll(
        &mut self,
        roller: &Roller,
        Roll {
            command,
            rotation,
            displacement,
            terrain,
        }: &Roll,
    ) -> Result<(Vector2<f64>, Vector2<f64>), RollError> {
        match self {
            Self::None => Ok((*displacement, *rotation)),
            Self::Motion {
                error,
                instants: 1,
                stream,
            } => {
                let motion = [disturbed(command, error, stream)];
                Ok((cleared_shift(roller, &motion, terrain)?, *rotation))
            }
            Self::Motion { .. } => Ok((
                cleared_shift(roller, &self.motions(command), terrain)?,
                *rotation,
            )),
            Self::Measurement {
                error,
                instants,
                stream,
            } => {
                let rate = command.angular_velocity.norm();
                let sum: Vector2<f64> = (0..*instants).map(|_| error.draw(stream, rate)).sum();
                let measured = sum * (command.duration_s / f64::from(*instants));
                Ok((*displacement, rotation + measured))
            }
        }
    }

    /// The actual motions of the probe for `command`.
    pub(super) fn motions(&mut self, command: &Motion) -> Vec<Motion> {
        match self {
            Self::None | Self::Measurement { .. } => vec![*command],
            Self::Motion {
                error,
                instants,
                stream,
            } => {
                let duration_s = command.duration_s / f64::from(*instants);
                let piece = Motion {
                    duration_s,
                    ..*command
                };
                (0..*instants)
                    .map(|_| disturbed(&piece, error, stream))
                    .collect()
            }
        }
    }
}

/// Displacement of the contact on a probe, or an error if the probe overlaps the terrain.
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
