//! Interval of the relative curvature by profile likelihood, from pictures.

use super::fitted::Fitted;
use super::law::State;
use super::minimise::minimise;
use super::problem::Problem;
use super::unknowns::{CURVATURE, INDENTATION, Unknowns};
use super::view::View;
use crate::Interval;
use crate::definite::solve;

/// Relative accuracy to which the root of chi-squared's rise meets the limit's.
const TOLERANCE: f64 = 0.02;
/// Least decrease of chi-squared that a further step must promise.
const ENOUGH: f64 = 1e-3;
const MOST_TRIES: usize = 24;
/// The logarithm of the curvature is sought so far from its estimate.
const FURTHEST: f64 = 7.0;

/// The interval in which chi-squared, made least over all other unknowns, lies less than `limit` squared above its
/// least value; or a state that fits better than the one thought best.
pub(super) fn profile<V: View>(
    problem: &Problem<'_, V>,
    best: &Fitted,
    std: f64,
    limit: f64,
) -> Result<Interval, State> {
    let mut ends = [None; 2];
    for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
        *end = walk(problem, best, std, limit, sign)?.map(libm::exp);
    }
    let [low, high] = ends;
    Ok(Interval { low, high })
}

/// Way along which all other unknowns follow the curvature.
fn ridge(best: &Fitted) -> Unknowns {
    let across = -best.sums.hessian.column(CURVATURE);
    let mut held = best.sums;
    held.hold(CURVATURE);
    let mut along = solve(&held.hessian, &across).unwrap_or_default();
    along[CURVATURE] = 1.0;
    along
}

fn walk<V: View>(
    problem: &Problem<'_, V>,
    best: &Fitted,
    std: f64,
    limit: f64,
    sign: f64,
) -> Result<Option<f64>, State> {
    let mut from = (best.clone(), ridge(best), 0.0);
    let mut at = |step: f64| -> Option<Result<f64, State>> {
        let way = from.1 * (sign * (step - from.2));
        let mut start = problem.stepped(&from.0.state, &way);
        // The depth follows a power of the curvature.
        start.indentation =
            from.0.state.indentation * libm::exp(way[INDENTATION] / from.0.state.indentation);
        let is_near = way[CURVATURE].abs() < 0.3;
        let start = if is_near {
            let residuals = problem.residuals(&start).ok()?;
            from.0.clone().near(problem, start, residuals).ok()?
        } else {
            Fitted::at(problem, start).ok()?
        };
        let found = minimise(problem, start, ENOUGH, Some(CURVATURE), is_near).ok()?;
        let rise = found.sums.chi_squared - best.sums.chi_squared;
        if rise < -0.05 {
            return Some(Err(found.state));
        }
        let along = ridge(&found);
        from = (found, along, step);
        Some(Ok(rise.max(0.0).sqrt()))
    };
    let mut step = (limit * std).clamp(1e-12, 1.0);
    let mut inside = (0.0, 0.0);
    let mut outside: Option<(f64, f64)> = None;
    for _ in 0..MOST_TRIES {
        match at(step) {
            Some(Err(state)) => return Err(state),
            Some(Ok(root)) => {
                if (root - limit).abs() <= TOLERANCE * limit {
                    let end = if root > 0.0 {
                        step * limit / root
                    } else {
                        step
                    };
                    return Ok(Some(best.state.log_curvature + sign * end));
                }
                if root < limit {
                    inside = (step, root);
                } else {
                    outside = Some((step, root));
                }
            }
            // No press is possible there.
            None => outside = Some((step, f64::INFINITY)),
        }
        step = match outside {
            Some((far, root)) if root.is_finite() => {
                let share = (limit - inside.1) / (root - inside.1);
                inside.0 + (far - inside.0) * share.clamp(0.05, 0.95)
            }
            Some((far, _)) => {
                if far - inside.0 < 0.02 * far || far < 1e-6 {
                    return Ok(None);
                }
                0.5 * (inside.0 + far)
            }
            None if inside.0 >= FURTHEST => return Ok(None),
            None => {
                let linear = inside.0 * limit / inside.1.max(0.1 * limit);
                linear.clamp(1.05 * inside.0, 4.0 * inside.0).min(FURTHEST)
            }
        };
    }
    Ok(match outside {
        Some((far, root)) if root.is_finite() => Some(best.state.log_curvature + sign * far),
        _ => None,
    })
}
