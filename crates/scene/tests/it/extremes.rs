//! Tests scenes with extreme sizes, ratios and noise. Without noise, the estimate is equal to the true value; with
//! noise, its relative error does not depend on the unit of length. Impossible scenes have named errors.

use palpate_scene::Scenes;
use palpate_study::config::parse;

const PLANE: &str = "{ kind = \"plane\" }";
/// Estimator of presses with an exactly stated indentation.
const KNOWN: &str = "estimator = { kind = \"half-space\", indentation = \"known\" }";

fn scene(kind: &str, probe: &str, object: &str, motion: &str, lines: &str) -> String {
    format!(
        "name = \"a\"\n[scene]\nkind = \"{kind}\"\nprobe = {probe}\nobject = {object}\nmotion = {motion}\n{lines}"
    )
}

/// Config of a roll: a probe with the radius `unit` rolls by the angle `angle`.
pub(crate) fn roll(unit: f64, object: &str, angle: f64, lines: &str) -> String {
    let motion = format!("{{ rate_rad_per_s = {angle:e}, duration_s = 1.0 }}");
    scene("roll", &sphere(unit), object, &motion, lines)
}

/// Config of a glide: three fingers slide over a patch with a side length of 2 `unit`.
pub(crate) fn glide(unit: f64, object: &str, lines: &str) -> String {
    let [side, half, third] = [2.0 * unit, unit, 0.5 * unit];
    let motion = format!(
        "{{ finger_positions = [{:e}, 0.0, {half:e}], inter_finger_distance = {half:e}, \
         patch_length = {side:e}, contacts_per_finger = 8 }}",
        -half
    );
    let lines = format!(
        "evaluate = {{ half_width = {third:e}, gaussian_threshold = {:e}, mean_threshold = {:e} }}\n{lines}",
        1e-6 / unit / unit,
        1e-3 / unit
    );
    scene("glide", &sphere(third), object, &motion, &lines)
}

/// Config of a press: the sensor has the radius 20 `unit`, and the indentation is this radius times `share`.
pub(crate) fn press(unit: f64, object: &str, share: f64, lines: &str) -> String {
    let [radius, depth, indentation] = [20.0 * unit, 2.0 * unit, 20.0 * unit * share];
    let probe = format!(
        "{{ kind = \"marker-sphere\", radius = {radius:e}, marker_depth = {depth:e}, layout = \"published\" }}"
    );
    let motion = format!("{{ indentation = {indentation:e} }}");
    scene("press", &probe, object, &motion, lines)
}

pub(crate) fn sphere(radius: f64) -> String {
    format!("{{ kind = \"sphere\", radius = {radius:e} }}")
}

fn dish(radius: f64) -> String {
    format!("{{ kind = \"dish\", radius = {radius} }}")
}

fn layered(thickness: f64) -> String {
    let layer = format!("kind = \"bonded-layer\", thickness = {thickness:e}");
    let lines =
        format!("model = {{ {layer} }}\nestimator = {{ {layer}, indentation = \"known\" }}");
    press(1.0, PLANE, 0.02, &lines)
}

/// Estimates and true values in the first three trials, both divided by the largest true value of their quantity.
/// Quantities whose true values are all 0 are left out. If a trial or the config is invalid, the error is the name of
/// the trial's failure or the path of the config field.
fn relative(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let study = parse("study.toml", text);
    let scene = study.and_then(|study| study.estimable_scene(0));
    let scene = scene.map_err(|error| error.path)?;
    let mut all: Vec<(&'static str, f64, f64)> = Vec::new();
    for number in 0..3 {
        scene.trial(number, |quantity, outcome| {
            let name = scene.quantities()[quantity].name;
            assert!(outcome.std.is_none_or(f64::is_finite), "{name}");
            all.push((name, outcome.estimate, outcome.truth));
        })?;
    }
    let largest = |quantity: &str| {
        let of_it = all.iter().filter(|(name, ..)| *name == quantity);
        of_it.fold(0.0, |largest: f64, (.., truth)| largest.max(truth.abs()))
    };
    let pairs = all.iter().filter_map(|&(quantity, estimate, truth)| {
        // The curvature of the object is the relative curvature minus the curvature of the sensor. Therefore, its error
        // is divided by the relative curvature. A radius is first converted to a curvature.
        let is_of_object = ["object_curvature", "object_radius"].contains(&quantity);
        let scale = largest(if is_of_object {
            "relative_curvature"
        } else {
            quantity
        });
        let pair = match quantity {
            "object_radius" => [estimate, truth].map(f64::recip),
            _ => [estimate, truth],
        };
        (scale > 0.0).then(|| pair.map(|one| one / scale))
    });
    Ok(pairs.collect())
}

#[test]
fn scenes_without_noise_are_exact() {
    for (text, condition) in [
        (roll(1e-9, &sphere(3e-9), 0.5, ""), 1.0),
        (press(1e9, &sphere(30e9), 0.05, KNOWN), 1.0),
        // Relative errors of the contact's shift are amplified by 1 + R₂/R₁, where R₁ is the radius of the probe and R₂
        // the radius of the object.
        (roll(1.0, &sphere(1e-9), 0.1, ""), 1.0),
        (roll(1.0, &sphere(1e12), 0.1, ""), 1e12),
        (press(1.0, &sphere(20e12), 0.01, KNOWN), 1e12),
        (press(1.0, &sphere(1e308), 0.01, KNOWN), 1.0),
        // The curvature of this object is so small that the estimate consists mostly of rounding errors of the
        // positions.
        (glide(1.0, &sphere(2e9), ""), 1e10),
        (roll(1.0, PLANE, 1e-12, ""), 1.0),
        (roll(1.0, &sphere(2.0), 1e-12, ""), 1.0),
        (roll(1.0, &dish(1.000_001), 1e-7, ""), 1e6),
        (press(1.0, &dish(20.000_02), 1e-9, KNOWN), 1e6),
        (press(1.0, PLANE, 0.999_999, KNOWN), 1.0),
        (layered(2.1), 1.0),
    ] {
        let pairs = relative(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
        let bound = 1e-6_f64.max(10.0 * f64::EPSILON * condition);
        for [estimate, truth] in pairs {
            assert!(
                (estimate - truth).abs() <= bound,
                "{estimate} {truth}: {text}"
            );
        }
    }
}

#[test]
fn impossible_scenes_have_named_errors() {
    for (text, name) in [
        (roll(1.0, &sphere(1e-12), 0.1, ""), "unresolved"),
        (roll(1.0, PLANE, 6.0, ""), "not-rolling"),
        (roll(1.0, &dish(1.0), 0.1, ""), "scene.object"),
        (press(1.0, &sphere(0.02), 0.01, KNOWN), "too-wide"),
        (press(1.0, &sphere(5e-324), 0.01, KNOWN), "out-of-range"),
        (press(1.0, &dish(19.9), 1e-9, KNOWN), "edge-contact"),
        (layered(2.0), "no-contact"),
        (layered(1e6), "scene.model.thickness"),
        (glide(1.0, &sphere(2e-12), ""), "scene.motion"),
        (glide(1.0, &sphere(5e-324), ""), "scene.object.radius"),
    ] {
        let found = relative(&text);
        assert_eq!(found.err().as_deref(), Some(name), "{text}");
    }
}

/// Tests that the unit of length does not matter. All lengths are multiplied by a power of two; no error may change by
/// more than a billionth of the estimated quantity.
#[test]
fn errors_are_the_same_in_any_unit() {
    let noisy_press = |unit: f64, noise: f64| {
        let kind = format!("{{ kind = \"gaussian\", std = {:e} }}", noise * unit);
        let lines = format!("noise = {{ normal_displacement = {kind} }}\n{KNOWN}");
        press(
            unit,
            PLANE,
            0.05,
            &(lines + "\nsensor = { kind = \"direct\", tangential = false }"),
        )
    };
    let noisy_glide = |unit: f64, noise: f64| {
        let kind = format!("{{ kind = \"gaussian\", fraction_of_ifd = {noise:e} }}");
        let lines = format!("noise = {{ position = {kind} }}");
        glide(unit, &sphere(5.0 * unit), &lines)
    };
    let on_pads = |unit: f64, pitch: f64| {
        let pitch = pitch * unit;
        let lines = format!(
            "sensor = {{ kind = \"pads\", pitch = {pitch:e}, layout = \"uniform\", offset = \"random\" }}"
        );
        roll(unit, &sphere(2.0 * unit), 0.5, &lines)
    };
    let same = |text: &dyn Fn(f64) -> String| {
        let [here, there] = [1.0, (1 << 20) as f64].map(|unit| relative(&text(unit)).unwrap());
        assert!(here.len() == there.len() && here.iter().any(|[found, truth]| found != truth));
        for (here, there) in here.iter().zip(there) {
            assert!((here[0] - there[0]).abs() <= 1e-9, "{here:?} {there:?}");
        }
    };
    // The standard deviation of the noise is `noise` times `unit`. Glides are also tested with `noise` = 10. Presses
    // are tested with less noise, because their contacts could not be detected with such a large noise.
    for noise in [1e-9, 0.1] {
        same(&|unit| noisy_press(unit, noise));
    }
    for noise in [1e-9, 0.1, 10.0] {
        same(&|unit| noisy_glide(unit, noise));
    }
    for pitch in [1e-6, 0.1] {
        same(&|unit| on_pads(unit, pitch));
    }
}
