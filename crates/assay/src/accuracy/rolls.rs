//! Rolls against closed forms, and what EP1 makes of them.

use anyhow::{Context, Result};
use nalgebra::Vector3;
use palpate_geometry::Shape;
use palpate_rolling::{Contact, HeldAxis};
use palpate_sweep::Summary;

use super::figure::Figure;
use crate::hot::rolls::{Chart, DIRECTION, Ep1, Model, motion, paraboloid, roller, sphere};

const TRIALS: u64 = 1 << 14;

pub(super) fn figures() -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (object, shape) in [("sphere", sphere()?), ("paraboloid", paraboloid()?)] {
        for angle_rad in [0.1, 6.0] {
            for (rung, model) in rungs(object) {
                let roller = roller(shape.clone(), model, angle_rad)?;
                let contact = roller.roll(&[motion(angle_rad)])?;
                let error = against_closed_form(&shape, angle_rad, &contact)?;
                let name = format!("roll {angle_rad} rad over a {object}, {rung}");
                figures.push(Figure::new(name, error));
            }
        }
    }
    for (sensor, setting) in [("uniform errors", Ep1::UNIFORM), ("pads", Ep1::PADS)] {
        let statistics = Ep1::new(setting)?.statistics(TRIALS)?;
        let error = |index: usize| -> Result<f64> {
            let summary: &Summary = statistics.quantities.get(index).context("no quantity")?;
            summary.relative_rms_error.context("no error")
        };
        figures.push(Figure::new(
            format!("EP1, {sensor}, normal curvature"),
            error(0)?,
        ));
        figures.push(Figure::new(
            format!("EP1, {sensor}, gaussian curvature"),
            error(2)?,
        ));
    }
    Ok(figures)
}

/// Names and models of all rungs that can roll over the object.
fn rungs(object: &str) -> Vec<(&'static str, Model)> {
    let charts = Chart::Montana(HeldAxis::Transported);
    let rk4 = |chart| Model::Rk4 { steps: 64, chart };
    let dop853 = |tolerance, chart| Model::Dop853 { tolerance, chart };
    let exact = match object {
        "sphere" => ("closed form", Model::ClosedForm),
        _ => ("meridian", Model::Meridian),
    };
    vec![
        exact,
        ("RK4, 64 steps, chart-free", rk4(Chart::Free)),
        ("RK4, 64 steps, in charts", rk4(charts)),
        ("DOP853, 1e-6, chart-free", dop853(1e-6, Chart::Free)),
        ("DOP853, 1e-6, in charts", dop853(1e-6, charts)),
        ("DOP853, 1e-10, chart-free", dop853(1e-10, Chart::Free)),
        ("DOP853, 1e-10, in charts", dop853(1e-10, charts)),
    ]
}

/// Error of a roll of the unit sphere from the top: how far the contact is from where the closed form has it, in any
/// coordinate, on the object or on the probe.
///
/// # Errors
/// If there is no closed form for the object.
pub(crate) fn against_closed_form(
    object: &Shape,
    angle_rad: f64,
    contact: &Contact,
) -> Result<f64> {
    let (axial, height, path) = match object {
        // Both turn by half the angle.
        Shape::Sphere(_) => {
            let half = 0.5 * angle_rad;
            (libm::sin(half), libm::cos(half), half)
        }
        Shape::Paraboloid(_) => {
            let r = radius_on_paraboloid(angle_rad);
            (r, -r * r, length_on_paraboloid(r))
        }
        other => anyhow::bail!("no closed form of a roll over a {}", other.name()),
    };
    let along = Vector3::new(libm::cos(DIRECTION), libm::sin(DIRECTION), 0.0);
    let on_object = along * axial + Vector3::z() * height;
    let on_probe = along * libm::sin(path) - Vector3::z() * libm::cos(path);
    let off_object = (contact.on_object.coords - on_object).amax();
    Ok(off_object.max((contact.on_probe(1.0).coords - on_probe).amax()))
}

/// Distance from the axis at which the unit sphere touches z = −r² after it has turned by `angle_rad`, the sum of the
/// slope's angle and the meridian's length.
fn radius_on_paraboloid(angle_rad: f64) -> f64 {
    let mut r = angle_rad / 3.0;
    for _ in 0..60 {
        let slope = 2.0 * r;
        let excess = libm::atan(slope) + length_on_paraboloid(r) - angle_rad;
        r -= excess / (2.0 / (1.0 + slope * slope) + libm::hypot(slope, 1.0));
    }
    r
}

/// Length of the meridian of z = −r² from the apex to `r`.
fn length_on_paraboloid(r: f64) -> f64 {
    let slope = 2.0 * r;
    0.5 * r * libm::hypot(slope, 1.0) + 0.25 * libm::asinh(slope)
}
