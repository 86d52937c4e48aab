//! Whether there is a contact to be seen at all.

use super::problem::{Problem, State};
use super::settings::Prior;
use crate::PressError;
use crate::markers::see;

/// Least improvement of chi-squared by a contact, against none, that counts as one.
const SEEN: f64 = 16.0;
/// Least improvement without the marker that gains most, since one marker alone may as well be wrong.
const SEEN_BY_OTHERS: f64 = 9.0;

/// The refusal where even the start explains nothing.
pub(super) const NOTHING: PressError = PressError::NoContact {
    improvement: 0.0,
    needed: SEEN,
};

/// Refuses a state whose contact does not explain the readings clearly better than none.
///
/// # Errors
/// [`PressError::NoContact`], and [`PressError::OneMarker`] where all but one marker stay where they were.
pub(super) fn seen(problem: &Problem<'_>, state: &State) -> Result<(), PressError> {
    let baseline = resting(problem);
    let contact = problem.contact(state)?;
    let (mut improvement, mut most, mut marker) = (0.0, 0.0, 0);
    for index in problem.counting() {
        let squared = |residuals: [f64; 3]| residuals.iter().map(|one| one * one).sum::<f64>();
        let gain = squared(problem.readings_of(index, baseline))
            - squared(problem.residuals_at(&contact, state, index));
        improvement += gain;
        if gain > most {
            (most, marker) = (gain, index);
        }
    }
    if improvement < SEEN {
        return Err(PressError::NoContact {
            improvement,
            needed: SEEN,
        });
    }
    if improvement - most < SEEN_BY_OTHERS {
        return Err(PressError::OneMarker {
            marker,
            improvement: improvement - most,
            needed: SEEN_BY_OTHERS,
        });
    }
    Ok(())
}

/// Normal displacement of all markers where nothing touches: the mean reading, or 0 if the baseline is known to be
/// exact.
fn resting(problem: &Problem<'_>) -> f64 {
    if problem.fit.baseline == Prior::Exact {
        return 0.0;
    }
    let kept = problem.reading.normal.iter().zip(&problem.kept);
    let (sum, count) = kept
        .filter(|(_, kept)| **kept)
        .fold((0.0, 0.0), |(sum, count), (value, _)| {
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
