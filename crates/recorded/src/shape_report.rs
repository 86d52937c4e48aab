//! Reports about a fitted plane, sphere or cylinder, about a single stroke, and about contacts that were left out of
//! the fit.

use std::collections::BTreeMap;

use palpate_ep2::{Outlier, Shape, ShapeFit, SizeEstimate, StrokeCurvature};
use serde::Serialize;

use super::glide_report::tidy;
use super::source::ReadingSource;
use super::value::{Value, finite};
use palpate_study::Unit;
use palpate_study::config::LengthUnit;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct LeftOut {
    /// Row number of the contact in the readings, counted from 1.
    row: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    /// Reason why the contact was left out: `sentinel`, `zeros`, `far` or `misfit`.
    reason: &'static str,
}

impl LeftOut {
    pub(super) fn new(outlier: &Outlier, source: &ReadingSource) -> Self {
        Self {
            row: source.row_number(outlier.contact),
            line: source.line(outlier.contact),
            reason: outlier.reason.into(),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct StrokeReport {
    /// Normal curvature along the stroke, > 0 if convex.
    curvature_along: Value,
    /// Normal curvature across the stroke. The contacts of the stroke do not determine it.
    curvature_across: Value,
    /// Unit vector along the stroke. The opposite vector is equivalent.
    direction: [f64; 3],
}

impl StrokeReport {
    pub(super) fn new(stroke: &StrokeCurvature, unit: LengthUnit) -> Self {
        let StrokeCurvature {
            value,
            std,
            interval95,
            direction,
            ..
        } = stroke;
        Self {
            curvature_along: Value {
                interval95: Some(interval95.map(Some)),
                ..Value::new(*value, *std, Unit::PerLength, unit)
            },
            curvature_across: Value::open(Unit::PerLength, unit),
            direction: tidy(direction),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ShapeReport {
    shape: &'static str,
    /// Probability of each shape. The last entry is the probability that the surface has none of these shapes. `null`
    /// if the shape was stated.
    shape_probabilities: Option<BTreeMap<&'static str, f64>>,
    /// Radius of the most probable shape; `None` for a plane.
    #[serde(skip)]
    pub(super) radius: Option<Value>,
    /// Curvature of a sphere, or of a cylinder across its axis; > 0 if convex.
    curvature: Value,
    /// Centre of a sphere, or the point of a cylinder's axis that is nearest to the contacts; `null` if the contacts do
    /// not determine the radius.
    centre: Option<[f64; 3]>,
    centre_std: Option<[f64; 3]>,
    /// Direction of a cylinder's axis; the opposite direction is equivalent. `null` for other shapes.
    axis: Option<[f64; 3]>,
    axis_std_deg: Option<f64>,
    rms_misfit: Value,
    /// P-value of the shape: the probability that noise causes a worse fit if the contacts lie on this shape.
    shape_p_value: f64,
}

impl ShapeReport {
    /// Report of the fitted shape. If `is_open` is true, the contacts do not determine the size of the shape, and its
    /// sizes are `null`.
    pub(super) fn new(fit: &ShapeFit, unit: LengthUnit, is_open: bool) -> Self {
        let curvature = match is_undetermined(fit) {
            true => of_radius(fit),
            false => fit.curvature,
        };
        let size = |size: &SizeEstimate, power: Unit| match is_open {
            true => Value::open(power, unit),
            false => Value {
                value: size.value.and_then(finite),
                std: size.std.and_then(finite),
                interval95: Some(size.interval95.map(|end| end.and_then(finite))),
                ..Value::open(power, unit)
            },
        };
        let names = [Shape::Plane, Shape::Sphere, Shape::Cylinder].map(<&str>::from);
        let names = names.into_iter().chain(["none"]);
        let is_plane = fit.shape == Shape::Plane;
        let axis = fit
            .direction
            .filter(|_| fit.shape == Shape::Cylinder && !is_open);
        let centre = fit.place.filter(|_| !is_plane && !is_open);
        let axis_std = fit.direction_std_rad.filter(|_| axis.is_some());
        Self {
            shape: match fit.is_none_of_these() {
                true => "none",
                false => fit.shape.into(),
            },
            shape_probabilities: fit.probabilities.map(|all| names.zip(all).collect()),
            radius: (!is_plane).then(|| size(&fit.radius, Unit::Length)),
            curvature: size(&curvature, Unit::PerLength),
            centre: centre.map(|centre| tidy(&centre.coords)),
            centre_std: fit.place_std.filter(|_| centre.is_some()),
            axis: axis.as_ref().map(tidy),
            axis_std_deg: axis_std.map(f64::to_degrees),
            rms_misfit: Value::bare(fit.rms_misfit, Unit::Length.of(unit)),
            shape_p_value: fit.p_value,
        }
    }
}

/// The curvature of a shape whose radius has only a lower bound.
fn of_radius(fit: &ShapeFit) -> SizeEstimate {
    let most = fit.radius.interval95[0].map(f64::recip);
    SizeEstimate {
        value: None,
        std: None,
        interval95: [most.map(|most| -most), most],
    }
}

/// Whether the contacts leave the curvature undetermined. False for a plane, because its curvature is 0.
pub(super) fn is_undetermined(fit: &ShapeFit) -> bool {
    fit.shape != Shape::Plane && fit.radius.value.is_none()
}
