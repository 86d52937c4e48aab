//! Where a fit begins.

use super::problem::{INDENTATION, Problem, State};
use super::{Measured, Prior};

/// Places of the contact that are tried: the markers that moved most.
const PLACES: usize = 4;
/// Radii of the contact that are tried, in radii of the sensor.
const RADII: [f64; 7] = [0.02, 0.04, 0.08, 0.14, 0.22, 0.32, 0.45];

/// States from which to begin, the likeliest first: the best of each of the likeliest two places.
pub(super) fn starts(problem: &Problem<'_>) -> Vec<State> {
    let baseline = match problem.fit.baseline {
        Prior::Exact => 0.0,
        Prior::Within(_) | Prior::Free => median(problem.reading.normal),
    };
    let mut best: Vec<(f64, State)> = most_moved(problem.reading.normal)
        .into_iter()
        .filter_map(|marker| {
            let direction = problem.reading.markers.places()[marker].direction;
            let place = problem.place_at(direction.as_ref());
            RADII
                .iter()
                .filter_map(|radius| {
                    let radius = radius * problem.reading.markers.skin().radius();
                    let from = State {
                        log_curvature: 0.0,
                        place,
                        indentation: 0.0,
                        baseline,
                        gain: 1.0,
                    };
                    let state = of_radius(problem, radius, from)?;
                    problem.cost(&state).ok().map(|cost| (cost, state))
                })
                .min_by(|one, other| one.0.total_cmp(&other.0))
        })
        .collect();
    best.sort_by(|one, other| one.0.total_cmp(&other.0));
    best.into_iter().take(2).map(|(_, state)| state).collect()
}

/// The state with a contact of this radius, and with the indentation or the gain that suits the readings best where
/// they are free.
fn of_radius(problem: &Problem<'_>, radius: f64, from: State) -> Option<State> {
    let [depth, _] = problem.fit.body.indentation_of(radius).ok()?;
    let amplitude = |state: State| -> Option<f64> {
        let contact = problem.contact(&state).ok()?;
        let (mut product, mut square) = (0.0, 0.0);
        let moved = problem.displacements(
            &contact,
            &State {
                baseline: 0.0,
                ..state
            },
        );
        for (read, moved) in problem.reading.normal.iter().zip(moved) {
            product += (read - state.baseline) * moved.normal;
            square += moved.normal * moved.normal;
        }
        (product > 0.0 && square > 0.0).then(|| product / square)
    };
    match problem.reading.indentation {
        Some(Measured { value, .. }) => {
            let state = State {
                log_curvature: (value / depth).ln(),
                indentation: value,
                ..from
            };
            let gain = match problem.fit.gain {
                Prior::Free => amplitude(state)?,
                Prior::Exact | Prior::Within(_) => 1.0,
            };
            Some(State { gain, ..state })
        }
        None => {
            debug_assert!(problem.sought[INDENTATION]);
            // Displacements are proportional to the curvature at a given radius.
            let unit = State {
                log_curvature: -depth.ln(),
                indentation: 1.0,
                ..from
            };
            let indentation = amplitude(unit)?;
            Some(State {
                log_curvature: unit.log_curvature + indentation.ln(),
                indentation,
                ..unit
            })
        }
    }
}

fn most_moved(normal: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..normal.len()).collect();
    let by_displacement = |one: &usize, other: &usize| normal[*other].total_cmp(&normal[*one]);
    if order.len() > PLACES {
        order.select_nth_unstable_by(PLACES - 1, by_displacement);
        order.truncate(PLACES);
    }
    order
}

pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() {
        return 0.0;
    }
    *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
}
