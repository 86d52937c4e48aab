//! Estimates of single trials compared with the truth, and bounds on their standard deviation.

use nalgebra::SMatrix;
use palpate_chromatouch::MarkerMotion;
use palpate_press::{Doubt, Estimated};

use super::failure::PressFailure;
use super::pressed::Pressed;
use super::readings::MarkerReadings;
use super::scene::{PressScene, PressSensor, hold};

/// Number of unknowns that change the pixels: relative curvature, two contact coordinates, indentation.
const UNKNOWNS: usize = 4;
/// Finite-difference step of the contact coordinates and the indentation, in sensor radii.
const STEP: f64 = 2e-4;
/// Finite-difference step of the relative curvature, as a fraction of it.
const SHARE: f64 = 1e-2;

/// The object's curvature as estimated in one trial, 1/length.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedCurvature {
    /// The estimate with its interval.
    pub estimated: Estimated,
    /// The true curvature.
    pub truth: f64,
    /// Whether the 50, 80 and 95 % intervals contain the true curvature.
    pub holds: [bool; 3],
    /// Cramér–Rao bound on the standard deviation, from the stated errors of tracker and calibration; `None` if the
    /// fit does not use pictures.
    pub std_bound: Option<f64>,
    /// Goodness-of-fit p-value, if the fit has one.
    pub p_value: Option<f64>,
    /// Warnings that the readings contradict the model.
    pub doubts: Vec<Doubt>,
}

impl PressScene {
    /// Estimates the object's curvature in trial number `trial`.
    ///
    /// # Errors
    /// Failure of the trial.
    pub fn judged_curvature(&self, trial: u64) -> Result<JudgedCurvature, PressFailure> {
        self.judged(self.readings(Some(trial))?)
    }

    /// Estimates the object's curvature in trial number `trial`, with a sensor that is calibrated by its frame at
    /// rest and the presses of `scene.sensor.calibration`. `scene.noise.sensor` states its uncertainty before
    /// calibration. Only fits of pictures use these presses.
    ///
    /// # Errors
    /// Failure of the trial.
    pub fn calibrated_curvature(&self, trial: u64) -> Result<JudgedCurvature, PressFailure> {
        let mut readings = self.readings(Some(trial))?;
        if let (PressSensor::Camera(Ok(camera)), Some(pictures)) =
            (&self.sensor, &mut readings.pictures)
        {
            pictures.calibrating = camera.calibrating(trial)?;
        }
        self.judged(readings)
    }

    fn judged(&self, readings: MarkerReadings) -> Result<JudgedCurvature, PressFailure> {
        let estimate = self.estimate_from(&readings)?;
        let doubts = self.doubts(&readings, &estimate)?;
        let estimated = estimate.object_curvature();
        let truth = self.pressed.object.curvature;
        let indentation = self.measured_indentation(&readings);
        let pictures = self.method.of_pictures.as_ref().zip(readings.pictures);
        let std_bound = pictures.and_then(|(method, pictures)| {
            let skin = self.markers.skin();
            let relative = skin.curvature() + truth;
            let depth = self.pressed.indentation;
            method.std_bound(&pictures, indentation, (relative, self.pressed.at, depth))
        });
        Ok(JudgedCurvature {
            estimated,
            truth,
            holds: hold(&estimated, truth),
            std_bound,
            p_value: estimate.goodness.map(|goodness| goodness.p_value),
            doubts,
        })
    }

    /// Cramér–Rao bound on the standard deviation of the curvature, 1/length, from the pixel noise of the pressed
    /// frame alone: the sensor is nominal and exactly known. `None` unless noisy frames are rendered and trials
    /// redraw the sensor.
    pub fn pixel_std_bound(&self) -> Option<f64> {
        let PressSensor::Camera(Ok(camera)) = &self.sensor else {
            return None;
        };
        let (redrawn, eye) = (camera.redrawn.as_ref()?, &camera.sensor.eye);
        let std = eye.pixel_std()?;
        let levels = |pressed: &Pressed| {
            let motions = redrawn.motions(pressed, [0.0; 2]).ok()?;
            let motions: Vec<Option<MarkerMotion>> = motions.into_iter().map(Some).collect();
            eye.optics.levels(&motions).ok()
        };
        let slope = |unknown: usize| {
            let (step, [less, more]) = self.beside(unknown);
            let (less, more) = (levels(&less)?, levels(&more)?);
            let pairs = less.iter().zip(&more);
            let slopes = pairs.map(|(less, more)| f64::from(more - less) / (2.0 * step * std));
            Some(slopes.collect::<Vec<f64>>())
        };
        let slopes: Vec<Vec<f64>> = (0..UNKNOWNS).map(slope).collect::<Option<_>>()?;
        let mut information = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|row, column| {
            let pairs = slopes[row].iter().zip(&slopes[column]);
            pairs.map(|(one, other)| one * other).sum()
        });
        if let Some(std) = self.method.known_indentation {
            // The minimum keeps the information finite if the indentation is exact.
            information[(3, 3)] += std.max(1e-9 * self.pressed.indentation).powi(-2);
        }
        let covariance = information.try_inverse()?;
        Some(covariance[(0, 0)].sqrt()).filter(|std| std.is_finite())
    }

    /// Two presses, with an unknown decreased and increased by a step, and this step.
    fn beside(&self, unknown: usize) -> (f64, [Pressed; 2]) {
        let radius = self.markers.skin().radius();
        let relative = self.markers.skin().curvature() + self.pressed.object.curvature;
        let step = match unknown {
            0 => SHARE * relative,
            _ => STEP * radius,
        };
        let at = |step: f64| {
            let mut pressed = self.pressed;
            match unknown {
                0 => pressed.object.curvature += step,
                3 => pressed.indentation += step,
                axis => pressed.at[axis - 1] += step,
            }
            pressed
        };
        (step, [at(-step), at(step)])
    }
}
