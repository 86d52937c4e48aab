//! Intervals of the curvature and the radius of a fitted shape.

use palpate_statistics::student_half_width;

use super::cells::{Cells, Rounding};
use super::lack_of_fit::LackOfFit;
use super::pose::{CURVATURE, Cloud, Gram};
use super::robust_fit::Solution;

const PROBABILITY: f64 = 0.95;
/// The curvature counts as determined only if the half-width of its 95 % interval, divided by the curvature, is below
/// this value. At larger half-widths, the computed interval is narrower than a true 95 % interval.
const MAX_RELATIVE_HALF_WIDTH: f64 = 0.4;
/// If the p-value of the test for lack of fit is below this value, the interval of the curvature is widened to include
/// the lack of fit.
const MISFIT_P_VALUE: f64 = 0.01;
/// The curvature counts as determined only if the ratio of the noise to the spread of the contacts is at most this
/// value. If the noise is larger, errors of positions along the surface make the fitted radius too small.
pub(super) const MAX_RELATIVE_NOISE: f64 = 0.1;

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
    let grams = &solution.equations.grams;
    let weights = solution.weights();
    let [distances, normals] = [0, 1].map(|kind| {
        grams[kind] * (lack.correlations[kind] * weights[kind].powi(2) * solution.variances[kind])
    });
    let spread = distances + normals;
    let mut covariance =
        solution.inverse * spread * solution.inverse + rounding.covariance(solution, cloud);
    let mut half_width = student_half_width(PROBABILITY, freedom.clamp(1.0, 1e6) as usize);
    let mut widen = |other: Gram, wide: f64| {
        let variance = |covariance: &Gram| covariance[(CURVATURE, CURVATURE)];
        if wide * wide * variance(&other) > half_width * half_width * variance(&covariance) {
            (covariance, half_width) = (other, wide);
        }
    };
    if lack.p_value < MISFIT_P_VALUE
        && let Some(cells) = Cells::new(&solution.pose, cloud)
    {
        let freedom = cells.freedom(&solution.pose);
        let scale = cells.count() as f64 / freedom as f64;
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
    let relative = half / curvature.abs();
    let is_resolved = relative < MAX_RELATIVE_HALF_WIDTH
        && solution.variances[0] < MAX_RELATIVE_NOISE * MAX_RELATIVE_NOISE;
    let is_finite = std.is_finite() && ends.iter().all(|end| end.is_finite());
    is_finite.then_some(CurvatureInterval {
        std,
        ends,
        is_resolved,
        covariance,
    })
}
