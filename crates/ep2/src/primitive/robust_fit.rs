//! Fits a shape to the distances and normals of contacts by least squares. Variances are estimated from the residuals,
//! and outliers are left out.

use nalgebra::{SymmetricEigen, Vector3};
use palpate_statistics::{SIGNIFICANCE_LEVEL, chi_squared_tail, student_half_width};

use super::intervals::MAX_RELATIVE_NOISE;
use super::pose::{CURVATURE, Cloud, Equations, Gram, Pose, Row, UNKNOWNS};
use super::start::{middle, starts};
use crate::Shape;
use crate::gross_outliers::{MAX_OUTLIER_SHARE, OUTLIER_PROBABILITY};
use crate::noise::MIN_OUTLIER_STEPS;
use crate::surface_outliers::median;

const ITERATIONS: usize = 20;
const VARIANCE_ITERATIONS: usize = 8;
/// A fit ends if a step decreases χ² by less than this value. The value is the square of 0.01, so the parameters would
/// change by at most about 1 % of a standard error.
const MIN_DECREASE: f64 = 1e-4;
/// Smallest standard deviation of positions (relative to their spread) and of normals. Smaller values are treated as
/// rounding errors.
pub(super) const MIN_STD: f64 = 1e-9;
/// Largest allowed ratio between the estimated variances of normals and positions, in either direction. Positions are
/// in the unit of the contacts' spread.
const MAX_VARIANCE_RATIO: f64 = 1e8;
/// The estimated variance of normals includes the effect of errors of positions, which is subtracted. At least this
/// share of the estimated variance remains, as the variance of the normals' own errors.
const MIN_SENSOR_SHARE: f64 = 0.05;
/// Largest variance that errors of positions add to the normals. Errors of unit normals are limited, so without this
/// limit, the sum of squares would be smallest at an infinite curvature.
const MAX_BENDING: f64 = 0.25;
/// Eigenvalues of scaled normal equations count as rounding errors if they are below this share of the largest
/// eigenvalue.
const RANK_TOLERANCE: f64 = 1e-12;
/// Largest number of contacts in the preliminary fits, which compute the start of the final fit.
const START_CONTACTS: usize = 600;
/// Number of subsets of contacts. The shape through each subset is a start value of a robust fit.
const SUBSETS: u64 = 60;
/// Number of contacts in a subset from which a robust fit starts.
const SUBSET_SIZE: usize = 8;
const SUBSET_ITERATIONS: usize = 15;
/// Two robust fits are compared: one starts from the shape through all contacts, the other from the shape through a
/// subset. The second fit replaces the first only if two quantities are smaller by at least this factor: the contacts'
/// median distance from the start shape of the second fit (compared with the first fit's shape), and the variance of
/// the second fit.
const MAX_MEDIAN_SHARE: f64 = 0.75;
const GROWTH_ITERATIONS: usize = 10;
const GROWTH_FIT_ITERATIONS: usize = 8;
/// Outliers are contacts beyond a limit. This constant is the largest number of contacts from which the limits are
/// computed.
const MAX_CONTACTS: usize = 20_000;
/// A fit that leaves out more than a fifth of the contacts may have a far smaller variance than the robust fit from all
/// contacts. Then the contacts have too many outliers, which is an error. This constant is the limit for the ratio of
/// the first variance to the second.
const MAX_FEW_VARIANCE_SHARE: f64 = 0.04;

/// Stated noise is contradicted only if the ratio of the estimated to the stated standard deviation, or its inverse,
/// exceeds this value.
const MAX_NOISE_RATIO: f64 = 1.5;

/// Stated standard deviations of positions (in the unit of the contacts' spread) and normals (rad).
pub(super) type StatedNoise = [Option<f64>; 2];

const ESTIMATED: StatedNoise = [None; 2];

#[derive(Clone, Copy, Debug)]
pub(super) struct Solution {
    pub(super) pose: Pose,
    pub(super) equations: Equations,
    /// Variances of the errors of positions and of normals.
    pub(super) variances: [f64; 2],
    /// Smallest variance of positions that was assumed.
    pub(super) least_variance: f64,
    pub(super) inverse: Gram,
    /// Degrees of freedom of the estimated variances; `None` if the contacts do not determine the variances.
    pub(super) freedom: Option<f64>,
}

/// Weights of distances and normals in the sum of squares.
///
/// An error of a position along the surface changes the expected normal by k times the error, where k is the curvature.
/// Therefore normals have the variance σ_n² + β k² with β = c σ_p²/2. σ_n and σ_p are the standard deviations of
/// normals and positions, and c is 2 for a sphere and 1 for a cylinder. With a constant variance, the fit would reduce
/// k in order to reduce the sum of squares.
#[derive(Clone, Copy, Debug)]
struct Weights {
    of_distances: f64,
    normals: [f64; 2],
}

/// The number β of [`Weights`]: positions with the variance `variance` add β k² to the variance of the normals.
pub(super) fn slope(shape: Shape, variance: f64) -> f64 {
    match shape {
        Shape::Plane => 0.0,
        Shape::Sphere => variance,
        Shape::Cylinder => 0.5 * variance,
    }
}

impl Weights {
    fn new(pose: &Pose, variances: [f64; 2]) -> Self {
        let slope = slope(pose.shape, variances[0]);
        let bending = slope * pose.curvature * pose.curvature;
        let sensor = (variances[1] - bending).max(MIN_SENSOR_SHARE * variances[1]);
        Self {
            of_distances: variances[0].recip(),
            normals: [sensor, slope],
        }
    }

    /// Weights for contacts on a large part of a shape. `cosine` is the mean cosine of the angles between the contacts'
    /// normals and the normal of the pose. There, errors of positions reduce k only by this share of their effect on a
    /// small cap. Therefore only this share of β k² depends on k in the fit.
    fn with_cosine(self, cosine: f64, pose: &Pose) -> Self {
        let [sensor, slope] = self.normals;
        let dependent = slope * cosine.clamp(0.0, 1.0);
        let constant = (slope - dependent) * pose.curvature * pose.curvature;
        Self {
            normals: [sensor + constant, dependent],
            ..self
        }
    }

    fn of_normals(&self, pose: &Pose) -> f64 {
        let [sensor, slope] = self.normals;
        let bending = slope * pose.curvature * pose.curvature;
        (sensor + bending.min(MAX_BENDING)).recip()
    }

    /// The cost is the weighted sum of squares. The variance of the normals depends on the curvature k, so the
    /// derivative of the cost with respect to k needs a correction. The result is this correction, divided by −2k.
    fn correction(&self, pose: &Pose, equations: &Equations) -> f64 {
        self.normals[1] * equations.squares[1] * self.of_normals(pose).powi(2)
    }

    fn cost(&self, pose: &Pose, equations: &Equations) -> f64 {
        let [of_distances, of_normals] = equations.squares;
        self.of_distances * of_distances + self.of_normals(pose) * of_normals
    }

    /// Matrix of the normal equations. Each parameter that the shape does not have is replaced by a 1 on the diagonal.
    fn gram(&self, pose: &Pose, equations: &Equations) -> Gram {
        let mut gram =
            equations.grams[0] * self.of_distances + equations.grams[1] * self.of_normals(pose);
        let least = 0.3 * gram[(CURVATURE, CURVATURE)];
        let corrected = gram[(CURVATURE, CURVATURE)] - self.correction(pose, equations);
        gram[(CURVATURE, CURVATURE)] = corrected.max(least);
        for unknown in 0..UNKNOWNS {
            if !pose.has(unknown) {
                gram.row_mut(unknown).fill(0.0);
                gram.column_mut(unknown).fill(0.0);
                gram[(unknown, unknown)] = 1.0;
            }
        }
        gram
    }

    fn gradient(&self, pose: &Pose, equations: &Equations) -> Row {
        let mut gradient = equations.gradients[0] * self.of_distances
            + equations.gradients[1] * self.of_normals(pose);
        gradient[CURVATURE] += self.correction(pose, equations) * pose.curvature;
        for unknown in 0..UNKNOWNS {
            if !pose.has(unknown) {
                gradient[unknown] = 0.0;
            }
        }
        gradient
    }

    fn minimise(&self, start: Pose, cloud: &Cloud, iterations: usize) -> (Pose, Equations) {
        let middle = middle(cloud);
        let mut pose = start.based_at(&middle);
        let mut equations = Equations::new(&pose, cloud);
        let mut cost = self.cost(&pose, &equations);
        let mut damping = 1e-6;
        for _ in 0..iterations {
            let mut gram = self.gram(&pose, &equations);
            for unknown in 0..UNKNOWNS {
                gram[(unknown, unknown)] *= 1.0 + damping;
            }
            let gradient = self.gradient(&pose, &equations);
            let Some(factor) = gram.cholesky() else {
                damping = (damping * 10.0_f64).max(1e-6);
                if damping > 1e12 {
                    break;
                }
                continue;
            };
            let step = factor.solve(&gradient);
            let expected = step.dot(&gradient);
            let next = pose.moved(&step, &middle);
            let there = Equations::new(&next, cloud);
            let next_cost = self.cost(&next, &there);
            let is_better = next_cost <= cost;
            if is_better {
                (pose, equations, cost) = (next, there, next_cost);
                damping = (damping * 0.1).max(1e-12);
            } else {
                damping = (damping * 10.0).max(1e-6);
            }
            let is_small = expected < MIN_DECREASE || expected < 1e-12 * cost;
            if (is_small && damping < 1.0) || damping > 1e12 {
                break;
            }
        }
        (pose, equations)
    }
}

/// Fits a shape, starting at the pose `start`. Variances that are not stated are estimated from the residuals.
/// `correlations` contains one number for positions and one for normals: the number of consecutive values that count as
/// one, because their errors are correlated.
pub(super) fn solve(
    start: Pose,
    cloud: &Cloud,
    stated: StatedNoise,
    correlations: [f64; 2],
    iterations: usize,
) -> Solution {
    let least_variances = [cloud.rounding_variance, 0.0].map(|one| one.max(MIN_STD * MIN_STD));
    let mut variances = first_variances(&start, cloud, stated);
    let mut pose = start;
    let mut last = None;
    let sum: Vector3<f64> = cloud.normals.iter().sum();
    let mean = sum / cloud.normals.len().max(1) as f64;
    let weights_at = |pose: &Pose, variances| {
        Weights::new(pose, variances).with_cosine(mean.dot(&pose.axis(2)), pose)
    };
    for _ in 0..VARIANCE_ITERATIONS {
        let weights = weights_at(&pose, variances);
        let (next, equations) = weights.minimise(pose, cloud, iterations);
        pose = next;
        let gram = weights.gram(&pose, &equations);
        let inverse = inverse(&gram);
        let of_kinds = [weights.of_distances, weights.of_normals(&pose)];
        let used = [0, 1].map(|kind| (inverse * equations.grams[kind]).trace() * of_kinds[kind]);
        let left: [f64; 2] =
            std::array::from_fn(|kind| equations.counts[kind] - correlations[kind] * used[kind]);
        let before = variances;
        for kind in 0..2 {
            let bending = match kind {
                0 => 0.0,
                _ => pose.curvature * pose.curvature * slope(pose.shape, variances[0]),
            };
            variances[kind] = match stated[kind] {
                Some(std) => std * std + bending,
                None if left[kind] >= 0.5 => equations.squares[kind] / left[kind],
                None => variances[kind],
            }
            .max(least_variances[kind]);
        }
        if !cloud.normals.is_empty() {
            variances[0] = variances[0].max(variances[1] / MAX_VARIANCE_RATIO);
            variances[1] = variances[1].max(variances[0] / MAX_VARIANCE_RATIO);
        }
        let left = [0, 1].map(|kind| left[kind] / correlations[kind]);
        let is_given = |kind: usize| stated[kind].is_some() || equations.counts[kind] == 0.0;
        let is_complete = (0..2).all(|kind| is_given(kind) || left[kind] >= 0.5);
        let freedom = match (0..2).all(is_given) {
            true => 1e9,
            false => left[0].max(0.0) + left[1].max(0.0),
        };
        // The variances have changed since the pose was fitted, so compute the normal equations again.
        let gram = weights_at(&pose, variances).gram(&pose, &equations);
        let is_steady = (0..2).all(|kind| (variances[kind] / before[kind] - 1.0).abs() < 0.01);
        last = Some(Solution {
            pose,
            equations,
            variances,
            least_variance: least_variances[0],
            inverse: self::inverse(&gram),
            freedom: is_complete.then_some(freedom),
        });
        // Without normals, there is only one variance. It does not change the minimum, so no further iteration is
        // needed.
        if is_steady || cloud.normals.is_empty() {
            break;
        }
    }
    last.unwrap_or_else(|| unreachable!("there is at least one iteration"))
}

/// Start values of the variances: the stated variances or, if they are not stated, the mean squares of the residuals.
fn first_variances(pose: &Pose, cloud: &Cloud, stated: StatedNoise) -> [f64; 2] {
    let mean_square = |all: &[f64]| {
        let sum: f64 = all.iter().map(|one| one * one).sum();
        sum / all.len().max(1) as f64
    };
    let thinned = cloud.thinned(START_CONTACTS);
    let [distances, normals] = residuals(pose, &thinned);
    let found = [mean_square(&distances), 0.5 * mean_square(&normals)];
    std::array::from_fn(|kind| {
        let variance = stated[kind].map_or(found[kind], |std| std * std);
        if variance.is_finite() {
            variance.max(MIN_STD * MIN_STD)
        } else {
            1.0
        }
    })
}

/// Inverse of the matrix of the normal equations. Parameter combinations that the equations do not determine get a very
/// large variance.
fn inverse(gram: &Gram) -> Gram {
    let scales = gram
        .diagonal()
        .map(|x| x.max(f64::MIN_POSITIVE).sqrt().recip());
    let scaled = Gram::from_diagonal(&scales) * gram * Gram::from_diagonal(&scales);
    let eigen = SymmetricEigen::new(scaled);
    let least = RANK_TOLERANCE * eigen.eigenvalues.max();
    let values = eigen.eigenvalues.map(|value| value.max(least).recip());
    let vectors = Gram::from_diagonal(&scales) * eigen.eigenvectors;
    vectors * Gram::from_diagonal(&values) * vectors.transpose()
}

impl Solution {
    /// Share of the variance of the normals that is caused by errors of the positions along the curved surface.
    pub(super) fn bending_share(&self) -> f64 {
        let [sensor, slope] = Weights::new(&self.pose, self.variances).normals;
        let bending = slope * self.pose.curvature * self.pose.curvature;
        bending / (sensor + bending)
    }

    /// On a cylinder, errors of positions change only the component of the expected normal across the axis. Let V be the
    /// mean variance of the two components and e the result. The variance along the axis is V (1 − e), and across the
    /// axis V (1 + e). The result is 0 for other shapes.
    pub(super) fn excess_across_axis(&self) -> f64 {
        match self.pose.shape {
            Shape::Cylinder => self.bending_share(),
            _ => 0.0,
        }
    }

    /// The fitted shape without the bias of noisy positions. Errors of a position along a curved surface move it outward
    /// on average, by σ_p²k on a sphere and by half of this on a cylinder. Here σ_p is the standard deviation of each
    /// coordinate, and k the curvature. The surface is moved back by this length.
    pub(super) fn within_noise(&self) -> Pose {
        let pose = self.pose;
        let [_, slope] = Weights::new(&pose, self.variances).normals;
        let outward = slope * pose.curvature;
        let stretch = 1.0 - outward * pose.curvature;
        // If the noise is not small compared with the radius, this correction is not accurate, so do not move the
        // surface.
        if stretch < 1.0 - MAX_RELATIVE_NOISE * MAX_RELATIVE_NOISE {
            return pose;
        }
        let point = pose.point - pose.axis(2) * outward;
        let (normal, axis) = (pose.axis(2), pose.axis(0));
        Pose::new(pose.shape, point, normal, axis, pose.curvature / stretch)
    }

    /// Ratios of the estimated to the expected variances of positions and of normals; 1 for noise that the contacts do
    /// not contradict. The expected variance is the stated one; for normals, it also contains the variance that errors
    /// of the positions cause on a curved surface. Call this only for a fit that does not use the stated noise.
    pub(super) fn noise_ratios(&self, stated: StatedNoise) -> [f64; 2] {
        let bending = [0.0, self.bending_share() * self.variances[1]];
        std::array::from_fn(|kind| {
            let Some(std) = stated[kind] else { return 1.0 };
            let ratio = self.variances[kind] / (std * std + bending[kind]);
            let freedom = self.equations.counts[kind] as usize;
            let freedom = freedom.saturating_sub(self.pose.unknowns());
            let larger = chi_squared_tail(freedom as f64 * ratio, freedom);
            let is_far = ratio.max(ratio.recip()) > MAX_NOISE_RATIO * MAX_NOISE_RATIO
                && 2.0 * larger.min(1.0 - larger) < SIGNIFICANCE_LEVEL;
            if is_far { ratio } else { 1.0 }
        })
    }

    /// Weights of squared distances and of squared deviations of normals in the fit. The weight of the normals is less
    /// than the inverse of their variance if this variance is less than expected from the errors of the positions.
    pub(super) fn weights(&self) -> [f64; 2] {
        let weights = Weights::new(&self.pose, self.variances);
        [weights.of_distances, weights.of_normals(&self.pose)]
    }

    /// −2 ln(likelihood) of the fit, without an additive constant. Variances that are not stated have their most
    /// probable values.
    pub(super) fn deviance(&self, stated: StatedNoise, correlations: [f64; 2]) -> f64 {
        let floors = [self.least_variance, MIN_STD * MIN_STD];
        let parts = (0..2).map(|kind| {
            let (count, square) = (self.equations.counts[kind], self.equations.squares[kind]);
            let deviance = match stated[kind] {
                _ if count == 0.0 => 0.0,
                Some(_) => square / self.variances[kind],
                None => count * libm::log((square / count).max(floors[kind])),
            };
            deviance / correlations[kind]
        });
        parts.sum()
    }
}

#[derive(Clone, Debug)]
pub(super) struct RobustFit {
    pub(super) solution: Solution,
    pub(super) is_used: Vec<bool>,
    limits: Limits,
    /// Pose and limits of another fit, which leaves out more than a fifth of all contacts but has a much smaller
    /// variance. `None` if there is no such fit.
    fit_to_few: Option<(Pose, Limits)>,
}

/// Fits a shape such that a few outliers hardly change the result. The noise is estimated even if it is stated:
/// otherwise, with too small a stated noise, sound contacts would be outliers.
pub(super) fn robust_fit(shape: Shape, cloud: &Cloud) -> RobustFit {
    let thinned = cloud.thinned(START_CONTACTS);
    let fits = starts(shape, &thinned)
        .into_iter()
        .map(|start| solve(start, &thinned, ESTIMATED, [1.0; 2], 12));
    let best = fits.min_by(|one, other| {
        let [one, other] = [one, other].map(|fit| fit.deviance(ESTIMATED, [1.0; 2]));
        one.total_cmp(&other)
    });
    let start = best.map_or_else(
        || Pose::new(shape, middle(cloud), Vector3::z(), Vector3::x(), 0.0),
        |fit| fit.pose,
    );
    let sample = cloud.thinned(MAX_CONTACTS);
    let robust = with_growth(start, &sample, &thinned);
    if sample.places.len() == cloud.places.len() {
        return robust;
    }
    let pose = robust.solution.pose;
    let is_used = robust.limits.are_met(&pose, cloud);
    let selected = cloud.selected(&is_used);
    RobustFit {
        solution: solve(pose, &selected, ESTIMATED, [1.0; 2], ITERATIONS),
        is_used,
        ..robust
    }
}

/// A robust fit that starts at the pose `start` and also at poses through subsets of the contacts. The subsets are
/// drawn from `thinned`, a selection of the contacts.
fn with_growth(start: Pose, cloud: &Cloud, thinned: &Cloud) -> RobustFit {
    let plain_all = solve(start, cloud, ESTIMATED, [1.0; 2], ITERATIONS);
    let mut plain = grown(plain_all, cloud);
    let Some(pose) = through_most(&plain.solution.pose, thinned) else {
        return plain;
    };
    // Both `plain_all` and `other` are fits to all contacts. `plain_all` starts at `start`, and `other` at the pose
    // through a subset of the contacts. Use `other` if it has the smaller deviance.
    let other = solve(pose, cloud, ESTIMATED, [1.0; 2], ITERATIONS);
    if other.deviance(ESTIMATED, [1.0; 2]) < plain_all.deviance(ESTIMATED, [1.0; 2]) - MIN_DECREASE
    {
        plain = grown(other, cloud);
    }
    let from_subset = Solution {
        pose,
        ..plain.solution
    };
    let from_subset = grown(from_subset, cloud);
    // Rounding errors of coordinates may be absent from the residuals, because the fit can follow them. Differences
    // between variances below that of rounding therefore mean nothing, so use at least the variance of rounding.
    let variances = [&from_subset, &plain].map(|fit| {
        let of_rounding = cloud.rounding(&fit.solution.pose).0.sum();
        fit.solution.variances[0].max(of_rounding)
    });
    if from_subset.leaves_out_too_many() {
        let is_clear = variances[0] < MAX_FEW_VARIANCE_SHARE * variances[1];
        plain.fit_to_few = is_clear.then_some((from_subset.solution.pose, from_subset.limits));
        return plain;
    }
    if variances[0] < MAX_MEDIAN_SHARE * variances[1] {
        from_subset
    } else {
        plain
    }
}

/// The pose with the smallest median distance from all contacts, among poses through subsets of the contacts. `None` if
/// this distance is not much smaller than the median distance from the pose `plain`.
fn through_most(plain: &Pose, cloud: &Cloud) -> Option<Pose> {
    let weights = Weights {
        of_distances: 1.0,
        normals: [100.0, 0.0],
    };
    let mut random = 0x9E37_79B9_7F4A_7C15_u64;
    let mut least = MAX_MEDIAN_SHARE * median_distance(plain, cloud);
    let mut best = None;
    for _ in 0..SUBSETS {
        let mut subset = Cloud::default();
        for _ in 0..SUBSET_SIZE {
            random = random.wrapping_mul(6_364_136_223_846_793_005);
            random = random.wrapping_add(1_442_695_040_888_963_407);
            let index = (random >> 33) as usize % cloud.places.len();
            subset.places.push(cloud.places[index]);
            subset.normals.extend(cloud.normals.get(index));
        }
        let (pose, _) = weights.minimise(*plain, &subset, SUBSET_ITERATIONS);
        let median = median_distance(&pose, cloud);
        if median < least {
            (least, best) = (median, Some(pose));
        }
    }
    best
}

fn median_distance(pose: &Pose, cloud: &Cloud) -> f64 {
    let places = cloud.places.iter();
    median(places.map(|place| pose.distance(place).abs()).collect())
}

/// Limits for outliers: the largest distance of a contact from the shape, and the largest deviation of its normal.
#[derive(Clone, Copy, Debug)]
struct Limits([f64; 2]);

impl Limits {
    /// Limits at the pose `pose`: the standard deviations of distances and of normals, each multiplied by `deviations`.
    /// The standard deviations are estimated from the medians of the residuals. With few residuals, a median is
    /// uncertain, so the limits are wider.
    fn first(pose: &Pose, cloud: &Cloud, deviations: f64) -> Self {
        let freedom = cloud.places.len().saturating_sub(pose.unknowns()).max(1);
        let correction = 1.0 + 5.0 / freedom as f64;
        // Medians of the magnitude of normally distributed noise with standard deviation 1: for a distance (one
        // component) and for the deviation of a unit normal (two components).
        let medians = [0.6745, 1.1774];
        let mut kind = 0;
        let of = residuals(pose, cloud).map(|all| {
            let median = match all.is_empty() {
                true => f64::INFINITY,
                false => median(all),
            };
            kind += 1;
            deviations * correction * (median / medians[kind - 1]).max(MIN_STD)
        });
        Self(of)
    }

    /// For each contact, whether it is within the limits.
    fn are_met(self, pose: &Pose, cloud: &Cloud) -> Vec<bool> {
        let [distances, normals] = residuals(pose, cloud);
        let most = self.0[0].max(MIN_OUTLIER_STEPS * cloud.rounding(pose).1.amax());
        let is_near = |(index, distance): (usize, &f64)| {
            let normal = normals.get(index).copied().unwrap_or(0.0);
            *distance <= most && normal <= 1.1 * self.0[1]
        };
        distances.iter().enumerate().map(is_near).collect()
    }
}

/// Fits the contacts near the pose of `solution`. Selects the contacts again after each fit, until the selection no
/// longer changes.
fn grown(mut solution: Solution, cloud: &Cloud) -> RobustFit {
    let unknowns = solution.pose.unknowns();
    let quantile = |used: usize| {
        let freedom = used.saturating_sub(unknowns);
        student_half_width(1.0 - OUTLIER_PROBABILITY, freedom.min(10_000))
    };
    let half = quantile(cloud.places.len().div_ceil(2));
    let mut limits = Limits::first(&solution.pose, cloud, half);
    let mut last = vec![];
    for _ in 0..GROWTH_ITERATIONS {
        let near = limits.are_met(&solution.pose, cloud);
        let used = near.iter().filter(|used| **used).count();
        if near == last || used <= unknowns + 1 {
            break;
        }
        let selected = cloud.selected(&near);
        solution = solve(
            solution.pose,
            &selected,
            ESTIMATED,
            [1.0; 2],
            GROWTH_FIT_ITERATIONS,
        );
        let deviations = quantile(used);
        limits = Limits(solution.variances.map(|one| deviations * one.sqrt()));
        last = near;
    }
    RobustFit {
        solution,
        is_used: limits.are_met(&solution.pose, cloud),
        limits,
        fit_to_few: None,
    }
}

fn residuals(pose: &Pose, cloud: &Cloud) -> [Vec<f64>; 2] {
    let distances = cloud.places.iter().map(|place| pose.distance(place).abs());
    let pairs = cloud.places.iter().zip(&cloud.normals);
    let normals = pairs.map(|(place, normal)| (normal - pose.normal_at(place)).norm());
    [distances.collect(), normals.collect()]
}

impl RobustFit {
    /// For each contact, whether a fit uses it that leaves out more than a fifth of the contacts but has a much smaller
    /// variance. `None` if there is no such fit.
    pub(super) fn inliers_of_few(&self, cloud: &Cloud) -> Option<Vec<bool>> {
        let (pose, limits) = self.fit_to_few?;
        Some(limits.are_met(&pose, cloud))
    }

    fn leaves_out_too_many(&self) -> bool {
        let left = self.is_used.iter().filter(|used| !**used).count();
        left as f64 > MAX_OUTLIER_SHARE * self.is_used.len() as f64
    }
}
