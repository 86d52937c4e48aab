//! Settings of a press: what `check` prints about them, trials that fail, and settings that are rejected.

use palpate_scene::Scene;

use super::elliptic_press::{cylinder, ellipsoid};
use super::press::{BALL, DISH, NOISE, PLANE, outcomes, refused, scene_of, text};

pub(super) fn needs_of(scene: &Scene) -> String {
    let needs = scene.needs().into_iter().map(|need| need.to_string());
    needs.collect::<Vec<_>>().join("\n")
}

#[test]
fn presses_that_cannot_be_are_failures_with_a_name() {
    for (object, motion, name) in [
        (r#"{ kind = "dish", radius = 20 }"#, "1.0", "conforming"),
        (r#"{ kind = "dish", radius = 10 }"#, "1.0", "edge-contact"),
        (PLANE, "20.0", "too-deep"),
        (r#"{ kind = "dish", radius = 20.5 }"#, "5.0", "too-wide"),
        (PLANE, "1e-300", "out-of-range"),
        (&cylinder(2.0, 0.0), "4.0", "too-wide"),
        (&ellipsoid([1.0, 2.0, 1.0]), "3.0", "too-wide"),
        (&ellipsoid([1e-300, 1.0, 1e300]), "1.0", "out-of-range"),
    ] {
        let text = text(object, NOISE)
            .replace("indentation = 1.0 }", &format!("indentation = {motion} }}"));
        let scene = scene_of(&text);
        assert_eq!(outcomes(&scene, 0).unwrap_err(), name, "{object} {motion}");
        let needs = needs_of(&scene);
        assert!(needs.contains(&format!("fails as `{name}`")), "{needs}");
        assert!(needs.len() < 1000, "{needs}");
        // True values that do not depend on the contact are available, although there is no contact.
        assert!(scene.truth(3).is_some());
        assert_eq!(
            scene.truth(1).is_some(),
            !["conforming", "edge-contact"].contains(&name)
        );
    }
}

#[test]
fn presses_without_useful_readings_have_warnings() {
    let moved = |more: &str, lines: &str| {
        let plane = text(PLANE, &format!("{NOISE}{lines}"));
        plane.replace(
            "indentation = 1.0 }",
            &format!("indentation = 1.0{more} }}"),
        )
    };
    let needs = |text: &str| needs_of(&scene_of(text));
    let off = "every trial fails as `off-markers`: the estimated contact is";
    assert!(needs(&moved(", contact_deg = [180, 0]", "")).contains(off));
    assert!(needs(&moved(", contact_deg = [120, 0]", "")).contains(off));
    assert!(!needs(&moved(", contact_deg = [30, 0]", "")).contains(off));
    let scene = scene_of(&moved(", contact_deg = [180, 0]", ""));
    assert!((0..20).all(|trial| outcomes(&scene, trial) == Err("off-markers")));

    let slips = "is more than the contact radius, 4.47: the strains are not small";
    assert!(needs(&moved(", shift = 5", "")).contains(slips));
    assert!(!needs(&moved(", shift = 4", "")).contains("the strains are not small"));

    let layer = "model = { kind = \"bonded-layer\", thickness = 3.0 }\n";
    let half_space = "estimator = { kind = \"half-space\", indentation = \"fitted\" }\n";
    let same = "estimator = { kind = \"bonded-layer\", indentation = \"fitted\" }\n";
    let other = "warning: even without noise the estimate";
    let lines = needs(&moved("", &format!("{layer}{half_space}")));
    assert!(lines.contains(other), "{lines}");
    assert!(!needs(&moved("", &format!("{layer}{same}"))).contains(other));
    assert!(!needs(&moved("", half_space)).contains(other));
    let thinner =
        "estimator = { kind = \"bonded-layer\", thickness = 2.7, indentation = \"known\" }\n";
    assert!(needs(&moved("", &format!("{layer}{thinner}"))).contains(other));
    let gaussian = "estimator = { kind = \"gaussian\", c = 10.0, indentation = \"known\" }\n";
    let lines = needs(&moved("", gaussian));
    assert!(
        lines.contains("even without noise the estimated curvature is"),
        "{lines}"
    );
}

#[test]
fn needs_describe_the_scene() {
    let needs = |object: &str, indentation: &str, lines: &str| {
        let text = text(object, lines);
        let text = text.replace(
            "indentation = 1.0 }",
            &format!("indentation = {indentation} }}"),
        );
        needs_of(&scene_of(&text))
    };
    let (plain, noisy) = (needs(PLANE, "1.0", ""), needs(BALL, "1.0", NOISE));
    for (needs, line) in [
        (
            &plain,
            "Hertz contact on a half-space, at the markers' depth: closed form",
        ),
        (&plain, "flat contact"),
        (&plain, "no noise: no random numbers are drawn"),
        (
            &plain,
            "direct sensor: 77 markers, with displacements along the skin",
        ),
        (
            &plain,
            "least-squares fit of a half-space, indentation given, noise as stated",
        ),
        (&noisy, "convex contact: the object bulges"),
        (
            &noisy,
            "noise: Gaussian errors of normal displacements, drawn per marker; of tangential displacements, drawn per marker and component; of the given indentation",
        ),
    ] {
        assert!(needs.lines().any(|need| need == line), "{line}: {needs}");
    }
    assert!(!plain.contains("warning"), "{plain}");
    // The contact radius is a = 6.32. For this radius, the indentation is a atanh(a/R) = 2.0710 by Sneddon's relation,
    // and 2 by Hertz's relation.
    let wide = needs(PLANE, "2.0", "");
    assert!(
        wide.contains("warning: the contact's radius is 0.32 of the sensor's radius, above 0.3: Sneddon's relation gives an indentation that is 3.5 % larger than Hertz's"),
        "{wide}"
    );
    // The contact radius is a = 1.35 mm, and the radius of the ball is R = 2 mm. By Sneddon's relation, the indentation
    // is (a/2) ln((R + a)/(R − a)).
    let sharp = needs(r#"{ kind = "sphere", radius = 2 }"#, "1.0", "");
    assert!(
        sharp.contains("warning: the contact's radius is 0.67 of the object's radius, above 0.3: Sneddon's relation gives an indentation that is 21.4 % larger than Hertz's"),
        "{sharp}"
    );
    let surface = needs(PLANE, "1.0", "model = { kind = \"hertz\" }\n");
    assert!(
        surface.contains("warning: the model moves the markers as if they were at the surface"),
        "{surface}"
    );
    let frames = needs(
        DISH,
        "1.0",
        "sensor = { kind = \"direct\", tangential = false, frames = 4 }\n",
    );
    assert!(
        frames.contains("77 markers, without displacements along the skin, the mean of 4 frames")
    );
    assert!(frames.contains("concave contact: the object is hollow"));
}

#[test]
fn bad_scenes_are_refused_at_their_field() {
    let probe = |from: &str, to: &str| text(PLANE, "").replace(from, to);
    let with = |lines: &str| text(PLANE, lines);
    for (text, message) in [
        (
            probe("marker_depth = 2.0", "marker_depth = 20"),
            "scene.probe.marker_depth: must be less than the sensor's radius 20, is 20",
        ),
        (
            probe("radius = 20.0", "radius = 1e99"),
            "scene.probe.radius: radius is 1e99; it must be between 1e-50 and 1e50",
        ),
        (
            probe(
                "marker_depth = 2.0 }",
                "marker_depth = 2.0, layout = { kind = \"lattice\", pitch = 0.01, cap_deg = 60 } }",
            ),
            "scene.probe.layout: there would be 12566370 markers; at most 100000 are possible",
        ),
        (
            probe(
                "marker_depth = 2.0 }",
                "marker_depth = 2.0, layout = { kind = \"line\", markers = 2, length = 2 } }\nsensor = { kind = \"direct\", tangential = false }",
            ),
            "scene.probe.layout: 2 marker(s)",
        ),
        (
            probe(
                "indentation = 1.0",
                "indentation = 1.0, contact_deg = [-1, 0]",
            ),
            "scene.motion.contact_deg: the polar angle must be from 0 to 180, is -1",
        ),
        (
            probe("indentation = 1.0", "indentation = 1.0, shift = 100"),
            "scene.motion.shift: |shift| must be less than the sensor's radius 20, is 100",
        ),
        (
            with("model = { kind = \"bonded-layer\", thickness = 1.5 }"),
            "scene.probe.marker_depth: the markers lie below the layer: their depth must be at most `scene.model.thickness`",
        ),
        (
            text(
                &cylinder(9.0, 0.0),
                "model = { kind = \"bonded-layer\", thickness = 9 }",
            ),
            "scene.object: a layer is modelled only for circular contacts: the object must be round, or the model must be a half-space",
        ),
        (
            text(&cylinder(9.0, 0.0), "")
                .replace("indentation = 1.0", "indentation = 1.0, shift = 0.1"),
            "scene.motion.shift: sideways movement is modelled only for circular contacts: the movement must be 0, or the object must be round",
        ),
        (
            with("model = { kind = \"bonded-layer\", thickness = 21 }"),
            "scene.model.thickness: must be at most the sensor's radius 20, is 21",
        ),
        (
            with("estimator = { kind = \"bonded-layer\" }"),
            "scene.estimator: `thickness` is missing, and the model has no layer whose thickness could be used",
        ),
        (
            with("estimator = { kind = \"bonded-layer\", thickness = 1 }"),
            "scene.estimator.thickness: the layer ends above the markers: its thickness must be at least `scene.probe.marker_depth`",
        ),
        (
            with("sensor = { kind = \"rendered\" }"),
            "scene.probe: `discs` is missing",
        ),
        (
            with("noise = { wrong_markers = { count = 78, std = 1.0 } }"),
            "scene.noise.wrong_markers.count: must be at most the number of markers 77, is 78",
        ),
    ] {
        let said = refused(&text);
        assert!(said.starts_with(message), "{said}\n{message}");
    }
}

#[test]
fn every_layout_and_estimator_runs() {
    for layout in [
        r#""published""#,
        r#"{ kind = "gores", gores = 6, rows = [1, 2, 3], row_spacing_deg = 10 }"#,
        r#"{ kind = "lattice", pitch = 2.0, cap_deg = 60 }"#,
    ] {
        for estimator in [
            r#"{ kind = "half-space", baseline = "fitted", gain_std = 0.1, noise = "found" }"#,
            r#"{ kind = "bonded-layer", indentation = "fitted" }"#,
            r#"{ kind = "gaussian", window = 9.0 }"#,
            r#"{ kind = "gaussian", c = 0.88, window = 9.0, indentation = "fitted" }"#,
        ] {
            let model = if estimator.contains("layer") {
                r#"{ kind = "bonded-layer", thickness = 8.0 }"#
            } else {
                r#"{ kind = "half-space" }"#
            };
            let lines = format!("{NOISE}model = {model}\nestimator = {estimator}\n");
            let text = text(BALL, &lines).replace(
                "marker_depth = 2.0 }",
                &format!("marker_depth = 2.0, layout = {layout} }}"),
            );
            let outcomes = outcomes(&scene_of(&text), 0)
                .unwrap_or_else(|name| panic!("{name}: {layout} {estimator}"));
            let (_, radius) = outcomes[1];
            // The estimator `gaussian` computes the radius as R = c σ²/δ. If the constant c is stated instead of
            // calibrated, the estimated radius is arbitrary.
            let tolerance = if estimator.contains("c = ") {
                10.0
            } else {
                0.6
            };
            let relative = radius.estimate / 16.0 - 1.0;
            assert!(
                relative.abs() < tolerance,
                "{layout} {estimator}: {radius:?}"
            );
        }
    }
}
