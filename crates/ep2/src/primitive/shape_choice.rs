//! Chooses the most probable of the shapes that were fitted to contacts.

use nalgebra::{Matrix2, SymmetricEigen};

use super::pose::{Cloud, Pose};
use super::robust_fit::StatedNoise;
use super::{Candidate, Shape, start, wave_tests};

/// If the p-value of the best-fitting shape equals this value, "none of these shapes" is as probable as this shape. A
/// smaller p-value makes "none of these shapes" more probable.
const NONE_P_VALUE: f64 = 0.01;
/// The contacts count as lying on a line if the variance of their positions across the line, divided by the variance of
/// the noise, is below this value.
const MIN_SPREAD_RATIO: f64 = 10.0;

/// Whether the contacts lie on a line along the surface, except for noise. `variance` is the variance of the positions'
/// noise.
pub(super) fn is_line(pose: &Pose, cloud: &Cloud, variance: f64) -> bool {
    let pose = pose.based_at(&start::middle(cloud));
    let mut spread = Matrix2::zeros();
    for place in &cloud.places {
        let q = (pose.axes * (place - pose.point)).xy();
        spread += q * q.transpose() / cloud.places.len() as f64;
    }
    SymmetricEigen::new(spread).eigenvalues.min() < MIN_SPREAD_RATIO * variance
}

/// The index of the most probable shape, and the probabilities of a plane, a sphere, a cylinder and none of these.
///
/// The shapes are compared by the Bayesian information criterion. The probability of "none of these" is 0.01 / p times
/// the probability of the best shape. Here p is the smaller of two p-values of the best shape. One comes from the test
/// for lack of fit, the other from the test for a wave in the distances of the contacts.
pub(super) fn choose(
    candidates: &[Candidate],
    stated: StatedNoise,
    used: &Cloud,
) -> (usize, Option<[f64; 4]>) {
    let correlations = [0, 1].map(|kind| {
        let all = candidates.iter().map(|one| one.lack.with_rounding[kind]);
        all.fold(f64::INFINITY, f64::min)
    });
    let criterion = |one: &Candidate| {
        let counts = one.solution.equations.counts;
        let equations = counts[0] / correlations[0] + counts[1] / correlations[1];
        let unknowns = one.solution.pose.unknowns() as f64;
        one.solution.deviance(stated, correlations) + unknowns * libm::log(equations)
    };
    let mut criteria: Vec<f64> = candidates.iter().map(criterion).collect();
    // If all contacts lie on one line, a sphere and a cylinder fit equally well except for position errors. The test
    // for a line uses the smallest residual variance of all shapes. The residuals of a shape that does not fit would be
    // far larger than the noise.
    let variances = candidates.iter().map(|one| one.solution.variances[0]);
    let variance = variances.fold(f64::INFINITY, f64::min);
    let cylinder = &candidates[Shape::Cylinder as usize].solution.pose;
    if is_line(cylinder, used, variance) {
        let best = criteria[Shape::Sphere as usize].min(criteria[Shape::Cylinder as usize]);
        criteria[Shape::Sphere as usize] = best;
        criteria[Shape::Cylinder as usize] = best;
    }
    let least = criteria.iter().copied().fold(f64::INFINITY, f64::min);
    let chosen = criteria.iter().position(|&one| one == least).unwrap_or(0);
    let weights: Vec<f64> = criteria
        .iter()
        .map(|one| libm::exp(0.5 * (least - one)))
        .collect();
    let Candidate { solution, lack } = &candidates[chosen];
    let of_wave = wave_tests::of_distances(solution, used, lack.with_rounding[0]);
    let none = NONE_P_VALUE / lack.p_value.min(of_wave).max(f64::MIN_POSITIVE);
    let total = weights.iter().sum::<f64>() + none;
    let shares = weights.iter().map(|weight| weight / total);
    let mut probabilities = [0.0; 4];
    for (probability, share) in probabilities.iter_mut().zip(shares.chain([none / total])) {
        *probability = share;
    }
    (chosen, Some(probabilities))
}
