//! Tests `palpate check` and `palpate schema`.

use super::desk::{Desk, SCENE, STUDY, assert_untouched, edited};

#[test]
fn cells_trials_models_and_time() {
    let desk = Desk::with(STUDY);
    let printed = desk.palpate("check c.toml").printed();
    let line = |start: &str| {
        let found = printed
            .lines()
            .find(|line| line.trim_start().starts_with(start));
        found
            .unwrap_or_else(|| panic!("no {start} in\n{printed}"))
            .trim()
            .to_owned()
    };
    assert_eq!(line("study"), "study   a-study");
    assert_eq!(line("cells"), "cells   2; 0 of them run a single trial");
    assert_eq!(line("trials"), "trials  40");
    assert_eq!(line("2 of 2"), "2 of 2 cells");
    assert!(line("closed form").starts_with("closed form: sphere on sphere"));
    assert!(line("least squares").contains("8 probes"));
    assert!(line("needs no").starts_with("needs no integrator"));
    let chosen = "chosen for a tolerance of 1e-9: the contact runs along geodesics";
    assert!(line("chosen").starts_with(chosen));
    assert_eq!(
        line("models, cheapest"),
        "models, cheapest first, in cell 0; errors: positions of the contacts at the end, relative to the first \
         contact's length scale"
    );
    assert!(line("> closed form").contains(" per trial"));
    // `check` also lists models that are more exact than the chosen one. Among these, `meridian` cannot compute this
    // roll, but RK4 can.
    assert!(line("meridian").contains("cannot: the first contact is not the apex"));
    assert!(line("RK4, 1 step").contains("error 7.7e-6, "));
    assert!(line("RK4, 1 step").ends_with(" x)"));
    assert!(line("time").contains("about a second"));
    assert!(line("time").ends_with(", planning included"));
    // All cells of a small study are checked, not a sample.
    assert!(!printed.contains("sample"), "{printed}");
    assert_untouched(&desk.path(""));
}

#[test]
fn each_combination_of_models_is_printed_once() {
    let objects = "[{ label = \"a\", kind = \"plane\" }, { label = \"b\", kind = \"saddle\", a = 0.01 }, \
                   { label = \"c\", kind = \"plane\" }]";
    let study = edited(STUDY, "scene.object.radius", "scene.object");
    let desk = Desk::with(&edited(&study, "[50, 5]", objects));
    let printed = desk.palpate("check c.toml").printed();
    assert!(printed.contains("  2 of 3 cells\n"), "{printed}");
    assert!(printed.contains("  1 of 3 cells\n"), "{printed}");
    assert_eq!(
        printed.matches("closed form: sphere on plane").count(),
        1,
        "{printed}"
    );
}

#[test]
fn the_chosen_rung_is_marked_for_projected_cameras_too() {
    // With the tolerance 0.3, the model `hertz` would also be allowed. But it takes as long as `half-space` and has a
    // larger error, so it is not chosen.
    for (sensor, tolerance, rung) in [
        ("direct", 0.3, "half-space, at the markers' depth"),
        ("projected", 0.3, "half-space, at the markers' depth"),
        ("projected", 0.1, "bonded layer, solved"),
    ] {
        let desk = Desk::with(&format!(
            "name = \"a-press\"\nlength_unit = \"mm\"\n[scene]\nkind = \"press\"\n\
             probe = {{ kind = \"marker-sphere\", radius = 20.0, marker_depth = 2.0, layout = \"published\", discs = {{ magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 }} }}\n\
             object = {{ kind = \"sphere\", radius = 80.0 }}\nmotion = {{ indentation = 1.0 }}\n\
             model = {{ kind = \"auto\", thickness = 15.0, tolerance = {tolerance} }}\n\
             sensor = {{ kind = \"{sensor}\" }}\n\
             estimator = {{ kind = \"half-space\", indentation = \"known\", indentation_std = 0.02 }}\n"
        ));
        let printed = desk.palpate("check c.toml").printed();
        for words in [
            &*format!("> {rung}"),
            "    needs no random numbers, no frames\n",
            "cell 0; errors: displacements of the markers, relative to the largest\n",
        ] {
            assert!(printed.contains(words), "{sensor}: {printed}");
        }
    }
}

#[test]
fn a_sample_of_many_cells_is_checked_and_reported() {
    let axis = |path: &str, from: f64, to: f64| {
        format!("[[sweep]]\npath = \"{path}\"\nfrom = {from}\nto = {to}\ncount = 200\n")
    };
    let radii = axis("scene.object.radius", 20.0, 80.0);
    let durations = axis("scene.motion.duration_s", 0.5, 1.0);
    let desk = Desk::with(&format!("{SCENE}{radii}{durations}"));
    desk.palpate("check c.toml").prints_all(&[
        "cells   40000; ",
        "\ntrials  at most ",
        "sample  each swept value is checked against the limits of its field; ",
        "all fields together are checked in ",
    ]);
}

/// Parts of configs. The test replaces every number in these parts by an extreme number.
const EXTREME: [&str; 3] = [
    "probe = { kind = \"sphere\", radius = 10.0 }\nobject = { kind = \"sphere\", radius = 30.0 }\n\
     motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }\n\
     sensor = { kind = \"pads\", pitch = 0.5, layout = \"uniform\", offset = \"random\" }\n",
    "probe = { kind = \"marker-sphere\", radius = 20.0, marker_depth = 2.0 }\nobject = { kind = \"sphere\", radius = 80.0 }\n\
     motion = { indentation = 1.0, contact_deg = [0.0, 0.0] }\n\
     model = { kind = \"auto\", thickness = 15.0, tolerance = 0.1 }\n\
     noise = { normal_displacement = { kind = \"gaussian\", std = 0.05 } }\n",
    "probe = { kind = \"sphere\", radius = 5.0 }\nobject = { kind = \"saddle\", a = 0.1 }\n\
     motion = { finger_positions = [-1.5, 0.0, 1.5], inter_finger_distance = 1.0, patch_length = 3.0, contacts_per_finger = 10 }\n\
     evaluate = { grid = 10, half_width = 1.0, gaussian_threshold = 0.005, mean_threshold = 0.03 }\n",
];

#[test]
fn no_number_makes_check_print_nan_or_infinity() {
    for (kind, scene) in ["roll", "press", "glide"].into_iter().zip(EXTREME) {
        check_of_extremes_is_finite(kind, scene);
    }
}

fn check_of_extremes_is_finite(kind: &str, scene: &str) {
    let desk = Desk::new();
    let numbers = |scene: &str| -> Vec<(usize, usize)> {
        let places = scene.match_indices(|c: char| c.is_ascii_digit());
        let starts = places.filter(|&(at, _)| {
            let before = scene[..at].chars().next_back();
            !before.is_some_and(|c| c.is_ascii_alphanumeric() || "._-".contains(c))
        });
        let end = |at: usize| {
            let rest = &scene[at..];
            at + rest
                .find(|c: char| !c.is_ascii_digit() && c != '.')
                .unwrap_or(rest.len())
        };
        starts.map(|(at, _)| (at, end(at))).collect()
    };
    for (start, end) in numbers(scene) {
        for value in ["1e-300", "1e6", "1e300"] {
            let text = format!(
                "name = \"x\"\ntrials = 2\n[scene]\nkind = \"{kind}\"\n{}{value}{}",
                &scene[..start],
                &scene[end..]
            );
            desk.write("c.toml", &text);
            let ended = desk.palpate("check c.toml");
            let said = format!("{}{}", ended.stdout, ended.stderr);
            assert!(matches!(ended.status, Some(0..=2)), "{text}{ended:?}");
            assert!(!said.is_empty(), "{text}");
            let mut words = said.split(|c: char| !c.is_ascii_alphanumeric());
            let bad = words.find(|word| ["NaN", "nan", "inf"].contains(word));
            assert_eq!(bad, None, "{text}{said}");
        }
    }
}

/// Tests three presses. The first is within the range of the measured random scenes, and the second is deeper than all
/// of these scenes. For the estimator of the third press, no random scenes were measured.
#[test]
fn check_reports_whether_intervals_were_tested() {
    let press = r#"
name = "a-press"
length_unit = "mm"
trials = 10
[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
object = { kind = "sphere", radius = 30.0 }
motion = { indentation = 1.0 }
sensor = { kind = "direct", tangential = false }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 } }
estimator = { kind = "half-space", indentation = "fitted" }
"#;
    let desk = Desk::with(press);
    let after = |line: &str| {
        let printed = desk.palpate("check c.toml").printed();
        let lines = printed
            .lines()
            .skip_while(|one| !one.starts_with("intervals"));
        let at = lines.skip(2).take(2).map(str::trim);
        let texts = at.collect::<Vec<_>>();
        assert!(texts[0].starts_with(line), "{printed}");
        texts[1].to_owned()
    };
    assert!(
        after("tested: in 24 random scenes they contained the true value in 9").starts_with("time")
    );
    desk.write(
        "c.toml",
        edited(press, "indentation = 1.0", "indentation = 2.0"),
    );
    let nearest = after(
        "not tested: random scenes have no scene.motion.indentation of 2 mm (they have 0.6 to 1.4 mm)",
    );
    assert!(
        nearest.starts_with("most similar: in 24 random"),
        "{nearest}"
    );
    desk.write(
        "c.toml",
        edited(press, "kind = \"half-space\", ", "kind = \"gaussian\", "),
    );
    after(
        "not tested: random scenes have no scene.estimator.kind of \"gaussian\" (they have \"half-space\")",
    );
}
