//! The contact of a ball with a half-space.

use std::hint::black_box;

use anyhow::{Context, Result};
use palpate_press::{Body, PressError};

use super::Figure;
use crate::hot::presses::markers;

const TASK: &str = "press, contact and pressure";
const RADIUS: f64 = 20.0;
const DEPTH: f64 = 1.4;
const YOUNG: f64 = 1.0;
/// The peer's grid: points a side, and its side.
const POINTS: usize = 256;
const SIDE: f64 = 16.0;

/// The contact, its force and pressure, and what moves: the points of the peer's grid, or the markers of a sensor.
pub(super) fn contact() -> Result<Vec<Figure>> {
    let surface = Body::hertz(0.0)?;
    let contact = surface.press(1.0 / RADIUS, DEPTH)?;
    // By the pressure's integral over the contact, 2/3 π a² of its peak, and the force of Hertz's theory.
    let peak = contact.peak_pressure(YOUNG).context("no pressure")?;
    let force = 4.0 / 3.0 * RADIUS.sqrt() * libm::pow(DEPTH, 1.5);
    let radius = (1.5 * force / (std::f64::consts::PI * peak)).sqrt();
    let error = (contact.radius / radius - 1.0).abs();

    let along = |index: usize| (index as f64 + 0.5) * SIDE / POINTS as f64 - 0.5 * SIDE;
    let grid: Vec<f64> = (0..POINTS * POINTS)
        .map(|index| libm::hypot(along(index / POINTS), along(index % POINTS)))
        .collect();
    let markers = markers()?;
    let below = Body::half_space(0.5, 2.0)?;
    Ok(vec![
        Figure::measured(
            TASK,
            "half-space, 256 x 256 points moved",
            error,
            1,
            move || solve(&surface, &grid),
        ),
        Figure::measured(TASK, "half-space, 77 markers moved", error, 1, move || {
            let contact = below.press(1.0 / RADIUS, black_box(DEPTH))?;
            let told = (contact.force(YOUNG), contact.peak_pressure(YOUNG));
            Ok::<_, PressError>((told, markers.displacements(&contact, [0.0, 0.0])))
        }),
    ])
}

type Solved = (Option<f64>, Option<f64>, Vec<f64>);

fn solve(body: &Body, grid: &[f64]) -> Result<Solved, PressError> {
    let contact = body.press(1.0 / RADIUS, black_box(DEPTH))?;
    let moved = grid.iter().map(|&r| contact.displacement(r).normal);
    let told = (contact.force(YOUNG), contact.peak_pressure(YOUNG));
    Ok((told.0, told.1, moved.collect()))
}
