//! The set of mobilities that agree with exact rotations and pads.
//!
//! A mobility has three components. Each roll also has an unknown start, whose coordinates occur in all rows of the
//! roll. The sum of rows whose normals add up to zero does not contain the start. Such sums remove the starts, so that
//! the set is a polyhedron in three dimensions.

use std::sync::OnceLock;

use nalgebra::{Matrix3, Vector2, Vector3};

/// Number of nodes of the integral over the set, for the first guess and for the result.
const NODES: [usize; 2] = [96, 288];
/// Number of nodes that are stored.
const MOST_NODES: usize = 2048;
/// Width of the nodes' distribution, relative to the width of the set's distribution.
const NODE_WIDTH: f64 = 1.3;
/// Largest change of a component of the mobility, in radii of the probe. A set that reaches it is open.
pub(crate) const OPEN: f64 = 16.0;
/// Rows are violated by more than this distance, in radii of the probe.
const TOLERANCE: f64 = 1e-13;

/// A row `form · β + normal · start ≤ slack` of one roll. β is the change of the mobility, and the normal is the one of
/// the edge with this index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeRow {
    pub(crate) edge: usize,
    pub(crate) form: Vector3<f64>,
    pub(crate) slack: f64,
    /// Part of the slack that covers what the linearisation omits. It belongs to the bounds of the set, but not to its
    /// distribution.
    pub(crate) omitted: f64,
}

/// The rows of one roll.
#[derive(Clone, Debug)]
pub(crate) struct RollRows {
    /// The rows, in the order of their edges.
    pub(crate) rows: Vec<EdgeRow>,
    pub(crate) is_start_known: bool,
    pub(crate) edges: usize,
}

/// A polyhedron `form · β ≤ slack`.
#[derive(Clone, Debug, Default)]
pub(crate) struct FeasibleSet {
    rows: Vec<(Vector3<f64>, f64)>,
}

impl FeasibleSet {
    /// The set of mobilities for which each roll has a start.
    pub(crate) fn of_rolls<'r>(rolls: impl Iterator<Item = &'r RollRows>) -> Self {
        let mut rows = Vec::with_capacity(512);
        for roll in rolls {
            if roll.is_start_known {
                rows.extend(roll.rows.iter().map(|row| (row.form, row.slack)));
                continue;
            }
            let of = |edge: usize| roll.rows.iter().filter(move |row| row.edge == edge);
            let half = roll.edges / 2;
            for edge in 0..half {
                for one in of(edge) {
                    let sums = of(edge + half);
                    rows.extend(sums.map(|other| (one.form + other.form, one.slack + other.slack)));
                }
            }
            if half == 3 {
                for first in 0..2 {
                    for one in of(first) {
                        for other in of(first + 2) {
                            let (form, slack) = (one.form + other.form, one.slack + other.slack);
                            let sums = of(first + 4);
                            rows.extend(sums.map(|last| (form + last.form, slack + last.slack)));
                        }
                    }
                }
            }
        }
        Self { rows }
    }

    /// The point of the set that is furthest in `direction`, by the dual simplex method. `None` if the set is empty.
    pub(crate) fn furthest(&self, direction: &Vector3<f64>) -> Option<Vector3<f64>> {
        // Start the dual simplex method with three sides of a large box as the basis.
        let mut basis = Matrix3::from_diagonal(&direction.map(|part| 1.0_f64.copysign(part)));
        let mut slacks = Vector3::repeat(OPEN);
        let mut inverse = basis;
        for _ in 0..200 {
            let point = inverse * slacks;
            let mut worst = (TOLERANCE, None);
            for (index, (form, slack)) in self.rows.iter().enumerate() {
                let beyond = form.dot(&point) - slack;
                if beyond > worst.0 {
                    worst = (beyond, Some(index));
                }
            }
            let Some(entering) = worst.1 else {
                return Some(point);
            };
            let (form, slack) = self.rows[entering];
            // `multipliers` are those of the three basis rows. `shares` express the entering row in the basis rows.
            let multipliers = inverse.tr_mul(direction);
            let shares = inverse.tr_mul(&form);
            let mut leaving = (f64::INFINITY, None);
            for row in 0..3 {
                let ratio = multipliers[row].max(0.0) / shares[row];
                if shares[row] > 1e-12 * form.norm() && ratio < leaving.0 {
                    leaving = (ratio, Some(row));
                }
            }
            let row = leaving.1?;
            basis.set_row(row, &form.transpose());
            slacks[row] = slack;
            inverse = basis.try_inverse()?;
        }
        None
    }
}

/// Mean and covariance of the mobility, if the starts and the mobility are distributed uniformly over the values that
/// agree with the readings. The distribution of the mobility is then proportional to the product of the areas in which
/// the starts of the rolls can be. `centre` and `covariance` are a first guess.
pub(crate) fn distribution(
    rolls: &[RollRows],
    centre: Vector3<f64>,
    covariance: Matrix3<f64>,
) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let (mut mean, mut spread) = (centre, covariance);
    for nodes in NODES {
        let root = spread.cholesky()?.unpack() * NODE_WIDTH;
        let (mut sum, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for normal in &normal_nodes()[..nodes] {
            let point = mean + root * normal;
            let area: f64 = rolls.iter().map(|roll| roll.area(&point)).product();
            if area > 0.0 {
                let weight = area * libm::exp(0.5 * normal.norm_squared());
                sum += weight;
                first += point * weight;
                second += point * point.transpose() * weight;
            }
        }
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        mean = first / sum;
        spread = second / sum - mean * mean.transpose();
        spread += Matrix3::identity() * (1e-24 + 1e-9 * spread.trace());
    }
    Some((mean, spread))
}

/// Points of a sequence with low discrepancy, with normally distributed coordinates.
pub(crate) fn normal_nodes() -> &'static [Vector3<f64>] {
    static NODES: OnceLock<Vec<Vector3<f64>>> = OnceLock::new();
    NODES.get_or_init(|| (1..=MOST_NODES).map(normal_node).collect())
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

impl RollRows {
    /// Area in which the start of the roll can be for the change `point` of the mobility, in units of its largest
    /// slacks. With a known start, the area is 1 if the mobility agrees with the rows, otherwise 0.
    fn area(&self, point: &Vector3<f64>) -> f64 {
        let mut slacks = [OPEN; 6];
        let mut rows = self.rows.iter();
        let mut next = rows.next();
        for (edge, least) in slacks.iter_mut().enumerate() {
            while let Some(row) = next.filter(|row| row.edge == edge) {
                let slack = row.slack - row.omitted - row.form.dot(point);
                *least = if slack < *least { slack } else { *least };
                next = rows.next();
            }
        }
        let slacks = &slacks[..self.edges];
        if self.is_start_known {
            return f64::from(u8::from(slacks.iter().all(|slack| *slack >= 0.0)));
        }
        if self.edges == 4 {
            let lengths = [slacks[0] + slacks[2], slacks[1] + slacks[3]];
            return match lengths[0] > 0.0 && lengths[1] > 0.0 {
                true => lengths[0] * lengths[1] * UNIT * UNIT,
                false => 0.0,
            };
        }
        hexagon_area(slacks) * UNIT * UNIT
    }
}

/// Unit of lengths in areas, which keeps products of many areas in the range of doubles.
const UNIT: f64 = 1e3;

/// Area of the polygon `normal · place ≤ slack` with the normals of a hexagon.
fn hexagon_area(slacks: &[f64]) -> f64 {
    let largest = 4.0 * slacks.iter().copied().fold(0.0, f64::max);
    let mut corners = vec![
        Vector2::new(-largest, -largest),
        Vector2::new(largest, -largest),
        Vector2::new(largest, largest),
        Vector2::new(-largest, largest),
    ];
    for (normal, slack) in crate::PadCell::hexagonal(1.0).normals().zip(slacks) {
        let mut cut = Vec::with_capacity(corners.len() + 1);
        for (index, corner) in corners.iter().enumerate() {
            let next = corners[(index + 1) % corners.len()];
            let [here, there] = [corner, &next].map(|place| slack - normal.dot(place));
            if here >= 0.0 {
                cut.push(*corner);
            }
            if (here >= 0.0) != (there >= 0.0) {
                cut.push(corner + (next - corner) * (here / (here - there)));
            }
        }
        if cut.len() < 3 {
            return 0.0;
        }
        corners = cut;
    }
    let next = corners.iter().cycle().skip(1);
    let twice: f64 = corners.iter().zip(next).map(|(a, b)| a.perp(b)).sum();
    0.5 * twice.max(0.0)
}
