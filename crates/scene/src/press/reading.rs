//! Readings of a press: the sensors that read the markers and the indentation, and their noise.

use palpate_statistics::BadSetting;
use std::sync::Arc;

use palpate_chromatouch::MarkerMotion;
use palpate_estimators::{MarkerImages, pressed_images};
use palpate_press::{Markers, Measured, Reading};
use palpate_sensing::{Channel, GaussianError, MarkerNoise, Stream};
use palpate_study::FieldError;
use palpate_study::config::{CameraConfig, Length, PressNoiseConfig, ReadingNoise};
use palpate_tracking::{Change, Marker};

use super::PressFailure;
use super::camera_calibration::{CameraCalibration, RestFrames};
use super::camera_model::{AT_REST, CameraModel, MarkerTracks, SimulatedCamera};
use super::plan::PressSetup;
use super::sensor_variation::SensorVariation;
use super::truth::{DiscMarkers, TruePress};

/// Largest shift of a marker's image that counts as a rounding error (px). Such a shift is replaced by 0.
const ROUNDING_PX: f64 = 1e-9;

/// Reading of a marker: its normal displacement, and both components of its displacement along the skin.
type MarkerReading = [f64; 3];

#[derive(Clone, Debug)]
pub(super) struct PressReading {
    /// Indices (in the layout) of the tracked markers, in ascending order.
    tracked: Vec<usize>,
    normal: Vec<f64>,
    tangential: Vec<[f64; 2]>,
    pub(super) indentation: f64,
    /// Tracks and images of all markers, as the camera reads them; `None` if the sensor reads the displacements
    /// directly.
    pub(super) camera: Option<CameraReading>,
}

#[derive(Clone, Debug)]
pub(super) struct CameraReading {
    pub(super) tracks: MarkerTracks,
    pub(super) images: MarkerImages,
}

impl PressReading {
    pub(super) fn markers(&self) -> impl ExactSizeIterator<Item = (usize, f64, [f64; 2])> {
        let readings = self.normal.iter().zip(&self.tangential);
        let tracked = self.tracked.iter().zip(readings);
        tracked.map(|(&marker, (&normal, &tangential))| (marker, normal, tangential))
    }

    pub(super) fn subset(&self, layout: &Markers) -> Option<Markers> {
        let has_lost = self.tracked.len() < layout.count();
        has_lost.then(|| layout.subset(&self.tracked))
    }

    /// Adds `error` to the normal displacement of one marker, which is chosen by the trial number.
    pub(super) fn add_outlier(&mut self, error: f64, trial: u64) {
        let count = self.normal.len() as u64;
        let marker = trial.checked_rem(count).unwrap_or(0) as usize;
        if let Some(normal) = self.normal.get_mut(marker) {
            *normal += error;
        }
    }

    /// Readings in the form that a fit of a press needs. `markers` contains the tracked markers.
    pub(super) fn fit_input<'a>(
        &'a self,
        markers: &'a Markers,
        has_tangential: bool,
        indentation: Option<Measured>,
    ) -> Reading<'a> {
        Reading {
            markers,
            normal: &self.normal,
            tangential: has_tangential.then_some(&self.tangential),
            indentation,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) enum PressSensor {
    Direct,
    Camera(Box<CameraPressSensor>),
}

impl PressSensor {
    /// Reads a press. The reading has the noise of trial number `trial`; it has no noise if `trial` is `None`.
    pub(super) fn read(
        &self,
        truth: &TruePress,
        noise: &PressNoise,
        trial: Option<u64>,
    ) -> Result<PressReading, PressFailure> {
        let (mut markers, camera) = match self {
            Self::Direct => {
                let markers = truth.markers.iter().map(|moved| {
                    let [x, y] = moved.tangential;
                    Some([moved.normal, x, y])
                });
                (markers.collect(), None)
            }
            Self::Camera(camera) => {
                let reading = camera.read(truth, trial)?;
                (camera.displacements(&reading.tracks), Some(reading))
            }
        };
        if let Some(trial) = trial {
            noise.markers.add_to(&mut markers, noise.seed, trial);
        }
        let tracked = markers.iter().flatten();
        Ok(PressReading {
            normal: tracked.clone().map(|[normal, ..]| *normal).collect(),
            tangential: tracked.map(|[_, x, y]| [*x, *y]).collect(),
            tracked: (0..markers.len())
                .filter(|&marker| markers[marker].is_some())
                .collect(),
            indentation: truth.geometry.indentation + noise.indentation_error(trial),
            camera,
        })
    }

    pub(super) fn camera(&self) -> Option<&CameraPressSensor> {
        match self {
            Self::Direct => None,
            Self::Camera(camera) => Some(camera),
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct PressNoise {
    pub(super) markers: MarkerNoise,
    /// Error of the indentation, which is read, for example, from the pose of a robot.
    pub(super) indentation: GaussianError,
    seed: u64,
}

impl PressNoise {
    /// Builds the noise that a config states, for a sensor with `markers` markers. Averaging over `frames` frames
    /// reduces the noise of the displacements.
    pub(super) fn new(
        config: &PressNoiseConfig,
        frames: u32,
        markers: usize,
        seed: u64,
    ) -> Result<Self, FieldError> {
        let length = |noise: Option<ReadingNoise<Length>>, key: &str| {
            gaussian(noise.map(|ReadingNoise::Gaussian { std }| std.0), key)
        };
        let biased = |error: GaussianError, bias: Option<f64>, key: &str| {
            let path = format!("scene.noise.{key}");
            error
                .with_bias(bias.unwrap_or(0.0))
                .map_err(|error| FieldError::at(path, error))
        };
        let normal = length(config.normal_displacement, "normal_displacement")?.averaged(frames);
        let indentation = length(config.indentation, "indentation")?;
        let gain = config.gain.map(|ReadingNoise::Gaussian { std }| std.0);
        let wrong = config.wrong_markers.as_ref();
        let outliers = marker_count(wrong.map(|wrong| wrong.count), "wrong_markers", markers)?;
        let outlier = gaussian(wrong.map(|wrong| wrong.std), "wrong_markers")?;
        let markers = MarkerNoise {
            outliers: if outlier.is_random() { outliers } else { 0 },
            normal: biased(normal, config.normal_bias, "normal_bias")?,
            tangential: length(config.tangential_displacement, "tangential_displacement")?
                .averaged(frames),
            gain: gaussian(gain, "gain")?,
            outlier,
        };
        Ok(Self {
            markers,
            indentation: biased(indentation, config.indentation_bias, "indentation_bias")?,
            seed,
        })
    }

    /// Whether the readings differ between trials. `has_tangential` states whether tangential displacements are read,
    /// and `has_indentation` whether the indentation is read.
    pub(super) fn is_random(&self, has_tangential: bool, has_indentation: bool) -> bool {
        let markers = &self.markers;
        markers.normal.is_random()
            || (has_tangential && markers.tangential.is_random())
            || (has_indentation && self.indentation.is_random())
            || markers.gain.is_random()
            || markers.outliers > 0
    }

    fn indentation_error(&self, trial: Option<u64>) -> f64 {
        trial.map_or(0.0, |trial| {
            let mut stream = Stream::new(self.seed, trial, Channel::Indentation);
            self.indentation.draw(&mut stream)
        })
    }
}

/// Gaussian error with the standard deviation `std`, or no error if `std` is `None`. `noise` is the name of the config
/// field that states the error.
pub(super) fn gaussian(std: Option<f64>, noise: &str) -> Result<GaussianError, FieldError> {
    GaussianError::new(std.unwrap_or(0.0)).map_err(|error: BadSetting<String>| {
        FieldError::at(format!("scene.noise.{noise}.std"), error)
    })
}

/// Number `count` of lost markers or of outliers, which the config states in the table `noise`; 0 if `count` is `None`.
/// Returns an error if the number exceeds `markers`, the number of all markers.
fn marker_count(count: Option<u32>, noise: &str, markers: usize) -> Result<usize, FieldError> {
    let count = count.unwrap_or(0) as usize;
    if count <= markers {
        return Ok(count);
    }
    let message = format!("must be at most the number of markers {markers}, is {count}");
    Err(FieldError::at(
        format!("scene.noise.{noise}.count"),
        message,
    ))
}

#[derive(Clone, Debug)]
pub(super) struct CameraPressSensor {
    pub(super) camera: SimulatedCamera,
    /// Image of each marker of the layout at rest; `None` for a marker that is not visible.
    pub(super) rest: Arc<[Option<Marker>]>,
    pub(super) calibration: CameraCalibration,
    /// Number of lost markers, which are chosen at random in every trial.
    lost_markers: usize,
    central_marker: usize,
    /// True changes of the image of the marker nearest to the contact, as from [`CameraPressSensor::central_changes`],
    /// computed directly, without noise and pixels. `None` if the camera does not see this marker at rest or in the
    /// press.
    pub(super) true_changes: Option<[f64; 3]>,
    pub(super) variation: Option<SensorVariation>,
}

impl CameraPressSensor {
    /// Builds the camera of a config and calibrates it. `discs` contains the markers with their discs.
    pub(super) fn new(
        setup: &PressSetup<'_>,
        (config, is_rendered): (&CameraConfig, bool),
        discs: &DiscMarkers<'_>,
        truth: &TruePress,
    ) -> Result<Self, FieldError> {
        let camera = SimulatedCamera::new(setup, config, is_rendered)?;
        let lost = setup.config.noise.lost_markers.as_ref();
        let lost = lost.map(|lost| lost.count);
        let lost_markers = marker_count(lost, "lost_markers", setup.places.len())?;
        let frames = RestFrames::new(&camera, config.calibration.rest_frames);
        let rest = setup
            .models
            .at_rest(&frames)
            .map_err(|error| FieldError::at("scene.sensor", error))?;
        if rest.iter().flatten().next().is_none() {
            let message = "no marker is visible to the camera; check `scene.sensor.field_deg`";
            return Err(FieldError::at("scene.sensor", message));
        }
        let calibration = CameraCalibration::new(setup, config, discs, &frames, &rest)?;
        let central_marker = discs.nearest(setup.geometry.at).unwrap_or(0);
        Ok(Self {
            true_changes: true_changes(&camera, &truth.discs, central_marker),
            variation: SensorVariation::new(setup, config)?,
            camera,
            rest,
            calibration,
            lost_markers,
            central_marker,
        })
    }

    pub(super) fn visible(&self) -> usize {
        let visible = self.rest.iter().flatten().count();
        visible.saturating_sub(self.lost_markers)
    }

    pub(super) fn is_random(&self) -> bool {
        self.lost_markers > 0 || self.camera.is_random || self.variation.is_some()
    }

    /// Tracks the markers of a press. The noise and the sensor parameters are those of trial number `trial`. If `trial`
    /// is `None`, the tracks have no noise.
    fn read(&self, truth: &TruePress, trial: Option<u64>) -> Result<CameraReading, PressFailure> {
        let (tracks, own_rest) = match (&self.variation, trial) {
            (Some(variation), Some(number)) => {
                let sensor = variation.sensor(&self.camera, &truth.geometry, number)?;
                let motions = self.without_lost(&sensor.motions, trial);
                let tracks = sensor.camera.track(&sensor.markers, &motions, trial)?;
                (tracks, Some(sensor.rest))
            }
            _ => {
                let motions = self.without_lost(&truth.discs, trial);
                (self.camera.track(&self.rest, &motions, trial)?, None)
            }
        };
        let images = MarkerImages {
            own_rest,
            pressed: pressed_images(&tracks.tracks, &tracks.errors),
        };
        Ok(CameraReading { tracks, images })
    }

    fn displacements(&self, tracks: &MarkerTracks) -> Vec<Option<MarkerReading>> {
        let calibration = &self.calibration.calibration;
        let reading = |(marker, change): (usize, Option<Change>)| {
            let change = change?;
            let normal = calibration.normal(marker, &change)?;
            let [x, y] = calibration.tangential(change.shift_px, normal)?;
            Some([normal, x, y])
        };
        let changes = tracks.tracks.iter();
        let changes = changes.map(|track| self.camera.lens.change(track.as_ref()?));
        changes.enumerate().map(reading).collect()
    }

    pub(super) fn frames(
        &self,
        truth: &TruePress,
        trial: Option<u64>,
    ) -> Result<Option<[image::RgbImage; 2]>, PressFailure> {
        if !matches!(self.camera.model, CameraModel::Rendered) {
            return Ok(None);
        }
        let rest = vec![Some(MarkerMotion::default()); truth.discs.len()];
        let pressed = self.without_lost(&truth.discs, trial);
        let pressed = self.camera.render(&pressed, trial)?;
        let at_rest = trial.map(|_| AT_REST);
        Ok(Some([self.camera.render(&rest, at_rest)?, pressed]))
    }

    fn without_lost(
        &self,
        motions: &[MarkerMotion],
        trial: Option<u64>,
    ) -> Vec<Option<MarkerMotion>> {
        let mut motions: Vec<_> = motions.iter().copied().map(Some).collect();
        if let Some(trial) = trial.filter(|_| self.lost_markers > 0) {
            let mut stream = Stream::new(self.camera.seed, trial, Channel::LostMarkers);
            for marker in stream.choose(self.lost_markers, motions.len()) {
                motions[marker] = None;
            }
        }
        motions
    }

    /// Changes of the image of the marker nearest to the contact from rest to the press: of the hue of its summed light
    /// and of its mean hue (turns), and the shift of its centroid (px). The shift is the angle (rad) between both
    /// directions from the camera to the marker, multiplied by the lens's pixels per radian.
    pub(super) fn central_changes(&self, tracks: &MarkerTracks) -> Option<[f64; 3]> {
        image_changes(&self.camera, tracks, self.central_marker)
    }
}

fn true_changes(
    camera: &SimulatedCamera,
    motions: &[MarkerMotion],
    marker: usize,
) -> Option<[f64; 3]> {
    let exact = camera.exact();
    let rest = exact.at_rest(None).ok()?;
    let rest: Vec<_> = rest.iter().map(|one| Some((*one)?.marker)).collect();
    let motions: Vec<_> = motions.iter().copied().map(Some).collect();
    let tracks = exact.track(&rest, &motions, None).ok()?;
    image_changes(&exact, &tracks, marker)
}

fn image_changes(
    camera: &SimulatedCamera,
    tracks: &MarkerTracks,
    marker: usize,
) -> Option<[f64; 3]> {
    let track = tracks.tracks.get(marker)?.as_ref()?;
    let change = camera.lens.change(track)?;
    let shift_px = libm::hypot(change.shift_px[0], change.shift_px[1]);
    let shift_px = if shift_px > ROUNDING_PX {
        shift_px
    } else {
        0.0
    };
    Some([change.hue_turns, track.mean_hue_change()?, shift_px])
}
