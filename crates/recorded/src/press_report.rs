//! Report of a press, as JSON.

use std::collections::BTreeMap;

use palpate_press::{ContactRegime, Estimated, Interval, PressEstimate};
use palpate_study::config::LengthUnit;
use palpate_study::{Unit, Warning};
use serde::Serialize;

use super::value::{FORMAT_VERSION, Value, finite};

/// Radius of the object. The radius of a flat object is infinite. JSON cannot express infinity, so an infinite radius
/// or end of an interval is `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Radius {
    value: Option<f64>,
    std: Option<f64>,
    /// 95 % interval of the radius's magnitude for a convex object. An end is `null` if the object may be flat. The
    /// interval is `null` if the object cannot be convex.
    convex95: Option<[Option<f64>; 2]>,
    /// 95 % interval of the radius's magnitude for a concave object. An end is `null` if the object may be flat. The
    /// interval is `null` if the object cannot be concave.
    concave95: Option<[Option<f64>; 2]>,
    unit: &'static str,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Principal {
    curvature_max: Value,
    curvature_min: Value,
    /// Angle from the x axis to the direction of the smaller curvature (for a cylinder, its axis), degrees, from −90 to
    /// 90.
    axis_deg: f64,
    /// Standard error of `axis_deg`, degrees. The standard error is at most 52, which is its value for a completely
    /// unknown axis.
    axis_std_deg: f64,
    /// Semi-axes of the contact ellipse (length), the longer semi-axis first.
    semi_axes: [f64; 2],
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Row {
    /// Number of the row, counted from 1. The header row is not counted.
    pub(super) row: usize,
    pub(super) line: Option<usize>,
    /// For each column that palpate does not use: its name, and its text in this row.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) columns: BTreeMap<String, String>,
}

/// Noise of the displacements, stated or estimated from the residuals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PressNoise {
    normal_std: Value,
    /// Standard deviation of the tangential displacements; `null` if no tangential displacements are used.
    tangential_std: Option<Value>,
    /// Reduced χ² of the fit. It is about 1 if the residuals are as large as the noise.
    reduced_chi_squared: f64,
    /// p-value of the goodness of fit; `null` if the noise of the normal or the tangential displacements is estimated
    /// from the residuals.
    p_value: Option<f64>,
}

/// Output of the command `estimate press`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PressReport {
    pub(super) format_version: u32,
    pub(super) method: &'static str,
    /// Constant c of a Gaussian, given or calibrated: R = c σ²/δ, with the effective radius R, the width σ of the
    /// Gaussian and the indentation δ. `null` for other methods.
    pub(super) c: Option<f64>,
    pub(super) markers: usize,
    pub(super) with_tangential: bool,
    pub(super) length_unit: &'static str,
    /// Relative curvature 1/R_s + 1/R_o, with the sensor's radius R_s and the object's radius R_o.
    pub(super) relative_curvature: Value,
    /// Effective radius of the contact: the inverse of `relative_curvature`.
    pub(super) effective_radius: Value,
    /// Curvature 1/R_o of the object, positive if the object is convex (R_o is its radius).
    pub(super) object_curvature: Value,
    pub(super) object_radius: Radius,
    /// Principal curvatures of the object; `null` unless the method is `elliptic`. The mean of the principal curvatures
    /// is `object_curvature`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) principal: Option<Principal>,
    /// Kind of contact of a press on an object with the estimated curvature: convex, flat, concave, conforming or edge.
    pub(super) regime: &'static str,
    /// Conclusion about the sign of the object's curvature, from its interval: `convex`, `concave`, `flat-within-noise`
    /// or `not-resolved`.
    pub(super) verdict: &'static str,
    pub(super) indentation: Value,
    pub(super) contact_radius: Value,
    /// Force between the bodies; `null` without Young's modulus, and for a Gaussian, which has no model of stress.
    pub(super) force: Option<Value>,
    pub(super) peak_pressure: Option<Value>,
    /// Position of the contact on the skin, in the coordinates of the markers.
    pub(super) contact: [f64; 2],
    pub(super) contact_std: [Option<f64>; 2],
    /// Fitted offset that is added to all normal displacements; `null` if it is not fitted.
    pub(super) baseline: Option<Value>,
    /// Fitted factor by which all normal displacements are multiplied; `null` if it is not fitted. For a Gaussian, the
    /// factor is the ratio of the Gaussian's amplitude to the indentation.
    pub(super) gain: Option<Value>,
    /// Markers that were left out of the fit, because their readings contradict the readings of the other markers.
    pub(super) wrong_markers: Vec<Row>,
    pub(super) noise: PressNoise,
    /// Share of the variance of the normal displacements that the fit explains.
    pub(super) r_squared: f64,
    /// Whether the displacements alone show a contact. If not, the curvature's interval contains the curvatures of all
    /// contacts that agree with the displacements. Only contacts with the stated indentation and within the area of the
    /// markers are considered.
    pub(super) contact_seen: bool,
    /// Warnings: contradictions between the readings and the model, each with its p-value, and likely mistakes.
    pub(super) warnings: Vec<Warning>,
}

impl PressReport {
    /// Variance of the residuals of the normal displacements.
    pub(super) fn residual_variance(&self) -> f64 {
        self.noise.normal_std.number().powi(2) * self.noise.reduced_chi_squared
    }

    /// Report of the press estimate `estimate`. Fields that need other data, such as `force`, are empty.
    pub(super) fn of(estimate: &PressEstimate, method: &'static str, unit: LengthUnit) -> Self {
        let value = |estimated, power| Value::of(&estimated, power, unit);
        let std = |std: f64| Value::bare(std, unit.as_str());
        let curvature = estimate.object_curvature();
        // Compute the radius from the curvature of the best fit, not from `object_curvature`, which is corrected for
        // bias.
        let most_likely = Estimated {
            value: estimate.most_likely_object_curvature(),
            ..curvature
        };
        Self {
            format_version: FORMAT_VERSION,
            method,
            c: None,
            markers: 0,
            with_tangential: true,
            length_unit: unit.as_str(),
            relative_curvature: value(estimate.relative_curvature, Unit::PerLength),
            effective_radius: value(estimate.effective_radius(), Unit::Length),
            object_curvature: value(curvature, Unit::PerLength),
            object_radius: Radius::of(&most_likely, unit),
            principal: estimate.principal.map(|principal| Principal {
                curvature_max: value(principal.curvatures[0], Unit::PerLength),
                curvature_min: value(principal.curvatures[1], Unit::PerLength),
                axis_deg: principal.axis.to_degrees(),
                axis_std_deg: principal.axis_std.to_degrees(),
                semi_axes: principal.contact.semi_axes,
            }),
            regime: ContactRegime::of(estimate.sensor_curvature, most_likely.value).into(),
            verdict: estimate.verdict.into(),
            indentation: value(estimate.indentation, Unit::Length),
            contact_radius: value(estimate.contact_radius, Unit::Length),
            force: None,
            peak_pressure: None,
            contact: estimate.contact.map(|component| component + 0.0),
            contact_std: estimate.contact_std.map(finite),
            baseline: estimate.baseline.map(|one| value(one, Unit::Length)),
            gain: estimate.gain.map(|gain| value(gain, Unit::One)),
            wrong_markers: Vec::new(),
            noise: PressNoise {
                normal_std: std(estimate.normal_std),
                tangential_std: estimate.tangential_std.map(std),
                reduced_chi_squared: estimate.reduced_chi_squared,
                p_value: estimate.goodness.map(|goodness| goodness.p_value),
            },
            r_squared: estimate.r_squared,
            contact_seen: estimate.is_detected,
            warnings: Vec::new(),
        }
    }
}

impl Radius {
    /// The radius as the inverse of a mean curvature. The radius has no interval if the curvature has no standard
    /// error.
    pub(super) fn of_mean(curvature: &Value, length: LengthUnit) -> Self {
        let [low, high] = curvature.interval95.unwrap_or_default();
        let radius = Self::of(
            &Estimated {
                value: curvature.number(),
                std: curvature.std.unwrap_or(f64::NAN),
                interval: Interval { low, high },
            },
            length,
        );
        match curvature.interval95 {
            Some(_) => radius,
            None => Self {
                convex95: None,
                concave95: None,
                ..radius
            },
        }
    }

    fn of(curvature: &Estimated, length: LengthUnit) -> Self {
        let value = finite(curvature.value.recip());
        let [low, high] = [curvature.interval.low, curvature.interval.high];
        // If the interval of the curvature is unbounded, the radius may be arbitrarily small, so the lower end of the
        // radius's interval is 0.
        let sharpest = |end: Option<f64>| end.map_or(Some(0.0), |end| finite(end.recip().abs()));
        let flattest = |end: Option<f64>, is_beyond: bool| {
            end.filter(|_| is_beyond)
                .and_then(|end| finite(end.recip().abs()))
        };
        let may_be_convex = high.is_none_or(|high| high > 0.0);
        let may_be_concave = low.is_none_or(|low| low < 0.0);
        Self {
            value,
            std: value.and_then(|radius| finite(curvature.std * radius * radius)),
            convex95: may_be_convex.then(|| [sharpest(high), flattest(low, !may_be_concave)]),
            concave95: may_be_concave.then(|| [sharpest(low), flattest(high, !may_be_convex)]),
            unit: Unit::Length.of(length),
        }
    }
}
