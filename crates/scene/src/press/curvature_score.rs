//! Curvature estimates of single trials compared with the truth, and bounds on their standard deviation.

use nalgebra::SMatrix;
use palpate_chromatouch::MarkerMotion;
use palpate_press::{Estimated, Misfit};

use super::PressFailure;
use super::reading::PressReading;
use super::trial::{PressScene, given_indentation_std, hold};
use super::truth::PressGeometry;

/// Number of unknowns that change the pixels: relative curvature, two contact coordinates, indentation.
const UNKNOWNS: usize = 4;
/// Finite-difference step of the contact coordinates and the indentation, in sensor radii.
const STEP: f64 = 2e-4;
/// Finite-difference step of the relative curvature, as a fraction of it.
const RELATIVE_STEP: f64 = 1e-2;

/// The object's curvature as estimated in one trial, 1/length.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvatureScore {
    /// The estimate with its interval.
    pub estimated: Estimated,
    /// The true curvature.
    pub truth: f64,
    /// Whether the 50, 80 and 95 % intervals contain the true curvature.
    pub holds: [bool; 3],
    /// Cramér–Rao bound on the standard deviation, from the stated errors of tracker and calibration; `None` if the
    /// fit does not use images.
    pub std_bound: Option<f64>,
    /// Goodness-of-fit p-value, if the fit has one.
    pub p_value: Option<f64>,
    /// Ways in which the readings contradict the model.
    pub misfits: Vec<Misfit>,
}

impl PressScene {
    /// Estimates the object's curvature in trial number `trial`.
    ///
    /// # Errors
    /// Failure of the trial.
    pub fn curvature_score(&self, trial: u64) -> Result<CurvatureScore, PressFailure> {
        self.score(&self.reading(Some(trial))?)
    }

    /// Estimates the object's curvature in trial number `trial`, with a sensor that is calibrated by its frame at
    /// rest and the presses of `scene.sensor.calibration`. `scene.noise.sensor` states its uncertainty before
    /// calibration. Only fits of images use these presses.
    ///
    /// # Errors
    /// Failure of the trial.
    pub fn calibrated_curvature_score(&self, trial: u64) -> Result<CurvatureScore, PressFailure> {
        let mut reading = self.reading(Some(trial))?;
        let (truth, sensor) = self.case.press()?;
        if let (Some(sensor), Some(camera)) = (sensor.camera(), &mut reading.camera) {
            camera.images.calibrating = sensor.calibration_presses(truth, trial)?;
        }
        self.score(&reading)
    }

    fn score(&self, reading: &PressReading) -> Result<CurvatureScore, PressFailure> {
        let estimate = self.estimate(reading)?;
        let indentation = self.given_indentation(reading);
        let images = self.estimator.images(reading);
        let (stated, mut misfits) = match images {
            Some((fit, images)) => (
                fit.check_indentation(images, indentation),
                fit.misfits(images, indentation, &estimate)?,
            ),
            None => self.with_fit(reading, |fit, reading| {
                let stated = fit.check_indentation(reading, Some(&estimate));
                Ok((stated, fit.misfits(reading, &estimate)?))
            })?,
        };
        misfits.extend(stated.ok().flatten());
        let estimated = estimate.object_curvature();
        let truth = self.geometry.object.curvature;
        let std_bound = images.and_then(|(fit, images)| {
            let relative = self.markers.skin().curvature() + truth;
            let press = (relative, self.geometry.at, self.geometry.indentation);
            fit.std_bound(images, indentation, press)
        });
        Ok(CurvatureScore {
            estimated,
            truth,
            holds: hold(&estimated, truth),
            std_bound,
            p_value: estimate.goodness.map(|goodness| goodness.p_value),
            misfits,
        })
    }

    /// Cramér–Rao bound on the standard deviation of the curvature, 1/length, from the pixel noise of the pressed
    /// frame alone. The sensor is assumed to have exactly its nominal parameters. `None` unless noisy frames are
    /// rendered and trials redraw the sensor.
    pub fn pixel_std_bound(&self) -> Option<f64> {
        let sensor = self.case.camera()?;
        let (variation, camera) = (sensor.variation.as_ref()?, &sensor.camera);
        let std = camera.pixel_std()?;
        let levels = |geometry: &PressGeometry| {
            let motions = variation.motions(geometry, [0.0; 2]).ok()?;
            let motions: Vec<Option<MarkerMotion>> = motions.into_iter().map(Some).collect();
            camera.optics.levels(&motions).ok()
        };
        let slope = |unknown: usize| {
            let (step, [less, more]) = self.steps(unknown);
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
        if let Some(std) = given_indentation_std(&self.config.estimator) {
            // The minimum keeps the information finite if the indentation is exact.
            information[(3, 3)] += std.max(1e-9 * self.geometry.indentation).powi(-2);
        }
        let covariance = information.try_inverse()?;
        Some(covariance[(0, 0)].sqrt()).filter(|std| std.is_finite())
    }

    /// Finite-difference step of an unknown, and the presses with the unknown decreased and increased by it.
    fn steps(&self, unknown: usize) -> (f64, [PressGeometry; 2]) {
        let radius = self.markers.skin().radius();
        let relative = self.markers.skin().curvature() + self.geometry.object.curvature;
        let step = match unknown {
            0 => RELATIVE_STEP * relative,
            _ => STEP * radius,
        };
        let at = |step: f64| {
            let mut geometry = self.geometry;
            match unknown {
                0 => geometry.object.curvature += step,
                3 => geometry.indentation += step,
                axis => geometry.at[axis - 1] += step,
            }
            geometry
        };
        (step, [at(-step), at(step)])
    }
}
