//! Whether there is a contact to be seen at all.

use palpate_statistics::HALF_WIDTHS;

use super::problem::{Problem, State, WRONG};
use super::settings::Prior;
use super::start::median;
use crate::PressError;
use crate::markers::see;
use crate::unexplained::unexplained;

/// Share of the presses in which nothing touches that are taken for a contact where one is looked for at the markers alone; a
/// thin layer's hides between them too, and fits find that in about 0.005 more.
const FALSE_ALARMS: f64 = 0.04;
/// Least improvement without a marker that chance alone does not move so far, since it may as well be wrong.
const SEEN_BY_OTHERS: f64 = 9.0;

impl Problem<'_> {
    /// Least improvement of chi-squared by a contact, against none, that counts as one.
    ///
    /// At each marker chance alone finds a contact of the best depth and width that improves chi-squared by two degrees of
    /// freedom, and of the depths half are outward. The markers are the independent places where one is looked for, at most
    /// (Bonferroni). Noise that is found from the residuals makes it Fisher's ratio.
    pub(super) fn needed(&self) -> f64 {
        let odds = libm::log(self.counting().count() as f64 / (2.0 * FALSE_ALARMS));
        if self.knows_noise() {
            return 2.0 * odds;
        }
        let freedom = self.freedom().max(1) as f64;
        freedom * libm::expm1(2.0 * odds / freedom)
    }

    /// Refusal of readings that a contact explains only so much better than none does.
    pub(super) fn without_contact(&self, improvement: f64) -> PressError {
        let (squares, each) = at_rest(self);
        let improvement = improvement.max(0.0);
        unexplained((improvement, self.needed()), squares.into_iter(), each)
    }
}

/// Refuses a state whose contact does not explain the readings clearly better than none, and tells the one marker that moved
/// beyond chance while all others stay where they were, if it is so.
///
/// # Errors
/// [`PressError::NoContact`], or [`PressError::OtherBody`] where the markers moved all the same.
pub(super) fn seen(problem: &Problem<'_>, state: &State) -> Result<Option<usize>, PressError> {
    let baseline = resting(problem);
    let contact = problem.contact(state)?;
    let (mut improvement, mut most, mut marker) = (0.0, 0.0, 0);
    for index in problem.counting() {
        let gain = squared(problem.readings_of(index, baseline))
            - squared(problem.residuals_at(&contact, state, index));
        improvement += gain;
        if gain > most {
            (most, marker) = (gain, index);
        }
    }
    if improvement < problem.needed() {
        return Err(problem.without_contact(improvement));
    }
    let is_alone = most > WRONG * WRONG && improvement - most < SEEN_BY_OTHERS;
    Ok(is_alone.then_some(marker))
}

/// Each marker's chi-squared against rest, on so many readings: of all where the noise is stated, else of its normal displacement
/// beside those of most markers.
fn at_rest(problem: &Problem<'_>) -> (Vec<f64>, usize) {
    let baseline = resting(problem);
    let markers = 0..problem.kept.len();
    let readings = markers.map(|marker| problem.readings_of(marker, baseline));
    if problem.knows_noise() {
        return (readings.map(squared).collect(), problem.components());
    }
    let normal: Vec<f64> = readings.map(|[normal, ..]| normal.abs()).collect();
    // Three standard deviations of how far chance takes the median of normally distributed noise.
    let chance = 1.0 + 3.5 / (normal.len() as f64).sqrt();
    let noise = chance * median(&normal) / HALF_WIDTHS[0];
    let squares = normal
        .iter()
        .map(|normal| normal / noise * (normal / noise));
    (squares.filter(|square| square.is_finite()).collect(), 1)
}

fn squared(residuals: [f64; 3]) -> f64 {
    residuals.iter().map(|one| one * one).sum()
}

/// Normal displacement of all markers where nothing touches: the likeliest by the mean reading and by what is known of it.
fn resting(problem: &Problem<'_>) -> f64 {
    // Readings that count as much as what is known beforehand, which is of 0.
    let known = match problem.fit.baseline {
        Prior::Exact => return 0.0,
        Prior::Within(std) => (problem.normal_std / std).powi(2),
        Prior::Free => 0.0,
    };
    let kept = problem
        .counting()
        .map(|marker| problem.reading.normal[marker]);
    let (sum, count) = kept.fold((0.0, known), |(sum, count), value| {
        (sum + value, count + 1.0)
    });
    sum / count
}

/// Refuses a state whose contact has no marker near it and is not surrounded by markers.
///
/// # Errors
/// [`PressError::OffMarkers`].
pub(super) fn on_markers(problem: &Problem<'_>, state: &State) -> Result<(), PressError> {
    let contact_radius = problem.contact(state)?.radius;
    see(&problem.sights(&state.place), contact_radius, f64::INFINITY)
}
