//! Warns about contacts of two objects in one log, and about objects with edges.
//!
//! The contacts are split into two groups along lines, by their order and by their fingers. A search then improves each
//! split. The two groups are two objects if two simple surfaces fit them clearly better than one smooth surface.

use std::f64::consts::PI;

use nalgebra::{DMatrix, RowVector3, SMatrix, SVector, Vector3};
use palpate_ep2::{Contact, Method, NoiseEstimate, Patch, Penalised, Sample};
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
/// Like `LINES`, for the comparison of slopes, which takes longer.
const LINES_OF_SLOPES: usize = 4;
/// The contacts are sorted along `LINES` directions, by their order and by their fingers. This is the largest number of
/// searches that start from splits of each of these sequences.
const CUTS: usize = 6;
/// Largest number of steps of a search.
const STEPS: usize = 5;
/// Coefficients of the terms of an implicit quadric in [`Terms`]: the terms add up to the height of the surface.
type Surface = SVector<f64, 9>;
type Row = SVector<f64, 10>;
type Rows = [Row; 3];
type Products = SMatrix<f64, 10, 10>;
/// Surfaces with `N` unknowns: their coefficients are the product of this matrix and of the unknowns.
type Family<const N: usize> = SMatrix<f64, 9, N>;
/// Indices of u, of v and of the height in [`Terms`].
const U: usize = 4;
const V: usize = 5;
const HEIGHT: usize = 9;
/// An implicit quadric counts as one smooth graph if the upward component of its gradient, divided by the largest
/// gradient at a contact, exceeds this value at all contacts. Two planes are a quadric too, but at their edge the
/// gradient is 0, and on parallel planes it has two directions.
const MIN_GRADIENT: f64 = 0.3;
/// Two groups are separated by a gap if [`Split::gap_ratio`] exceeds this value. No contacts in a gap show
/// how one surface would bend there. So the two surfaces are then compared only with polynomials of a low degree and an
/// implicit quadric.
const MIN_GAP: f64 = 0.5;
/// Largest degrees of these polynomials: first for a gap ratio of at most 1, then for a larger one.
const MAX_DEGREES_ACROSS_GAP: [i32; 2] = [4, 3];
/// A term is left out of a fit if the earlier terms almost reproduce it: if the sum of squares of the rest is at most
/// this share of the term's sum of squares.
const RANK_TOLERANCE: f64 = 1e-9;

/// Warning if the contacts form two groups, and two planes, spheres or quadrics fit them clearly better than polynomials,
/// an implicit quadric and a penalised spline. `normal` is a normal of the estimated surface, and `noise` its noise.
/// `distinct` is the number of contacts without copies.
pub(super) fn two_groups(
    contacts: &[Contact],
    normal: &Vector3<f64>,
    noise: Option<NoiseEstimate>,
    distinct: usize,
) -> Option<Warning> {
    let selection = evenly_spaced(contacts.len(), MAX_CONTACTS);
    let contacts: Vec<Contact> = selection.map(|contact| contacts[contact]).collect();
    let patch = Patch::new(&contacts, normal).ok()?;
    let compare = |ratio, lines| compare(&contacts, &patch, distinct, ratio, lines);
    let mut log_ratio = compare(0.0, LINES)?.0;
    if let Some(noise) = noise.filter(|_| log_ratio <= MIN_LOG_RATIO)
        && let Some(slope) = noise.normal_std_rad
    {
        // One smooth surface may follow the heights of both groups, but not their slopes. Its noise may differ from that
        // of two surfaces.
        let ratio = noise.position_std / (patch.frame.scale() * slope);
        let (_, change) = compare(ratio, LINES_OF_SLOPES)?;
        log_ratio = compare(ratio * change, LINES_OF_SLOPES)?.0;
    }
    (log_ratio > MIN_LOG_RATIO).then(|| {
        let text = "two surfaces fit the contacts better than one surface: did the fingers touch two objects, or does the object have an edge that the estimated surface does not follow?";
        Warning::new("two-groups", text, [("log_ratio", log_ratio)])
    })
}

/// Logarithm of the likelihood ratio of two surfaces to one surface. It is 0 if there are too few independent contacts, or
/// if the contacts are too far from the two surfaces. `None` if a fit fails. The two surfaces are searched along `lines`
/// directions. `ratio` is the assumed ratio of the standard deviations of heights and slopes; with 0, slopes are not
/// used. The second result is the ratio that follows from the residuals of the two surfaces, divided by `ratio`.
fn compare(
    contacts: &[Contact],
    patch: &Patch,
    distinct: usize,
    ratio: f64,
    lines: usize,
) -> Option<(f64, f64)> {
    let samples = patch.samples.iter();
    let terms: Vec<Terms> = samples.map(|one| Terms::of(one, ratio)).collect();
    let split = best_split(contacts, &terms, lines)?;
    let (squares, count) = (squares(&split.distances), contacts.len() as f64);
    // Surfaces follow correlated noise better than independent noise. Therefore count the independent distances,
    // whose number follows from the correlation of successive distances.
    let mut order: Vec<usize> = (0..contacts.len()).collect();
    order.sort_by_key(|&contact| contacts[contact].finger);
    let pairs = order.windows(2).map(|pair| [pair[0], pair[1]]);
    let pairs = pairs.filter(|pair| contacts[pair[0]].finger == contacts[pair[1]].finger);
    let products = pairs.map(|pair| pair.map(|contact| split.distances[contact]));
    let products = products.map(|[one, other]| one.component_mul(&other));
    let correlations = products.sum::<Vector3<f64>>().component_div(&squares);
    let correlation = correlations.iter().copied().fold(0.0, f64::max);
    let correlation = correlation.min(MAX_CORRELATION);
    let share = (1.0 - correlation) / (1.0 + correlation);
    let share = share.min(distinct as f64 / count);
    let gap = split.gap_ratio(&patch.samples);
    let has_gap = gap > MIN_GAP;
    // Two planes are more plausible than a polynomial of a higher degree that bends only between them.
    let degree = match split.unknowns {
        3 => 2,
        _ if has_gap => MAX_DEGREES_ACROSS_GAP[usize::from(gap > 1.0)],
        _ => MAX_DEGREE,
    };
    let of_one = of_polynomials(&terms, &split.weights, degree);
    let of_one = of_one.min(of_implicit_quadric(&terms));
    let log_ratio = |of_one: f64| 0.5 * share * (of_one - split.information);
    let change = (2.0 * squares.x / (squares.y + squares.z)).sqrt();
    let is_enough = share * count > MIN_INDEPENDENT;
    let first = log_ratio(of_one) * f64::from(u8::from(is_enough));
    if first <= MIN_LOG_RATIO || has_gap {
        return Some((first, change));
    }
    let fit = Penalised::default().fit(patch).ok()?;
    let noise = fit.noise?;
    let height = noise.position_std / patch.frame.scale();
    let slope = ratio * noise.normal_std_rad.unwrap_or_default();
    // Heights determine a third of the effective degrees of freedom if there are normals, otherwise all.
    let of_heights = fit.effective_unknowns * count / patch.equations() as f64;
    let left = (count - of_heights).max(0.0);
    let of_fit = Vector3::new(height * height, slope * slope, slope * slope) * left;
    let of_fit = information(&of_fit, count, of_heights);
    let is_close = squares.x / (count - 14.0) < (MAX_RATIO * height).powi(2);
    let log_ratio = log_ratio(of_one.min(of_fit)) * f64::from(u8::from(is_close));
    Some((log_ratio, change))
}

/// For each component, the sum of its squares over all `distances`.
fn squares(distances: &[Vector3<f64>]) -> Vector3<f64> {
    distances.iter().map(|one| one.component_mul(one)).sum()
}

/// Bayesian information criterion of a surface with `unknowns` parameters, apart from constants: `squares` are the sums
/// of the squares of `number` distances from it and of as many differences of both slopes, in the unit of the patch.
/// The noise of heights and the noise of slopes are unknown.
fn information(squares: &Vector3<f64>, number: f64, unknowns: f64) -> f64 {
    let of_kind = |square: f64| number * libm::log(square / number + MIN_NOISE * MIN_NOISE);
    let of_slopes = 2.0 * of_kind(0.5 * (squares.y + squares.z));
    of_kind(squares.x) + of_slopes + unknowns * libm::log(number)
}

/// Information criterion of the implicit quadric that fits all contacts best; infinite if it is not a smooth graph.
fn of_implicit_quadric(terms: &[Terms]) -> f64 {
    let sum = terms.iter().map(|one| one.products).sum();
    let found = surface(&sum, &Family::<9>::identity());
    let offsets = |(surface, _)| terms.iter().map(|one| one.offset(&surface)).collect();
    let offsets: Vec<_> = found.map(offsets).unwrap_or_default();
    let (distances, gradients): (Vec<_>, Vec<_>) = offsets.into_iter().unzip();
    match is_graph(gradients.iter()) {
        true => information(&squares(&distances), terms.len() as f64, 9.0),
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

/// Smallest information criterion of polynomials of u and v, of at most the degree `largest`. The distance of a contact
/// is its height above the polynomial, multiplied by its weight in `weights`.
fn of_polynomials(terms: &[Terms], weights: &[f64], largest: i32) -> f64 {
    let number = terms.len();
    let column = |of: &dyn Fn(&Rows) -> [f64; 3]| {
        let mut column = DMatrix::zeros(number, 3);
        for (row, (one, weight)) in terms.iter().zip(weights).enumerate() {
            column.set_row(row, &(RowVector3::from(of(&one.rows)) * *weight));
        }
        column
    };
    let mut left = column(&|rows| rows.map(|row| row[HEIGHT]));
    let (mut basis, mut best) = (Vec::<DMatrix<f64>>::new(), f64::INFINITY);
    for degree in 0..=largest {
        for power in 0..=degree {
            let mut term = column(&|[height, along_u, along_v]| {
                let of = |base: usize, power: i32| height[base].powi(power.max(0));
                let (of_u, of_v) = (of(U, power), of(V, degree - power));
                let by_u = f64::from(power) * of(U, power - 1) * of_v;
                let by_v = f64::from(degree - power) * of(V, degree - power - 1) * of_u;
                [of_u * of_v, by_u * along_u[U], by_v * along_v[V]]
            });
            let norm = term.norm();
            for other in &basis {
                term -= other * other.dot(&term);
            }
            if let Some(term) = term.try_normalize(RANK_TOLERANCE.sqrt() * norm) {
                left -= &term * term.dot(&left);
                basis.push(term);
            }
        }
        let unknowns = basis.len() as f64;
        if unknowns <= MAX_TERMS * number as f64 {
            let squares = [0, 1, 2].map(|kind| left.column(kind).norm_squared());
            best = best.min(information(&squares.into(), number as f64, unknowns));
        }
    }
    best
}

/// Two groups of contacts, each on its own surface.
struct Split {
    information: f64,
    /// Distances of the contacts from their surfaces, and differences of both slopes.
    distances: Vec<Vector3<f64>>,
    /// Cosines of the angles between the normals of the surfaces and the normal of the patch, at the contacts.
    weights: Vec<f64>,
    /// Number of unknowns of a surface.
    unknowns: usize,
    is_first: Vec<bool>,
}

impl Split {
    /// Width of the empty strip between the groups, divided by the extent of the smaller group or by twice the width
    /// of the widest empty strip within a group, whichever is larger.
    fn gap_ratio(&self, samples: &[Sample]) -> f64 {
        let ratio = |line: usize| {
            let (sin, cos) = libm::sincos(2.0 * PI * line as f64 / LINES as f64);
            let places = samples.iter().map(|one| one.u * cos + one.v * sin);
            let (mut first, mut last): (Vec<_>, Vec<_>) = places
                .zip(&self.is_first)
                .partition(|(_, is_first)| **is_first);
            let mut step: f64 = 0.0;
            let [low, high] = [&mut first, &mut last].map(|group| {
                group.sort_by(|one, other| one.0.total_cmp(&other.0));
                let steps = group.windows(2).map(|pair| pair[1].0 - pair[0].0);
                step = steps.fold(step, f64::max);
                [group[0].0, group[group.len() - 1].0]
            });
            (high[0] - low[1]) / (low[1] - low[0]).min(high[1] - high[0]).max(2.0 * step)
        };
        (0..LINES).map(ratio).fold(0.0, f64::max)
    }
}

/// Divides the contacts into the two groups with the smallest information criterion. The surfaces of both groups are
/// planes, spheres, quadrics, or quadrics with a term w².
fn best_split(contacts: &[Contact], terms: &[Terms], lines: usize) -> Option<Split> {
    let (count, total) = (terms.len(), terms.iter().map(|one| one.products).sum());
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
    let lines = (0..lines).map(|line| libm::sincos(PI * line as f64 / lines as f64));
    let along = |(sin, cos)| {
        let keys = terms
            .iter()
            .map(|one| one.rows[0][U] * cos + one.rows[0][V] * sin);
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
            start.1 += terms[pair[0]].products;
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

/// Improves a division of the contacts into two groups. Each group has its own surface from `family`. In each step, a
/// contact joins the first group if the surface of this group is the higher one at the contact (the lower one if `sign`
/// is −1). A division with a smaller information criterion than `best` replaces `best`.
///
/// `is_first` states which contacts are in the first group at the start. `sum` is the sum of the [`Terms::products`]
/// of these contacts, and `total` the sum for all contacts.
fn search<const N: usize>(
    best: &mut Option<Split>,
    (mut is_first, mut sum): (Vec<bool>, Products),
    sign: f64,
    family: &Family<N>,
    total: &Products,
    terms: &[Terms],
) {
    let (count, mut last) = (terms.len(), f64::INFINITY);
    for _ in 0..STEPS {
        let first = is_first.iter().filter(|one| **one).count();
        let is_large = first.min(count - first) >= MIN_GROUP;
        let surfaces = surface(&sum, family).zip(surface(&(total - sum), family));
        let Some(((one, _), (other, _))) = surfaces.filter(|_| is_large) else {
            return;
        };
        let both = |terms: &Terms| [terms.offset(&one), terms.offset(&other)];
        let both: Vec<_> = terms.iter().map(both).collect();
        let own = both.iter().zip(&is_first);
        let own = own.map(|(both, is_first)| both[usize::from(!is_first)]);
        let (distances, gradients): (Vec<_>, Vec<Vector3<f64>>) = own.unzip();
        // The line that separates the groups has two parameters.
        let unknowns = (2 * N + 2) as f64;
        let information = information(&squares(&distances), count as f64, unknowns);
        if information >= last || !is_graph(gradients.iter()) {
            return;
        }
        last = information;
        let least = best.as_ref().map_or(f64::INFINITY, |best| best.information);
        if information < least {
            *best = Some(Split {
                information,
                distances,
                weights: gradients.iter().map(|one| one.z / one.norm()).collect(),
                unknowns: N,
                is_first: is_first.clone(),
            });
        }
        for ((is_first, both), one) in is_first.iter_mut().zip(&both).zip(terms) {
            let is_next = sign * (both[1].0.x - both[0].0.x) > 0.0;
            if is_next != *is_first {
                sum += if is_next { one.products } else { -one.products };
                *is_first = is_next;
            }
        }
    }
}

/// The first row of `rows` contains the terms of an implicit quadric at a contact and, as its last entry, the height of
/// the contact. The other two rows are the derivatives of the first row along two tangents, multiplied by the ratio of the
/// standard deviations of heights and slopes. They are 0 if slopes are not used. `products` is the sum of the products
/// of each row with itself.
struct Terms {
    rows: Rows,
    products: Products,
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

impl Terms {
    /// `ratio` is the ratio of the standard deviations of heights and slopes.
    fn of(sample: &Sample, ratio: f64) -> Self {
        let Sample { u, v, w, .. } = *sample;
        let [p, q] = sample.slopes.unwrap_or_default();
        let along = |tangent: Vector3<f64>| {
            let [x, y, z] = (tangent.normalize() * ratio).into();
            let [of_u, of_v, of_w] = [w * x + u * z, w * y + v * z, 2.0 * w * z];
            let [uu, uv, vv] = [2.0 * u * x, u * y + v * x, 2.0 * v * y];
            Row::from([of_u, of_v, of_w, 0.0, x, y, uu, uv, vv, z])
        };
        let rows = [
            Row::from([u * w, v * w, w * w, 1.0, u, v, u * u, u * v, v * v, w]),
            along(Vector3::new(1.0, 0.0, p)),
            along(Vector3::new(0.0, 1.0, q)),
        ];
        let products = rows.iter().map(|row| row * row.transpose()).sum();
        Self { rows, products }
    }

    /// Distance of the contact above a surface, to first order, the differences of both slopes, and the gradient of the
    /// height less the surface's terms.
    fn offset(&self, surface: &Surface) -> (Vector3<f64>, Vector3<f64>) {
        let height = &self.rows[0];
        let (u, v, w) = (height[U], height[V], height[HEIGHT]);
        let [uw, vw, ww, _, by_u, by_v, uu, uv, vv] = surface.data.0[0];
        let gradient = Vector3::new(
            -uw * w - by_u - 2.0 * uu * u - uv * v,
            -vw * w - by_v - 2.0 * vv * v - uv * u,
            1.0 - uw * u - vw * v - 2.0 * ww * w,
        );
        let left = |row: &Row| row[HEIGHT] - surface.dot(&row.fixed_rows::<9>(0));
        let left = match self.rows[1][U] > 0.0 {
            true => self.rows.each_ref().map(left),
            false => [left(height), 0.0, 0.0],
        };
        (Vector3::from(left) / gradient.norm(), gradient)
    }
}
