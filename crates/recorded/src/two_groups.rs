//! Warns about contacts of two objects in one log, and about objects with edges.
//!
//! The contacts are split into two groups along lines, by their order and by their fingers. A search then improves each
//! split. The two groups are two objects if two simple surfaces fit them clearly better than one smooth surface.

use std::f64::consts::PI;

use nalgebra::{DVector, SMatrix, SVector, Vector3};
use palpate_ep2::{Contact, Method, Patch, Penalised, Sample};
use palpate_statistics::evenly_spaced;
use palpate_study::Warning;

/// Largest number of contacts with which two groups are compared.
const MAX_CONTACTS: usize = 300;
/// Largest assumed correlation of successive distances.
const MAX_CORRELATION: f64 = 0.95;
/// Smaller distances of contacts from a surface, as a share of half the side of the patch, are not compared. They may be
/// the error of the estimated surface.
const MIN_NOISE: f64 = 1e-3;
/// Groups count as two surfaces only if the logarithm of the likelihood ratio of two surfaces to one surface exceeds
/// this value. It is large because many splits are tried.
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
/// The contacts are sorted along `LINES` directions, by their order and by their fingers. This is the largest number of
/// searches that start from splits of each of these sequences.
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

/// Whether a surface is a smooth graph (one height per place). `gradients` are its gradients at the contacts.
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
