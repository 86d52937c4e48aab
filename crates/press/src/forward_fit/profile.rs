//! Intervals of the relative curvature by profile likelihood.

use super::minimise;
use super::problem::{Problem, State};
use crate::Interval;
use crate::unknowns::{CURVATURE, INDENTATION, Sums};

/// Relative tolerance of the square root of chi-squared's increase at the end of an interval; the end is then interpolated.
const TOLERANCE: f64 = 0.03;
/// Least predicted decrease of chi-squared for a further step.
const ENOUGH: f64 = 1e-4;
const MAX_TRIES: usize = 40;
/// Largest ratio of a curvature to its estimate, or of the estimate to a curvature, in the search.
const MAX_RATIO: f64 = 1e6;

/// The interval, or a state with a smaller chi-squared than the supposed best one.
pub(super) enum Profile {
    Interval(Interval),
    Better(State),
}

/// The interval in which chi-squared, minimised over all other unknowns, is less than `limit` above its minimum.
pub(super) fn profile(problem: &Problem<'_>, best: &State, sums: &Sums, limit: f64) -> Profile {
    let mut ends = [None; 2];
    for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
        match walk(problem, best, sums, limit.sqrt(), sign) {
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

/// A step of the logarithm of the curvature, the square root of chi-squared's increase there, and the derivative of the step by
/// the root.
#[derive(Clone, Copy)]
struct Found {
    step: f64,
    root: f64,
    per_root: f64,
}

impl Found {
    /// The step at another root, by the cubic polynomial through two points with their derivatives.
    fn through(self, other: Self, root: f64) -> f64 {
        let width = other.root - self.root;
        let share = (root - self.root) / width;
        let rest = 1.0 - share;
        let slopes = rest * self.per_root - share * other.per_root;
        let ends = (1.0 + 2.0 * share) * rest * rest * self.step
            + (1.0 + 2.0 * rest) * share * share * other.step;
        ends + share * rest * width * slopes
    }
}

fn walk(problem: &Problem<'_>, best: &State, sums: &Sums, limit: f64, sign: f64) -> Walk {
    // The state at the last step, the derivative of the unknowns there, and the step.
    let mut from = (*best, sums.ridge(), 0.0);
    let std = (sums.hessian.row(CURVATURE) * from.1)[0].sqrt().recip();
    let mut at = |step: f64| -> Option<Result<Found, State>> {
        let way = from.1 * (sign * (step - from.2));
        let mut start = problem.moved(&from.0, &way);
        // The indentation is extrapolated as a power of the curvature.
        start.indentation = from.0.indentation * libm::exp(way[INDENTATION] / from.0.indentation);
        let (state, least) = minimise(problem, start, ENOUGH, Some(CURVATURE)).ok()?;
        from = (state, least.ridge(), step);
        let rise = |sums: &Sums, least: f64| least - sums.chi_squared;
        let is_less = |rise: f64| rise < -1e-6 * (1.0 + sums.chi_squared);
        let found = rise(sums, least.chi_squared);
        // The minimum is a prediction, so check it by the true chi-squared.
        if is_less(found) && is_less(rise(sums, problem.sums(&state).ok()?.chi_squared)) {
            return Some(Err(state));
        }
        let root = found.max(0.0).sqrt();
        let per_root = root / (sign * least.gradient[CURVATURE]);
        Some(Ok(Found {
            step,
            root,
            per_root,
        }))
    };
    let furthest = libm::log(MAX_RATIO);
    let mut step = (limit * std).clamp(1e-12, 1.0);
    let mut inside = Found {
        step: 0.0,
        root: 0.0,
        per_root: std,
    };
    // The smallest step beyond the end, with the result there; `None` if no press is possible.
    let mut outside: Option<(f64, Option<Found>)> = None;
    for _ in 0..MAX_TRIES {
        let mut last = inside;
        match at(step) {
            Some(Err(state)) => return Walk::Better(state),
            Some(Ok(found)) if (found.root - limit).abs() <= TOLERANCE * limit => {
                // The slopes are useless if the profile is almost flat.
                let guess = inside.through(found, limit);
                let is_near = (guess - step).abs() <= 0.1 * step;
                let end = if is_near { guess } else { step };
                return Walk::End(best.log_curvature + sign * end);
            }
            Some(Ok(found)) if found.root < limit => inside = found,
            Some(Ok(found)) => outside = Some((step, Some(found))),
            // No press is possible there.
            None => outside = Some((step, None)),
        }
        if let Some((_, Some(found))) = outside {
            last = found;
        }
        let guess = inside.through(last, limit);
        let or_linear = |linear: f64| if guess.is_finite() { guess } else { linear };
        step = match outside {
            Some((far, Some(found))) => {
                let share = (limit - inside.root) / (found.root - inside.root);
                let at = |share: f64| inside.step + (far - inside.step) * share;
                or_linear(at(share)).clamp(at(0.05), at(0.95))
            }
            Some((far, None)) => 0.5 * (inside.step + far),
            None if inside.step >= furthest => return Walk::Endless,
            None => {
                let linear = inside.step * limit / inside.root.max(0.1 * limit);
                let near = 1.05 * inside.step;
                or_linear(linear)
                    .clamp(near, 4.0 * inside.step)
                    .min(furthest)
            }
        };
        if let Some((far, found)) = outside {
            let gap = far - inside.step;
            if found.is_none() && (gap < 0.02 * far || far < 1e-6) {
                return Walk::Endless;
            }
            if gap < 1e-12 * far {
                return Walk::End(best.log_curvature + sign * inside.step);
            }
        }
    }
    match outside {
        Some((far, Some(_))) => Walk::End(best.log_curvature + sign * far),
        Some((_, None)) | None => Walk::Endless,
    }
}
