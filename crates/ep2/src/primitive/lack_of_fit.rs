//! Tests whether the residuals of a fitted shape are only noise. For this test, a smooth deviation (a polynomial) is
//! fitted to the residuals. Then the correlation between the remaining residuals is estimated.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector, Vector3};
use palpate_statistics::{evenly_spaced, ratio_tail};

use super::cells::{Cells, Rounding};
use super::pose::{Cloud, Pose, UNKNOWNS};
use super::robust_fit::Solution;
use super::wave_tests;
use crate::Shape;
use crate::effective_readings::correlation_time;

/// Largest degree of the polynomial that describes the smooth deviation.
const MAX_DEGREE: usize = 4;
/// A patch counts as a graph over its plane only if all normals are close to the mean normal. This constant is the
/// smallest cosine of the angle between a normal and the mean normal (72 degrees).
const MIN_GRAPH_COSINE: f64 = 0.3;
/// A column of the equations is skipped if it is almost a linear combination of the earlier columns. The part of the
/// column that is independent of the earlier columns has a squared length. This constant is the largest squared length
/// of this part in a skipped column, divided by the squared length of the column.
const RANK_TOLERANCE: f64 = 1e-9;
/// A column of the equations is skipped if it is almost a linear combination of the earlier columns. For noisy
/// positions, the tolerance of this test is this factor times the variance of the positions' noise, but at least
/// [`RANK_TOLERANCE`] and at most [`MAX_RANK_TOLERANCE`].
const MIN_NOISE_RATIO: f64 = 10.0;
const MAX_RANK_TOLERANCE: f64 = 2e-3;
/// Largest number of contacts in the normal equations. If there are more, an evenly spaced selection is used.
const MAX_CONTACTS: usize = 20_000;
/// Largest number of contacts from which the range of the coordinates is computed. The coordinates are the variables of
/// the polynomial that describes the smooth deviation.
const BASIS_CONTACTS: usize = 2000;
/// Number of consecutive contacts in a block. For many contacts, the correlation of residuals is estimated from some of
/// the blocks.
const BLOCK: usize = 2000;
/// Normals are tested only if the ratio of their variance to the variance that the fit assumes is at least this value.
const MIN_NORMALS_VARIANCE: f64 = 0.5;
/// The degree of the smooth deviation is reduced until the ratio of equations to fitted parameters is at least this
/// value.
const MIN_EQUATIONS_RATIO: f64 = 1.5;

/// A shape fits if the contacts deviate from it by less than this share of their spread, and the normals by less than
/// this angle (rad). Such deviations may be the rounding errors of computed contacts, which are not random.
const NEGLIGIBLE: f64 = 1e-4;

#[derive(Clone, Debug)]
pub(super) struct LackOfFit {
    /// P-value of the fit: the probability that contacts on a surface of exactly this shape would fit worse by chance.
    pub(super) p_value: f64,
    /// Whether the deviations from the shape are too small to matter, whatever their p-value.
    pub(super) is_negligible: bool,
    /// One number for positions and one for normals: the number of consecutive values that count as one, because their
    /// errors are correlated.
    pub(super) correlations: [f64; 2],
    /// The same numbers, including the correlation of the positions' rounding errors.
    pub(super) with_rounding: [f64; 2],
}

/// The monomials whose weighted sum is the smooth deviation. Their variables are the coordinates of the points of the
/// shape that are nearest to the contacts.
struct Basis {
    centre: Vector3<f64>,
    scale: f64,
    exponents: Vec<[usize; 3]>,
}

impl Basis {
    fn new(pose: &Pose, cloud: &Cloud, equations: f64) -> Self {
        let cloud = &cloud.thinned(BASIS_CONTACTS);
        let normals = cloud.places.iter().map(|place| pose.normal_at(place));
        let mean = normals.clone().sum::<Vector3<f64>>();
        let is_graph = mean.try_normalize(1e-9).is_some_and(|mean| {
            normals
                .clone()
                .all(|normal| normal.dot(&mean) > MIN_GRAPH_COSINE)
        });
        // Express the places of the contacts along the axes of `pose`, whose normal is the mean normal, and relative to
        // the middle of the contacts.
        let centre = pose.axes * (super::start::middle(cloud) - pose.point);
        let places = cloud
            .places
            .iter()
            .map(|place| pose.axes * (place - pose.point) - centre);
        let scale = places
            .map(|place| place.amax())
            .fold(f64::MIN_POSITIVE, f64::max);
        let exponents = |degree: usize| {
            let depths = if is_graph { 0 } else { degree };
            let mut all = Vec::new();
            for total in 0..=degree {
                for third in 0..=total.min(depths) {
                    for second in 0..=total - third {
                        all.push([total - third - second, second, third]);
                    }
                }
            }
            all
        };
        let degree = (2..=MAX_DEGREE).rev().find(|&degree| {
            let count = exponents(degree).len() + UNKNOWNS;
            equations >= MIN_EQUATIONS_RATIO * count as f64
        });
        Self {
            centre,
            scale,
            exponents: degree.map_or(Vec::new(), exponents),
        }
    }

    /// Writes the values and gradients of the monomials at the point `foot` of the shape, in the axes of the pose.
    fn at(&self, foot: &Vector3<f64>, values: &mut [f64], gradients: &mut [Vector3<f64>]) {
        let place = (foot - self.centre) / self.scale;
        let mut powers = [[1.0; MAX_DEGREE + 1]; 3];
        for (axis, power) in powers.iter_mut().enumerate() {
            for degree in 1..=MAX_DEGREE {
                power[degree] = power[degree - 1] * place[axis];
            }
        }
        for (index, exponents) in self.exponents.iter().enumerate() {
            let parts: [f64; 3] = std::array::from_fn(|axis| powers[axis][exponents[axis]]);
            values[index] = parts[0] * parts[1] * parts[2];
            gradients[index] = Vector3::from_fn(|axis, _| {
                let exponent = exponents[axis];
                if exponent == 0 {
                    return 0.0;
                }
                let others = (0..3).filter(|&other| other != axis);
                let others: f64 = others.map(|other| parts[other]).product();
                exponent as f64 * powers[axis][exponent - 1] * others / self.scale
            });
        }
    }
}

/// Computes the equations of a contact: one for its distance from the shape and three for the components of its normal.
struct Rows<'a> {
    pose: &'a Pose,
    cloud: &'a Cloud,
    basis: Basis,
    /// An error of a position along a curved surface also changes the expected normal there, so the errors of positions
    /// and normals are correlated. To remove this correlation, each contact is moved along the surface to its most
    /// probable place. The displacement is this length times the deviation of the measured normal from the expected
    /// one. The length is 0 if there is nothing to correct.
    shift: f64,
    values: Vec<f64>,
    gradients: Vec<Vector3<f64>>,
}

impl Rows<'_> {
    fn columns(&self) -> usize {
        UNKNOWNS + self.basis.exponents.len()
    }

    fn fill(&mut self, index: usize, rows: &mut [Vec<f64>]) -> [f64; 4] {
        let (pose, place) = (self.pose, self.cloud.places[index]);
        let normal = self.cloud.normals.get(index);
        let mut one = pose.deviation(&place, true);
        let mut residuals = [one.distance, 0.0, 0.0, 0.0];
        let mut foot = pose.axes * (place - pose.point) - one.normal * one.distance;
        if let Some(normal) = normal {
            let left = pose.in_axes(normal) - one.normal;
            residuals[1..].copy_from_slice(left.as_slice());
            let mut step = left * self.shift;
            if pose.shape == Shape::Cylinder {
                step.x = 0.0;
            }
            foot += step;
            one = pose.deviation(&(place + pose.axes.transpose() * step), true);
        }
        self.basis.at(&foot, &mut self.values, &mut self.gradients);
        rows[0][..UNKNOWNS].copy_from_slice((-one.distance_row).as_slice());
        rows[0][UNKNOWNS..].copy_from_slice(&self.values);
        if normal.is_some() {
            for axis in 0..3 {
                let row = rows[1 + axis].iter_mut().take(UNKNOWNS).enumerate();
                row.for_each(|(unknown, value)| *value = one.normal_row(unknown)[axis]);
                for (column, gradient) in self.gradients.iter().enumerate() {
                    let tangent = gradient - one.normal * one.normal.dot(gradient);
                    rows[1 + axis][UNKNOWNS + column] = -tangent[axis];
                }
            }
        }
        residuals
    }
}

/// Tests the residuals of a fit. `fingers` contains the number of the finger of each contact.
pub(super) fn lack_of_fit(
    solution: &Solution,
    cloud: &Cloud,
    fingers: &[usize],
    rounding: &Rounding,
) -> LackOfFit {
    let (p_value, mut found) = tested(solution, cloud, fingers, [1.0; 2]);
    // Residuals that are smaller than rounding errors do not show whether the errors are correlated.
    if solution.variances[0] <= solution.least_variance {
        found[0] = 1.0;
    }
    // Correlated errors of the positions along a curved surface cause correlated errors of the normals. In the
    // estimated correlation of the normals, the noise of the normals hides these errors. Their sum over many contacts
    // is not small, so compute their correlation from the positions.
    let of_bending = match cloud.normals.is_empty() {
        true => 1.0,
        false => 1.0 + solution.bending_share() * (found[0] - 1.0),
    };
    let correlations = [found[0], found[1].max(of_bending)];
    let with_rounding = [
        found[0].max(rounding.correlation(solution)),
        correlations[1],
    ];
    let p_value = match with_rounding == [1.0; 2] {
        true => p_value,
        false => {
            let (again, _) = tested(solution, cloud, fingers, with_rounding);
            let slopes = match found[0] > 1.0 && found[1] > of_bending {
                true => wave_tests::of_slopes(&solution.pose, cloud, fingers),
                false => 1.0,
            };
            again.min(2.0 * slopes)
        }
    };
    let kinds = if cloud.normals.is_empty() { 1 } else { 2 };
    let deviations = &solution.variances[..kinds];
    LackOfFit {
        p_value,
        is_negligible: deviations.iter().all(|one| *one < NEGLIGIBLE * NEGLIGIBLE),
        correlations,
        with_rounding,
    }
}

/// The p-value of the fit for the given correlations, and the correlations that the residuals have.
fn tested(
    solution: &Solution,
    cloud: &Cloud,
    fingers: &[usize],
    correlations: [f64; 2],
) -> (f64, [f64; 2]) {
    let pose = &solution.pose;
    let counts = solution.equations.counts;
    // If the contacts lie on one line, errors of their positions across the line change the normals of the fitted
    // shape. Therefore only distances are tested in this case.
    let is_line = super::shape_choice::is_line(pose, cloud, solution.variances[0]);
    // If the normals scatter less than the fit assumes, the fit gives them too little weight, so their residuals are
    // not independent. Only distances are tested in this case, too.
    let is_exact = solution.weights()[1] * solution.variances[1] < MIN_NORMALS_VARIANCE;
    let (kinds, of_normals) = match is_line || is_exact || cloud.normals.is_empty() {
        true => (1, 0.0),
        false => (4, counts[1] / correlations[1]),
    };
    let equations = counts[0] / correlations[0] + of_normals;
    let basis = Basis::new(pose, cloud, equations);
    let terms = basis.exponents.len();
    let (share, of_axis) = (solution.bending_share(), solution.excess_across_axis());
    let share = (share + of_axis) / (1.0 + of_axis);
    let mut rows = Rows {
        pose,
        cloud,
        basis,
        shift: if share > 0.0 {
            share / pose.curvature
        } else {
            0.0
        },
        values: vec![0.0; terms],
        gradients: vec![Vector3::zeros(); terms],
    };
    let columns = rows.columns();
    let [of_distance, of_normal] =
        [0, 1].map(|kind| 1.0 / (solution.variances[kind] * correlations[kind]));
    let across = of_normal / (1.0 + of_axis);
    let weights = [of_distance, of_normal / (1.0 - of_axis), across, across];
    let mut filled = vec![vec![0.0; columns]; 4];
    let mut gram = DMatrix::zeros(columns, columns);
    let mut right = DVector::zeros(columns);
    let mut total = 0.0;
    let step = cloud.places.len().div_ceil(MAX_CONTACTS).max(1);
    let mut used = 0.0;
    for index in evenly_spaced(cloud.places.len(), MAX_CONTACTS) {
        used += 1.0;
        let residuals = rows.fill(index, &mut filled);
        for (component, row) in filled.iter().enumerate().take(kinds) {
            let weight = weights[component];
            total += weight * residuals[component] * residuals[component];
            for (column, value) in row.iter().enumerate() {
                let weighted = weight * value;
                if weighted == 0.0 {
                    continue;
                }
                right[column] += weighted * residuals[component];
                for (other, value) in row[..=column].iter().enumerate() {
                    gram[(column, other)] += weighted * value;
                }
            }
        }
    }
    // Without noise, some columns of the equations would be linearly dependent. Noise moves the contacts' closest
    // points on the shape, which makes these columns slightly independent. Therefore the tolerance of the test for
    // dependent columns grows with the noise.
    let tolerance = MIN_NOISE_RATIO * solution.variances[0];
    let tolerance = tolerance.clamp(RANK_TOLERANCE, MAX_RANK_TOLERANCE);
    let solved = Sequential::new(&gram, &right, tolerance);
    let explained: f64 = solved.parts[UNKNOWNS..]
        .iter()
        .map(|part| part * part)
        .sum();
    let of_unknowns: f64 = solved.parts[..UNKNOWNS]
        .iter()
        .map(|part| part * part)
        .sum();
    let ranks = |range: std::ops::Range<usize>| range.filter(|&c| solved.is_kept[c]).count();
    let extra = ranks(UNKNOWNS..columns);
    let rank = ranks(0..columns);
    let freedom = equations * used / cloud.places.len() as f64 - rank as f64;
    let mut left = (total - explained - of_unknowns).max(0.0);
    // The residuals of exact contacts are rounding errors, which are far below the smallest variance.
    if solution.variances[0] <= solution.least_variance {
        left = left.max(freedom);
    }
    let by_series = match extra > 0 && freedom >= 1.0 {
        true => ratio_tail(explained, extra, left, freedom as usize),
        false => 1.0,
    };
    // From here on, "residuals" are the values that remain after the smooth deviation is subtracted.
    let coefficients = solved.coefficients();
    let mut strokes: HashMap<usize, usize> = HashMap::new();
    let mut distances: Vec<Vec<f64>> = Vec::new();
    let mut normals: Vec<[Vec<f64>; 3]> = Vec::new();
    for index in (0..cloud.places.len()).filter(|index| (index / BLOCK).is_multiple_of(step)) {
        let residuals = rows.fill(index, &mut filled);
        let left = |component: usize| {
            let fitted: f64 = filled[component]
                .iter()
                .zip(&coefficients)
                .map(|(a, b)| a * b)
                .sum();
            residuals[component] - fitted
        };
        let stroke = *strokes.entry(fingers[index]).or_insert_with(|| {
            distances.push(Vec::new());
            normals.push(Default::default());
            distances.len() - 1
        });
        distances[stroke].push(left(0));
        for component in 1..kinds {
            normals[stroke][component - 1].push(left(component));
        }
    }
    let of_normals: Vec<Vec<f64>> = normals.into_iter().flat_map(|[a, b, _]| [a, b]).collect();
    // Positions and normals together determine the parameters of the deviation. Half of these parameters are attributed
    // to the positions, and half to the normals.
    let absorbed = if kinds > 1 { rank / 2 } else { rank };
    let found = [
        correlation_time(&distances, absorbed),
        if kinds > 1 {
            correlation_time(&of_normals, absorbed)
        } else {
            1.0
        },
    ];
    let thinned = cloud.thinned(MAX_CONTACTS);
    let by_cells = Cells::new(pose, &thinned).map_or(1.0, |cells| {
        let values = thinned.places.iter().map(|place| pose.distance(place));
        cells.p_value(&values.collect::<Vec<f64>>(), solution, correlations[0])
    });
    ((2.0 * by_series.min(by_cells)).min(1.0), found)
}

/// Cholesky factor of normal equations, computed column by column. Columns that are almost a linear combination of
/// earlier columns are skipped.
struct Sequential {
    factor: DMatrix<f64>,
    parts: Vec<f64>,
    is_kept: Vec<bool>,
}

impl Sequential {
    fn new(gram: &DMatrix<f64>, right: &DVector<f64>, tolerance: f64) -> Self {
        let size = right.len();
        let mut factor = DMatrix::zeros(size, size);
        let (mut parts, mut is_kept) = (vec![0.0; size], vec![false; size]);
        for row in 0..size {
            for column in 0..row {
                if is_kept[column] {
                    let mut sum = gram[(row, column)];
                    for before in 0..column {
                        sum -= factor[(row, before)] * factor[(column, before)];
                    }
                    factor[(row, column)] = sum / factor[(column, column)];
                }
            }
            let mut pivot = gram[(row, row)];
            let mut part = right[row];
            for before in 0..row {
                pivot -= factor[(row, before)] * factor[(row, before)];
                part -= factor[(row, before)] * parts[before];
            }
            is_kept[row] = pivot > tolerance * gram[(row, row)] && pivot > 0.0;
            if is_kept[row] {
                factor[(row, row)] = pivot.sqrt();
                parts[row] = part / factor[(row, row)];
            }
        }
        Self {
            factor,
            parts,
            is_kept,
        }
    }

    fn coefficients(&self) -> Vec<f64> {
        let size = self.parts.len();
        let mut solved = vec![0.0; size];
        for row in (0..size).rev().filter(|&row| self.is_kept[row]) {
            let later: f64 = (row + 1..size)
                .map(|next| self.factor[(next, row)] * solved[next])
                .sum();
            solved[row] = (self.parts[row] - later) / self.factor[(row, row)];
        }
        solved
    }
}
