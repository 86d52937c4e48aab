//! A press: a soft spherical sensor touches an object once, and the object's curvature is estimated from how the markers
//! under its skin move.

mod camera;
mod failure;
mod ladder;
mod method;
mod noise;
mod plan;
mod profile;
mod seen;
mod trace;
mod words;

pub use failure::PressFailure;
pub(crate) use method::{Assumed, body_of};
pub(crate) use plan::{disc_depths, discs, layout_of, of_layout, of_optics};
pub use profile::ProfileTable;
pub use trace::PressTrace;
pub(crate) use words::large_contact;

use palpate_number::BadSetting;
use palpate_press::{
    Body, Bounds, Contact, Estimated, ForwardFit, MarkerDisplacement, Markers, Measured,
    PressError, PressEstimate, Reading, Skin,
};

use crate::{Outcome, PlanError};
use camera::Sight;
use noise::ReadingNoise;
use palpate_study::{Quantity, Unit};
use seen::CameraPress;

/// Quantities that every press estimates.
const ESTIMATED: [Quantity; 6] = [
    quantity("relative_curvature", Unit::PerLength),
    quantity("effective_radius", Unit::Length),
    quantity("object_curvature", Unit::PerLength),
    quantity("indentation", Unit::Length),
    quantity("contact_radius", Unit::Length),
    quantity("r_squared", Unit::One),
];

/// Quantities that a camera adds: errors of every marker that is tracked, the hue change and the shift of the marker
/// under the contact, and how the tracking went.
const SEEN: [Quantity; 7] = [
    quantity("normal_displacement", Unit::Length),
    quantity("tangential_displacement", Unit::Length),
    quantity("hue_change", Unit::Turn),
    quantity("centroid_shift", Unit::Pixel),
    quantity("markers_tracked", Unit::One),
    quantity("wrong_matches", Unit::One),
    quantity("pixels", Unit::One),
];

/// Quantity that comes last, only for objects that have a radius.
const RADIUS: Quantity = quantity("object_radius", Unit::Length);

const fn quantity(name: &'static str, unit: Unit) -> Quantity {
    Quantity { name, unit }
}

/// Quantities that a press with a direct sensor estimates. The last only of objects that have a radius.
const OF_DIRECT: [Quantity; 7] = {
    let [a, b, c, d, e, f] = ESTIMATED;
    [a, b, c, d, e, f, RADIUS]
};

/// Quantities that a press with a camera estimates. The last only of objects that have a radius.
const OF_CAMERA: [Quantity; 14] = {
    let ([a, b, c, d, e, f], [g, h, i, j, k, l, m]) = (ESTIMATED, SEEN);
    [a, b, c, d, e, f, g, h, i, j, k, l, m, RADIUS]
};

/// A press that is ready to run: the truth, the sensor, the noise and the method of a cell.
#[derive(Clone, Debug)]
pub struct PressScene {
    seed: u64,
    /// Chart coordinates of the markers.
    places: Vec<[f64; 2]>,
    markers: Markers,
    body: Body,
    object: PressedObject,
    indentation: f64,
    /// Chart coordinates of the contact.
    at: [f64; 2],
    /// True contact and displacements; or why there is no press, and then every trial fails.
    truth: Result<TruePress, PressError>,
    sensor: PressSensor,
    /// Whether displacements along the skin are read.
    tangential: bool,
    noise: ReadingNoise,
    method: PressMethod,
    bounds: Option<Bounds>,
    /// Needs of the scene: its model, sensor and noise in words.
    needs: Vec<String>,
}

/// The object, as far as a press feels it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PressedObject {
    /// 1/R_o, positive where convex.
    curvature: f64,
    /// R_o, negative for a dish; `None` for a plane.
    radius: Option<f64>,
}

/// Truth of a press.
#[derive(Clone, Debug, PartialEq)]
struct TruePress {
    contact_radius: f64,
    /// Displacements of the markers, midway between their discs.
    markers: Vec<MarkerDisplacement>,
}

/// Sensor that reads a press.
#[derive(Clone, Debug)]
enum PressSensor {
    /// Displacements, as they are.
    Direct,
    /// A camera with the markers before it; or why there is no press to be seen, and then every trial fails.
    Camera(Result<Box<CameraPress>, PressError>),
}

/// How curvature follows from the readings.
#[derive(Clone, Debug)]
struct PressMethod {
    /// The fit, or why there is none: then every trial fails.
    fit: Result<ForwardFit, PressError>,
    /// Standard deviation ascribed to the given indentation; `None` where none is given.
    known_indentation: Option<f64>,
}

/// Readings of a press.
#[derive(Clone, Debug, PartialEq)]
struct PressReadings {
    /// Indices of the tracked markers, in ascending order; `None` if all are tracked.
    tracked: Option<Vec<usize>>,
    normal: Vec<f64>,
    tangential: Vec<[f64; 2]>,
    /// Markers as a camera saw them; `None` with a direct sensor.
    sight: Option<Sight>,
}

impl PressReadings {
    /// Leaves out the markers that were not tracked.
    fn keep_tracked(&mut self) {
        if let Some(tracked) = &self.tracked {
            self.normal = tracked.iter().map(|&marker| self.normal[marker]).collect();
            self.tangential = tracked
                .iter()
                .map(|&marker| self.tangential[marker])
                .collect();
        }
    }
}

impl PressScene {
    /// Quantities that the scene estimates.
    pub fn quantities(&self) -> &'static [Quantity] {
        let all: &[Quantity] = match self.sensor {
            PressSensor::Direct => &OF_DIRECT,
            PressSensor::Camera(_) => &OF_CAMERA,
        };
        match self.object.radius {
            Some(_) => all,
            None => &all[..all.len() - 1],
        }
    }

    /// Whether trials differ.
    pub fn is_random(&self) -> bool {
        let knows = self.method.known_indentation.is_some();
        let camera = match &self.sensor {
            PressSensor::Camera(Ok(camera)) => camera.is_random(),
            PressSensor::Camera(Err(_)) | PressSensor::Direct => false,
        };
        camera || self.noise.is_random(self.tangential, knows)
    }

    /// Whether the readings have enough markers, and the method settings that can be, to tell a press. Where there is no
    /// press, or none to be seen, the scene can still be run: its trials fail.
    ///
    /// # Errors
    /// [`PlanError`] at what keeps them from it.
    pub fn estimable(&self) -> Result<(), PlanError> {
        match self.estimate(None) {
            Err(PressFailure::Press(error @ PressError::TooFewMarkers { .. })) => {
                Err(PlanError::at("scene.probe.layout", error))
            }
            Err(PressFailure::Press(
                error @ PressError::BadSetting(BadSetting { setting, .. }),
            )) => Err(PlanError::at(format!("scene.estimator.{setting}"), error)),
            Ok(_) | Err(_) => Ok(()),
        }
    }

    /// Standard deviations of normal and tangential displacements that the estimator is told, length; `None` where it finds
    /// them from the residuals.
    pub(crate) fn told_stds(&self) -> [Option<f64>; 2] {
        let fit = self.method.fit.as_ref();
        fit.map_or([None; 2], |fit| [fit.normal_std, fit.tangential_std])
    }

    fn skin(&self) -> &Skin {
        self.markers.skin()
    }

    /// The true contact.
    fn contact(&self) -> Result<Contact<'_>, PressError> {
        let object = self.object.curvature;
        self.skin().contact(&self.body, object, self.indentation)
    }

    /// Readings of the sensor: without noise, or in trial number `trial`.
    fn readings(&self, trial: Option<u64>) -> Result<PressReadings, PressFailure> {
        let truth = self.truth.as_ref().map_err(|error| *error)?;
        let mut readings = PressReadings {
            tracked: None,
            normal: truth.markers.iter().map(|marker| marker.normal).collect(),
            tangential: truth.markers.iter().map(|one| one.tangential).collect(),
            sight: None,
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

    fn estimate(&self, trial: Option<u64>) -> Result<PressEstimate, PressFailure> {
        self.estimate_from(&self.readings(trial)?, trial)
    }

    fn estimate_from(
        &self,
        readings: &PressReadings,
        trial: Option<u64>,
    ) -> Result<PressEstimate, PressFailure> {
        let fit = self.method.fit.as_ref().map_err(|error| *error)?;
        let tracked = readings
            .tracked
            .as_ref()
            .map(|tracked| self.markers.subset(tracked));
        Ok(fit.estimate(&Reading {
            markers: tracked.as_ref().unwrap_or(&self.markers),
            normal: &readings.normal,
            tangential: self.tangential.then_some(&readings.tangential),
            indentation: self.method.known_indentation.map(|std| Measured {
                value: self.told_indentation(trial),
                std,
            }),
        })?)
    }

    /// One trial, from truth to estimate; see [`crate::Scene::trial`].
    ///
    /// # Errors
    /// The stable name of what went wrong.
    pub fn trial(
        &self,
        trial: u64,
        mut observe: impl FnMut(usize, Outcome),
    ) -> Result<(), &'static str> {
        let readings = self.readings(Some(trial)).map_err(|error| error.name())?;
        let estimate = self
            .estimate_from(&readings, Some(trial))
            .map_err(|error| error.name())?;
        let curvature = estimate.object_curvature();
        for (quantity, estimated) in [
            estimate.relative_curvature,
            estimate.effective_radius(),
            curvature,
            estimate.indentation,
            estimate.contact_radius,
        ]
        .into_iter()
        .enumerate()
        {
            if let Some(truth) = self.truth(quantity) {
                observe(quantity, outcome(&estimated, truth));
            }
        }
        observe(5, plain(estimate.r_squared, 1.0));
        self.observe_sight(&readings, &mut observe);
        // An object taken for flat has no finite radius.
        let radius = estimate.most_likely_object_curvature().recip();
        if let Some(truth) = self.object.radius
            && radius.is_finite()
        {
            let of_curvature = outcome(&curvature, self.object.curvature);
            observe(
                self.quantities().len() - 1,
                Outcome {
                    estimate: radius,
                    truth,
                    std: finite(curvature.std * radius * radius),
                    interval_holds: of_curvature.interval_holds,
                },
            );
        }
        Ok(())
    }

    /// Reports the quantities that a camera adds, of a trial that was estimated from.
    fn observe_sight(&self, readings: &PressReadings, observe: &mut impl FnMut(usize, Outcome)) {
        let (Some(sight), Ok(truth)) = (&readings.sight, &self.truth) else {
            return;
        };
        let PressSensor::Camera(Ok(camera)) = &self.sensor else {
            return;
        };
        let first = ESTIMATED.len();
        let tracked = readings.tracked.iter().flatten();
        let read = tracked.zip(readings.normal.iter().zip(&readings.tangential));
        for (&marker, (&normal, tangential)) in read {
            let moved = &truth.markers[marker];
            observe(first, plain(normal, moved.normal));
            if self.tangential {
                for (read, truth) in tangential.iter().zip(moved.tangential) {
                    observe(first + 1, plain(*read, truth));
                }
            }
        }
        if let (Some(read), Some(exact)) = (camera.under_contact(sight), camera.shown) {
            observe(first + 2, plain(read.hue_turns, exact.hue_turns));
            observe(first + 3, plain(read.shift_px, exact.shift_px));
        }
        let tracked = readings.normal.len() as f64;
        observe(first + 4, plain(tracked, camera.seen as f64));
        observe(first + 5, plain(sight.wrong_matches as f64, 0.0));
        let pixels = camera.sensor.eye.pixels();
        observe(first + 6, plain(pixels, pixels));
    }

    /// The true value of a quantity, where it has one.
    pub fn truth(&self, quantity: usize) -> Option<f64> {
        let relative_curvature = self.skin().curvature() + self.object.curvature;
        match quantity {
            0 => Some(relative_curvature),
            1 => (relative_curvature > 0.0).then(|| relative_curvature.recip()),
            2 => Some(self.object.curvature),
            3 => Some(self.indentation),
            4 => self.truth.as_ref().ok().map(|truth| truth.contact_radius),
            5 => Some(1.0),
            last if last + 1 == self.quantities().len() => self.object.radius,
            _ => None,
        }
    }

    /// The Cramér–Rao bound on the standard deviation of a quantity, where it has one: what the readings can tell by the
    /// scene's own body and noise. What the estimator has to find out itself counts as unknown; of what it is told, the
    /// noise that is drawn, else that which it is told of.
    pub fn std_bound(&self, quantity: usize) -> Option<f64> {
        let bounds = self.bounds?;
        let square = |radius: f64| radius * radius;
        let bound = match quantity {
            0 | 2 => bounds.relative_curvature,
            1 => bounds.relative_curvature * square(self.truth(1)?),
            3 => bounds.indentation,
            4 => bounds.contact_radius,
            last if last + 1 == self.quantities().len() => {
                bounds.relative_curvature * square(self.object.radius?)
            }
            _ => return None,
        };
        finite(bound)
    }

    /// The models that the scene needs and why, one line each.
    pub fn needs(&self) -> Vec<String> {
        let mut needs = self.needs.clone();
        if let (Ok(_), Err(error)) = (&self.truth, self.estimate(None)) {
            needs.push(format!(
                "warning: even without noise the estimate fails as `{}`: {error}",
                error.name()
            ));
        }
        needs
    }
}

fn outcome(estimated: &Estimated, truth: f64) -> Outcome {
    Outcome {
        estimate: estimated.value,
        truth,
        std: finite(estimated.std),
        interval_holds: Some(estimated.interval.holds(truth)),
    }
}

/// An estimate that comes without a standard deviation.
fn plain(estimate: f64, truth: f64) -> Outcome {
    Outcome {
        estimate,
        truth,
        std: None,
        interval_holds: None,
    }
}

fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}
