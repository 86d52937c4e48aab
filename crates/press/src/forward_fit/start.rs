//! Where a fit begins.

use nalgebra::Vector3;

use super::problem::{INDENTATION, Problem, State};
use super::{Measured, Prior};
use crate::markers::Sight;

/// Markers at which the contact is tried: those that moved most; and between the two, three … of them.
const MARKERS: usize = 4;
/// Radii of the contact that are tried, in radii of the sensor.
const RADII: [f64; 5] = [0.03, 0.07, 0.14, 0.24, 0.4];

/// States from which to begin, the likeliest first.
pub(super) fn starts(problem: &Problem<'_>) -> Vec<State> {
    let baseline = match problem.fit.baseline {
        Prior::Exact => 0.0,
        Prior::Within(_) | Prior::Free => median(problem.reading.normal),
    };
    let skin = problem.reading.markers.skin();
    let mut best: Vec<(f64, State)> = Vec::new();
    for direction in places(problem) {
        let from = State {
            log_curvature: 0.0,
            place: problem.place_at(&direction),
            indentation: 0.0,
            baseline,
            gain: 1.0,
        };
        let sights = problem.sights(&from.place);
        let states = RADII.iter().filter_map(|radius| {
            let state = of_radius(problem, radius * skin.radius(), from, &sights)?;
            problem.cost(&state, &sights).ok().map(|cost| (cost, state))
        });
        best.extend(states);
    }
    best.sort_by(|one, other| one.0.total_cmp(&other.0));
    best.into_iter().map(|(_, state)| state).collect()
}

/// The state with a contact of this radius, and with the indentation or the gain that suits the readings best where
/// they are free.
fn of_radius(problem: &Problem<'_>, radius: f64, from: State, sights: &[Sight]) -> Option<State> {
    let [depth, _] = problem.fit.body.indentation_of(radius).ok()?;
    let amplitude = |state: State| -> Option<f64> {
        let contact = problem.contact(&state).ok()?;
        let (mut product, mut square) = (0.0, 0.0);
        for (read, sight) in problem.reading.normal.iter().zip(sights) {
            let moved = contact.displacement(sight.distance).normal;
            product += (read - state.baseline) * moved;
            square += moved * moved;
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

/// Directions of the contact that are tried.
fn places(problem: &Problem<'_>) -> Vec<Vector3<f64>> {
    let normal = problem.reading.normal;
    let mut order: Vec<usize> = (0..normal.len()).collect();
    let by_displacement = |one: &usize, other: &usize| normal[*other].total_cmp(&normal[*one]);
    if order.len() > MARKERS {
        order.select_nth_unstable_by(MARKERS - 1, by_displacement);
        order.truncate(MARKERS);
    }
    order.sort_by(by_displacement);
    let directions: Vec<Vector3<f64>> = order
        .iter()
        .map(|&marker| {
            problem.reading.markers.places()[marker]
                .direction
                .into_inner()
        })
        .collect();
    let between = (2..=directions.len()).filter_map(|count| {
        let sum: Vector3<f64> = directions[..count].iter().sum();
        sum.try_normalize(1e-9)
    });
    directions.iter().copied().chain(between).collect()
}

pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() {
        return 0.0;
    }
    *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
}
