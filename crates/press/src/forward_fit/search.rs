//! Searches for the best fit of a press: robust fits from several start values, rejection of outliers, estimation of
//! the noise, intervals.

use std::f64::consts::GOLDEN_RATIO;

use palpate_statistics::{HALF_WIDTHS, NORMAL_95, student_half_width};

use super::contact_detection::{detect, on_markers};
use super::problem::{Problem, WRONG};
use super::start::{RADII, Shapes, median, starts};
use super::undetected_contacts::UndetectedContacts;
use super::{ForwardFit, Reading};
use crate::least_squares::{EXACTLY, LeastSquares};
use crate::outcome::until_best;
use crate::profile::profile;
use crate::unknowns::{EXACT, Square, State, Sums};
use crate::{Contact, Estimated, Interval, PressError, PressEstimate};

/// Largest share of outliers among the markers. If there are more, the model is probably wrong, and no marker is
/// rejected.
const MAX_OUTLIER_SHARE: f64 = 1.0 / 8.0;
/// A marker is an outlier only if its residual exceeds this share of the largest displacement. Smaller residuals may be
/// rounding errors of displacements that have no noise.
const MIN_OUTLIER: f64 = 1e-4;
/// Smallest number of outliers for which a fit without the marker nearest to the contact is also tried. If the reading
/// of this marker is wrong but was not rejected, it can make several correct markers look like outliers.
const SEVERAL: usize = 2;
/// Significance level for the marker that contradicts the other markers most. If the p-value of this contradiction is
/// lower, the 95 % interval is extended by the interval of a fit without the marker.
const SUSPECT: f64 = 0.05;
/// Residuals beyond this number of standard deviations have a reduced weight in the robust fit, which precedes the
/// rejection of outliers.
const ROBUST: f64 = 3.0;
/// The robust fit stops if the next step is predicted to decrease chi-squared by less than this value.
const ROUGHLY: f64 = 1e-2;
/// Relative change below which an estimated noise counts as unchanged. With many readings, the limit is lower: it is
/// `MAX_RISE` divided by the number of readings. A change of the noise by less than this limit changes chi-squared by
/// at most 2 `MAX_RISE`.
const MAX_NOISE_CHANGE: f64 = 1e-3;
const MAX_RISE: f64 = 0.25;
/// If there are fewer normal readings per fitted parameter, normal and tangential noise are assumed equal, and one
/// standard deviation is estimated. The fit follows few normal readings so closely that their residuals hide their
/// noise.
pub(crate) const MIN_READINGS_PER_PARAMETER: usize = 3;
/// Fits of up to this number of markers use all start values. With few markers, chi-squared often has several
/// minima.
const FEW_MARKERS: usize = 40;
/// Number of markers with the largest displacements in the first stage of a search. The first stage also uses about as
/// many of the other markers. If there are at most twice this number of markers, the search uses all markers from the
/// start.
const MAX_START_MARKERS: usize = 10_000;

#[derive(Clone)]
pub(super) struct Search<'a> {
    problem: Problem<'a>,
    /// Whether the noise of normal displacements is estimated from the residuals, because it is not stated.
    /// `find_tangential` states this for tangential displacements.
    find_normal: bool,
    find_tangential: bool,
    /// The largest displacement (length) in the reading.
    largest: f64,
    /// Fit parameters at all minima of chi-squared that the fits from different start values found.
    rivals: Vec<State>,
}

/// Result of the second search, which follows a fit without a detected contact.
enum Found<'a> {
    Contact(Box<(Search<'a>, State, Sums)>),
    /// The readings show no contact, but an indentation is stated, so there must be a contact. The field is the
    /// estimate from the stated indentation.
    Left(Box<PressEstimate>),
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
        let first = self.begin()?;
        until_best(first, |(mut state, mut sums)| {
            let shown = detect(&self.problem, &state);
            let only_marker = match shown {
                Ok(None) => None,
                Err(refusal @ PressError::OtherBody { .. }) if self.problem.knows_noise() => {
                    return Err(refusal);
                }
                _ => match self.undetected(shown.unwrap_or_default()) {
                    Some(Found::Contact(found)) => {
                        (self, state, sums) = *found;
                        None
                    }
                    // The noise was estimated, so the bad fit may be a wrong local minimum. Therefore return the error
                    // of the bad fit, not the estimate of an undetected contact.
                    Some(Found::Left(_)) if matches!(shown, Err(PressError::OtherBody { .. })) => {
                        shown?
                    }
                    Some(Found::Left(estimate)) => return Ok(Ok(*estimate)),
                    None => shown?,
                },
            };
            let covariance = self.problem.covariance(&sums)?;
            let limit = self.limit();
            let interval = profile(&self.problem, &(state, sums), limit * limit);
            match interval.and_then(|interval| self.with_rivals(&state, &sums, interval)) {
                Ok(interval) => {
                    on_markers(&self.problem, &state)?;
                    let fit = (&state, &sums);
                    let found = self.problem.outcome(fit, &covariance, interval, limit)?;
                    if only_marker.is_none() {
                        let held = self.or_without_slipped(&state, &sums, &covariance, interval)?;
                        return Ok(Ok(found.holding(held)));
                    }
                    Ok(Ok(PressEstimate {
                        only_marker,
                        ..found
                    }))
                }
                Err(mut better) => {
                    let sums = self.settle(&mut better)?;
                    Ok(Err((better, sums)))
                }
            }
        })
    }

    /// Searches for a contact at another place, if no marker or only one marker shows the contact of the previous fit.
    /// Returns the new contact if the readings show it. Otherwise returns an estimate that relies on the stated
    /// indentation and contains the range of curvatures that the readings allow. Returns `None` if such an estimate is
    /// impossible.
    fn undetected(&self, only_marker: Option<usize>) -> Option<Found<'a>> {
        let mut problem = self.problem.clone();
        if let Some(marker) = only_marker {
            // Exclude the only marker that moved, because a very sharp object under this marker could explain any
            // displacement of it without moving the other markers.
            problem.kept[marker] = false;
        }
        problem.determined().ok()?;
        let contacts = UndetectedContacts::new(&problem)?;
        let mut missed = self.clone();
        if let Some(mut state) = contacts.likeliest()
            && let Ok(sums) = missed.settle(&mut state)
            && matches!(detect(&missed.problem, &state), Ok(None))
        {
            return Some(Found::Contact(Box::new((missed, state, sums))));
        }
        let limit = self.limit();
        let (state, sums, interval) = contacts.left(limit * limit)?;
        let covariance = problem.covariance(&sums).ok()?;
        let estimate = problem.outcome((&state, &sums), &covariance, interval, limit);
        let estimate = estimate.ok()?;
        // Do not let the bias correction increase the curvature. Far from a clear minimum, noise would make this
        // correction much too large.
        let corrected = estimate.relative_curvature;
        let value = corrected.value.min(estimate.most_likely_curvature);
        let mut wrong_markers = estimate.wrong_markers;
        wrong_markers.retain(|&marker| Some(marker) != only_marker);
        Some(Found::Left(Box::new(PressEstimate {
            is_detected: false,
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

    /// Extends the interval by the intervals around other minima of chi-squared that explain the readings about equally
    /// well. If chi-squared is smaller at another minimum, the function returns the fit parameters at this minimum as
    /// the error.
    fn with_rivals(
        &self,
        best: &State,
        sums: &Sums,
        interval: Interval,
    ) -> Result<Interval, State> {
        let limit = self.limit() * self.limit();
        let mut hull = interval;
        for rival in self
            .rivals
            .iter()
            .filter(|rival| !self.is_same(best, rival))
        {
            let Ok((state, least)) = self.problem.minimum(*rival, EXACTLY, None) else {
                continue;
            };
            let rise = least.chi_squared - sums.chi_squared;
            if self.is_same(best, &state) || rise >= limit {
                continue;
            }
            if rise < -ROUGHLY {
                return Err(state);
            }
            let around = |_| profile(&self.problem, &(state, least), limit - rise.max(0.0)).ok();
            // If no interval can be computed around another good minimum of chi-squared, the combined interval is
            // unbounded.
            let other = self.problem.covariance(&least).ok().and_then(around);
            hull = other.map_or(Interval::UNBOUNDED, |interval| hull.hull(interval));
        }
        Ok(hull)
    }

    /// Returns the interval from all markers. If one marker contradicts the other markers, the interval is extended by
    /// the interval of a fit without this marker.
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
        // The search for the interval may find a better fit than the fit from which it started. In this case, the
        // search is repeated from the better fit.
        for _ in 0..4 {
            let Some((others, state, sums)) = told else {
                break;
            };
            match profile(&others, &(state, sums), limit) {
                Ok(without) => return Ok(interval.hull(without)),
                Err(better) => told = others.without(marker, &better),
            }
        }
        // The search found no interval for the fit without the contradicting marker, so the curvature counts as
        // unbounded.
        Ok(Interval::UNBOUNDED)
    }

    fn is_same(&self, one: &State, other: &State) -> bool {
        let near = |contact: Contact<'_>| {
            let markers = self.problem.reading.markers;
            markers.sight(&one.place, &other.place).distance < 0.2 * contact.radius
        };
        (one.log_curvature - other.log_curvature).abs() < 0.1
            && self.problem.contact(one).is_ok_and(near)
    }

    /// Fits some of the markers, and then all markers with the first fit's parameters as start values. Returns `None`
    /// if there are only few markers, or if one of the two fits fails.
    fn begin_with_few(&mut self) -> Option<(State, Sums)> {
        let reading = self.problem.reading;
        let mut chosen: Vec<usize> = (0..reading.normal.len()).collect();
        if chosen.len() <= 2 * MAX_START_MARKERS {
            return None;
        }
        let share = MAX_START_MARKERS as f64 / chosen.len() as f64;
        let by_displacement =
            |one: &usize, other: &usize| reading.normal[*other].total_cmp(&reading.normal[*one]);
        chosen.select_nth_unstable_by(MAX_START_MARKERS, by_displacement);
        let mut others = chosen.split_off(MAX_START_MARKERS);
        // The fractional parts of multiples of the golden ratio are spread evenly, so the chosen markers are also
        // spread evenly over the rows of a grid.
        others.retain(|&marker| (marker as f64 * GOLDEN_RATIO).fract() < share);
        chosen.append(&mut others);
        let markers = reading.markers.subset(&chosen);
        let normal: Vec<f64> = chosen.iter().map(|&one| reading.normal[one]).collect();
        let of_chosen = |all: &[[f64; 2]]| chosen.iter().map(|&one| all[one]).collect();
        let tangential: Option<Vec<[f64; 2]>> = reading.tangential.map(of_chosen);
        let few = Reading {
            markers: &markers,
            normal: &normal,
            tangential: tangential.as_deref(),
            indentation: reading.indentation,
        };
        let mut search = Search::new(self.problem.fit, &few).ok()?;
        let (mut state, _) = search.begin().ok()?;
        let mut all = self.clone();
        let sums = all.settle(&mut state).ok()?;
        all.rivals = search.rivals;
        *self = all;
        Some(self.without_nearest(&state).unwrap_or((state, sums)))
    }

    /// The best of the fits from all start values: the fit with the smallest chi-squared or, if the noise is estimated,
    /// with the smallest noise.
    fn begin(&mut self) -> Result<(State, Sums), PressError> {
        if let Some(fit) = self.begin_with_few() {
            return Ok(fit);
        }
        let mut fits = self.robust_fits()?;
        if self.problem.fit.window.is_some() {
            // If a window is set, each fit uses only the markers within the window around its own contact. The
            // residuals of different fits then cannot be compared, so keep only the first fit.
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

    /// If there are several outliers, tries a fit without the marker nearest to the contact. An error of this marker
    /// would look like a sharp object under it. Returns the new fit if it explains the readings of all markers better,
    /// otherwise `None`.
    fn without_nearest(&mut self, state: &State) -> Option<(State, Sums)> {
        let wrong = self.problem.kept.iter().filter(|kept| !**kept).count();
        // In two cases, do not fit without the nearest marker. If a window is set, the unused markers may be correct
        // markers outside of the window, not outliers. If the noise is estimated, the residuals of the two fits cannot
        // be compared.
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
            let Ok((mut there, _)) = without.problem.minimum(start, ROUGHLY, None) else {
                continue;
            };
            let Ok(sums) = without.settle(&mut there) else {
                continue;
            };
            let unexplained = without.problem.unexplained(&there);
            let goodness = without.problem.goodness(&sums);
            let is_good = goodness.is_some_and(|goodness| !goodness.is_poor());
            if is_good && unexplained < least {
                least = unexplained;
                best = Some((without, there, sums));
            }
        }
        let (without, there, sums) = best?;
        *self = without;
        Some((there, sums))
    }

    /// Fit parameters at each minimum that the robust fits found, sorted from the smallest chi-squared to the largest.
    fn robust_fits(&self) -> Result<Vec<State>, PressError> {
        let mut problem = self.problem.clone();
        if !problem.fit.body.is_approximate() {
            problem.tolerance = ROBUST;
        }
        let mut fits: Vec<(f64, State)> = Vec::new();
        let middling = 0.1 * self.problem.reading.markers.extent();
        let unsolved = self.problem.fit.body.unit_contact(middling).err();
        let mut failure = unsolved.unwrap_or_else(|| self.problem.without_contact(0.0));
        let few = match self.find_normal {
            _ if problem.kept.len() <= FEW_MARKERS => usize::MAX,
            true => 6,
            false => 2,
        };
        for start in starts(&problem, few) {
            problem.keep_window(&start);
            match problem.minimum(start, ROUGHLY, None) {
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

    /// Repeats a least-squares fit, each time without the outliers of the previous fit, until neither the noise nor the
    /// selection of markers changes. The noise is estimated if it is not stated.
    fn settle(&mut self, state: &mut State) -> Result<Sums, PressError> {
        const ROUNDS: usize = 8;
        let (mut last, mut sums) = (None, None);
        for round in 0..ROUNDS {
            let kept = self.problem.kept.clone();
            let residuals = self.residuals(state)?;
            self.find_noise(&residuals, round < 2);
            self.choose(state, &residuals)?;
            let is_same = kept == self.problem.kept && !self.is_noise_new(&mut last);
            if let Some(sums) = sums.filter(|_| is_same) {
                return Ok(sums);
            }
            let least = self.problem.minimum(*state, EXACTLY, None)?;
            (*state, sums) = (least.0, Some(least.1));
        }
        // The estimated noise and the selection of markers did not converge. For example, a marker at the outlier
        // threshold may be accepted and rejected in turn. Use the fit parameters of the last round.
        self.problem.sums(state)
    }

    fn is_noise_new(&self, last: &mut Option<[f64; 2]>) -> bool {
        let now = [self.problem.normal_std, self.problem.tangential_std];
        let tolerance = MAX_NOISE_CHANGE.min(MAX_RISE / self.problem.equations() as f64);
        let same = |last: [f64; 2]| {
            last.iter()
                .zip(now)
                .all(|(last, now)| (now - last).abs() <= tolerance * now)
        };
        let found = self.find_normal || self.find_tangential;
        let is_new = found && !last.is_some_and(same);
        *last = Some(now);
        is_new
    }

    fn residuals(&self, state: &State) -> Result<Vec<[f64; 3]>, PressError> {
        let problem = &self.problem;
        let contact = problem.contact(state)?;
        let stds = [
            problem.normal_std,
            problem.tangential_std,
            problem.tangential_std,
        ];
        let of_marker = |marker| {
            let residuals = problem.residuals_at(&contact, state, marker);
            std::array::from_fn(|part| (residuals[part] * stds[part]).abs())
        };
        Ok((0..problem.kept.len()).map(of_marker).collect())
    }

    /// Estimates the standard deviations of the noise from the residuals of the used markers. If `robustly` is true,
    /// they follow from the median of the residuals' magnitudes, otherwise from the squared residuals.
    fn find_noise(&mut self, residuals: &[[f64; 3]], robustly: bool) {
        if !(self.find_normal || self.find_tangential) {
            return;
        }
        let problem = &self.problem;
        let mut normal: Vec<f64> = problem
            .counting()
            .map(|marker| residuals[marker][0])
            .collect();
        let mut tangential = Vec::new();
        if problem.uses_tangential() {
            tangential.extend(
                problem
                    .counting()
                    .flat_map(|marker| [residuals[marker][1], residuals[marker][2]]),
            );
        }
        if normal.len() < MIN_READINGS_PER_PARAMETER * problem.fitted.count() {
            normal.extend(&tangential);
            tangential.clone_from(&normal);
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
    }

    /// Selects the markers that the fit uses: those within the window that are not outliers.
    fn choose(&mut self, state: &State, residuals: &[[f64; 3]]) -> Result<(), PressError> {
        let least = MIN_OUTLIER * self.largest;
        let problem = &mut self.problem;
        problem.kept.fill(true);
        problem.keep_window(state);
        let inside = problem.counting().count();
        let is_wrong = |marker: &usize| {
            let [normal, x, y] = residuals[*marker];
            let [of_normal, of_others] =
                [problem.normal_std, problem.tangential_std].map(|std| (WRONG * std).max(least));
            normal > of_normal || x.max(y) > of_others
        };
        let wrong: Vec<usize> = problem.counting().filter(is_wrong).collect();
        let most = (MAX_OUTLIER_SHARE * inside as f64).max(1.0) as usize;
        if wrong.len() <= most && !problem.fit.body.is_approximate() {
            for marker in wrong {
                problem.kept[marker] = false;
            }
        }
        problem.determined()
    }

    fn limit(&self) -> f64 {
        if self.find_normal {
            student_half_width(0.95, self.problem.freedom())
        } else {
            NORMAL_95
        }
    }
}
