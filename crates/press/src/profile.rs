//! Computes intervals of the relative curvature by profile likelihood.

use crate::Interval;
use crate::least_squares::{LeastSquares, minimise};
use crate::unknowns::{CURVATURE, INDENTATION, State};

/// Relative tolerance of the search for an end of the interval. At the end, chi-squared exceeds its minimum by the
/// limit of the confidence interval. The search stops if the square root of this excess is correct within the
/// tolerance. An interpolation then improves the end.
const TOLERANCE: f64 = 0.03;
const MAX_TRIES: usize = 40;
/// Limit of the search for the ends of an interval: largest ratio between a tried curvature and the estimated
/// curvature, in either direction.
const MAX_RATIO: f64 = 1e6;

/// The interval of the relative curvature. For each curvature, chi-squared is minimised with respect to all other fit
/// parameters. The curvature is in the interval if this minimum exceeds the overall minimum by less than `limit`. If
/// the search finds fit parameters with a clearly smaller chi-squared than `best`, the function returns these
/// parameters as the error. The caller can then start a new fit from them.
pub(crate) fn profile<P: LeastSquares>(
    problem: &P,
    best: &P::Fit,
    limit: f64,
) -> Result<Interval, State> {
    let end = |sign| Ok(walk(problem, best, limit.sqrt(), sign)?.map(libm::exp));
    Ok(Interval {
        low: end(-1.0)?,
        high: end(1.0)?,
    })
}

/// A step of the logarithm of the curvature from the best fit. `root` is the square root of the increase of chi-squared
/// after this step, and `per_root` the derivative of the step with respect to `root`.
#[derive(Clone, Copy)]
struct Found {
    step: f64,
    root: f64,
    per_root: f64,
}

impl Found {
    /// The step at which the square root of the increase of chi-squared is `root`. It is interpolated by a cubic
    /// polynomial between the steps `self` and `other`, from their values and derivatives.
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

/// Searches one end of the interval of the curvature, and returns the logarithm of the curvature at this end. Returns
/// `None` if the interval has no end on this side.
fn walk<P: LeastSquares>(
    problem: &P,
    best: &P::Fit,
    limit: f64,
    sign: f64,
) -> Result<Option<f64>, State> {
    let (start, sums) = (P::state_of(best), P::sums_of(best));
    // `from` describes the last tried step: the fit after the step, the derivative of the fit parameters with respect
    // to the logarithm of the curvature, and the length of the step.
    let mut from = (best.clone(), sums.ridge(), 0.0);
    let std = (sums.hessian.row(CURVATURE) * from.1)[0].sqrt().recip();
    let mut at = |step: f64| -> Option<Result<Found, State>> {
        let way = from.1 * (sign * (step - from.2));
        let last = P::state_of(&from.0);
        let mut state = problem.stepped(last, &way);
        // The indentation must stay positive. Therefore extrapolate its logarithm linearly, not the indentation itself.
        state.indentation = last.indentation * libm::exp(way[INDENTATION] / last.indentation);
        let near = problem.fit_near(&from.0, state, way[CURVATURE]).ok()?;
        let fit = minimise(problem, near, P::ENOUGH_OF_PROFILE, Some(CURVATURE)).ok()?;
        let least = P::sums_of(&fit);
        let root = (least.chi_squared - sums.chi_squared).max(0.0).sqrt();
        let per_root = root / (sign * least.gradient[CURVATURE]);
        let ridge = least.ridge();
        if problem.is_better(&fit, best) {
            return Some(Err(*P::state_of(&fit)));
        }
        from = (fit, ridge, step);
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
    // `outside` is the smallest tried step beyond the end of the interval, with the fit at this step. The fit is `None`
    // if no press is possible with this curvature.
    let mut outside: Option<(f64, Option<Found>)> = None;
    for _ in 0..MAX_TRIES {
        let mut last = inside;
        match at(step) {
            Some(Err(state)) => return Err(state),
            Some(Ok(found)) if (found.root - limit).abs() <= TOLERANCE * limit => {
                // Use the interpolated step only if it is near the step that was tried. If chi-squared hardly changes
                // with the curvature, the interpolation is wrong.
                let guess = inside.through(found, limit);
                let is_near = (guess - step).abs() <= 0.1 * step;
                let end = if is_near { guess } else { step };
                return Ok(Some(start.log_curvature + sign * end));
            }
            Some(Ok(found)) if found.root < limit => inside = found,
            Some(Ok(found)) => outside = Some((step, Some(found))),
            // No press is possible at this step, so the interval ends before this step.
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
            None if inside.step >= furthest => return Ok(None),
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
                return Ok(None);
            }
            if gap < 1e-12 * far {
                return Ok(Some(start.log_curvature + sign * inside.step));
            }
        }
    }
    Ok(match outside {
        Some((far, Some(_))) => Some(start.log_curvature + sign * far),
        Some((_, None)) | None => None,
    })
}
