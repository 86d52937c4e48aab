//! Estimate of the curvature from recorded rolls.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::OnceLock;

use nalgebra::Vector2;
use palpate_ep1::{
    Ep1Error, Estimate, LeastSquares, Measured, PadCell, PadStart, ProbeReading, ReadingNoise,
    SeriesEstimate, SeriesNoise,
};
use palpate_geometry::{ShapeClass, ShapeThresholds};
use palpate_statistics::{NORMAL_95, student_half_width};
use serde::{Serialize, Serializer};

use super::error::{RecordedError, explained};
use super::glide_report::{Thresholds, of_size};
use super::lost_rolls::common_step;
use super::press_report::Radius;
use super::roll_options::RollOptions;
use super::roll_recording::RollRecording;
use super::roll_series::{LeftOutProbe, QUANTITIES, SeriesResult, estimate_of_series};
use super::roll_warnings::{ORIENTATIONS, has_common_rotation};
use super::single_direction::{DirectedCurvature, single_direction};
use super::value::{FORMAT_VERSION, Value};
use palpate_study::config::{LengthUnit, RollEstimatorConfig};
use palpate_study::{Unit, Warning};

/// √6. If a shift is the difference of two places that are rounded to multiples of a step, the standard deviation of its
/// rounding error is the step divided by this number.
const STEPS_PER_STD: f64 = 2.449_489_742_783_178;
/// Residuals up to this fraction of the mean length of the contacts' paths are rounding errors of the computation. The
/// noise is not estimated from them.
const MIN_RESIDUAL: f64 = 1e-12;
/// If all rolls are in one direction, the noise follows from the residuals along it. The sum of their squares counts as
/// at least this share of the sum for all residuals, because smaller residuals may be rounding errors.
const MIN_SHARE_ALONG: f64 = 0.01;
/// Source of the standard errors if the noise is estimated from the residuals.
pub(super) const OF_RESIDUALS: &str = "the residuals";
/// Source of the standard errors if they follow from the steps of the shifts.
pub(super) const FROM_STEPS: &str = "the steps of the shifts";
/// Text in the output that states how the thresholds of the shape classes are computed.
const THRESHOLDS_FROM: &str = "the mean arc length L of the contacts: the threshold of the mean curvature is 0.03 * 3 / (2 L), which is the 0.03 of the 1996 paper, scaled from its patch of 3 x 3 to a patch of 2 L x 2 L; the threshold of the Gaussian curvature is the square of this value";

/// A probe that rolled, but whose readings show no motion of the contact.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct UnresolvedProbe {
    probe: u64,
    /// Upper bound of the object's radius of curvature in the direction of the roll. `null` if the pitch of the pads is
    /// not given, or if the pitch is so coarse that there is no bound.
    radius_below: Option<f64>,
    unit: &'static str,
    /// For each column that palpate does not use: its name, and its text in this probe's row.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    columns: BTreeMap<String, String>,
}

/// Estimate of the curvature from recorded rolls. Results whose computation takes longer than the estimate are computed
/// only when their methods are called.
#[derive(Clone, Debug)]
pub struct RollEstimate {
    pub(super) recorded: RollRecording,
    pub(super) options: RollOptions,
    pub(super) unit: LengthUnit,
    pub(super) estimate: Estimate,
    /// Covariance of the normal curvatures along u and v and of the twist k_uv (all in 1/length). It is computed from
    /// the stated noise or from the residuals; `None` if neither is possible.
    covariance: Option<[[f64; 3]; 3]>,
    pub(super) residual: f64,
    /// Degrees of freedom of the residuals from which the noise was estimated; `None` if it was not estimated.
    freedom: Option<usize>,
    pub(super) std_from: &'static str,
    pub(super) repeated: Option<String>,
    /// Rolls that were left out because their readings were lost.
    lost: Vec<LeftOutProbe>,
    /// Text of the warning about samples with lost contacts, which were left out; `None` if there are none.
    pub(super) lost_samples: Option<String>,
    probes: usize,
    /// The result of a method for time series; `None` for least squares.
    pub(super) series: Option<SeriesResult>,
    /// Curvature along the contact's path, if all rolls have the same direction; otherwise `None`.
    pub(super) single_direction: Option<DirectedCurvature>,
    /// The readings for the tests of the fit, if all rolls have the same direction: the recorded readings and the
    /// artificial roll of [`single_direction()`]. If `None`, the tests use only the recorded readings.
    tested: Option<Vec<ProbeReading>>,
}

/// Curvatures and lengths estimated from rolls.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RollValues {
    /// Normal curvature of the object in the direction u at the first contact.
    pub normal_curvature_u: Value,
    /// Normal curvature of the object in the direction v at the first contact.
    pub normal_curvature_v: Value,
    /// Gaussian curvature of the object at the first contact.
    pub gaussian_curvature: Value,
    /// Mean curvature of the object at the first contact.
    pub mean_curvature: Value,
    /// Length of the contact's path in a roll, averaged over all rolls. If a time series returns towards its start, only
    /// the path to its farthest contact counts.
    pub arc_length: Value,
    /// Smallest normal curvature of the object at the first contact.
    pub principal_curvature_min: Value,
    /// Largest normal curvature of the object at the first contact.
    pub principal_curvature_max: Value,
    /// Direction of the largest curvature, degrees, from +u towards +v of the readings. `null` if all rolls have the
    /// same direction.
    pub principal_direction_max_deg: Option<f64>,
    /// Standard error of `principal_direction_max_deg`, degrees; at most 52, the value for a completely unknown
    /// direction. `null` if the noise is neither stated nor estimated, or if all rolls have the same direction.
    pub principal_direction_max_std_deg: Option<f64>,
    /// Error amplification along u: ratio of the relative error of the curvature to the relative error of the readings.
    /// It is 1 + 1/RCR, where RCR is the ratio of the object's curvature to the probe's curvature; `null` if the object
    /// is flat or all rolls have the same direction.
    pub amplification_u: Option<f64>,
    /// Error amplification along v, as in `amplification_u`; `null` in the same cases.
    pub amplification_v: Option<f64>,
    /// Root mean square of the residuals, over all components of the measured contact shifts.
    pub residual_rms: Value,
    /// Curvature along the contact's path, if all rolls have the same direction; otherwise `None`.
    pub single_direction: Option<DirectedCurvature>,
}

/// Output of the command `estimate roll`.
#[derive(Serialize)]
struct RollReport {
    /// Version of this format, [`FORMAT_VERSION`].
    format_version: u32,
    method: &'static str,
    probes: usize,
    #[serde(flatten)]
    values: RollValues,
    radius: Radius,
    /// Text that states the source of the standard errors.
    std_from: &'static str,
    /// Number of terms of the model for the curvature along a roll; 1 if the curvature is constant. Only methods for
    /// time series have this model.
    #[serde(skip_serializing_if = "Option::is_none")]
    terms: Option<usize>,
    /// Smallest and largest value of each curvature that is compatible with the readings, if the rotations and the pads
    /// are exact. Left out for rotations with noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    bounds: Option<BTreeMap<&'static str, [Option<f64>; 2]>>,
    /// Shape class of the object at the first contact; `null` if all rolls have the same direction.
    class: Option<&'static str>,
    /// Probability of each class; `null` if no noise is stated or estimated.
    class_probabilities: Option<BTreeMap<&'static str, f64>>,
    thresholds: Option<Thresholds>,
    left_out: Vec<LeftOutProbe>,
    unresolved_probes: Vec<UnresolvedProbe>,
    /// p-value of the goodness of fit for the stated noise; `null` if no noise is stated.
    p_value: Option<f64>,
    warnings: Vec<Warning>,
}

impl RollEstimate {
    /// The curvatures and lengths that are estimated from the rolls.
    pub fn values(&self) -> RollValues {
        let Self { estimate, unit, .. } = self;
        let is_open = self.single_direction.is_some();
        let half_width = half_width(self.freedom);
        let value = |Measured { value, std }, power: Unit| match is_open {
            true => Value::open(power, *unit),
            false => Value::within(value, std, half_width, power, *unit),
        };
        let bare = |value: f64, power: Unit| Value::bare(value, power.of(*unit));
        let principal = estimate.curvature.principal();
        let stds = self
            .covariance()
            .map(|covariance| estimate.curvature.principal_stds(&covariance));
        let extreme = |extreme: f64, place: usize| {
            let std = stds.map(|stds| stds[place]);
            let measured = Measured {
                value: extreme,
                std,
            };
            value(measured, Unit::PerLength)
        };
        let mut values = RollValues {
            normal_curvature_u: value(estimate.normal_curvature_u, Unit::PerLength),
            normal_curvature_v: value(estimate.normal_curvature_v, Unit::PerLength),
            gaussian_curvature: value(estimate.gaussian_curvature, Unit::PerLengthSquared),
            mean_curvature: value(estimate.mean_curvature, Unit::PerLength),
            arc_length: bare(estimate.arc_length, Unit::Length),
            principal_curvature_min: extreme(principal.k_min, 0),
            principal_curvature_max: extreme(principal.k_max, 1),
            principal_direction_max_deg: (!is_open)
                .then(|| principal.angle_of_max_rad.to_degrees() + 0.0),
            principal_direction_max_std_deg: stds.map(|[.., angle]| angle.to_degrees()),
            amplification_u: estimate.amplification(0.0).filter(|_| !is_open),
            amplification_v: estimate.amplification(FRAC_PI_2).filter(|_| !is_open),
            residual_rms: bare(self.residual, Unit::Length),
            single_direction: self.single_direction.clone(),
        };
        if let Some(series) = &self.series {
            let curvatures = [
                &mut values.normal_curvature_u,
                &mut values.normal_curvature_v,
                &mut values.gaussian_curvature,
                &mut values.mean_curvature,
                &mut values.principal_curvature_min,
                &mut values.principal_curvature_max,
            ];
            for (value, (_, quantity)) in curvatures.into_iter().zip(QUANTITIES) {
                let interval = || series.estimate.interval95(quantity);
                value.interval95 = self.covariance.map(|_| interval());
            }
        }
        values
    }

    /// Smallest and largest value of each curvature that is compatible with the readings, if the rotations and the pads
    /// are exact. `None` if the rotations have noise.
    pub(super) fn bounds(&self) -> Option<BTreeMap<&'static str, [Option<f64>; 2]>> {
        let estimate = &self.series.as_ref()?.estimate;
        let bounds = |(name, quantity)| Some((name, estimate.bounds(quantity)?));
        QUANTITIES.into_iter().map(bounds).collect()
    }

    /// Thresholds of the shape classes. The threshold of the mean curvature is that of the 1996 paper by Charlebois et
    /// al., scaled to a patch as wide as two rolls in opposite directions (twice the mean length of the contact's
    /// path). The threshold of the Gaussian curvature is the square of this value, so that a ball exceeds either both
    /// thresholds or neither. `None` if all rolls have the same direction, or if no contact moved.
    fn thresholds(&self) -> Option<ShapeThresholds> {
        let mean = of_size([2.0 * self.estimate.arc_length; 2])?.mean();
        let thresholds = ShapeThresholds::new(mean * mean, mean).ok();
        thresholds.filter(|_| self.single_direction.is_none())
    }

    fn class(&self, thresholds: &ShapeThresholds) -> ShapeClass {
        let form = &self.estimate.curvature;
        thresholds.classify(form.gaussian_curvature(), form.mean_curvature())
    }

    fn class_probabilities(
        &self,
        thresholds: &ShapeThresholds,
    ) -> Option<BTreeMap<&'static str, f64>> {
        let covariance = self.covariance?;
        let all = match &self.series {
            Some(series) => series.estimate.class_probabilities(thresholds),
            None => SeriesEstimate::of_ends(&self.estimate, covariance, self.freedom)
                .class_probabilities(thresholds),
        };
        let names = ShapeClass::ALL.map(ShapeClass::name);
        Some(names.into_iter().zip(all).collect())
    }

    /// p-value of the goodness of fit for the stated noise. If no noise is stated, `None`, unless the residuals of a time
    /// series contradict the noise model of the fit: then the p-value of this contradiction.
    pub fn p_value(&self) -> Option<f64> {
        if let Some(series) = &self.series {
            return Some(series.estimate.goodness?.p_value);
        }
        let tested = self.tested_readings();
        Some(self.estimate.goodness(self.options.noise, tested)?.p_value)
    }

    /// The readings for the test of the goodness of fit.
    pub(super) fn tested_readings(&self) -> &[ProbeReading] {
        self.tested.as_ref().unwrap_or(&self.recorded.readings)
    }

    /// Covariance matrix of the normal curvatures along u and v and of the twist k_uv; the curvatures are in 1/length.
    /// `None` in two cases: the noise is neither stated nor estimated from residuals, or all rolls have the same
    /// direction.
    pub fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        self.covariance.filter(|_| self.single_direction.is_none())
    }
}

impl Serialize for RollEstimate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let values = self.values();
        let (limits, series) = (self.thresholds(), self.series.as_ref());
        let report = RollReport {
            format_version: FORMAT_VERSION,
            method: series.map_or("least-squares", |series| series.method),
            probes: self.probes,
            radius: Radius::of_mean(&values.mean_curvature, self.unit),
            values,
            std_from: self.std_from,
            terms: series.map(|series| series.estimate.terms),
            bounds: self.bounds(),
            class: limits.map(|limits| self.class(&limits).name()),
            class_probabilities: limits.and_then(|limits| self.class_probabilities(&limits)),
            thresholds: limits.map(|limits| Thresholds::new(&limits, THRESHOLDS_FROM, self.unit)),
            left_out: self.left_out(),
            unresolved_probes: self.unresolved(),
            p_value: self.p_value(),
            warnings: self.warnings(),
        };
        report.serialize(serializer)
    }
}

impl RollEstimate {
    /// Probes that the fit does not use.
    pub(super) fn left_out(&self) -> Vec<LeftOutProbe> {
        match &self.series {
            Some(series) => series.left_out(&self.recorded),
            None => self.lost.clone(),
        }
    }

    /// Probes that rolled, but whose readings show no motion of the contact on the probe: the measured shift is exactly
    /// 0 or, in time series, the contact stayed on one pad. If the sensor has pads, the true shift is then smaller than
    /// their pitch. If the pitch is stated, each of these probes sets an upper bound on the object's radius.
    fn unresolved(&self) -> Vec<UnresolvedProbe> {
        let Self {
            recorded, options, ..
        } = self;
        let still = |(place, reading): &(usize, &ProbeReading)| match &self.series {
            Some(series) => series.is_unresolved(*place),
            None => reading.shift == Vector2::zeros() && reading.rotation != Vector2::zeros(),
        };
        let bound = |(place, reading): (usize, &ProbeReading)| {
            let resolution = options.noise.shift_resolution;
            let square = PadCell {
                pitch: 1.0,
                is_hexagonal: false,
            };
            let cell = options.series.pads.unwrap_or(square);
            let drive = Vector2::new(-reading.rotation.y, reading.rotation.x);
            let resolution = resolution * cell.chord(&drive.normalize()) / cell.pitch;
            let radius = 1.0 / (reading.rotation.norm() / resolution - 1.0 / options.probe_radius);
            let row = recorded.rows.get(place);
            let is_bound = resolution > 0.0 && radius > 0.0 && radius.is_finite();
            UnresolvedProbe {
                probe: recorded.probe(place),
                radius_below: is_bound.then_some(radius),
                unit: self.unit.as_str(),
                columns: row.map_or_else(BTreeMap::new, |&row| recorded.extras.named(row)),
            }
        };
        let readings = recorded.readings.iter().enumerate();
        readings.filter(still).map(bound).collect()
    }
}

/// Estimates the object's curvature from recorded rolls.
///
/// Standard errors follow from the stated noise. Without stated noise, they follow from the residuals, if there are
/// more readings than fitted parameters. The half-width of the 95 % interval then follows from Student's t with 2n − 3
/// degrees of freedom, where n is the number of probes. For example, the half-width is 2.57 standard errors for 4
/// probes, and 2.16 for 8 probes ([`palpate_statistics::student_half_width`]).
///
/// ```
/// use palpate_recorded::{RecordedFile, RollOptions, estimate_roll, RollRecording};
///
/// // A probe of radius 10 that is turned by 0.3 on a ball of radius 20 rolls over 0.3 / (1/10 + 1/20) = 2.
/// let csv = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n0,0,-0.3,2,0\n1,0.3,0,0,2\n";
/// let readings = RollRecording::try_from(RecordedFile::new("readings.csv", csv.as_bytes().to_vec()))?;
/// let estimate = estimate_roll(readings, &RollOptions::new(10.0))?;
/// let estimate = serde_json::to_value(estimate)?;
/// let curvature = estimate["mean_curvature"]["value"].as_f64().ok_or("no number")?;
/// assert!((curvature - 0.05).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RecordedError::Readings`] if the options contradict the file or the readings do not determine the curvature.
pub fn estimate_roll(
    mut recorded: RollRecording,
    options: &RollOptions,
) -> Result<RollEstimate, RecordedError> {
    let probes = recorded.readings.len();
    if let Some(series) = &mut recorded.series
        && let Some(start) = options.series.start
    {
        if series.rolls.iter().any(|roll| roll.start.is_some()) {
            return Err(recorded.source.fail(
                "setting `start`: the columns start_u, start_v already state the start of each roll",
            ));
        }
        let rolls = series.rolls.iter_mut();
        rolls.for_each(|roll| roll.start = Some(Vector2::from(start)));
    }
    let has_series = recorded.series.is_some();
    let is_of_ends = options.estimator.method(has_series).0 == "least-squares";
    let mut options = options.clone();
    if let Some(series) = recorded.series.as_ref().filter(|_| is_of_ends) {
        options.difference_noise(series.has_start_rotations);
    }
    let options = &options;
    let repeated = match options.noise.pad_start {
        _ if !is_of_ends => recorded.leave_out_copied_series(),
        PadStart::PerRoll => recorded.leave_out_copies(),
        _ => None,
    };
    let unit = recorded.source.unit(recorded.unit, options.length_unit)?;
    recorded.leave_out_repeated_samples();
    let lost_samples = recorded.leave_out_lost_samples(options, unit)?;
    let lost = match is_of_ends {
        true => recorded.leave_out_lost(options, unit)?,
        false => Vec::new(),
    };
    if let (Some(series), Some(cell), false) =
        (&mut recorded.series, options.series.pads, is_of_ends)
    {
        series.snap_to_lattice(&cell);
    }
    let source = &recorded.source;
    let readings = &recorded.readings;
    let units = || recorded.units(is_of_ends, options.probe_radius, unit);
    let fail = |message: String| {
        source.fail(units().map_or(message.clone(), |(more, _)| format!("{message}; {more}")))
    };
    if let Some((text, true)) = units() {
        return Err(source.fail(text));
    }
    let refused = |error: Ep1Error| {
        let message = match error {
            Ep1Error::NotFinite { probe } => {
                format!("probe {}: the reading is not finite", recorded.probe(probe))
            }
            Ep1Error::TooFewProbes { .. } => recorded.with_note(&error),
            Ep1Error::Unresolved { radius_below, .. } if radius_below.is_some() => {
                format!("{error} {}", unit.as_str())
            }
            _ => error.to_string(),
        };
        fail(explained(message, error.into()))
    };

    let series = estimate_of_series(&recorded, options, unit).map_err(fail)?;
    if series.is_none() && !is_of_ends {
        let mut options = options.clone();
        options.estimator = RollEstimatorConfig::LeastSquares;
        options.series.start = None;
        return Ok(RollEstimate {
            repeated,
            lost_samples,
            ..estimate_roll(recorded, &options)?
        });
    }
    if let Some(series) = series {
        let has_pads = recorded.series.as_ref().is_some_and(|one| one.has_pads);
        let estimate = series.estimate();
        return Ok(RollEstimate {
            options: options.clone(),
            unit,
            covariance: Some(series.estimate.covariance),
            residual: estimate.residual(readings).0,
            estimate,
            freedom: None,
            std_from: match (options.series.noise == SeriesNoise::default(), has_pads) {
                (true, true) if series.noise == SeriesNoise::default() => "the pads' edges",
                (true, true) => "the steps of the rotations",
                (true, false) if options.series.contact_std == 0.0 => OF_RESIDUALS,
                _ => "the stated noise",
            },
            repeated,
            lost,
            lost_samples,
            probes,
            series: Some(series),
            single_direction: None,
            tested: None,
            recorded,
        });
    }
    let single = single_direction(readings, options.probe_radius, &options.noise);
    let single = single.map_err(refused)?;
    let (fitted_readings, mut noise) = match &single {
        Some((_, fitted, noise)) => (fitted, *noise),
        None => (readings, options.noise),
    };
    let fit =
        |noise| LeastSquares::fitted(options.probe_radius, noise, fitted_readings).map_err(refused);
    let (mut fitted, mut estimate) = fit(noise)?;
    let (residual, freedom) = estimate.residual(&fitted_readings[..readings.len()]);
    if !has_series && has_common_rotation(readings, residual) == Some(true) {
        return Err(fail(ORIENTATIONS.to_owned()));
    }
    let is_per_roll = !has_series && options.noise.pad_start == PadStart::PerRoll;
    let copies = is_per_roll.then(|| recorded.without_near_copies(residual, options.probe_radius));
    if let Some((merged, text)) = copies.flatten() {
        return Ok(RollEstimate {
            repeated: Some(text),
            lost,
            lost_samples,
            probes,
            ..estimate_roll(merged, options)?
        });
    }
    let mut noise_freedom = None;
    let std_from = match options.noise {
        ReadingNoise {
            relative_rotation_std: 0.0,
            rotation_std_rad: 0.0,
            shift_resolution,
            ..
        } if shift_resolution > 0.0 => "the pads' pitch",
        _ if noise.is_stated() => "the stated noise",
        _ if freedom == 0 || residual <= MIN_RESIDUAL * estimate.arc_length => {
            "none: the residuals are zero, and no noise or pitch is stated"
        }
        _ if common_step(readings) > STEPS_PER_STD * residual => {
            noise.shift_std = common_step(readings) / STEPS_PER_STD;
            (fitted, estimate) = fit(noise)?;
            FROM_STEPS
        }
        _ => {
            let (mut squares, mut rows) = (residual * residual * freedom as f64, freedom);
            // Rolls in one direction: only the residuals along the path contain the noise of the rotations.
            if let Some((angle, ..)) = &single {
                let across = Vector2::new(-libm::sin(*angle), libm::cos(*angle));
                let across = readings.iter().map(|one| one.shift.dot(&across).powi(2));
                squares = (squares - across.sum::<f64>()).max(MIN_SHARE_ALONG * squares);
                rows = readings.len() - 1;
            }
            noise.shift_std = (squares / rows as f64).sqrt();
            (fitted, estimate) = fit(noise)?;
            noise_freedom = Some(rows);
            OF_RESIDUALS
        }
    };
    let covariance = fitted.covariance(&estimate);
    let artificial = single.as_ref().and_then(|(_, fitted, _)| fitted.last());
    let tested = artificial.map(|roll| [&readings[..], &[*roll]].concat());
    let single_direction = single.as_ref().map(|(angle, ..)| {
        let half_width = half_width(noise_freedom);
        DirectedCurvature::new(*angle, &estimate, covariance.as_ref(), half_width, unit)
    });
    Ok(RollEstimate {
        options: options.clone(),
        recorded,
        unit,
        covariance,
        single_direction,
        tested,
        estimate,
        residual,
        freedom: noise_freedom,
        std_from,
        repeated,
        lost,
        lost_samples,
        probes,
        series: None,
    })
}

/// Largest number of degrees of freedom for which the half-width of an interval is stored after its first computation.
const MAX_CACHED: usize = 64;

/// Half-width of the 95 % interval, as a number of standard errors. `freedom` is the number of degrees of freedom from
/// which the noise was estimated; `None` if it was not estimated. For few degrees of freedom, the result is stored,
/// because its computation takes longer than the estimate from a few rolls.
fn half_width(freedom: Option<usize>) -> f64 {
    static CACHE: [OnceLock<f64>; MAX_CACHED] = [const { OnceLock::new() }; MAX_CACHED];
    let Some(freedom) = freedom else {
        return NORMAL_95;
    };
    let compute = || student_half_width(0.95, freedom);
    CACHE
        .get(freedom)
        .map_or_else(compute, |half_width| *half_width.get_or_init(compute))
}
