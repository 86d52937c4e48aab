//! Rolls as time series: the samples of each roll, and estimates from them.

use std::sync::Arc;

use nalgebra::Vector2;
use palpate_ep1::{
    Places, Quantity, RollSample, RollSeries, SeriesEstimate, SeriesMethod, SeriesNoise,
    estimate_series,
};
use palpate_rolling::{Motion, PathPoint, Roller};
use palpate_sensing::BeyondPads;
use palpate_statistics::HALF_WIDTHS;
use palpate_study::config::{LengthUnit, RollConfig, RollEstimatorConfig, RollStart, Side};
use palpate_study::readings::{COLUMNS, table_columns};
use palpate_study::{FieldError, Table};
use palpate_sweep::Observation;

use super::motion_noise::{NoiseTrial, Roll};
use super::roll_sensor::{RollSensor, RotationSensor};
use super::roll_trial::{ROLL_QUANTITIES, RollScene};
use crate::principal_curvatures::PointCurvature;
use crate::trace::TraceError;

const MAX_SAMPLES: f64 = 1e7;
/// Largest rotation of a probe about the contact normal that counts as a rounding error, rad. If all rotations of a
/// roll about the normal are smaller, they are replaced by 0.
const ROUNDING_RAD: f64 = 1e-12;

#[derive(Clone, Debug)]
pub(super) struct SampledRolls {
    /// The samples of each roll. Rolls with the same command share their samples.
    rolls: Vec<Arc<SampledRoll>>,
    pub(super) method: Option<SeriesMethod>,
    places: Option<Places>,
    pub(super) noise: SeriesNoise,
    is_start_known: bool,
}

#[derive(Clone, Debug)]
struct SampledRoll {
    times_s: Vec<f64>,
    points: Vec<PathPoint>,
}

impl SampledRoll {
    fn new(roller: &Roller, command: &Motion, sampling_hz: f64) -> Result<Self, String> {
        let count = (command.duration_s * sampling_hz * (1.0 + f64::EPSILON)).floor();
        let times_s: Vec<f64> = (0..=count as usize)
            .map(|sample| (sample as f64 / sampling_hz).min(command.duration_s))
            .collect();
        let points = roller.path(&[*command], &times_s);
        Ok(Self {
            points: points.map_err(|error| error.to_string())?,
            times_s,
        })
    }
}

impl SampledRolls {
    pub(super) fn new(
        config: &RollConfig,
        roller: &Roller,
        rolls: &[Roll],
        sensors: (&RollSensor, &RotationSensor),
        relative_rotation_std: f64,
    ) -> Result<Option<Self>, FieldError> {
        let Some(sampling_hz) = config.motion.sampling_hz else {
            return Ok(None);
        };
        let refuse = |message: String| FieldError::at("scene.motion.sampling_hz", message);
        let durations = rolls
            .iter()
            .map(|roll| roll.command.duration_s * sampling_hz);
        let samples: f64 = durations.map(|samples| samples + 1.0).sum();
        if samples > MAX_SAMPLES {
            return Err(refuse(format!(
                "the rolls of a trial have {samples:.0} samples; at most {MAX_SAMPLES:.0} are possible"
            )));
        }
        let mut sampled: Vec<Arc<SampledRoll>> = Vec::with_capacity(rolls.len());
        for (place, roll) in rolls.iter().enumerate() {
            let same = rolls[..place]
                .iter()
                .position(|one| one.command == roll.command);
            sampled.push(match same {
                Some(same) => Arc::clone(&sampled[same]),
                None => {
                    Arc::new(SampledRoll::new(roller, &roll.command, sampling_hz).map_err(refuse)?)
                }
            });
        }
        let (sensor, rotation_sensor) = sensors;
        let squares = rolls.iter().map(|roll| roll.rotation.norm_squared());
        let size = (squares.sum::<f64>() / rolls.len() as f64).sqrt();
        let noise = rotation_sensor.series_noise(size);
        let method = match config.estimator.method(true).0 {
            "pad-edge" => Some(SeriesMethod::PadEdge),
            "trajectory" => Some(SeriesMethod::Trajectory),
            _ => None,
        };
        let places = sensor.places();
        if places.is_none() && method.is_some() {
            let message = "\"uniform\" pads have no straight edges: a time series needs \"square\" or \"hexagonal\"";
            return Err(FieldError::at("scene.sensor.layout", message));
        }
        Ok(Some(Self {
            rolls: sampled,
            method,
            places,
            noise: SeriesNoise {
                relative_rotation_std: libm::hypot(
                    noise.relative_rotation_std,
                    relative_rotation_std,
                ),
                ..noise
            },
            is_start_known: match config.estimator {
                RollEstimatorConfig::LeastSquares => false,
                RollEstimatorConfig::PadEdge { start }
                | RollEstimatorConfig::Trajectory { start }
                | RollEstimatorConfig::Auto { start } => start == RollStart::Known,
            },
        }))
    }

    pub(super) fn samples(&self) -> usize {
        self.rolls.iter().map(|roll| roll.times_s.len()).sum()
    }
}

enum NoSeries {
    Roll(palpate_rolling::RollError),
    Sensor(BeyondPads),
}

impl RollScene {
    /// Runs a trial whose estimator uses time series. Returns the outcomes and the estimate.
    pub(super) fn series_outcomes(
        &self,
        sampled: &SampledRolls,
        method: SeriesMethod,
        trial: u64,
    ) -> Result<([Observation; ROLL_QUANTITIES.len()], SeriesEstimate), &'static str> {
        let rolls = self.series(sampled, Some(trial));
        let rolls = rolls.map_err(|(_, fault)| match fault {
            NoSeries::Roll(error) => <&str>::from(error.fault),
            NoSeries::Sensor(error) => error.into(),
        })?;
        let places = sampled.places.unwrap_or(Places::Contacts { std: 0.0 });
        let radius = self.roller.probe().radius();
        let estimate = estimate_series(method, radius, &places, &sampled.noise, &rolls)?;
        let mut outcomes = self.compare(&estimate.estimate());
        for (outcome, quantity) in outcomes.iter_mut().zip(QUANTITIES) {
            outcome.interval_holds = Some(holds(outcome, &estimate, quantity));
        }
        Ok((outcomes, estimate))
    }

    /// Time series of all rolls. The time series have the noise of trial number `trial`; they have no noise if `trial`
    /// is `None`. If a roll fails, the error contains the index of the roll and the reason.
    fn series(
        &self,
        sampled: &SampledRolls,
        trial: Option<u64>,
    ) -> Result<Vec<RollSeries>, (usize, NoSeries)> {
        let mut sensor = self.sensor.begin(self.seed, trial);
        let mut noise = NoiseTrial::new(self.noise, self.seed, trial);
        let mut rotations = trial.map(|trial| self.rotation_sensor.begin(self.seed, trial));
        let is_disturbed = self.noise.is_some_and(|noise| noise.side == Side::Motion);
        let mut all = Vec::with_capacity(self.rolls.len());
        for (place, (roll, samples)) in self.rolls.iter().zip(&sampled.rolls).enumerate() {
            let fail = |error| (place, NoSeries::Roll(error));
            let moved = match is_disturbed && trial.is_some() {
                true => {
                    let motions = noise.motions(&roll.command);
                    if let Some(terrain) = &roll.terrain {
                        self.roller
                            .clearance(&motions, terrain, 0.0)
                            .map_err(fail)?;
                    }
                    Some(self.roller.path(&motions, &samples.times_s).map_err(fail)?)
                }
                false => None,
            };
            let points = moved.as_ref().unwrap_or(&samples.points);
            let contacts: Vec<_> = points.iter().map(|point| point.displacement).collect();
            let (places, start) = sensor
                .read_samples(&contacts)
                .map_err(|error| (place, NoSeries::Sensor(error)))?;
            let duration_s = roll.command.duration_s;
            // Times of the samples, as fractions of the duration of the roll.
            let fractions = samples.times_s.iter().map(|time_s| time_s / duration_s);
            let fractions: Vec<f64> = fractions.collect();
            let errors = noise.measured(&roll.command, &fractions);
            let commanded = samples.points.iter().map(|point| point.rotation.xy());
            let mut measured: Vec<Vector2<f64>> =
                commanded.zip(errors).map(|(a, b)| a + b).collect();
            if let Some(rotations) = &mut rotations {
                rotations.read_samples(&mut measured, &fractions, duration_s);
            }
            let turns = samples.points.iter().map(|point| point.rotation.z);
            let spins = turns.clone().any(|turn| turn.abs() > ROUNDING_RAD);
            let mut series = Vec::with_capacity(measured.len());
            for (((&time_s, rotation), turn), place) in samples
                .times_s
                .iter()
                .zip(&measured)
                .zip(turns)
                .zip(&places)
            {
                series.push(RollSample {
                    time_s,
                    rotation: rotation.push(if spins { turn } else { 0.0 }),
                    place: *place,
                });
            }
            all.push(RollSeries {
                start: sampled.is_start_known.then_some(start),
                has_spin: true,
                samples: series,
            });
        }
        Ok(all)
    }

    /// Table of the time series of all rolls, with one row per sample. A row contains the number of the roll (column
    /// `probe`), the time, the rotation vector, and the position of the contact or of the active pad. The rotation
    /// about the normal is included unless it is 0 in all samples.
    pub(super) fn series_table(
        &self,
        sampled: &SampledRolls,
        trial: Option<u64>,
        unit: LengthUnit,
    ) -> Result<Table, TraceError> {
        let rolls = self.series(sampled, trial);
        let rolls = rolls.map_err(|(probe, fault)| match fault {
            NoSeries::Roll(error) => TraceError::Roll { probe, error },
            NoSeries::Sensor(error) => TraceError::Sensor { probe, error },
        })?;
        let mut samples = rolls.iter().flat_map(|roll| &roll.samples);
        let spins = samples.any(|sample| sample.rotation.z != 0.0);
        let axes = if spins { 3 } else { 2 };
        let places = match sampled.places {
            Some(Places::Pads(_)) => &COLUMNS.roll_series[4..],
            _ => &COLUMNS.contacts,
        };
        let columns = [
            &COLUMNS.roll_series[..2],
            &COLUMNS.rotation_vector[..axes],
            places,
        ]
        .concat();
        let mut table = Table::new(table_columns(&columns, unit));
        for (probe, roll) in rolls.iter().enumerate() {
            for sample in &roll.samples {
                let rotation = sample.rotation.iter().take(axes);
                let numbers = rotation.chain(&sample.place).copied();
                table.push(probe, std::iter::once(sample.time_s).chain(numbers));
            }
        }
        Ok(table)
    }
}

/// Quantities of a roll whose estimates have 95 % intervals. They have the same order as the quantities in
/// [`ROLL_QUANTITIES`].
const QUANTITIES: [Quantity; 4] = [
    Quantity::Normal { angle_rad: 0.0 },
    Quantity::Normal {
        angle_rad: std::f64::consts::FRAC_PI_2,
    },
    Quantity::Gaussian,
    Quantity::Mean,
];

/// Principal curvatures of an estimate from time series, with the estimator's own intervals. `mean` is the outcome of
/// the mean curvature.
pub(super) fn series_principal(
    estimate: &SeriesEstimate,
    mean: &Observation,
    truth: &PointCurvature,
) -> PointCurvature {
    let stds = estimate.curvature.principal_stds(&estimate.covariance);
    let mut point = PointCurvature::of(&estimate.curvature, Some(stds), mean.std);
    point.interval_holds[2] = mean.interval_holds;
    for (place, quantity) in [(0, Quantity::PrincipalMin), (1, Quantity::PrincipalMax)] {
        let outcome = point.measured(truth, place);
        point.interval_holds[place] = Some(holds(&outcome, estimate, quantity));
    }
    point
}

/// Whether the 50, 80 and 95 % intervals of `quantity` contain the true value. The first two intervals are computed
/// from the standard error, as for a normal distribution.
fn holds(outcome: &Observation, estimate: &SeriesEstimate, quantity: Quantity) -> [bool; 3] {
    let error = (outcome.estimate - outcome.truth).abs();
    let within = |scores: f64| outcome.std.is_some_and(|std| error <= scores * std);
    let [low, high] = estimate.interval95(quantity);
    let is_above = low.is_none_or(|low| low <= outcome.truth);
    let is_below = high.is_none_or(|high| outcome.truth <= high);
    let [half, most, _] = HALF_WIDTHS;
    [within(half), within(most), is_above && is_below]
}
