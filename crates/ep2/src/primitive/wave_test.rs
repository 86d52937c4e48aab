//! Tests whether the distances of contacts from a shape follow a wave along the surface. Polynomials do not describe
//! several periods of a wave, and a wave in few contacts looks like noise that is correlated along strokes.

use nalgebra::{Matrix2, Vector2, Vector3};
use palpate_statistics::ratio_tail;

use super::pose::{Cloud, Pose};

/// Largest number of contacts from which the wave is fitted.
const MAX_CONTACTS: usize = 300;
/// Largest number of periods of the wave along each side of the rectangle that contains the contacts.
const MAX_PERIODS: f64 = 6.0;
/// Differences between the numbers of periods of neighbouring waves. The waves of the first step cover all numbers of
/// periods. Those of each later step are neighbours of the best wave.
const STEPS: [f64; 3] = [0.5, 0.25, 0.125];
/// Number of fitted parameters of a wave: two amplitudes and two numbers of periods.
const PARAMETERS: usize = 4;

/// P-value of the best wave: the probability that noise fits one of the waves at least as well. `correlation` is the
/// number of consecutive contacts that count as one because their errors are correlated.
pub(super) fn p_value(pose: &Pose, cloud: &Cloud, correlation: f64) -> f64 {
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
        solved.map_or(0.0, |explained| explained.clamp(0.0, total))
    };
    let mut best = (0.0, Vector2::zeros());
    let mut waves = 0;
    for step in STEPS {
        let most = if waves == 0 {
            libm::round(MAX_PERIODS / step) as i32
        } else {
            1
        };
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
    let tail = ratio_tail(best.0, PARAMETERS, total - best.0, freedom as usize);
    (f64::from(waves) * tail).min(1.0)
}
