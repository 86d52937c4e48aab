//! Presses whose estimate is a fit to the camera's images of the markers.

use palpate_scene::{Scene, Scenes, SharedModels};
use palpate_study::config::parse;
use palpate_sweep::Observation;

/// Config of a press on a ball with a radius of 40 mm. A camera reads the press, and the estimator uses the images of
/// the markers.
fn text(sensor: &str, noise: &str, model: &str) -> String {
    format!(
        r#"
        name = "pictures"
        length_unit = "mm"
        scene.kind = "press"
        scene.object = {{ kind = "sphere", radius = 40.0 }}
        scene.motion = {{ indentation = 1.0, contact_deg = [9.0, 30.0] }}
        scene.model = {model}
        scene.sensor = {sensor}
        scene.noise = {noise}
        scene.estimator = {{ kind = "image", indentation = "fitted" }}
        [scene.probe]
        kind = "marker-sphere"
        radius = 20.0
        marker_depth = 2.0
        discs = {{ magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0, misalignment = 0.25 }}
        "#
    )
}

fn scene(text: &str) -> Scene {
    let study = parse("pictures.toml", text).expect("a study");
    let cell = study.cell(0).expect("a cell");
    let scene = study.estimable_scene_of(0, &cell, &SharedModels::default());
    scene.expect("a scene")
}

fn outcomes(scene: &Scene, quantity: &str, trials: u64) -> Vec<Observation> {
    let place = scene
        .quantities()
        .iter()
        .position(|one| one.name == quantity);
    let mut outcomes = Vec::new();
    for trial in 0..trials {
        let mut observe = |quantity: usize, outcome: Observation| {
            if Some(quantity) == place {
                outcomes.push(outcome);
            }
        };
        scene.trial(trial, &mut observe).expect("an estimate");
    }
    outcomes
}

#[test]
fn images_without_errors_determine_the_press() {
    for model in [
        r#"{ kind = "half-space" }"#,
        r#"{ kind = "bonded-layer", thickness = 6.0 }"#,
    ] {
        let scene = scene(&text(r#"{ kind = "projected" }"#, "{}", model));
        let found = outcomes(&scene, "object_curvature", 1);
        assert!((found[0].estimate * 40.0 - 1.0).abs() < 1e-3, "{found:?}");
        let found = outcomes(&scene, "indentation", 1);
        assert!((found[0].estimate - 1.0).abs() < 1e-4, "{found:?}");
    }
}

/// Tests the intervals if the sensor parameters are drawn anew in every trial, and the estimator has only the nominal
/// parameters and their standard deviations.
#[test]
fn intervals_hold_over_redrawn_sensors() {
    let noise = r#"{ centroid = { kind = "gaussian", std = 0.005 }, hue = { kind = "gaussian", std = 1e-4 },
        size = { kind = "gaussian", std = 4e-4 }, sensor = { centre_px = 0.29, scale = 0.002, place = 0.05,
        turn_deg = 0.3, disc_depth = 0.03, disc_diameter = 0.01, colour = 0.01 } }"#
        .replace('\n', " ");
    let sensor = r#"{ kind = "projected", calibration = { rest_frames = 1 } }"#;
    let scene = scene(&text(sensor, &noise, r#"{ kind = "half-space" }"#));
    let found = outcomes(&scene, "object_curvature", 60);
    let (mut held, mut squared, mut stated) = (0, 0.0, 0.0);
    for outcome in &found {
        held += usize::from(outcome.interval_holds.is_some_and(|[_, _, wide]| wide));
        squared += (outcome.estimate - outcome.truth).powi(2);
        stated += outcome.std.map_or(0.0, |std| std * std);
    }
    // With correct 95 % intervals, the probability that 51 or fewer of 60 contain the true value is 0.3 %.
    assert!(held > 51, "{held} of 60");
    // The root mean square of 60 errors has a relative standard error of 9 %. The limits of `ratio` are about three
    // standard errors away from 1.
    let ratio = (stated / squared).sqrt();
    assert!((0.75..1.35).contains(&ratio), "{ratio}");
}

#[test]
fn rendered_frames_determine_the_press_within_the_stated_error() {
    let sensor = r#"{ kind = "rendered", size_px = 500, calibration = { rest_frames = 2 } }"#;
    let noise = r#"{ pixel = { kind = "gaussian", std = 3.0 } }"#;
    let model = r#"{ kind = "bonded-layer", thickness = 6.0 }"#;
    let scene = scene(&text(sensor, noise, model));
    for outcome in outcomes(&scene, "object_curvature", 3) {
        let std = outcome.std.expect("stated");
        assert!(
            (outcome.estimate - outcome.truth).abs() < 4.5 * std,
            "{outcome:?}"
        );
        assert!(std * 40.0 < 0.2, "{outcome:?}");
    }
}

#[test]
fn pictures_need_a_camera() {
    let refused = parse(
        "pictures.toml",
        &text(r#"{ kind = "direct" }"#, "{}", r#"{ kind = "half-space" }"#),
    );
    let said = refused.expect_err("no camera").to_string();
    assert!(
        said.contains("an estimator of kind image needs a camera"),
        "{said}"
    );
}

/// Tests that the estimate is corrected for a bias: if the depths and colours of the discs are uncertain, the most
/// likely curvature is biased.
#[test]
fn curvatures_are_right_in_the_mean_over_sensors() {
    let noise =
        r#"{ centroid = { kind = "gaussian", std = 0.01 }, hue = { kind = "gaussian", std = 3e-4 },
        size = { kind = "gaussian", std = 1e-3 }, sensor = { disc_depth = 0.03, colour = 0.01 } }"#
            .replace('\n', " ");
    let sensor = r#"{ kind = "projected", calibration = { rest_frames = 1 } }"#;
    let model = r#"{ kind = "bonded-layer", thickness = 4.2 }"#;
    let text = text(sensor, &noise, model).replace("misalignment = 0.25", "misalignment = 0.05");
    let scene = scene(&text);
    let count = 120;
    let found = outcomes(&scene, "object_curvature", count);
    let count = count as f64;
    let error = |outcome: &Observation| outcome.estimate - outcome.truth;
    let mean = found.iter().map(error).sum::<f64>() / count;
    let squares = found.iter().map(|outcome| (error(outcome) - mean).powi(2));
    let scatter = (squares.sum::<f64>() / (count - 1.0)).sqrt();
    // The estimates must have almost no bias: for 120 trials, the standard error of the mean error is 0.09 times
    // `scatter`, the standard deviation of the errors. The most likely curvatures, which are not corrected for bias,
    // would have a mean error of 0.6 times `scatter`.
    assert!(mean.abs() < 0.3 * scatter, "{mean} {scatter}");
}
