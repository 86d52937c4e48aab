//! Scenes of a roll: exact estimates, noise, sensors, motions, and rolls that are rejected.

use palpate_scene::{Arch, Scene, Scenes};
use palpate_study::config::{LengthUnit, parse};
use palpate_sweep::Observation;

use super::press::{outcomes, scene_of};

/// Config of a roll: a probe with a radius of 1 rolls by 0.1 rad. `lines` contains additional fields of the scene.
fn text(object: &str, lines: &str) -> String {
    format!(
        r#"name = "a-study"
seed = 3

[scene]
kind = "roll"
probe = {{ kind = "sphere", radius = 1.0 }}
object = {object}
motion.rate_rad_per_s = 0.1
motion.duration_s = 1.0
{lines}"#
    )
}

fn scene(object: &str, lines: &str) -> Scene {
    scene_of(&text(object, lines))
}

fn trial(scene: &Scene, trial: u64) -> Vec<(f64, f64)> {
    let mut outcomes = Vec::new();
    scene
        .trial(trial, |quantity, outcome| {
            assert_eq!(quantity, outcomes.len());
            outcomes.push((outcome.estimate, outcome.truth));
        })
        .unwrap();
    outcomes
}

const NOISE: &str = r#"noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }"#;

#[test]
fn a_bias_and_a_drift_shift_all_measured_rotations() {
    let ball = r#"{ kind = "sphere", radius = 4 }"#;
    let scene = |noise: &str| {
        let noise = format!(
            "noise.rotation = {{ std_rad = 0.0, {noise} }}\nmotion.duration_s = 2.0\nmotion.directions_deg = [0, 90]"
        );
        let text = text(ball, &noise).replacen("motion.duration_s = 1.0\n", "", 1);
        scene_of(&text)
    };
    let rotations = |scene: &Scene, trial: Option<u64>| -> Vec<f64> {
        let readings = scene.trace(trial, LengthUnit::Mm).unwrap().readings;
        let rows = readings.rows.iter();
        rows.flat_map(|row| [1, 2].map(|column: usize| row[column].parse().unwrap()))
            .collect()
    };
    let degree = 1_f64.to_radians();
    for (noise, shift) in [
        ("bias_deg = 0.5", 0.5 * degree),
        ("drift_deg_per_s = -0.1", -0.2 * degree),
        ("bias_deg = 0.5, drift_deg_per_s = -0.1", 0.3 * degree),
        ("bias_deg = 0.0", 0.0),
    ] {
        let scene = scene(noise);
        assert_eq!(scene.trials(1000), 1, "nothing is random");
        let [exact, read] = [None, Some(0)].map(|trial| rotations(&scene, trial));
        assert!(exact.len() >= 4);
        for (exact, read) in exact.iter().zip(&read) {
            assert!(
                (read - exact - shift).abs() < 1e-12,
                "{noise}: {read} {exact}"
            );
        }
        // The rotations of all rolls have the same error. The two rolls are at right angles, because the effects of
        // this error on the curvature would cancel in two opposite rolls.
        let curvature = trial(&scene, 0)[3].0;
        assert_eq!((curvature - 0.25).abs() < 1e-12, shift == 0.0, "{noise}");
    }
}

#[test]
fn hexagonal_pads_err_less_than_square_ones() {
    let ball = r#"{ kind = "sphere", radius = 4 }"#;
    // The contact's path is 0.08 long. If this length were a multiple of the pitch, square pads would read it exactly.
    // So use pitches that do not divide 0.08.
    let square_sum = |layout: &str| -> f64 {
        let pitches = [0.017, 0.019, 0.021, 0.023].iter();
        let squares = pitches.map(|pitch| {
            let pads = format!("kind = \"pads\", pitch = {pitch}, offset = \"random\"");
            let scene = scene(
                ball,
                &format!("sensor = {{ {pads}, layout = \"{layout}\" }}"),
            );
            let errors = (0..500).map(|number| trial(&scene, number)[3]);
            errors
                .map(|(estimate, truth)| (estimate - truth).powi(2))
                .sum::<f64>()
        });
        squares.sum()
    };
    let ratio = (square_sum("hexagonal") / square_sum("square")).sqrt();
    // An independent simulation, with displacements of a contact over pads with these pitches, yields 0.84 for the
    // ratio of the rms errors.
    assert!((0.7..1.0).contains(&ratio), "{ratio}");
}

#[test]
fn without_noise_spheres_are_exact() {
    for (object, curvature) in [
        (r#"{ kind = "sphere", radius = 4 }"#, 0.25),
        (r#"{ kind = "dish", radius = 4 }"#, -0.25),
        (r#"{ kind = "plane" }"#, 0.0),
    ] {
        let scene = scene(object, "");
        assert_eq!(scene.trials(1000), 1);
        let outcomes = trial(&scene, 0);
        let expected = [curvature, curvature, curvature * curvature, curvature];
        for ((estimate, truth), expected) in outcomes.iter().zip(expected) {
            assert!((truth - expected).abs() < 1e-15, "{object}: {truth}");
            assert!((estimate - expected).abs() < 1e-12, "{object}: {estimate}");
        }
        let arc = 0.1 / (1.0 + curvature);
        assert!((outcomes[4].0 - arc).abs() < 1e-14 && (outcomes[4].1 - arc).abs() < 1e-14);
    }
}

#[test]
fn true_values_are_available_without_a_trial() {
    let scene = scene(r#"{ kind = "saddle", a = 0.1 }"#, NOISE);
    for (quantity, (_, truth)) in trial(&scene, 5).into_iter().enumerate() {
        assert_eq!(scene.truth(quantity), Some(truth));
    }
    assert_eq!(scene.truth(5), None);
    // The surface z = a (x² − y²) is concave along x, with the curvature −2a, and convex along y, with the curvature
    // 2a.
    assert!((scene.truth(0).unwrap() + 0.2).abs() < 1e-12);
    assert!((scene.truth(1).unwrap() - 0.2).abs() < 1e-12);
}

const NOISES: [&str; 3] = [
    "",
    NOISE,
    r#"noise = { angular_velocity = { kind = "gaussian", fraction = 0.1 } }"#,
];

fn rolls_of(duration_s: f64, lines: &str) -> Scene {
    let lines = format!("{lines}\nmotion.directions_deg = [0, 50, 120]");
    let object = r#"{ kind = "cylinder", radius = 5.0, direction_deg = 20 }"#;
    let duration = format!("duration_s = {duration_s:?}");
    scene_of(&text(object, &lines).replace("duration_s = 1.0", &duration))
}

/// Tests that the estimates do not depend on the roll model: with equal random draws, all models compute the same
/// rolls. The longest rolls end beyond half of the probe's circumference.
#[test]
fn models_share_draws_and_results() {
    for noise in NOISES {
        for duration_s in [1.0, 25.0, 40.0] {
            let closed = rolls_of(duration_s, noise);
            for model in [
                r#"{ kind = "dop853", tolerance = 1e-13 }"#,
                r#"{ kind = "dop853", tolerance = 1e-13, chart = "montana" }"#,
                r#"{ kind = "rk4", steps = 200 }"#,
            ] {
                let other = rolls_of(duration_s, &format!("{noise}\nmodel = {model}"));
                for number in 0..10 {
                    match [&closed, &other].map(|scene| outcomes(scene, number)) {
                        [Ok(closed), Ok(other)] => {
                            for ((_, one), (name, two)) in closed.iter().zip(other) {
                                let difference = (one.estimate - two.estimate).abs();
                                let scale = 1.0 + one.estimate.abs();
                                assert!(difference < 1e-7 * scale, "{model}, {name}: {one:?}");
                            }
                        }
                        [closed, other] => assert_eq!(closed, other),
                    }
                }
            }
        }
    }
}

#[test]
fn side_by_side_is_one_by_one_to_the_last_bit() {
    for noise in NOISES {
        // Rolls of 31 s end about halfway around the probe. In some trials, they end beyond this point, and in other
        // trials before it.
        for duration_s in [1.0, 31.0] {
            let Scene::Roll(scene) = rolls_of(duration_s, noise) else {
                panic!("not a roll");
            };
            let (mut trial, mut together) = (0, 0);
            while trial < 500 {
                let mut first = trial;
                let taken = scene.side_by_side(Arch::new(), trial..500, |observed| {
                    let count = observed[0].estimates.len();
                    for place in 0..count {
                        let outcomes = scene.outcomes(first + place as u64).unwrap();
                        for (side_by_side, outcome) in observed.iter().zip(outcomes) {
                            assert_eq!(side_by_side.estimates[place], outcome.estimate);
                            assert_eq!(side_by_side.truth, outcome.truth);
                            assert_eq!(side_by_side.stds.map(|stds| stds[place]), outcome.std);
                        }
                    }
                    first += count as u64;
                    count
                });
                assert_eq!(first, trial + taken);
                together += taken;
                trial += taken.max(1);
            }
            let are_all = together == 500;
            assert!(together > 0 && (are_all || duration_s > 1.0), "{noise}");
        }
    }
}

#[test]
fn trials_that_are_long_or_not_accepted_do_not_count() {
    let [short, long] = [1.0, 32.0].map(|duration_s| match rolls_of(duration_s, "") {
        Scene::Roll(roll) => roll,
        _ => panic!("not a roll"),
    });
    let mut offers = Vec::new();
    let taken = short.side_by_side(Arch::new(), 3..1000, |observed| {
        offers.push(observed[4].estimates.len());
        if offers.len() < 3 { offers[0] } else { 5 }
    });
    assert_eq!(offers, [offers[0]; 3]);
    assert_eq!(taken, 2 * offers[0] as u64 + 5);
    for (scene, trials) in [(short, 3..3), (long, 3..1000)] {
        assert_eq!(
            scene.side_by_side(Arch::new(), trials, |_| panic!("none")),
            0
        );
    }
}

/// Tests that an additional source of noise does not change the random numbers that the other sources use.
#[test]
fn channels_are_apart() {
    let object = r#"{ kind = "sphere", radius = 4 }"#;
    let plain = scene(object, NOISE);
    let tiny = scene(
        object,
        &format!("{NOISE}\nsensor = {{ kind = \"wrist\", std = 1e-12 }}"),
    );
    for number in 0..10 {
        for ((a, _), (b, _)) in trial(&plain, number).into_iter().zip(trial(&tiny, number)) {
            assert!((a - b).abs() < 1e-9, "{a}, {b}");
        }
    }
}

#[test]
fn a_noisy_measurement_is_quantised_once() {
    let noise = |encoder: &str| {
        format!(
            "noise = {{ angular_velocity = {{ kind = \"uniform\", fraction = 0.1, \
             side = \"measurement\" }}{encoder} }}"
        )
    };
    let sphere = r#"{ kind = "sphere", radius = 5 }"#;
    let coarse = scene(sphere, &noise(", encoder = { step_rad = 0.03 }"));
    let fine = scene(sphere, &noise(", encoder = { step_rad = 1e-9 }"));
    let none = scene(sphere, &noise(""));
    // The noise moves readings across the limits of the encoder's steps, so trials differ.
    assert_ne!(trial(&coarse, 0), trial(&coarse, 1));
    // Encoder steps that are much smaller than the noise have no effect.
    let (fine, none) = (trial(&fine, 0)[0].0, trial(&none, 0)[0].0);
    assert!((fine - none).abs() < 1e-6, "{fine} {none}");
}

#[test]
fn the_stated_deviation_counts_spin() {
    let spinning = scene(
        r#"{ kind = "sphere", radius = 5 }"#,
        "motion.spin_rad_per_s = 0.3\n\
         noise = { angular_velocity = { kind = \"gaussian\", fraction = 0.003 } }",
    );
    let (mut square, mut stated) = (0.0, 0.0);
    let trials = 400;
    for trial in 0..trials {
        spinning
            .trial(trial, |quantity, outcome| {
                if quantity == 0 {
                    square += (outcome.estimate - outcome.truth).powi(2);
                    stated += outcome.std.unwrap();
                }
            })
            .unwrap();
    }
    let ratio = (square / trials as f64).sqrt() / (stated / trials as f64);
    assert!((0.85..1.15).contains(&ratio), "{ratio}");
}

fn with_motion(motion: &str, lines: &str) -> Scene {
    let text = format!(
        r#"name = "a-study"
seed = 3
scene.kind = "roll"
scene.probe = {{ kind = "sphere", radius = 1.0 }}
scene.object = {{ kind = "sphere", radius = 4 }}
scene.motion = {{ {motion} }}
scene.{lines}"#
    );
    scene_of(&text)
}

/// Tests three ways to state the length of a roll. The path of the contact is R r/(R + r) times the angle. It is 0.08
/// for a ball with the radius R = 4, a probe with the radius r = 1 and the angle 0.1 rad.
#[test]
fn duration_angle_or_path_determine_the_length_of_a_roll() {
    let of_time = trial(
        &with_motion("rate_rad_per_s = 0.1, duration_s = 1", NOISE),
        7,
    );
    for motion in [
        "angle_deg = 5.729577951308232",
        "rate_rad_per_s = 3, angle_deg = 5.729577951308232",
        "arc_length = 0.08",
        "rate_rad_per_s = 3, arc_length = 0.08",
    ] {
        for (one, other) in of_time.iter().zip(trial(&with_motion(motion, NOISE), 7)) {
            assert!(
                (one.0 - other.0).abs() < 1e-12,
                "{motion}: {one:?} {other:?}"
            );
            assert!(
                (one.1 - other.1).abs() < 1e-14,
                "{motion}: {one:?} {other:?}"
            );
        }
    }
    let twice = trial(&with_motion("angle_deg = 11.459155902616464", NOISE), 7);
    assert!((twice[4].1 - 2.0 * of_time[4].1).abs() < 1e-14);
}

/// Errors of the normal curvature along u in 500 trials: root mean square error, mean error, and mean reported standard
/// error. A star consists of four rolls by 20°. The probe has a radius of 9, and the object is a cylinder with a radius
/// of 20.
fn errors_of_stars(stars: usize, lines: &str) -> [f64; 3] {
    let directions = [[0, 90, 180, 270]].repeat(stars).concat();
    let text = format!(
        "name = \"a-study\"\nseed = 5\n[scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = 9 }}\n\
         object = {{ kind = \"cylinder\", radius = 20, direction_deg = 90 }}\n\
         motion = {{ angle_deg = 20, directions_deg = {directions:?} }}\n{lines}\n"
    );
    let scene = scene_of(&text);
    let trials = 500;
    let (mut square, mut mean, mut stated) = (0.0, 0.0, 0.0);
    for trial in 0..trials {
        let observe = |quantity, outcome: Observation| {
            if quantity == 0 {
                let error = outcome.estimate - outcome.truth;
                square += error * error;
                mean += error;
                stated += outcome.std.unwrap();
            }
        };
        scene.trial(trial, &mut { observe }).unwrap();
    }
    let trials = trials as f64;
    [(square / trials).sqrt(), mean / trials, stated / trials]
}

#[test]
fn repeated_rolls_over_pads_err_as_they_state() {
    let pads = |offset: &str| {
        format!("sensor = {{ kind = \"pads\", pitch = 0.2, offset = \"{offset}\" }}")
    };
    for stars in [1, 8, 32] {
        let [rms, mean, stated] = errors_of_stars(stars, &pads("random"));
        assert!(
            (0.8..1.2).contains(&(rms / stated)),
            "{stars}: {rms} {stated}"
        );
        assert!(mean.abs() < 0.3 * rms, "{stars}: {mean} {rms}");
        // A star is a set of rolls in all directions from one start. With `random-per-trial`, all rolls of a trial
        // start at the same place on a pad, so several stars in a trial do not reduce the error.
        let [rms, _, stated] = errors_of_stars(stars, &pads("random-per-trial"));
        assert!((0.0025..0.0037).contains(&rms), "{stars}: {rms}");
        assert!(
            (0.8..1.2).contains(&(rms / stated)),
            "{stars}: {rms} {stated}"
        );
    }
}

#[test]
fn rolls_from_one_place_count_once_with_noisy_rotations_too() {
    let pads = "sensor = { kind = \"pads\", pitch = 0.2, offset = \"random-per-trial\" }";
    let [rms, _, stated] = errors_of_stars(
        16,
        &format!("{pads}\nnoise = {{ rotation = {{ std_deg = 0.01 }} }}"),
    );
    assert!((0.8..1.2).contains(&(rms / stated)), "{rms} {stated}");
}

#[test]
fn rotations_err_as_they_state() {
    for (noise, std_deg) in [
        ("encoder = { step_deg = 5 }", 5.0 / 12.0_f64.sqrt()),
        ("rotation = { std_deg = 0.2 }", 0.2),
        (
            "rotation = { kind = \"gaussian\", std_rad = 0.01 }",
            0.01_f64.to_degrees(),
        ),
    ] {
        let [rms, mean, stated] = errors_of_stars(4, &format!("noise = {{ {noise} }}"));
        // `due` is the expected standard error of the curvature along u, estimated from eight rolls. Errors of the
        // rotation are amplified by 1 + R₂/R₁, with the radii R₁ of the probe and R₂ of the object.
        let due = std_deg / 20.0 / 8.0_f64.sqrt() * (1.0 / 9.0 + 1.0 / 20.0);
        assert!((stated / due - 1.0).abs() < 0.1, "{noise}: {stated} {due}");
        assert!(
            (0.8..1.2).contains(&(rms / stated)),
            "{noise}: {rms} {stated}"
        );
        assert!(mean.abs() < 0.3 * stated, "{noise}: {mean} {stated}");
    }
}

#[test]
fn a_probe_that_noise_turns_into_the_object_fails_in_some_trials() {
    // Without noise, the probe just misses the step in the surface. With noise, it hits the step in some trials.
    let step = |noise: &str| {
        let text = format!(
            "name = \"a-study\"\n[scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = 1 }}\n\
             object = {{ kind = \"height-field\", formula = \"1.5*(1+tanh(20*(x-1.5)))\" }}\n\
             motion = {{ angle_deg = 20 }}\nnoise = {{ {noise} }}\n"
        );
        parse("study.toml", &text).unwrap().estimable_scene(0)
    };
    assert!(step("").is_ok());
    let noisy = step(r#"angular_velocity = { kind = "gaussian", fraction = 0.5 }"#).unwrap();
    assert!(
        noisy
            .needs()
            .iter()
            .any(|line| line.to_string().starts_with("clearance of every trial"))
    );
    let failures = (0..40).filter_map(|trial| noisy.trial(trial, &mut |_, _| ()).err());
    let failures: Vec<_> = failures.filter(|name| *name == "overlapping").collect();
    assert!((1..40).contains(&failures.len()), "{}", failures.len());
}
