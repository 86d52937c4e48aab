//! Warnings about logs: contacts that were left out or are not independent, and sizes that the contacts do not
//! determine.

use std::f64::consts::PI;

use nalgebra::{DVector, SMatrix, SVector, Vector3};
use palpate_ep2::{
    Contact, Curvature, EffectiveReadings, Method, Outlier, OutlierReason, Patch, Penalised,
    Sample, Shape, ShapeFit, StrokeCurvature,
};
use palpate_statistics::{NORMAL_95, Number, evenly_spaced};
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

/// Largest number of contacts with which two groups are compared.
const MAX_CONTACTS: usize = 300;
/// Largest assumed correlation of successive distances.
const MAX_CORRELATION: f64 = 0.95;
/// Smaller distances of contacts from a surface, as a share of half the side of the patch, are not compared. They may be
/// the error of the estimated surface.
const MIN_NOISE: f64 = 1e-3;
/// Groups count as two surfaces only if the logarithm of the likelihood ratio of two surfaces and of one surface is at
/// least this value. It is large because many splits are tried.
const MIN_LOG_RATIO: f64 = 20.0;
/// Two surfaces must fit about as closely as the penalised spline: this is the largest ratio of the standard deviations
/// of the distances.
const MAX_RATIO: f64 = 1.05;
/// Largest degree of the polynomials that are compared with two surfaces.
const MAX_DEGREE: i32 = 7;
/// Polynomials are compared with two surfaces if their number of terms is at most this share of the number of contacts.
const MAX_TERMS: f64 = 0.6;
/// Smallest number of independent contacts with which two groups are compared.
const MIN_INDEPENDENT: f64 = 26.0;
/// Smallest number of contacts in a group.
const MIN_GROUP: usize = 9;
/// Number of directions along which the contacts are sorted and then split into two groups.
const LINES: usize = 16;
/// Largest number of splits from which a search for two groups starts, for each way of sorting. The contacts are sorted
/// along `LINES` directions, by their order, and by their fingers.
const CUTS: usize = 6;
/// Largest number of steps of a search.
const STEPS: usize = 5;
/// Coefficients of the terms of an implicit quadric in [`products`]: the terms add up to the height of the surface.
type Surface = SVector<f64, 9>;
type Products = SMatrix<f64, 10, 10>;
/// Surfaces with `N` unknowns: their coefficients are the product of this matrix and of the unknowns.
type Family<const N: usize> = SMatrix<f64, 9, N>;
/// Index of the constant term in [`products`].
const CONSTANT: usize = 3;
/// Index of the height in [`products`].
const HEIGHT: usize = 9;
/// An implicit quadric counts as one smooth graph if the upward component of its gradient, divided by the largest
/// gradient at a contact, exceeds this value at all contacts. Two planes are a quadric too, but at their edge the
/// gradient is 0, and on parallel planes it has two directions.
const MIN_GRADIENT: f64 = 0.3;
/// A term is left out of a fit if the earlier terms almost reproduce it: if the sum of squares of the rest is at most
/// this share of the term's sum of squares.
const RANK_TOLERANCE: f64 = 1e-9;

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

/// Warning if the contacts form two groups, and two planes, spheres or quadrics fit them clearly better than polynomials,
/// an implicit quadric and a penalised spline. `normal` is a normal of the estimated surface. `distinct` is the number of
/// contacts without copies.
pub(super) fn two_groups(
    contacts: &[Contact],
    normal: &Vector3<f64>,
    distinct: usize,
) -> Option<Warning> {
    let selection = evenly_spaced(contacts.len(), MAX_CONTACTS);
    let contacts: Vec<Contact> = selection.map(|contact| contacts[contact]).collect();
    let patch = Patch::new(&contacts, normal).ok()?;
    let terms: Vec<Products> = patch.samples.iter().map(products).collect();
    let (of_split, distances, unknowns) = best_split(&contacts, &patch.samples, &terms)?;
    let square: f64 = distances.iter().map(|one| one * one).sum();
    let count = contacts.len() as f64;
    // Surfaces follow correlated noise better than independent noise. Therefore count the independent distances, whose
    // number follows from the correlation of successive distances.
    let mut order: Vec<usize> = (0..contacts.len()).collect();
    order.sort_by_key(|&contact| contacts[contact].finger);
    let pairs = order.windows(2).map(|pair| [pair[0], pair[1]]);
    let pairs = pairs.filter(|pair| contacts[pair[0]].finger == contacts[pair[1]].finger);
    let products = pairs.map(|pair| distances[pair[0]] * distances[pair[1]]);
    let correlation = (products.sum::<f64>() / square).clamp(0.0, MAX_CORRELATION);
    let share = ((1.0 - correlation) / (1.0 + correlation)).min(distinct as f64 / count);
    // Two planes are more plausible than a polynomial of a higher degree that bends only between them.
    let degree = if unknowns == 3 { 2 } else { MAX_DEGREE };
    let of_one = of_polynomials(&patch.samples, degree).min(of_implicit_quadric(&terms));
    let log_ratio = |of_one: f64| 0.5 * share * (of_one - of_split);
    if share * count <= MIN_INDEPENDENT || log_ratio(of_one) <= MIN_LOG_RATIO {
        return None;
    }
    let fit = Penalised::default().fit(&patch).ok()?;
    let noise = fit.noise?.position_std / patch.frame.scale();
    // Heights determine a third of the effective degrees of freedom if there are normals, otherwise all.
    let unknowns = fit.effective_unknowns * count / patch.equations() as f64;
    let of_fit = information(noise * noise * (count - unknowns).max(0.0), count, unknowns);
    let log_ratio = log_ratio(of_one.min(of_fit));
    let is_close = square / (count - 14.0) < (MAX_RATIO * noise).powi(2);
    (is_close && log_ratio > MIN_LOG_RATIO).then(|| {
        let text = "two separate surfaces fit the contacts better than one surface: do they belong to two objects, or does the object have an edge or another feature that the estimated surface does not follow?";
        Warning::new("two-groups", text, [("log_ratio", log_ratio)])
    })
}

/// Bayesian information criterion of a surface with `unknowns` parameters, apart from constants: `square` is the sum of
/// the squares of `number` distances from it, in the unit of the patch.
fn information(square: f64, number: f64, unknowns: f64) -> f64 {
    number * libm::log(square / number + MIN_NOISE * MIN_NOISE) + unknowns * libm::log(number)
}

/// Information criterion of the implicit quadric that fits all contacts best; infinite if it is not a smooth graph.
fn of_implicit_quadric(terms: &[Products]) -> f64 {
    let found = surface(&terms.iter().sum(), &Family::<9>::identity());
    let offsets = |(surface, _)| terms.iter().map(|one| offset(&surface, one)).collect();
    let offsets: Vec<_> = found.map(offsets).unwrap_or_default();
    let square = offsets.iter().map(|(distance, _)| distance * distance);
    match is_graph(offsets.iter().map(|(_, gradient)| gradient)) {
        true => information(square.sum(), terms.len() as f64, 9.0),
        false => f64::INFINITY,
    }
}

/// Whether a surface is a smooth graph. `gradients` are those at the contacts.
fn is_graph<'a>(gradients: impl Iterator<Item = &'a Vector3<f64>> + Clone) -> bool {
    let largest = gradients.clone().map(Vector3::norm).fold(0.0, f64::max);
    let least = gradients
        .map(|gradient| gradient.z)
        .fold(f64::INFINITY, f64::min);
    least > MIN_GRADIENT * largest && least.is_finite()
}

/// Smallest information criterion of polynomials of u and v, of at most the degree `largest`.
fn of_polynomials(samples: &[Sample], largest: i32) -> f64 {
    let column = |of: &dyn Fn(&Sample) -> f64| -> DVector<f64> {
        DVector::from_iterator(samples.len(), samples.iter().map(of))
    };
    let (mut left, number) = (column(&|one| one.w), samples.len() as f64);
    let (mut basis, mut best) = (Vec::<DVector<f64>>::new(), f64::INFINITY);
    for degree in 0..=largest {
        for power in 0..=degree {
            let mut term = column(&|one| one.u.powi(power) * one.v.powi(degree - power));
            let norm = term.norm();
            for other in &basis {
                term.axpy(-other.dot(&term), other, 1.0);
            }
            if let Some(term) = term.try_normalize(RANK_TOLERANCE.sqrt() * norm) {
                left.axpy(-term.dot(&left), &term, 1.0);
                basis.push(term);
            }
        }
        let unknowns = basis.len() as f64;
        if unknowns <= MAX_TERMS * number {
            best = best.min(information(left.norm_squared(), number, unknowns));
        }
    }
    best
}

/// Two groups of contacts, each on its own surface: the information criterion, the distances of the contacts from these
/// surfaces, and the number of unknowns of a surface.
type Split = (f64, Vec<f64>, usize);

/// The two groups with the smallest information criterion. Planes, spheres, quadrics, and quadrics with a term w² are
/// tried. `terms` contains the products of all contacts.
fn best_split(contacts: &[Contact], samples: &[Sample], terms: &[Products]) -> Option<Split> {
    let (count, total) = (terms.len(), terms.iter().sum());
    let mut spheres: Family<4> = graphs(2);
    (spheres[(6, 0)], spheres[(8, 0)]) = (1.0, 1.0);
    let quadrics: Family<6> = graphs(3);
    let mut best = None;
    let mut search_all = |start: &(Vec<bool>, Products)| {
        for sign in [1.0, -1.0] {
            search::<3>(&mut best, start.clone(), sign, &graphs(3), &total, terms);
            search(&mut best, start.clone(), sign, &spheres, &total, terms);
            search(&mut best, start.clone(), sign, &quadrics, &total, terms);
            search::<7>(&mut best, start.clone(), sign, &graphs(2), &total, terms);
        }
    };
    let lines = (0..LINES).map(|line| libm::sincos(PI * line as f64 / LINES as f64));
    let along = |(sin, cos)| {
        let keys = samples.iter().map(|one| one.u * cos + one.v * sin);
        keys.collect()
    };
    let mut keys: Vec<Vec<f64>> = lines.map(along).collect();
    keys.push((0..count).map(|row| row as f64).collect());
    keys.push(contacts.iter().map(|one| one.finger as f64).collect());
    for keys in &keys {
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|one, other| keys[*one].total_cmp(&keys[*other]));
        let (mut start, mut last) = ((vec![false; count], Products::zeros()), 0);
        let mut least = (f64::INFINITY, start.clone());
        for (cut, pair) in (1..).zip(order.windows(2)) {
            start.0[pair[0]] = true;
            start.1 += terms[pair[0]];
            if keys[pair[0]] == keys[pair[1]] || cut.min(count - cut) < MIN_GROUP {
                continue;
            }
            let groups = [start.1, total - start.1].map(|sum| surface(&sum, &quadrics));
            if let [Some((_, one)), Some((_, other))] = groups
                && one + other < least.0
            {
                least = (one + other, start.clone());
            }
            if cut * CUTS / count > last {
                last = cut * CUTS / count;
                search_all(&start);
            }
        }
        search_all(&least.1);
    }
    best
}

/// Searches for two groups of contacts, each on its own surface from `family`, from the groups `is_first` with the sum
/// of products `sum`. In each step, the contacts where the surface of the first group is higher become the first group
/// (lower if `sign` is −1). If the information criterion is smaller than that of `best`, the groups become the new
/// `best`. `terms` contains the products of all contacts, and `total` their sum.
fn search<const N: usize>(
    best: &mut Option<Split>,
    (mut is_first, mut sum): (Vec<bool>, Products),
    sign: f64,
    family: &Family<N>,
    total: &Products,
    terms: &[Products],
) {
    let (count, mut last) = (terms.len(), f64::INFINITY);
    for _ in 0..STEPS {
        let first = is_first.iter().filter(|one| **one).count();
        let is_large = first.min(count - first) >= MIN_GROUP;
        let surfaces = surface(&sum, family).zip(surface(&(total - sum), family));
        let Some(((one, _), (other, _))) = surfaces.filter(|_| is_large) else {
            return;
        };
        let both = |products| [offset(&one, products), offset(&other, products)];
        let both: Vec<_> = terms.iter().map(both).collect();
        let own = both.iter().zip(&is_first);
        let own = own.map(|(both, is_first)| both[usize::from(!is_first)]);
        let (distances, gradients): (Vec<f64>, Vec<Vector3<f64>>) = own.unzip();
        let square = distances.iter().map(|one| one * one).sum();
        // The line that separates the groups has two parameters.
        let information = information(square, count as f64, (2 * N + 2) as f64);
        if information >= last || !is_graph(gradients.iter()) {
            return;
        }
        last = information;
        if best.as_ref().is_none_or(|best| information < best.0) {
            *best = Some((information, distances, N));
        }
        for ((is_first, both), one) in is_first.iter_mut().zip(&both).zip(terms) {
            let is_next = sign * (both[1].0 - both[0].0) > 0.0;
            if is_next != *is_first {
                sum += if is_next { *one } else { -*one };
                *is_first = is_next;
            }
        }
    }
}

/// Surfaces whose unknowns are the coefficients of `N` terms, from the term with the index `first`.
fn graphs<const N: usize>(first: usize) -> Family<N> {
    Family::from_fn(|row, column| f64::from(u8::from(row == first + column)))
}

/// The surface from `family` that fits best, and the sum of the squares of the heights less the surface's terms. `sums`
/// contains the sums of the contacts' products.
fn surface<const N: usize>(sums: &Products, family: &Family<N>) -> Option<(Surface, f64)> {
    let mut gram = family.tr_mul(&(sums.fixed_view::<9, 9>(0, 0) * family));
    let least = RANK_TOLERANCE * gram.trace();
    (0..N).for_each(|term| gram[(term, term)] += least);
    let right = family.tr_mul(&sums.fixed_view::<9, 1>(0, HEIGHT));
    let found = gram.cholesky()?.solve(&right);
    Some((family * found, sums[(HEIGHT, HEIGHT)] - found.dot(&right)))
}

/// Distance of a contact above a surface, to first order, and the gradient of the height less the surface's terms.
/// `products` are the products of the contact.
fn offset(surface: &Surface, products: &Products) -> (f64, Vector3<f64>) {
    let terms = products.fixed_view::<9, 1>(0, CONSTANT);
    let (u, v, w) = (terms[4], terms[5], products[(HEIGHT, CONSTANT)]);
    let [uw, vw, ww, _, by_u, by_v, uu, uv, vv] = surface.data.0[0];
    let gradient = Vector3::new(
        -uw * w - by_u - 2.0 * uu * u - uv * v,
        -vw * w - by_v - 2.0 * vv * v - uv * u,
        1.0 - uw * u - vw * v - 2.0 * ww * w,
    );
    ((w - surface.dot(&terms)) / gradient.norm(), gradient)
}

/// Products of the terms of an implicit quadric at a contact, and of its height, which is the last term.
fn products(sample: &Sample) -> Products {
    let Sample { u, v, w, .. } = *sample;
    let terms = SVector::from([u * w, v * w, w * w, 1.0, u, v, u * u, u * v, v * v, w]);
    terms * terms.transpose()
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
