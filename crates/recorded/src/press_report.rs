//! Report of a press, as JSON.

use std::collections::BTreeMap;

use palpate_press::{ContactRegime, Estimated, Interval, PressEstimate};
use palpate_study::config::LengthUnit;
use palpate_study::{Unit, Warning};
use serde::Serialize;

use super::value::{FORMAT_VERSION, Value, finite};

/// The radius of an object that may be flat: the larger, the flatter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Radius {
    /// Negative if concave; `null` if flat.
    value: Option<f64>,
    std: Option<f64>,
    /// 95 % interval of the radius if the object is convex, unsigned; an end of `null` is flat. `null` if it cannot
    /// be convex.
    convex95: Option<[Option<f64>; 2]>,
    /// The same if the object is concave.
    concave95: Option<[Option<f64>; 2]>,
    unit: &'static str,
}

/// Principal curvatures of the object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Principal {
    curvature_max: Value,
    curvature_min: Value,
    /// Angle of the direction of the smaller curvature, the axis of a cylinder, to the x axis, from −90 to 90.
    axis_deg: f64,
    /// At most 52, that of an unknown axis.
    axis_std_deg: f64,
    /// Semi-axes of the contact, the longer first.
    semi_axes: [f64; 2],
}

/// A row of the readings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Row {
    /// Number of the row from 1, without the header.
    pub(super) row: usize,
    /// Its line in the file.
    pub(super) line: Option<usize>,
    /// Other fields of the row, by column name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) columns: BTreeMap<String, String>,
}

/// Noise of the displacements, stated or estimated from the residuals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PressNoise {
    normal_std: Value,
    /// Standard deviation of tangential displacements; `null` if none are used.
    tangential_std: Option<Value>,
    /// Reduced χ² of the fit: about 1 if residuals are as large as the noise.
    reduced_chi_squared: f64,
    /// Goodness-of-fit p-value by the stated noise; `null` if the noise is estimated from the residuals, and for a
    /// Gaussian.
    p_value: Option<f64>,
}

/// Output of `estimate press`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PressReport {
    pub(super) format_version: u32,
    pub(super) method: &'static str,
    /// The c of a Gaussian, given or calibrated; `null` for other methods.
    pub(super) c: Option<f64>,
    pub(super) markers: usize,
    pub(super) with_tangential: bool,
    pub(super) length_unit: &'static str,
    /// 1/R_s + 1/R_o.
    pub(super) relative_curvature: Value,
    /// Its inverse.
    pub(super) effective_radius: Value,
    /// 1/R_o, positive if convex.
    pub(super) object_curvature: Value,
    /// R_o.
    pub(super) object_radius: Radius,
    /// The principal curvatures, by method `elliptic`; the other curvatures are then their mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) principal: Option<Principal>,
    /// Contact regime of the estimate.
    pub(super) regime: &'static str,
    /// Shape of the object by the interval of its curvature: `convex`, `concave`, `flat-within-noise` or
    /// `not-resolved`.
    pub(super) verdict: &'static str,
    pub(super) indentation: Value,
    pub(super) contact_radius: Value,
    /// Force between the bodies; `null` without a Young's modulus, and for a Gaussian, which has no stress.
    pub(super) force: Option<Value>,
    /// Pressure in the middle of the contact; `null` if the force is `null`.
    pub(super) peak_pressure: Option<Value>,
    /// Place of the contact on the skin, in the coordinates of the markers.
    pub(super) contact: [f64; 2],
    pub(super) contact_std: [Option<f64>; 2],
    /// `null` if it is not fitted.
    pub(super) baseline: Option<Value>,
    /// Factor on normal displacements (for a Gaussian: amplitude over indentation); `null` if it is not fitted.
    pub(super) gain: Option<Value>,
    /// Readings that contradict the others and were left out.
    pub(super) wrong_markers: Vec<Row>,
    pub(super) noise: PressNoise,
    /// The share of the normal displacements' variance that the fit explains.
    pub(super) r_squared: f64,
    /// Whether the displacements alone show a contact. If not, the interval covers all contacts of the stated
    /// indentation, on the markers, that the displacements do not exclude.
    pub(super) contact_seen: bool,
    /// Contradictions between the readings and the model, each with its p-value, and other warnings.
    pub(super) warnings: Vec<Warning>,
}

impl PressReport {
    /// Report of an estimate by a method, without the fields that the estimate does not contain.
    pub(super) fn of(estimate: &PressEstimate, method: &'static str, unit: LengthUnit) -> Self {
        let value = |estimated, power| Value::of(&estimated, power, unit);
        let std = |std: f64| Value::bare(std, unit.as_str());
        let curvature = estimate.object_curvature();
        // The radius is that of the best fit: the curvature is bias-corrected.
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
            regime: ContactRegime::of(estimate.sensor_curvature, most_likely.value).name(),
            verdict: estimate.verdict.name(),
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
    /// The inverse of a mean curvature with its interval, if the noise is known.
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

    /// The inverse of a curvature.
    fn of(curvature: &Estimated, length: LengthUnit) -> Self {
        let value = finite(curvature.value.recip());
        let [low, high] = [curvature.interval.low, curvature.interval.high];
        // Without a bound on the curvature, the radius may be arbitrarily small.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_radius_is_the_inverse_of_a_curvature_of_any_sign() {
        let [ball, wide] = [Some([Some(25.0), Some(100.0)]), Some([Some(100.0), None])];
        for (value, low, high, radius, convex, concave) in [
            (0.02, Some(0.01), Some(0.04), Some(50.0), ball, None),
            (-0.02, Some(-0.04), Some(-0.01), Some(-50.0), None, ball),
            (0.0, Some(-0.01), Some(0.01), None, wide, wide),
            (
                1.0,
                Some(0.5),
                None,
                Some(1.0),
                Some([Some(0.0), Some(2.0)]),
                None,
            ),
            (0.0, Some(-0.01), Some(0.0), None, None, wide),
        ] {
            let std = 0.001;
            let interval = Interval { low, high };
            let estimated = Estimated {
                value,
                std,
                interval,
            };
            let found = Radius::of(&estimated, LengthUnit::Mm);
            assert_eq!(found.value, radius);
            assert_eq!(
                (found.convex95, found.concave95),
                (convex, concave),
                "{value}"
            );
            assert_eq!(found.std, radius.map(|radius| std * radius * radius));
        }
    }
}
