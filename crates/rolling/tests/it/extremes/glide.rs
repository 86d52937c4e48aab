//! Fingertips that glide, from needles to boulders.

use palpate_geometry::Shape;
use palpate_rolling::{Fingertip, Glider, Touch};
use palpate_verdict::{Answer, NO_LENGTHS, NOT_FINITE, Precise, decades, extreme_pairs, rows};

use crate::scenes::{
    cylinder, dish, ellipsoid, height_field, paraboloid, plane, saddle, sphere, torus,
};

const TOUCH: &str = "rolling::Glider::touch";
const GAPS: [f64; 4] = [0.5, 1e-3, 1e-6, 1e-9];

rows! {
    "rolling::Glider::new", "tip {bad:e}", "invalid-shape" => Glider::new(plane(), Fingertip::Sphere { radius: bad }),
        for bad in NO_LENGTHS;
    TOUCH, "sphere of {size:e}, tip {ratio:e} times as large" => on_sphere(size, size * ratio),
        for ratio in decades(-12, 12, 3), for size in [1e-9, 1.0, 1e9];
    TOUCH, "paraboloid of c = 0.5, tip of {ratio:e} at the foot r = 1.2" => on_paraboloid(0.5, ratio, 1.2),
        for ratio in decades(-12, 12, 3);
    TOUCH, "paraboloid of c = 0.5, tip of 0.7 at the foot r = {ratio:e}" => on_paraboloid(0.5, 0.7, ratio),
        for ratio in decades(-12, 12, 3);
    TOUCH, "neighbours {apart:e} apart on a sphere of radius 1e12" => neighbours(apart),
        for apart in decades(-12, 12, 3);
    TOUCH, "tip of {tip:?} of a dish" => in_dish(tip), for tip in GAPS.map(|gap| 1.0 - gap);
    TOUCH, "tip {gap:e} larger than a dish", "two-contacts" => in_dish(1.0 + gap), for gap in GAPS;
    TOUCH, "tip of {tip:?} of a bowl's apex" => on_paraboloid(-0.5, tip, 0.0), for tip in GAPS.map(|gap| 1.0 - gap);
    TOUCH, "tip {gap:e} larger than a bowl's apex", "two-contacts" => on_paraboloid(-0.5, 1.0 + gap, 0.0),
        for gap in GAPS;
    TOUCH, "{tip:?} held at ({x:e}, {y:e}) on a {name} of {size:e}", "off-domain" => touched(shape, tip, x, y),
        for size in [1e-9, 1e9], for bad in NOT_FINITE, for (x, y) in [(bad, 0.0), (0.0, bad), (bad, bad)],
        for tip in tips(size), for (name, shape) in shapes(size);
    TOUCH, "{tip:?} at 256 places on 9 surfaces of {size:e}: finite" => everywhere(size, tip, answered),
        for (size, answered) in [(1e-9, [550, 540]), (1e9, [733, 717])],
        for (tip, answered) in tips(size).into_iter().zip(answered);
}

const fn tips(size: f64) -> [Fingertip; 2] {
    [Fingertip::Point, Fingertip::Sphere { radius: 0.1 * size }]
}

/// One surface of every kind, about as large as `size`.
fn shapes(size: f64) -> [(&'static str, Shape); 9] {
    let wavy = height_field("h*sin(x/s)*cos(y/s)", &[("h", 0.2 * size), ("s", size)]);
    [
        sphere(size),
        dish(size),
        plane(),
        cylinder(size, 0.4f64.to_degrees()),
        ellipsoid(size, 0.8 * size, 0.5 * size),
        torus(size, 0.3 * size),
        paraboloid(0.5 / size),
        saddle(0.2 / size),
        wavy,
    ]
    .map(|shape| (shape.name(), shape))
}

fn touched(object: Shape, tip: Fingertip, x: f64, y: f64) -> Result<Touch, &'static str> {
    let glider = Glider::new(object, tip).unwrap();
    glider.touch(x, y).map_err(|error| error.name())
}

fn everywhere(size: f64, tip: Fingertip, answered: u32) -> Result<Answer, String> {
    let places = extreme_pairs().chain([(1e3 * size, 0.0)]);
    let touches =
        places.flat_map(|(x, y)| shapes(size).map(|(_, shape)| touched(shape, tip, x, y)));
    let numbers = touches.map(|touch| touch.map(|touch| numbers(&touch)));
    Answer::counted(
        numbers,
        answered,
        &["off-domain", "contact-lost", "two-contacts"],
    )
}

fn numbers(touch: &Touch) -> Vec<f64> {
    let vectors = [touch.point.coords, touch.normal, touch.tip_centre.coords];
    let form = touch.curvature;
    let form = [form.k_uu, form.k_uv, form.k_vv];
    vectors.iter().flatten().copied().chain(form).collect()
}

/// The contact is where the line from centre to centre leaves the sphere: `x R/(R + r)`.
fn on_sphere(size: f64, tip: f64) -> Result<Answer, &'static str> {
    let (x, y) = (0.36 * (size + tip), 0.48 * (size + tip));
    let share = Precise::new(size) / (Precise::new(size) + tip);
    let sphere = sphere(size);
    let touch = touched(sphere, Fingertip::Sphere { radius: tip }, x, y)?;
    let pairs = [
        (touch.point.x, (&share * x).to_f64()),
        (touch.point.y, (&share * y).to_f64()),
    ];
    Ok(Answer::all_at_scale(pairs, size)
        .within(1e-12)
        .conditioned(1.0 + tip / size)
        .also(numbers(&touch)))
}

/// A tip that touches at r has its centre at `r + t 2cr/√(1 + (2cr)²)`.
fn on_paraboloid(c: f64, tip: f64, r: f64) -> Result<Answer, &'static str> {
    let slope = 2.0 * Precise::new(c) * r;
    let w = (slope.squared() + 1.0).sqrt();
    let centre = (Precise::new(r) + &slope / &w * tip).to_f64();
    let hill = paraboloid(c);
    let touch = touched(
        hill,
        Fingertip::Sphere { radius: tip },
        0.6 * centre,
        0.8 * centre,
    )?;
    // How far the contact moves as the tip does: 1/(1 + t k) with k up the slope.
    let w = w.to_f64();
    let condition = 1.0 / (1.0 + tip * 2.0 * c / w.powi(3)).min(1.0);
    let pairs = [(touch.point.x, 0.6 * r), (touch.point.y, 0.8 * r)];
    Ok(Answer::all_at_scale(pairs, r + tip)
        .within(1e-12)
        .conditioned(condition)
        .also(numbers(&touch)))
}

/// Distance between neighbouring contacts on a sphere three times as large as the tip, which is 3/4 of the distance
/// between the places asked for. The nearer these are, the more the last place of a coordinate counts.
fn neighbours(apart: f64) -> Result<Answer, &'static str> {
    let (size, tip) = (1e12, 1e12 / 3.0);
    let at = |x| {
        let sphere = sphere(size);
        touched(sphere, Fingertip::Sphere { radius: tip }, x, 0.0)
    };
    let (here, there) = (at(1e3)?, at(1e3 + apart)?);
    let moved = there.point.x - here.point.x;
    // The truth is that of the places as rounded to doubles.
    let truth = 0.75 * ((1e3 + apart) - 1e3);
    let answer = Answer::near(moved, truth).within(1e-12);
    Ok(answer.conditioned(1e3 / apart).or_no_digits())
}

fn in_dish(tip: f64) -> Result<Answer, &'static str> {
    let x = 0.5 * (1.0 - tip);
    let dish = dish(1.0);
    let touch = touched(dish, Fingertip::Sphere { radius: tip }, x, 0.0)?;
    let condition = 1.0 / (1.0 - tip);
    let pairs = [(touch.point.x, 0.5), (touch.point.y, 0.0)];
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(1e-12)
        .conditioned(condition)
        .also(numbers(&touch)))
}
