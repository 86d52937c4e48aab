//! Dishes that fit the probe almost, exactly, or not at all.

use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Dish, Graph};
use palpate_rolling::{Chart, Model, Motion};

use super::super::Precise;
use super::super::answer::Named;
use super::super::{Answer, Case};
use super::{MADE, numbers, roll, roller};

const DOP853: Model = Model::Dop853 {
    tolerance: 1e-9,
    chart: Chart::Free,
};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for gap in [1.0, 1e-3, 1e-6, 1e-9, 1e-12] {
        for (rung, model, bound) in [
            ("closed form", Model::ClosedForm, 1e-14),
            ("DOP853", DOP853, 1e-9),
        ] {
            let input = format!("{rung}, dish wider than the probe by {gap:e} of it");
            cases.push(Case::value("rolling::Roller::roll", input, move || {
                in_dish(1.0 + gap, model, bound)
            }));
        }
        cases.push(Case::refusal(
            "rolling::Roller::new",
            format!("dish narrower than the probe by {:e} of it", 0.5 * gap),
            move || in_dish(1.0 - 0.5 * gap, Model::ClosedForm, 0.0),
        ));
        cases.push(Case::refusal(
            "rolling::Roller::new",
            format!("bowl sharper than the probe by {gap:e}"),
            move || in_bowl(-0.5 * (1.0 + gap)),
        ));
    }
    for model in [Model::ClosedForm, DOP853] {
        cases.push(Case::value(
            "rolling::Roller::roll",
            format!("{model:?}, probe of 0.999999 of the dish"),
            move || in_dish(1.0 / 0.999_999, model, 1e-9),
        ));
    }
    for fit in [1.0, 1.0f64.next_up(), 1.0f64.next_down()] {
        cases.push(Case::new(
            "rolling::Roller::new",
            format!("dish of {:e} more than the probe's radius", fit - 1.0),
            move || in_dish(fit, Model::ClosedForm, 1e-14).into(),
        ));
    }
    cases
}

/// `θ/(1/R₁ − 1/R₂)`, with θ such that the path is about one radius long.
fn in_dish(radius: f64, model: Model, bound: f64) -> Result<Answer, Named> {
    let relative = Precise::new(1.0) - Precise::new(1.0) / radius;
    let theta = relative.to_f64().abs().max(f64::EPSILON);
    let path = Precise::new(theta) / &relative;
    let angle = (&path / radius).to_f64();
    let dish = Shape::Dish(Dish::new(radius).expect(MADE));
    let motion = Motion::rolling(0.0, 1.0, theta);
    let contact = roll(&roller(1.0, dish, (0.0, 0.0), model, motion)?, motion)?;
    let pairs = [
        (contact.arc_length, path.to_f64()),
        (contact.on_object.x, radius * libm::sin(angle)),
        (contact.on_object.z, -radius * libm::cos(angle)),
    ];
    let condition = (1.0 + 1.0 / radius) / relative.to_f64().abs();
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(bound)
        .conditioned(condition)
        .also(numbers(&contact)))
}

fn in_bowl(c: f64) -> Result<Answer, Named> {
    let bowl = Shape::Paraboloid(Graph::paraboloid(c).expect(MADE));
    let motion = Motion::rolling(0.0, 1.0, 1e-3);
    let roller = roller(1.0, bowl, (0.0, 0.0), Model::Meridian, motion)?;
    roll(&roller, motion).map(|contact| Answer::finite(numbers(&contact)))
}
