//! Searches for the press that fits an image best, and computes the reported estimate.

use nalgebra::Vector3;
use palpate_statistics::NORMAL_95;

use super::fit_state::FitState;
use super::image_problem::{Problem, Residuals};
use super::view::{NUMBERS, SIZE, Seen, difference};
use super::{ImageFit, Rest};
use crate::least_squares::{LeastSquares, minimise};
use crate::outcome::{OfReadings, no_contact, outcome, until_best};
use crate::profile::profile;
use crate::unknowns::{CURVATURE, State};
use crate::{Estimated, GoodnessOfFit, Measured, PressError, PressEstimate};

/// Outlier threshold. A marker has four residuals (two for the centroid, one for the hue and one for the size), which
/// are transformed such that noise gives each of them unit variance. The marker is an outlier if the sum of their
/// squares is above this value. Noise alone causes this once in three million markers.
pub(super) const WRONG: f64 = 36.0;
/// Limit for the robust fit, which precedes the rejection of outliers. A marker has four residuals (two for the
/// centroid, one for the hue and one for the size), in standard deviations. The marker has a reduced weight if the sum
/// of their squares is above this value.
const ROBUST: f64 = 16.0;
/// Largest share of outliers among the markers. If there are more, the model is probably wrong, and no marker is
/// rejected.
const MAX_OUTLIER_SHARE: f64 = 1.0 / 8.0;
const ROUNDS: usize = 20;
const SENSOR_UPDATES: usize = 5;
/// Limit for the updates of the sensor parameters: they end if the next step of the fit is predicted to decrease
/// chi-squared by less than this value. A step of 1/20 standard error would decrease chi-squared by this value.
const SETTLED: f64 = 2.5e-3;
/// A contact counts as detected if it decreases chi-squared by at least this value, compared with no contact. A fit of
/// displacements with 240 markers has the same threshold. Fits of images usually have fewer markers, but each marker
/// has four noisy readings.
const MIN_IMPROVEMENT: f64 = 16.0;
/// Largest standard error of the logarithm of the curvature for which a bad fit still counts as a contact. If the
/// standard error is larger, the images are compatible with objects of any sharpness.
const MAX_LOG_STD: f64 = 10.0;
/// A preliminary fit, from whose result a more accurate fit starts, stops if the next step is predicted to decrease
/// chi-squared by less than this value.
const ROUGHLY: f64 = 1e-1;
const EXACTLY: f64 = 1e-6;

impl ImageFit {
    /// Estimates the press from the readings of one frame and from the sensor at rest. The reading of a marker that is
    /// not visible is `None`. For exact readings, the error of the most likely curvature is below 1/1000 of its
    /// standard error, if the standard error is smaller than the curvature.
    ///
    /// # Errors
    /// [`PressError::BadSetting`], [`PressError::NotFinite`], [`PressError::TooFewMarkers`] for invalid settings and
    /// readings; [`PressError::NoContact`] if the markers have not moved; [`PressError::OtherBody`] if the markers did
    /// not move as in a press on this body; [`PressError::OffMarkers`], [`PressError::Undetermined`] and errors of
    /// [`Body::press`](crate::Body::press) if no press fits the readings.
    pub fn estimate(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
    ) -> Result<PressEstimate, PressError> {
        self.check(rest, seen, indentation)?;
        let problem = Problem::new(self, rest, seen, indentation)?;
        problem.determined()?;
        search(problem)
    }
}

fn search(mut problem: Problem<'_>) -> Result<PressEstimate, PressError> {
    problem.weigh_at_rest()?;
    let mut best = robust(&mut problem)?;
    let wrong = drop_wrong(&mut problem, &best)?;
    if !wrong.is_empty() {
        best = problem.weigh(&best.state)?;
    }
    best = update_sensor(&mut problem, best)?;
    let weighed = best.clone();
    until_best(best, |best| {
        let best = minimise(&problem, best.keeping_slopes(), EXACTLY, None)?;
        let covariance = problem.covariance(&best.sums)?;
        let at_rest = problem.residuals_at_rest()?;
        let unmoved = problem.own_squares(&at_rest)?;
        let improvement = unmoved - best.sums.chi_squared;
        if improvement < MIN_IMPROVEMENT {
            return Err(problem.no_contact(improvement));
        }
        let std = covariance[(CURVATURE, CURVATURE)].sqrt();
        let goodness = problem.goodness(&best);
        let noise = goodness.chi_squared / goodness.freedom.max(1) as f64;
        if goodness.is_poor() && (improvement < MIN_IMPROVEMENT * noise || std > MAX_LOG_STD) {
            return Err(PressError::OtherBody {
                chi_squared: goodness.chi_squared,
                freedom: goodness.freedom,
            });
        }
        let interval = match profile(&problem, &best, NORMAL_95 * NORMAL_95) {
            Ok(interval) => interval,
            Err(better) => return Ok(Err(problem.fit_at(better)?)),
        };
        let contact = problem.contact(&best.state)?;
        problem
            .fit
            .markers
            .see_around(&best.state.place, contact.radius)?;
        if best.is_stuck() {
            return Err(PressError::Undetermined {
                what: "the sum of squared residuals has no clear minimum",
            });
        }
        // `factor` corrects the bias of the most likely curvature. The ends of the interval are multiplied by the same
        // factor.
        let factor = libm::exp(problem.mean_beside(&weighed, &covariance));
        let unbiased = contact.relative_curvature * factor;
        let readings = OfReadings {
            relative_curvature: Estimated {
                value: unbiased,
                std: unbiased * std,
                interval: interval.map(|end| end * factor),
            },
            baseline: None,
            gain: None,
            wrong_markers: wrong.clone(),
            normal_std: best.normal_std(),
            tangential_std: None,
            r_squared: 1.0 - best.sums.chi_squared / unmoved.max(f64::MIN_POSITIVE),
            goodness: Some(goodness),
        };
        let fit = (&best.state, &best.sums);
        outcome(&problem, fit, &covariance, NORMAL_95, readings).map(Ok)
    })
}

/// The best fit near the fit parameters `near`. The sensor parameters are fitted to both frames (at rest and pressed).
pub(super) fn settle(problem: &mut Problem<'_>, near: State) -> Result<FitState, PressError> {
    let near = problem.weigh(&near)?;
    let near = update_sensor(problem, near)?;
    minimise(problem, near.keeping_slopes(), EXACTLY, None)
}

/// Repeats two steps until the fit converges: fit the press, then update the sensor parameters with both frames (at
/// rest and pressed).
fn update_sensor(problem: &mut Problem<'_>, near: FitState) -> Result<FitState, PressError> {
    let mut best = near;
    for _ in 0..SENSOR_UPDATES {
        best = minimise(problem, best.keeping_slopes(), 0.1 * SETTLED, None)?;
        let before = problem.clone();
        let is_possible = problem.update_sensor(&best)?;
        match problem.weigh(&best.state) {
            Ok(fitted) if is_possible => best = fitted,
            _ => {
                // The updated sensor parameters are impossible, so restore the previous parameters.
                *problem = before;
                break;
            }
        }
        if best.promise() < SETTLED {
            break;
        }
    }
    Ok(best)
}

fn robust(problem: &mut Problem<'_>) -> Result<FitState, PressError> {
    let starts = problem.starts()?;
    let mut best: Option<FitState> = None;
    let mut failure = problem.no_contact(0.0);
    for start in starts.into_iter().take(3) {
        let fitted = problem
            .fit_at(start)
            .and_then(|fitted| minimise(problem, fitted, ROUGHLY, None));
        match fitted {
            Ok(fitted) => {
                let is_good = fitted.sums.chi_squared < 2.0 * problem.equations() as f64;
                let is_better = best
                    .as_ref()
                    .is_none_or(|best| fitted.sums.chi_squared < best.sums.chi_squared);
                if is_better {
                    best = Some(fitted);
                }
                if is_good {
                    break;
                }
            }
            Err(error) => failure = error,
        }
    }
    let near = best.ok_or(failure)?;
    let near = problem.weigh(&near.state)?;
    let mut best = minimise(problem, near.keeping_slopes(), ROUGHLY, None)?;
    // Outliers may cause a bad fit. Before the fit is rejected, repeat it with smaller weights for the markers with
    // large residuals.
    let mut is_weighed = false;
    for _ in 0..ROUNDS {
        let squares = problem.squares(&best.residuals)?;
        let mut is_new = false;
        for (trust, square) in problem.trust.iter_mut().zip(&squares) {
            let square = square / (*trust * *trust);
            let before = *trust;
            *trust = if square > ROBUST {
                (ROBUST / square).sqrt().max(1e-6)
            } else {
                1.0
            };
            is_new |= (*trust - before).abs() > 0.02 * before;
        }
        if !is_new {
            break;
        }
        let weighed = problem.weigh(&best.state)?;
        best = minimise(problem, weighed.keeping_slopes(), ROUGHLY, None)?;
        is_weighed = true;
    }
    if is_weighed {
        problem.trust.fill(1.0);
        best = problem.weigh(&best.state)?;
    }
    Ok(best)
}

fn drop_wrong(problem: &mut Problem<'_>, best: &FitState) -> Result<Vec<usize>, PressError> {
    let squares = problem.squares(&best.residuals)?;
    let most = (MAX_OUTLIER_SHARE * squares.len() as f64).max(1.0) as usize;
    let pairs = problem.counting.iter().zip(&squares);
    let wrong: Vec<usize> = pairs
        .filter(|(_, square)| **square > WRONG)
        .map(|(marker, _)| *marker)
        .collect();
    let enough = NUMBERS * (squares.len() - wrong.len()) >= problem.fitted.count();
    if wrong.len() > most || !enough {
        return Ok(Vec::new());
    }
    problem.leave_out(&wrong);
    Ok(wrong)
}

impl Problem<'_> {
    fn goodness(&self, fitted: &FitState) -> GoodnessOfFit {
        GoodnessOfFit::new(fitted.sums.chi_squared, self.freedom())
    }

    fn no_contact(&self, improvement: f64) -> PressError {
        let at_rest = self.residuals_at_rest();
        match at_rest.and_then(|at_rest| self.squares(&at_rest)) {
            Ok(squares) => no_contact((improvement, MIN_IMPROVEMENT), squares.into_iter(), NUMBERS),
            Err(error) => error,
        }
    }

    /// For each used marker, the sum of its squared residuals. The part of the residuals that a change of the sensor's
    /// parameters could explain is subtracted before the squares are computed.
    pub(super) fn squares(&self, residuals: &Residuals) -> Result<Vec<f64>, PressError> {
        let own = self.own(residuals)?;
        Ok((0..self.counting.len())
            .map(|at| own.rows(NUMBERS * at, NUMBERS).norm_squared())
            .collect())
    }
}

/// Contact radii that are tried for the start values, relative to the sensor's radius.
const RADII: [f64; 4] = [0.08, 0.14, 0.22, 0.35];
/// Number of markers at which start values of the contact are tried, in addition to the middle of the displaced
/// markers. They are the markers that moved most.
const BESIDE: usize = 2;

impl Problem<'_> {
    /// Start values of the fit, sorted from the most to the least likely.
    pub(super) fn starts(&self) -> Result<Vec<State>, PressError> {
        let skin = self.fit.markers.skin();
        let at_rest = &self.rest.slopes.pictures;
        // If the camera is in the sensor's centre, the relative growth of a disc's image equals the relative decrease
        // of its distance. The growth therefore measures the inward displacement.
        let mut inward: Vec<(f64, usize)> = Vec::new();
        for &marker in &self.counting {
            if let (Some(seen), Some(rest)) = (&self.seen[marker], &at_rest[marker]) {
                let growth = 0.5 * difference(&seen.picture, rest)[SIZE];
                inward.push((-skin.radius() * libm::expm1(-growth), marker));
            }
        }
        inward.sort_by(|one, other| other.0.total_cmp(&one.0));
        let Some(&(most, _)) = inward.first() else {
            return Ok(Vec::new());
        };
        let places = self.fit.markers.places();
        let direction = |marker: usize| *places[marker].direction.as_ref();
        let among = inward.iter().filter(|(moved, _)| *moved > 0.4 * most);
        let mean: Vector3<f64> = among
            .map(|&(moved, marker)| direction(marker) * (moved * moved))
            .sum();
        let known = self.indentation.map(|known| known.value);
        let deepest = known.unwrap_or(1.15 * most);
        let state = |direction: &Vector3<f64>, share: f64| {
            let [unit, _] = self.fit.bodies[0]
                .indentation_of(share * skin.radius())
                .ok()?;
            let state = State::new(deepest / unit, skin.place_at(direction), deepest, [0.0; 2]);
            let residuals = self.residuals(&state).ok()?;
            Some((self.cost(&state, &residuals).ok()?, share, state))
        };
        let mut states: Vec<_> = RADII
            .iter()
            .filter_map(|&share| state(&mean, share))
            .collect();
        // Also start with contacts at the markers that moved most. These contacts have the radius of the best start
        // value so far.
        let best = states.iter().min_by(|one, other| one.0.total_cmp(&other.0));
        if let Some(&(_, width, _)) = best {
            let beside = inward.iter().take(BESIDE);
            states.extend(beside.filter_map(|one| state(&direction(one.1), width)));
        }
        states.sort_by(|one, other| one.0.total_cmp(&other.0));
        Ok(states.into_iter().map(|(_, _, state)| state).collect())
    }
}
