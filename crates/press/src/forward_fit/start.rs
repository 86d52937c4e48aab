//! Start values for a fit of displacements.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};

use super::Prior;
use super::problem::Problem;
use crate::least_squares::LeastSquares;
use crate::markers::Sight;
use crate::unknowns::State;
use crate::{Displacement, Place};

/// Number of markers at which contacts are tried as start values. They are the markers that moved most. Contacts are
/// also tried at the mean positions of the first two, three and four of these markers.
const MARKERS: usize = 4;
/// Distances at which contacts outside the area of the markers are tried, in units of the length scale
/// `Markers::extent`, which is at most the sensor's radius.
const BEYOND: [f64; 3] = [0.2, 0.7, 1.5];
/// Limit for a contact outside the area of the markers: it is a start value only if its chi-squared is less than this
/// value above the smallest chi-squared of the contacts among the markers.
const MAX_EXCESS: f64 = 50.0;
/// Contact radii that are tried, in units of the length scale `Markers::extent`, which is at most the sensor's radius.
/// The first entry is a medium radius, which is tried at all places.
pub(super) const RADII: [f64; 5] = [0.14, 0.03, 0.07, 0.24, 0.4];
/// Number of places at which all radii are tried: the most likely places for a contact of medium radius.
const VIEWS: usize = 3;

/// Start values: the `few` most likely contacts among the markers, and the most likely contact outside the area of the
/// markers. The contact outside is omitted if it is much less likely than the contacts among the markers.
pub(super) fn starts(problem: &Problem<'_>, few: usize) -> Vec<State> {
    let shapes = Shapes::new(problem, &RADII);
    let mut near = tried(problem, &shapes, &with_between(most_moved(problem)));
    let mut beyond = tried(problem, &shapes, &beyond(problem));
    near.truncate(few);
    beyond.truncate(1);
    let likely = near
        .first()
        .map_or(f64::INFINITY, |(cost, _)| cost + MAX_EXCESS);
    beyond.retain(|(cost, _)| *cost < likely);
    near.into_iter()
        .chain(beyond)
        .map(|(_, state)| state)
        .collect()
}

/// Tables of the skin's displacements, one for each of several contact radii. A table contains the displacements at
/// fixed distances (nodes) from the contact. The largest distance is π times `Markers::extent`.
pub(super) struct Shapes {
    furthest: f64,
    /// For each radius, the indentation at a relative curvature of 1 and the displacements at the nodes; `None` if the
    /// contact is impossible.
    contacts: Vec<Option<(f64, Vec<Displacement>)>>,
}

impl Shapes {
    /// Number of intervals between the nodes, which are the tabulated distances from the contact.
    const INTERVALS: f64 = 64.0;

    pub(super) fn new(problem: &Problem<'_>, radii: &[f64]) -> Self {
        let scale = problem.reading.markers.extent();
        let furthest = PI * scale;
        let shape = |share: &f64| {
            let unit = problem.fit.body.unit_contact(share * scale).ok()?;
            let at = |node: u32| {
                let share = f64::from(node) / Self::INTERVALS;
                unit.displacement(furthest * share * share)
            };
            let nodes = 0..=Self::INTERVALS as u32;
            Some((unit.indentation, nodes.map(at).collect()))
        };
        Self {
            furthest,
            contacts: radii.iter().map(shape).collect(),
        }
    }

    /// For each tabulated radius, chi-squared and the fit parameters of the best contact of this radius at the place
    /// `place`; `None` if such a contact is impossible.
    pub(super) fn states(&self, problem: &Problem<'_>, place: Place) -> Vec<Option<(f64, State)>> {
        let sights = problem.sights(&place);
        let state = |shape: &Option<_>| of_shape(problem, self, shape.as_ref(), place, &sights);
        self.contacts.iter().map(state).collect()
    }

    fn at(&self, nodes: &[Displacement], distance: f64) -> Displacement {
        let place = Self::INTERVALS * (distance / self.furthest).sqrt().min(1.0);
        let before = (place as usize).min(nodes.len() - 2);
        let share = place - before as f64;
        let [from, to] = [nodes[before], nodes[before + 1]];
        let between = |from: f64, to: f64| from + share * (to - from);
        Displacement {
            normal: between(from.normal, to.normal),
            radial: between(from.radial, to.radial),
        }
    }
}

/// Chi-squared and fit parameters of contacts at the places in the directions `directions` from the sensor's centre,
/// sorted from the most to the least likely. A medium radius is tried in each direction. The other radii are tried only
/// in the best directions.
fn tried(problem: &Problem<'_>, shapes: &Shapes, directions: &[Vector3<f64>]) -> Vec<(f64, State)> {
    let [middling, others @ ..] = &shapes.contacts[..] else {
        return Vec::new();
    };
    let mut views: Vec<(f64, Vec<Sight>, State)> = Vec::new();
    for direction in directions {
        let place = problem.place_at(direction);
        let sights = problem.sights(&place);
        if let Some((cost, state)) = of_shape(problem, shapes, middling.as_ref(), place, &sights) {
            views.push((cost, sights, state));
        }
    }
    views.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut states: Vec<(f64, State)> = Vec::new();
    for (_, sights, state) in views.iter().take(VIEWS) {
        let of_shape =
            |shape: &Option<_>| of_shape(problem, shapes, shape.as_ref(), state.place, sights);
        states.extend(others.iter().filter_map(of_shape));
    }
    states.extend(views.iter().map(|(cost, _, state)| (*cost, *state)));
    states.sort_by(|one, other| one.0.total_cmp(&other.0));
    states
}

/// Chi-squared and fit parameters of a contact with the radius of `shape`. If the indentation or the gain is a fitted
/// parameter, the best value of this parameter is computed.
fn of_shape(
    problem: &Problem<'_>,
    shapes: &Shapes,
    shape: Option<&(f64, Vec<Displacement>)>,
    place: Place,
    sights: &[Sight],
) -> Option<(f64, State)> {
    let fit = problem.fit;
    let (unit, nodes) = shape?;
    let moved: Vec<Displacement> = sights
        .iter()
        .map(|sight| shapes.at(nodes, sight.distance))
        .collect();
    let baseline = match fit.baseline {
        Prior::Exact => 0.0,
        Prior::Within(_) | Prior::Free => median(problem.reading.normal),
    };
    // `amplitude` is the factor by which the displacements of the tabulated contact must be multiplied to fit the
    // readings.
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
            let curvature = known / unit;
            (curvature, amplitude()? / curvature)
        }
        (Some(known), _) => (known / unit, 1.0),
        (None, _) => (amplitude()?, 1.0),
    };
    let indentation = known.unwrap_or(curvature * unit);
    let state = State::new(curvature, place, indentation, [baseline, gain]);
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

/// The given directions, followed by the mean of the first two directions, the mean of the first three, and so on.
fn with_between(mut directions: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
    let between = |count: usize| directions[..count].iter().sum::<Vector3<f64>>();
    let between: Vec<Vector3<f64>> = (2..=directions.len())
        .filter_map(|count| between(count).try_normalize(1e-9))
        .collect();
    directions.extend(between);
    directions
}

/// Directions from the sensor's centre to places outside the area of the markers, on the side where the markers moved
/// most.
fn beyond(problem: &Problem<'_>) -> Vec<Vector3<f64>> {
    let directions = || {
        let places = problem.reading.markers.places().iter();
        places.map(|place| place.direction.into_inner())
    };
    let Some(middle) = directions().sum::<Vector3<f64>>().try_normalize(1e-9) else {
        return Vec::new();
    };
    let (markers, normal) = (problem.reading.markers, problem.reading.normal);
    let middle = markers.skin().place_at(&middle);
    let mean = normal.iter().sum::<f64>() / normal.len().max(1) as f64;
    let (mut growth, mut rim) = (Vector2::zeros(), 0.0_f64);
    for (place, value) in markers.places().iter().zip(normal) {
        let sight = markers.sight(&middle, place);
        growth += sight.bearing * (sight.reach * (value - mean));
        rim = rim.max(sight.distance);
    }
    let Some(outward) = growth.try_normalize(0.0) else {
        return Vec::new();
    };
    let at = |beyond: &f64| {
        let [along, across] = (outward * (rim + beyond * markers.extent())).into();
        markers.skin().beyond(&middle, along, across)
    };
    BEYOND.iter().map(at).collect()
}

pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() {
        return 0.0;
    }
    *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
}
