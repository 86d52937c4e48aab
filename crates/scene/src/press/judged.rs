//! Estimates of single trials beside the truth, and what any estimate could reach.

use nalgebra::SMatrix;
use palpate_chromatouch::MarkerMotion;
use palpate_press::{Doubt, Estimated};

use super::failure::PressFailure;
use super::pressed::Pressed;
use super::readings::MarkerReadings;
use super::scene::{PressScene, PressSensor, hold};

/// Unknowns of a press to which pixels are sensitive: relative curvature, both coordinates of the contact, indentation.
const UNKNOWNS: usize = 4;
/// Steps of the contact's coordinates and of the indentation by which slopes are found, in radii of the sensor.
const STEP: f64 = 2e-4;
/// Step of the relative curvature, as a share of it.
const SHARE: f64 = 1e-2;

/// The object's curvature as one trial tells it, 1/length.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedCurvature {
    /// The estimate with its interval.
    pub estimated: Estimated,
    /// The true curvature.
    pub truth: f64,
    /// Whether the intervals of 50, 80 and 95 % hold it.
    pub holds: [bool; 3],
    /// The Cramér–Rao bound on the standard deviation, from the errors that the tracker and the calibration state; `None`
    /// of fits that are not of pictures.
    pub std_bound: Option<f64>,
    /// P-value of the fit; `None` where it has none.
    pub p_value: Option<f64>,
    /// Ways in which the readings contradict the model.
    pub doubts: Vec<Doubt>,
}

impl PressScene {
    /// The object's curvature as trial number `trial` tells it.
    ///
    /// # Errors
    /// Failure of the trial.
    pub fn judged_curvature(&self, trial: u64) -> Result<JudgedCurvature, PressFailure> {
        self.judged(self.readings(Some(trial))?)
    }

    /// The object's curvature as trial number `trial` tells it, by a sensor that the presses of `scene.sensor.calibration`
    /// tell too, beside its frame at rest: `scene.noise.sensor` is then what is known of it before them. Of fits of
    /// pictures.
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

    /// The Cramér–Rao bound on the standard deviation of the curvature by the noise of the pressed frame's pixels alone,
    /// 1/length: of the sensor as it is meant to be, all of which is known. `None` without frames, noise of their pixels, or
    /// sensors that trials draw.
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
            // An indentation that is exact is no unknown.
            information[(3, 3)] += std.max(1e-9 * self.pressed.indentation).powi(-2);
        }
        let covariance = information.try_inverse()?;
        Some(covariance[(0, 0)].sqrt()).filter(|std| std.is_finite())
    }

    /// The presses on both sides of this one along an unknown, and the step between.
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
