//! Intervals of the curvature and the radius of a fitted shape.

use palpate_statistics::student_half_width;

use super::cells::{Cells, Rounding};
use super::lack_of_fit::LackOfFit;
use super::pose::{CURVATURE, Cloud, Gram};
use super::robust_fit::Solution;

const PROBABILITY: f64 = 0.95;
/// The curvature counts as determined only if the half-width of its interval with the probability
/// [`STRICT_PROBABILITY`], divided by the curvature, is below this value. At larger half-widths, the computed 95 %
/// interval is narrower than a true one. With few contacts, chance may cause a large curvature and little noise.
const MAX_RELATIVE_HALF_WIDTH: f64 = 0.8;
const STRICT_PROBABILITY: f64 = 0.9999;
/// If the p-value of the test for lack of fit is below this value, the interval of the curvature is widened to include
/// the lack of fit.
const MISFIT_P_VALUE: f64 = 0.01;
/// The curvature counts as determined only if the ratio of the noise to the spread of the contacts is at most this
/// value. If the noise is larger, errors of positions along the surface make the fitted radius too small.
pub(super) const MAX_RELATIVE_NOISE: f64 = 0.1;
/// The contacts determine the curvature only if the share of noise in the information about the shape ([`noise_share`])
/// is at most this value.
const MAX_NOISE_SHARE: f64 = 0.1;
/// Smallest noise that [`noise_share`] assumes, relative to the spread of the contacts. Smaller noise may be a rounding
/// error.
const MIN_NOISE: f64 = 1e-5;

/// Interval of the curvature of a fitted shape, with the spread of the contacts as unit of length.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvatureInterval {
    pub(super) std: f64,
    pub(super) ends: [f64; 2],
    pub(super) is_resolved: bool,
    pub(super) covariance: Gram,
}

/// Computes the interval of the curvature; `None` if no degrees of freedom remain for the noise.
pub(super) fn curvature_interval(
    solution: &Solution,
    cloud: &Cloud,
    lack: &LackOfFit,
    rounding: &Rounding,
) -> Option<CurvatureInterval> {
    let freedom = solution.freedom?;
    let noise_share = noise_share(solution, cloud);
    if noise_share >= 1.0 {
        return None;
    }
    let mut grams = solution.equations.grams;
    let excess = solution.excess_across_axis();
    grams[1] += (grams[1] - solution.equations.axial_gram * 2.0) * excess;
    let weights = solution.weights();
    let [distances, normals] = [0, 1].map(|kind| {
        grams[kind] * (lack.correlations[kind] * weights[kind].powi(2) * solution.variances[kind])
    });
    let spread = distances + normals;
    let mut covariance =
        solution.inverse * spread * solution.inverse + rounding.covariance(solution, cloud);
    let width = |probability| student_half_width(probability, freedom.clamp(1.0, 1e6) as usize);
    let mut half_width = width(PROBABILITY);
    let stricter = width(STRICT_PROBABILITY) / half_width;
    let mut widen = |other: Gram, wide: f64| {
        let variance = |covariance: &Gram| covariance[(CURVATURE, CURVATURE)];
        if wide * wide * variance(&other) > half_width * half_width * variance(&covariance) {
            (covariance, half_width) = (other, wide);
        }
    };
    if lack.p_value < MISFIT_P_VALUE
        && let Some(cells) = Cells::new(&solution.pose, cloud)
    {
        let freedom = cells.count.saturating_sub(solution.pose.unknowns()).max(1);
        let scale = cells.count as f64 / freedom as f64;
        let wide = student_half_width(PROBABILITY, freedom);
        widen(cells.covariance(solution, cloud) * scale, wide);
    }
    // A scan may round a coordinate to a few values, called levels. The rounding errors on a level have all values
    // between plus and minus half a step. Therefore they nearly cancel in sums, except at the edge of the patch. These
    // errors are not a random sample. Therefore use the number of contacts, and not the number of levels, as degrees of
    // freedom.
    if let Some(levels) = rounding.levels(solution, cloud) {
        let wide = student_half_width(PROBABILITY, cloud.places.len());
        widen(levels.covariance(solution, cloud), wide);
    }
    let std = covariance[(CURVATURE, CURVATURE)].max(0.0).sqrt();
    let curvature = solution.pose.curvature;
    let half = half_width * std;
    let ends = [curvature - half, curvature + half];
    let relative = stricter * half / curvature.abs();
    let is_resolved = relative < MAX_RELATIVE_HALF_WIDTH
        && solution.variances[0] < MAX_RELATIVE_NOISE * MAX_RELATIVE_NOISE
        && noise_share < MAX_NOISE_SHARE;
    let is_finite = std.is_finite() && ends.iter().all(|end| end.is_finite());
    is_finite.then_some(CurvatureInterval {
        std,
        ends,
        is_resolved,
        covariance,
    })
}

/// The contacts determine the shape by their distances from it. Noise along the surface moves the contacts to places
/// with other distances, so it seems to determine parameters that the contacts do not determine, for example the radius
/// of a sphere through a ring of contacts. The result is the largest share of noise in the information about a
/// parameter, or about a combination of parameters.
pub(super) fn noise_share(solution: &Solution, cloud: &Cloud) -> f64 {
    let mut tilts = Gram::zeros();
    for place in &cloud.places {
        tilts += solution.pose.deviation(place, true).normal_gram();
    }
    tilts *= (MIN_NOISE * MIN_NOISE / solution.variances[0]).max(1.0);
    let share = solution.inverse.cholesky().map(|factor| {
        let root = factor.l();
        (root.transpose() * tilts * root)
            .symmetric_eigenvalues()
            .max()
    });
    share.unwrap_or(f64::INFINITY)
}
