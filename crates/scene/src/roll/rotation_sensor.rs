//! Sensors of the probe's rotation.

use nalgebra::Vector2;
use palpate_sensing::{Channel, Encoder, GaussianError, Stream};
use palpate_study::config::RollNoiseConfig;

use crate::plan::sensor_error;
use palpate_study::FieldError;

/// Errors of the rotation that a probe reports.
#[derive(Clone, Debug)]
pub(super) struct RotationSensor {
    error: GaussianError,
    encoder: Option<Encoder>,
}

/// The sensor in one trial.
pub(super) struct RotationTrial<'a> {
    sensor: &'a RotationSensor,
    errors: Stream,
    phases: Stream,
}

impl RotationSensor {
    pub(super) fn new(noise: &RollNoiseConfig) -> Result<Self, FieldError> {
        let std_rad = noise.rotation.as_ref().map_or(0.0, |noise| noise.std_rad());
        let encoder = noise
            .encoder
            .as_ref()
            .map(|encoder| Encoder::new(encoder.step_rad()));
        Ok(Self {
            error: GaussianError::new(std_rad)
                .map_err(|error| sensor_error("scene.noise.rotation", error))?,
            encoder: encoder
                .transpose()
                .map_err(|error| sensor_error("scene.noise.encoder", error))?,
        })
    }

    pub(super) fn is_random(&self) -> bool {
        self.error.is_random() || self.encoder.is_some()
    }

    /// Config path of the larger of the two errors.
    pub(super) fn path(&self) -> &'static str {
        match self.encoder {
            Some(encoder) if encoder.std_rad() >= self.error.std() => "scene.noise.encoder",
            _ => "scene.noise.rotation",
        }
    }

    /// Standard deviation of each component, rad.
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
                "rotations measured to {} rad",
                palpate_statistics::Number(self.error.std())
            )
        });
        let encoder = self
            .encoder
            .map(|_| "encoders count the rotation in steps".to_owned());
        let needs: Vec<String> = error.into_iter().chain(encoder).collect();
        (!needs.is_empty()).then(|| needs.join("; "))
    }
}

impl RotationTrial<'_> {
    /// The rotation (rad) that the sensor reports for a true `rotation`.
    pub(super) fn read(&mut self, rotation: Vector2<f64>) -> Vector2<f64> {
        let RotationSensor { error, encoder } = self.sensor;
        let measured = rotation.map(|angle| angle + error.draw(&mut self.errors));
        match encoder {
            Some(encoder) => encoder.read(&mut self.phases, &measured),
            None => measured,
        }
    }
}
