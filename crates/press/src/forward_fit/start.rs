//! States from which a fit begins.

use nalgebra::Vector3;

use super::problem::{Problem, State};
use super::settings::Prior;
use crate::markers::Sight;
use crate::{Displacement, Place};

/// Markers at which the contact is tried: those that moved most; and between the two, three … of them.
const MARKERS: usize = 4;
/// The contact is also tried so far beyond the markers, in radians.
const BEYOND: [f64; 3] = [0.2, 0.7, 1.5];
/// A start that costs so much more than another in chi-squared is not worth beginning from.
const MUCH: f64 = 50.0;
/// Radii of the contact that are tried, in radii of the sensor, a middling one first.
const RADII: [f64; 5] = [0.14, 0.03, 0.07, 0.24, 0.4];
/// Number of directions in which all radii are tried.
const VIEWS: usize = 3;

/// States from which to begin: the `few` likeliest, and the likeliest with a contact beyond the markers if that is not
/// much less likely.
pub(super) fn starts(problem: &Problem<'_>, few: usize) -> Vec<State> {
    let mut near = tried(problem, &with_between(most_moved(problem)));
    let mut beyond = tried(problem, &beyond(problem));
    near.truncate(few);
    beyond.truncate(1);
    let likely = near.first().map_or(f64::INFINITY, |(cost, _)| cost + MUCH);
    beyond.retain(|(cost, _)| *cost < likely);
    near.into_iter()
        .chain(beyond)
        .map(|(_, state)| state)
        .collect()
}

/// States with a contact in these directions, with their costs, the likeliest first: of a middling radius in each, and
/// of all radii in the likeliest few.
fn tried(problem: &Problem<'_>, directions: &[Vector3<f64>]) -> Vec<(f64, State)> {
    let [middling, others @ ..] = RADII;
    let skin = problem.reading.markers.skin();
    let mut views: Vec<(f64, Vec<Sight>, State)> = Vec::new();
    for direction in directions {
        let place = problem.place_at(direction);
        let sights = problem.sights(&place);
        if let Some((cost, state)) = of_radius(problem, middling * skin.radius(), place, &sights) {
            views.push((cost, sights, state));
        }
    }
    views.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut states: Vec<(f64, State)> = Vec::new();
    for (_, sights, state) in views.iter().take(VIEWS) {
        let of_radius =
            |share: &f64| of_radius(problem, share * skin.radius(), state.place, sights);
        states.extend(others.iter().filter_map(of_radius));
    }
    states.extend(views.iter().map(|(cost, _, state)| (*cost, *state)));
    states.sort_by(|one, other| one.0.total_cmp(&other.0));
    states
}

/// The state with a contact of this radius, and with the indentation or the gain that suits the readings best where
/// they are free; and its cost.
fn of_radius(
    problem: &Problem<'_>,
    radius: f64,
    place: Place,
    sights: &[Sight],
) -> Option<(f64, State)> {
    let fit = problem.fit;
    let unit = fit.body.unit_contact(radius).ok()?;
    let moved: Vec<Displacement> = sights
        .iter()
        .map(|sight| unit.displacement(sight.distance))
        .collect();
    let baseline = match fit.baseline {
        Prior::Exact => 0.0,
        Prior::Within(_) | Prior::Free => median(problem.reading.normal),
    };
    // The readings in multiples of the displacements.
    let amplitude = || {
        let (mut product, mut square) = (0.0, 0.0);
        for (read, moved) in problem.reading.normal.iter().zip(&moved) {
            product += (read - baseline) * moved.normal;
            square += moved.normal * moved.normal;
        }
        (product > 0.0 && square > 0.0).then(|| product / square)
    };
    let known = problem.reading.indentation.map(|known| known.value);
    let (curvature, gain) = match (known, fit.gain) {
        (Some(known), Prior::Free) => {
            let curvature = known / unit.indentation;
            (curvature, amplitude()? / curvature)
        }
        (Some(known), _) => (known / unit.indentation, 1.0),
        (None, _) => (amplitude()?, 1.0),
    };
    let state = State {
        log_curvature: libm::log(curvature),
        place,
        indentation: known.unwrap_or(curvature * unit.indentation),
        baseline,
        gain,
    };
    let scaled = |marker: usize| {
        let Displacement { normal, radial } = moved[marker];
        (
            gain * curvature * normal + baseline,
            sights[marker].outward * (curvature * radial),
        )
    };
    problem.contact(&state).ok()?;
    let cost = problem.cost(&state, scaled).ok()?;
    Some((cost, state))
}

/// The directions of the markers that moved most, the furthest first.
fn most_moved(problem: &Problem<'_>) -> Vec<Vector3<f64>> {
    let normal = problem.reading.normal;
    let mut order: Vec<usize> = (0..normal.len()).collect();
    let by_displacement = |one: &usize, other: &usize| normal[*other].total_cmp(&normal[*one]);
    if order.len() > MARKERS {
        order.select_nth_unstable_by(MARKERS - 1, by_displacement);
        order.truncate(MARKERS);
    }
    order.sort_by(by_displacement);
    let direction = |marker: usize| problem.reading.markers.places()[marker].direction;
    order
        .into_iter()
        .map(|marker| direction(marker).into_inner())
        .collect()
}

/// Directions, and those between the first two, three … of them.
fn with_between(mut directions: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
    let between = |count: usize| directions[..count].iter().sum::<Vector3<f64>>();
    let between: Vec<Vector3<f64>> = (2..=directions.len())
        .filter_map(|count| between(count).try_normalize(1e-9))
        .collect();
    directions.extend(between);
    directions
}

/// Directions beyond the markers, on the side to which displacements grow.
fn beyond(problem: &Problem<'_>) -> Vec<Vector3<f64>> {
    let directions = || {
        let places = problem.reading.markers.places().iter();
        places.map(|place| place.direction.into_inner())
    };
    let normal = problem.reading.normal;
    let mean = normal.iter().sum::<f64>() / normal.len().max(1) as f64;
    let growth: Vector3<f64> = directions()
        .zip(normal)
        .map(|(direction, value)| direction * (value - mean))
        .sum();
    let Some(middle) = directions().sum::<Vector3<f64>>().try_normalize(1e-9) else {
        return Vec::new();
    };
    let Some(outward) = (growth - middle * growth.dot(&middle)).try_normalize(0.0) else {
        return Vec::new();
    };
    let rim = directions()
        .map(|direction| direction.dot(&middle))
        .fold(1.0, f64::min);
    let at = |angle: f64| middle * libm::cos(angle) + outward * libm::sin(angle);
    BEYOND
        .iter()
        .map(|beyond| at(libm::acos(rim) + beyond))
        .collect()
}

pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() {
        return 0.0;
    }
    *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
}
