//! A press that is ready to run, and its trials.

use std::sync::OnceLock;

use palpate_chance::{HALF_WIDTHS, NORMAL_95};
use palpate_number::{BadSetting, Number};
use palpate_press::{
    Bounds, Doubt, Estimated, ForwardFit, MarkerDisplacement, Markers, Measured, PressError,
    PressEstimate, Reading,
};

use super::failure::PressFailure;
use super::ladder::PressRungs;
use super::pictures::PictureMethod;
use super::pressed::Pressed;
use super::readings::{MarkerNoise, MarkerReadings};
use super::seen::CameraPress;
use super::soft_body::SoftBody;
use crate::ladder::Ladder;
use crate::map::MapTable;
use crate::need::{Need, Warning};
use crate::plan::PlanError;
use crate::trace::{Trace, TraceError};
use crate::trials::{Outcome, Trials};
use palpate_study::Quantity;
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

/// Quantities of a press before a camera, which adds errors of every marker that is tracked, the hue change and the
/// shift of the marker under the contact, and how the tracking went.
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
    /// True contact and displacements; or why there is no press, and then every trial fails.
    pub(super) truth: Result<TruePress, PressError>,
    pub(super) sensor: PressSensor,
    /// Whether displacements along the skin are read.
    pub(super) tangential: bool,
    pub(super) noise: MarkerNoise,
    pub(super) method: PressMethod,
    pub(super) bounds: Option<Bounds>,
    pub(super) rungs: PressRungs,
    /// Needs of the scene: its model, sensor and noise in words.
    pub(super) needs: Vec<Need>,
    /// Estimate from readings without noise, once it was asked for.
    pub(super) exact: OnceLock<Result<PressEstimate, PressFailure>>,
}

/// Truth of a press.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TruePress {
    pub(super) contact_radius: f64,
    /// Displacements of the markers, midway between their discs.
    pub(super) markers: Vec<MarkerDisplacement>,
}

/// Sensor that reads a press.
#[derive(Clone, Debug)]
pub(super) enum PressSensor {
    /// Displacements, as they are.
    Direct,
    /// A camera with the markers before it; or why there is no press to be seen, and then every trial fails.
    Camera(Result<Box<CameraPress>, PressError>),
}

/// How curvature follows from the readings.
#[derive(Clone, Debug)]
pub(super) struct PressMethod {
    /// The fit, or why there is none: then every trial fails.
    pub(super) fit: Result<ForwardFit, PressError>,
    /// The fit of pictures, where that is the method.
    pub(super) of_pictures: Option<PictureMethod>,
    /// Standard deviation ascribed to the given indentation; `None` where none is given.
    pub(super) known_indentation: Option<f64>,
}

impl PressScene {
    /// The indentation that an estimator is given where it is known: the truth, or in trial number `trial`.
    pub fn told_indentation(&self, trial: Option<u64>) -> f64 {
        let error = trial.map_or(0.0, |trial| self.noise.of_indentation(self.seed, trial));
        self.pressed.indentation + error
    }

    /// Standard deviations of normal and tangential displacements that the estimator is told, length; `None` where it finds
    /// them from the residuals.
    pub(crate) fn told_stds(&self) -> [Option<f64>; 2] {
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

    /// Ways in which readings contradict the model, of the estimate from them.
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

    /// The indentation that the estimator is told.
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

    /// Index of a quantity among those of the scene, if it is one.
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

    /// Tells the quantities that a camera adds, of a trial that was estimated from.
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

/// Quantities of a press, before a camera or not, on an object that has a radius or not.
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

    /// Whether the readings have enough markers, and the method settings that can be, to tell a press. Where there is no
    /// press, or none to be seen, the scene can still be run: its trials fail.
    fn estimable(&self) -> Result<(), PlanError> {
        match self.exact() {
            Err(PressFailure::Press(error @ PressError::TooFewMarkers { .. })) => {
                Err(PlanError::at("scene.probe.layout", error))
            }
            Err(PressFailure::Press(
                error @ PressError::BadSetting(BadSetting { setting, .. }),
            )) => Err(PlanError::at(format!("scene.estimator.{setting}"), error)),
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
        // An object taken for flat has no finite radius.
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

    /// Bound by what the readings can tell by the scene's own body and noise. What the estimator has to find out itself
    /// counts as unknown; of what it is told, the noise that is drawn, else that which it is told of.
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

    fn ladder(&self) -> Result<Option<Ladder>, PlanError> {
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

/// Whether the intervals of 50, 80 and 95 % hold a truth. The last is that of the estimate; the sides of the others are
/// as much shorter as those of a normal distribution, or, where that one is open, as long as those.
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

/// Shares of the relative curvature by which an estimate without noise is far off: by any interval of its own, and where
/// that leaves the truth out.
const FAR_OFF: [f64; 2] = [0.5, 0.05];

/// A warning where an estimate without noise is far off the object's curvature.
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

/// Share of the variance of normal displacements that a fit to readings without noise explains at the least, where it
/// is of the body that was pressed.
const LEAST_EXPLAINED: f64 = 0.95;

/// A warning where the fit to readings without noise leaves much of them unexplained: with noise it may go anywhere.
fn unexplained(estimate: &PressEstimate) -> Option<Warning> {
    let explained = estimate.r_squared;
    (explained < LEAST_EXPLAINED).then(|| {
        let percent = 100.0 * explained.max(0.0);
        let text = format!("even without noise the estimator explains only {percent:.0} % of the variance of the normal displacements: what it assumes of body, contact or readings does not hold here");
        Warning::new("unexplained-readings", text, [("r_squared", explained)])
    })
}
