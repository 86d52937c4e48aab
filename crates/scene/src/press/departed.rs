//! Sensor parameters redrawn in every trial.

use std::sync::Arc;

use palpate_chromatouch::{Departure, DiscMotion, MarkerMotion};
use palpate_press::{Markers, PressError};
use palpate_sensing::{Channel, GaussianError, Stream};
use palpate_study::config::{PressModelConfig, SensorNoise};

use super::camera::{AT_REST, Eye};
use super::failure::PressFailure;
use super::looks::RestLook;
use super::pressed::Pressed;
use super::soft_body::SoftBody;
use palpate_estimators::{departure_stds, pressed_images};
use palpate_press::{Body, KnownPress, Seen};
use palpate_study::FieldError;

/// Each trial with a redrawn sensor reserves this many noise trial numbers, below those of shared frames.
const APART: u64 = 1000;
/// The numbers of calibration presses start this far below that of the trial's first frame at rest.
const PRESSES: u64 = APART / 2;

/// Trial number that seeds the noise of the first frame at rest of a redrawn sensor.
const fn first_of(trial: u64) -> u64 {
    AT_REST.wrapping_sub(APART.wrapping_mul(trial.wrapping_add(2)))
}

/// Draws the sensor parameters of each trial.
#[derive(Clone, Debug)]
pub(super) struct Redrawn {
    errors: Vec<GaussianError>,
    model: PressModelConfig,
    radius: f64,
    markers: Markers,
    /// Nominal depths of the magenta and the yellow discs.
    depths: [f64; 2],
    pressed: Pressed,
    rest_frames: u32,
    /// Calibration presses on a plane.
    calibrating: Vec<Pressed>,
    /// Largest misalignment of a marker, as a fraction of the yellow diameter.
    misalignment: f64,
}

/// The sensor of a trial.
pub(super) struct Departed {
    pub(super) eye: Eye,
    /// Lengths by which the magenta and the yellow discs are deeper than nominal.
    deeper: [f64; 2],
    pub(super) motions: Vec<MarkerMotion>,
    /// Pictures of the markers at rest, with their covariances.
    pub(super) rest: Arc<[Option<Seen>]>,
    pub(super) markers: Arc<[Option<palpate_tracking::Marker>]>,
}

impl Redrawn {
    pub(super) fn new(
        noise: &SensorNoise,
        model: &PressModelConfig,
        radius: f64,
        markers: &Markers,
        depths: [f64; 2],
        pressed: &Pressed,
        (rest_frames, calibrating, misalignment): (u32, Vec<Pressed>, f64),
    ) -> Result<Self, FieldError> {
        let errors = departure_stds(noise).map(|std| {
            GaussianError::new(std).map_err(|error| FieldError::at("scene.noise.sensor", error))
        });
        Ok(Self {
            errors: errors.into_iter().collect::<Result<_, _>>()?,
            model: model.clone(),
            radius,
            markers: markers.clone(),
            depths,
            pressed: *pressed,
            rest_frames,
            calibrating,
            misalignment,
        })
    }

    /// Draws the sensor of a trial around the nominal sensor `meant`.
    pub(super) fn sensor(&self, meant: &Eye, trial: u64) -> Result<Departed, PressFailure> {
        let mut stream = Stream::new(meant.seed, trial, Channel::Sensor);
        let mut numbers = [0.0; Departure::NUMBERS];
        for (number, error) in numbers.iter_mut().zip(&self.errors) {
            *number = error.draw(&mut stream);
        }
        let departure = meant.optics.possible(Departure::of(numbers));
        let optics = meant.optics.departed(&departure)?;
        let array = optics.array().clone();
        // The misalignments of number 0 belong to the sensor that the trials of other scenes share.
        let made = array.misaligned_in(self.misalignment, meant.seed, trial.wrapping_add(1))?;
        let eye = Eye {
            optics: optics.misaligned(&made.misalignments())?,
            ..meant.clone()
        };
        let motions = self.motions(&self.pressed, departure.depths)?;
        let look = RestLook::new(&eye, self.rest_frames);
        let spotted = look.spotted(first_of(trial))?;
        Ok(Departed {
            eye,
            deeper: departure.depths,
            motions,
            rest: spotted
                .iter()
                .map(|one| Some(one.as_ref()?.image()))
                .collect(),
            markers: spotted.iter().map(|one| Some((*one)?.marker)).collect(),
        })
    }

    /// Calibration presses of a trial's sensor, with its readings.
    pub(super) fn calibrating(
        &self,
        meant: &Eye,
        trial: u64,
    ) -> Result<Vec<KnownPress>, PressFailure> {
        let sensor = self.sensor(meant, trial)?;
        let seen = |(press, number): (&Pressed, u64)| {
            let motions = self.motions(press, sensor.deeper)?;
            let motions: Vec<Option<MarkerMotion>> = motions.into_iter().map(Some).collect();
            let draw = first_of(trial).wrapping_sub(PRESSES + number);
            let sight = sensor.eye.sight(&sensor.markers, &motions, Some(draw))?;
            Ok(KnownPress {
                seen: pressed_images(&sight.tracks, &sight.errors),
                relative_curvature: self.radius.recip() + press.object.curvature,
                at: press.at,
                indentation: press.indentation,
            })
        };
        self.calibrating.iter().zip(0..).map(seen).collect()
    }

    /// Displacements of the discs in a press if they lie `deeper` than nominal.
    pub(super) fn motions(
        &self,
        pressed: &Pressed,
        deeper: [f64; 2],
    ) -> Result<Vec<MarkerMotion>, PressError> {
        let [magenta, yellow] = [0, 1].map(|disc| {
            let depth = self.depths[disc] + deeper[disc];
            let body = SoftBody::of(&self.model, self.radius, depth, Body::solved_layer);
            let body = body.map_err(|_| PressError::OutOfRange)?;
            body.displacements(&self.markers, pressed)
        });
        let motion = |moved: palpate_press::MarkerDisplacement| DiscMotion {
            normal: moved.normal,
            tangential: moved.tangential,
            ..DiscMotion::default()
        };
        Ok(magenta?
            .into_iter()
            .zip(yellow?)
            .map(|(magenta, yellow)| MarkerMotion {
                magenta: motion(magenta),
                yellow: motion(yellow),
            })
            .collect())
    }
}
