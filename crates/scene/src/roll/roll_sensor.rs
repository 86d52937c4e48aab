//! Sensors of a roll: one for the position of the contact on the probe, and one for the rotation of the probe.

use nalgebra::Vector2;
use palpate_ep1::{PadCell, PadStart, Places, ReadingNoise, SeriesNoise};
use palpate_sensing::{
    BeyondPads, Channel, Encoder, GaussianError, PadOffset, PadPlacement, Pads, Stream, Wrist,
};
use palpate_statistics::Number;
use palpate_study::config::{self, RollNoiseConfig, RollSensorConfig, RotationNoise};

use crate::config_conversion::{pad_layout, sensor_error};
use crate::scene::joined;
use palpate_study::FieldError;

#[derive(Clone, Debug)]
pub(super) enum RollSensor {
    Ideal,
    Wrist(Wrist),
    Pads(Pads),
}

pub(super) enum SensorTrial<'a> {
    Ideal,
    Wrist(&'a Wrist, Stream),
    /// Pads, and a stream of random numbers. The position of the first contact relative to the pads is drawn anew for
    /// each roll.
    RandomPads(&'a Pads, Stream),
    Pads(&'a Pads, PadPlacement),
}

impl RollSensor {
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
            Self::Pads(pads) => pads.offset != PadOffset::Centred,
        }
    }

    pub(super) fn shift_noise(&self) -> ReadingNoise {
        match self {
            Self::Ideal => ReadingNoise::default(),
            Self::Wrist(wrist) => ReadingNoise {
                shift_std: wrist.shift_std(),
                ..ReadingNoise::default()
            },
            Self::Pads(pads) => {
                let start = match pads.offset {
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

    /// The sensor in trial number `trial`. If `trial` is `None`, the sensor has no noise. Pads then still round each
    /// position to the centre of a pad, and the first contact is at the centre of a pad.
    #[inline]
    pub(super) fn begin(&self, seed: u64, trial: Option<u64>) -> SensorTrial<'_> {
        let stream = |channel| Stream::new(seed, trial.unwrap_or_default(), channel);
        match (self, trial) {
            (Self::Ideal, _) | (Self::Wrist(_), None) => SensorTrial::Ideal,
            (Self::Wrist(wrist), Some(_)) => {
                SensorTrial::Wrist(wrist, stream(Channel::WristContact))
            }
            (Self::Pads(pads), Some(_)) if pads.offset == PadOffset::Random => {
                SensorTrial::RandomPads(pads, stream(Channel::PadOffset))
            }
            (Self::Pads(pads), Some(_)) => {
                SensorTrial::Pads(pads, pads.place(&mut stream(Channel::PadOffset)))
            }
            (Self::Pads(pads), None) => {
                let mut centred = pads.clone();
                centred.offset = PadOffset::Centred;
                SensorTrial::Pads(pads, centred.place(&mut stream(Channel::PadOffset)))
            }
        }
    }

    /// Whether the positions in a time series are contact points or centres of pads. `None` for pads on a uniform
    /// lattice, which are neither squares nor hexagons.
    pub(super) fn places(&self) -> Option<Places> {
        Some(match self {
            Self::Ideal => Places::Contacts { std: 0.0 },
            Self::Wrist(wrist) => Places::Contacts {
                std: wrist.shift_std() / std::f64::consts::SQRT_2,
            },
            Self::Pads(pads) => Places::Pads(PadCell {
                pitch: pads.pitch(),
                is_hexagonal: pads.are_hexagons()?,
            }),
        })
    }

    pub(super) fn need(&self) -> String {
        match self {
            Self::Ideal => "ideal sensor: no noise".to_owned(),
            Self::Wrist(_) => "wrist sensor: two contact points inferred per probe".to_owned(),
            Self::Pads(pads) => {
                let start = match pads.offset {
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

    /// The readings at all samples of one roll, and the position of the first contact. With pads, all positions in the
    /// result are displacements (exponential map) from the origin of the pad array, around which the pads are arranged.
    /// Without pads, they are displacements from the first contact, like the true contacts `contacts`.
    pub(super) fn read_samples(
        &mut self,
        contacts: &[Vector2<f64>],
    ) -> Result<(Vec<Vector2<f64>>, Vector2<f64>), BeyondPads> {
        let random;
        let (pads, placement) = match self {
            Self::Ideal => return Ok((contacts.to_vec(), Vector2::zeros())),
            Self::Wrist(wrist, stream) => {
                let read = |contact| wrist.contact(stream, contact);
                return Ok((contacts.iter().map(read).collect(), Vector2::zeros()));
            }
            Self::RandomPads(pads, stream) => {
                random = pads.place(stream);
                (pads, &random)
            }
            Self::Pads(pads, placement) => (pads, &*placement),
        };
        pads.read_samples(placement, contacts)
    }
}

#[derive(Clone, Debug)]
pub(super) struct RotationSensor {
    error: GaussianError,
    /// Rate at which the error of each component of the measured rotation grows during a roll, rad/s.
    drift_rad_per_s: f64,
    encoder: Option<Encoder>,
    /// Error of the measured rotation that is drawn separately for each sample of a roll.
    sample_error: GaussianError,
}

pub(super) struct RotationTrial<'a> {
    sensor: &'a RotationSensor,
    errors: Stream,
    phases: Stream,
    samples: Stream,
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
            sample_error: GaussianError::new(number(|noise| {
                noise.sample_std_deg.unwrap_or(0.0).to_radians()
            }))
            .map_err(|error| sensor_error("scene.noise.rotation.sample_std_deg", error))?,
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
        self.is_random_per_roll() || self.sample_error.is_random()
    }

    fn is_random_per_roll(&self) -> bool {
        self.error.is_random() || self.encoder.is_some()
    }

    pub(super) fn is_exact(&self) -> bool {
        !self.is_random_per_roll() && self.error.bias() == 0.0 && self.drift_rad_per_s == 0.0
    }

    /// Path of the config field that states the larger of two errors of the reported rotation: the random error of the
    /// rotation, or the error of the encoder.
    pub(super) fn path(&self) -> &'static str {
        match self.encoder {
            Some(encoder) if encoder.std_rad() >= self.error.std() => "scene.noise.encoder",
            _ => "scene.noise.rotation",
        }
    }

    /// Standard deviation of each component of the reported rotation at the end of a roll (rad).
    pub(super) fn std_rad(&self) -> f64 {
        libm::hypot(
            self.error.std(),
            self.encoder.map_or(0.0, |encoder| encoder.std_rad()),
        )
    }

    pub(super) fn series_noise(&self, rotation_rad: f64) -> SeriesNoise {
        let step = self.encoder.map_or(0.0, |encoder| encoder.std_rad());
        SeriesNoise {
            rotation_std_rad: libm::hypot(self.sample_error.std(), step),
            relative_rotation_std: self.error.std() / rotation_rad,
            ..SeriesNoise::default()
        }
    }

    pub(super) fn begin(&self, seed: u64, trial: u64) -> RotationTrial<'_> {
        RotationTrial {
            sensor: self,
            errors: Stream::new(seed, trial, Channel::Rotation),
            phases: Stream::new(seed, trial, Channel::EncoderPhase),
            samples: Stream::new(seed, trial, Channel::RotationSample),
        }
    }

    pub(super) fn need(&self) -> Option<String> {
        let [std, sample_std] = [self.error, self.sample_error].map(|error| error.std());
        let stated = |name: &str, size: f64, unit: &str| {
            (size != 0.0).then(|| format!("{name} of {} {unit}", Number(size)))
        };
        let encoder = self.encoder;
        let errors = [
            stated("rotations measured with a standard deviation", std, "rad"),
            encoder.map(|_| "encoders count the rotation in steps".to_owned()),
            stated("a bias of measured rotations", self.error.bias(), "rad"),
            stated(
                "a drift of measured rotations",
                self.drift_rad_per_s,
                "rad/s",
            ),
            stated(
                "sampled rotations with a standard deviation",
                sample_std,
                "rad per sample",
            ),
        ];
        joined(errors, "; ")
    }
}

impl RotationTrial<'_> {
    /// Returns the rotation (rad) that the sensor reports for the true rotation `rotation`. `duration_s` is the
    /// duration of the roll, over which the drift accumulates.
    pub(super) fn read(&mut self, rotation: Vector2<f64>, duration_s: f64) -> Vector2<f64> {
        let sensor = self.sensor;
        let drifted = sensor.drift_rad_per_s * duration_s;
        let measured = rotation.map(|angle| angle + drifted + sensor.error.draw(&mut self.errors));
        match &sensor.encoder {
            Some(encoder) => encoder.read(&mut self.phases, &measured),
            None => measured,
        }
    }

    /// Replaces the true rotations (rad) at the given fractions of a roll by the rotations that the sensor reports. The
    /// drift and the random error of the roll grow linearly, from 0 at its start to their values in
    /// [`RotationTrial::read`] at its end. In addition, each sample has its own error.
    pub(super) fn read_samples(
        &mut self,
        rotations: &mut [Vector2<f64>],
        fractions: &[f64],
        duration_s: f64,
    ) {
        let sensor = self.sensor;
        let drifted = sensor.drift_rad_per_s * duration_s;
        let mut at_end = || drifted + sensor.error.draw(&mut self.errors);
        let at_end = Vector2::new(at_end(), at_end());
        // The phase of the encoder is random, but all samples of a roll must have the same phase. Therefore, the stream
        // of random phases is reset before each sample.
        let first_phase = self.phases.clone();
        for (rotation, &fraction) in rotations.iter_mut().zip(fractions) {
            let error = Vector2::from_fn(|_, _| sensor.sample_error.draw(&mut self.samples));
            let measured = *rotation + at_end * fraction + error;
            self.phases = first_phase.clone();
            *rotation = match &sensor.encoder {
                Some(encoder) => encoder.read(&mut self.phases, &measured),
                None => measured,
            };
        }
    }
}
