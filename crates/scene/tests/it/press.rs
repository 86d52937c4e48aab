//! Scenes of a press: displacements of markers, estimates, noise, and settings that are rejected.

use palpate_scene::{PressScene, Scene, Scenes, Trials};
use palpate_study::Table;
use palpate_study::config::{LengthUnit, parse};
use palpate_sweep::Observation;

use super::press_settings::needs_of;

/// Config of a press: the sensor has a radius of 20, and the indentation is 1. `lines` contains additional fields of
/// the scene.
pub(super) fn text(object: &str, lines: &str) -> String {
    format!(
        r#"name = "a-study"
seed = 3

[scene]
kind = "press"
probe = {{ kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }}
object = {object}
motion = {{ indentation = 1.0 }}
{lines}"#
    )
}

pub(super) fn scene_of(text: &str) -> Scene {
    let study = parse("study.toml", text).unwrap_or_else(|error| panic!("{error}"));
    study
        .estimable_scene(0)
        .unwrap_or_else(|error| panic!("{error}"))
}

pub(super) fn press(text: &str) -> PressScene {
    match scene_of(text) {
        Scene::Press(press) => press,
        _ => panic!("not a press"),
    }
}

#[track_caller]
pub(super) fn refused(text: &str) -> String {
    let study = match parse("study.toml", text) {
        Ok(study) => study,
        Err(error) => return format!("{}: {}", error.path, error.message),
    };
    let error = study.estimable_scene(0).unwrap_err();
    format!("{}: {}", error.path, error.message)
}

pub(super) fn outcomes(
    scene: &Scene,
    trial: u64,
) -> Result<Vec<(&'static str, Observation)>, &'static str> {
    let mut outcomes = Vec::new();
    scene.trial(trial, |quantity, outcome| {
        outcomes.push((scene.quantities()[quantity].name, outcome));
    })?;
    Ok(outcomes)
}

pub(super) fn numbers(table: &Table) -> Vec<Vec<f64>> {
    let row = |row: &Vec<String>| row.iter().map(|field| field.parse().unwrap()).collect();
    table.rows.iter().map(row).collect()
}

pub(super) const PLANE: &str = r#"{ kind = "plane" }"#;
pub(super) const BALL: &str = r#"{ kind = "sphere", radius = 80 }"#;
pub(super) const DISH: &str = r#"{ kind = "dish", radius = 80 }"#;
pub(super) const NOISE: &str = r#"noise = { normal_displacement = { kind = "gaussian", std = 0.07 }, tangential_displacement = { kind = "gaussian", std = 0.02 }, indentation = { kind = "gaussian", std = 0.02 } }
"#;

#[test]
fn without_noise_every_object_is_found() {
    for (object, curvature, quantities) in [
        (BALL, 1.0 / 80.0, 7),
        (PLANE, 0.0, 6),
        (DISH, -1.0 / 80.0, 7),
    ] {
        let scene = scene_of(&text(object, ""));
        assert_eq!(scene.trials(1000), 1);
        let outcomes = outcomes(&scene, 0).unwrap();
        assert_eq!(scene.quantities().len(), quantities);
        let relative_curvature: f64 = 0.05 + curvature;
        for (name, truth) in [
            ("relative_curvature", relative_curvature),
            ("effective_radius", 1.0 / relative_curvature),
            ("object_curvature", curvature),
            ("indentation", 1.0),
            // The contact radius a follows from a² = R δ, with the effective radius R = 1/(relative curvature) and the
            // indentation δ.
            ("contact_radius", libm::pow(relative_curvature, -0.5)),
            ("r_squared", 1.0),
            ("object_radius", 1.0 / curvature),
        ] {
            let Some((_, outcome)) = outcomes.iter().find(|(known, _)| *known == name) else {
                assert!(name == "object_radius" && object == PLANE, "{name}");
                continue;
            };
            assert!(
                (outcome.truth - truth).abs() <= 1e-12 * truth.abs(),
                "{name}"
            );
            let off = (outcome.estimate - truth).abs();
            assert!(off < 1e-6 * truth.abs().max(0.05), "{name}: {outcome:?}");
            // Without noise, there is no Cramér–Rao bound.
            let place = scene.quantities().iter().position(|one| one.name == name);
            assert_eq!(scene.std_bound(place.unwrap()), None);
        }
    }
}

#[test]
fn hertz_displacements_at_the_surface_are_the_closed_form() {
    let lines = "model = { kind = \"hertz\" }\n";
    let line = r#"layout = { kind = "line", markers = 41, length = 16.0 } }"#;
    let text = text(PLANE, lines).replace(
        "marker_depth = 2.0 }",
        &format!("marker_depth = 2.0, {line}"),
    );
    let trace = press(&text).trace(None, LengthUnit::Mm).unwrap();
    let (contact_radius, mut inside) = (20.0_f64.sqrt(), 0);
    for (marker, row) in numbers(&trace.contacts).iter().enumerate() {
        let [number, x, y, position, normal, ..] = row[..] else {
            panic!("{row:?}");
        };
        assert_eq!((number, y), (marker as f64, 0.0));
        assert!((x - (0.4 * marker as f64 - 8.0)).abs() < 1e-12);
        assert!((position - x.abs()).abs() < 1e-12);
        if position <= contact_radius {
            inside += 1;
            assert!(
                (normal - (1.0 - position * position / 40.0)).abs() < 1e-12,
                "{position}"
            );
        } else {
            assert!(normal > 0.0 && normal < 0.5);
        }
    }
    assert_eq!(inside, 23);
}

#[test]
fn markers_move_away_from_the_contact_wherever_it_is() {
    let off_apex = text(PLANE, "").replace(
        "indentation = 1.0 }",
        "indentation = 1.0, contact_deg = [11.9, 45.0] }",
    );
    let rows = |text: &str| numbers(&press(text).trace(None, LengthUnit::Mm).unwrap().contacts);
    let apex = rows(&text(PLANE, ""));
    for row in &apex {
        let [_, x, y, position, _, along_x, along_y] = row[..] else {
            panic!("{row:?}");
        };
        // Under an incompressible half-space, the skin moves outward, in the direction of (x, y).
        let (outward, across) = (along_x * x + along_y * y, along_y * x - along_x * y);
        assert!(position == 0.0 || outward > 0.0, "{row:?}");
        assert!(across.abs() < 1e-12, "{row:?}");
    }
    // In the second press, the contact is at the second marker instead of the apex. The second marker moves like the
    // apex in the first press. The apex moves like the second marker in the first press, but in the opposite tangential
    // direction.
    let moved = rows(&off_apex);
    assert!(moved[1][3] < 1e-12 && (moved[1][4] - apex[0][4]).abs() < 1e-12);
    assert!((moved[0][4] - apex[1][4]).abs() < 1e-12);
    assert!((moved[0][5] + apex[1][5]).abs() < 1e-12 && (moved[0][6] + apex[1][6]).abs() < 1e-12);
}

#[test]
fn noise_has_the_stated_size_and_frames_average_it() {
    let sample = |lines: &str| {
        let press = press(&text(PLANE, &format!("{NOISE}{lines}")));
        let exact = numbers(&press.trace(None, LengthUnit::Mm).unwrap().readings);
        let (mut normal, mut tangential, mut count) = (0.0, 0.0, 0.0);
        for trial in 0..60 {
            let read = numbers(&press.trace(Some(trial), LengthUnit::Mm).unwrap().readings);
            for (read, exact) in read.iter().zip(&exact) {
                assert_eq!((read[0], read[1]), (exact[0], exact[1]));
                normal += (read[2] - exact[2]).powi(2);
                tangential += 0.5 * ((read[3] - exact[3]).powi(2) + (read[4] - exact[4]).powi(2));
                count += 1.0;
            }
        }
        let stated = (0..500).map(|trial| {
            let trace = press.trace(Some(trial), LengthUnit::Mm).unwrap();
            let (_, text) = trace.what.split_once("indentation of ").unwrap();
            let stated: f64 = text.split(' ').next().unwrap().parse().unwrap();
            (stated - 1.0).powi(2)
        });
        let indentation: f64 = stated.sum::<f64>() / 500.0;
        [normal / count, tangential / count, indentation].map(f64::sqrt)
    };
    // The tolerances follow from the number of random draws: the relative standard error of a standard deviation is 1 %
    // for 4,620 draws and 3 % for 500 draws.
    let single = sample("");
    let four = sample("sensor = { kind = \"direct\", frames = 4 }\n");
    for (found, expected, tolerance) in [
        (single[0], 0.07, 0.04),
        (single[1], 0.02, 0.04),
        (single[2], 0.02, 0.12),
        (four[0], 0.035, 0.04),
        (four[1], 0.01, 0.04),
        (four[2], 0.02, 0.12),
    ] {
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{found} {expected}"
        );
    }
}

#[test]
fn a_gain_is_one_factor_and_wrong_markers_have_the_stated_number() {
    let exact = press(&text(PLANE, ""));
    let exact = numbers(&exact.trace(None, LengthUnit::Mm).unwrap().readings);
    let gain = press(&text(
        PLANE,
        r#"noise = { gain = { kind = "gaussian", std = 0.17 } }"#,
    ));
    let mut factors = Vec::new();
    for trial in 0..400 {
        let read = numbers(&gain.trace(Some(trial), LengthUnit::Mm).unwrap().readings);
        let factor = read[0][2] / exact[0][2];
        for (read, exact) in read.iter().zip(&exact) {
            assert!((read[2] - factor * exact[2]).abs() < 1e-12);
            assert_eq!(read[3..], exact[3..]);
        }
        factors.push(factor - 1.0);
    }
    let square: f64 = factors.iter().map(|factor| factor * factor).sum::<f64>() / 400.0;
    assert!((square.sqrt() / 0.17 - 1.0).abs() < 0.12, "{square}");

    let wrong = press(&text(
        PLANE,
        "noise = { wrong_markers = { count = 3, std = 1.0 } }",
    ));
    let mut seen = std::collections::BTreeSet::new();
    for trial in 0..60 {
        let read = numbers(&wrong.trace(Some(trial), LengthUnit::Mm).unwrap().readings);
        let off: Vec<usize> = (0..77).filter(|&one| read[one] != exact[one]).collect();
        assert_eq!(off.len(), 3);
        seen.extend(off);
    }
    assert!(seen.len() > 60, "{}", seen.len());
}

#[test]
fn biases_shift_all_readings_alike() {
    let noise = "noise = { normal_bias = -0.03, indentation_bias = 0.1 }\n";
    let press = press(&text(BALL, noise));
    let [exact, read] = [None, Some(0)].map(|trial| press.trace(trial, LengthUnit::Mm).unwrap());
    for (exact, read) in std::iter::zip(numbers(&exact.readings), numbers(&read.readings)) {
        assert!(
            (read[2] - exact[2] + 0.03).abs() < 1e-12,
            "{read:?} {exact:?}"
        );
        assert_eq!(read[3..], exact[3..]);
    }
    assert!(
        read.what.contains("a stated indentation of 1.1 "),
        "{}",
        read.what
    );
    let scene = scene_of(&text(BALL, noise));
    assert_eq!(scene.trials(1000), 1);
    assert!(
        needs_of(&scene)
            .contains("noise: a bias of all normal displacements; a bias of the given indentation")
    );
    assert!(outcomes(&scene, 0).unwrap()[2].1.estimate != 1.0 / 80.0);
    let large = refused(&text(BALL, "noise = { normal_bias = 1e200 }\n"));
    assert!(
        large.starts_with("scene.noise.normal_bias: bias is 1e200"),
        "{large}"
    );
}

#[test]
fn cells_share_their_draws() {
    let readings = |object: &str, lines: &str| {
        let press = press(&text(object, &format!("{NOISE}{lines}")));
        let read = numbers(&press.trace(Some(4), LengthUnit::Mm).unwrap().readings);
        let exact = numbers(&press.trace(None, LengthUnit::Mm).unwrap().readings);
        let errors = read
            .iter()
            .zip(exact)
            .map(|(read, exact)| read[2] - exact[2]);
        errors.collect::<Vec<f64>>()
    };
    let plane = readings(PLANE, "");
    for other in [
        readings(BALL, ""),
        readings(
            PLANE,
            "sensor = { kind = \"direct\", tangential = false }\n",
        ),
        readings(
            PLANE,
            "estimator = { kind = \"gaussian\", indentation = \"fitted\" }\n",
        ),
    ] {
        for (one, other) in plane.iter().zip(other) {
            assert!((one - other).abs() < 1e-12);
        }
    }
}

#[test]
fn intervals_have_their_coverage_and_bounds_are_reached() {
    let scene = scene_of(&text(
        BALL,
        &format!("{NOISE}estimator = {{ kind = \"half-space\", indentation_std = 0.02 }}\n"),
    ));
    let trials = 200;
    let (mut held, mut square) = ([0; 3], 0.0);
    for trial in 0..trials {
        let outcomes = outcomes(&scene, trial).unwrap();
        let (name, outcome) = outcomes[0];
        assert_eq!(name, "relative_curvature");
        for (held, holds) in held.iter_mut().zip(outcome.interval_holds.unwrap()) {
            *held += u32::from(holds);
        }
        square += (outcome.estimate - outcome.truth).powi(2);
        let object = outcomes.iter().find(|(name, _)| *name == "object_radius");
        assert_eq!(object.unwrap().1.interval_holds, outcome.interval_holds);
    }
    // Of 200 intervals with the probabilities 50, 80 and 95 %, the expected numbers that contain the true value are 100
    // ± 7.1, 160 ± 5.7 and 190 ± 3.1 (± one standard deviation).
    for (held, expected) in held.iter().zip([72..=128, 138..=182, 178..=199]) {
        assert!(expected.contains(held), "{held} of {expected:?}");
    }
    let (rms, bound) = ((square / trials as f64).sqrt(), scene.std_bound(0).unwrap());
    assert!(rms > 0.85 * bound && rms < 1.25 * bound, "{rms} {bound}");
    // `bound` is the Cramér–Rao bound of the relative curvature. The bounds of the radii and of the object's curvature
    // follow from it.
    let radius = 1.0 / 0.0625;
    let close = |found: Option<f64>, expected: f64| (found.unwrap() / expected - 1.0).abs() < 1e-9;
    assert!(close(scene.std_bound(1), bound * radius * radius));
    assert!(close(scene.std_bound(2), bound) && close(scene.std_bound(6), bound * 6400.0));
    assert_eq!(scene.std_bound(5), None);
    // Without a stated indentation, the Cramér–Rao bound is larger. A fit of a Gaussian has no bound, because a
    // Gaussian is not the simulated contact model.
    let of = |estimator: &str| {
        scene_of(&text(BALL, &format!("{NOISE}estimator = {estimator}\n"))).std_bound(0)
    };
    assert!(of(r#"{ kind = "half-space", indentation = "fitted" }"#).unwrap() > 1.2 * bound);
    assert_eq!(of(r#"{ kind = "gaussian" }"#), None);
}
