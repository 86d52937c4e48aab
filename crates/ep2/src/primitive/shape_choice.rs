//! Chooses the most probable of the shapes that were fitted to contacts.

use nalgebra::{Matrix2, SymmetricEigen};

use super::intervals::noise_share;
use super::pose::{Cloud, Pose};
use super::robust_fit::StatedNoise;
use super::{Candidate, Shape, start, wave_tests};

/// If the p-value of the best-fitting shape equals this value, "none of these shapes" is as probable as this shape. A
/// smaller p-value makes "none of these shapes" more probable.
const NONE_P_VALUE: f64 = 0.01;
/// The contacts count as lying on a line if the variance of their positions across the line, divided by the variance of
/// the noise, is below this value.
const MIN_SPREAD_RATIO: f64 = 10.0;
/// Two shapes are tested for equal probability only if the sum of the squared sines of the angles between their normals
/// at the contacts exceeds `MIN_SINES`, or if the [`noise_share`] of one of them exceeds `MIN_NOISE_SHARE`. If the most
/// probable shapes include one with such a noise share, it is chosen, because it leaves the radius open.
const MIN_SINES: f64 = 4.0;
const MIN_NOISE_SHARE: f64 = 0.5;
/// Two shapes count as equally probable if their deviances differ by less than this number of standard deviations of
/// the difference.
const MAX_DEVIATIONS: f64 = 3.0;

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
/// for lack of fit, the other from the test for a wave in the distances of the contacts. If the deviations are negligible,
/// p is 1.
pub(super) fn choose(
    candidates: &[Candidate],
    stated: StatedNoise,
    used: &Cloud,
) -> (usize, Option<[f64; 4]>) {
    let correlations = [0, 1].map(|kind| {
        let all = candidates.iter().map(|one| one.lack.with_rounding[kind]);
        all.fold(f64::INFINITY, f64::min)
    });
    let deviance = |one: &Candidate| one.solution.deviance(stated, correlations);
    let criterion = |one: &Candidate| {
        let counts = one.solution.equations.counts;
        let equations = counts[0] / correlations[0] + counts[1] / correlations[1];
        let unknowns = one.solution.pose.unknowns() as f64;
        deviance(one) + unknowns * libm::log(equations)
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
    let by_criterion = |one: &usize, other: &usize| criteria[*one].total_cmp(&criteria[*other]);
    let best = (0..criteria.len()).min_by(by_criterion).unwrap_or(0);
    let least = criteria[best];
    // Several shapes may fit the contacts equally well, although their normals at the contacts differ, such as a sphere
    // and a cylinder through two rings of contacts. Then different components of the noise determine the fits, so the
    // difference of their deviances is random. Its variance is 4 Σ sin² θ, where θ is the angle between both normals at
    // a contact.
    let shares: Vec<f64> = candidates
        .iter()
        .map(|one| noise_share(&one.solution, used))
        .collect();
    for (index, share) in shares.iter().enumerate() {
        let pair = [best, index].map(|one| &candidates[one]);
        let sine = |place| {
            let [one, other] = pair.map(|one| one.solution.pose.normal_at(place));
            one.cross(&other).norm_squared() / correlations[0]
        };
        let sines: f64 = used.places.iter().map(sine).sum();
        let most = 2.0 * MAX_DEVIATIONS * sines.max(1.0).sqrt();
        let is_tested = sines > MIN_SINES || *share > MIN_NOISE_SHARE;
        if is_tested && (deviance(pair[0]) - deviance(pair[1])).abs() < most {
            criteria[index] = least;
        }
    }
    let equal = (0..criteria.len()).filter(|&one| criteria[one] == least);
    let chosen = equal
        .max_by_key(|&one| (shares[one] > MIN_NOISE_SHARE, one == best))
        .unwrap_or(best);
    let weights: Vec<f64> = criteria
        .iter()
        .map(|one| libm::exp(0.5 * (least - one)))
        .collect();
    let Candidate { solution, lack } = &candidates[chosen];
    let p_value = match lack.is_negligible {
        true => 1.0,
        false => wave_tests::of_distances(solution, used, lack.with_rounding[0]).min(lack.p_value),
    };
    let none = NONE_P_VALUE / p_value.max(f64::MIN_POSITIVE);
    let total = weights.iter().sum::<f64>() + none;
    let probabilities = std::array::from_fn(|one| weights.get(one).unwrap_or(&none) / total);
    (chosen, Some(probabilities))
}
