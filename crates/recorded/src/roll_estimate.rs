//! Estimate of the curvature from recorded rolls.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

use nalgebra::Vector2;
use palpate_ep1::{Ep1Error, LeastSquares, Measured, ProbeReading, ReadingNoise};
use palpate_statistics::{NORMAL_95, Number, student_half_width};
use serde::Serialize;

use super::Value;
use super::consistency::FORMAT_VERSION;
use super::error::{RecordedError, explained};
use super::input_checks::of_roll;
use super::roll_misfit::RollFit;
use super::roll_recording::{RollOptions, RollRecording};
use super::source::agreed_unit;
use palpate_study::config::{LengthUnit, RollEstimatorConfig};
use palpate_study::{Unit, Warning};

/// A probe whose contact did not move.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnresolvedProbe {
    probe: u64,
    /// Upper bound of the object's radius of curvature in the direction of the roll; `null` if the pads' pitch is not
    /// given or too coarse.
    radius_below: Option<f64>,
    unit: String,
    /// Other fields of the probe's row, by column name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    columns: BTreeMap<String, String>,
}

/// Estimate of the curvature from recorded rolls. Its [`report`](Self::report) has the warnings too.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RollEstimate {
    /// Version of this format, [`FORMAT_VERSION`](super::FORMAT_VERSION).
    format_version: u32,
    method: &'static str,
    probes: usize,
    normal_curvature_u: Value,
    normal_curvature_v: Value,
    gaussian_curvature: Value,
    mean_curvature: Value,
    arc_length: Value,
    principal_curvature_min: Value,
    principal_curvature_max: Value,
    /// Direction of the largest curvature, from +u towards +v of the readings.
    principal_direction_max_deg: f64,
    /// Amplification of a relative error of the readings: 1 + 1/RCR; `null` if the object is flat.
    amplification_u: Option<f64>,
    amplification_v: Option<f64>,
    /// Root mean square of the residuals of the shifts' components.
    residual_rms: Value,
    /// ReadingSource of the standard deviations, in words.
    std_from: &'static str,
    unresolved_probes: Vec<UnresolvedProbe>,
    /// Goodness-of-fit p-value by the stated noise; `null` if no noise is stated.
    p_value: Option<f64>,
    #[serde(skip)]
    fitted: RollFit,
    #[serde(skip)]
    covariance: Option<[[f64; 3]; 3]>,
}

/// Output of `estimate roll`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RollReport<'e> {
    #[serde(flatten)]
    estimate: &'e RollEstimate,
    warnings: Vec<Warning>,
}

impl RollEstimate {
    /// Contradictions between the readings and the model, and likely mistakes in the readings. They take longer than the
    /// estimate, so they are computed only here.
    pub fn warnings(&self) -> Vec<Warning> {
        self.fitted.warnings()
    }

    /// The estimate with its warnings.
    pub fn report(&self) -> RollReport<'_> {
        RollReport {
            estimate: self,
            warnings: self.warnings(),
        }
    }

    /// Covariance of the normal curvatures along u and v and of the twist k_uv, 1/length²; `None` if the noise is
    /// unknown.
    pub fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        self.covariance
    }
}

/// Estimates the object's curvature from recorded rolls.
///
/// Standard deviations follow from the noise that is stated, else from the residuals, where
/// there are more readings than unknowns. Intervals of the latter are Student's, of 2n − 3 degrees of freedom with n probes
/// ([`palpate_statistics::student_half_width`]): of 95 %, 2.57 standard deviations to either side with 4 probes and 2.16 with 8.
///
/// ```
/// use palpate_recorded::{RecordedFile, RollOptions, estimate_roll, parse_roll};
///
/// // A probe of radius 10 that is turned by 0.3 on a ball of radius 20 rolls over 0.3 / (1/10 + 1/20) = 2.
/// let csv = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n0,0,-0.3,2,0\n1,0.3,0,0,2\n";
/// let readings = parse_roll(RecordedFile::new("readings.csv", csv.as_bytes().to_vec()))?;
/// let estimate = estimate_roll(&readings, &RollOptions::new(10.0))?;
/// let estimate = serde_json::to_value(estimate)?;
/// let curvature = estimate["mean_curvature"]["value"].as_f64().ok_or("no number")?;
/// assert!((curvature - 0.05).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RecordedError::Readings`] if the options contradict the file or the readings do not determine the curvature.
pub fn estimate_roll(
    recorded: &RollRecording,
    options: &RollOptions,
) -> Result<RollEstimate, RecordedError> {
    let origin = &recorded.origin;
    let unit = agreed_unit(origin, recorded.unit, options.length_unit)?;
    let readings = &recorded.readings;
    let fail = |message: String| {
        let units = of_roll(readings, options.probe_radius, unit);
        origin.fail(units.map_or(message.clone(), |more| format!("{message}; {more}")))
    };
    let half_way = PI * options.probe_radius;
    for (probe, reading) in recorded.probes.iter().zip(readings) {
        let shift = libm::hypot(reading.shift.x, reading.shift.y);
        if shift > half_way * (1.0 + 1e-9) {
            let unit = unit.as_str();
            return Err(fail(format!(
                "probe {probe}: a shift of {} {unit} passes half way round the probe ({} {unit})",
                Number(shift),
                Number(half_way)
            )));
        }
    }
    let refused = |error: Ep1Error| {
        let message = match error {
            Ep1Error::NotFinite { probe } => {
                format!(
                    "probe {}: the reading is not finite",
                    recorded.probes[probe]
                )
            }
            Ep1Error::Unresolved {
                radius_below: Some(_),
                ..
            } => {
                format!("{error} {}", unit.as_str())
            }
            _ => error.to_string(),
        };
        fail(explained(message, error.name()))
    };

    let RollEstimatorConfig::LeastSquares = options.estimator;
    let stated = options.noise;
    let fit = |noise| LeastSquares::fitted(options.probe_radius, noise, readings).map_err(refused);
    let (mut fitted, mut estimate) = fit(stated)?;
    let by_stated_noise = RollFit {
        recorded: recorded.clone(),
        options: options.clone(),
        unit,
        fit: fitted.clone(),
        estimate,
    };
    let goodness = fitted.goodness(&estimate, readings);
    let (residual, freedom) = estimate.residual(readings);
    let mut std_from = match stated {
        ReadingNoise {
            relative_rotation_std: 0.0,
            rotation_std_rad: 0.0,
            shift_resolution,
            ..
        } if shift_resolution > 0.0 => "the pads' pitch",
        _ => "the stated noise",
    };
    if !stated.is_stated() {
        std_from = "none: the residuals are zero and no pitch is given";
        if freedom > 0 && residual > 0.0 {
            std_from = "the residuals";
            (fitted, estimate) = fit(ReadingNoise {
                shift_std: residual,
                ..stated
            })?;
        }
    }

    let half_width = match std_from {
        "the residuals" => half_width(freedom),
        _ => NORMAL_95,
    };
    let value =
        |Measured { value, std }, power: Unit| Value::within(value, std, half_width, power, unit);
    let bare = |value: f64, power: Unit| Value::new(value, None, power, unit);
    let principal = estimate.curvature.principal();
    Ok(RollEstimate {
        format_version: FORMAT_VERSION,
        method: "least-squares",
        probes: readings.len(),
        normal_curvature_u: value(estimate.normal_curvature_u, Unit::PerLength),
        normal_curvature_v: value(estimate.normal_curvature_v, Unit::PerLength),
        gaussian_curvature: value(estimate.gaussian_curvature, Unit::PerLengthSquared),
        mean_curvature: value(estimate.mean_curvature, Unit::PerLength),
        arc_length: bare(estimate.arc_length, Unit::Length),
        principal_curvature_min: bare(principal.k_min, Unit::PerLength),
        principal_curvature_max: bare(principal.k_max, Unit::PerLength),
        principal_direction_max_deg: principal.angle_of_max_rad.to_degrees() + 0.0,
        amplification_u: estimate.amplification(0.0),
        amplification_v: estimate.amplification(FRAC_PI_2),
        residual_rms: bare(residual, Unit::Length),
        std_from,
        unresolved_probes: unresolved(
            recorded,
            options.probe_radius,
            stated.shift_resolution,
            unit,
        ),
        p_value: goodness.map(|goodness| goodness.p_value),
        fitted: by_stated_noise,
        covariance: fitted.covariance(&estimate),
    })
}

/// Largest number of degrees of freedom for which half-widths are computed only once.
const MAX_CACHED: usize = 64;

/// Half-width of the 95 % interval in standard deviations with these degrees of freedom. Computing it takes longer than the
/// estimate of a few rolls.
fn half_width(freedom: usize) -> f64 {
    static CACHE: [OnceLock<f64>; MAX_CACHED] = [const { OnceLock::new() }; MAX_CACHED];
    let compute = || student_half_width(0.95, freedom);
    CACHE
        .get(freedom)
        .map_or_else(compute, |half_width| *half_width.get_or_init(compute))
}

/// Probes that rolled without a shift, with the bound on the object's radius that follows.
fn unresolved(
    recorded: &RollRecording,
    probe_radius: f64,
    resolution: f64,
    unit: LengthUnit,
) -> Vec<UnresolvedProbe> {
    let still = |reading: &ProbeReading| {
        reading.shift == Vector2::zeros() && reading.rotation != Vector2::zeros()
    };
    recorded
        .probes
        .iter()
        .zip(&recorded.readings)
        .enumerate()
        .filter(|(_, (_, reading))| still(reading))
        .map(|(place, (&probe, reading))| {
            let radius = 1.0 / (reading.rotation.norm() / resolution - 1.0 / probe_radius);
            let radius_below =
                (resolution > 0.0 && radius > 0.0 && radius.is_finite()).then_some(radius);
            UnresolvedProbe {
                probe,
                radius_below,
                unit: unit.as_str().to_owned(),
                columns: recorded
                    .rows
                    .get(place)
                    .map_or_else(BTreeMap::new, |&row| recorded.extras.named(row)),
            }
        })
        .collect()
}
