//! Intervals of the relative curvature by profile likelihood.

use super::minimise::minimise;
use super::problem::{CURVATURE, Problem, Square, State, Sums};
use crate::Interval;

/// Relative accuracy to which the root of chi-squared's rise meets the limit's at the ends of the interval.
const TOLERANCE: f64 = 3e-3;
/// Least decrease of chi-squared that a further step must promise.
const ENOUGH: f64 = 1e-4;
const MOST_TRIES: usize = 40;
/// The curvature is sought up to this many times its estimate, and down to one over that.
const FURTHEST: f64 = 1e6;

/// The interval, or a state that fits better than the one thought best.
pub(super) enum Profile {
    Interval(Interval),
    Better(State),
}

/// The interval in which chi-squared, made least over all other unknowns, lies less than `limit` above its least value.
pub(super) fn profile(
    problem: &Problem<'_>,
    best: &State,
    sums: &Sums,
    covariance: &Square,
    limit: f64,
) -> Profile {
    let mut ends = [None; 2];
    for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
        match walk(problem, best, sums, covariance, limit.sqrt(), sign) {
            Walk::End(log_curvature) => *end = Some(libm::exp(log_curvature)),
            Walk::Endless => {}
            Walk::Better(state) => return Profile::Better(state),
        }
    }
    let [low, high] = ends;
    Profile::Interval(Interval { low, high })
}

enum Walk {
    End(f64),
    Endless,
    Better(State),
}

fn walk(
    problem: &Problem<'_>,
    best: &State,
    sums: &Sums,
    covariance: &Square,
    limit: f64,
    sign: f64,
) -> Walk {
    let variance = covariance[(CURVATURE, CURVATURE)];
    let ridge = covariance.column(CURVATURE) / variance;
    let mut held = problem.clone();
    held.sought[CURVATURE] = false;
    // The root of chi-squared's rise at a step of the logarithm, beginning where the last one ended.
    let mut from = (*best, 0.0);
    let mut root_at = |step: f64| -> Option<Result<f64, State>> {
        let start = problem.moved(&from.0, &(ridge * (step - from.1)));
        let (state, least) = minimise(&held, start, ENOUGH).ok()?;
        from = (state, step);
        let rise = least.chi_squared - sums.chi_squared;
        if rise < -1e-6 * (1.0 + sums.chi_squared) {
            return Some(Err(state));
        }
        Some(Ok(rise.max(0.0).sqrt()))
    };
    let furthest = libm::log(FURTHEST);
    let mut step = (limit * variance.sqrt()).clamp(1e-12, 1.0);
    // Steps with the root there; no root where no press is possible.
    let mut inside = (0.0, 0.0);
    let mut outside: Option<(f64, Option<f64>)> = None;
    for _ in 0..MOST_TRIES {
        match root_at(sign * step) {
            Some(Err(state)) => return Walk::Better(state),
            Some(Ok(root)) if (root - limit).abs() <= TOLERANCE * limit => {
                return Walk::End(best.log_curvature + sign * step);
            }
            Some(Ok(root)) if root < limit => inside = (step, root),
            Some(Ok(root)) => outside = Some((step, Some(root))),
            // No press is possible there.
            None => outside = Some((step, None)),
        }
        step = match outside {
            Some((far, Some(root))) => {
                let share = (limit - inside.1) / (root - inside.1);
                inside.0 + (far - inside.0) * share.clamp(0.05, 0.95)
            }
            Some((far, None)) => 0.5 * (inside.0 + far),
            None if inside.0 >= furthest => return Walk::Endless,
            None => {
                let linear = inside.0 * limit / inside.1.max(0.1 * limit);
                linear.clamp(1.05 * inside.0, 4.0 * inside.0).min(furthest)
            }
        };
        let is_edge = |(far, root): (f64, Option<f64>)| {
            root.is_none() && (far - inside.0 < 1e-3 * far || far < 1e-6)
        };
        if outside.is_some_and(is_edge) {
            return Walk::Endless;
        }
        if outside.is_some_and(|(far, _)| far - inside.0 < 1e-12 * far) {
            return Walk::End(best.log_curvature + sign * inside.0);
        }
    }
    match outside {
        Some((far, Some(_))) => Walk::End(best.log_curvature + sign * far),
        Some((_, None)) | None => Walk::Endless,
    }
}
