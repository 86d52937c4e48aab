//! Ladders of scenes: errors of the rungs, at tolerances and sizes that are extreme.

use palpate_scene::Scenes;
use palpate_study::config::parse;

use super::Refused;
use crate::extremes::{Answer, Case};

const ENTRY: &str = "scene::Study::ladder";

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for unit in [1e-9, 1e-3, 1.0, 1e3, 1e9] {
        for (kind, scene) in SCENES {
            cases.push(Case::value(
                ENTRY,
                format!("{kind}, lengths of {unit:e}: the taken rung's error over the tolerance"),
                move || taken(&scene(unit, &auto("1e-6"))),
            ));
        }
    }
    for tolerance in ["1e-14", "1e-9", "1e-3", "0.1"] {
        for (kind, scene) in &SCENES[..2] {
            cases.push(Case::value(
                ENTRY,
                format!("{kind}, tolerance {tolerance}: the taken rung's error over it"),
                move || taken(&scene(1.0, &auto(tolerance))),
            ));
        }
    }
    for tolerance in [
        "nan", "inf", "-inf", "0.0", "-0.0", "-1.0", "5e-324", "1e-15", "0.11", "1e308",
    ] {
        for (kind, scene) in &SCENES[..2] {
            cases.push(Case::refusal(
                ENTRY,
                format!("{kind}, tolerance {tolerance}"),
                move || taken(&scene(1.0, &auto(tolerance))),
            ));
        }
    }
    cases
}

fn auto(tolerance: &str) -> String {
    format!("model = {{ kind = \"auto\", tolerance = {tolerance} }}\n")
}

/// A scene in a unit of length, with lines of its config.
type Scene = fn(f64, &str) -> String;

const SCENES: [(&str, Scene); 3] = [
    ("roll", |unit, lines| {
        scene(
            "roll",
            &format!("{{ kind = \"sphere\", radius = {unit:e} }}"),
            &format!(
                "{{ kind = \"ellipsoid\", semi_axes = [{:e}, {:e}, {unit:e}] }}",
                3.0 * unit,
                2.0 * unit
            ),
            "{ rate_rad_per_s = 0.3, duration_s = 1.0 }",
            lines,
        )
    }),
    ("glide", |unit, lines| {
        let [half, third] = [unit, 0.5 * unit];
        scene(
            "glide",
            &format!("{{ kind = \"sphere\", radius = {third:e} }}"),
            &format!("{{ kind = \"paraboloid\", c = {:e} }}", 0.1 / unit),
            &format!(
                "{{ finger_positions = [{:e}, 0.0, {half:e}], inter_finger_distance = {half:e}, \
                 patch_length = {:e}, contacts_per_finger = 8 }}",
                -half,
                2.0 * unit
            ),
            &format!(
                "evaluate = {{ half_width = {third:e}, gaussian_threshold = {:e}, mean_threshold = {:e} }}\n{lines}",
                1e-6 / unit / unit,
                1e-3 / unit
            ),
        )
    }),
    ("press", |unit, lines| {
        scene(
            "press",
            &format!(
                "{{ kind = \"marker-sphere\", radius = {:e}, marker_depth = {:e}, layout = \"published\" }}",
                20.0 * unit,
                2.0 * unit
            ),
            &format!("{{ kind = \"sphere\", radius = {:e} }}", 30.0 * unit),
            &format!("{{ indentation = {unit:e} }}"),
            &format!("estimator = {{ kind = \"half-space\", indentation = \"known\" }}\n{lines}"),
        )
    }),
];

fn scene(kind: &str, probe: &str, object: &str, motion: &str, lines: &str) -> String {
    format!(
        "name = \"a\"\n[scene]\nkind = \"{kind}\"\nprobe = {probe}\nobject = {object}\nmotion = {motion}\n{lines}"
    )
}

/// The error of the rung that `auto` takes is within the tolerance.
fn taken(text: &str) -> Result<Answer, Refused> {
    let study = parse("study.toml", text);
    let ladder = study.and_then(|study| study.ladder(0));
    let ladder = ladder.map_err(|error| Refused::of(&error))?;
    let ladder = ladder.ok_or_else(|| Refused("none".to_owned()))?;
    let errors = ladder
        .rungs
        .iter()
        .filter_map(|rung| rung.outcome.clone().ok());
    let outcome = ladder.taken().outcome.clone();
    let taken = outcome.map_err(|_| Refused("rung-cannot".to_owned()))?;
    let allowed = ladder.tolerance.unwrap_or(f64::NAN);
    Ok(Answer::at_scale(taken / allowed, 0.0, 1.0)
        .within(1.0)
        .also(errors))
}
