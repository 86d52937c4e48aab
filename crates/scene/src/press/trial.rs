//! A press that is ready to run, and its trials.

use std::sync::{LazyLock, OnceLock};

use palpate_estimators::{ImageEstimator, MarkerImages};
use palpate_press::{
    Body, Bounds, Estimated, ForwardFit, Interval, Markers, Measured, ObjectPress, PressError,
    PressEstimate, Reading,
};
use palpate_statistics::{BadSetting, HALF_WIDTHS, NORMAL_95};
use palpate_study::config::{
    Indentation, LengthUnit, PressConfig, PressEstimatorConfig, PressObjectConfig,
};
use palpate_study::{FieldError, Quantity, Table};
use palpate_sweep::Observation;

use super::plan::{Choice, PressRungs};
use super::reading::{CameraPressSensor, CameraReading, PressNoise, PressReading, PressSensor};
use super::truth::{TruePress, object_radius};
use super::{PressFailure, PressFlaw};
use crate::ladder::Ladder;
use crate::principal_curvatures::{finite, half_turn};
use crate::scene::{Need, Observer, Trials};
use crate::trace::{Trace, TraceError};

/// Quantities of presses, in the order of the tables. There are six groups:
///
/// - quantities of all presses
/// - presses that a camera reads: errors of each tracked marker, change of hue and shift of the marker under the
///   contact, results of tracking
/// - presses on an object with a radius
/// - elliptic fits
/// - elliptic fits to an object with an axis
/// - presses with a stated modulus of the body
const QUANTITIES: [&[Quantity]; 6] = [
    &[
        Quantity::RELATIVE_CURVATURE,
        Quantity::EFFECTIVE_RADIUS,
        Quantity::OBJECT_CURVATURE,
        Quantity::INDENTATION,
        Quantity::CONTACT_RADIUS,
        Quantity::R_SQUARED,
    ],
    &[
        Quantity::NORMAL_DISPLACEMENT,
        Quantity::TANGENTIAL_DISPLACEMENT,
        Quantity::HUE_CHANGE,
        Quantity::MEAN_HUE_CHANGE,
        Quantity::CENTROID_SHIFT,
        Quantity::MARKERS_TRACKED,
        Quantity::WRONG_MATCHES,
        Quantity::PIXELS,
    ],
    &[Quantity::OBJECT_RADIUS],
    &[
        Quantity::PRINCIPAL_CURVATURE_MAX,
        Quantity::PRINCIPAL_CURVATURE_MIN,
    ],
    &[Quantity::AXIS_DEG],
    &[Quantity::FORCE],
];

/// The quantities of every combination of the six groups in [`QUANTITIES`]. If bit n of the index is 1, the combination
/// contains the group n.
static COMBINATIONS: LazyLock<Vec<Vec<Quantity>>> = LazyLock::new(|| {
    let combination = |bits: usize| {
        let some = QUANTITIES.iter().enumerate();
        let some = some.filter(|(bit, _)| bits >> bit & 1 == 1);
        some.flat_map(|(_, quantities)| quantities.iter().copied())
            .collect()
    };
    (0..1 << QUANTITIES.len()).map(combination).collect()
});

/// A press that is ready to run. It contains the true press, the sensor, the noise and the estimator of a grid point of
/// a study.
#[derive(Clone, Debug)]
pub struct PressScene {
    pub(super) config: PressConfig,
    pub(super) choice: Choice,
    pub(super) rungs: PressRungs,
    pub(super) markers: Markers,
    pub(super) places: Vec<[f64; 2]>,
    pub(super) body: Body,
    pub(super) geometry: ObjectPress,
    pub(super) case: PressCase,
    pub(super) has_tangential: bool,
    pub(super) noise: PressNoise,
    pub(super) estimator: PressEstimator,
    /// Standard deviations of normal and tangential displacements that the estimator assumes (length); `None` if the
    /// estimator computes them from the residuals.
    pub stated_stds: [Option<f64>; 2],
    pub(super) bounds: Option<Bounds>,
    pub(super) young: Option<f64>,
    /// Estimate from noiseless readings. It is computed when it is first used.
    pub(super) exact: OnceLock<Result<PressEstimate, PressFailure>>,
}

#[derive(Clone, Debug)]
pub(super) enum PressCase {
    Press {
        truth: TruePress,
        sensor: PressSensor,
    },
    /// No fit is possible, because the press itself is impossible. Every trial fails with the name of the error.
    NoPress(PressError),
}

impl PressCase {
    pub(super) fn press(&self) -> Result<(&TruePress, &PressSensor), PressError> {
        match self {
            Self::Press { truth, sensor } => Ok((truth, sensor)),
            Self::NoPress(error) => Err(*error),
        }
    }

    pub(super) fn camera(&self) -> Option<&CameraPressSensor> {
        self.press().ok().and_then(|(_, sensor)| sensor.camera())
    }
}

#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one per cell")]
pub(super) enum PressEstimator {
    /// Fit to the displacements of the markers. The second value is a fit to the images of the markers; `None` if the
    /// config does not state this estimator.
    Fit(ForwardFit, Option<ImageEstimator>),
    /// The fit cannot be built. Every trial fails with the name of the error.
    NoFit(PressError),
}

impl PressEstimator {
    pub(super) fn fit(&self) -> Result<&ForwardFit, PressError> {
        match self {
            Self::Fit(fit, _) => Ok(fit),
            Self::NoFit(error) => Err(*error),
        }
    }

    pub(super) fn images<'a>(
        &'a self,
        reading: &'a PressReading,
    ) -> Option<(&'a ImageEstimator, &'a MarkerImages)> {
        match self {
            Self::Fit(_, images) => images
                .as_ref()
                .zip(reading.camera.as_ref().map(|camera| &camera.images)),
            Self::NoFit(_) => None,
        }
    }
}

/// Standard deviation of the indentation reading that the estimator receives; `None` if the estimator fits the
/// indentation.
pub(super) fn given_indentation_std(estimator: &PressEstimatorConfig) -> Option<f64> {
    let priors = estimator.priors();
    (priors.indentation == Indentation::Known).then_some(priors.indentation_std)
}

impl PressScene {
    /// Reads the press. The reading has the noise of trial number `trial`; it has no noise if `trial` is `None`.
    pub(super) fn reading(&self, trial: Option<u64>) -> Result<PressReading, PressFailure> {
        let (truth, sensor) = self.case.press()?;
        sensor.read(truth, &self.noise, trial)
    }

    pub(super) fn exact(&self) -> Result<&PressEstimate, &PressFailure> {
        let estimate = || self.estimate(&self.reading(None)?);
        self.exact.get_or_init(estimate).as_ref()
    }

    pub(super) fn estimate(&self, reading: &PressReading) -> Result<PressEstimate, PressFailure> {
        match self.estimator.images(reading) {
            Some((fit, images)) => Ok(fit.estimate(images, self.given_indentation(reading))?),
            None => self.with_fit(reading, |fit, reading| fit.estimate(reading)),
        }
    }

    /// Indentation reading that the estimator receives; `None` if the estimator fits the indentation.
    pub(super) fn given_indentation(&self, reading: &PressReading) -> Option<Measured> {
        given_indentation_std(&self.config.estimator).map(|std| Measured {
            value: reading.indentation,
            std,
        })
    }

    /// Calls `then` with the fit to displacements, and with `reading` in the form that this fit needs.
    pub(super) fn with_fit<T>(
        &self,
        reading: &PressReading,
        then: impl FnOnce(&ForwardFit, &Reading<'_>) -> Result<T, PressError>,
    ) -> Result<T, PressFailure> {
        let tracked = reading.subset(&self.markers);
        let markers = tracked.as_ref().unwrap_or(&self.markers);
        let indentation = self.given_indentation(reading);
        let input = reading.fit_input(markers, self.has_tangential, indentation);
        Ok(then(self.estimator.fit()?, &input)?)
    }

    fn report(&self, quantity: Quantity, outcome: Observation, observe: Observer<'_>) {
        let place = self.quantities().iter().position(|one| *one == quantity);
        if let Some(place) = place {
            observe(place, outcome);
        }
    }

    fn report_estimate(&self, quantity: Quantity, estimated: &Estimated, observe: Observer<'_>) {
        if let Some(truth) = self.true_value(quantity) {
            self.report(quantity, outcome(estimated, truth), observe);
        }
    }

    fn true_value(&self, quantity: Quantity) -> Option<f64> {
        let object = &self.geometry;
        let truth = self.case.press().ok().map(|(truth, _)| truth);
        let [smaller, larger] = object.unequal.unwrap_or([object.curvature; 2]);
        let relative_curvature = self.markers.skin().curvature() + object.curvature;
        match quantity {
            Quantity::RELATIVE_CURVATURE => Some(relative_curvature),
            Quantity::EFFECTIVE_RADIUS => {
                (relative_curvature > 0.0).then(|| relative_curvature.recip())
            }
            Quantity::OBJECT_CURVATURE => Some(object.curvature),
            Quantity::INDENTATION => Some(object.indentation),
            Quantity::CONTACT_RADIUS => Some(truth?.contact_radius),
            Quantity::R_SQUARED => Some(1.0),
            Quantity::OBJECT_RADIUS => object_radius(&self.config.object),
            Quantity::PRINCIPAL_CURVATURE_MAX => Some(larger),
            Quantity::PRINCIPAL_CURVATURE_MIN => Some(smaller),
            Quantity::FORCE => finite(truth?.force_per_young? * self.young?),
            Quantity::AXIS_DEG => object.unequal.map(|_| half_turn(object.axis.to_degrees())),
            _ => None,
        }
    }

    pub(super) fn compare(
        &self,
        reading: &PressReading,
        estimate: &PressEstimate,
        observe: Observer<'_>,
    ) {
        let curvature = estimate.object_curvature();
        for (quantity, estimated) in [
            (Quantity::RELATIVE_CURVATURE, estimate.relative_curvature),
            (Quantity::EFFECTIVE_RADIUS, estimate.effective_radius()),
            (Quantity::OBJECT_CURVATURE, curvature),
            (Quantity::INDENTATION, estimate.indentation),
            (Quantity::CONTACT_RADIUS, estimate.contact_radius),
        ] {
            self.report_estimate(quantity, &estimated, observe);
        }
        let r_squared = Observation::plain(estimate.r_squared, 1.0);
        self.report(Quantity::R_SQUARED, r_squared, observe);
        // If the estimated curvature is 0, the radius is infinite and is not reported.
        let radius = estimate.most_likely_object_curvature().recip();
        if let Some(truth) = object_radius(&self.config.object)
            && radius.is_finite()
        {
            let curvature_outcome = outcome(&curvature, self.geometry.curvature);
            let radius_outcome = Observation {
                std: finite(curvature.std * radius * radius),
                interval_holds: curvature_outcome.interval_holds,
                ..Observation::plain(radius, truth)
            };
            self.report(Quantity::OBJECT_RADIUS, radius_outcome, observe);
        }
        if let Some(principal) = &estimate.principal {
            let [larger, smaller] = &principal.curvatures;
            self.report_estimate(Quantity::PRINCIPAL_CURVATURE_MAX, larger, observe);
            self.report_estimate(Quantity::PRINCIPAL_CURVATURE_MIN, smaller, observe);
            if let Some(truth) = self.true_value(Quantity::AXIS_DEG) {
                let [axis, std] = [principal.axis, principal.axis_std].map(f64::to_degrees);
                // Angles that differ by half a turn describe the same axis. Of these angles, report the one nearest to
                // the true angle.
                let value = truth + half_turn(axis - truth);
                let [low, high] = [-NORMAL_95, NORMAL_95].map(|width| Some(value + width * std));
                let interval = Interval { low, high };
                let axis = Estimated {
                    value,
                    std,
                    interval,
                };
                self.report_estimate(Quantity::AXIS_DEG, &axis, observe);
            }
        }
        let force = self.young.and_then(|young| self.force(estimate, young));
        if let (Some(truth), Some(force)) = (self.true_value(Quantity::FORCE), force) {
            self.report(Quantity::FORCE, Observation::plain(force, truth), observe);
        }
        self.observe_camera(reading, observe);
    }

    /// Force of an estimated press on the body that the fit assumes; `None` for the Gaussian model, which computes no
    /// stress.
    fn force(&self, estimate: &PressEstimate, young: f64) -> Option<f64> {
        if let Some(principal) = &estimate.principal {
            return finite(principal.contact.force(young));
        }
        let body = &self.estimator.fit().ok()?.body;
        let (curvature, indentation) = (estimate.most_likely_curvature, estimate.indentation);
        let contact = body.press(curvature, indentation.value).ok()?;
        contact.force(young)
    }

    /// Reports the quantities that only presses with a camera have, after a successful estimate.
    fn observe_camera(&self, reading: &PressReading, observe: Observer<'_>) {
        let PressCase::Press { truth, sensor } = &self.case else {
            return;
        };
        let (Some(sensor), Some(CameraReading { tracks, .. })) = (sensor.camera(), &reading.camera)
        else {
            return;
        };
        let mut report = |quantity, read, truth| {
            self.report(quantity, Observation::plain(read, truth), observe);
        };
        for (marker, normal, tangential) in reading.markers() {
            let moved = &truth.markers[marker];
            report(Quantity::NORMAL_DISPLACEMENT, normal, moved.normal);
            if self.has_tangential {
                for (read, truth) in tangential.into_iter().zip(moved.tangential) {
                    report(Quantity::TANGENTIAL_DISPLACEMENT, read, truth);
                }
            }
        }
        if let (Some(read), Some(exact)) = (sensor.central_changes(tracks), sensor.true_changes) {
            let changes = [
                Quantity::HUE_CHANGE,
                Quantity::MEAN_HUE_CHANGE,
                Quantity::CENTROID_SHIFT,
            ];
            for ((quantity, read), exact) in changes.into_iter().zip(read).zip(exact) {
                report(quantity, read, exact);
            }
        }
        let (tracked, visible) = (reading.markers().len() as f64, sensor.visible() as f64);
        report(Quantity::MARKERS_TRACKED, tracked, visible);
        report(Quantity::WRONG_MATCHES, tracks.wrong_matches as f64, 0.0);
        let pixels = sensor.camera.pixels();
        report(Quantity::PIXELS, pixels, pixels);
    }

    pub(crate) fn quantities_of(config: &PressConfig) -> &'static [Quantity] {
        let is_elliptic = matches!(config.estimator, PressEstimatorConfig::Elliptic { .. });
        let is_plane = matches!(config.object, PressObjectConfig::Plane {});
        let is_round = config.object.is_round();
        let applies = [
            true,
            config.sensor.camera().is_some(),
            is_round && !is_plane,
            is_elliptic,
            is_elliptic && !is_round,
            config.model.modulus_kpa().is_some(),
        ];
        let bits = applies.iter().enumerate();
        let index: usize = bits
            .map(|(bit, &applies)| usize::from(applies) << bit)
            .sum();
        &COMBINATIONS[index]
    }
}

impl Trials for PressScene {
    fn quantities(&self) -> &'static [Quantity] {
        Self::quantities_of(&self.config)
    }

    fn is_random(&self) -> bool {
        let camera = self.case.camera();
        let has_indentation = given_indentation_std(&self.config.estimator).is_some();
        camera.is_some_and(CameraPressSensor::is_random)
            || self.noise.is_random(self.has_tangential, has_indentation)
    }

    /// Returns an error if there are too few markers, or if a setting of the estimator is invalid. An impossible press,
    /// or a press that the camera cannot image, is not an error: the scene can run, but all its trials fail.
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

    fn trial(&self, trial: u64, observe: Observer<'_>) -> Result<(), &'static str> {
        let reading = self.reading(Some(trial))?;
        let estimate = self.estimate(&reading)?;
        self.compare(&reading, &estimate, observe);
        Ok(())
    }

    fn trial_with_warnings(
        &self,
        trial: u64,
        observe: Observer<'_>,
    ) -> Result<Vec<&'static str>, &'static str> {
        self.flawed_trial(trial, PressFlaw::default(), observe)
    }

    fn truth(&self, quantity: usize) -> Option<f64> {
        self.true_value(*self.quantities().get(quantity)?)
    }

    /// Cramér–Rao bound of a quantity, for the true body and the noise of the scene; `None` for a quantity without such
    /// a bound. Parameters that the estimator fits are treated as unknown. A parameter that the estimator receives,
    /// such as the indentation, has a standard deviation: the standard deviation of its noise in the trials or, without
    /// noise, the standard deviation that the config states.
    fn std_bound(&self, quantity: usize) -> Option<f64> {
        let bounds = self.bounds?;
        let quantity = *self.quantities().get(quantity)?;
        let radius_bound = |radius: f64| bounds.relative_curvature * (radius * radius);
        finite(match quantity {
            Quantity::RELATIVE_CURVATURE | Quantity::OBJECT_CURVATURE => bounds.relative_curvature,
            Quantity::EFFECTIVE_RADIUS | Quantity::OBJECT_RADIUS => {
                radius_bound(self.true_value(quantity)?)
            }
            Quantity::INDENTATION => bounds.indentation,
            Quantity::CONTACT_RADIUS => bounds.contact_radius,
            Quantity::PRINCIPAL_CURVATURE_MAX => bounds.principal?[0],
            Quantity::PRINCIPAL_CURVATURE_MIN => bounds.principal?[1],
            Quantity::AXIS_DEG => bounds.principal?[2].to_degrees(),
            _ => return None,
        })
    }

    fn needs(&self) -> Vec<Need> {
        self.description()
    }

    fn ladder(&self) -> Result<Option<Ladder>, FieldError> {
        self.rungs.ladder(&self.markers, &self.geometry).map(Some)
    }

    fn trace(&self, trial: Option<u64>, unit: LengthUnit) -> Result<Trace, TraceError> {
        Ok(self.record(trial, unit)?)
    }

    fn map(&self, cell: usize, trial: u64, table: &mut Table) -> Result<(), &'static str> {
        Ok(self.push_profile(cell, trial, table)?)
    }
}

fn outcome(estimated: &Estimated, truth: f64) -> Observation {
    Observation {
        std: finite(estimated.std),
        interval_holds: Some(hold(estimated, truth)),
        ..Observation::plain(estimated.value, truth)
    }
}

/// Whether the 50, 80 and 95 % intervals contain the true value. The 95 % interval is part of the estimate. The
/// half-widths of the other intervals are computed from the half-width of the 95 % interval, as for a normal
/// distribution. On a side where the 95 % interval has no limit, the half-widths are computed from the standard error
/// `std`.
fn hold(estimated: &Estimated, truth: f64) -> [bool; 3] {
    let (value, interval) = (estimated.value, estimated.interval);
    let end = if truth < value {
        interval.low
    } else {
        interval.high
    };
    let one_std = end.map_or(estimated.std, |end| (end - value).abs() / NORMAL_95);
    let [narrowest, narrow, _] = HALF_WIDTHS.map(|width| (truth - value).abs() <= width * one_std);
    [narrowest, narrow, interval.holds(truth)]
}
