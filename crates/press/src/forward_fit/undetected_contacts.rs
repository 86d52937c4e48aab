//! Computes which curvatures are compatible with readings that do not show a contact.

use std::cmp::Ordering;

use super::contact_detection::on_markers;
use super::problem::Problem;
use super::start::{Shapes, median};
use crate::Interval;
use crate::least_squares::LeastSquares;
use crate::unknowns::{ACROSS, ALONG, CURVATURE, State, Sums};

/// Largest radius of the tried contacts, relative to the sensor's radius.
const MAX_RADIUS: f64 = 0.9;
/// Ratio of each tried contact radius to the next larger one.
const RADIUS_RATIO: f64 = 0.8;
const RADII: usize = 32;
const MAX_PLACES: usize = 100;
/// Radius of the widest contact that can remain undetected between two neighbouring markers, relative to the distance
/// between these markers.
const HIDDEN: f64 = 0.5;
/// The fit of a tried contact stops if the next step is predicted to decrease chi-squared by less than this value.
const ENOUGH: f64 = 1e-2;
/// Standard deviation of a weak prior for the logarithm of the curvature. Readings without a detected contact hardly
/// determine the curvature, and the prior keeps standard errors finite.
const PRIOR_STD: f64 = 3.0;

/// Contacts with the stated indentation that are possible although the readings show no contact. For each of several
/// contact radii, the list contains one contact, at the position with the smallest chi-squared.
pub(super) struct UndetectedContacts<'p, 'a> {
    problem: &'p Problem<'a>,
    found: Vec<Candidate>,
}

#[derive(Clone, Copy)]
struct Candidate {
    state: State,
    sums: Sums,
    /// Radius of the contact, relative to the widest contact that can remain undetected between neighbouring markers.
    relative_radius: f64,
}

impl Candidate {
    fn likelier(one: &&Self, other: &&Self) -> Ordering {
        one.sums.chi_squared.total_cmp(&other.sums.chi_squared)
    }
}

impl<'p, 'a> UndetectedContacts<'p, 'a> {
    pub(super) fn new(problem: &'p Problem<'a>) -> Option<Self> {
        problem.reading.indentation?;
        let narrower = |radius: &f64| Some(RADIUS_RATIO * radius);
        let radii: Vec<f64> = std::iter::successors(Some(MAX_RADIUS), narrower)
            .take(RADII)
            .collect();
        let shapes = Shapes::new(problem, &radii);
        let places = problem.reading.markers.places();
        let every = places.len().div_ceil(MAX_PLACES).max(1);
        let mut best: Vec<Option<(f64, State)>> = vec![None; radii.len()];
        let mut spacings = Vec::new();
        for marker in places.iter().step_by(every) {
            let place = problem.place_at(marker.direction.as_ref());
            spacings.push(neighbour(problem, &place));
            for (best, state) in best.iter_mut().zip(shapes.states(problem, place)) {
                let is_better =
                    |(cost, _): &(f64, State)| best.as_ref().is_none_or(|(least, _)| cost < least);
                if let Some(state) = state.filter(is_better) {
                    *best = Some(state);
                }
            }
        }
        let hidden = HIDDEN * median(&spacings);
        let near = |state: State, held: Option<usize>| {
            let near = problem.minimum(state, ENOUGH, held).ok();
            let near = near.filter(|(state, _)| on_markers(problem, state).is_ok());
            let sums = || Some((state, problem.sums(&state).ok()?));
            let (state, sums) = near.or_else(sums)?;
            Some(Candidate {
                state,
                sums,
                relative_radius: problem.contact(&state).ok()?.radius / hidden,
            })
        };
        let of_radii = best.into_iter().flatten();
        let mut unseen = Self {
            found: of_radii
                .filter_map(|(_, state)| near(state, Some(CURVATURE)))
                .collect(),
            problem,
        };
        // Only a few contact radii were tried, and the best radius may be between two of them. Therefore fit the
        // radius, starting at the best tried radius.
        let best = unseen.likeliest().and_then(|best| near(best, None));
        unseen.found.extend(best);
        let log_curvature = |one: &Candidate| one.state.log_curvature;
        unseen
            .found
            .sort_by(|one, other| log_curvature(one).total_cmp(&log_curvature(other)));
        Some(unseen)
    }

    pub(super) fn likeliest(&self) -> Option<State> {
        Some(self.found.iter().min_by(Candidate::likelier)?.state)
    }

    /// The most likely contact and the interval of the curvature. A curvature is in the interval if its chi-squared
    /// exceeds the smallest chi-squared by less than `limit`. The result is `None` in three cases: all tried contacts
    /// are in the interval, even the widest contact in the interval could remain undetected between the markers, or no
    /// tried contact would show clearly in the readings.
    pub(super) fn left(&self, limit: f64) -> Option<(State, Sums, Interval)> {
        let best = self.found.iter().min_by(Candidate::likelier)?;
        let least = best.sums.chi_squared;
        let root = |one: &Candidate| (one.sums.chi_squared - least).max(0.0).sqrt();
        let is_left = |one: &Candidate| root(one) < limit.sqrt();
        let widest = self.found.iter().position(is_left)?;
        let narrowest = self.found.iter().rposition(is_left)?;
        let leaves_all = widest == 0 && narrowest + 1 == self.found.len();
        let is_clear = |one: &Candidate| self.clarity(&one.state) > limit;
        if self.found[widest].relative_radius < 1.0
            || leaves_all
            || !self.found.iter().any(is_clear)
        {
            return None;
        }
        // The interval of the curvature ends where the increase of chi-squared reaches `limit`. The square root of this
        // increase is interpolated linearly.
        let end = |inside: usize, outside: Option<usize>| {
            let (inside, outside) = (&self.found[inside], self.found.get(outside?)?);
            let share = (limit.sqrt() - root(inside)) / (root(outside) - root(inside));
            let way = outside.state.log_curvature - inside.state.log_curvature;
            Some(libm::exp(inside.state.log_curvature + share * way))
        };
        let interval = Interval {
            low: end(widest, widest.checked_sub(1)),
            high: end(narrowest, Some(narrowest + 1)),
        };
        let mut sums = best.sums;
        let scale = self.problem.reading.markers.scale();
        for (unknown, std) in [(CURVATURE, PRIOR_STD), (ALONG, scale), (ACROSS, scale)] {
            sums.hessian[(unknown, unknown)] += 1.0 / (std * std);
        }
        Some((best.state, sums, interval))
    }
}

impl UndetectedContacts<'_, '_> {
    /// Signal of a contact in the readings: the sum of the squared displacements that the contact causes, in standard
    /// deviations of the noise.
    fn clarity(&self, state: &State) -> f64 {
        let problem = self.problem;
        let Ok(contact) = problem.contact(state) else {
            return 0.0;
        };
        let moved = problem.displacements(&contact, state);
        let square = |marker: usize| {
            let normal = (moved[marker].normal - state.others[0]) / problem.normal_std;
            let along = moved[marker]
                .tangential
                .map(|along| along / problem.tangential_std);
            let along = along.iter().map(|along| along * along).sum::<f64>();
            normal * normal
                + if problem.uses_tangential() {
                    along
                } else {
                    0.0
                }
        };
        problem.counting().map(square).sum()
    }
}

/// Distance from the marker at `place` to its nearest neighbour.
fn neighbour(problem: &Problem<'_>, place: &crate::Place) -> f64 {
    let distances = problem
        .sights(place)
        .into_iter()
        .map(|sight| sight.distance);
    let apart = 1e-6 * problem.reading.markers.scale();
    distances
        .filter(|&distance| distance > apart)
        .fold(f64::INFINITY, f64::min)
}
