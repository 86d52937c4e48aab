//! Report of a pressed object, as JSON.

use std::collections::BTreeMap;

use palpate_press::{ContactRegime, Estimated, PressEstimate};
use serde::Serialize;

use super::Value;
use palpate_study::Unit;
use palpate_study::Warning;
use palpate_study::config::LengthUnit;

/// A value with its uncertainty; an end of the interval is `null` where the readings set no bound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Told {
    value: f64,
    std: Option<f64>,
    interval95: [Option<f64>; 2],
    unit: &'static str,
}

/// The radius of an object that may be flat: the larger, the flatter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Radius {
    /// Negative where concave; `null` where flat.
    value: Option<f64>,
    std: Option<f64>,
    /// 95 % interval of the radius if the object is convex, unsigned; an end of `null` is flat. `null` if it cannot
    /// be convex.
    convex95: Option<[Option<f64>; 2]>,
    /// The same if the object is concave.
    concave95: Option<[Option<f64>; 2]>,
    unit: &'static str,
}

/// A row of the readings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Row {
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
pub struct PressNoise {
    pub(super) normal_std: Value,
    /// Standard deviation of tangential displacements; `null` where none are used.
    pub(super) tangential_std: Option<Value>,
    /// Reduced χ² of the fit: about 1 where residuals are as large as the noise.
    pub(super) reduced_chi_squared: f64,
    /// Goodness-of-fit p-value by the stated noise; `null` if the noise is estimated from the residuals, and for a
    /// Gaussian.
    pub(super) p_value: Option<f64>,
}

/// Output of `estimate press`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PressReport {
    /// Version of this format, [`FORMAT_VERSION`](super::FORMAT_VERSION).
    pub(super) format_version: u32,
    pub(super) method: &'static str,
    /// The c of a Gaussian, given or calibrated; `null` for other methods.
    pub(super) c: Option<f64>,
    pub(super) markers: usize,
    pub(super) with_tangential: bool,
    pub(super) length_unit: &'static str,
    /// 1/R_s + 1/R_o.
    pub(super) relative_curvature: Told,
    /// Its inverse.
    pub(super) effective_radius: Told,
    /// 1/R_o, positive where convex.
    pub(super) object_curvature: Told,
    /// R_o.
    pub(super) object_radius: Radius,
    /// Contact regime of the estimate.
    pub(super) regime: &'static str,
    /// Shape of the object by the interval of its curvature: `convex`, `concave`, `flat-within-noise` or
    /// `not-resolved`.
    pub(super) verdict: &'static str,
    pub(super) indentation: Told,
    pub(super) contact_radius: Told,
    /// Force between the bodies; `null` without a Young's modulus, and for a Gaussian, which has no stress.
    pub(super) force: Option<Value>,
    /// Pressure in the middle of the contact; `null` if the force is `null`.
    pub(super) peak_pressure: Option<Value>,
    /// Place of the contact on the skin, in the coordinates of the markers.
    pub(super) contact: [f64; 2],
    pub(super) contact_std: [Option<f64>; 2],
    /// `null` where it is not fitted.
    pub(super) baseline: Option<Told>,
    /// Factor on normal displacements (for a Gaussian: amplitude over indentation); `null` if it is not fitted.
    pub(super) gain: Option<Told>,
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

/// Fields of a report that the estimate does not contain.
pub(super) struct Described {
    pub(super) format_version: u32,
    pub(super) method: &'static str,
    pub(super) c: Option<f64>,
    pub(super) markers: usize,
    pub(super) with_tangential: bool,
    pub(super) unit: LengthUnit,
    /// Force and peak pressure, if Young's modulus is given.
    pub(super) stresses: [Option<Value>; 2],
    pub(super) wrong_markers: Vec<Row>,
    pub(super) warnings: Vec<Warning>,
}

impl PressReport {
    /// Report of an estimate.
    pub(super) fn of(estimate: &PressEstimate, described: Described) -> Self {
        let Described { unit, .. } = described;
        let told = |estimated, power| Told::new(&estimated, power, unit);
        let curvature = estimate.object_curvature();
        // The radius is that of the best fit: the curvature is bias-corrected.
        let most_likely = Estimated {
            value: estimate.most_likely_object_curvature(),
            ..curvature
        };
        let [force, peak_pressure] = described.stresses;
        let p_value = estimate.goodness.map(|goodness| goodness.p_value);
        Self {
            format_version: described.format_version,
            method: described.method,
            c: described.c,
            markers: described.markers,
            with_tangential: described.with_tangential,
            length_unit: unit.as_str(),
            relative_curvature: told(estimate.relative_curvature, Unit::PerLength),
            effective_radius: told(estimate.effective_radius(), Unit::Length),
            object_curvature: told(curvature, Unit::PerLength),
            object_radius: Radius::of(&most_likely, unit),
            regime: ContactRegime::of(estimate.sensor_curvature, most_likely.value).name(),
            verdict: estimate.verdict.name(),
            indentation: told(estimate.indentation, Unit::Length),
            contact_radius: told(estimate.contact_radius, Unit::Length),
            force,
            peak_pressure,
            contact: estimate.contact.map(|component| component + 0.0),
            contact_std: estimate
                .contact_std
                .map(|std| Some(std).filter(|std| std.is_finite())),
            baseline: estimate
                .baseline
                .map(|baseline| told(baseline, Unit::Length)),
            gain: estimate.gain.map(|gain| told(gain, Unit::One)),
            wrong_markers: described.wrong_markers,
            noise: PressNoise {
                normal_std: Value::new(estimate.normal_std, None, Unit::Length, unit),
                tangential_std: estimate
                    .tangential_std
                    .map(|std| Value::new(std, None, Unit::Length, unit)),
                reduced_chi_squared: estimate.reduced_chi_squared,
                p_value,
            },
            r_squared: estimate.r_squared,
            contact_seen: estimate.is_detected,
            warnings: described.warnings,
        }
    }
}

fn finite(number: f64) -> Option<f64> {
    // Adding 0 turns −0 into 0.
    Some(number + 0.0).filter(|number| number.is_finite())
}

impl Told {
    pub(super) fn new(estimated: &Estimated, power: Unit, length: LengthUnit) -> Self {
        Self {
            value: estimated.value + 0.0,
            std: finite(estimated.std),
            interval95: [estimated.interval.low, estimated.interval.high]
                .map(|end| end.and_then(finite)),
            unit: power.of(length),
        }
    }
}

impl Radius {
    /// The inverse of a curvature.
    pub(super) fn of(curvature: &Estimated, length: LengthUnit) -> Self {
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
    use palpate_press::Interval;

    fn radius(value: f64, low: Option<f64>, high: Option<f64>) -> Radius {
        let interval = Interval { low, high };
        let std = 0.001;
        Radius::of(
            &Estimated {
                value,
                std,
                interval,
            },
            LengthUnit::Mm,
        )
    }

    #[test]
    fn radii_of_either_sign_and_of_none() {
        let ball = radius(0.02, Some(0.01), Some(0.04));
        assert_eq!(ball.value, Some(50.0));
        assert_eq!(
            (ball.convex95, ball.concave95),
            (Some([Some(25.0), Some(100.0)]), None)
        );
        assert_eq!(ball.std, Some(2.5));
        let dish = radius(-0.02, Some(-0.04), Some(-0.01));
        assert_eq!(dish.value, Some(-50.0));
        assert_eq!(
            (dish.convex95, dish.concave95),
            (None, Some([Some(25.0), Some(100.0)]))
        );
        let flat = radius(0.0, Some(-0.01), Some(0.005));
        assert_eq!((flat.value, flat.std), (None, None));
        assert_eq!(flat.convex95, Some([Some(200.0), None]));
        assert_eq!(flat.concave95, Some([Some(100.0), None]));
        let sharp = radius(1.0, Some(0.5), None);
        assert_eq!(
            (sharp.convex95, sharp.concave95),
            (Some([Some(0.0), Some(2.0)]), None)
        );
        let at_most = radius(0.0, Some(-0.01), Some(0.0));
        assert_eq!(
            (at_most.convex95, at_most.concave95),
            (None, Some([Some(100.0), None]))
        );
    }
}
