//! Ladders of scenes: errors of the rungs, at tolerances and sizes that are extreme.

use palpate_scene::Scenes;
use palpate_study::config::parse;
use palpate_verdict::{Answer, rows};

use super::refused::invalid;
use super::trials::{IDEAL, glide, press, sphere};

const LADDER: &str = "scene::Study::ladder";
const BAD: &str = "invalid-scene-model-tolerance";
const BAD_TOLERANCES: [&str; 10] = [
    "nan", "inf", "-inf", "0.0", "-0.0", "-1.0", "5e-324", "1e-15", "0.11", "1e308",
];
/// A scene in a unit of length, with lines of its config.
type Scene = fn(f64, &str) -> String;
const SCENES: [(&str, Scene); 3] = [
    ("roll", |unit, lines| {
        let object = format!(
            "{{ kind = \"ellipsoid\", semi_axes = [{:e}, {:e}, {unit:e}] }}",
            3.0 * unit,
            2.0 * unit
        );
        super::trials::roll(unit, &object, 0.3, lines)
    }),
    ("glide", |unit, lines| {
        let object = format!("{{ kind = \"paraboloid\", c = {:e} }}", 0.1 / unit);
        glide(unit, &object, lines)
    }),
    ("press", |unit, lines| {
        press(
            unit,
            &sphere(30.0 * unit),
            0.05,
            &format!("{IDEAL}\n{lines}"),
        )
    }),
];

rows! {
    LADDER, "{kind}, lengths of {unit:e}: the taken rung's error over the tolerance" =>
        taken(scene(unit, &auto("1e-6"))), for unit in [1e-9, 1e-3, 1.0, 1e3, 1e9], for (kind, scene) in SCENES;
    LADDER, "{kind}, tolerance {tolerance}: the taken rung's error over it" => taken(scene(1.0, &auto(tolerance))),
        for tolerance in ["1e-14", "1e-9", "1e-3", "0.1"], for (kind, scene) in &SCENES[..2];
    LADDER, "{kind}, tolerance {tolerance}", BAD => taken(scene(1.0, &auto(tolerance))),
        for tolerance in BAD_TOLERANCES, for (kind, scene) in &SCENES[..2];
}

fn auto(tolerance: &str) -> String {
    format!("model = {{ kind = \"auto\", tolerance = {tolerance} }}\n")
}

/// The error of the rung that `auto` takes is within the tolerance.
fn taken(text: String) -> Result<Answer, String> {
    let study = parse("study.toml", &text);
    let ladder = study.and_then(|study| study.ladder(0));
    let ladder = ladder.map_err(|error| invalid(&error))?.ok_or("none")?;
    let errors = ladder
        .rungs
        .iter()
        .filter_map(|rung| rung.outcome.clone().ok());
    let taken = ladder.taken().outcome.clone().map_err(|_| "rung-cannot")?;
    let answer = Answer::at_scale(taken / ladder.tolerance.unwrap(), 0.0, 1.0);
    Ok(answer.within(1.0).also(errors))
}
