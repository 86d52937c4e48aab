//! Report of a patch: the estimate, as JSON, and the map.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use palpate_ep2::{MapPoint, Region, Regions};
use palpate_geometry::ShapeThresholds;
use serde::Serialize;

use super::press_report::Radius;
use super::reading_table::ExtraColumns;
use super::shape_report::{LeftOut, ShapeReport, StrokeReport};
use super::value::Value;
use palpate_estimators::{map_table, push_map_point};
use palpate_study::config::LengthUnit;
use palpate_study::{Column, Unit, Warning};

/// Thresholds below which curvatures count as zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Thresholds {
    pub(super) gaussian: Value,
    pub(super) mean: Value,
    /// Source of the thresholds, in words.
    pub(super) from: &'static str,
}

/// Noise of the contacts, estimated or stated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PatchNoise {
    /// Standard deviation of positions along the surface's normal.
    pub(super) position_std: Value,
    /// Standard deviation of a normal's tilt about each tangent; `null` without normals.
    pub(super) normal_std_deg: Option<f64>,
}

/// A connected part of the map that has one class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PatchRegion {
    pub(super) class: &'static str,
    /// Number of map points in the region.
    pub(super) points: usize,
    pub(super) area: Value,
    pub(super) gaussian_curvature: Value,
    pub(super) mean_curvature: Value,
    /// Common direction of largest curvature of the region's points, of either sign; `null` if there is none.
    pub(super) direction_of_max: Option<[f64; 3]>,
    /// Agreement of the points on this direction, from 0 to 1.
    pub(super) coherence: f64,
}

/// Radius of a glide's object.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(super) enum GlideRadius {
    OfMean(Radius),
    /// `null` for a plane.
    OfShape(Option<Value>),
}

/// Output of `estimate glide`. Curvature, class and directions are those of the patch's middle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GlideEstimate {
    pub(super) format_version: u32,
    pub(super) method: &'static str,
    pub(super) contacts: usize,
    pub(super) fingers: usize,
    pub(super) with_normals: bool,
    pub(super) length_unit: &'static str,
    /// The middle of the patch, on the fitted surface.
    pub(super) position: [f64; 3],
    /// Unit normal in the middle of the patch, out of the object.
    pub(super) normal: [f64; 3],
    pub(super) gaussian_curvature: Value,
    pub(super) mean_curvature: Value,
    /// Radius of the shape, or the inverse of the mean curvature.
    pub(super) radius: GlideRadius,
    pub(super) k_min: Value,
    pub(super) k_max: Value,
    /// Unit tangents, of either sign.
    pub(super) direction_of_min: [f64; 3],
    pub(super) direction_of_max: [f64; 3],
    /// Shape index from −1, a cup, to 1, a cap; `null` if the surface is flat.
    pub(super) shape_index: Option<f64>,
    /// `null` for a single stroke, like `sign_class` and the values of curvatures.
    pub(super) class: Option<&'static str>,
    /// Probability of each class; `null` if the method states no uncertainty.
    pub(super) class_probabilities: Option<BTreeMap<&'static str, f64>>,
    /// Class by the signs of the curvatures alone.
    pub(super) sign_class: Option<&'static str>,
    pub(super) thresholds: Thresholds,
    /// `null` if the method does not estimate noise.
    pub(super) noise: Option<PatchNoise>,
    /// Whether two-pass reached its smoothing sums; `null` for other methods. If it did not (`knots-exhausted`,
    /// `unsettled`), do not use the curvatures.
    pub(super) status: Option<&'static str>,
    /// Effective number of unknowns that the fit determined.
    pub(super) effective_unknowns: f64,
    /// Map points along each side.
    pub(super) grid: usize,
    /// Connected parts of the map that have one class, the largest first.
    pub(super) regions: Vec<PatchRegion>,
    /// Goodness-of-fit p-value: probability that noise of the stated size gives a worse fit if the model holds;
    /// `null` if the noise is estimated, and for two-pass.
    pub(super) p_value: Option<f64>,
    /// Number of independent contacts, after copies, rests and correlated noise.
    pub(super) effective_contacts: f64,
    /// Number of contacts after copies and rests are merged.
    pub(super) distinct_contacts: usize,
    /// Number of consecutive positions that count as one because their noise is correlated.
    pub(super) correlated_contacts: f64,
    /// Contacts that the fit does not use.
    pub(super) left_out: Vec<LeftOut>,
    /// Curvature along the stroke, if there is only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) stroke: Option<StrokeReport>,
    /// Size and place of the shape, for the methods that fit one.
    #[serde(flatten)]
    pub(super) shape: Option<ShapeReport>,
    /// Contradictions between the contacts and the model, each with its p-value, and other warnings.
    pub(super) warnings: Vec<Warning>,
    #[serde(skip)]
    pub(super) covariance: Option<[[f64; 2]; 2]>,
}

impl GlideEstimate {
    /// Covariance of Gaussian and mean curvature in the middle of the patch, 1/length⁴, 1/length³ and 1/length²; `None`
    /// if the method states no uncertainty.
    pub fn covariance(&self) -> Option<[[f64; 2]; 2]> {
        self.covariance
    }
}

/// The estimated curvature on a grid over the patch, or at the contacts.
#[derive(Clone, Debug)]
pub struct GlideMap {
    /// The contacts, or a grid whose slowest index runs along the fingers' path.
    pub points: Vec<MapPoint>,
    /// Index of the region of each point; `None` for a map at the contacts.
    pub regions: Option<Vec<usize>>,
    pub(super) thresholds: ShapeThresholds,
    pub(super) unit: LengthUnit,
    /// Other fields of the readings, contact by contact, for a map at the contacts.
    pub(super) extras: ExtraColumns,
}

impl GlideMap {
    /// The map as CSV, one row per point. A map at the contacts has no regions, and ends with the columns of the readings
    /// that palpate does not use. If the map already has a column of that name, the prefix `readings_` is added.
    pub fn to_csv(&self) -> String {
        let mut map = map_table(self.unit, false);
        for (place, point) in self.points.iter().enumerate() {
            let region = self.regions.as_ref().map(|regions| regions[place]);
            push_map_point(&mut map, None, point, region, &self.thresholds);
        }
        let mut table = map.table;
        for name in &self.extras.names {
            let mut name = name.clone();
            while table.columns.iter().any(|column| column.name == name) {
                name = format!("readings_{name}");
            }
            table.columns.push(Column::text(&name));
        }
        for (place, row) in table.rows.iter_mut().enumerate() {
            row.extend(self.extras.row(place));
        }
        table.to_csv()
    }
}

impl PatchRegion {
    pub(super) fn all(regions: &Regions, unit: LengthUnit) -> Vec<Self> {
        let all = regions.regions.iter();
        all.map(|region| Self::of(region, unit)).collect()
    }

    fn of(region: &Region, unit: LengthUnit) -> Self {
        let value = |value: f64, power: Unit| Value::bare(value, power.of(unit));
        Self {
            class: region.class.name(),
            points: region.points,
            area: value(region.area, Unit::LengthSquared),
            gaussian_curvature: value(region.gaussian_curvature, Unit::PerLengthSquared),
            mean_curvature: value(region.mean_curvature, Unit::PerLength),
            direction_of_max: region.direction_of_max.as_ref().map(tidy),
            coherence: region.coherence,
        }
    }
}

/// Replaces −0 by 0.
pub(super) fn tidy(vector: &Vector3<f64>) -> [f64; 3] {
    [vector.x, vector.y, vector.z].map(|number| number + 0.0)
}
