//! Trials of whole scenes: the truth again without noise, a number or a named error with it.

use palpate_scene::Scenes;
use palpate_study::config::parse;

use super::Refused;
use crate::extremes::{Answer, Case, Outcome};

/// Allowed error of the estimate of a scene without noise, relative to the truth and to the scene's own scale.
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
    let mut add = |input: String, text: String, condition: f64| {
        cases.push(Case::new("scene::Scene::trial", input, move || {
            exact(&text, condition)
        }));
    };
    for unit in [1e-9, 1e-3, 1.0, 1e3, 1e9] {
        add(
            format!("roll, lengths of {unit:e}"),
            roll(unit, &sphere(3.0 * unit), 0.5, ""),
            1.0,
        );
        add(
            format!("press, lengths of {unit:e}"),
            press(unit, &sphere(30.0 * unit), 0.05, IDEAL),
            1.0,
        );
    }
    for ratio in [1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e12] {
        // Errors of the shift grow by 1 + 1/RCR, the object's radius over the probe's.
        add(
            format!("roll, object {ratio:e} times the probe"),
            roll(1.0, &sphere(ratio), 0.1, ""),
            1.0 + ratio,
        );
        add(
            format!("press, object {ratio:e} times the sensor"),
            press(1.0, &sphere(20.0 * ratio), 0.01, IDEAL),
            1.0 + ratio,
        );
        add(
            format!("glide, object {ratio:e} times the patch"),
            glide(1.0, &sphere(2.0 * ratio), ""),
            // Rounding of the places is seen as bending.
            10.0 * ratio,
        );
    }
    for angle in [1e-12, 1e-6, 1.0, 6.0, 6000.0] {
        add(
            format!("roll of {angle:e} rad"),
            roll(1.0, PLANE, angle, ""),
            1.0,
        );
        add(
            format!("roll of {angle:e} rad on a sphere"),
            roll(1.0, &sphere(2.0), angle, ""),
            1.0,
        );
    }
    for (radius, gap) in [
        ("1.000001", 1e-6),
        ("1.1", 0.1),
        ("0.999999", 1.0),
        ("1.0", 1.0),
    ] {
        let dish = format!("{{ kind = \"dish\", radius = {radius} }}");
        add(
            format!("roll in a dish of {radius} probes"),
            roll(1.0, &dish, 0.1 * gap, ""),
            1.0 / gap,
        );
    }
    for (radius, gap) in [
        ("20.00002", 1e-6),
        ("20.2", 1e-2),
        ("40.0", 0.5),
        ("19.9", 1.0),
    ] {
        let dish = format!("{{ kind = \"dish\", radius = {radius} }}");
        add(
            format!("press in a dish of {radius} for a sensor of 20"),
            press(1.0, &dish, 1e-9, IDEAL),
            1.0 / gap,
        );
    }
    for share in [1e-9, 1e-6, 1e-3, 0.3, 0.9, 0.999_999] {
        add(
            format!("press, {share:e} of the radius deep"),
            press(1.0, PLANE, share, IDEAL),
            1.0,
        );
    }
    for thickness in [2.0, 2.1, 5.0, 20.0, 1e6] {
        let layer = format!("kind = \"bonded-layer\", thickness = {thickness:e}");
        add(
            format!("press, layer of {thickness:e} on a sensor of 20, markers 2 deep"),
            press(
                1.0,
                PLANE,
                0.02,
                &format!(
                    "model = {{ {layer} }}\nestimator = {{ {layer}, indentation = \"known\" }}"
                ),
            ),
            1.0,
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
        for (scene, text) in [
            ("roll", roll(1.0, &object, 0.1, "")),
            ("glide", glide(1.0, &object, "")),
            ("press", press(1.0, &object, 0.01, IDEAL)),
        ] {
            add(
                format!("{scene} on a sphere whose radius is {kind}"),
                text,
                1.0,
            );
        }
    }
    cases.extend(in_other_units());
    cases
}

/// Scenes that err, in two units of length.
fn in_other_units() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |input: String, condition: f64, text: &dyn Fn(f64) -> String| {
        let input = format!("{input}: as in a unit of 2^20");
        let [here, there] = [1.0, 2f64.powi(20)].map(text);
        cases.push(Case::new("scene::Scene::trial", input, move || {
            alike(&here, &there, condition)
        }));
    };
    for scale in [1e-9, 1e-3, 1.0, 1e3, 1e9] {
        add(format!("glide, lengths of {scale:e}"), 1.0, &|unit| {
            glide(unit * scale, &sphere(5.0 * unit * scale), "")
        });
    }
    for noise in [1e-9, 1e-3, 0.1, 1.0, 10.0] {
        add(
            format!("press, noise of {noise:e} of the indentation"),
            1.0,
            &|unit| {
                let kind = format!("{{ kind = \"gaussian\", std = {:e} }}", noise * unit);
                let lines = format!("noise = {{ normal_displacement = {kind} }}\n{IDEAL}");
                press(unit, PLANE, 0.05, &lines)
            },
        );
        add(
            format!("glide, noise of {noise:e} finger distances"),
            1.0,
            &|unit| {
                let kind = format!("{{ kind = \"gaussian\", fraction_of_ifd = {noise:e} }}");
                let lines = format!("noise = {{ position = {kind} }}");
                glide(unit, &sphere(5.0 * unit), &lines)
            },
        );
    }
    for pitch in [1e-6, 1e-3, 0.1, 1.0] {
        add(format!("roll, pads of {pitch:e} probes"), 1.0, &|unit| {
            let lines = format!(
                "sensor = {{ kind = \"pads\", pitch = {:e}, layout = \"uniform\", offset = \"random\" }}",
                pitch * unit
            );
            roll(unit, &sphere(2.0 * unit), 0.5, &lines)
        });
    }
    cases
}

/// The first trials of a scene, whose errors its condition lets grow.
fn exact(text: &str, condition: f64) -> Outcome {
    let trials = match trials(text) {
        Ok(trials) => trials,
        Err(error) => return Err::<Answer, _>(error).into(),
    };
    let judged = trials.relative().into_iter();
    Answer::all_at_scale(judged.collect::<Vec<_>>(), 1.0)
        .within(EXACT)
        .conditioned(condition)
        .also(trials.numbers)
        .into()
}

/// Comparison of a scene with its copy in another unit of length: their errors relative to the truth must agree.
fn alike(here: &str, there: &str, condition: f64) -> Outcome {
    let [here, there] = [trials(here), trials(there)];
    let (here, there) = match (here, there) {
        (Ok(here), Ok(there)) => (here, there),
        (Err(error), _) | (_, Err(error)) => return Err::<Answer, _>(error).into(),
    };
    let pairs = (here.relative().into_iter())
        .zip(there.relative())
        .map(|((here, _), (there, _))| (here, there));
    Answer::all_at_scale(pairs.collect::<Vec<_>>(), 1.0)
        .within(EXACT)
        .conditioned(condition)
        .also(here.numbers)
        .into()
}

/// Results of some trials of a scene.
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

fn trials(text: &str) -> Result<Trials, Refused> {
    let study = parse("study.toml", text);
    let scene = study.and_then(|study| study.estimable_scene(0));
    let scene = scene.map_err(|error| Refused::of(&error))?;
    let mut trials = Trials {
        pairs: Vec::new(),
        numbers: Vec::new(),
    };
    for number in 0..3 {
        scene
            .trial(number, |quantity, outcome| {
                let (estimate, truth) = (outcome.estimate, outcome.truth);
                let name = scene.quantities()[quantity].name;
                trials.pairs.push((name, estimate, truth));
                trials.numbers.extend([estimate, truth]);
                trials.numbers.extend(outcome.std);
            })
            .map_err(|name| Refused(name.to_owned()))?;
    }
    Ok(trials)
}
