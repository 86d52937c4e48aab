//! Sensors of a roll, which read the contact on the probe and the rotation of the probe.

use nalgebra::Vector2;
use palpate_ep1::{PadStart, ReadingNoise};
use palpate_sensing::{
    BeyondPads, Channel, Encoder, GaussianError, PadOffset, PadPlacement, Pads, Stream, Wrist,
};
use palpate_statistics::Number;
use palpate_study::config::{self, RollNoiseConfig, RollSensorConfig, RotationNoise};

use crate::config_conversion::{pad_layout, sensor_error};
use palpate_study::FieldError;

#[derive(Clone, Debug)]
pub(super) enum RollSensor {
    Ideal,
    Wrist(Wrist),
    Pads(Pads),
}

/// The sensor in one trial.
pub(super) enum SensorTrial<'a> {
    Ideal,
    Wrist(&'a Wrist, Stream),
    /// Pads, and the random numbers by which each roll starts at its own place on a pad.
    RandomPads(&'a Pads, Stream),
    Pads(&'a Pads, PadPlacement),
}

impl RollSensor {
    /// The sensor in a config, on a probe of this radius.
    pub(super) fn new(config: &RollSensorConfig, radius: f64) -> Result<Self, FieldError> {
        match config {
            RollSensorConfig::Ideal => Ok(Self::Ideal),
            RollSensorConfig::Wrist { std } => Wrist::new(*std, radius).map(Self::Wrist),
            RollSensorConfig::Pads {
                pitch,
                layout,
                offset,
                cap_deg,
            } => {
                let layout = pad_layout(*layout);
                let offset = match offset {
                    config::PadOffset::Centred => PadOffset::Centred,
                    config::PadOffset::Random => PadOffset::Random,
                    config::PadOffset::RandomPerTrial => PadOffset::RandomPerTrial,
                };
                Pads::new(radius, *pitch, layout, offset, cap_deg.to_radians()).map(Self::Pads)
            }
        }
        .map_err(|error| sensor_error("scene.sensor", error))
    }

    pub(super) fn is_random(&self) -> bool {
        match self {
            Self::Ideal => false,
            Self::Wrist(wrist) => wrist.shift_std() > 0.0,
            Self::Pads(pads) => pads.offset() != PadOffset::Centred,
        }
    }

    /// Noise of the shifts that the sensor reports.
    pub(super) fn shift_noise(&self) -> ReadingNoise {
        match self {
            Self::Ideal => ReadingNoise::default(),
            Self::Wrist(wrist) => ReadingNoise {
                shift_std: wrist.shift_std(),
                ..ReadingNoise::default()
            },
            Self::Pads(pads) => {
                let start = match pads.offset() {
                    PadOffset::Centred => PadStart::Centred,
                    PadOffset::Random => PadStart::PerRoll,
                    PadOffset::RandomPerTrial => PadStart::PerTrial,
                };
                let square = ReadingNoise::of_pads(pads.pitch(), start);
                let [std, largest] = pads.rounding();
                ReadingNoise {
                    shift_std: std * square.shift_std,
                    shift_resolution: largest * square.shift_resolution,
                    ..square
                }
            }
        }
    }

    #[inline]
    pub(super) fn begin(&self, seed: u64, trial: u64) -> SensorTrial<'_> {
        match self {
            Self::Ideal => SensorTrial::Ideal,
            Self::Wrist(wrist) => {
                SensorTrial::Wrist(wrist, Stream::new(seed, trial, Channel::WristContact))
            }
            Self::Pads(pads) => {
                let mut stream = Stream::new(seed, trial, Channel::PadOffset);
                match pads.offset() {
                    PadOffset::Random => SensorTrial::RandomPads(pads, stream),
                    PadOffset::Centred | PadOffset::RandomPerTrial => {
                        SensorTrial::Pads(pads, pads.place(&mut stream))
                    }
                }
            }
        }
    }

    /// The sensor without noise. Pads still round positions; the centre of one pad is at the first contact.
    pub(super) fn noiseless(&self) -> Self {
        match self {
            Self::Ideal | Self::Wrist(_) => Self::Ideal,
            Self::Pads(pads) => Self::Pads(pads.centred()),
        }
    }

    pub(super) fn need(&self) -> String {
        match self {
            Self::Ideal => "ideal sensor: no noise".to_owned(),
            Self::Wrist(_) => "wrist sensor: two contact points inferred per probe".to_owned(),
            Self::Pads(pads) => {
                let start = match pads.offset() {
                    PadOffset::Centred => "centred on the first contact",
                    PadOffset::Random => "at an offset drawn for each roll",
                    PadOffset::RandomPerTrial => "at an offset drawn per trial",
                };
                format!("pads: the nearest one reports, {start}")
            }
        }
    }
}

impl SensorTrial<'_> {
    #[inline]
    pub(super) fn read(&mut self, displacement: &Vector2<f64>) -> Result<Vector2<f64>, BeyondPads> {
        match self {
            Self::Ideal => Ok(*displacement),
            Self::Wrist(wrist, stream) => Ok(wrist.read(stream, displacement)),
            Self::RandomPads(pads, stream) => pads.read(&pads.place(stream), displacement),
            Self::Pads(pads, placement) => pads.read(placement, displacement),
        }
    }
}

/// Sensor of the rotation of a probe, with its errors.
#[derive(Clone, Debug)]
pub(super) struct RotationSensor {
    error: GaussianError,
    /// Rate at which the error of each component of the rotation grows during a roll, rad/s.
    drift_rad_per_s: f64,
    encoder: Option<Encoder>,
}

/// The rotation sensor during one trial.
pub(super) struct RotationTrial<'a> {
    sensor: &'a RotationSensor,
    errors: Stream,
    phases: Stream,
}

impl RotationSensor {
    pub(super) fn new(noise: &RollNoiseConfig) -> Result<Self, FieldError> {
        let rotation = noise.rotation.as_ref();
        let number = |of: fn(&RotationNoise) -> f64| rotation.map_or(0.0, of);
        let encoder = noise
            .encoder
            .as_ref()
            .map(|encoder| Encoder::new(encoder.step_rad()));
        Ok(Self {
            drift_rad_per_s: number(|noise| noise.drift_deg_per_s.unwrap_or(0.0).to_radians()),
            error: GaussianError::new(number(RotationNoise::std_rad))
                .and_then(|error| {
                    error.with_bias(number(|noise| noise.bias_deg.unwrap_or(0.0).to_radians()))
                })
                .map_err(|error| sensor_error("scene.noise.rotation", error))?,
            encoder: encoder
                .transpose()
                .map_err(|error| sensor_error("scene.noise.encoder", error))?,
        })
    }

    pub(super) fn is_random(&self) -> bool {
        self.error.is_random() || self.encoder.is_some()
    }

    /// Whether the sensor reports the true rotations.
    pub(super) fn is_exact(&self) -> bool {
        !self.is_random() && self.error.bias() == 0.0 && self.drift_rad_per_s == 0.0
    }

    /// Config path of the larger of the sensor's two errors.
    pub(super) fn path(&self) -> &'static str {
        match self.encoder {
            Some(encoder) if encoder.std_rad() >= self.error.std() => "scene.noise.encoder",
            _ => "scene.noise.rotation",
        }
    }

    /// Standard deviation of each component of the rotation, rad.
    pub(super) fn std_rad(&self) -> f64 {
        libm::hypot(
            self.error.std(),
            self.encoder.map_or(0.0, |encoder| encoder.std_rad()),
        )
    }

    pub(super) fn begin(&self, seed: u64, trial: u64) -> RotationTrial<'_> {
        RotationTrial {
            sensor: self,
            errors: Stream::new(seed, trial, Channel::Rotation),
            phases: Stream::new(seed, trial, Channel::EncoderPhase),
        }
    }

    pub(super) fn need(&self) -> Option<String> {
        let error = self.error.is_random().then(|| {
            format!(
                "rotations measured with a standard deviation of {} rad",
                Number(self.error.std())
            )
        });
        let encoder = self
            .encoder
            .map(|_| "encoders count the rotation in steps".to_owned());
        let offsets = [
            ("bias", self.error.bias(), "rad"),
            ("drift", self.drift_rad_per_s, "rad/s"),
        ];
        let offsets = offsets.into_iter().filter(|(_, size, _)| *size != 0.0);
        let offsets = offsets.map(|(name, size, unit)| {
            format!("a {name} of measured rotations of {} {unit}", Number(size))
        });
        let needs: Vec<String> = error.into_iter().chain(encoder).chain(offsets).collect();
        (!needs.is_empty()).then(|| needs.join("; "))
    }
}

impl RotationTrial<'_> {
    /// The rotation (rad) that the sensor reports if the true rotation is `rotation` and the roll lasts `duration_s`.
    pub(super) fn read(&mut self, rotation: Vector2<f64>, duration_s: f64) -> Vector2<f64> {
        let RotationSensor {
            error,
            drift_rad_per_s,
            encoder,
        } = self.sensor;
        let drifted = drift_rad_per_s * duration_s;
        let measured = rotation.map(|angle| angle + drifted + error.draw(&mut self.errors));
        match encoder {
            Some(encoder) => encoder.read(&mut self.phases, &measured),
            None => measured,
        }
    }
}
