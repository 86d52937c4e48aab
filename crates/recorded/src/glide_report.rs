//! Report of a patch: the estimate as JSON, and the map as CSV.

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

/// Thresholds of the Gaussian and the mean curvature. Smaller magnitudes count as zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Thresholds {
    pub(super) gaussian: Value,
    pub(super) mean: Value,
    pub(super) from: &'static str,
}

impl Thresholds {
    pub(super) fn new(limits: &ShapeThresholds, from: &'static str, unit: LengthUnit) -> Self {
        Self {
            gaussian: Value::bare(limits.gaussian(), Unit::PerLengthSquared.of(unit)),
            mean: Value::bare(limits.mean(), Unit::PerLength.of(unit)),
            from,
        }
    }
}

/// Thresholds of the Gaussian and the mean curvature for a patch with the side lengths `u` and `v`. The 1996 paper by
/// Charlebois et al. uses 0.005 and 0.03 for a patch of 3 × 3 (in the paper's unit of length). These thresholds are
/// scaled by the mean of the side lengths. `None` if the scaled thresholds exceed the range of doubles.
pub(super) fn of_size([u, v]: [f64; 2]) -> Option<ShapeThresholds> {
    let paper_units = 3.0 / (0.5 * u + 0.5 * v);
    ShapeThresholds::new(0.005 * paper_units * paper_units, 0.03 * paper_units).ok()
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PatchNoise {
    /// Standard deviation of the noise of the positions, along the normal of the surface.
    pub(super) position_std: Value,
    /// Standard deviation of the tilt of a normal about each of the two tangents (degrees); `null` if the contacts have
    /// no normals.
    pub(super) normal_std_deg: Option<f64>,
}

/// A connected part of the map in which all points have the same class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PatchRegion {
    pub(super) class: &'static str,
    pub(super) points: usize,
    pub(super) area: Value,
    pub(super) gaussian_curvature: Value,
    pub(super) mean_curvature: Value,
    /// Direction of the largest curvature, averaged over the points of the region. The opposite direction is
    /// equivalent. `null` if the directions at the points differ too much for an average.
    pub(super) direction_of_max: Option<[f64; 3]>,
    /// Agreement of the directions at the points of the region, from 0 (all different) to 1 (all equal to
    /// `direction_of_max`).
    pub(super) coherence: f64,
}

/// Radius of an object that was touched in glides.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(super) enum GlideRadius {
    OfMean(Radius),
    OfShape(Option<Value>),
}

/// Output of the command `estimate glide`. Curvature, class and directions are for the middle of the patch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GlideEstimate {
    pub(super) format_version: u32,
    pub(super) method: &'static str,
    pub(super) contacts: usize,
    pub(super) fingers: usize,
    pub(super) with_normals: bool,
    pub(super) length_unit: &'static str,
    /// Position of the middle of the patch, on the fitted surface.
    pub(super) position: [f64; 3],
    /// Unit normal in the middle of the patch. It points out of the object.
    pub(super) normal: [f64; 3],
    pub(super) gaussian_curvature: Value,
    pub(super) mean_curvature: Value,
    /// Radius of the shape or, without a shape, the inverse of the mean curvature.
    pub(super) radius: GlideRadius,
    pub(super) k_min: Value,
    pub(super) k_max: Value,
    /// Unit tangent in the direction of the smallest curvature; the opposite tangent is equivalent.
    pub(super) direction_of_min: [f64; 3],
    /// Unit tangent in the direction of the largest curvature; the opposite tangent is equivalent.
    pub(super) direction_of_max: [f64; 3],
    /// Shape index, from −1 (a cup) to 1 (a cap); `null` if the surface is flat.
    pub(super) shape_index: Option<f64>,
    /// Class of the surface. `class`, `sign_class` and the curvatures are `null` if the contacts form a single stroke,
    /// or if no simple shape fits.
    pub(super) class: Option<&'static str>,
    /// Probability of each class; `null` if the method states no uncertainty.
    pub(super) class_probabilities: Option<BTreeMap<&'static str, f64>>,
    /// Class that follows from the signs of the estimated curvatures, without regard to their uncertainty; `null` if
    /// the Gaussian curvature is exactly 0, if the contacts form a single stroke, if no simple shape fits, or if the
    /// contacts do not determine the size of the shape.
    pub(super) sign_class: Option<&'static str>,
    pub(super) thresholds: Thresholds,
    /// Noise of the contacts; `null` if the method does not estimate noise.
    pub(super) noise: Option<PatchNoise>,
    /// Whether each pass of the method `two-pass` reached its target value for the sum of squared residuals; `null` for
    /// other methods. If the method did not reach the target (`knots-exhausted`, `unsettled`), do not use the
    /// curvatures.
    pub(super) status: Option<&'static str>,
    /// Effective degrees of freedom of the fitted surface.
    pub(super) effective_unknowns: f64,
    /// Number of points along each side of the map's grid.
    pub(super) grid: usize,
    /// Connected parts of the map in which all points have the same class, the largest first.
    pub(super) regions: Vec<PatchRegion>,
    /// P-value of the goodness of fit: the probability that noise of the stated size causes a worse fit if the model is
    /// right. `null` if the noise is estimated instead of stated, and for the method `two-pass`.
    pub(super) p_value: Option<f64>,
    /// Effective number of independent contacts. It is smaller than the number of contacts if contacts are repeated, if
    /// a finger rests, or if the noise is correlated.
    pub(super) effective_contacts: f64,
    /// Number of contacts after repeated contacts and contacts of a resting finger were merged.
    pub(super) distinct_contacts: usize,
    /// Number of consecutive contacts that together count as one independent contact, because their noise is
    /// correlated.
    pub(super) correlated_contacts: f64,
    /// Contacts that are not used in the fit.
    pub(super) left_out: Vec<LeftOut>,
    /// Curvature along the stroke if the contacts form a single stroke; otherwise `null`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) stroke: Option<StrokeReport>,
    /// Size and position of the fitted shape; `null` unless the method fits a shape.
    #[serde(flatten)]
    pub(super) shape: Option<ShapeReport>,
    /// Warnings: contradictions between the contacts and the model, each with its p-value, and likely mistakes.
    pub(super) warnings: Vec<Warning>,
    /// Covariance matrix of the Gaussian and the mean curvature in the middle of the patch. The unit is 1/length⁴ for
    /// the variance of the Gaussian curvature, 1/length² for the variance of the mean curvature, and 1/length³ for
    /// their covariance. `None` if the method states no uncertainty.
    #[serde(skip)]
    pub covariance: Option<[[f64; 2]; 2]>,
}

/// Map of the estimated curvature, on a grid over the patch or at the contacts.
#[derive(Clone, Debug)]
pub struct GlideMap {
    /// The points of the map: one per contact, or the points of a grid. In the list of grid points, the coordinate
    /// along the fingers' path changes slowest.
    pub points: Vec<MapPoint>,
    /// Index of the region of each point; `None` for a map at the contacts.
    pub regions: Option<Vec<usize>>,
    pub(super) thresholds: ShapeThresholds,
    pub(super) unit: LengthUnit,
    /// For a map at the contacts: the columns of the readings that palpate does not use, one row per contact.
    pub(super) extras: ExtraColumns,
}

impl GlideMap {
    /// The map as CSV, one row per point. A map at the contacts has no column of regions. Its last columns are copied
    /// from the readings: all columns that palpate does not use. If the map already has a column with the same name,
    /// the copied column gets the prefix `readings_`.
    pub fn to_csv(&self) -> String {
        let mut map = map_table(self.unit, false);
        for (place, point) in self.points.iter().enumerate() {
            let region = self.regions.as_ref().map(|regions| regions[place]);
            push_map_point(&mut map, None, point, region, &self.thresholds);
        }
        let mut table = map;
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

pub(super) fn tidy(vector: &Vector3<f64>) -> [f64; 3] {
    [vector.x, vector.y, vector.z].map(|number| number + 0.0)
}
