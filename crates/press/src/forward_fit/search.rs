//! The search for an estimate from readings: start, robust fit, wrong markers, noise, intervals.

use nalgebra::Vector3;
use palpate_statistics::{HALF_WIDTHS, NORMAL_95, student_half_width};

use super::minimise::{EXACTLY, minimise};
use super::misfit::Misfit;
use super::outcome::outcome;
use super::presence::{on_markers, seen};
use super::problem::{ACROSS, BASELINE, GAIN, INDENTATION, Problem, Square, State, Sums, WRONG};
use super::profile::{Profile, profile};
use super::reading::Reading;
use super::settings::{ForwardFit, Prior};
use super::start::{RADII, Shapes, median, starts};
use super::unseen::Unseen;
use crate::definite::inverse;
use crate::{Contact, Estimated, Interval, PressError, PressEstimate};

/// Least entry on the diagonal of the scaled factor of information that can be inverted.
pub(super) const SINGULAR: f64 = 1e-7;
/// Largest share of the markers that can be wrong; if more seem so, the model is.
const MOST_WRONG: f64 = 1.0 / 8.0;
/// Number of wrong markers of which one that counts may be the cause.
const SEVERAL: usize = 2;
/// Markers are in a row where they spread (squared) less across it than this share of what they do along it.
const ROW: f64 = 1e-5;
/// Probability by chance of what a marker says against the others below which they may be right.
const SUSPECT: f64 = 0.05;
/// Residual, in standard deviations, beyond which the weight falls while it is not known which markers are wrong.
const ROBUST: f64 = 3.0;
/// Least decrease of chi-squared that a further step must promise, before it is known which markers are wrong.
const ROUGHLY: f64 = 1e-2;
/// Smallest standard deviation of a displacement, as a share of the largest displacement: of less, rounding is more.
const EXACT: f64 = 1e-10;

/// A search for the press behind a reading.
#[derive(Clone)]
pub(super) struct Search<'a> {
    problem: Problem<'a>,
    /// Whether the noise of normal and of tangential displacements must be found.
    find_normal: bool,
    find_tangential: bool,
    /// The largest displacement that was read.
    largest: f64,
    /// Fits that began elsewhere.
    rivals: Vec<State>,
}

/// Contact of readings that show none at first.
enum Found<'a> {
    /// A contact that they show elsewhere.
    Contact(Box<(Search<'a>, State, Sums)>),
    /// The estimate of a contact that only its indentation tells of.
    Left(Box<PressEstimate>),
}

impl<'a> Problem<'a> {
    /// Problem in which all that is not known is sought, and every marker counts, with a standard deviation of 1.
    pub(super) fn new(fit: &'a ForwardFit, reading: &'a Reading<'a>) -> Self {
        let mut sought = [true; super::problem::UNKNOWNS];
        // A prior narrower than rounding counts as exact.
        let largest = reading
            .normal
            .iter()
            .fold(0.0, |most: f64, one| most.max(one.abs()));
        let is_sought = |prior: Prior, scale: f64| match prior {
            Prior::Exact => false,
            Prior::Within(std) => std > EXACT * scale,
            Prior::Free => true,
        };
        sought[INDENTATION] = reading
            .indentation
            .is_none_or(|known| known.std > EXACT * known.value);
        sought[BASELINE] = is_sought(fit.baseline, largest);
        sought[GAIN] = is_sought(fit.gain, 1.0);
        let mut problem = Self {
            fit,
            reading,
            sought,
            normal_std: 1.0,
            tangential_std: 1.0,
            kept: vec![true; reading.normal.len()],
            circle: None,
            tolerance: f64::INFINITY,
        };
        if !problem.uses_tangential() {
            problem.circle = common_circle(reading);
            problem.sought[ACROSS] = problem.circle.is_none();
        }
        problem
    }

    /// Only markers within the window count.
    pub(super) fn keep_window(&mut self, state: &State) {
        let Some(window) = self.fit.window else {
            return;
        };
        let markers = self.reading.markers;
        for (kept, place) in self.kept.iter_mut().zip(markers.places()) {
            *kept = markers.sight(&state.place, place).distance <= window;
        }
    }
}

impl Problem<'_> {
    /// Sum of squares of all markers' residuals, of each as much as a wrong one has at least; infinite where there is no such contact.
    fn unexplained(&self, state: &State) -> f64 {
        let Ok(contact) = self.contact(state) else {
            return f64::INFINITY;
        };
        let square = |marker: usize| {
            let residuals = self.residuals_at(&contact, state, marker);
            let square: f64 = residuals.iter().map(|residual| residual * residual).sum();
            square.min(WRONG * WRONG)
        };
        (0..self.kept.len()).map(square).sum()
    }

    /// Chi-squared of the markers that do not count, taken as unmoved.
    fn left_out(&self) -> f64 {
        let mut misfit = Misfit::new(self.tolerance);
        for marker in (0..self.kept.len()).filter(|&marker| !self.kept[marker]) {
            misfit.add(self.readings_of(marker, 0.0));
        }
        misfit.total()
    }
}

/// The pole of the great circle on which all markers lie, if they do.
fn common_circle(reading: &Reading<'_>) -> Option<Vector3<f64>> {
    let mut spread = nalgebra::Matrix3::zeros();
    for place in reading.markers.places() {
        spread += place.direction.as_ref() * place.direction.as_ref().transpose();
    }
    let eigen = spread.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let mut spreads: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
    spreads.sort_by(f64::total_cmp);
    (spreads[0] <= ROW * spreads[1]).then(|| eigen.eigenvectors.column(least).into_owned())
}

impl<'a> Search<'a> {
    pub(super) fn new(fit: &'a ForwardFit, reading: &'a Reading<'a>) -> Result<Self, PressError> {
        let mut problem = Problem::new(fit, reading);
        problem.determined()?;
        let least = reading.normal.iter().copied().fold(f64::INFINITY, f64::min);
        let most = reading
            .normal
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        if least == most {
            return Err(PressError::NoContact {
                improvement: 0.0,
                needed: problem.needed(),
            });
        }
        let largest = most.abs().max(least.abs());
        let floored = |std: f64| std.max(EXACT * largest);
        let stated = |std: Option<f64>| std.filter(|&std| std > 0.0).map(floored);
        let (normal, tangential) = (stated(fit.normal_std), stated(fit.tangential_std));
        problem.normal_std = normal.unwrap_or(0.1 * largest);
        problem.tangential_std = tangential.unwrap_or(problem.normal_std);
        Ok(Self {
            find_normal: normal.is_none(),
            find_tangential: tangential.is_none(),
            problem,
            largest,
            rivals: Vec::new(),
        })
    }

    pub(super) fn run(mut self) -> Result<PressEstimate, PressError> {
        let (mut state, mut sums) = self.begin()?;
        // The profile may find a better fit than the one it starts from.
        for _ in 0..4 {
            let shown = seen(&self.problem, &state);
            let only_marker = match shown {
                Ok(None) => None,
                Err(refusal @ PressError::OtherBody { .. }) if self.problem.knows_noise() => {
                    return Err(refusal);
                }
                _ => match self.unseen(shown.unwrap_or_default()) {
                    Some(Found::Contact(found)) => {
                        (self, state, sums) = *found;
                        None
                    }
                    // Where most markers tell the noise, a press that is not explained may be one that fits missed.
                    Some(Found::Left(_)) if matches!(shown, Err(PressError::OtherBody { .. })) => {
                        shown?
                    }
                    Some(Found::Left(estimate)) => return Ok(*estimate),
                    None => shown?,
                },
            };
            let covariance = inverse(&sums.hessian, SINGULAR).ok_or(PressError::Undetermined {
                what: "some combination of curvature, place, indentation, baseline and gain is free",
            })?;
            let limit = self.limit();
            match profile(&self.problem, &state, &sums, limit * limit) {
                Profile::Interval(interval) => match self.with_rivals(&state, &sums, interval) {
                    Profile::Interval(interval) => {
                        on_markers(&self.problem, &state)?;
                        let found =
                            outcome(&self.problem, &state, &sums, &covariance, interval, limit)?;
                        if only_marker.is_none() {
                            let held =
                                self.or_without_slipped(&state, &sums, &covariance, interval)?;
                            return Ok(found.holding(held));
                        }
                        return Ok(PressEstimate {
                            only_marker,
                            ..found
                        });
                    }
                    Profile::Better(better) => state = better,
                },
                Profile::Better(better) => state = better,
            }
            sums = self.settle(&mut state)?;
        }
        Err(PressError::Undetermined {
            what: "the sum of squares has no clear minimum",
        })
    }

    /// Contact of readings that show none where the fits have led, or by one marker alone: one that they do show elsewhere, or
    /// the curvatures that they leave to one whose indentation is given, on the markers; `None` where there is neither.
    fn unseen(&self, only_marker: Option<usize>) -> Option<Found<'a>> {
        let mut problem = self.problem.clone();
        if let Some(marker) = only_marker {
            // Without it the others say what a needle under it would not contradict.
            problem.kept[marker] = false;
        }
        problem.determined().ok()?;
        let unseen = Unseen::new(&problem)?;
        let mut missed = self.clone();
        if let Some(mut state) = unseen.likeliest()
            && let Ok(sums) = missed.settle(&mut state)
            && matches!(seen(&missed.problem, &state), Ok(None))
        {
            return Some(Found::Contact(Box::new((missed, state, sums))));
        }
        let limit = self.limit();
        let (state, sums, interval) = unseen.left(limit * limit)?;
        let covariance = inverse(&sums.hessian, SINGULAR)?;
        let estimate = outcome(&problem, &state, &sums, &covariance, interval, limit).ok()?;
        // Noise makes readings that show nothing look sharp; so far from a clear minimum no bias the other way is told.
        let corrected = estimate.relative_curvature;
        let value = corrected.value.min(estimate.most_likely_curvature);
        let mut wrong_markers = estimate.wrong_markers;
        wrong_markers.retain(|&marker| Some(marker) != only_marker);
        Some(Found::Left(Box::new(PressEstimate {
            is_seen: false,
            only_marker,
            wrong_markers,
            relative_curvature: Estimated {
                value,
                std: corrected.std * (value / corrected.value),
                interval,
            },
            ..estimate
        })))
    }

    /// An interval that holds what other fits tell which explain the readings about as well.
    fn with_rivals(&self, best: &State, sums: &Sums, interval: Interval) -> Profile {
        let limit = self.limit() * self.limit();
        let mut hull = interval;
        for rival in self
            .rivals
            .iter()
            .filter(|rival| !self.is_same(best, rival))
        {
            let Ok((state, least)) = minimise(&self.problem, *rival, EXACTLY, None) else {
                continue;
            };
            let rise = least.chi_squared - sums.chi_squared;
            if self.is_same(best, &state) || rise >= limit {
                continue;
            }
            if rise < -ROUGHLY {
                return Profile::Better(state);
            }
            let around = |_| profile(&self.problem, &state, &least, limit - rise.max(0.0));
            hull = match inverse(&least.hessian, SINGULAR).map(around) {
                Some(Profile::Interval(interval)) => hull.hull(interval),
                // A rival that nothing bounds leaves the curvature unbounded.
                Some(Profile::Better(_)) | None => Interval::UNBOUNDED,
            };
        }
        Profile::Interval(hull)
    }

    /// An interval that also holds what the other markers tell where one of them contradicts them.
    fn or_without_slipped(
        &self,
        state: &State,
        sums: &Sums,
        covariance: &Square,
        interval: Interval,
    ) -> Result<Interval, PressError> {
        let problem = &self.problem;
        let Some(noise) = problem.noise(sums) else {
            return Ok(interval);
        };
        let (marker, chance) = problem.slipped(state, covariance, &noise)?;
        if chance >= SUSPECT {
            return Ok(interval);
        }
        let limit = self.limit() * self.limit();
        let mut told = problem.without(marker, state);
        // The profile may find a better fit than the one it starts from.
        for _ in 0..4 {
            let Some((others, state, sums)) = told else {
                break;
            };
            match profile(&others, &state, &sums, limit) {
                Profile::Interval(without) => return Ok(interval.hull(without)),
                Profile::Better(better) => told = others.without(marker, &better),
            }
        }
        // Nothing that the others tell bounds the curvature.
        Ok(Interval::UNBOUNDED)
    }

    /// Whether two fits are one and the same.
    fn is_same(&self, one: &State, other: &State) -> bool {
        let near = |contact: Contact<'_>| {
            let markers = self.problem.reading.markers;
            markers.sight(&one.place, &other.place).distance < 0.2 * contact.radius
        };
        (one.log_curvature - other.log_curvature).abs() < 0.1
            && self.problem.contact(one).is_ok_and(near)
    }

    /// The best of the fits that are begun; where the noise is to be found, the one that finds the least.
    fn begin(&mut self) -> Result<(State, Sums), PressError> {
        let mut fits = self.robust_fits()?;
        if self.problem.fit.window.is_some() {
            // Fits to other markers are not to be compared by their residuals.
            fits.truncate(1);
        }
        self.rivals.clone_from(&fits);
        if !self.find_normal {
            fits.truncate(1);
        }
        let mut failure = PressError::OutOfRange;
        let mut best: Option<(Self, State, Sums)> = None;
        for mut state in fits {
            let mut settled = self.clone();
            match settled.settle(&mut state) {
                Ok(sums) => {
                    let noise = settled.problem.normal_std;
                    let is_better =
                        |(best, _, _): &(Self, State, Sums)| noise < best.problem.normal_std;
                    if best.as_ref().is_none_or(is_better) {
                        best = Some((settled, state, sums));
                    }
                }
                Err(error) => failure = error,
            }
        }
        let (settled, state, sums) = best.ok_or(failure)?;
        *self = settled;
        Ok(self.without_nearest(&state).unwrap_or((state, sums)))
    }

    /// A fit that explains the markers where one that leaves several out does so worse: that without the marker nearest to the
    /// contact, which makes a needle under it where it slipped.
    fn without_nearest(&mut self, state: &State) -> Option<(State, Sums)> {
        let wrong = self.problem.kept.iter().filter(|kept| !**kept).count();
        // Markers outside a window are not wrong, and fits that find other noise are not to be compared by their residuals.
        let finds_noise =
            self.find_normal || self.find_tangential && self.problem.uses_tangential();
        if finds_noise || self.problem.fit.window.is_some() || wrong < SEVERAL {
            return None;
        }
        let markers = self.problem.reading.markers.places().iter();
        let distances = markers.map(|place| {
            let sight = self.problem.reading.markers.sight(&state.place, place);
            sight.distance
        });
        let near = |(_, one): &(usize, f64), (_, other): &(usize, f64)| one.total_cmp(other);
        let (nearest, _) = distances.enumerate().min_by(near)?;
        let mut others = self.clone();
        others.problem.kept.fill(true);
        others.problem.kept[nearest] = false;
        let mut least = self.problem.unexplained(state);
        let mut best = None;
        let shapes = Shapes::new(&others.problem, &RADII).states(&others.problem, state.place);
        for (_, start) in shapes.into_iter().flatten() {
            let mut without = others.clone();
            let Ok((mut there, _)) = minimise(&without.problem, start, ROUGHLY, None) else {
                continue;
            };
            let Ok(sums) = without.settle(&mut there) else {
                continue;
            };
            let unexplained = without.problem.unexplained(&there);
            let goodness = without.problem.goodness(&sums);
            let is_good = goodness.is_some_and(|goodness| !goodness.is_doubted());
            if is_good && unexplained < least {
                least = unexplained;
                best = Some((without, there, sums));
            }
        }
        let (without, there, sums) = best?;
        *self = without;
        Some((there, sums))
    }

    /// Fits that no few markers can lead astray, one for each place to which they lead, the best first.
    fn robust_fits(&self) -> Result<Vec<State>, PressError> {
        let mut problem = self.problem.clone();
        if !problem.fit.body.is_approximate() {
            problem.tolerance = ROBUST;
        }
        let mut fits: Vec<(f64, State)> = Vec::new();
        let middling = 0.1 * self.problem.reading.markers.skin().radius();
        let unsolved = self.problem.fit.body.unit_contact(middling).err();
        let mut failure = unsolved.unwrap_or_else(|| self.problem.without_contact(0.0));
        let few = if self.find_normal { 6 } else { 2 };
        for start in starts(&problem, few) {
            problem.keep_window(&start);
            match minimise(&problem, start, ROUGHLY, None) {
                Ok((state, sums)) => fits.push((sums.chi_squared + problem.left_out(), state)),
                Err(error) => failure = error,
            }
        }
        fits.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut apart: Vec<State> = Vec::new();
        for (_, state) in fits {
            if !apart.iter().any(|other| self.is_same(other, &state)) {
                apart.push(state);
            }
        }
        match apart.is_empty() {
            true => Err(failure),
            false => Ok(apart),
        }
    }

    /// Least squares over the markers that are not wrong, with the noise that they show where it must be found.
    fn settle(&mut self, state: &mut State) -> Result<Sums, PressError> {
        const ROUNDS: usize = 8;
        let (mut last, mut sums) = (None, None);
        for round in 0..ROUNDS {
            let kept = self.problem.kept.clone();
            self.find_noise(state, round < 2)?;
            self.choose(state)?;
            let is_same = kept == self.problem.kept && !self.is_noise_new(&mut last);
            if let Some(sums) = sums.filter(|_| is_same) {
                return Ok(sums);
            }
            let least = minimise(&self.problem, *state, EXACTLY, None)?;
            (*state, sums) = (least.0, Some(least.1));
        }
        // A marker at a limit may come and go without end.
        self.problem.sums(state)
    }

    /// Whether the noise has changed noticeably since the last call.
    fn is_noise_new(&self, last: &mut Option<[f64; 2]>) -> bool {
        let now = [self.problem.normal_std, self.problem.tangential_std];
        let same = |last: [f64; 2]| {
            last.iter()
                .zip(now)
                .all(|(last, now)| (now - last).abs() <= 1e-3 * now)
        };
        let found = self.find_normal || self.find_tangential;
        let is_new = found && !last.is_some_and(same);
        *last = Some(now);
        is_new
    }

    /// Finds standard deviations from the residuals of the markers that count: from their median (`robustly`) or their
    /// squares.
    fn find_noise(&mut self, state: &State, robustly: bool) -> Result<(), PressError> {
        if !(self.find_normal || self.find_tangential) {
            return Ok(());
        }
        let problem = &self.problem;
        let contact = problem.contact(state)?;
        let (mut normal, mut tangential) = (Vec::new(), Vec::new());
        for marker in problem.counting() {
            let [inward, x, y] = problem.residuals_at(&contact, state, marker);
            normal.push((inward * problem.normal_std).abs());
            tangential.extend([x, y].map(|along| (along * problem.tangential_std).abs()));
        }
        let correction = (problem.equations() as f64 / problem.freedom().max(1) as f64).sqrt();
        let floor = EXACT * self.largest;
        let std = |residuals: &[f64]| {
            let raw = if robustly {
                median(residuals) / HALF_WIDTHS[0]
            } else {
                let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
                (squares / residuals.len().max(1) as f64).sqrt()
            };
            (raw * correction).max(floor)
        };
        let (found_normal, found_tangential) = (std(&normal), std(&tangential));
        if self.find_normal {
            self.problem.normal_std = found_normal;
        }
        if self.find_tangential && self.problem.uses_tangential() {
            self.problem.tangential_std = found_tangential;
        }
        Ok(())
    }

    /// Whether each marker counts: it lies within the window and is not wrong.
    fn choose(&mut self, state: &State) -> Result<(), PressError> {
        let problem = &mut self.problem;
        problem.kept.fill(true);
        problem.keep_window(state);
        let contact = problem.contact(state)?;
        let inside = problem.counting().count();
        let is_wrong = |marker: &usize| {
            let residuals = problem.residuals_at(&contact, state, *marker);
            residuals.iter().any(|residual| residual.abs() > WRONG)
        };
        let wrong: Vec<usize> = problem.counting().filter(is_wrong).collect();
        let most = (MOST_WRONG * inside as f64).max(1.0) as usize;
        if wrong.len() <= most && !problem.fit.body.is_approximate() {
            for marker in wrong {
                problem.kept[marker] = false;
            }
        }
        problem.determined()
    }

    /// The half-width of a 95 % interval, in standard deviations.
    fn limit(&self) -> f64 {
        if self.find_normal {
            student_half_width(0.95, self.problem.freedom())
        } else {
            NORMAL_95
        }
    }
}
