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
use palpate_press::{PressError, Reading};
use palpate_tracking::TrackingError;
use strum::IntoStaticStr;
use thiserror::Error;

use reading::PressReading;

pub(crate) use camera_calibration::{CalibrationFrames, ImageChanges, RestFrames, RestMarkers};
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
