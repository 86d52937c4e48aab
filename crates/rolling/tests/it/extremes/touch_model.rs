//! Fingertips that glide by another model: tolerances, and rungs that cannot do it.

use palpate_geometry::Shape;
use palpate_rolling::{Fingertip, Glider, InvalidTouch, Touch, TouchModel};
use palpate_verdict::{Answer, NO_LENGTHS, rows};

use crate::scenes::{cylinder, paraboloid, plane, sphere};

const ON: &str = "rolling::Glider::on";
const TOUCH: &str = "rolling::Glider::touch";
const TIP: Fingertip = Fingertip::Sphere { radius: 0.5 };
const TOLERANCES: [f64; 5] = [1e-14, 1e-12, 1e-6, 1e-3, 0.1];

rows! {
    ON, "{name}, tolerance {tolerance:e}", "tolerance" => glider(sphere(1.0), TIP, model),
        for tolerance in NO_LENGTHS.into_iter().chain([1e-15, 0.11]), for (name, model) in models(tolerance);
    ON, "closed form of a round tip on a hill", "unsupported" => glider(paraboloid(0.5), TIP, TouchModel::ClosedForm);
    ON, "Newton of a point", "unsupported" =>
        glider(sphere(1.0), Fingertip::Point, TouchModel::Newton { tolerance: 1e-9 });
    TOUCH, "Newton within {tolerance:e}, sphere of {size:e}, tip {ratio:e} times as large" =>
        on_sphere(size, ratio, tolerance),
        for tolerance in TOLERANCES, for size in [1e-9, 1.0, 1e9], for ratio in [1e-3, 1.0, 1e3];
    TOUCH, "Newton within {tolerance:e} on a {name}: as in closed form" => as_closed(object, tolerance),
        for tolerance in TOLERANCES,
        for (name, object) in [("plane", plane()), ("cylinder", cylinder(1.0, 0.4f64.to_degrees()))];
}

fn glider(object: Shape, tip: Fingertip, model: TouchModel) -> Result<Glider, &'static str> {
    let glider = Glider::new(object, tip).unwrap().on(model);
    glider.map_err(|error| match error {
        InvalidTouch::Tip(_) => "invalid-shape",
        InvalidTouch::Unsupported { .. } => "unsupported",
        InvalidTouch::Tolerance { .. } => "tolerance",
    })
}

const fn models(tolerance: f64) -> [(&'static str, TouchModel); 2] {
    [
        ("auto", TouchModel::Auto { tolerance }),
        ("Newton", TouchModel::Newton { tolerance }),
    ]
}

fn touched(glider: &Glider, x: f64, y: f64) -> Result<Touch, &'static str> {
    glider.touch(x, y).map_err(|error| error.name())
}

/// The contact is where the line from centre to centre leaves the sphere, `x R/(R + r)`; within the tolerance of the
/// tip's radius.
fn on_sphere(size: f64, ratio: f64, tolerance: f64) -> Result<Answer, &'static str> {
    let radius = size * ratio;
    let (x, y) = (0.36 * (size + radius), 0.48 * (size + radius));
    let (tip, newton) = (
        Fingertip::Sphere { radius },
        TouchModel::Newton { tolerance },
    );
    let touch = touched(&glider(sphere(size), tip, newton)?, x, y)?;
    let truth = [0.36 * size, 0.48 * size, 0.8 * size];
    let pairs = [0, 1, 2].map(|axis| (touch.point[axis], truth[axis]));
    let answer = Answer::all_at_scale(pairs, radius).within(tolerance);
    Ok(answer.conditioned(1.0 + ratio + 1.0 / ratio))
}

fn as_closed(object: Shape, tolerance: f64) -> Result<Answer, &'static str> {
    let closed = Glider::new(object.clone(), TIP).unwrap();
    let newton = glider(object, TIP, TouchModel::Newton { tolerance })?;
    let found = touched(&newton, 0.2, 0.3)?;
    let truth = touched(&closed, 0.2, 0.3)?;
    let pairs = [0, 1, 2].map(|axis| (found.point[axis], truth.point[axis]));
    let answer = Answer::all_at_scale(pairs, 0.5).within(tolerance);
    Ok(answer.conditioned(10.0))
}
