//! The curvature of a patch from recorded glides.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use palpate_ep2::{
    Curvature, Ep2Error, Fit, MapPoint, Method, Noise, Patch, Penalised, Quadric, Region, Regions,
    TwoPass, Uncertainty, regions,
};
use palpate_geometry::{ShapeClass, ShapeThresholds};
use serde::Serialize;

use super::Value;
use super::glide::GlideReadings;
use super::sheet::{RecordedError, agreed_unit};
use crate::Unit;
use crate::config::LengthUnit;
use crate::glide::{MapTable, PatchMethod};

/// How to estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GlideMethod {
    /// A penalised spline through heights and slopes.
    #[default]
    Penalised,
    /// The two passes of the 1996 paper.
    TwoPass,
    /// A least-squares quadric.
    Quadric,
}

/// What the readings do not say themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlideOptions {
    /// The estimator.
    pub method: GlideMethod,
    /// The unit of lengths, where the header does not state it.
    pub length_unit: Option<LengthUnit>,
    /// Out of the object; only its side of the patch matters, and only without normals.
    pub outward: [f64; 3],
    /// Places of the map along each side.
    pub grid: usize,
    /// When curvatures count as zero, in the unit of the readings; `None` takes them from the size
    /// of the patch.
    pub thresholds: Option<ShapeThresholds>,
    /// Standard deviation of a position along each axis, length; `None` finds it from the contacts.
    /// Two-pass has no use for it.
    pub position_std: Option<f64>,
    /// Standard deviation of a normal's tilt about each tangent; likewise.
    pub normal_std_rad: Option<f64>,
}

impl Default for GlideOptions {
    fn default() -> Self {
        Self {
            method: GlideMethod::default(),
            length_unit: None,
            outward: [0.0, 0.0, 1.0],
            grid: 30,
            thresholds: None,
            position_std: None,
            normal_std_rad: None,
        }
    }
}

/// When curvatures count as zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Thresholds {
    gaussian: Value,
    mean: Value,
    /// Where they come from.
    from: &'static str,
}

/// How far contacts are off, as found or as stated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatchNoise {
    /// Along the surface's normal.
    position_std: Value,
    /// Of a normal's tilt about each tangent; `null` without normals.
    normal_std_deg: Option<f64>,
}

/// A connected part of the map that has one class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatchRegion {
    class: &'static str,
    /// How many places of the map it holds.
    points: usize,
    area: Value,
    gaussian_curvature: Value,
    mean_curvature: Value,
    /// The direction of largest curvature that its places share, of either sign; `null` where they
    /// share none.
    direction_of_max: Option<[f64; 3]>,
    /// How well its places agree on it, from 0 to 1.
    coherence: f64,
}

/// What `estimate glide` prints. Curvature, class and directions are those of the patch's middle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GlideEstimate {
    method: &'static str,
    contacts: usize,
    fingers: usize,
    with_normals: bool,
    length_unit: &'static str,
    /// The middle of the patch, on the fitted surface.
    position: [f64; 3],
    /// Out of the object.
    normal: [f64; 3],
    gaussian_curvature: Value,
    mean_curvature: Value,
    k_min: Value,
    k_max: Value,
    /// Unit tangents, of either sign.
    direction_of_min: [f64; 3],
    direction_of_max: [f64; 3],
    /// From −1, a cup, to 1, a cap; `null` where the surface is flat.
    shape_index: Option<f64>,
    class: &'static str,
    /// `null` where the method states no uncertainty.
    class_probabilities: Option<BTreeMap<&'static str, f64>>,
    /// By the signs of the curvatures alone.
    sign_class: &'static str,
    thresholds: Thresholds,
    /// `null` where the method does not find it.
    noise: Option<PatchNoise>,
    /// How many unknowns the fit has taken up.
    effective_unknowns: f64,
    /// Places of the map along each side.
    grid: usize,
    /// The map's parts of one class, the largest first.
    regions: Vec<PatchRegion>,
}

/// The estimated curvature on a grid over the patch.
#[derive(Clone, Debug)]
pub struct GlideMap {
    points: Vec<MapPoint>,
    regions: Regions,
    thresholds: ShapeThresholds,
    unit: LengthUnit,
}

impl GlideMap {
    /// The map as CSV, one row per place.
    pub fn to_csv(&self) -> String {
        let mut table = MapTable::of_readings(self.unit);
        table.push_map(&self.points, &self.regions, &self.thresholds);
        table.into_csv()
    }
}

/// Estimates the curvature of a patch from recorded contacts.
///
/// # Errors
/// [`RecordedError::Line`] where one contact is at fault, else [`RecordedError::Readings`]: where
/// the options contradict the file or the contacts do not tell the patch.
pub fn estimate_glide(
    recorded: &GlideReadings,
    options: &GlideOptions,
) -> Result<(GlideEstimate, GlideMap), RecordedError> {
    let unit = agreed_unit(&recorded.file, recorded.unit, options.length_unit)?;
    let refused = |error| refused(recorded, &error);
    let patch = Patch::new(&recorded.contacts, &Vector3::from(options.outward)).map_err(refused)?;
    let method = method(options);
    let fit = method.fit(&patch).map_err(refused)?;
    let centre = fit.centre().map_err(refused)?;
    let points = fit.map(options.grid).map_err(refused)?;
    let (limits, from) = match options.thresholds {
        Some(thresholds) => (thresholds, "given"),
        None => (
            of_size(&fit).ok_or(Ep2Error::OutOfRange).map_err(refused)?,
            "the patch's size: those of the 1996 paper on its patch of 3 x 3, scaled",
        ),
    };
    let regions = regions(options.grid, &points, &limits);
    let value = |value: f64, std: Option<f64>, power: Unit| Value::new(value, std, power, unit);
    let curvature = centre.curvature;
    let stds = curvature.uncertainty;
    let [min_std, max_std] = principal_stds(&curvature);
    let estimate = GlideEstimate {
        method: method.name(),
        contacts: recorded.contacts.len(),
        fingers: recorded.fingers,
        with_normals: patch.has_normals(),
        length_unit: unit.as_str(),
        position: tidy(&centre.position.coords),
        normal: tidy(&centre.normal),
        gaussian_curvature: value(
            curvature.gaussian,
            stds.map(|stds| stds.gaussian_std),
            Unit::PerLengthSquared,
        ),
        mean_curvature: value(
            curvature.mean,
            stds.map(|stds| stds.mean_std),
            Unit::PerLength,
        ),
        k_min: value(centre.k_min, min_std, Unit::PerLength),
        k_max: value(centre.k_max, max_std, Unit::PerLength),
        direction_of_min: tidy(&centre.direction_of_min),
        direction_of_max: tidy(&centre.direction_of_max),
        shape_index: centre.shape_index,
        class: curvature.class(&limits).name(),
        class_probabilities: curvature.class_probabilities(&limits).map(|all| {
            ShapeClass::ALL
                .map(ShapeClass::name)
                .into_iter()
                .zip(all)
                .collect()
        }),
        sign_class: curvature.sign_class().name(),
        thresholds: Thresholds {
            gaussian: value(limits.gaussian(), None, Unit::PerLengthSquared),
            mean: value(limits.mean(), None, Unit::PerLength),
            from,
        },
        noise: fit.noise.map(|noise| PatchNoise {
            position_std: value(noise.position_std, None, Unit::Length),
            normal_std_deg: noise.normal_std_rad.map(f64::to_degrees),
        }),
        effective_unknowns: fit.effective_unknowns,
        grid: options.grid,
        regions: regions
            .regions
            .iter()
            .map(|one| region(one, unit))
            .collect(),
    };
    let map = GlideMap {
        points,
        regions,
        thresholds: limits,
        unit,
    };
    Ok((estimate, map))
}

fn method(options: &GlideOptions) -> PatchMethod {
    let noise = Noise {
        position_std: options.position_std,
        normal_std_rad: options.normal_std_rad,
    };
    match options.method {
        GlideMethod::Penalised => PatchMethod::Penalised(Penalised {
            noise,
            ..Penalised::default()
        }),
        GlideMethod::TwoPass => PatchMethod::TwoPass(TwoPass::default()),
        GlideMethod::Quadric => PatchMethod::Quadric(Quadric { noise }),
    }
}

/// The error with the line of the contact that is at fault, if it is one.
fn refused(recorded: &GlideReadings, error: &Ep2Error) -> RecordedError {
    let contact = match error {
        Ep2Error::NotFinite { contact }
        | Ep2Error::BadWeight { contact, .. }
        | Ep2Error::BadNormal { contact, .. }
        | Ep2Error::MissingNormal { contact }
        | Ep2Error::Folded { contact, .. } => Some(*contact),
        _ => None,
    };
    let (file, message) = (recorded.file.clone(), error.to_string());
    match contact.and_then(|contact| recorded.lines.get(contact)) {
        Some(&line) => RecordedError::Line {
            file,
            line,
            message,
        },
        None => RecordedError::Readings { file, message },
    }
}

/// The thresholds of the 1996 paper, 0.005 and 0.03 on a patch of 3 × 3, scaled to this patch by
/// the mean of its sides. `None` where they leave the range of doubles.
fn of_size(fit: &Fit) -> Option<ShapeThresholds> {
    let [u, v] = fit
        .domain
        .map(|[low, high]| (high - low) * fit.frame.scale());
    let paper_units = 3.0 / (0.5 * u + 0.5 * v);
    ShapeThresholds::new(0.005 * paper_units * paper_units, 0.03 * paper_units).ok()
}

/// Standard deviations of the principal curvatures H ∓ √(H² − K), to first order; `None` where the
/// two cannot be told apart, and where the method states no uncertainty.
fn principal_stds(curvature: &Curvature) -> [Option<f64>; 2] {
    let Some(uncertainty) = curvature.uncertainty else {
        return [None; 2];
    };
    let Uncertainty {
        gaussian_std,
        mean_std,
        correlation,
    } = uncertainty;
    let variance = |by_gaussian: f64, by_mean: f64| {
        let (gaussian, mean) = (by_gaussian * gaussian_std, by_mean * mean_std);
        (gaussian * gaussian + 2.0 * correlation * gaussian * mean + mean * mean).max(0.0)
    };
    let mean = curvature.mean;
    let square = mean * mean - curvature.gaussian;
    if square <= 2.0 * variance(-1.0, 2.0 * mean).sqrt() || square <= 0.0 {
        return [None; 2];
    }
    let half = square.sqrt();
    [-1.0, 1.0].map(|sign| {
        let std = variance(-0.5 * sign / half, 1.0 + sign * mean / half).sqrt();
        std.is_finite().then_some(std)
    })
}

fn region(region: &Region, unit: LengthUnit) -> PatchRegion {
    let value = |value: f64, power: Unit| Value::new(value, None, power, unit);
    PatchRegion {
        class: region.class.name(),
        points: region.points,
        area: value(region.area, Unit::LengthSquared),
        gaussian_curvature: value(region.gaussian_curvature, Unit::PerLengthSquared),
        mean_curvature: value(region.mean_curvature, Unit::PerLength),
        direction_of_max: region.direction_of_max.as_ref().map(tidy),
        coherence: region.coherence,
    }
}

/// Zero without a sign.
fn tidy(vector: &Vector3<f64>) -> [f64; 3] {
    [vector.x, vector.y, vector.z].map(|number| number + 0.0)
}
