//! A roll that is ready to run, and its trials.

use std::convert::Infallible;
use std::ops::Range;
use std::sync::LazyLock;

use nalgebra::Vector2;
use palpate_ep1::{
    BATCH_SIZE, BatchEstimates, Ep1Error, Estimate, LeastSquares, Measured, Moments, ProbeReading,
    ProbeRotation, ReadingNoise, SeriesMethod, SeriesNoise, rounding_std,
};
use palpate_geometry::CurvatureForm;
use palpate_rolling::{Chart, Motion, Roller};
use palpate_statistics::Number;
use pulp::{Arch, Simd, WithSimd};

use super::linear_rolls::{LinearRolls, ManyRolls};
use super::motion_noise::{MotionNoise, NoiseTrial, Roll};
use super::roll_sensor::{RollSensor, RotationSensor};
use super::sampled_rolls::{SampledRolls, series_principal};
use crate::ladder::Ladder;
use crate::principal_curvatures::PointCurvature;
use crate::scene::{Need, Observer, Trials};
use crate::trace::{Trace, TraceError};
use palpate_study::config::{LengthUnit, RollEstimatorConfig, Side};
use palpate_study::{FieldError, Quantity, Warning};
use palpate_sweep::{Observation, Observations};

pub(crate) const ROLL_QUANTITIES: [Quantity; 5] = [
    Quantity::NORMAL_CURVATURE_U,
    Quantity::NORMAL_CURVATURE_V,
    Quantity::GAUSSIAN_CURVATURE,
    Quantity::MEAN_CURVATURE,
    Quantity::ARC_LENGTH,
];

static WITH_PRINCIPAL: LazyLock<Vec<Quantity>> =
    LazyLock::new(|| [&ROLL_QUANTITIES[..], &Quantity::PRINCIPAL].concat());

pub(crate) fn quantities_of(has_principal: bool) -> &'static [Quantity] {
    match has_principal {
        true => &WITH_PRINCIPAL,
        false => &ROLL_QUANTITIES,
    }
}

/// Rolls that are ready to run. The scene contains the true rolls, the noise, the sensor and the estimator of a grid
/// point of a study.
#[derive(Clone, Debug)]
pub struct RollScene {
    pub(super) seed: u64,
    /// Computes rolls with the chosen model.
    pub roller: Roller,
    pub(super) rolls: Vec<Roll>,
    pub(super) noise: Option<MotionNoise>,
    pub(super) sensor: RollSensor,
    pub(super) rotation_sensor: RotationSensor,
    /// Noise that the estimator assumes for readings at the ends of rolls.
    pub reading_noise: ReadingNoise,
    /// Noise that the estimator assumes for time series; `None` if the sensor reads only the ends of rolls.
    pub series_noise: Option<SeriesNoise>,
    pub(super) fit: RollFit,
    /// Closed form of the rolls. It exists if the displacement of the contact is linear in the rotation for all rolls,
    /// and the reported rotations are the same in every trial; otherwise `None`.
    pub(super) linear: Option<LinearRolls>,
    pub(super) sampled: Option<SampledRolls>,
    pub(super) estimator: RollEstimatorConfig,
    pub(super) truth: Truth,
    pub(super) has_principal: bool,
    pub(super) directions_path: &'static str,
    /// Largest error that `auto` allows when it chooses a model; `None` if the config names the model.
    pub(super) tolerance: Option<f64>,
    /// Form of the contact equations that the compared integrators use: in charts, or without charts.
    pub(super) chart: Chart,
}

/// The least-squares fit, prepared for the commanded rotations of the probes. Traces (records of one simulation) do not
/// need the fit, because they contain only true values and readings.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one per cell")]
pub(super) enum RollFit {
    Fit(LeastSquares),
    /// There is no fit, because the rotations do not determine the curvature. Every trial that needs the fit fails with
    /// the name of this error.
    NoFit(Ep1Error),
}

impl RollFit {
    #[inline(always)]
    fn get(&self) -> Result<&LeastSquares, &'static str> {
        match self {
            Self::Fit(fit) => Ok(fit),
            Self::NoFit(error) => Err(error.into()),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Truth {
    pub(super) curvature: CurvatureForm,
    pub(super) arc_length: f64,
}

struct Together<'a> {
    seed: u64,
    linear: &'a LinearRolls,
    fit: &'a LeastSquares,
    first: u64,
    count: usize,
    rolls: &'a mut ManyRolls,
    estimates: &'a mut BatchEstimates,
}

impl WithSimd for Together<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        let rolls = self.rolls;
        let rolled = self
            .linear
            .side_by_side(self.seed, self.first, self.count, rolls);
        self.fit
            .estimate_batch(&rolls.moments, rolled, self.estimates)
    }
}

impl Together<'_> {
    /// Runs the trials, and returns how many of them ran before the first trial that failed. The function must be
    /// compiled in this crate: crates that call [`RollScene::side_by_side`] are compiled with fewer optimisations,
    /// which would not vectorise it.
    #[inline(never)]
    fn run(self, arch: Arch) -> usize {
        arch.dispatch(self)
    }
}

impl RollScene {
    pub(crate) fn commands(&self) -> impl Iterator<Item = &Motion> {
        self.rolls.iter().map(|roll| &roll.command)
    }

    #[inline]
    pub(crate) fn truths(&self) -> [f64; ROLL_QUANTITIES.len()] {
        let curvature = &self.truth.curvature;
        [
            curvature.k_uu,
            curvature.k_vv,
            curvature.gaussian_curvature(),
            curvature.mean_curvature(),
            self.truth.arc_length,
        ]
    }

    fn true_principal(&self) -> PointCurvature {
        PointCurvature::of(&self.truth.curvature, None, None)
    }

    /// The outcomes of one trial, in the order of [`Trials::quantities`].
    ///
    /// # Errors
    /// The name of the failure, which stays the same in all versions.
    #[inline(always)]
    pub fn outcomes(
        &self,
        trial: u64,
    ) -> Result<[Observation; ROLL_QUANTITIES.len()], &'static str> {
        if let (Some(linear), RollSensor::Ideal) = (&self.linear, &self.sensor) {
            let fit = self.fit.get()?;
            let Ok(moments) = linear.read(self.seed, trial, Ok::<_, Infallible>);
            return Ok(self.compare(&fit.estimate(&moments)?));
        }
        match self.series_method() {
            Some((sampled, method)) => self
                .series_outcomes(sampled, method, trial)
                .map(|(outcomes, _)| outcomes),
            None => self
                .sensor_trial(trial)
                .map(|estimate| self.compare(&estimate)),
        }
    }

    /// Runs trials in batches of at most [`BATCH_SIZE`], and passes the outcomes of each batch to `take`, in the order
    /// of [`Trials::quantities`]. The outcomes are exactly the same as from [`RollScene::outcomes`], but they are
    /// computed faster, above all on processors with wide vectors. `take` returns the number of trials that it accepts.
    /// The function stops if `take` does not accept all trials of a batch, or if a trial cannot run in a batch. It
    /// returns the number of accepted trials.
    pub fn side_by_side(
        &self,
        arch: Arch,
        trials: Range<u64>,
        mut take: impl FnMut(&[Observations<'_>; ROLL_QUANTITIES.len()]) -> usize,
    ) -> u64 {
        let (Some(linear), RollFit::Fit(fit), RollSensor::Ideal, false) =
            (&self.linear, &self.fit, &self.sensor, self.has_principal)
        else {
            return 0;
        };
        let truths = self.truths();
        let (mut rolls, mut estimates) = (ManyRolls::default(), BatchEstimates::default());
        let mut trial = trials.start;
        loop {
            let count = trials.end.saturating_sub(trial).min(BATCH_SIZE as u64) as usize;
            let together = Together {
                seed: self.seed,
                linear,
                fit,
                first: trial,
                count,
                rolls: &mut rolls,
                estimates: &mut estimates,
            };
            let ran = together.run(arch);
            if ran == 0 {
                return trial - trials.start;
            }
            let stds = |quantity: usize| {
                let stds = estimates.stds.get(quantity);
                stds.filter(|_| estimates.have_stds)
                    .map(|stds| &stds[..ran])
            };
            let taken = take(&std::array::from_fn(|quantity| Observations {
                estimates: &estimates.values[quantity][..ran],
                truth: truths[quantity],
                stds: stds(quantity),
            }));
            trial += taken as u64;
            if taken < count {
                return trial - trials.start;
            }
        }
    }

    /// Samples of the rolls, and the method that estimates the curvature from these samples; `None` if the estimator is
    /// least squares, which needs no samples.
    fn series_method(&self) -> Option<(&SampledRolls, SeriesMethod)> {
        let sampled = self.sampled.as_ref()?;
        Some((sampled, sampled.method?))
    }

    #[inline(always)]
    pub(super) fn compare(&self, estimate: &Estimate) -> [Observation; ROLL_QUANTITIES.len()] {
        let outcome = |measured: Measured, truth: f64| Observation {
            std: measured.std,
            ..Observation::plain(measured.value, truth)
        };
        let [u, v, gaussian, mean, length] = self.truths();
        let arc_length = Measured {
            value: estimate.arc_length,
            std: None,
        };
        [
            outcome(estimate.normal_curvature_u, u),
            outcome(estimate.normal_curvature_v, v),
            outcome(estimate.gaussian_curvature, gaussian),
            outcome(estimate.mean_curvature, mean),
            outcome(arc_length, length),
        ]
    }

    #[inline(never)]
    fn sensor_trial(&self, trial: u64) -> Result<Estimate, &'static str> {
        let is_measured = !self.rotation_sensor.is_exact()
            || self
                .noise
                .is_some_and(|noise| noise.side == Side::Measurement);
        match &self.linear {
            Some(linear) => self.linear_trial(linear, trial),
            None if is_measured => self.measured_trial(trial),
            None => self.general_trial(trial),
        }
    }

    /// Runs a trial in which the displacement of every contact is a linear function of the rotation. Such a trial is
    /// fast, because no motion is simulated.
    fn linear_trial(&self, linear: &LinearRolls, trial: u64) -> Result<Estimate, &'static str> {
        let fit = self.fit.get()?;
        let mut sensor = self.sensor.begin(self.seed, Some(trial));
        let moments = linear
            .read(self.seed, trial, |displacement| sensor.read(&displacement))
            .map_err(<&str>::from)?;
        Ok(fit.estimate(&moments)?)
    }

    /// Runs a trial whose rolls may be of any kind, if the reported rotations have no errors. All such trials share one
    /// prepared fit.
    fn general_trial(&self, trial: u64) -> Result<Estimate, &'static str> {
        let fit = self.fit.get()?;
        let mut moments = Moments::default();
        self.readings(trial, |reading| {
            let rotation = ProbeRotation::new(self.roller.probe().radius(), &reading.rotation);
            moments.add_shifts(&rotation, reading.shift.into())
        })?;
        Ok(fit.estimate(&moments)?)
    }

    /// Runs a trial in which the reported rotations have errors. The fit depends on the reported rotations, so each
    /// trial prepares its own fit.
    fn measured_trial(&self, trial: u64) -> Result<Estimate, &'static str> {
        let mut readings = Vec::with_capacity(self.rolls.len());
        self.readings(trial, |reading| readings.push(reading))?;
        let radius = self.roller.probe().radius();
        Ok(LeastSquares::of(radius, self.reading_noise, &readings)?)
    }

    /// Calls `report` with the reading of each probe in a trial, in the order of the probes.
    fn readings(
        &self,
        trial: u64,
        mut report: impl FnMut(ProbeReading),
    ) -> Result<(), &'static str> {
        let mut noise = NoiseTrial::new(self.noise, self.seed, Some(trial));
        let mut sensor = self.sensor.begin(self.seed, Some(trial));
        let mut rotations = self.rotation_sensor.begin(self.seed, trial);
        for roll in &self.rolls {
            let (displacement, rotation) = noise
                .roll(&self.roller, roll)
                .map_err(|error| <&str>::from(error.fault))?;
            let rotation = rotations.read(rotation, roll.command.duration_s);
            let shift = sensor.read(&displacement).map_err(<&str>::from)?;
            report(ProbeReading { rotation, shift });
        }
        Ok(())
    }

    fn method_need(&self) -> String {
        let probes = self.rolls.len();
        let sampled = self.sampled.as_ref();
        let (name, reason) = self.estimator.method(sampled.is_some());
        let reason = reason.map_or_else(String::new, |reason| format!(", chosen because {reason}"));
        match sampled {
            Some(sampled) if sampled.method.is_some() => {
                let samples = sampled.samples();
                format!("{name} over {probes} probes, {samples} samples{reason}")
            }
            _ => format!("least squares over {probes} probes{reason}"),
        }
    }

    fn rounding_warning(&self) -> Option<Warning> {
        let curvature = self.truth.curvature.principal();
        let sharper = curvature.k_min.abs().max(curvature.k_max.abs());
        let error = rounding_std(self.roller.probe().radius(), sharper) / sharper;
        // Warn only if the relative error of the curvature is in this range. A smaller error does not matter. If the
        // error is larger, the object counts as a plane, and a warning is not useful.
        (1e-3..1e12).contains(&error).then(|| {
            let share = Number::rounded(error);
            Warning::new(
                "flat-object",
                format!("the object is so flat that rounding of the readings causes a curvature error of {share} times its curvature"),
                [("relative_error", error)],
            )
        })
    }
}

impl Trials for RollScene {
    fn quantities(&self) -> &'static [Quantity] {
        quantities_of(self.has_principal)
    }

    fn is_random(&self) -> bool {
        self.noise.is_some() || self.sensor.is_random() || self.rotation_sensor.is_random()
    }

    fn estimable(&self) -> Result<(), FieldError> {
        match &self.fit {
            RollFit::Fit(_) => Ok(()),
            RollFit::NoFit(Ep1Error::NoisyRotations { .. }) if self.series_method().is_some() => {
                Ok(())
            }
            RollFit::NoFit(error @ Ep1Error::NoisyRotations { .. }) => {
                Err(FieldError::at(self.rotation_sensor.path(), error))
            }
            RollFit::NoFit(error) => Err(FieldError::at(self.directions_path, error)),
        }
    }

    fn trial(&self, trial: u64, observe: Observer<'_>) -> Result<(), &'static str> {
        if self.has_principal {
            return self.trial_with_warnings(trial, observe).map(drop);
        }
        let outcomes = self.outcomes(trial)?.into_iter().enumerate();
        outcomes.for_each(|(quantity, outcome)| observe(quantity, outcome));
        Ok(())
    }

    fn trial_with_warnings(
        &self,
        trial: u64,
        observe: Observer<'_>,
    ) -> Result<Vec<&'static str>, &'static str> {
        if let Some((sampled, method)) = self.series_method() {
            let (outcomes, estimate) = self.series_outcomes(sampled, method, trial)?;
            for (quantity, outcome) in outcomes.into_iter().enumerate() {
                observe(quantity, outcome);
            }
            if self.has_principal {
                let truth = self.true_principal();
                series_principal(&estimate, &outcomes[3], &truth).report(
                    &truth,
                    self.quantities(),
                    observe,
                );
            }
            return Ok(Vec::new());
        }
        let mut readings = Vec::with_capacity(self.rolls.len());
        self.readings(trial, |reading| readings.push(reading))?;
        let radius = self.roller.probe().radius();
        let (fit, estimate) = LeastSquares::fitted(radius, self.reading_noise, &readings)?;
        for (quantity, outcome) in self.compare(&estimate).into_iter().enumerate() {
            observe(quantity, outcome);
        }
        if self.has_principal {
            let form = estimate.curvature;
            let stds = fit
                .covariance(&estimate)
                .map(|all| form.principal_stds(&all));
            let principal = PointCurvature::of(&form, stds, estimate.mean_curvature.std);
            principal.report(&self.true_principal(), self.quantities(), observe);
        }
        let misfits = estimate.misfits(self.reading_noise, &readings);
        Ok(misfits.iter().map(|misfit| misfit.code()).collect())
    }

    fn truth(&self, quantity: usize) -> Option<f64> {
        let usual = self.truths().get(quantity).copied();
        usual.or_else(|| {
            let truth = self.true_principal();
            let quantity = *self.quantities().get(quantity)?;
            Some(truth.outcome(&truth, quantity)?.truth)
        })
    }

    fn needs(&self) -> Vec<Need> {
        let choice = self.roller.choice();
        let bound = choice.error_bound.map_or_else(String::new, |bound| {
            format!(", error at most {bound:.0e} of the contact's scale")
        });
        let mut models = vec![format!("{} ({}{bound})", choice.rung, choice.reason)];
        models.extend(self.noise.map(|noise| noise.need()));
        models.push(self.sensor.need());
        if self.rolls.iter().any(|roll| roll.terrain.is_some()) {
            models.push(
                "clearance of every trial: the probe passes close to other parts of the object"
                    .to_owned(),
            );
        }
        models.extend(self.rotation_sensor.need());
        models.push(self.method_need());
        let mut needs: Vec<Need> = models.into_iter().map(Need::Model).collect();
        needs.extend(self.rounding_warning().map(Need::Warning));
        let half_turn = std::f64::consts::PI * self.roller.probe().radius();
        let arc_length = self.truth.arc_length;
        if arc_length > half_turn {
            let text = "the contact moves by more than half of the probe's circumference: the shift then no longer determines the length of the roll";
            let numbers = [("arc_length", arc_length), ("half_turn", half_turn)];
            needs.push(Need::Warning(Warning::new("half-turn", text, numbers)));
        }
        let furthest = Vector2::new(arc_length, 0.0);
        if let Err(error) = self.sensor.begin(0, None).read(&furthest) {
            let text = format!("{error}: trials fail as `beyond-pads`");
            needs.push(Need::Warning(Warning::new(
                "beyond-pads",
                text,
                [("arc_length", arc_length)],
            )));
        }
        needs
    }

    fn ladder(&self) -> Result<Option<Ladder>, FieldError> {
        Ok(Some(self.measured_ladder()))
    }

    fn trace(&self, trial: Option<u64>, unit: LengthUnit) -> Result<Trace, TraceError> {
        self.record(trial, unit)
    }
}
