//! Sensor parameters that are drawn anew in every trial.

use std::sync::Arc;

use palpate_chromatouch::{Departure, MarkerMotion};
use palpate_estimators::departure_stds;
use palpate_press::{Body, Markers, ObjectPress, PressError, Seen};
use palpate_sensing::{Channel, GaussianError, Stream};
use palpate_study::FieldError;
use palpate_study::config::{CameraConfig, PressModelConfig};
use palpate_tracking::Marker;

use super::PressFailure;
use super::camera_calibration::RestFrames;
use super::camera_model::{AT_REST, SimulatedCamera};
use super::plan::PressSetup;
use super::truth::{disc_motions, marker_motions, soft_body};

/// If each trial has its own sensor, this many trial numbers are reserved for its frames. Each number seeds the noise
/// of one frame. The reserved numbers are smaller than the numbers of the frames that all trials share.
const NUMBERS_PER_TRIAL: u64 = 1000;

const fn rest_number(trial: u64) -> u64 {
    AT_REST.wrapping_sub(NUMBERS_PER_TRIAL.wrapping_mul(trial.wrapping_add(2)))
}

#[derive(Clone, Debug)]
pub(super) struct SensorVariation {
    errors: Vec<GaussianError>,
    model: PressModelConfig,
    markers: Markers,
    /// Depths of the magenta and the yellow discs of the nominal sensor (length).
    depths: [f64; 2],
    rest_frames: u32,
    /// Largest misalignment of a marker's two discs, relative to the diameter of the yellow disc.
    misalignment: f64,
}

/// Sensor of one trial, and the motions of its markers' discs in a press.
pub(super) struct VariedSensor {
    pub(super) camera: SimulatedCamera,
    pub(super) motions: Vec<MarkerMotion>,
    pub(super) rest: Arc<[Option<Seen>]>,
    pub(super) markers: Vec<Option<Marker>>,
}

impl SensorVariation {
    pub(super) fn new(
        setup: &PressSetup<'_>,
        camera: &CameraConfig,
    ) -> Result<Option<Self>, FieldError> {
        let Some(noise) = &setup.config.noise.sensor else {
            return Ok(None);
        };
        let depths = setup.sphere.disc_depths()?;
        let errors = departure_stds(noise).map(|std| {
            GaussianError::new(std).map_err(|error| FieldError::at("scene.noise.sensor", error))
        });
        Ok(Some(Self {
            errors: errors.into_iter().collect::<Result<_, _>>()?,
            model: setup.model.clone(),
            markers: setup.markers.clone(),
            depths: [depths.magenta, depths.yellow],
            rest_frames: camera.calibration.rest_frames,
            misalignment: setup.sphere.discs.map_or(0.0, |discs| discs.misalignment),
        }))
    }

    /// Draws the sensor of a trial, and computes the motions of its discs in a press. The parameters of this sensor
    /// differ at random from the parameters of the sensor `nominal`.
    pub(super) fn sensor(
        &self,
        nominal: &SimulatedCamera,
        geometry: &ObjectPress,
        trial: u64,
    ) -> Result<VariedSensor, PressFailure> {
        let mut stream = Stream::new(nominal.seed, trial, Channel::Sensor);
        let mut numbers = [0.0; Departure::NUMBERS];
        for (number, error) in numbers.iter_mut().zip(&self.errors) {
            *number = error.draw(&mut stream);
        }
        let departure = nominal.optics.possible(Departure::from(numbers));
        let optics = nominal.optics.departed(&departure)?;
        let array = optics.array().clone();
        // Add 1 to the number of the trial, because the number 0 is reserved: it seeds the misalignments in scenes
        // whose trials share one sensor.
        let array = array.misaligned(self.misalignment, nominal.seed, trial.wrapping_add(1))?;
        let camera = SimulatedCamera {
            optics: optics.misaligned(&array.misalignments())?,
            ..nominal.clone()
        };
        let motions = self.motions(geometry, departure.depths)?;
        let frames = RestFrames::new(&camera, self.rest_frames);
        let measured = frames.measurements(rest_number(trial))?;
        Ok(VariedSensor {
            camera,
            motions,
            rest: measured
                .iter()
                .map(|one| Some(one.as_ref()?.image()))
                .collect(),
            markers: measured.iter().map(|one| Some((*one)?.marker)).collect(),
        })
    }

    /// Motions of the discs in a press. The depths of the discs exceed their nominal depths by `deeper`.
    fn motions(
        &self,
        geometry: &ObjectPress,
        deeper: [f64; 2],
    ) -> Result<Vec<MarkerMotion>, PressError> {
        let motions = |disc: usize| {
            let depth = self.depths[disc] + deeper[disc];
            let radius = self.markers.skin().radius();
            let body = soft_body(&self.model, radius, depth, Body::solved_layer);
            let body = body.map_err(|_| PressError::OutOfRange)?;
            let moved = geometry.displacements(&body, &self.markers)?;
            Ok::<_, PressError>(disc_motions(&moved))
        };
        Ok(marker_motions([motions(0)?, motions(1)?]))
    }
}
