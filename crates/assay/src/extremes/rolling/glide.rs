//! Fingertips that glide, from needles to boulders.

use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Dish, Graph, Plane, Sphere};
use palpate_rolling::{Fingertip, GlideError, Glider, Touch};

use super::super::Precise;
use super::super::answer::Named;
use super::super::hostile::{EXTREME, NO_LENGTHS, NOT_FINITE};
use super::super::{Answer, Case, Outcome};
use super::MADE;
use crate::extremes::geometry::shapes;

const ENTRY: &str = "rolling::Glider::touch";

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for bad in NO_LENGTHS {
        cases.push(Case::refusal(
            "rolling::Glider::new",
            format!("tip {bad:e}"),
            move || Glider::new(Shape::Plane(Plane), Fingertip::Sphere { radius: bad }),
        ));
    }
    for exponent in [-12, -9, -6, -3, 0, 3, 6, 9, 12] {
        let ratio = 10f64.powi(exponent);
        for size in [1e-9, 1.0, 1e9] {
            let input = format!("sphere of {size:e}, tip {ratio:e} times as large");
            cases.push(Case::value(ENTRY, input, move || {
                on_sphere(size, size * ratio)
            }));
        }
        let input = format!("paraboloid of c = 0.5, tip of {ratio:e} at the foot r = 1.2");
        cases.push(Case::value(ENTRY, input, move || {
            on_paraboloid(0.5, ratio, 1.2)
        }));
        let input = format!("paraboloid of c = 0.5, tip of 0.7 at the foot r = {ratio:e}");
        cases.push(Case::value(ENTRY, input, move || {
            on_paraboloid(0.5, 0.7, ratio)
        }));
        let input = format!("neighbours {ratio:e} apart on a sphere of radius 1e12");
        cases.push(Case::value(ENTRY, input, move || neighbours(ratio)));
    }
    for gap in [0.5, 1e-3, 1e-6, 1e-9] {
        let input = format!("tip of {:?} of a dish", 1.0 - gap);
        cases.push(Case::value(ENTRY, input, move || in_dish(1.0 - gap)));
        let input = format!("tip {gap:e} larger than a dish");
        cases.push(Case::refusal(ENTRY, input, move || in_dish(1.0 + gap)));
        let input = format!("tip of {:?} of a bowl's apex", 1.0 - gap);
        cases.push(Case::value(ENTRY, input, move || {
            on_paraboloid(-0.5, 1.0 - gap, 0.0)
        }));
        let input = format!("tip {gap:e} larger than a bowl's apex");
        cases.push(Case::refusal(ENTRY, input, move || {
            on_paraboloid(-0.5, 1.0 + gap, 0.0)
        }));
    }
    for exponent in [-9, 9] {
        let size = 10f64.powi(exponent);
        for bad in NOT_FINITE {
            let input = format!("held at {bad:e}, sizes {size:e}");
            cases.push(Case::refusal(ENTRY, input, move || anywhere(size, bad)));
        }
        for tip in [Fingertip::Point, Fingertip::Sphere { radius: 0.1 * size }] {
            let input = format!("{tip:?} at 256 places on 9 surfaces of {size:e}: finite");
            cases.push(Case::new(ENTRY, input, move || everywhere(size, tip)));
        }
    }
    cases
}

fn touched(object: Shape, fingertip: Fingertip, x: f64, y: f64) -> Result<Touch, Named> {
    let glider = Glider::new(object, fingertip).map_err(|_| Named("invalid-shape"))?;
    glider
        .touch(x, y)
        .map_err(|error: GlideError| Named(error.name()))
}

fn numbers(touch: &Touch) -> Vec<f64> {
    let vectors = [touch.point.coords, touch.normal, touch.tip_centre.coords];
    let form = touch.curvature;
    let form = [form.k_uu, form.k_uv, form.k_vv];
    vectors.iter().flatten().copied().chain(form).collect()
}

/// The contact is where the line from centre to centre leaves the sphere: `x R/(R + r)`.
fn on_sphere(size: f64, tip: f64) -> Result<Answer, Named> {
    let (x, y) = (0.36 * (size + tip), 0.48 * (size + tip));
    let share = Precise::new(size) / (Precise::new(size) + tip);
    let sphere = Shape::Sphere(Sphere::new(size).expect(MADE));
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
fn on_paraboloid(c: f64, tip: f64, r: f64) -> Result<Answer, Named> {
    let slope = Precise::new(2.0) * c * r;
    let w = (slope.squared() + 1.0).sqrt();
    let centre = (Precise::new(r) + &slope / &w * tip).to_f64();
    let hill = Shape::Paraboloid(Graph::paraboloid(c).expect(MADE));
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
fn neighbours(apart: f64) -> Result<Answer, Named> {
    let (size, tip) = (1e12, 1e12 / 3.0);
    let at = |x| {
        let sphere = Shape::Sphere(Sphere::new(size).expect(MADE));
        touched(sphere, Fingertip::Sphere { radius: tip }, x, 0.0)
    };
    let (here, there) = (at(1e3)?, at(1e3 + apart)?);
    let moved = there.point.x - here.point.x;
    // The truth is that of the places as rounded to doubles.
    let truth = 0.75 * ((1e3 + apart) - 1e3);
    let answer = Answer::near(moved, truth).within(1e-12);
    Ok(answer.conditioned(1e3 / apart).or_no_digits())
}

fn in_dish(tip: f64) -> Result<Answer, Named> {
    let x = 0.5 * (1.0 - tip);
    let dish = Shape::Dish(Dish::new(1.0).expect(MADE));
    let touch = touched(dish, Fingertip::Sphere { radius: tip }, x, 0.0)?;
    let condition = 1.0 / (1.0 - tip);
    let pairs = [(touch.point.x, 0.5), (touch.point.y, 0.0)];
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(1e-12)
        .conditioned(condition)
        .also(numbers(&touch)))
}

fn anywhere(size: f64, bad: f64) -> Result<Touch, Named> {
    let tips = [Fingertip::Point, Fingertip::Sphere { radius: 0.1 * size }];
    let places = [(bad, 0.0), (0.0, bad), (bad, bad)];
    let asked = shapes(size)
        .into_iter()
        .flat_map(|shape| tips.map(|tip| (shape.clone(), tip)))
        .flat_map(|(shape, tip)| places.map(|place| (shape.clone(), tip, place)));
    let touches = asked.map(|(shape, tip, (x, y))| touched(shape, tip, x, y));
    touches.reduce(Result::or).expect("nine surfaces")
}

fn everywhere(size: f64, tip: Fingertip) -> Outcome {
    let places = EXTREME.into_iter().flat_map(|x| EXTREME.map(|y| (x, y)));
    let places = places.chain([(1e3 * size, 0.0)]);
    let asked = places.flat_map(|(x, y)| shapes(size).map(|shape| (shape, x, y)));
    let touches = asked.map(|(shape, x, y)| touched(shape, tip, x, y));
    Outcome::of_all(touches.map(|touch| touch.map(|touch| numbers(&touch))))
}
