//! A press: a soft spherical sensor touches an object once. The curvature of the object is estimated from the
//! displacements of the markers under the skin.

mod camera_calibration;
mod camera_model;
mod description;
mod plan;
mod press_tables;
mod reading;
mod sensor_variation;
mod trial;
mod truth;

use crate::scene::Observer;
use palpate_chromatouch::OpticsError;
use palpate_press::{Body, PressError, Reading};
use palpate_sweep::Cache;
use palpate_tracking::{Marker, TrackingError};
use strum::IntoStaticStr;
use thiserror::Error;

use camera_calibration::{CalibrationFrames, ImageChanges, RestFrames, RestMarkers};
use reading::PressReading;

pub use trial::PressScene;

/// Reason why a press or one of its trials has no estimate.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq)]
pub enum PressFailure {
    /// The press is impossible, or no simulated press agrees with the readings.
    #[error(transparent)]
    #[strum(transparent)]
    Press(#[from] PressError),
    /// The camera cannot image the displaced markers.
    #[error(transparent)]
    #[strum(transparent)]
    Optics(#[from] OpticsError),
    /// No markers were found in the camera's frame.
    #[error(transparent)]
    #[strum(transparent)]
    Camera(#[from] TrackingError),
}

/// Additional errors in the readings of a press. These errors are not part of the noise of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PressFlaw {
    /// Additional error of one marker's normal displacement (length). The marker with this error differs from trial to
    /// trial.
    pub outlier: f64,
    /// Additional error of the stated indentation. Its unit is the standard deviation of the difference between the
    /// stated indentation and the indentation that is estimated from the displacements alone.
    pub indentation: f64,
}

impl PressScene {
    /// Runs a trial like [`Trials::trial`](crate::Trials::trial), but with a flaw in its readings. Returns the names of
    /// the warnings about its estimate. If the fit rejects markers, `outlier` is one of these names.
    ///
    /// # Errors
    /// The name of the failure, which stays the same in all versions.
    pub fn flawed_trial(
        &self,
        trial: u64,
        flaw: PressFlaw,
        observe: Observer<'_>,
    ) -> Result<Vec<&'static str>, &'static str> {
        let mut reading = self.reading(Some(trial))?;
        reading.add_outlier(flaw.outlier, trial);
        if flaw.indentation != 0.0 {
            reading.indentation += flaw.indentation * self.indentation_difference_std()?;
        }
        Ok(self.warnings(&reading, observe)?)
    }

    /// Standard deviation of the difference between the stated indentation and the indentation that is estimated from
    /// the displacements alone. It is computed from the estimate for noiseless readings.
    fn indentation_difference_std(&self) -> Result<f64, PressFailure> {
        self.with_fit(&self.reading(None)?, |fit, reading| {
            let alone = fit.estimate(&Reading {
                indentation: None,
                ..*reading
            })?;
            let stated = reading.indentation.map_or(0.0, |stated| stated.std);
            Ok(libm::hypot(stated, alone.indentation.std))
        })
    }

    /// Estimates the press from a reading, compares the estimate with the true values, and returns the names of its
    /// warnings.
    fn warnings(
        &self,
        reading: &PressReading,
        observe: Observer<'_>,
    ) -> Result<Vec<&'static str>, PressFailure> {
        let estimate = self.estimate(reading)?;
        let given = self.given_indentation(reading);
        // A stated indentation can contradict the readings only if the markers alone determine the indentation too.
        let (indentation, misfits) = match self.estimator.images(reading) {
            Some((fit, images)) => (
                fit.check_indentation(images, given),
                fit.misfits(images, given, &estimate)?,
            ),
            None => self.with_fit(reading, |fit, reading| {
                let indentation = fit.check_indentation(reading, Some(&estimate));
                Ok((indentation, fit.misfits(reading, &estimate)?))
            })?,
        };
        self.compare(reading, &estimate, observe);
        let outlier = (!estimate.wrong_markers.is_empty()).then_some("outlier");
        let misfits = misfits.into_iter().chain(indentation.ok().flatten());
        let codes = misfits.map(|misfit| misfit.code());
        Ok(codes.chain(outlier).collect())
    }
}

/// Maximum number of cached layers of the soft body. Each layer has tables of at most 2 MB.
const LAYERS: usize = 16;
/// Maximum number of cached marker images, each of at most 300 bytes.
const IMAGES: usize = 1 << 17;

/// Models that several scenes share, such as the scenes of a study's grid points. The models are soft layers with their
/// tables of displacements, and camera readings at rest and in calibration presses. The first scene that needs a model
/// computes it, and scenes with the same inputs reuse it. The cache has a limited size and never changes results.
///
/// ```
/// use palpate_scene::{Scenes, SharedModels};
/// use palpate_study::config::parse;
///
/// let text = r#"
///     name = "presses"
///     scene.kind = "press"
///     scene.probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
///     scene.object = { kind = "plane" }
///     scene.motion = { indentation = 1.0 }
///     scene.model = { kind = "bonded-layer", thickness = 5.0 }
///     scene.estimator = { kind = "bonded-layer" }
///     [[sweep]]
///     path = "scene.motion.indentation"
///     values = [0.5, 1.0]
/// "#;
/// let study = parse("study.toml", text)?;
/// let models = SharedModels::default();
/// for (number, indentation) in [0.5, 1.0].into_iter().enumerate() {
///     // The second scene reuses the layer of the first.
///     let scene = study.estimable_scene_of(number, &study.cell(number)?, &models)?;
///     assert_eq!(scene.truth(3), Some(indentation));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SharedModels {
    /// Cached layers of the soft body. The key consists of the bits of the layer's thickness and of the marker depths.
    layers: Cache<Vec<u64>, Result<Vec<Body>, PressError>>,
    at_rest: Cache<RestFrames, Result<RestMarkers, PressFailure>>,
    changes: Cache<CalibrationFrames, Result<ImageChanges, PressFailure>>,
}

impl Default for SharedModels {
    fn default() -> Self {
        Self {
            layers: Cache::new(LAYERS),
            at_rest: Cache::new(IMAGES),
            changes: Cache::new(IMAGES),
        }
    }
}

impl SharedModels {
    /// Returns the soft body that [`Body::bonded_layer`] builds for this thickness and marker depth. The body is built
    /// only if the cache does not contain it.
    fn layer(&self, thickness: f64, depth: f64) -> Result<Body, PressError> {
        let mut layers = self.layers(thickness, &[depth])?;
        layers.pop().ok_or(PressError::OutOfRange)
    }

    fn layers(&self, thickness: f64, depths: &[f64]) -> Result<Vec<Body>, PressError> {
        let numbers = [thickness].into_iter().chain(depths.iter().copied());
        let key = numbers.map(f64::to_bits).collect();
        self.layers
            .get(key, depths.len(), || Body::bonded_layers(thickness, depths))
    }

    fn at_rest(&self, frames: &RestFrames) -> Result<RestMarkers, PressFailure> {
        let markers = || frames.markers().map(RestMarkers::from);
        self.at_rest.get(frames.clone(), frames.size(), markers)
    }

    /// For each calibration press, the changes of the markers' images from their images at rest (`rest`).
    fn changes(
        &self,
        frames: &CalibrationFrames,
        rest: &[Option<Marker>],
    ) -> Result<ImageChanges, PressFailure> {
        self.changes
            .get(frames.clone(), frames.size(), || frames.changes(rest))
    }
}
