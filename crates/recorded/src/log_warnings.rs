//! Warnings about logs: contacts that were left out or are not independent, and sizes that the contacts do not
//! determine.

use nalgebra::Vector3;
use palpate_ep2::{
    Contact, Curvature, EffectiveReadings, Outlier, OutlierReason, Shape, ShapeFit, StrokeCurvature,
};
use palpate_statistics::{NORMAL_95, Number};
use palpate_study::Warning;
use palpate_study::config::LengthUnit;

use super::glide_recording::GlideRecording;
use super::shape_report::is_undetermined;

pub(super) const LISTED_ROWS: usize = 10;
/// If the noise is correlated, several consecutive contacts count as one independent contact. A warning is shown if
/// their number exceeds this value.
const MIN_CORRELATION: f64 = 1.5;
const MIN_PROBABILITY: f64 = 0.9;
/// If the p-value of the fit of a stated shape is below this value, there is a warning.
const MIN_P_VALUE: f64 = 0.005;
/// The distances of contacts from a shape are comparable with their extent if the ratio of the root mean squares of both
/// exceeds this value.
const MAX_RELATIVE_MISFIT: f64 = 0.2;
/// The normals of contacts contradict a shape if the mean cosine of their angles to the normals of the shape is below
/// this value.
const MIN_MEAN_COSINE: f64 = 0.93;

/// Text that lists the rows `rows`; if there are many, only the first of them.
pub(super) fn listed(rows: impl ExactSizeIterator<Item = String>) -> String {
    let more = rows.len().saturating_sub(LISTED_ROWS);
    let mut listed: Vec<String> = rows.take(LISTED_ROWS).collect();
    listed.extend((more > 0).then(|| format!("and {more} more")));
    listed.join("; ")
}

pub(super) fn left_out(outliers: &[Outlier], recorded: &GlideRecording) -> Option<Warning> {
    let (count, contacts) = (outliers.len(), recorded.contacts.len());
    let row = |outlier: &Outlier| {
        let row = recorded.source.row(outlier.contact);
        match outlier.reason {
            OutlierReason::Sentinel => {
                // To show the number that the sensor wrote for a lost reading, print the coordinate that differs most
                // from that of a contact that is not left out.
                let sound =
                    (0..contacts).find(|one| outliers.iter().all(|out| out.contact != *one));
                let sound = recorded.contacts[sound.unwrap_or(0)].position;
                let own = recorded.contacts[outlier.contact].position;
                format!(
                    "{row} (lost reading, {})",
                    Number(own[(own - sound).iamax()])
                )
            }
            OutlierReason::Zeros => format!("{row} (lost reading, zeros)"),
            OutlierReason::Far => format!("{row} (far from all others)"),
            OutlierReason::Misfit => format!("{row} (misfit)"),
        }
    };
    (count > 0).then(|| {
        let rows = listed(outliers.iter().map(row));
        let text = format!("{count} of {contacts} contacts are left out: {rows}");
        let numbers = [("left_out", count as f64), ("contacts", contacts as f64)];
        Warning::new("left-out", text, numbers)
    })
}

/// Warning that the estimated curvature depends on an assumption, because the contacts have no normals. There are three
/// cases: a fitted shape is assumed to be convex; the estimate is concave if the outer side faces the default outward
/// direction, as assumed; or a single stroke was recorded, and its curvature depends on the assumed outer side. `None`
/// if the curvature depends on no assumption.
pub(super) fn assumed_side(
    surface: Option<&ShapeFit>,
    stroke: Option<&StrokeCurvature>,
    curvature: &Curvature,
    outward: Option<[f64; 3]>,
) -> Option<Warning> {
    let std = curvature.uncertainty.map_or(0.0, |one| one.mean_std);
    let text = if let Some(stroke) = stroke {
        if stroke.std.is_some() {
            return None;
        }
        "the contacts are of one stroke without normals, and its outer side is assumed to face +z: the interval of the curvature along the stroke is valid for any outer side within 90 degrees of +z; record normals, or state setting `outward`"
    } else if surface.is_some_and(|fit| fit.is_side_assumed) && outward.is_some() {
        "setting `outward` does not show which side of the object is outside, because it is nearly parallel to the surface, or because the contacts are all around the object; the object is assumed to be convex"
    } else if surface.is_some_and(|fit| fit.is_side_assumed) {
        "the contacts have no normals and do not show which side of the object is outside, so it is assumed to be convex: record normals, or state setting `outward` if all contacts are on one side"
    } else if outward.is_none() && curvature.mean + NORMAL_95 * std < 0.0 {
        "the object is concave if its outer side faces +z, which is assumed because the contacts have no normals: if it was touched from below, state setting `outward` as 0,0,-1"
    } else {
        return None;
    };
    let numbers = match stroke {
        Some(stroke) => ("curvature_along", stroke.value),
        None => ("mean_curvature", curvature.mean),
    };
    Some(Warning::new("assumed-side", text, [numbers]))
}

pub(super) fn correlated(readings: &EffectiveReadings, has_normals: bool) -> Option<Warning> {
    let [position, normal] = [readings.position_correlation, readings.normal_correlation];
    (position.max(normal) > MIN_CORRELATION).then(|| {
        let [shown, tilts] = [position, normal].map(Number::rounded);
        let of_normals = match has_normals {
            true => format!(", and {tilts} normals"),
            false => String::new(),
        };
        let text = format!(
            "the noise is correlated along the strokes: {shown} consecutive positions count as one{of_normals}"
        );
        let numbers = [("positions", position), ("normals", normal)];
        Warning::new("correlated-noise", text, numbers)
    })
}

/// Warning that all contacts are on a single stroke, and that a stroke does not determine the curvature across it.
pub(super) fn across(stroke: &StrokeCurvature, unit: LengthUnit) -> Warning {
    let [low, high] = stroke.interval95;
    let [value, low, high] = [stroke.value, low, high].map(Number::rounded);
    let text = format!(
        "the contacts are of one stroke: its curvature is {value} 1/{} along it (95 %: {low} to {high}), and is not resolved across it",
        unit.as_str()
    );
    Warning::new("not-resolved-across", text, [])
}

/// Warnings about a fitted shape. A single stroke (`is_stroke`) does not bound the radius of the shape.
pub(super) fn shape_warnings(
    fit: &ShapeFit,
    contacts: &[Contact],
    is_stroke: bool,
    unit: LengthUnit,
) -> Vec<Warning> {
    let (unit, name) = (unit.as_str(), <&str>::from(fit.shape));
    let is_none = fit.is_none_of_these();
    let is_open = is_undetermined(fit) && !is_none;
    let least = fit.radius.interval95[0].filter(|_| !is_stroke);
    let open = is_open.then(|| match least.map(Number::rounded) {
        Some(least) => {
            format!("the contacts do not resolve the radius: it is at least {least} {unit}")
        }
        None => "the contacts do not resolve the radius".to_owned(),
    });
    let misfit = Number::rounded(fit.rms_misfit);
    let none = is_none.then(|| {
        format!("the contacts do not lie on a plane, sphere or cylinder: they deviate from the best fit, a {name}, by {misfit} {unit} (rms); method `penalised` or `quadric` estimates the curvatures")
    });
    let share = fit.probabilities.map(|all| all[fit.shape as usize]);
    // A sphere has one parameter more than a plane. So its chi-squared is smaller even if the object is a plane, in 95
    // % of all logs by at most 3.84. At a difference of 3.84, the criterion that compares shapes gives the plane the
    // probability 1 / (1 + exp(3.84 / 2) / √n), where n is the number of equations. Warn only if the plane's
    // probability is below this value.
    let limit = match fit.shape {
        Shape::Plane => {
            let has_normals = contacts.iter().any(|one| one.normal.is_some());
            let equations = if has_normals { 3.0 } else { 1.0 } * fit.readings.effective();
            MIN_PROBABILITY.min(1.0 / (1.0 + libm::exp(0.5 * 3.84) / equations.sqrt()))
        }
        Shape::Sphere | Shape::Cylinder => MIN_PROBABILITY,
    };
    let is_unsure = share.is_some_and(|share| share < limit) && none.is_none();
    let unsure = is_unsure.then(|| {
        let percent = Number::rounded(100.0 * share.unwrap_or_default());
        format!("the contacts do not determine the shape: it is a {name} with a probability of {percent} %")
    });
    let texts = [
        ("not-resolved", open),
        ("none-of-these", none),
        ("uncertain-shape", unsure),
    ];
    let warning = |(code, text)| Warning::of(code, text);
    let mut warnings: Vec<Warning> = texts.into_iter().filter_map(warning).collect();
    // If the user stated the shape, it was not compared with other shapes. Therefore only its goodness of fit is
    // tested.
    let why = match () {
        () if fit.probabilities.is_some() => return warnings,
        () if !is_undetermined(fit) && fit.rms_misfit > MAX_RELATIVE_MISFIT * spread(contacts) => {
            "which is comparable with the extent of the contacts"
        }
        () if mean_cosine(fit, contacts) < MIN_MEAN_COSINE => "and their normals contradict it",
        () if fit.p_value < MIN_P_VALUE => "which noise does not explain",
        () => return warnings,
    };
    let text = format!(
        "the contacts deviate from the {name} by {misfit} {unit} (rms), {why}: they may be of another shape, and the intervals are not reliable"
    );
    warnings.push(Warning::new("poor-fit", text, [("p_value", fit.p_value)]));
    warnings
}

/// Root mean square distance of the contacts from their mean.
fn spread(contacts: &[Contact]) -> f64 {
    let share = 1.0 / contacts.len() as f64;
    let from = contacts[0].position;
    let offsets = contacts.iter().map(|one| one.position - from);
    let mean: Vector3<f64> = offsets.clone().sum::<Vector3<f64>>() * share;
    let squares = offsets.map(|offset| (offset - mean).norm_squared() * share);
    squares.sum::<f64>().sqrt()
}

/// Mean cosine of the angles between the normals of contacts and those of a shape; 1 without normals.
fn mean_cosine(fit: &ShapeFit, contacts: &[Contact]) -> f64 {
    let cosine = |one: &Contact| match one.normal.and_then(|normal| normal.try_normalize(0.0)) {
        Some(normal) => normal.dot(&fit.point_at(&one.position).normal),
        None => 1.0,
    };
    contacts.iter().map(cosine).sum::<f64>() / contacts.len() as f64
}
