//! Linear bounds of the mobility, and the distribution of the mobility inside them.
//!
//! A row is a linear inequality: in one sample, the contact is on the inner side of an edge of the active pad. A mobility
//! has three components. Each roll also has an unknown start, whose coordinates occur in all rows of the roll. A linear
//! program over the start of one roll shows whether a mobility agrees with the roll. If it does not, the program's
//! multipliers add rows of the roll to a sum without the start (Benders' decomposition). Such sums bound the mobility in
//! three dimensions.

use std::sync::OnceLock;

use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};

use crate::PadCell;

/// Numbers of nodes of successive integrals over the set of possible mobilities. The result of each integral is the
/// first guess of the next one.
const NODES: [usize; 6] = [96, 256, 256, 512, 1024, 2048];
/// The result of an integral is accepted if its effective number of nodes, divided by its number of nodes, exceeds this
/// value.
const MIN_EFFECTIVE: f64 = 0.15;
/// Number of nodes that are integrated together.
const BLOCK: usize = 32;
/// Number of nodes that are stored.
const MOST_NODES: usize = 2048;
/// Width of the nodes' distribution, relative to the width of the set's distribution.
const NODE_WIDTH: f64 = 1.3;
/// Largest change of a component of the mobility, in radii of the probe. A set that reaches it is open.
pub(crate) const OPEN: f64 = 16.0;
/// Rows are violated by more than this distance, in radii of the probe.
const TOLERANCE: f64 = 1e-12;
/// A start can violate the rows of its roll by this distance. It is larger than the rounding errors of the sums.
const START_TOLERANCE: f64 = 1e-10;
/// Largest number of steps of a linear program.
const MAX_STEPS: usize = 300;
/// Relative change of a direction, which avoids cycles of the simplex method.
const OBLIQUE: f64 = 1e-7;
/// Unit of length of the areas in which the starts of rolls can be. It keeps the products of many areas in the range of
/// doubles.
const UNIT: f64 = 1e-3;

/// A bound (row) `form · β ≤ slack` of the change β of the mobility.
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

/// The bounds (rows) of one roll.
#[derive(Clone, Debug)]
pub(crate) struct RollRows {
    /// The rows, in the order of their edges.
    pub(crate) rows: Vec<EdgeRow>,
    pub(crate) is_start_known: bool,
}

/// The corner of a polyhedron that is furthest in a direction.
struct Corner {
    point: Vector3<f64>,
    /// The rows through the corner: the index of each row (`None` for a side of the box), and its share of the
    /// direction.
    shares: [(Option<usize>, f64); 3],
}

/// The corner of the polyhedron `rows` that is furthest in `direction`, by the dual simplex method. `None` if the
/// polyhedron is empty.
fn furthest(rows: &[Row], direction: &Vector3<f64>) -> Option<Corner> {
    // A direction that is perpendicular to no edge of the polyhedron avoids cycles.
    let oblique = direction + Vector3::new(0.37, 0.61, 0.83) * (OBLIQUE * direction.norm());
    // The first basis consists of three sides of a box.
    let mut basis = Matrix3::from_diagonal(&oblique.map(f64::signum));
    let mut slacks = Vector3::repeat(OPEN);
    let (mut inverse, mut numbers) = (basis, [None; 3]);
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

/// The change of the mobility that is furthest in `direction` and agrees with all rolls, and the changes of the rolls'
/// starts there. `None` if no change agrees with all rolls.
pub(crate) fn furthest_change(
    rolls: &[RollRows],
    direction: &Vector3<f64>,
) -> Option<(Vector3<f64>, Vec<Vector2<f64>>)> {
    let sides = [Vector3::x(), Vector3::y(), Vector3::z()];
    let sides = sides
        .into_iter()
        .flat_map(|side| [(side, OPEN), (-side, OPEN)]);
    let known = rolls.iter().filter(|roll| roll.is_start_known);
    let rows = known.flat_map(|roll| roll.rows.iter().map(|row| scaled(row.form, row.slack)));
    let mut sums: Vec<Row> = sides.chain(rows).collect();
    let mut starts = Vec::with_capacity(rolls.len());
    let mut of_roll = Vec::new();
    for _ in 0..MAX_STEPS {
        let point = furthest(&sums, direction)?.point;
        let count = sums.len();
        starts.clear();
        for roll in rolls {
            starts.push(match roll.is_start_known {
                true => Vector2::zeros(),
                false => roll.start(&point, &mut of_roll, &mut sums)?,
            });
        }
        if sums.len() == count {
            return Some((point, starts));
        }
    }
    None
}

/// A row with a form of length 1.
fn scaled(form: Vector3<f64>, slack: f64) -> Row {
    let scale = 1.0 / form.norm().max(1e-12);
    (form * scale, slack * scale)
}

impl RollRows {
    /// The start that violates the rows least at the change `point` of the mobility. If it violates them, the sum of
    /// rows that shows it is added to `sums`.
    fn start(
        &self,
        point: &Vector3<f64>,
        rows: &mut Vec<Row>,
        sums: &mut Vec<Row>,
    ) -> Option<Vector2<f64>> {
        rows.clear();
        rows.extend(self.rows.iter().map(|row| {
            let form = Vector3::new(row.normal.x, row.normal.y, -1.0);
            (form, row.slack - row.form.dot(point))
        }));
        let corner = furthest(rows, &-Vector3::z())?;
        if corner.point.z > START_TOLERANCE {
            let (mut form, mut slack) = (Vector3::zeros(), 0.0);
            for (row, share) in corner.shares {
                if let Some(row) = row {
                    form += self.rows[row].form * share;
                    slack += self.rows[row].slack * share;
                }
            }
            sums.push(scaled(form, slack));
        }
        Some(corner.point.xy())
    }
}

/// Mean and covariance of the mobility, if the starts and the mobility are distributed uniformly over the values that
/// agree with the readings. `is_possible` excludes mobilities that are not those of a rolling contact. The distribution of the mobility is then proportional to the product of the areas in which
/// the starts of the rolls can be. `centre` and `covariance` are a first guess, and `responses` are the derivatives of
/// the starts with respect to the mobility.
pub(crate) fn distribution(
    rolls: &[RollRows],
    responses: &[Matrix2x3<f64>],
    cell: &PadCell,
    is_possible: impl Fn(&Vector3<f64>) -> bool,
    centre: Vector3<f64>,
    covariance: Matrix3<f64>,
) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    // The normals of a roll's rows differ slightly from those of the pads' edges. The difference is small, so that the
    // start in it may be the likeliest one.
    let normals: Vec<_> = cell.normals().collect();
    let along: Vec<Vec<_>> = rolls
        .iter()
        .zip(responses)
        .map(|(roll, response)| {
            let row = |row: &EdgeRow| {
                let apart = row.normal - normals[row.edge];
                let more = match roll.is_start_known {
                    true => Vector3::zeros(),
                    false => response.tr_mul(&apart),
                };
                (row.edge, row.form + more, row.slack)
            };
            roll.rows.iter().map(row).collect()
        })
        .collect();
    let (mut mean, mut spread) = (centre, covariance);
    for (pass, nodes) in NODES.into_iter().enumerate() {
        let root = spread.cholesky()?.unpack() * NODE_WIDTH;
        let (mut sum, mut squares) = (0.0, 0.0);
        let (mut first, mut second) = (Vector3::zeros(), Matrix3::zeros());
        for block in normal_nodes()[..nodes].chunks_exact(BLOCK) {
            let points: [Vector3<f64>; BLOCK] = std::array::from_fn(|at| mean + root * block[at]);
            let mut areas = [1.0; BLOCK];
            for (rows, roll) in along.iter().zip(rolls) {
                multiply_areas(
                    rows,
                    roll.is_start_known,
                    normals.len(),
                    &points,
                    &mut areas,
                );
            }
            for ((point, area), normal) in points.iter().zip(areas).zip(block) {
                if area > 0.0 && is_possible(point) {
                    let weight = area * libm::exp(0.5 * normal.norm_squared());
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
        spread = second / sum - mean * mean.transpose();
        spread += Matrix3::identity() * (1e-24 + 1e-9 * spread.trace());
        let effective = sum * sum / squares;
        if effective < 6.0 {
            return None;
        }
        if pass > 0 && effective > MIN_EFFECTIVE * nodes as f64 {
            return Some((mean, spread));
        }
    }
    None
}

/// Multiplies `areas` by the areas in which the start of a roll can be for the changes `points` of the mobility. With a
/// known start, the area is 1 if the mobility agrees with the rows, otherwise 0.
fn multiply_areas(
    rows: &[(usize, Vector3<f64>, f64)],
    is_start_known: bool,
    edges: usize,
    points: &[Vector3<f64>; BLOCK],
    areas: &mut [f64; BLOCK],
) {
    let mut slacks = [[OPEN; BLOCK]; 6];
    for (edge, form, slack) in rows {
        for (least, point) in slacks[*edge].iter_mut().zip(points) {
            let slack = slack - form.dot(point);
            *least = if slack < *least { slack } else { *least };
        }
    }
    for (node, area) in areas.iter_mut().enumerate() {
        let mut slack: [f64; 6] = std::array::from_fn(|edge| slacks[edge][node]);
        *area *= match (is_start_known, edges) {
            (true, _) => f64::from(u8::from(slack.iter().all(|slack| *slack >= 0.0))),
            (false, 4) => {
                let [u, v] = [slack[0] + slack[2], slack[1] + slack[3]];
                u.max(0.0) * v.max(0.0) / (UNIT * UNIT)
            }
            _ => hexagon_area(&mut slack) / (UNIT * UNIT),
        };
    }
}

/// Area of the polygon `normal · place ≤ slack` with the normals of a hexagon. Each normal is the sum of both normals
/// beside it.
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
