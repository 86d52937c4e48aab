//! Fingertips that glide by another model: tolerances, and rungs that cannot do it.

use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Cylinder, Graph, Plane, Sphere};
use palpate_rolling::{Fingertip, GlideError, Glider, InvalidTouch, Touch, TouchModel};

use super::super::answer::Named;
use super::super::{Answer, Case};
use super::MADE;

const ENTRY: &str = "rolling::Glider::on";
const TIP: Fingertip = Fingertip::Sphere { radius: 0.5 };

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for tolerance in [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -1.0,
        -0.0,
        0.0,
        f64::from_bits(1),
        1e-15,
        0.11,
        f64::MAX,
    ] {
        for (name, model) in [
            ("auto", TouchModel::Auto { tolerance }),
            ("Newton", TouchModel::Newton { tolerance }),
        ] {
            cases.push(Case::refusal(
                ENTRY,
                format!("{name}, tolerance {tolerance:e}"),
                move || glider(sphere(1.0), TIP)?.on(model).map_err(invalid),
            ));
        }
    }
    cases.push(Case::refusal(
        ENTRY,
        "closed form of a round tip on a hill",
        || {
            let hill = Shape::Paraboloid(Graph::paraboloid(0.5).expect(MADE));
            glider(hill, TIP)?
                .on(TouchModel::ClosedForm)
                .map_err(invalid)
        },
    ));
    cases.push(Case::refusal(ENTRY, "Newton of a point", || {
        let newton = TouchModel::Newton { tolerance: 1e-9 };
        glider(sphere(1.0), Fingertip::Point)?
            .on(newton)
            .map_err(invalid)
    }));
    for tolerance in [1e-14, 1e-12, 1e-6, 1e-3, 0.1] {
        for size in [1e-9, 1.0, 1e9] {
            for ratio in [1e-3, 1.0, 1e3] {
                cases.push(Case::value(
                    "rolling::Glider::touch",
                    format!(
                        "Newton within {tolerance:e}, sphere of {size:e}, tip {ratio:e} times as large"
                    ),
                    move || on_sphere(size, ratio, tolerance),
                ));
            }
        }
        for object in [plane, cylinder] {
            let name = object().name();
            cases.push(Case::value(
                "rolling::Glider::touch",
                format!("Newton within {tolerance:e} on a {name}: as in closed form"),
                move || as_closed(object(), tolerance),
            ));
        }
    }
    cases
}

fn sphere(radius: f64) -> Shape {
    Shape::Sphere(Sphere::new(radius).expect(MADE))
}

const fn plane() -> Shape {
    Shape::Plane(Plane)
}

fn cylinder() -> Shape {
    Shape::Cylinder(Cylinder::new(1.0, 0.4).expect(MADE))
}

fn glider(object: Shape, tip: Fingertip) -> Result<Glider, Named> {
    Glider::new(object, tip).map_err(|_| Named("invalid-shape"))
}

fn invalid(error: InvalidTouch) -> Named {
    Named(match error {
        InvalidTouch::Tip(_) => "invalid-shape",
        InvalidTouch::Unsupported { .. } => "unsupported",
        InvalidTouch::Tolerance { .. } => "tolerance",
    })
}

fn touched(glider: &Glider, x: f64, y: f64) -> Result<Touch, Named> {
    let touch = glider.touch(x, y);
    touch.map_err(|error: GlideError| Named(error.name()))
}

/// The contact is where the line from centre to centre leaves the sphere, `x R/(R + r)`; within the tolerance of the
/// tip's radius.
fn on_sphere(size: f64, ratio: f64, tolerance: f64) -> Result<Answer, Named> {
    let radius = size * ratio;
    let (x, y) = (0.36 * (size + radius), 0.48 * (size + radius));
    let newton = TouchModel::Newton { tolerance };
    let glider = glider(sphere(size), Fingertip::Sphere { radius })?;
    let touch = touched(&glider.on(newton).map_err(invalid)?, x, y)?;
    let pairs = [
        (touch.point.x, 0.36 * size),
        (touch.point.y, 0.48 * size),
        (touch.point.z, 0.8 * size),
    ];
    let answer = Answer::all_at_scale(pairs, radius).within(tolerance);
    Ok(answer.conditioned(1.0 + ratio + 1.0 / ratio))
}

fn as_closed(object: Shape, tolerance: f64) -> Result<Answer, Named> {
    let closed = glider(object, TIP)?;
    let newton = closed.on(TouchModel::Newton { tolerance });
    let found = touched(&newton.map_err(invalid)?, 0.2, 0.3)?;
    let truth = touched(&closed, 0.2, 0.3)?;
    let pairs = (0..3).map(|axis| (found.point[axis], truth.point[axis]));
    let answer = Answer::all_at_scale(pairs, 0.5).within(tolerance);
    Ok(answer.conditioned(10.0))
}
