//! A press that is ready to run, and its trials.

use std::sync::OnceLock;

use palpate_press::{
    Bounds, Doubt, Estimated, ForwardFit, MarkerDisplacement, Markers, Measured, PressError,
    PressEstimate, Reading,
};
use palpate_statistics::{BadSetting, HALF_WIDTHS, NORMAL_95, Number};

use super::failure::PressFailure;
use super::ladder::PressRungs;
use super::pressed::Pressed;
use super::readings::{MarkerNoise, MarkerReadings};
use super::seen::CameraPress;
use super::soft_body::SoftBody;
use crate::ladder::Ladder;
use crate::need::Need;
use crate::trace::{Trace, TraceError};
use crate::trials::{Outcome, Trials};
use palpate_estimators::ImageEstimator;
use palpate_study::FieldError;
use palpate_study::MapTable;
use palpate_study::Quantity;
use palpate_study::Warning;
use palpate_study::config::{LengthUnit, PressConfig, PressObjectConfig, PressSensorConfig};

/// Quantities of a press that is read directly.
static OF_DIRECT: [Quantity; 7] = [
    Quantity::RELATIVE_CURVATURE,
    Quantity::EFFECTIVE_RADIUS,
    Quantity::OBJECT_CURVATURE,
    Quantity::INDENTATION,
    Quantity::CONTACT_RADIUS,
    Quantity::R_SQUARED,
    Quantity::OBJECT_RADIUS,
];

/// Quantities of a press with a camera. It adds the errors of each tracked marker, the hue change and the shift of
/// the marker under the contact, and the results of tracking.
static OF_CAMERA: [Quantity; 14] = [
    Quantity::RELATIVE_CURVATURE,
    Quantity::EFFECTIVE_RADIUS,
    Quantity::OBJECT_CURVATURE,
    Quantity::INDENTATION,
    Quantity::CONTACT_RADIUS,
    Quantity::R_SQUARED,
    Quantity::NORMAL_DISPLACEMENT,
    Quantity::TANGENTIAL_DISPLACEMENT,
    Quantity::HUE_CHANGE,
    Quantity::CENTROID_SHIFT,
    Quantity::MARKERS_TRACKED,
    Quantity::WRONG_MATCHES,
    Quantity::PIXELS,
    Quantity::OBJECT_RADIUS,
];

/// A press that is ready to run: the truth, the sensor, the noise and the method of a cell.
#[derive(Clone, Debug)]
pub struct PressScene {
    pub(super) seed: u64,
    /// Chart coordinates of the markers.
    pub(super) places: Vec<[f64; 2]>,
    pub(super) markers: Markers,
    pub(super) body: SoftBody,
    pub(super) pressed: Pressed,
    /// True contact and displacements, or why the press is impossible: then every trial fails.
    pub(super) truth: Result<TruePress, PressError>,
    pub(super) sensor: PressSensor,
    /// Whether displacements along the skin are read.
    pub(super) tangential: bool,
    pub(super) noise: MarkerNoise,
    pub(super) method: PressMethod,
    pub(super) bounds: Option<Bounds>,
    pub(super) rungs: PressRungs,
    /// Lines for `palpate check`: the model, the sensor, the noise and warnings.
    pub(super) needs: Vec<Need>,
    /// Estimate from readings without noise, computed on first use.
    pub(super) exact: OnceLock<Result<PressEstimate, PressFailure>>,
}

/// True values of a press.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TruePress {
    pub(super) contact_radius: f64,
    /// Displacements of the markers, midway between their discs.
    pub(super) markers: Vec<MarkerDisplacement>,
}

/// Sensor that reads a press.
#[derive(Clone, Debug)]
pub(super) enum PressSensor {
    /// Reads the displacements directly.
    Direct,
    /// A camera with the markers, or why there is no press to image: then every trial fails.
    Camera(Result<Box<CameraPress>, PressError>),
}

/// The method that estimates curvature from the readings.
#[derive(Clone, Debug)]
pub(super) struct PressMethod {
    /// The fit, or why there is none: then every trial fails.
    pub(super) fit: Result<ForwardFit, PressError>,
    /// The fit of pictures, if the config uses it.
    pub(super) of_pictures: Option<ImageEstimator>,
    /// Stated standard deviation of the given indentation; `None` if none is given.
    pub(super) known_indentation: Option<f64>,
}

impl PressScene {
    /// The indentation given to the estimator: the true one, or with the error of trial number `trial`.
    pub fn told_indentation(&self, trial: Option<u64>) -> f64 {
        let error = trial.map_or(0.0, |trial| self.noise.of_indentation(self.seed, trial));
        self.pressed.indentation + error
    }

    /// Standard deviations of normal and tangential displacements that the estimator assumes, length; `None` if it
    /// estimates them from the residuals.
    pub fn stated_stds(&self) -> [Option<f64>; 2] {
        let fit = self.method.fit.as_ref();
        fit.map_or([None; 2], |fit| [fit.normal_std, fit.tangential_std])
    }

    /// Readings of the sensor: without noise, or in trial number `trial`.
    pub(super) fn readings(&self, trial: Option<u64>) -> Result<MarkerReadings, PressFailure> {
        let truth = self.truth.as_ref().map_err(|error| *error)?;
        let mut readings = MarkerReadings {
            tracked: None,
            normal: truth.markers.iter().map(|marker| marker.normal).collect(),
            tangential: truth.markers.iter().map(|one| one.tangential).collect(),
            indentation: self.told_indentation(trial),
            sight: None,
            pictures: None,
        };
        if let PressSensor::Camera(camera) = &self.sensor {
            let camera = camera.as_ref().map_err(|error| *error)?;
            camera.read(&mut readings, trial)?;
        }
        if let Some(trial) = trial {
            self.noise.add_to(&mut readings, self.seed, trial);
        }
        readings.keep_tracked();
        Ok(readings)
    }

    pub(super) fn estimate(&self, trial: Option<u64>) -> Result<PressEstimate, PressFailure> {
        self.estimate_from(&self.readings(trial)?)
    }

    /// Estimate from readings without noise.
    fn exact(&self) -> Result<&PressEstimate, &PressFailure> {
        self.exact.get_or_init(|| self.estimate(None)).as_ref()
    }

    pub(super) fn estimate_from(
        &self,
        readings: &MarkerReadings,
    ) -> Result<PressEstimate, PressFailure> {
        let indentation = self.measured_indentation(readings);
        if let (Some(method), Some(pictures)) = (&self.method.of_pictures, &readings.pictures) {
            return Ok(method.estimate(pictures, indentation)?);
        }
        self.by_displacements(readings, |fit, reading| fit.estimate(reading))
    }

    /// Warnings that the readings contradict the model of the estimate.
    pub(super) fn doubts(
        &self,
        readings: &MarkerReadings,
        estimate: &PressEstimate,
    ) -> Result<Vec<Doubt>, PressFailure> {
        let indentation = self.measured_indentation(readings);
        if let (Some(method), Some(pictures)) = (&self.method.of_pictures, &readings.pictures) {
            return Ok(method.doubts(pictures, indentation, estimate)?);
        }
        self.by_displacements(readings, |fit, reading| fit.doubts(reading, estimate))
    }

    /// The indentation given to the estimator, if any.
    pub(super) fn measured_indentation(&self, readings: &MarkerReadings) -> Option<Measured> {
        self.method.known_indentation.map(|std| Measured {
            value: readings.indentation,
            std,
        })
    }

    fn by_displacements<T>(
        &self,
        readings: &MarkerReadings,
        then: impl FnOnce(&ForwardFit, &Reading<'_>) -> Result<T, PressError>,
    ) -> Result<T, PressFailure> {
        let fit = self.method.fit.as_ref().map_err(|error| *error)?;
        let tracked = readings
            .tracked
            .as_ref()
            .map(|tracked| self.markers.subset(tracked));
        let reading = Reading {
            markers: tracked.as_ref().unwrap_or(&self.markers),
            normal: &readings.normal,
            tangential: self.tangential.then_some(&readings.tangential),
            indentation: self.measured_indentation(readings),
        };
        Ok(then(fit, &reading)?)
    }

    /// Index of a quantity among the scene's quantities, if the scene has it.
    fn place(&self, quantity: Quantity) -> Option<usize> {
        self.quantities().iter().position(|one| *one == quantity)
    }

    fn truth_of(&self, quantity: Quantity) -> Option<f64> {
        let object = &self.pressed.object;
        let relative_curvature = self.markers.skin().curvature() + object.curvature;
        match quantity {
            Quantity::RELATIVE_CURVATURE => Some(relative_curvature),
            Quantity::EFFECTIVE_RADIUS => {
                (relative_curvature > 0.0).then(|| relative_curvature.recip())
            }
            Quantity::OBJECT_CURVATURE => Some(object.curvature),
            Quantity::INDENTATION => Some(self.pressed.indentation),
            Quantity::CONTACT_RADIUS => {
                let truth = self.truth.as_ref().ok();
                truth.map(|truth| truth.contact_radius)
            }
            Quantity::R_SQUARED => Some(1.0),
            Quantity::OBJECT_RADIUS => object.radius,
            _ => None,
        }
    }

    /// Reports the quantities that a camera adds, after a successful estimate.
    fn observe_sight(&self, readings: &MarkerReadings, observe: &mut dyn FnMut(usize, Outcome)) {
        let (Some(sight), Ok(truth), PressSensor::Camera(Ok(camera))) =
            (&readings.sight, &self.truth, &self.sensor)
        else {
            return;
        };
        let mut tell = |place: Option<usize>, outcome: Outcome| {
            if let Some(place) = place {
                observe(place, outcome);
            }
        };
        let of_normal = self.place(Quantity::NORMAL_DISPLACEMENT);
        let of_tangential = self.place(Quantity::TANGENTIAL_DISPLACEMENT);
        let tracked = readings.tracked.iter().flatten();
        let read = tracked.zip(readings.normal.iter().zip(&readings.tangential));
        for (&marker, (&normal, tangential)) in read {
            let moved = &truth.markers[marker];
            tell(of_normal, Outcome::plain(normal, moved.normal));
            if self.tangential {
                for (read, truth) in tangential.iter().zip(moved.tangential) {
                    tell(of_tangential, Outcome::plain(*read, truth));
                }
            }
        }
        let mut tell = |quantity, outcome| tell(self.place(quantity), outcome);
        if let (Some(read), Some(exact)) = (camera.under_contact(sight), camera.shown) {
            let hue = Outcome::plain(read.hue_turns, exact.hue_turns);
            tell(Quantity::HUE_CHANGE, hue);
            let shift = Outcome::plain(read.shift_px, exact.shift_px);
            tell(Quantity::CENTROID_SHIFT, shift);
        }
        let tracked = Outcome::plain(readings.normal.len() as f64, camera.seen as f64);
        tell(Quantity::MARKERS_TRACKED, tracked);
        let wrong = Outcome::plain(sight.wrong_matches as f64, 0.0);
        tell(Quantity::WRONG_MATCHES, wrong);
        tell(Quantity::PIXELS, Outcome::exact(camera.sensor.eye.pixels()));
    }
}

/// Quantities of a press with or without a camera, on an object with or without a radius.
fn quantities(has_camera: bool, has_radius: bool) -> &'static [Quantity] {
    let all: &[Quantity] = if has_camera { &OF_CAMERA } else { &OF_DIRECT };
    let others = all.strip_suffix(&[Quantity::OBJECT_RADIUS]);
    match has_radius {
        true => all,
        false => others.unwrap_or(all),
    }
}

impl PressScene {
    /// Quantities that the press of a config observes.
    pub(crate) fn quantities_of(config: &PressConfig) -> &'static [Quantity] {
        let is_direct = matches!(config.sensor, PressSensorConfig::Direct { .. });
        let is_plane = matches!(config.object, PressObjectConfig::Plane {});
        quantities(!is_direct, !is_plane)
    }
}

impl Trials for PressScene {
    fn quantities(&self) -> &'static [Quantity] {
        let has_camera = matches!(self.sensor, PressSensor::Camera(_));
        quantities(has_camera, self.pressed.object.radius.is_some())
    }

    fn is_random(&self) -> bool {
        let knows = self.method.known_indentation.is_some();
        let camera = match &self.sensor {
            PressSensor::Camera(Ok(camera)) => camera.is_random(),
            PressSensor::Camera(Err(_)) | PressSensor::Direct => false,
        };
        camera || self.noise.is_random(self.tangential, knows)
    }

    /// Fails if there are too few markers or a setting of the method is invalid. If there is no press, or the camera
    /// cannot image it, the scene can still run: its trials fail.
    fn estimable(&self) -> Result<(), FieldError> {
        match self.exact() {
            Err(PressFailure::Press(error @ PressError::TooFewMarkers { .. })) => {
                Err(FieldError::at("scene.probe.layout", error))
            }
            Err(PressFailure::Press(
                error @ PressError::BadSetting(BadSetting { setting, .. }),
            )) => Err(FieldError::at(format!("scene.estimator.{setting}"), error)),
            Ok(_) | Err(_) => Ok(()),
        }
    }

    fn trial(
        &self,
        trial: u64,
        observe: &mut dyn FnMut(usize, Outcome),
    ) -> Result<(), &'static str> {
        let readings = self.readings(Some(trial)).map_err(|error| error.name())?;
        let estimate = self
            .estimate_from(&readings)
            .map_err(|error| error.name())?;
        let mut tell = |quantity: Quantity, outcome: Outcome| {
            if let Some(place) = self.place(quantity) {
                observe(place, outcome);
            }
        };
        let curvature = estimate.object_curvature();
        for (quantity, estimated) in [
            (Quantity::RELATIVE_CURVATURE, estimate.relative_curvature),
            (Quantity::EFFECTIVE_RADIUS, estimate.effective_radius()),
            (Quantity::OBJECT_CURVATURE, curvature),
            (Quantity::INDENTATION, estimate.indentation),
            (Quantity::CONTACT_RADIUS, estimate.contact_radius),
        ] {
            if let Some(truth) = self.truth_of(quantity) {
                tell(quantity, outcome(&estimated, truth));
            }
        }
        tell(Quantity::R_SQUARED, Outcome::plain(estimate.r_squared, 1.0));
        // An object that is estimated to be flat has no finite radius.
        let radius = estimate.most_likely_object_curvature().recip();
        if let Some(truth) = self.pressed.object.radius
            && radius.is_finite()
        {
            let of_curvature = outcome(&curvature, self.pressed.object.curvature);
            let of_radius = Outcome {
                std: finite(curvature.std * radius * radius),
                interval_holds: of_curvature.interval_holds,
                ..Outcome::plain(radius, truth)
            };
            tell(Quantity::OBJECT_RADIUS, of_radius);
        }
        self.observe_sight(&readings, observe);
        Ok(())
    }

    fn truth(&self, quantity: usize) -> Option<f64> {
        self.truth_of(*self.quantities().get(quantity)?)
    }

    /// Cramér–Rao bound for the scene's own body and noise. Fitted parameters are unknowns. Given ones have the noise
    /// that is drawn or, without such noise, the standard deviation in the config.
    fn std_bound(&self, quantity: usize) -> Option<f64> {
        let bounds = self.bounds?;
        let quantity = *self.quantities().get(quantity)?;
        let of_radius = |radius: f64| bounds.relative_curvature * (radius * radius);
        finite(match quantity {
            Quantity::RELATIVE_CURVATURE | Quantity::OBJECT_CURVATURE => bounds.relative_curvature,
            Quantity::EFFECTIVE_RADIUS | Quantity::OBJECT_RADIUS => {
                of_radius(self.truth_of(quantity)?)
            }
            Quantity::INDENTATION => bounds.indentation,
            Quantity::CONTACT_RADIUS => bounds.contact_radius,
            _ => return None,
        })
    }

    fn needs(&self) -> Vec<Need> {
        let mut needs = self.needs.clone();
        let estimate = self.truth.is_ok().then(|| self.exact());
        let warning = estimate.and_then(|estimate| match estimate {
            Ok(estimate) => far_off(estimate, self.pressed.object.curvature),
            Err(error) => {
                let name = error.name();
                let text = format!("even without noise the estimate fails as `{name}`: {error}");
                Some(Warning::new("no-estimate", text, []))
            }
        });
        needs.extend(warning.map(Need::from));
        needs
    }

    fn ladder(&self) -> Result<Option<Ladder>, FieldError> {
        self.rungs.ladder(&self.markers, &self.pressed).map(Some)
    }

    fn trace(&self, trial: Option<u64>, unit: LengthUnit) -> Result<Trace, TraceError> {
        Ok(self.followed(trial, unit)?)
    }

    fn map_table(&self, unit: LengthUnit) -> Result<MapTable, &'static str> {
        Ok(Self::profile_table(unit))
    }

    fn map(&self, cell: usize, trial: u64, table: &mut MapTable) -> Result<(), &'static str> {
        self.push_profile(cell, trial, table)
            .map_err(|error| error.name())
    }
}

fn outcome(estimated: &Estimated, truth: f64) -> Outcome {
    Outcome {
        std: finite(estimated.std),
        interval_holds: Some(hold(estimated, truth)),
        ..Outcome::plain(estimated.value, truth)
    }
}

/// Whether the 50, 80 and 95 % intervals contain the truth. The 95 % interval is the estimate's own. The others scale
/// its half-width as for a normal distribution, or use `std` where it is open.
pub(super) fn hold(estimated: &Estimated, truth: f64) -> [bool; 3] {
    let Estimated {
        value,
        std,
        interval,
    } = *estimated;
    let end = if truth < value {
        interval.low
    } else {
        interval.high
    };
    let one_std = end.map_or(std, |end| (end - value).abs() / NORMAL_95);
    let [narrowest, narrow, _] = HALF_WIDTHS.map(|width| (truth - value).abs() <= width * one_std);
    [narrowest, narrow, interval.holds(truth)]
}

fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

/// Errors, relative to the relative curvature, above which a noiseless estimate counts as biased: in any case, and if
/// its interval excludes the truth.
const FAR_OFF: [f64; 2] = [0.5, 0.05];

/// Warns if an estimate without noise is far from the object's curvature.
fn far_off(estimate: &PressEstimate, object: f64) -> Option<Warning> {
    let estimated = estimate.object_curvature();
    let [far, beside] = FAR_OFF.map(|share| share * (estimate.sensor_curvature + object));
    let off = (estimated.value - object).abs();
    if off <= beside {
        return None;
    }
    match off > far || !estimated.interval.holds(object) {
        true => {
            let numbers = [
                ("estimated_curvature", estimated.value),
                ("true_curvature", object),
            ];
            let [found, object] = numbers.map(|(_, number)| Number::rounded(number));
            let text = format!(
                "even without noise the estimated curvature is {found}, where it is {object}: what the estimator assumes of body, contact or readings does not hold here"
            );
            Some(Warning::new("biased-estimate", text, numbers))
        }
        false => unexplained(estimate),
    }
}

/// A fit to noiseless readings with the correct body explains at least this fraction of the variance of normal
/// displacements.
const LEAST_EXPLAINED: f64 = 0.95;

/// Warns if the fit explains the noiseless readings badly: with noise its result is unpredictable.
fn unexplained(estimate: &PressEstimate) -> Option<Warning> {
    let explained = estimate.r_squared;
    (explained < LEAST_EXPLAINED).then(|| {
        let percent = 100.0 * explained.max(0.0);
        let text = format!("even without noise the estimator explains only {percent:.0} % of the variance of the normal displacements: what it assumes of body, contact or readings does not hold here");
        Warning::new("unexplained-readings", text, [("r_squared", explained)])
    })
}
