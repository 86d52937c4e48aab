//! The press behind pictures, and the estimate that is reported of it.

use palpate_statistics::NORMAL_95;

use super::fitted::Fitted;
use super::law::State;
use super::minimise::minimise;
use super::problem::Problem;
use super::profile::profile;
use super::rest::Rest;
use super::settings::ImageFit;
use super::unknowns::{ACROSS, ALONG, CURVATURE, INDENTATION, Residuals, Square};
use super::view::{NUMBERS, Seen, View};
use crate::definite::inverse;
use crate::unexplained::unexplained;
use crate::{Estimated, GoodnessOfFit, Interval, Measured, PressError, PressEstimate, Verdict};

/// Least entry on the diagonal of the scaled factor of information that can be inverted.
pub(super) const SINGULAR: f64 = 1e-6;
/// Sum of the squares of a marker's four residuals beyond which it is wrong: chance brings one in three million.
pub(super) const WRONG: f64 = 36.0;
/// Sum of squares beyond which a marker counts less while it is not known which are wrong.
const ROBUST: f64 = 16.0;
/// Largest share of the markers that can be wrong; if more seem so, the model is.
const MOST_WRONG: f64 = 1.0 / 8.0;
/// Rounds in which markers that count less are told.
const ROUNDS: usize = 20;
/// Rounds in which the sensor is told by both frames.
const LEARNT: usize = 5;
/// Fall of chi-squared by a step about a sensor that was just learnt, below which the next would change nothing that counts: a
/// twentieth of a standard deviation, of which the next would be a small part.
const SETTLED: f64 = 2.5e-3;
/// Least improvement of chi-squared by a contact, against none, that counts as one: what displacements of 240 markers need, since
/// chance may move each number of a marker's picture.
const SEEN: f64 = 16.0;
/// Standard deviation of the logarithm of the curvature from which on pictures leave any needle.
const ANY: f64 = 10.0;
/// Least decrease of chi-squared that a further step must promise: roughly, and at last.
const ROUGHLY: f64 = 1e-1;
const EXACTLY: f64 = 1e-6;

impl<V: View + Clone> ImageFit<V> {
    /// The press behind the pictures of one frame, `None` for markers that are not seen, of a sensor whose markers at
    /// rest are known. Of pictures without error, of any size and stated to be exact or not, the likeliest curvature is right
    /// to a thousandth of its standard deviation, where that is less than the curvature.
    ///
    /// # Errors
    /// [`PressError::BadSetting`], [`PressError::NotFinite`], [`PressError::TooFewMarkers`] for what is given;
    /// [`PressError::NoContact`] where the markers are as at rest; [`PressError::OtherBody`] where they moved otherwise than in
    /// any press of this body; [`PressError::OffMarkers`],
    /// [`PressError::Undetermined`] and those of [`Body::press`](crate::Body::press) where the pictures fit no press.
    pub fn estimate(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
    ) -> Result<PressEstimate, PressError> {
        self.check(rest, seen, indentation)?;
        let problem = Problem::new(self, rest, seen, indentation)?;
        let (equations, needed) = (problem.equations(), problem.unknowns());
        if equations < needed {
            return Err(PressError::TooFewMarkers {
                markers: problem.counting.len(),
                equations,
                needed,
            });
        }
        search(problem)
    }
}

impl<V: View> ImageFit<V> {
    /// Refuses what cannot be given to a fit.
    pub(super) fn check(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
    ) -> Result<(), PressError> {
        self.validate()?;
        let markers = self.markers.places().len();
        for given in [seen.len(), rest.seen.len()] {
            let good = given == markers;
            PressError::unless_good("readings", given as f64, good, "one for each marker")?;
        }
        let told = rest.information.nrows();
        let expected = "as many departures that are not exact as the fit has that is told it";
        PressError::unless_good("rest", told as f64, told == self.free().len(), expected)?;
        for (marker, seen) in seen.iter().enumerate() {
            if let Some(seen) = seen {
                seen.check(marker)?;
            }
        }
        if let Some(Measured { value, std }) = indentation {
            let good = (0.0..=1e100).contains(&std);
            PressError::unless_good("indentation_std", std, good, "at least 0 and at most 1e100")?;
            if !value.is_finite() {
                return Err(PressError::OutOfRange);
            }
            if value <= 0.0 {
                return Err(PressError::NoIndentation { indentation: value });
            }
        }
        Ok(())
    }
}

impl<V: View + Clone> ImageFit<V> {
    /// The Cramér–Rao bound on the standard deviation of the relative curvature, 1/length, by the errors that are stated of
    /// the markers and of the sensor: of a press of this relative curvature, at these chart coordinates and this deep, that
    /// these pictures show.
    ///
    /// # Errors
    /// [`PressError::Undetermined`] where the pictures do not tell the press, and those of
    /// [`Body::press`](crate::Body::press).
    pub fn std_bound(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
        (curvature, at, depth): (f64, [f64; 2], f64),
    ) -> Result<f64, PressError> {
        self.check(rest, seen, indentation)?;
        let good = curvature > 0.0 && curvature <= 1e50;
        PressError::unless_good("curvature", curvature, good, "> 0 and at most 1e50")?;
        if !(at.iter().all(|along| along.abs() <= 1e50) && depth > 0.0 && depth <= 1e50) {
            return Err(PressError::OutOfRange);
        }
        let mut problem = Problem::new(self, rest, seen, indentation)?;
        let state = State {
            log_curvature: libm::log(curvature),
            place: self.markers.skin().place(at),
            indentation: depth,
            shift: [0.0; 2],
        };
        let sums = problem.weigh(&state)?.sums;
        let covariance = inverse(&sums.hessian, SINGULAR).ok_or(PressError::Undetermined {
            what: "some combination of curvature, place and indentation is free",
        })?;
        Ok(curvature * covariance[(CURVATURE, CURVATURE)].sqrt())
    }
}

fn search<V: View + Clone>(mut problem: Problem<'_, V>) -> Result<PressEstimate, PressError> {
    problem.weigh_at_rest()?;
    let mut best = robust(&mut problem)?;
    let wrong = drop_wrong(&mut problem, &best)?;
    if !wrong.is_empty() {
        best = problem.weigh(&best.state)?;
    }
    best = learn(&mut problem, best)?;
    let weighed = best.clone();
    for _ in 0..4 {
        best = minimise(&problem, best, EXACTLY, None, true)?;
        let covariance = inverse(&best.sums.hessian, SINGULAR).ok_or(PressError::Undetermined {
            what: "some combination of curvature, place and indentation is free",
        })?;
        let at_rest = problem.residuals_at_rest()?;
        let unmoved = problem.own_squares(&at_rest)?;
        let improvement = unmoved - best.sums.chi_squared;
        if improvement < SEEN {
            return Err(problem.unexplained(improvement));
        }
        let std = covariance[(CURVATURE, CURVATURE)].sqrt();
        let goodness = problem.goodness(&best);
        let noise = goodness.chi_squared / goodness.freedom.max(1) as f64;
        if goodness.is_doubted() && (improvement < SEEN * noise || std > ANY) {
            return Err(PressError::OtherBody {
                chi_squared: goodness.chi_squared,
                freedom: goodness.freedom,
            });
        }
        match profile(&problem, &best, std, NORMAL_95) {
            Ok(interval) => {
                let reached = problem.fit.contact(&problem.fit.bodies[0], &best.state)?;
                problem.fit.markers.see(&best.state.place, reached.radius)?;
                if best.is_stuck() {
                    break;
                }
                return outcome(
                    &problem,
                    (&weighed, &best),
                    &covariance,
                    interval,
                    unmoved,
                    wrong,
                );
            }
            Err(better) => best = Fitted::at(&problem, better)?,
        }
    }
    Err(PressError::Undetermined {
        what: "the sum of squares has no clear minimum",
    })
}

/// The fit near a state, about the sensor that both frames tell.
pub(super) fn settle<V: View + Clone>(
    problem: &mut Problem<'_, V>,
    near: State,
) -> Result<Fitted, PressError> {
    let near = problem.weigh(&near)?;
    let near = learn(problem, near)?;
    minimise(problem, near, EXACTLY, None, true)
}

/// A fit about the sensor that both frames tell.
fn learn<V: View + Clone>(
    problem: &mut Problem<'_, V>,
    near: Fitted,
) -> Result<Fitted, PressError> {
    let mut best = near;
    for _ in 0..LEARNT {
        best = minimise(problem, best, 0.1 * SETTLED, None, true)?;
        let before = problem.clone();
        let is_there = problem.learn(&best)?;
        match problem.weigh(&best.state) {
            Ok(fitted) if is_there => best = fitted,
            _ => {
                // There is no such sensor.
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

/// A fit that few markers cannot lead astray.
fn robust<V: View + Clone>(problem: &mut Problem<'_, V>) -> Result<Fitted, PressError> {
    let starts = problem.starts()?;
    let mut best: Option<Fitted> = None;
    let mut failure = problem.unexplained(0.0);
    for start in starts.into_iter().take(3) {
        let fitted = Fitted::at(problem, start)
            .and_then(|fitted| minimise(problem, fitted, ROUGHLY, None, false));
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
    let mut best = minimise(problem, near, ROUGHLY, None, true)?;
    // Where the fit is bad, a few markers may be to blame.
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
        best = minimise(problem, weighed, ROUGHLY, None, true)?;
        is_weighed = true;
    }
    if is_weighed {
        problem.trust.fill(1.0);
        best = problem.weigh(&best.state)?;
    }
    Ok(best)
}

/// Takes wrong markers out, and tells which.
fn drop_wrong<V: View>(
    problem: &mut Problem<'_, V>,
    best: &Fitted,
) -> Result<Vec<usize>, PressError> {
    let squares = problem.squares(&best.residuals)?;
    let most = (MOST_WRONG * squares.len() as f64).max(1.0) as usize;
    let pairs = problem.counting.iter().zip(&squares);
    let wrong: Vec<usize> = pairs
        .filter(|(_, square)| **square > WRONG)
        .map(|(marker, _)| *marker)
        .collect();
    let enough = NUMBERS * (squares.len() - wrong.len()) >= problem.unknowns();
    if wrong.len() > most || !enough {
        return Ok(Vec::new());
    }
    problem.leave_out(&wrong);
    Ok(wrong)
}

impl<V: View> Problem<'_, V> {
    fn goodness(&self, fitted: &Fitted) -> GoodnessOfFit {
        let freedom = (self.equations() + self.known()).saturating_sub(self.unknowns());
        GoodnessOfFit::new(fitted.sums.chi_squared, freedom)
    }

    /// Refusal of pictures that a contact explains only so much better than none does.
    fn unexplained(&self, improvement: f64) -> PressError {
        let at_rest = self.residuals_at_rest();
        match at_rest.and_then(|at_rest| self.squares(&at_rest)) {
            Ok(squares) => unexplained((improvement, SEEN), squares.into_iter(), NUMBERS),
            Err(error) => error,
        }
    }

    /// Sum of squares of each counting marker's residuals, what is common to all taken out.
    fn squares(&self, residuals: &Residuals) -> Result<Vec<f64>, PressError> {
        let own = self.own(residuals)?;
        Ok((0..self.counting.len())
            .map(|at| own.rows(NUMBERS * at, NUMBERS).norm_squared())
            .collect())
    }
}

fn outcome<V: View + Clone>(
    problem: &Problem<'_, V>,
    (weighed, best): (&Fitted, &Fitted),
    covariance: &Square,
    interval: Interval,
    unmoved: f64,
    wrong_markers: Vec<usize>,
) -> Result<PressEstimate, PressError> {
    let State {
        place, indentation, ..
    } = best.state;
    let body = &problem.fit.bodies[0];
    let contact = problem.fit.contact(body, &best.state)?;
    let variance = |one: usize, other: usize| {
        if problem.sought[one] && problem.sought[other] {
            covariance[(one, other)]
        } else {
            0.0
        }
    };
    let around = |value: f64, std: f64| Estimated {
        value,
        std,
        interval: Interval {
            low: Some((value - NORMAL_95 * std).max(0.0)),
            high: Some(value + NORMAL_95 * std),
        },
    };
    // C D(a) = δ: C D' da = dδ − δ d ln C.
    let [_, slope] = body.indentation_of(contact.radius)?;
    let of_radius = variance(INDENTATION, INDENTATION)
        - 2.0 * indentation * variance(INDENTATION, CURVATURE)
        + indentation * indentation * variance(CURVATURE, CURVATURE);
    let skin = problem.fit.markers.skin();
    let curvature = contact.relative_curvature;
    let log_variance = variance(CURVATURE, CURVATURE);
    let goodness = problem.goodness(best);
    // The interval goes with the mean.
    let factor = libm::exp(problem.mean_beside(weighed, covariance));
    let Interval { low, high } = interval;
    let interval = Interval {
        low: low.map(|low| low * factor),
        high: high.map(|high| high * factor),
    };
    let unbiased = curvature * factor;
    Ok(PressEstimate {
        sensor_curvature: skin.curvature(),
        relative_curvature: Estimated {
            value: unbiased,
            std: unbiased * log_variance.sqrt(),
            interval,
        },
        most_likely_curvature: curvature,
        indentation: around(indentation, variance(INDENTATION, INDENTATION).sqrt()),
        contact_radius: around(
            contact.radius,
            of_radius.max(0.0).sqrt() / (curvature * slope),
        ),
        contact: skin.chart(place.direction.as_ref()),
        contact_std: [
            variance(ALONG, ALONG).sqrt(),
            variance(ACROSS, ACROSS).sqrt(),
        ],
        baseline: None,
        gain: None,
        wrong_markers,
        normal_std: best.normal_std(),
        tangential_std: None,
        r_squared: 1.0 - best.sums.chi_squared / unmoved.max(f64::MIN_POSITIVE),
        reduced_chi_squared: goodness.chi_squared / goodness.freedom.max(1) as f64,
        goodness: Some(goodness),
        is_seen: true,
        only_marker: None,
        verdict: Verdict::of(interval, skin.curvature()),
    })
}
