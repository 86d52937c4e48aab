//! Trials of whole scenes: the truth again without noise, a number or a named error with it.

use palpate_scene::config::parse;

use crate::extremes::{Answer, Case, Outcome};

/// What the estimate of a scene without noise may be off by, of the truth and of what the scene is measured in.
const EXACT: f64 = 1e-6;

/// A probe of radius `unit` that rolls by an angle.
fn roll(unit: f64, object: &str, angle: f64, lines: &str) -> String {
    format!(
        "name = \"a\"\n[scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = {unit:e} }}\n\
         object = {object}\nmotion = {{ rate_rad_per_s = {angle:e}, duration_s = 1.0 }}\n{lines}"
    )
}

/// Three fingers that slide over a patch of side 2 units.
fn glide(unit: f64, object: &str, lines: &str) -> String {
    let [side, half, third] = [2.0 * unit, unit, 0.5 * unit];
    format!(
        "name = \"a\"\n[scene]\nkind = \"glide\"\nprobe = {{ kind = \"sphere\", radius = {third:e} }}\n\
         object = {object}\nmotion = {{ finger_positions = [{:e}, 0.0, {half:e}], \
         inter_finger_distance = {half:e}, patch_length = {side:e}, contacts_per_finger = 8 }}\n\
         evaluate = {{ half_width = {third:e}, gaussian_threshold = {:e}, mean_threshold = {:e} }}\n{lines}",
        -half,
        1e-6 / unit / unit,
        1e-3 / unit
    )
}

/// A sensor of radius 20 units that is pressed by a share of its radius.
fn press(unit: f64, object: &str, share: f64, lines: &str) -> String {
    let [radius, depth, indentation] = [20.0 * unit, 2.0 * unit, 20.0 * unit * share];
    format!(
        "name = \"a\"\n[scene]\nkind = \"press\"\nprobe = {{ kind = \"marker-sphere\", radius = {radius:e}, \
         marker_depth = {depth:e}, layout = \"published\" }}\nobject = {object}\n\
         motion = {{ indentation = {indentation:e} }}\n{lines}"
    )
}

fn sphere(radius: f64) -> String {
    format!("{{ kind = \"sphere\", radius = {radius:e} }}")
}

const PLANE: &str = "{ kind = \"plane\" }";
const IDEAL: &str = "estimator = { kind = \"half-space\", indentation = \"known\" }";

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |input: String, text: String, is_exact: bool| {
        cases.push(Case::new("scene::Scene::trial", input, move || {
            trial(&text, is_exact, 1.0)
        }));
    };
    for unit in [1e-9, 1e-3, 1.0, 1e3, 1e9] {
        add(
            format!("roll, lengths of {unit:e}"),
            roll(unit, &sphere(3.0 * unit), 0.5, ""),
            true,
        );
        add(
            format!("glide, lengths of {unit:e}; finite"),
            glide(unit, &sphere(5.0 * unit), ""),
            false,
        );
        add(
            format!("press, lengths of {unit:e}"),
            press(unit, &sphere(30.0 * unit), 0.05, IDEAL),
            true,
        );
    }
    for ratio in [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e12] {
        add(
            format!("glide, object {ratio:e} times the patch; finite"),
            glide(1.0, &sphere(ratio), ""),
            false,
        );
        add(
            format!("press, object {ratio:e} times the sensor; finite"),
            press(1.0, &sphere(20.0 * ratio), 0.01, IDEAL),
            false,
        );
    }
    for angle in [1e-12, 1e-6, 1.0, 6.0, 6000.0] {
        add(
            format!("roll of {angle:e} rad"),
            roll(1.0, PLANE, angle, ""),
            true,
        );
        add(
            format!("roll of {angle:e} rad on a sphere; finite"),
            roll(1.0, &sphere(2.0), angle, ""),
            false,
        );
    }
    for radius in ["1.000001", "1.1", "0.999999", "1.0"] {
        let dish = format!("{{ kind = \"dish\", radius = {radius} }}");
        add(
            format!("roll in a dish of {radius} probes; finite"),
            roll(1.0, &dish, 0.1, ""),
            false,
        );
    }
    for radius in ["20.00002", "20.2", "40.0", "19.9"] {
        let dish = format!("{{ kind = \"dish\", radius = {radius} }}");
        add(
            format!("press in a dish of {radius} for a sensor of 20; finite"),
            press(1.0, &dish, 1e-9, IDEAL),
            false,
        );
    }
    for share in [1e-9, 1e-6, 1e-3, 0.3, 0.9, 0.999_999] {
        add(
            format!("press, {share:e} of the radius deep"),
            press(1.0, PLANE, share, IDEAL),
            true,
        );
    }
    for noise in [1e-9, 1e-3, 0.1, 1.0, 10.0] {
        let gaussian = |std: f64| format!("{{ kind = \"gaussian\", std = {std:e} }}");
        add(
            format!("press, noise of {noise:e} of the indentation; finite"),
            press(
                1.0,
                PLANE,
                0.05,
                &format!(
                    "noise = {{ normal_displacement = {} }}\n{IDEAL}",
                    gaussian(noise)
                ),
            ),
            false,
        );
        add(
            format!("glide, noise of {noise:e} finger distances; finite"),
            glide(
                1.0,
                &sphere(5.0),
                &format!(
                    "noise = {{ position = {{ kind = \"gaussian\", fraction_of_ifd = {noise:e} }} }}"
                ),
            ),
            false,
        );
    }
    for pitch in [1e-6, 1e-3, 0.1, 1.0] {
        add(
            format!("roll, pads of {pitch:e} probes; finite"),
            roll(
                1.0,
                &sphere(2.0),
                0.5,
                &format!(
                    "sensor = {{ kind = \"pads\", pitch = {pitch:e}, layout = \"uniform\", offset = \"random\" }}"
                ),
            ),
            false,
        );
    }
    for thickness in [2.0, 2.1, 5.0, 20.0, 1e6] {
        add(
            format!("press, layer of {thickness:e} on a sensor of 20, markers 2 deep"),
            press(
                1.0,
                PLANE,
                0.02,
                &format!(
                    "model = {{ kind = \"bonded-layer\", thickness = {thickness:e} }}\n\
                     estimator = {{ kind = \"bonded-layer\", thickness = {thickness:e}, indentation = \"known\" }}"
                ),
            ),
            false,
        );
    }
    for (kind, line) in [
        ("NaN", "radius = nan"),
        ("infinite", "radius = inf"),
        ("0", "radius = 0.0"),
        ("-0", "radius = -0.0"),
        ("negative", "radius = -1.0"),
        ("subnormal", "radius = 5e-324"),
        ("1e308", "radius = 1e308"),
    ] {
        let object = format!("{{ kind = \"sphere\", {line} }}");
        add(
            format!("roll on a sphere whose radius is {kind}; finite"),
            roll(1.0, &object, 0.1, ""),
            false,
        );
        add(
            format!("glide on a sphere whose radius is {kind}; finite"),
            glide(1.0, &object, ""),
            false,
        );
        add(
            format!("press on a sphere whose radius is {kind}; finite"),
            press(1.0, &object, 0.01, IDEAL),
            false,
        );
    }
    for ratio in [1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e12] {
        // Errors of the shift grow by 1 + 1/RCR, the object's radius over the probe's.
        cases.push(Case::new(
            "scene::Scene::trial",
            format!("roll, object {ratio:e} times the probe"),
            move || trial(&roll(1.0, &sphere(ratio), 0.1, ""), true, 1.0 + ratio),
        ));
    }
    cases
}

/// The first trials of a scene, whose errors its condition lets grow.
fn trial(text: &str, is_exact: bool, condition: f64) -> Outcome {
    let scene = match parse("study.toml", text).and_then(|study| study.estimable_scene(0)) {
        Ok(scene) => scene,
        Err(error) => return Outcome::Refused(format!("config: {}", error.message())),
    };
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    let mut largest = [0.0_f64; 64];
    for number in 0..3 {
        let failed = scene.trial(number, |quantity, outcome| {
            largest[quantity] = largest[quantity].max(outcome.truth.abs());
            pairs.push((quantity, outcome.estimate, outcome.truth));
            numbers.extend(outcome.std);
        });
        if let Err(name) = failed {
            return Outcome::Refused(name.to_owned());
        }
    }
    let estimates = pairs
        .iter()
        .flat_map(|&(_, estimate, truth)| [estimate, truth]);
    let all: Vec<f64> = estimates.chain(numbers).collect();
    if !is_exact {
        return Answer::finite(all).into();
    }
    let judged = pairs
        .iter()
        .filter(|(quantity, ..)| largest[*quantity] > 0.0);
    let judged = judged.map(|&(quantity, estimate, truth)| {
        (estimate / largest[quantity], truth / largest[quantity])
    });
    Answer::all_at_scale(judged.collect::<Vec<_>>(), 1.0)
        .within(EXACT)
        .conditioned(condition)
        .also(all)
        .into()
}
