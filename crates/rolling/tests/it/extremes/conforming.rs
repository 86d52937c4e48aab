//! Dishes that fit the probe almost, exactly, or not at all.

use palpate_rolling::{Model, Motion};
use palpate_verdict::{Answer, Precise, rows};

use super::rolled::{NEW, ROLL, dop853, numbers, roll, roller};
use crate::scenes::{dish, paraboloid};

const GAPS: [f64; 5] = [1.0, 1e-3, 1e-6, 1e-9, 1e-12];
const RUNGS: [(&str, Model, f64); 2] = [
    ("closed form", Model::ClosedForm, 1e-14),
    ("DOP853", dop853(1e-9), 1e-9),
];

rows! {
    ROLL, "{rung}, dish wider than the probe by {gap:e} of it" => in_dish(1.0 + gap, model, bound),
        for gap in GAPS, for (rung, model, bound) in RUNGS;
    ROLL, "{model:?}, probe of 0.999999 of the dish" => in_dish(1.0 / 0.999_999, model, 1e-9),
        for (_, model, _) in RUNGS;
    NEW, "dish narrower than the probe by {gap:e} of it", "conforming" => in_dish(1.0 - gap, Model::ClosedForm, 0.0),
        for gap in GAPS.map(|gap| 0.5 * gap);
    NEW, "bowl sharper than the probe by {gap:e}", "conforming" => in_bowl(-0.5 * (1.0 + gap)), for gap in GAPS;
    NEW, "dish of {more:e} more than the probe's radius", "conforming" => in_dish(1.0 + more, Model::ClosedForm, 1e-14),
        for more in [0.0, f64::EPSILON, -0.5 * f64::EPSILON];
}

/// `θ/(1/R₁ − 1/R₂)`, with θ such that the path is about one radius long.
fn in_dish(radius: f64, model: Model, bound: f64) -> Result<Answer, &'static str> {
    let relative = 1.0 - 1.0 / Precise::new(radius);
    let theta = relative.to_f64().abs().max(f64::EPSILON);
    let path = Precise::new(theta) / &relative;
    let angle = (&path / radius).to_f64();
    let dish = dish(radius);
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

fn in_bowl(c: f64) -> Result<Answer, &'static str> {
    let bowl = paraboloid(c);
    let motion = Motion::rolling(0.0, 1.0, 1e-3);
    let roller = roller(1.0, bowl, (0.0, 0.0), Model::Meridian, motion)?;
    roll(&roller, motion).map(|contact| Answer::finite(numbers(&contact)))
}
