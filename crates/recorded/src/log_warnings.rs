//! Warnings about logs: contacts that were left out or are not independent, and sizes that the contacts do not
//! determine.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{SMatrix, SVector, Vector3};
use palpate_ep2::{
    Contact, Curvature, EffectiveReadings, Outlier, OutlierReason, Patch, Sample, Shape, ShapeFit,
    StrokeCurvature,
};
use palpate_statistics::{NORMAL_95, Number, evenly_spaced, ratio_tail};
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

/// Smallest gap between two groups of contacts, as a share of the range of all contacts. A gap that is much larger than
/// the next largest gap may be smaller than this.
const MIN_GAP: f64 = 0.15;
/// A gap that is at least this many times as large as the next largest gap counts even if it is smaller than `MIN_GAP`.
const MIN_CLEAR_GAPS_RATIO: f64 = 3.0;
/// Smallest ratio of the gap between two groups of contacts to the next largest gap. In a log of strokes, the next
/// largest gap may be the distance between two strokes.
const MIN_GAPS_RATIO: f64 = 1.3;
/// Largest number of contacts with which two groups are compared.
const MAX_CONTACTS: usize = 300;
/// Two groups of contacts count as two objects only if the mean square distance of the contacts from a common surface
/// exceeds that from separate surfaces by this share of the mean square distance of a group from its own plane.
const MIN_EXCESS: f64 = 0.02;
/// Two groups of contacts count as two objects only if the p-value of a common surface is below this value. The limit is
/// small, because surfaces that are no polynomials fit a common polynomial worse than two polynomials.
const MAX_P_VALUE: f64 = 1e-4;
/// Largest assumed correlation of successive residuals.
const MAX_CORRELATION: f64 = 0.95;
/// Groups without a gap are tested only if the noise is at least this share of half the side of the patch. Smaller
/// residuals may be the error of the estimated surface.
const MIN_NOISE: f64 = 1e-3;
/// Groups without a gap count as two surfaces only if separate quadrics fit better than the estimated surface by this
/// ratio of standard deviations. Smaller ratios may come from the error of the estimated noise.
const MIN_QUADRICS_RATIO: f64 = 1.2;
/// Groups without a gap count as two surfaces only if the logarithm of the likelihood ratio of two quadrics and the
/// estimated surface is at least this value. It is large because many splits are tried.
const MIN_LOG_RATIO: f64 = 30.0;
/// Number of parameters of two quadrics and of the line that separates them.
const TWO_QUADRICS: f64 = 14.0;
/// Smallest number of independent contacts, less the parameters of two quadrics.
const MIN_FREEDOM: f64 = 12.0;
/// Smallest number of contacts in a group that is fitted by a quadric.
const MIN_GROUP: usize = 9;
/// Number of directions along which the contacts are sorted and then split into two groups.
const LINES: usize = 8;
/// Largest number of splits from which a search for two groups starts, for each way of sorting. The contacts are sorted
/// along `LINES` directions, by their order, and by their fingers.
const CUTS: usize = 20;
/// Largest number of steps of a search.
const STEPS: usize = 5;
/// A group of contacts counts as flat if the p-value of a plane through it is above this value.
const MIN_FLAT_P_VALUE: f64 = 0.01;
/// Terms of polynomials, as ranges of the terms in [`residual`].
const IMPLICIT_QUADRIC: Range<usize> = 0..9;
const PLANE: Range<usize> = 3..6;
const QUADRIC: Range<usize> = 3..9;
const QUADRIC_TERMS: usize = 6;
const CONSTANT: usize = 3;
const CUBIC: Range<usize> = 3..13;
/// Index of the height after the terms of polynomials.
const HEIGHT: usize = 13;
type Quadric = SVector<f64, QUADRIC_TERMS>;
type Products = SMatrix<f64, { HEIGHT + 1 }, { HEIGHT + 1 }>;
/// A term is left out of a fit if the earlier terms almost reproduce it: if the sum of squares of the rest is at most
/// this share of the term's sum of squares.
const RANK_TOLERANCE: f64 = 1e-9;
/// Smaller sums of squared residuals, in the unit of the patch, are rounding errors.
const MIN_RESIDUAL: f64 = 1e-12;

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

/// Warning if the contacts form two groups that do not lie on one simple surface. The groups may be separated by a wide
/// gap along a line. Without a gap, two groups count as two surfaces if two quadrics fit them clearly better than
/// the estimated surface. `normal` is a normal of this surface. `distinct` is the number of contacts without copies, and
/// `noise` the standard deviation of the contacts about the estimated surface.
pub(super) fn two_groups(
    contacts: &[Contact],
    normal: &Vector3<f64>,
    distinct: usize,
    noise: Option<f64>,
    unit: LengthUnit,
) -> Option<Warning> {
    let selection = evenly_spaced(contacts.len(), MAX_CONTACTS);
    let contacts: Vec<Contact> = selection.map(|contact| contacts[contact]).collect();
    let patch = Patch::new(&contacts, normal).ok()?;
    let (samples, count) = (&patch.samples, contacts.len());
    let terms: Vec<Products> = samples.iter().map(products).collect();
    let total: Products = terms.iter().sum();
    // The contacts are split along lines, by their order, and by their fingers.
    let lines = (0..LINES).map(|line| libm::sincos(PI * line as f64 / LINES as f64));
    let along = |(sin, cos)| {
        samples
            .iter()
            .map(|one| one.u * cos + one.v * sin)
            .collect()
    };
    let mut keys: Vec<Vec<f64>> = lines.map(along).collect();
    keys.push((0..count).map(|row| row as f64).collect());
    keys.push(contacts.iter().map(|one| one.finger as f64).collect());
    let mut widest = 0.0_f64;
    let mut best = (f64::INFINITY, Vec::new());
    for (line, keys) in keys.iter().enumerate() {
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|one, other| keys[*one].total_cmp(&keys[*other]));
        let gaps = order.windows(2).map(|pair| keys[pair[1]] - keys[pair[0]]);
        let gaps: Vec<f64> = gaps.collect();
        let range: f64 = gaps.iter().sum();
        let mut sorted = gaps.clone();
        sorted.sort_unstable_by(|one, other| other.total_cmp(one));
        let next = sorted.get(1).copied().unwrap_or(0.0);
        let least_gap = (MIN_GAP * range).min(MIN_CLEAR_GAPS_RATIO * next);
        let least_gap = least_gap.max(MIN_GAPS_RATIO * next);
        let (mut is_first, mut sum, mut last) = (vec![false; count], Products::zeros(), 0);
        for (cut, gap) in (1..).zip(gaps) {
            is_first[order[cut - 1]] = true;
            sum += terms[order[cut - 1]];
            let groups = [(sum, cut), (total - sum, count - cut)];
            if line < LINES && gap > least_gap && are_two_surfaces(&total, groups, distinct) {
                widest = widest.max(gap);
            }
            if cut * CUTS / count > last && gap > 0.0 {
                last = cut * CUTS / count;
                for sign in [1.0, -1.0] {
                    search(&mut best, is_first.clone(), sum, &total, &terms, sign);
                }
            }
        }
    }
    let scale = patch.frame.scale();
    if widest > 0.0 {
        let (gap, unit) = (Number::rounded(scale * widest), unit.as_str());
        let text = format!(
            "the contacts form two groups that are {gap} {unit} apart, and no simple surface fits both: do they belong to two objects?"
        );
        return Some(Warning::new(
            "two-groups",
            text,
            [("distance", scale * widest)],
        ));
    }
    let (noise, (square, residuals)) = (noise? / scale, best);
    // Quadrics follow correlated noise better than independent noise. Therefore count the independent residuals, whose
    // number follows from the correlation of successive residuals.
    let mut order: Vec<usize> = (0..residuals.len()).collect();
    order.sort_by_key(|&contact| contacts[contact].finger);
    let pairs = order.windows(2).map(|pair| [pair[0], pair[1]]);
    let pairs = pairs.filter(|pair| contacts[pair[0]].finger == contacts[pair[1]].finger);
    let products = pairs.map(|pair| residuals[pair[0]] * residuals[pair[1]]);
    let correlation = (products.sum::<f64>() / square).clamp(0.0, MAX_CORRELATION);
    let independent = count as f64 * (1.0 - correlation) / (1.0 + correlation);
    let ratio = noise / (square / (count as f64 - TWO_QUADRICS)).sqrt();
    let freedom = independent - TWO_QUADRICS;
    let is_clear = noise > MIN_NOISE && ratio > MIN_QUADRICS_RATIO && ratio.is_finite();
    (is_clear && freedom > MIN_FREEDOM && freedom * libm::log(ratio) > MIN_LOG_RATIO).then(|| {
        let text = format!(
            "the contacts scatter {} times as much about the estimated surface as about two separate surfaces: do they belong to two objects, or does the object have an edge or another feature that the estimated surface does not follow?",
            Number::rounded(ratio)
        );
        Warning::new("two-groups", text, [("ratio", ratio)])
    })
}

/// Searches for two groups of contacts, each on its own quadric, from the groups `is_first`. In each step, the contacts
/// where the quadric of the first group is higher become the first group (lower if `sign` is −1). If a sum of squared
/// residuals is smaller than that of `best`, it and the residuals become the new `best`. `terms` contains the
/// products of all contacts, `total` their sum, and `sum` the sum for the first group.
fn search(
    best: &mut (f64, Vec<f64>),
    mut is_first: Vec<bool>,
    mut sum: Products,
    total: &Products,
    terms: &[Products],
    sign: f64,
) {
    for _ in 0..STEPS {
        let first = is_first.iter().filter(|one| **one).count();
        let is_large = first.min(terms.len() - first) >= MIN_GROUP;
        let quadrics = quadric(&sum).zip(quadric(&(total - sum)));
        let Some((one, other)) = quadrics.filter(|_| is_large) else {
            return;
        };
        let residuals = |products: &Products| {
            let terms = products.fixed_view::<QUADRIC_TERMS, 1>(QUADRIC.start, CONSTANT);
            [&one, &other].map(|quadric| products[(HEIGHT, CONSTANT)] - quadric.dot(&terms))
        };
        let residuals: Vec<[f64; 2]> = terms.iter().map(residuals).collect();
        let own = residuals.iter().zip(&is_first);
        let own = own.map(|(both, is_first)| both[usize::from(!is_first)]);
        let square = own.clone().map(|one| one * one).sum::<f64>();
        if square < best.0 {
            *best = (square, own.collect());
        }
        let mut is_steady = true;
        for ((is_first, both), one) in is_first.iter_mut().zip(&residuals).zip(terms) {
            let is_next = sign * (both[1] - both[0]) > 0.0;
            if is_next != *is_first {
                sum += if is_next { *one } else { -*one };
                (*is_first, is_steady) = (is_next, false);
            }
        }
        if is_steady {
            return;
        }
    }
}

/// Coefficients of the quadric that fits best. `sums` contains the sums of the contacts' products.
fn quadric(sums: &Products) -> Option<Quadric> {
    let mut gram = sums
        .fixed_view::<QUADRIC_TERMS, QUADRIC_TERMS>(QUADRIC.start, QUADRIC.start)
        .into_owned();
    let least = RANK_TOLERANCE * gram.trace();
    (0..QUADRIC_TERMS).for_each(|term| gram[(term, term)] += least);
    let right = sums.fixed_view::<QUADRIC_TERMS, 1>(QUADRIC.start, HEIGHT);
    Some(gram.cholesky()?.solve(&right))
}

/// Whether separate quadrics through two groups of contacts fit clearly better than one surface through both groups:
/// a cubic, or an implicit quadric such as an ellipsoid. These surfaces also follow two planes. So if both groups are
/// flat, the common surface is a quadric. For each group, `groups` contains the sums of products and the number of
/// contacts.
fn are_two_surfaces(all: &Products, groups: [(Products, usize); 2], distinct: usize) -> bool {
    let count = groups[0].1 + groups[1].1;
    let [planes, quadrics] =
        [PLANE, QUADRIC].map(|terms| groups.map(|(sums, _)| residual(&sums, terms.clone())));
    let are_flat = (0..2).all(|group| {
        let freedom = groups[group].1.saturating_sub(QUADRIC.len());
        let excess = planes[group] - quadrics[group];
        excess <= MIN_RESIDUAL || ratio_tail(excess, 3, quadrics[group], freedom) > MIN_FLAT_P_VALUE
    });
    let (together, saved) = match are_flat {
        true => (residual(all, QUADRIC), QUADRIC.len()),
        false => (residual(all, CUBIC).min(residual(all, IMPLICIT_QUADRIC)), 3),
    };
    let excess = together - quadrics[0] - quadrics[1];
    let bends = [0, 1].map(|group| planes[group] / groups[group].1 as f64);
    let freedom = count.min(distinct).saturating_sub(2 * QUADRIC.len());
    excess > MIN_EXCESS * bends[0].max(bends[1]) * count as f64
        && excess > MIN_RESIDUAL
        && ratio_tail(excess, saved, quadrics[0] + quadrics[1], freedom) < MAX_P_VALUE
}

/// Products of the terms of polynomials at a contact, and of its height, which is the last term.
fn products(sample: &Sample) -> Products {
    let Sample { u, v, w, .. } = *sample;
    let [uu, vv] = [u * u, v * v];
    let implicit = [w * w, u * w, v * w, 1.0, u, v, uu, u * v, vv];
    let cubic = [uu * u, uu * v, u * vv, vv * v, w];
    let terms = implicit.into_iter().chain(cubic);
    let terms = SVector::<f64, { HEIGHT + 1 }>::from_iterator(terms);
    terms * terms.transpose()
}

/// Sum of the squared residuals of heights after a least-squares fit of the polynomial whose terms are `terms`. `sums`
/// contains the sums of the contacts' products.
fn residual(sums: &Products, terms: Range<usize>) -> f64 {
    let mut left = *sums;
    for term in terms.clone() {
        let pivot = left[(term, term)];
        let later = || (term + 1..terms.end).chain([HEIGHT]);
        for row in later().filter(|_| pivot > RANK_TOLERANCE * sums[(term, term)]) {
            let share = left[(row, term)] / pivot;
            for column in later().take_while(|&column| column <= row) {
                left[(row, column)] -= share * left[(column, term)];
            }
        }
    }
    left[(HEIGHT, HEIGHT)].max(0.0)
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
