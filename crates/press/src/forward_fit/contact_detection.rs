//! Decides whether the readings of a press show a contact.

use palpate_statistics::HALF_WIDTHS;

use super::Prior;
use super::problem::{Problem, WRONG};
use super::start::median;
use crate::PressError;
use crate::least_squares::LeastSquares;
use crate::markers::see;
use crate::outcome::no_contact;
use crate::unknowns::State;

/// False alarm rate: probability that a contact is detected although there is none. The value is valid if contacts are
/// tried only at the positions of the markers. On a thin layer, a fit also finds contacts between the markers, which
/// increases the probability by about 0.005.
const FALSE_ALARM_RATE: f64 = 0.04;
/// Smallest decrease of chi-squared by a contact, summed over all markers except the one with the largest decrease. If
/// the sum is smaller and this one marker moved significantly, it alone shows the contact and may be an outlier.
const MIN_IMPROVEMENT_OF_OTHERS: f64 = 9.0;

impl Problem<'_> {
    /// Smallest improvement of chi-squared by a contact, compared with no contact, for which the contact counts as
    /// detected.
    ///
    /// If there is only noise, a contact can still be fitted at each marker. Its indentation and its width are two
    /// degrees of freedom. Half of these contacts would have a negative indentation, which is impossible. The number of
    /// independent tests is at most the number of markers (Bonferroni). If the noise is estimated from the residuals,
    /// the test uses the F distribution.
    pub(super) fn needed(&self) -> f64 {
        let odds = libm::log(self.counting().count() as f64 / (2.0 * FALSE_ALARM_RATE));
        if self.knows_noise() {
            return 2.0 * odds;
        }
        let freedom = self.freedom().max(1) as f64;
        freedom * libm::expm1(2.0 * odds / freedom)
    }

    pub(super) fn without_contact(&self, improvement: f64) -> PressError {
        let (squares, each) = at_rest(self);
        let improvement = improvement.max(0.0);
        no_contact((improvement, self.needed()), squares.into_iter(), each)
    }
}

/// Returns an error if the contact with the fit parameters `state` does not decrease chi-squared enough to count as
/// detected. If only one marker moved significantly, returns the number of this marker, otherwise `None`.
///
/// # Errors
/// [`PressError::NoContact`], or [`PressError::OtherBody`] if the markers moved significantly.
pub(super) fn detect(problem: &Problem<'_>, state: &State) -> Result<Option<usize>, PressError> {
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
    let is_alone = most > WRONG * WRONG && improvement - most < MIN_IMPROVEMENT_OF_OTHERS;
    Ok(is_alone.then_some(marker))
}

/// For each marker, chi-squared of the hypothesis that the marker did not move. The second result is the number of
/// readings per marker from which chi-squared is computed. If the noise is stated, all readings are used. Otherwise
/// only normal displacements are used, and their noise is estimated from the median over all markers.
fn at_rest(problem: &Problem<'_>) -> (Vec<f64>, usize) {
    let baseline = resting(problem);
    let markers = 0..problem.kept.len();
    let readings = markers.map(|marker| problem.readings_of(marker, baseline));
    if problem.knows_noise() {
        return (readings.map(squared).collect(), problem.components());
    }
    let normal: Vec<f64> = readings.map(|[normal, ..]| normal.abs()).collect();
    // Upper bound of the noise. It is computed from the median of the displacements' magnitudes plus three standard
    // errors of this median. The relative standard error of the median of n normally distributed readings is 1.17/√n,
    // and 3 · 1.17 = 3.5.
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

/// The most likely baseline if there is no contact, computed from the mean reading and the prior of the baseline. The
/// baseline is the normal displacement that is common to all markers.
fn resting(problem: &Problem<'_>) -> f64 {
    // The baseline is the normal displacement that is common to all markers. Its prior has the mean 0, and weighs as
    // much as `known` additional readings with the value 0.
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

/// Returns an error if the contact with the fit parameters `state` is neither near a marker nor surrounded by markers.
///
/// # Errors
/// [`PressError::OffMarkers`].
pub(super) fn on_markers(problem: &Problem<'_>, state: &State) -> Result<(), PressError> {
    let contact_radius = problem.contact(state)?.radius;
    see(&problem.sights(&state.place), contact_radius, f64::INFINITY)
}
