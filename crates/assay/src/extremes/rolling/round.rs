//! Spheres on planes, spheres and cylinders, where rolls have closed forms.

use std::f64::consts::TAU;

use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Cylinder, Plane, Sphere};
use palpate_rolling::{Chart, Model, Motion};

use super::super::Precise;
use super::super::answer::Named;
use super::super::{Answer, Case};
use super::{MADE, ended, numbers, roll, roller};

const AUTO: Model = Model::Auto {
    tolerance: 1e-9,
    chart: Chart::Free,
};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for exponent in [-12, -9, -6, -3, 0, 3, 6, 9, 12] {
        let ratio = 10f64.powi(exponent);
        for probe in [1e-9, 1.0, 1e9] {
            let input = format!("probe {probe:e}, sphere {ratio:e} times as large, 0.1 rad");
            cases.push(Case::value(
                "rolling::Roller::shift",
                input.clone(),
                move || shift(probe, sphere(probe * ratio), 1.0 / (probe * ratio), 0.1),
            ));
            cases.push(Case::value("rolling::Roller::roll", input, move || {
                place(probe, probe * ratio, 0.1, Model::ClosedForm, 1e-14)
            }));
        }
    }
    for turns in [1e-300, 1e-12, 1e-6, 0.1, 1.0, 1000.0, 1e9] {
        let theta = turns * TAU;
        let objects = [
            (Shape::Plane(Plane), 0.0),
            (sphere(3.0), 1.0 / 3.0),
            (Shape::Cylinder(Cylinder::new(0.5, 1.0).expect(MADE)), 0.0),
        ];
        for (object, curvature) in objects {
            let input = format!("{}, {turns:e} turns", object.name());
            // Along the cylinder's axis, where it is flat.
            let direction = if curvature == 0.0 { 1.0 } else { 0.3 };
            cases.push(Case::value("rolling::Roller::shift", input, move || {
                shift_along(1.0, object, curvature, direction, theta)
            }));
        }
        let input = format!("sphere of radius 3, {turns:e} turns");
        cases.push(Case::value("rolling::Roller::roll", input, move || {
            place(1.0, 3.0, theta, AUTO, 1e-14)
        }));
    }
    for arc in [0.0, 1e-300, 1e-12, 1e-3, 1.0, 1e6] {
        cases.push(Case::value(
            "rolling::Roller::duration_for_arc",
            format!("sphere of radius 3, arc {arc:e}"),
            move || duration(arc),
        ));
    }
    cases
}

fn sphere(radius: f64) -> Shape {
    Shape::Sphere(Sphere::new(radius).expect(MADE))
}

fn shift(probe: f64, object: Shape, curvature: f64, theta: f64) -> Result<Answer, Named> {
    shift_along(probe, object, curvature, 0.3, theta)
}

/// The path on the probe is `θ/(1/R₁ + k₂)` long, and the shift what is left of it in half a turn.
fn shift_along(
    probe: f64,
    object: Shape,
    curvature: f64,
    direction: f64,
    theta: f64,
) -> Result<Answer, Named> {
    let relative = Precise::new(1.0) / probe + curvature;
    let path = Precise::new(theta) / &relative;
    let turn = Precise::pi() * 2.0 * probe;
    let turns = (path.to_f64() / turn.to_f64()).round();
    let rest = (&path - turn * turns).to_f64().abs();
    let motion = Motion::rolling(direction, 1.0, theta);
    let found = roller(probe, object, (0.0, 0.0), AUTO, motion)?
        .shift(&[motion])
        .map_err(ended)?;
    let scale = (Precise::new(1.0) / relative).to_f64() * theta.clamp(1e-150, 1.0);
    let pairs = [
        (found.arc_length, path.to_f64()),
        (found.displacement.norm(), rest),
    ];
    Ok(Answer::all_at_scale(pairs, scale)
        .within(1e-14)
        .conditioned(theta.max(1.0)))
}

/// After the path s the contact is at the angle `s/R₂` from the top.
fn place(probe: f64, radius: f64, theta: f64, model: Model, bound: f64) -> Result<Answer, Named> {
    let relative = Precise::new(1.0) / probe + Precise::new(1.0) / radius;
    let path = Precise::new(theta) / &relative;
    let angle = &path / radius;
    let motion = Motion::rolling(0.0, 1.0, theta);
    let contact = roll(
        &roller(probe, sphere(radius), (0.0, 0.0), model, motion)?,
        motion,
    )?;
    let scale = (Precise::new(1.0) / &relative).to_f64();
    let pairs = [
        (contact.on_object.x, (angle.sin() * radius).to_f64()),
        (contact.on_object.z, (angle.cos() * radius).to_f64()),
        (contact.arc_length, path.to_f64()),
    ];
    // Coordinates have no more digits than the object's size leaves them.
    let condition = (radius / scale).max(1.0) * theta.max(1.0);
    Ok(Answer::all_at_scale(pairs, scale)
        .within(bound)
        .conditioned(condition)
        .also(numbers(&contact)))
}

/// `s (1/R₁ + 1/R₂)/ω`.
fn duration(arc: f64) -> Result<Answer, Named> {
    let truth = (Precise::new(arc) * 4.0 / 3.0 / 0.7).to_f64();
    let motion = Motion::rolling(0.3, 0.7, 1.0);
    let roller = roller(1.0, sphere(3.0), (0.0, 0.0), AUTO, motion)?;
    let found = roller.duration_for_arc(&motion, arc).map_err(ended)?;
    Ok(Answer::near(found, truth).within(1e-14))
}
