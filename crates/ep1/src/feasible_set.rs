//! Computes linear bounds of the mobility, and the distribution of the mobility inside these bounds. The mobility is
//! the contact's travel per radian of rotation.
//!
//! A bound (row) is a linear inequality. It states that in one sample, the contact is on the inner side of an edge of
//! the active pad. Its unknowns are the three components of the mobility and the start of the roll. All rows of a roll
//! have the same start. For a given mobility, a linear program over the start tests whether the mobility agrees with
//! the roll. If it does not, the program's multipliers combine rows of the roll into a sum in which the start cancels
//! (Benders' decomposition). Such sums bound the mobility alone.

use std::sync::OnceLock;

use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};

use crate::PadCell;

/// Numbers of nodes of successive numerical integrals over the set of possible mobilities (contact travels per radian).
/// Each integral returns the mean and the covariance of the mobility. They are the first guess for the next integral.
const NODES: [usize; 6] = [64, 192, 256, 512, 1024, 2048];
/// The result of a numerical integral is accepted only if the effective number of nodes exceeds this share of the
/// number of all nodes. For the weights w of the nodes, the effective number is (Σ w)² / Σ w².
const MIN_EFFECTIVE: f64 = 0.15;
/// Number of nodes at which the integrand is computed together.
const BLOCK: usize = 32;
/// Largest number of nodes of a numerical integral over the set of possible mobilities (contact travels per radian).
/// The nodes are computed once and stored.
const MOST_NODES: usize = 2048;
/// The nodes of a numerical integral are normally distributed values of the mobility (contact travel per radian). This
/// constant is their standard deviation, divided by the standard deviation of the mobility.
const NODE_WIDTH: f64 = 1.3;
/// Largest considered change of a component of the mobility (contact travel per radian), in radii of the probe. If
/// mobilities with this change are possible, the set of possible mobilities counts as open, that is, as unbounded.
pub(crate) const OPEN: f64 = 16.0;
/// A point violates a bound (row) only if it is beyond the bound by more than this distance, in radii of the probe.
const TOLERANCE: f64 = 1e-12;
/// The start of a roll may violate the bounds of the roll by this distance, in radii of the probe. This tolerance is
/// larger than the rounding errors of the bounds, so that rounding excludes no possible start.
const START_TOLERANCE: f64 = 1e-9;
/// Largest number of steps of the simplex method, and largest number of rounds in which bounds are added to a linear
/// program.
const MAX_STEPS: usize = 300;
/// Relative change of the direction in which a linear program searches. This change avoids cycles of the simplex
/// method.
const OBLIQUE: f64 = 1e-7;
/// Unit of length, in radii of the probe, in which the areas of possible starts of rolls are computed. With this unit,
/// the product of the areas of many rolls stays in the range of doubles.
const UNIT: f64 = 1e-3;

/// A bound (row) `form · β ≤ slack` of the change β of the mobility (contact travel per radian).
type Row = (Vector3<f64>, f64);

/// A bound (row) `form · β + normal · start ≤ slack` of one roll, with the index of the pad's edge. β is the change of
/// the mobility, and `start` is the change of the roll's start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeRow {
    pub(crate) edge: usize,
    pub(crate) form: Vector3<f64>,
    pub(crate) normal: Vector2<f64>,
    pub(crate) slack: f64,
}

/// The bounds (rows) of the mobility and of the start that follow from one roll.
#[derive(Clone, Debug)]
pub(crate) struct RollRows {
    /// The bounds, in the order of the pads' edges to which they belong.
    pub(crate) rows: Vec<EdgeRow>,
    pub(crate) is_start_known: bool,
    /// Exponent of the roll's probability: 1/n if n rolls change pads at the same samples. They share the errors of these
    /// changes, so together they count as one roll.
    pub(crate) share: f64,
}

/// The corner that is furthest in a direction, among the corners of the polyhedron that all bounds enclose.
struct Corner {
    point: Vector3<f64>,
    /// For each of the three bounds (rows) through the corner: its index (`None` for a side of the bounding box), and
    /// its multiplier. The direction in which the corner is furthest is the sum of the normals of the three bounds,
    /// each times its multiplier.
    shares: [(Option<usize>, f64); 3],
}

/// Indices of three bounds (rows), which intersect in a corner; `None` for a side of the bounding box.
pub(crate) type Basis = [Option<usize>; 3];

/// State of the linear programs for the bounds (rows) of all rolls. `starts` contains the corner at which the last
/// program of each roll ended, because the next program begins there. `sums` are sums of bounds of a roll in which the
/// unknown start of the roll cancels. They are valid for all directions of search.
#[derive(Clone, Debug, Default)]
pub(crate) struct Programs {
    sums: Vec<Row>,
    pub(crate) starts: Vec<Basis>,
}

/// The corner of the polyhedron `rows` that is furthest in `direction`, computed with the dual simplex method. The
/// search begins at the corner of the three rows `numbers` if this corner is optimal for these three rows alone.
/// Otherwise, the search begins at a corner of the bounding box. `None` if the polyhedron is empty.
fn furthest(rows: &[Row], direction: &Vector3<f64>, numbers: &mut Basis) -> Option<Corner> {
    // If an edge of the polyhedron is perpendicular to `direction`, the simplex method can repeat the same steps
    // forever. Therefore search in a slightly different direction.
    let oblique = direction + Vector3::new(0.37, 0.61, 0.83) * (OBLIQUE * direction.norm());
    let mut basis = Matrix3::from_diagonal(&oblique.map(f64::signum));
    let mut slacks = Vector3::repeat(OPEN);
    let mut inverse = basis;
    if *numbers != [None; 3] {
        let (mut of_rows, mut own) = (basis, slacks);
        for (place, number) in numbers.iter().enumerate() {
            if let Some((form, slack)) = number.and_then(|number| rows.get(number)) {
                of_rows.set_row(place, &form.transpose());
                own[place] = *slack;
            }
        }
        let found = of_rows.try_inverse();
        match found.filter(|inverse| inverse.tr_mul(&oblique).min() >= 0.0) {
            Some(found) => (basis, slacks, inverse) = (of_rows, own, found),
            None => *numbers = [None; 3],
        }
    }
    for _ in 0..MAX_STEPS {
        let point = inverse * slacks;
        let mut worst = (TOLERANCE, None);
        for (index, (form, slack)) in rows.iter().enumerate() {
            let beyond = form.dot(&point) - slack;
            if beyond > worst.0 {
                worst = (beyond, Some(index));
            }
        }
        let Some(entering) = worst.1 else {
            let shares = inverse.tr_mul(direction);
            let shares = [0, 1, 2].map(|row| (numbers[row], shares[row].max(0.0)));
            return Some(Corner { point, shares });
        };
        let (form, slack) = rows[entering];
        let multipliers = inverse.tr_mul(&oblique);
        let shares = inverse.tr_mul(&form);
        let mut leaving = (f64::INFINITY, None);
        for row in 0..3 {
            let ratio = multipliers[row].max(0.0) / shares[row];
            if shares[row] > 1e-9 && ratio < leaving.0 {
                leaving = (ratio, Some(row));
            }
        }
        let row = leaving.1?;
        basis.set_row(row, &form.transpose());
        (slacks[row], numbers[row]) = (slack, Some(entering));
        inverse = basis.try_inverse()?;
    }
    None
}

/// Among the changes of the mobility (contact travel per radian) that agree with all rolls, returns the change that is
/// furthest in `direction`. The second result contains the changes of the rolls' starts that belong to this change.
/// `None` if no change agrees with all rolls.
pub(crate) fn furthest_change(
    rolls: &[RollRows],
    direction: &Vector3<f64>,
    programs: &mut Programs,
) -> Option<(Vector3<f64>, Vec<Vector2<f64>>)> {
    let Programs { sums, starts } = programs;
    let mut of_roll = Vec::new();
    if sums.is_empty() {
        let sides = [Vector3::x(), Vector3::y(), Vector3::z()];
        let sides = sides
            .into_iter()
            .flat_map(|side| [(side, OPEN), (-side, OPEN)]);
        let known = rolls.iter().filter(|roll| roll.is_start_known);
        let rows = known.flat_map(|roll| roll.rows.iter().map(|row| scaled(row.form, row.slack)));
        sums.extend(sides.chain(rows));
        starts.resize(rolls.len(), [None; 3]);
        for (roll, basis) in rolls.iter().zip(&mut *starts) {
            if !roll.is_start_known {
                let corner = roll.start(&Vector3::zeros(), basis, &mut of_roll)?;
                sums.extend(roll.sum(&corner));
            }
        }
    }
    let mut basis = [None; 3];
    for _ in 0..MAX_STEPS {
        let point = furthest(sums, direction, &mut basis)?.point;
        let count = sums.len();
        let mut all = Vec::with_capacity(rolls.len());
        for (roll, basis) in rolls.iter().zip(&mut *starts) {
            if roll.is_start_known {
                all.push(Vector2::zeros());
                continue;
            }
            let corner = roll.start(&point, basis, &mut of_roll)?;
            if corner.point.z > START_TOLERANCE {
                // At `point`, no start of the roll fulfils all bounds of the roll. So their sum, in which the start
                // cancels, should be a bound of the mobility that excludes `point`. If rounding errors hide this, do
                // not add the sum, because the next `point` would be the same.
                let (form, slack) = roll.sum(&corner)?;
                if form.dot(&point) > slack + TOLERANCE {
                    sums.push((form, slack));
                }
            }
            all.push(corner.point.xy());
        }
        if sums.len() == count {
            return Some((point, all));
        }
    }
    None
}

/// The bound `form · β ≤ slack`, with both sides divided by the length of the vector `form`.
fn scaled(form: Vector3<f64>, slack: f64) -> Row {
    let scale = 1.0 / form.norm().max(1e-12);
    (form * scale, slack * scale)
}

impl RollRows {
    /// Finds the start of the roll that violates the bounds of the roll least: it minimises the largest violation.
    /// `point` is the change of the mobility (contact travel per radian). The first two coordinates of the resulting
    /// corner are the start; the third coordinate is the violation.
    fn start(
        &self,
        point: &Vector3<f64>,
        basis: &mut Basis,
        rows: &mut Vec<Row>,
    ) -> Option<Corner> {
        rows.clear();
        rows.extend(self.rows.iter().map(|row| {
            let form = Vector3::new(row.normal.x, row.normal.y, -1.0);
            (form, row.slack - row.form.dot(point))
        }));
        furthest(rows, &-Vector3::z(), basis)
    }

    /// The sum of the bounds through a corner, each times its multiplier. The unknown start of the roll cancels in this
    /// sum. `None` if the corner is on the bounding box.
    fn sum(&self, corner: &Corner) -> Option<Row> {
        let (mut form, mut slack) = (Vector3::zeros(), 0.0);
        let mut normal = Vector2::zeros();
        for (row, share) in corner.shares {
            if let Some(row) = row {
                form += self.rows[row].form * share;
                normal += self.rows[row].normal * share;
                slack += self.rows[row].slack * share;
            } else if share > 1e-9 {
                return None;
            }
        }
        // The multipliers have small errors, so the start of the roll does not cancel exactly: the coefficient `normal`
        // remains. The start is at most one radius of the probe, so its term is at most |normal|. Widen the bound by
        // this value.
        Some(scaled(form, slack + normal.norm()))
    }

    /// Converts the bounds of the roll to bounds of the mobility alone, in the order of the pads' edges. `response` is
    /// the derivative of the roll's start with respect to the mobility (contact travel per radian).
    ///
    /// The normals of a roll's bounds differ slightly from the normals of the pads' edges. In the term with this small
    /// difference, the likeliest start replaces the unknown start.
    fn of_mobility(&self, response: &Matrix2x3<f64>, cell: &PadCell) -> Vec<MobilityRow> {
        let mut all = Vec::with_capacity(self.rows.len());
        for (edge, normal) in cell.normals().enumerate() {
            for row in self.rows.iter().filter(|row| row.edge == edge) {
                let mut form = row.form;
                if !self.is_start_known {
                    form += response.tr_mul(&(row.normal - normal));
                }
                all.push(MobilityRow {
                    edge,
                    form,
                    slack: row.slack,
                });
            }
        }
        all
    }
}

/// A bound of the mobility (contact travel per radian) that follows from one roll: `form · β ≤ slack`, where β is the
/// change of the mobility. The bound is stored with the index of the pad's edge.
#[derive(Clone, Copy, Debug)]
struct MobilityRow {
    edge: usize,
    form: Vector3<f64>,
    slack: f64,
}

/// Removes each bound of the mobility for which another bound from the same edge of the pad is at least as strict at
/// every integration node. `mean` is the mean of the mobility (contact travel per radian), `root` the Cholesky factor of
/// its covariance, and `radius` the largest distance of an integration node from the mean, in standard deviations.
fn retain_needed(
    rows: &mut Vec<MobilityRow>,
    mean: &Vector3<f64>,
    root: &Matrix3<f64>,
    radius: f64,
) {
    let at_mean = |row: &MobilityRow| row.slack - row.form.dot(mean);
    let mut tightest: [Option<MobilityRow>; 6] = [None; 6];
    for row in &*rows {
        let best = &mut tightest[row.edge];
        if best.is_none_or(|best| at_mean(row) < at_mean(&best)) {
            *best = Some(*row);
        }
    }
    rows.retain(|row| {
        tightest[row.edge].is_none_or(|best| {
            let reach = root.tr_mul(&(row.form - best.form)).norm() * radius * NODE_WIDTH;
            at_mean(row) - at_mean(&best) <= reach
        })
    });
}

/// Mean and covariance of the mobility (contact travel per radian). The mobility and the starts of the rolls are
/// assumed to be distributed uniformly over the values that agree with the readings. Then the density of the mobility
/// is proportional to the product of the areas in which the rolls can start. `is_possible` excludes mobilities with
/// which the contact would not roll. `centre` and `covariance` are first guesses of the mean and the covariance.
/// `responses` are the derivatives of the starts with respect to the mobility.
pub(crate) fn distribution(
    rolls: &[RollRows],
    responses: &[Matrix2x3<f64>],
    cell: &PadCell,
    is_possible: impl Fn(&Vector3<f64>) -> bool,
    centre: Vector3<f64>,
    covariance: Matrix3<f64>,
) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let all: Vec<_> = rolls
        .iter()
        .zip(responses)
        .map(|(roll, response)| roll.of_mobility(response, cell))
        .collect();
    let (mut mean, mut spread) = (centre, covariance);
    for (pass, nodes) in NODES.into_iter().enumerate() {
        let root = spread.cholesky()?.unpack();
        let mut near = all.clone();
        let radius = normal_nodes()[nodes - 1].radius;
        for (rows, roll) in near.iter_mut().zip(rolls) {
            retain_needed(rows, &mean, &root, radius);
            // If the start of the roll is known, a bound that all nodes fulfil does not change the result.
            rows.retain(|row| {
                let reach = root.tr_mul(&row.form).norm() * radius * NODE_WIDTH;
                !roll.is_start_known || row.slack - row.form.dot(&mean) < reach
            });
        }
        let root = root * NODE_WIDTH;
        let (mut sum, mut squares) = (0.0, 0.0);
        let (mut first, mut second) = (Vector3::zeros(), Matrix3::zeros());
        for block in normal_nodes()[..nodes].chunks_exact(BLOCK) {
            let points: [Vector3<f64>; BLOCK] =
                std::array::from_fn(|at| mean + root * block[at].node);
            let parts = [0, 1, 2].map(|part| points.map(|point| point[part]));
            let mut areas = [1.0; BLOCK];
            for (rows, roll) in near.iter().zip(rolls).filter(|(rows, _)| !rows.is_empty()) {
                multiply_areas(rows, roll, cell, &parts, &mut areas);
            }
            for ((point, area), node) in points.iter().zip(areas).zip(block) {
                if area > 0.0 && is_possible(point) {
                    let weight = area * node.weight;
                    sum += weight;
                    squares += weight * weight;
                    first += point * weight;
                    second += point * point.transpose() * weight;
                }
            }
        }
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        mean = first / sum;
        let effective = sum * sum / squares;
        // Few nodes are in the set. Their mean is also in the set, because the set is convex. Search near this mean.
        if effective < 6.0 {
            spread *= 0.25;
            continue;
        }
        spread = second / sum - mean * mean.transpose();
        spread += Matrix3::identity() * (1e-24 + 1e-9 * spread.trace());
        if pass > 0 && effective > MIN_EFFECTIVE * nodes as f64 {
            return Some((mean, spread));
        }
    }
    None
}

/// Multiplies each of the `areas` by the area in which a roll can start. Each area belongs to a change (`uu`, `uv`,
/// `vv`) of the mobility (contact travel per radian). If the start is fixed, the factor is 1 if the mobility agrees
/// with all bounds, otherwise 0.
fn multiply_areas(
    rows: &[MobilityRow],
    roll: &RollRows,
    cell: &PadCell,
    [uu, uv, vv]: &[[f64; BLOCK]; 3],
    areas: &mut [f64; BLOCK],
) {
    let mut slacks = [[OPEN; BLOCK]; 6];
    for row in rows {
        let [of_uu, of_uv, of_vv] = row.form.into();
        let nodes = slacks[row.edge].iter_mut().zip(uu).zip(uv).zip(vv);
        for (((least, uu), uv), vv) in nodes {
            let slack = row.slack - of_uu * uu - of_uv * uv - of_vv * vv;
            *least = if slack < *least { slack } else { *least };
        }
    }
    for (node, area) in areas.iter_mut().enumerate() {
        let mut slack: [f64; 6] = std::array::from_fn(|edge| slacks[edge][node]);
        let own = match (roll.is_start_known, 2 * cell.pairs()) {
            (true, _) => f64::from(u8::from(slack.iter().all(|slack| *slack >= 0.0))),
            (false, 4) => {
                let [u, v] = [slack[0] + slack[2], slack[1] + slack[3]];
                u.max(0.0) * v.max(0.0) / (UNIT * UNIT)
            }
            _ => hexagon_area(&mut slack) / (UNIT * UNIT),
        };
        *area *= if roll.share == 1.0 {
            own
        } else {
            libm::pow(own, roll.share)
        };
    }
}

/// Area of a hexagon: the set of all places that fulfil six bounds `normal · place ≤ slack`. The normals are the unit
/// normals of a regular hexagon, so each normal is the sum of its two neighbours.
fn hexagon_area(slacks: &mut [f64; 6]) -> f64 {
    let beside = |slacks: &[f64; 6], edge: usize| slacks[(edge + 1) % 6] + slacks[(edge + 5) % 6];
    for edge in (0..12).map(|edge| edge % 6) {
        slacks[edge] = slacks[edge].min(beside(slacks, edge));
    }
    if (0..3).any(|edge| slacks[edge] + slacks[edge + 3] <= 0.0) {
        return 0.0;
    }
    let length =
        |edge: usize| (beside(slacks, edge) - slacks[edge]).max(0.0) * 2.0 / 3.0_f64.sqrt();
    (0..6)
        .map(|edge| 0.5 * slacks[edge] * length(edge))
        .sum::<f64>()
        .max(0.0)
}

/// A node of a numerical integral: a normally distributed point from a low-discrepancy sequence. The density of the
/// points is normal, so each weight is proportional to the inverse of the normal density at the point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) node: Vector3<f64>,
    weight: f64,
    /// The largest distance from the origin among this node and all nodes before it.
    radius: f64,
}

/// Points of a low-discrepancy sequence, transformed to normally distributed coordinates.
pub(crate) fn normal_nodes() -> &'static [Node] {
    static NODES: OnceLock<Vec<Node>> = OnceLock::new();
    let all = || {
        let mut radius: f64 = 0.0;
        let node = |index| {
            let node = normal_node(index);
            let weight = libm::exp(0.5 * node.norm_squared());
            radius = radius.max(node.norm());
            Node {
                node,
                weight,
                radius,
            }
        };
        (1..=MOST_NODES).map(node).collect()
    };
    NODES.get_or_init(all)
}

fn normal_node(index: usize) -> Vector3<f64> {
    let fraction = |base: usize| {
        let (mut rest, mut scale, mut sum) = (index, 1.0, 0.0);
        while rest > 0 {
            scale /= base as f64;
            sum += scale * (rest % base) as f64;
            rest /= base;
        }
        sum
    };
    let radius = |base| (-2.0 * libm::log(fraction(base))).sqrt();
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * fraction(3));
    let other = libm::cos(std::f64::consts::TAU * fraction(7));
    Vector3::new(radius(2) * cos, radius(2) * sin, radius(5) * other)
}
