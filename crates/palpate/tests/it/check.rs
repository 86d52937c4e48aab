//! `palpate check` and `palpate schema`.

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
    assert_eq!(line("cells"), "cells   2, of which 0 run a single trial");
    assert_eq!(line("trials"), "trials  40");
    assert_eq!(line("2 of 2"), "2 of 2 cells");
    assert!(line("closed form").starts_with("closed form: sphere on sphere"));
    assert!(line("least squares").contains("8 probes"));
    assert!(line("needs no").starts_with("needs no integrator"));
    let chosen = "chosen for a tolerance of 1e-9: the contact runs along geodesics";
    assert!(line("chosen").starts_with(chosen));
    assert_eq!(
        line("rungs"),
        "rungs of the model, in cell 0; errors: places of the contacts at the end, relative to the first \
         contact's length scale"
    );
    assert!(line("> closed form").contains(" per trial"));
    // The next rungs up: one that cannot, and one that can.
    assert!(line("meridian").contains("cannot: the first contact is not the apex"));
    assert!(line("RK4, 1 step").contains("error 7.7e-6, "));
    assert!(line("RK4, 1 step").ends_with(" x)"));
    assert!(line("time").contains("about a second"));
    assert!(line("time").ends_with(", planning included"));
    assert_untouched(&desk.path(""));
}

#[test]
fn each_combination_of_models_stands_once() {
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
fn a_scene_without_noise() {
    let printed = Desk::with(SCENE).palpate("check c.toml").printed();
    assert!(
        printed.contains("cells   1, of which 1 run a single trial\n"),
        "{printed}"
    );
    assert!(printed.contains("trials  1\n"), "{printed}");
}

#[test]
fn what_run_refuses_check_refuses() {
    let one = edited(
        SCENE,
        "duration_s = 1.0",
        "duration_s = 1.0, directions_deg = [0]",
    );
    let desk = Desk::with(&one);
    assert_eq!(
        desk.palpate("check c.toml").said(2),
        desk.palpate("run c.toml").said(2)
    );
}

#[test]
fn the_schema_is_json_and_knows_units() {
    let printed = Desk::new().palpate("schema").printed();
    let schema: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(schema["type"], "object");
    assert!(
        schema["required"]
            .as_array()
            .unwrap()
            .contains(&"scene".into())
    );
    assert!(schema["properties"]["scene"].is_object());
    assert!(printed.contains("\"x-unit\": \"length\""));
}

#[test]
fn a_noiseless_press_needs_neither_draws_nor_frames() {
    let press = "name = \"p\"\nlength_unit = \"mm\"\n[scene]\nkind = \"press\"\n\
        probe = { kind = \"marker-sphere\", radius = 20.0, marker_depth = 2.0 }\n\
        object = { kind = \"sphere\", radius = 80.0 }\nmotion = { indentation = 1.0 }\n\
        model = { kind = \"auto\", thickness = 15.0 }\n";
    let printed = Desk::with(press).palpate("check c.toml").printed();
    assert!(
        printed.contains("    needs no random numbers, no frames\n"),
        "{printed}"
    );
    assert!(
        printed.contains("cell 0; errors: displacements of markers, relative to the largest\n"),
        "{printed}"
    );
    assert!(printed.contains("      > bonded layer"), "{printed}");
    assert!(printed.contains("        half-space"), "{printed}");
}

#[test]
fn the_rung_that_is_marked_is_the_one_that_is_chosen_behind_a_camera_too() {
    // Discs move otherwise than the markers between them, so that Hertz contact errs by more.
    for (sensor, tolerance, rung) in [
        ("direct", 0.3, "Hertz contact, at the surface"),
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
        assert!(
            printed.contains(&format!("> {rung}")),
            "{sensor}: {printed}"
        );
    }
}
