//! Principal curvatures, their direction and the radius, as quantities of rolls and glides.

use palpate_scene::Scenes;
use palpate_study::config::parse;
use palpate_sweep::Observation;

const CYLINDER: &str = r#"object = { kind = "cylinder", radius = 4.0, direction_deg = 30 }"#;
const SPHERE: &str = r#"object = { kind = "sphere", radius = 4.0 }"#;
const WRIST: &str = r#"sensor = { kind = "wrist", std = 0.003 }"#;
const ROLL: &str = r#"kind = "roll"
    probe = { kind = "sphere", radius = 1.0 }
    motion = { rate_rad_per_s = 0.1, duration_s = 3.0, directions_deg = [0, 60, 120, 180, 240, 300] }"#;
const GLIDE: &str = r#"kind = "glide"
    probe = { kind = "point" }
    motion = { finger_positions = [-1, 0, 1], inter_finger_distance = 1, patch_length = 2, contacts_per_finger = 15 }
    evaluate = { grid = 2, half_width = 0.2, gaussian_threshold = 0.1, mean_threshold = 0.1 }"#;

/// Observations of the quantity `name` in the first `trials` trials of a scene.
fn observed(scene: [&str; 3], name: &str, trials: u64) -> Vec<Observation> {
    let lines = scene.join("\n");
    let text = format!("name = \"a\"\n[scene]\nprincipal_curvatures = true\n{lines}\n");
    let study = parse("a.toml", &text).unwrap_or_else(|error| panic!("{error}"));
    let scene = study.estimable_scene(0).unwrap();
    let place = scene.quantities().iter().position(|one| one.name == name);
    let mut all = Vec::new();
    for trial in 0..trials {
        let observe = |quantity, outcome| all.extend((Some(quantity) == place).then_some(outcome));
        scene.trial(trial, observe).unwrap();
    }
    all
}

/// Means over the observations `all`: the mean error, the mean estimate, and the share of 95 % intervals that contain
/// the true value.
fn means(all: &[Observation]) -> [f64; 3] {
    let holds = |one: &Observation| {
        let std = one.std.unwrap_or_default();
        let is_near = (one.estimate - one.truth).abs() <= 1.96 * std;
        f64::from(u8::from(
            one.interval_holds.map_or(is_near, |holds| holds[2]),
        ))
    };
    let mean =
        |value: fn(&Observation) -> f64| all.iter().map(value).sum::<f64>() / all.len() as f64;
    let share = all.iter().map(holds).sum::<f64>() / all.len() as f64;
    [
        mean(|one| one.estimate - one.truth),
        mean(|one| one.estimate),
        share,
    ]
}

#[test]
fn without_noise_they_are_exact_and_undefined_ones_are_missing() {
    // In a roll, the second tangent axis v points to −y; in a glide, it points to +y. So the angle of the same axis has
    // opposite signs.
    for (kind, axis) in [(ROLL, -30.0), (GLIDE, 30.0)] {
        for (object, name, value) in [
            (CYLINDER, "principal_curvature_max", Some(0.25)),
            (CYLINDER, "principal_curvature_min", Some(0.0)),
            (CYLINDER, "axis_deg", Some(axis)),
            (CYLINDER, "axis_undetermined", Some(0.0)),
            (CYLINDER, "object_radius", None),
            (SPHERE, "principal_curvature_min", Some(0.25)),
            (SPHERE, "axis_deg", None),
            (SPHERE, "object_radius", Some(4.0)),
        ] {
            let all = observed([kind, object, ""], name, 1);
            assert_eq!(all.is_empty(), value.is_none(), "{name}");
            for (one, value) in all.iter().zip(value.iter().cycle()) {
                let off = [one.truth, one.estimate]
                    .map(|found| (found - value).abs() / value.abs().max(1.0));
                // For `axis_deg`, `value` is the angle in the x, y plane. Away from the top, the angle in the tangent
                // plane is a little smaller.
                assert!(off[0] < 3e-3 && off[1] < 5e-3, "{name}: {one:?}");
            }
        }
    }
}

#[test]
fn intervals_contain_the_true_values() {
    let quadric = "estimator.kind = \"quadric\"\nobject = { kind = \"height-field\", formula = \"-(3^0.5*x+y)^2/32\" }";
    let noise = "noise.position = { kind = \"gaussian\", std = 0.02 }\nnoise.normal = { kind = \"gaussian\", std_deg = 2 }";
    let rotation = "noise = { rotation = { std_deg = 0.2 } }";
    for (scene, trials) in [
        ([ROLL, CYLINDER, WRIST], 2000),
        ([ROLL, CYLINDER, rotation], 2000),
        ([GLIDE, quadric, noise], 400),
    ] {
        for name in [
            "principal_curvature_max",
            "principal_curvature_min",
            "axis_deg",
        ] {
            let [.., share] = means(&observed(scene, name, trials));
            assert!((0.91..=0.99).contains(&share), "{name}, {scene:?}: {share}");
        }
    }
}

#[test]
fn on_a_sphere_noise_separates_the_principal_curvatures() {
    let found = |name: &str| means(&observed([ROLL, SPHERE, WRIST], name, 2000));
    // Noise makes the larger of the two estimated principal curvatures too large on average, and the smaller one too
    // small.
    let [max, min] = ["principal_curvature_max", "principal_curvature_min"].map(found);
    assert!(max[0] > 0.003 && min[0] < -0.003, "{max:?} {min:?}");
    assert!(max[2] > 0.94 && min[2] > 0.94, "{max:?} {min:?}");
    // If both principal curvatures are equal, a test with the significance level 5 % leaves the axis undetermined in 95
    // % of trials.
    let [_, undetermined, _] = found("axis_undetermined");
    assert!((0.93..0.97).contains(&undetermined), "{undetermined}");
}

#[test]
fn axes_near_90_degrees_are_averaged_as_axes() {
    let cylinder = r#"object = { kind = "cylinder", radius = 4.0, direction_deg = 90 }"#;
    let noise = "noise.position = { kind = \"gaussian\", std = 0.01 }";
    let all = observed([GLIDE, cylinder, noise], "axis_deg", 20);
    let sides = all.iter().flat_map(|one| [one.truth, one.estimate]);
    let sides: Vec<f64> = sides.map(|angle| angle * all[0].truth.signum()).collect();
    assert!(
        sides.iter().all(|angle| (60.0..120.0).contains(angle)),
        "{sides:?}"
    );
}
