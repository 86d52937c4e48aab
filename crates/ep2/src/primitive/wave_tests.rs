//! Two tests whether the contacts are on a wavy surface instead of the fitted shape. They are needed in addition to the
//! test for lack of fit, whose polynomials cannot describe several periods of a wave. In addition, if there are few
//! contacts, a wave looks like noise that is correlated along strokes.

use nalgebra::{Matrix2, Vector2, Vector3};
use palpate_statistics::ratio_tail;

use super::pose::{Cloud, Pose};
use super::robust_fit::Solution;
use crate::patch::FingerMap;

/// Largest number of contacts from which the wave is fitted.
const MAX_CONTACTS: usize = 300;
/// Steps of the search for the best wave. Each step compares the waves of a grid; the first number is the spacing of
/// the grid, and the second the number of grid points on each side of its middle. The spacing is a number of periods
/// along a side of the rectangle that contains the contacts. The first grid extends to 6 periods. The later grids are
/// around the best wave so far.
const STEPS: [(f64, i32); 3] = [(0.5, 12), (0.25, 1), (0.125, 1)];
/// A wave is significant only if it explains at least this share of the contacts' sum of squared distances from the
/// shape. On a regular grid, rounding errors of the coordinates also look like waves, but these waves are weaker.
const MIN_SHARE: f64 = 0.5;
/// Number of fitted parameters of a wave: two amplitudes and two numbers of periods.
const PARAMETERS: usize = 4;
/// Distances and normals are compared in pairs of neighbouring blocks of contacts along a stroke. The comparison needs
/// at least this number of pairs.
const MIN_PAIRS: usize = 6;

/// P-value of the best wave: the probability that for noise alone, one of the tried waves fits the distances at least
/// as well. `correlation` is the number of consecutive contacts that count as one because their errors are correlated.
pub(super) fn of_distances(solution: &Solution, cloud: &Cloud, correlation: f64) -> f64 {
    let pose = &solution.pose;
    let thinned = cloud.thinned(MAX_CONTACTS);
    let independent = (cloud.places.len() as f64 / correlation).min(thinned.places.len() as f64);
    let freedom = independent - (pose.unknowns() + PARAMETERS) as f64;
    if freedom < 1.0 {
        return 1.0;
    }
    let distances: Vec<f64> = thinned
        .places
        .iter()
        .map(|place| pose.distance(place))
        .collect();
    let total: f64 = distances.iter().map(|one| one * one).sum();
    let foot = |(place, distance): (&Vector3<f64>, &f64)| {
        (pose.axes * (place - pose.normal_at(place) * *distance - pose.point)).xy()
    };
    let feet: Vec<Vector2<f64>> = thinned.places.iter().zip(&distances).map(foot).collect();
    let fold =
        |choose: fn(f64, f64) -> f64| feet.iter().copied().reduce(|a, b| a.zip_map(&b, choose));
    let (Some(low), Some(high)) = (fold(f64::min), fold(f64::max)) else {
        return 1.0;
    };
    let sides = (high - low).map(|side| side.max(f64::MIN_POSITIVE));
    let turns: Vec<Vector2<f64>> = feet
        .iter()
        .map(|foot| (foot - low).component_div(&sides) * std::f64::consts::TAU)
        .collect();
    let explained = |periods: Vector2<f64>| {
        let (mut gram, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for (turns, distance) in turns.iter().zip(&distances) {
            let (sin, cos) = libm::sincos(turns.dot(&periods));
            let row = Vector2::new(cos, sin);
            gram += row * row.transpose();
            right += row * *distance;
        }
        // A wave that is zero at all contacts explains nothing.
        let solved = gram
            .try_inverse()
            .map(|inverse| right.dot(&(inverse * right)));
        solved.map_or(0.0, |explained| explained.min(total))
    };
    let mut best = (0.0, Vector2::zeros());
    let mut waves = 0;
    for (step, most) in STEPS {
        let middle = best.1;
        for along in -most..=most {
            for across in (if waves == 0 { 0 } else { -most })..=most {
                let periods = middle + Vector2::new(f64::from(along), f64::from(across)) * step;
                let found = explained(periods);
                if found > best.0 {
                    best = (found, periods);
                }
            }
        }
        waves = waves.max((2 * most + 1) * (most + 1));
    }
    if best.0 < MIN_SHARE * total {
        return 1.0;
    }
    // On exact contacts, the distances are rounding errors, which may follow a wave.
    let left = (total - best.0).max(solution.least_variance * distances.len() as f64);
    let tail = ratio_tail(best.0, PARAMETERS, left, freedom as usize);
    (f64::from(waves) * tail).min(1.0)
}

/// Compares the distances and the normals of contacts along strokes. The noise of positions and the noise of normals
/// are independent of each other. On a surface of another shape, however, the distances change along a stroke as the
/// tilt of the normals predicts. The result is a p-value: the probability that distances and normals with independent
/// noise agree at least as well. `fingers` contains the number of the finger of each contact.
pub(super) fn of_slopes(pose: &Pose, cloud: &Cloud, fingers: &[usize]) -> f64 {
    // For each contact of a stroke: its distance from the shape, and its height above the shape according to the
    // normals. This height is the integral of the normals' tilt along the stroke.
    let mut strokes: FingerMap<Vec<[f64; 2]>> = FingerMap::default();
    let mut last: FingerMap<Option<[Vector3<f64>; 2]>> = FingerMap::default();
    for ((place, normal), &finger) in cloud.places.iter().zip(&cloud.normals).zip(fingers) {
        let tilt = normal - pose.normal_at(place);
        let stroke = strokes.entry(finger);
        let before = last.entry(finger).replace([*place, tilt]);
        let height = before
            .zip(stroke.last())
            .map(|([from, other], [_, height])| height - 0.5 * (tilt + other).dot(&(place - from)));
        stroke.push([pose.distance(place), height.unwrap_or(0.0)]);
    }
    let (mut smallest, mut scales) = (1.0_f64, 0.0);
    for size in (0..).map(|power| 1 << power) {
        let (mut sums, mut pairs) = ([0.0; 3], 0);
        for stroke in strokes.iter() {
            let mean = |block: &[[f64; 2]]| {
                [0, 1].map(|kind| block.iter().map(|one| one[kind]).sum::<f64>() / size as f64)
            };
            let means: Vec<[f64; 2]> = stroke.chunks_exact(size).map(mean).collect();
            for pair in means.windows(2) {
                let [x, y] = [0, 1].map(|kind| pair[1][kind] - pair[0][kind]);
                sums = [sums[0] + x * x, sums[1] + x * y, sums[2] + y * y];
                pairs += 1;
            }
        }
        if pairs < MIN_PAIRS {
            break;
        }
        scales += 1.0;
        let [squares, products, of_normals] = sums;
        if products > 0.0 {
            let explained = products * products / of_normals;
            let left = (squares - explained).max(0.0);
            smallest = smallest.min(0.5 * ratio_tail(explained, 1, left, pairs - 1));
        }
    }
    (scales * smallest).clamp(0.0, 1.0)
}
