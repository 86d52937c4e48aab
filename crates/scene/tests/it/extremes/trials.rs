//! Trials of whole scenes: the truth again without noise, a number or a named error with it.

use palpate_scene::Scenes;
use palpate_study::config::parse;
use palpate_verdict::{Answer, rows};

use super::refused::invalid;

const TRIAL: &str = "scene::Scene::trial";
const RADIUS: &str = "invalid-scene-object-radius";
const PLANE: &str = "{ kind = \"plane\" }";
/// Estimator of presses without noise.
pub(super) const IDEAL: &str = "estimator = { kind = \"half-space\", indentation = \"known\" }";
/// Sensor that reads no displacements along the skin.
const NORMAL: &str = "sensor = { kind = \"direct\", tangential = false }";
const UNITS: [f64; 5] = [1e-9, 1e-3, 1.0, 1e3, 1e9];
const RATIOS: [f64; 8] = [1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e12];
const NO_RADII: [&str; 5] = ["nan", "inf", "0.0", "-0.0", "-1.0"];
/// Allowed error of the estimate of a scene without noise, relative to the truth and to the scene's own scale.
const EXACT: f64 = 1e-6;

rows! {
    TRIAL, "roll, lengths of {unit:e}" => exact(&roll(unit, &sphere(3.0 * unit), 0.5, ""), 1.0), for unit in UNITS;
    TRIAL, "press, lengths of {unit:e}" => exact(&press(unit, &sphere(30.0 * unit), 0.05, IDEAL), 1.0),
        for unit in UNITS;
    // Errors of the shift grow by 1 + 1/RCR, the object's radius over the probe's.
    TRIAL, "roll, object {ratio:e} times the probe" => exact(&roll(1.0, &sphere(ratio), 0.1, ""), 1.0 + ratio),
        for &ratio in &RATIOS[1..];
    TRIAL, "roll, object 1e-12 times the probe", "unresolved" => trials(&roll(1.0, &sphere(1e-12), 0.1, ""));
    TRIAL, "press, object {ratio:e} times the sensor" =>
        exact(&press(1.0, &sphere(20.0 * ratio), 0.01, IDEAL), 1.0 + ratio), for &ratio in &RATIOS[4..];
    TRIAL, "press, object {ratio:e} times the sensor", "too-wide" =>
        trials(&press(1.0, &sphere(20.0 * ratio), 0.01, IDEAL)), for &ratio in &RATIOS[..4];
    // Rounding of the places is seen as bending.
    TRIAL, "glide, object {ratio:e} times the patch" => exact(&glide(1.0, &sphere(2.0 * ratio), ""), 10.0 * ratio),
        for ratio in [1e3, 1e6, 1e9];
    TRIAL, "glide, object {ratio:e} times the patch", "invalid-scene-motion" =>
        trials(&glide(1.0, &sphere(2.0 * ratio), "")), for ratio in [1e-12, 1e-9, 1e-6, 1e-3, 1e12];
    TRIAL, "roll of {angle:e} rad" => exact(&roll(1.0, PLANE, angle, ""), 1.0), for angle in [1e-12, 1e-6, 1.0];
    TRIAL, "roll of {angle:e} rad", "not-rolling" => trials(&roll(1.0, PLANE, angle, "")), for angle in [6.0, 6000.0];
    TRIAL, "roll of {angle:e} rad on a sphere" => exact(&roll(1.0, &sphere(2.0), angle, ""), 1.0),
        for angle in [1e-12, 1e-6, 1.0];
    TRIAL, "roll of {angle:e} rad on a sphere", "not-rolling" => trials(&roll(1.0, &sphere(2.0), angle, "")),
        for angle in [6.0, 6000.0];
    TRIAL, "roll in a dish of {radius} probes" => exact(&roll(1.0, &dish(radius), 0.1 * gap, ""), 1.0 / gap),
        for (radius, gap) in [("1.000001", 1e-6), ("1.1", 0.1)];
    TRIAL, "roll in a dish of {radius} probes", "invalid-scene-object" => trials(&roll(1.0, &dish(radius), 0.1, "")),
        for radius in ["0.999999", "1.0"];
    TRIAL, "press in a dish of {radius} for a sensor of 20" =>
        exact(&press(1.0, &dish(radius), 1e-9, IDEAL), 1.0 / gap),
        for (radius, gap) in [("20.00002", 1e-6), ("20.2", 1e-2), ("40.0", 0.5)];
    TRIAL, "press in a dish of 19.9 for a sensor of 20", "edge-contact" =>
        trials(&press(1.0, &dish("19.9"), 1e-9, IDEAL));
    TRIAL, "press, {share:e} of the radius deep" => exact(&press(1.0, PLANE, share, IDEAL), 1.0),
        for share in [1e-9, 1e-6, 1e-3, 0.3, 0.9, 0.999_999];
    TRIAL, "press, layer of {thickness:e} on a sensor of 20, markers 2 deep" => exact(&layered(thickness), 1.0),
        for thickness in [2.1, 5.0, 20.0];
    TRIAL, "press, layer of 2e0 on a sensor of 20, markers 2 deep", "no-contact" => trials(&layered(2.0));
    TRIAL, "press, layer of 1e6 on a sensor of 20, markers 2 deep", "invalid-scene-model-thickness" =>
        trials(&layered(1e6));
    TRIAL, "{kind} on a sphere whose radius is {radius}", RADIUS => trials(&text),
        for radius in NO_RADII, for (kind, text) in on_spheres(radius);
    TRIAL, "{kind} on a sphere whose radius is {radius}", RADIUS => trials(text),
        for radius in ["5e-324", "1e308"], for (kind, text) in &on_spheres(radius)[..2];
    TRIAL, "press on a sphere whose radius is 5e-324", "out-of-range" => trials(&on_spheres("5e-324")[2].1);
    TRIAL, "press on a sphere whose radius is 1e308" => exact(&on_spheres("1e308")[2].1, 1.0);
    TRIAL, "glide, lengths of {scale:e}: as in a unit of 2^20" =>
        alike(|unit| glide(unit * scale, &sphere(5.0 * unit * scale), "")), for scale in UNITS;
    TRIAL, "press, noise of {noise:e} of the indentation: as in a unit of 2^20" =>
        alike(|unit| noisy_press(unit, noise, "")), for noise in [1e-9, 1e-3, 0.1, 1.0, 10.0];
    TRIAL, "press, noise of {noise:e} of the indentation in all that is read, unit {unit}", "no-contact" =>
        trials(&noisy_press(unit, noise, NORMAL)), for noise in [10.0, 100.0], for unit in BOTH;
    TRIAL, "glide, noise of {noise:e} finger distances: as in a unit of 2^20" => alike(|unit| noisy_glide(unit, noise)),
        for noise in [1e-9, 1e-3, 0.1, 1.0, 10.0];
    TRIAL, "roll, pads of {pitch:e} probes: as in a unit of 2^20" => alike(|unit| on_pads(unit, pitch)),
        for pitch in [1e-6, 1e-3, 0.1];
    TRIAL, "roll, pads of 1e0 probes, unit {unit}", "unresolved" => trials(&on_pads(unit, 1.0)), for unit in BOTH;
}

/// Units of length that change no digit.
const BOTH: [f64; 2] = [1.0, (1 << 20) as f64];

fn scene(kind: &str, probe: &str, object: &str, motion: &str, lines: &str) -> String {
    format!(
        "name = \"a\"\n[scene]\nkind = \"{kind}\"\nprobe = {probe}\nobject = {object}\nmotion = {motion}\n{lines}"
    )
}

/// A probe of radius `unit` that rolls by an angle.
pub(super) fn roll(unit: f64, object: &str, angle: f64, lines: &str) -> String {
    let motion = format!("{{ rate_rad_per_s = {angle:e}, duration_s = 1.0 }}");
    scene("roll", &sphere(unit), object, &motion, lines)
}

/// Three fingers that slide over a patch of side 2 units.
pub(super) fn glide(unit: f64, object: &str, lines: &str) -> String {
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

/// A sensor of radius 20 units that is pressed by a share of its radius.
pub(super) fn press(unit: f64, object: &str, share: f64, lines: &str) -> String {
    let [radius, depth, indentation] = [20.0 * unit, 2.0 * unit, 20.0 * unit * share];
    let probe = format!(
        "{{ kind = \"marker-sphere\", radius = {radius:e}, marker_depth = {depth:e}, layout = \"published\" }}"
    );
    let motion = format!("{{ indentation = {indentation:e} }}");
    scene("press", &probe, object, &motion, lines)
}

pub(super) fn sphere(radius: f64) -> String {
    format!("{{ kind = \"sphere\", radius = {radius:e} }}")
}

fn dish(radius: &str) -> String {
    format!("{{ kind = \"dish\", radius = {radius} }}")
}

fn on_spheres(radius: &str) -> [(&'static str, String); 3] {
    let object = format!("{{ kind = \"sphere\", radius = {radius} }}");
    [
        ("roll", roll(1.0, &object, 0.1, "")),
        ("glide", glide(1.0, &object, "")),
        ("press", press(1.0, &object, 0.01, IDEAL)),
    ]
}

fn layered(thickness: f64) -> String {
    let layer = format!("kind = \"bonded-layer\", thickness = {thickness:e}");
    let lines =
        format!("model = {{ {layer} }}\nestimator = {{ {layer}, indentation = \"known\" }}");
    press(1.0, PLANE, 0.02, &lines)
}

fn noisy_press(unit: f64, noise: f64, sensor: &str) -> String {
    let kind = format!("{{ kind = \"gaussian\", std = {:e} }}", noise * unit);
    let lines = format!("noise = {{ normal_displacement = {kind} }}\n{sensor}\n{IDEAL}");
    press(unit, PLANE, 0.05, &lines)
}

fn noisy_glide(unit: f64, noise: f64) -> String {
    let kind = format!("{{ kind = \"gaussian\", fraction_of_ifd = {noise:e} }}");
    glide(
        unit,
        &sphere(5.0 * unit),
        &format!("noise = {{ position = {kind} }}"),
    )
}

fn on_pads(unit: f64, pitch: f64) -> String {
    let pitch = pitch * unit;
    let lines = format!(
        "sensor = {{ kind = \"pads\", pitch = {pitch:e}, layout = \"uniform\", offset = \"random\" }}"
    );
    roll(unit, &sphere(2.0 * unit), 0.5, &lines)
}

/// The first trials of a scene, whose errors its condition lets grow.
fn exact(text: &str, condition: f64) -> Result<Answer, String> {
    let trials = trials(text)?;
    let answer = Answer::all_at_scale(trials.relative(), 1.0).within(EXACT);
    Ok(answer.conditioned(condition).also(trials.numbers))
}

/// Comparison of a scene with its copy in another unit of length: their errors relative to the truth must agree.
fn alike(text: impl Fn(f64) -> String) -> Result<Answer, String> {
    let [here, there] = BOTH.map(|unit| trials(&text(unit)));
    let (here, there) = (here?, there?);
    let estimates = |trials: &Trials| trials.relative().into_iter().map(|(estimate, _)| estimate);
    let pairs = estimates(&here).zip(estimates(&there));
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(EXACT)
        .also(here.numbers))
}

/// Results of some trials of a scene.
#[derive(Default)]
struct Trials {
    /// Quantity, estimate and truth.
    pairs: Vec<(&'static str, f64, f64)>,
    /// All numbers.
    numbers: Vec<f64>,
}

impl Trials {
    /// Estimates and truths of the largest truth of their quantity, without those whose truth is 0. The curvature of
    /// an object that is pressed is what the sensor's own leaves of the relative one, and counts on its scale; its
    /// radius counts as that curvature.
    fn relative(&self) -> Vec<(f64, f64)> {
        let relative = |&(quantity, estimate, truth): &(&'static str, f64, f64)| {
            let scale = match quantity {
                "object_curvature" | "object_radius" => self.largest("relative_curvature"),
                _ => self.largest(quantity),
            };
            let [estimate, truth] = match quantity {
                "object_radius" => [estimate, truth].map(f64::recip),
                _ => [estimate, truth],
            };
            (scale > 0.0).then(|| (estimate / scale, truth / scale))
        };
        self.pairs.iter().filter_map(relative).collect()
    }

    fn largest(&self, quantity: &str) -> f64 {
        let of_it = self.pairs.iter().filter(|(name, ..)| *name == quantity);
        of_it.fold(0.0, |largest, (.., truth)| largest.max(truth.abs()))
    }
}

fn trials(text: &str) -> Result<Trials, String> {
    let study = parse("study.toml", text);
    let scene = study.and_then(|study| study.estimable_scene(0));
    let scene = scene.map_err(|error| invalid(&error))?;
    let mut trials = Trials::default();
    for number in 0..3 {
        scene.trial(number, |quantity, outcome| {
            let (estimate, truth) = (outcome.estimate, outcome.truth);
            let name = scene.quantities()[quantity].name;
            trials.pairs.push((name, estimate, truth));
            trials.numbers.extend([estimate, truth]);
            trials.numbers.extend(outcome.std);
        })?;
    }
    Ok(trials)
}
