//! Presses that a camera reads: readings and random draws at each level of detail, and settings that are rejected.

use nalgebra::Vector3;
use palpate_chromatouch::{Camera, Lens, OddTerms};
use palpate_press::{Markers, Skin};
use palpate_scene::Scene;
use palpate_study::config::LengthUnit;
use palpate_sweep::Observation;
use palpate_tracking::Equidistant;

use super::press::{refused, scene_of as scene};

/// Config of a press: the sensor of the 2020 paper is pressed onto a plane. The soft body is a layer with a thickness
/// of 5 mm on a core. The indentation is 1 mm.
fn text(sensor: &str, noise: &str) -> String {
    format!(
        r#"name = "a-study"
length_unit = "mm"
seed = 3

[scene]
kind = "press"
probe = {{ kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = {{ magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 }} }}
object = {{ kind = "plane" }}
motion = {{ indentation = 1.0 }}
model = {{ kind = "bonded-layer", thickness = 5.0 }}
sensor = {{ {sensor} }}
noise = {{ {noise} }}
estimator = {{ kind = "bonded-layer" }}
"#
    )
}

fn outcomes(scene: &Scene, trial: u64, name: &str) -> Vec<Observation> {
    let mut outcomes = Vec::new();
    scene
        .trial(trial, |quantity, outcome| {
            if scene.quantities()[quantity].name == name {
                outcomes.push(outcome);
            }
        })
        .unwrap();
    outcomes
}

fn rms_error(outcomes: &[Observation]) -> f64 {
    let squares = outcomes
        .iter()
        .map(|one| (one.estimate - one.truth).powi(2));
    (squares.sum::<f64>() / outcomes.len() as f64).sqrt()
}

fn only(scene: &Scene, trial: u64, name: &str) -> Observation {
    let outcomes = outcomes(scene, trial, name);
    assert_eq!(outcomes.len(), 1, "{name}");
    outcomes[0]
}

#[test]
fn an_image_without_errors_yields_displacements_and_draws_nothing() {
    for (from, limit) in [("hue", 0.012), ("size", 0.004), ("both", 0.002)] {
        let sensor = format!(r#"kind = "projected", normal_from = "{from}""#);
        let scene = scene(&text(&sensor, ""));
        // Nothing in this scene is random, so all trials are equal and one trial is run.
        assert_eq!(scene.trials(1000), 1);
        let normal = outcomes(&scene, 0, "normal_displacement");
        assert_eq!(normal.len(), 77);
        // The estimated displacement has an error even without noise. The reason is that the hue depends on the
        // difference between the displacements of a marker's two discs, and not only on the displacement of the marker.
        assert!(rms_error(&normal) < limit, "{from}: {}", rms_error(&normal));
        let tangential = outcomes(&scene, 0, "tangential_displacement");
        assert_eq!(tangential.len(), 2 * 77);
        assert!(rms_error(&tangential) < 0.01, "{}", rms_error(&tangential));
        assert_eq!(only(&scene, 0, "pixels").estimate, 0.0);
        assert_eq!(only(&scene, 0, "wrong_matches").estimate, 0.0);
        assert_eq!(only(&scene, 0, "markers_tracked").estimate, 77.0);
        let same = outcomes(&scene, 41, "normal_displacement");
        assert_eq!(normal, same);
    }
}

#[test]
fn rendered_and_projected_cameras_agree() {
    let sensor = |kind: &str| text(&format!(r#"kind = "{kind}""#), "");
    let (projected, rendered) = (scene(&sensor("projected")), scene(&sensor("rendered")));
    assert_eq!(rendered.trials(1000), 1);
    for (name, limit) in [
        ("normal_displacement", 0.01),
        ("tangential_displacement", 0.003),
        ("hue_change", 2e-4),
        // The mean hue has a larger error than the hue: a pixel at the edge of two aligned discs may have a hue on
        // either side of red. At red, the angle of the hue jumps by a full turn.
        ("mean_hue_change", 0.015),
        ("centroid_shift", 0.02),
    ] {
        let (seen, found) = (outcomes(&projected, 0, name), outcomes(&rendered, 0, name));
        assert_eq!(seen.len(), found.len(), "{name}");
        for (seen, found) in seen.iter().zip(&found) {
            assert_eq!(seen.truth, found.truth, "{name}");
            let off = (seen.estimate - found.estimate).abs();
            assert!(off < limit, "{name}: {seen:?} {found:?}");
        }
    }
    assert_eq!(only(&rendered, 0, "pixels").estimate, 640.0 * 640.0);
}

#[test]
fn pixel_noise_is_drawn_anew_in_every_trial_and_replayed() {
    let noise = r#"pixel = { kind = "gaussian", std = 2.0 }, lost_markers = { count = 8 }"#;
    let scene = scene(&text(r#"kind = "rendered", size_px = 265"#, noise));
    assert_eq!(scene.trials(1000), 1000);
    let tracked = only(&scene, 5, "markers_tracked");
    assert_eq!((tracked.estimate, tracked.truth), (69.0, 69.0));
    assert_eq!(only(&scene, 5, "wrong_matches").estimate, 0.0);
    let [one, again, other] = [5, 5, 6].map(|trial| outcomes(&scene, trial, "normal_displacement"));
    assert_eq!(one.len(), 69);
    assert_eq!(one, again);
    assert_ne!(one, other);
    assert!(rms_error(&one) < 0.03, "{}", rms_error(&one));
}

#[test]
fn errors_of_images_have_the_stated_size_and_frames_at_rest_are_averaged() {
    let exact = only(&scene(&text(r#"kind = "projected""#, "")), 0, "hue_change");
    assert_eq!(exact.estimate, exact.truth);
    let mut square = 0.0;
    let noise = r#"hue = { kind = "gaussian", std = 0.001 }"#;
    let sensor = r#"kind = "projected", calibration = { rest_frames = 1000 }"#;
    for seed in 3..7 {
        let noisy = scene(&text(sensor, noise).replace("seed = 3", &format!("seed = {seed}")));
        let errors = (0..200).map(|trial| {
            let error = only(&noisy, trial, "hue_change").estimate - exact.truth;
            square += error * error;
            error
        });
        // The hue in each frame has an error with the standard deviation 0.001 turns. Therefore the mean error of the
        // hue change, over 1000 frames at rest and 200 presses, has a standard error of 0.001 √(1/1000 + 1/200) =
        // 7.7e-5 turns.
        let mean = errors.sum::<f64>() / 200.0;
        assert!(mean.abs() < 2.3e-4, "{seed}: {mean}");
    }
    let spread = f64::sqrt(square / 800.0);
    assert!((spread / 0.001 - 1.0).abs() < 0.15, "{spread}");
}

#[test]
fn the_standard_deviation_includes_the_noise_of_the_camera() {
    let noise = r#"hue = { kind = "gaussian", std = 0.0005 }"#;
    let sensor = r#"kind = "projected", normal_from = "hue", tangential = false"#;
    let noisy = scene(&text(sensor, noise));
    let estimates: Vec<Observation> = (0..100)
        .map(|trial| only(&noisy, trial, "relative_curvature"))
        .collect();
    let mean = estimates.iter().map(|one| one.estimate).sum::<f64>() / 100.0;
    let squares = estimates.iter().map(|one| (one.estimate - mean).powi(2));
    let scatter = (squares.sum::<f64>() / 99.0).sqrt();
    let stated = estimates.iter().filter_map(|one| one.std).sum::<f64>() / 100.0;
    assert!(
        (0.5..2.0).contains(&(stated / scatter)),
        "{stated} {scatter}"
    );
}

#[test]
fn a_trace_has_the_tracks_and_frames_of_the_camera() {
    let press = scene(&text(r#"kind = "rendered", size_px = 265"#, ""));
    let trace = press.trace(None, LengthUnit::Mm).unwrap();
    let seen = trace.camera.unwrap();
    let header =
        "marker,x_px,y_px,hue_turns,dx_px,dy_px,dhue_turns,status,mean_hue_turns,dmean_hue_turns\n";
    assert!(seen.markers.to_csv().starts_with(header));
    assert_eq!(seen.markers.rows.len(), 77);
    assert!(seen.markers.rows.iter().all(|row| row[7] == "tracked"));
    let [rest, pressed] = seen.frames.unwrap();
    assert_eq!(rest.dimensions(), (265, 265));
    assert_ne!(rest, pressed);
    assert_eq!(trace.readings.rows.len(), 77);
}

#[test]
fn tracking_reads_the_lens_that_the_optics_have() {
    for [k3, k5] in [[0.05, -0.02], [-0.2, 0.02], [0.1, 0.01]] {
        let lens = Lens::from(OddTerms { k3, k5 });
        let camera = Camera::new(lens, 640, 65.0).unwrap();
        let read = Equidistant::new(camera.centre_px(), camera.px_per_rad(), [k3, k5]).unwrap();
        for step in 0..65 {
            let (polar, azimuth) = (f64::from(step).to_radians(), 0.1 * f64::from(step));
            let ((sine, cosine), (up, along)) = (libm::sincos(polar), libm::sincos(azimuth));
            let seen = camera.image(&Vector3::new(sine * along, sine * up, cosine));
            let place = read.place(seen.unwrap());
            assert!((place[0] - polar * along).abs() < 1e-12, "{k3} {step}");
            assert!((place[1] - polar * up).abs() < 1e-12, "{k3} {step}");
        }
    }
}

#[test]
fn a_lens_with_odd_terms_leaves_displacements_as_they_are() {
    // The simulated lens and the lens of the calibration are the same. There are no pixels and no noise, so only the
    // finite size of the discs causes errors.
    let results = |terms: &str| {
        let scene = scene(&text(&format!(r#"kind = "projected"{terms}"#), ""));
        [
            rms_error(&outcomes(&scene, 0, "normal_displacement")),
            rms_error(&outcomes(&scene, 0, "tangential_displacement")),
            only(&scene, 0, "object_curvature").estimate,
        ]
    };
    let straight = results("");
    assert_eq!(results(", k3 = 0.0, k5 = 0.0"), straight);
    for terms in [", k3 = 0.05", ", k3 = -0.1, k5 = 0.01"] {
        let bent = results(terms);
        assert_ne!(bent, straight);
        for (bent, straight) in bent.iter().zip(straight) {
            assert!((bent - straight).abs() < 2e-3, "{terms}: {bent} {straight}");
        }
    }
}

#[test]
fn sensors_that_cannot_be_are_refused_at_the_field() {
    let projected = r#"kind = "projected""#;
    let rendered = r#"kind = "rendered""#;
    let pixel = r#"pixel = { kind = "gaussian", std = 2.0 }"#;
    let hue = r#"hue = { kind = "gaussian", std = 0.001 }"#;
    let plain = text(projected, "");
    for (text, path) in [
        (text(projected, pixel), "scene.noise.pixel"),
        (text(rendered, hue), "scene.noise.hue"),
        (
            text(rendered, "lost_markers = { count = 78 }"),
            "scene.noise.lost_markers.count",
        ),
        (
            text(r#"kind = "projected", k3 = -0.3"#, ""),
            "scene.sensor.k3",
        ),
        // With this narrow field of view, only the edge of the marker is visible.
        (
            text(r#"kind = "projected", field_deg = 1.0"#, ""),
            "scene.sensor",
        ),
        (
            text(
                r#"kind = "projected", calibration = { indentation = 6.0 }"#,
                "",
            ),
            "scene.sensor.calibration",
        ),
        (
            plain.replace("separation = 2.0", "separation = 5.0"),
            "scene.probe.discs.separation",
        ),
        (
            plain.replace("yellow_diameter = 2.0", "yellow_diameter = 5.0"),
            "scene.probe.discs",
        ),
        (
            plain.replace("indentation = 1.0", "indentation = 1.0, shift = 0.5"),
            "scene.motion.shift",
        ),
    ] {
        let message = refused(&text);
        assert!(message.starts_with(path), "{path}: {message}");
    }
}

#[test]
fn a_sideways_shift_moves_the_centroid() {
    let half_space = |shift: &str| {
        text(r#"kind = "projected""#, "")
            .replace(
                r#"kind = "bonded-layer", thickness = 5.0"#,
                r#"kind = "half-space""#,
            )
            .replace(r#"estimator = { kind = "bonded-layer" }"#, "")
            .replace("indentation = 1.0", &format!("indentation = 1.0{shift}"))
    };
    let still = only(&scene(&half_space("")), 0, "centroid_shift");
    assert!(still.estimate < 1e-9, "{still:?}");
    let shifted = |shift: f64| {
        let scene = scene(&half_space(&format!(", shift = {shift}")));
        only(&scene, 0, "centroid_shift").estimate
    };
    let [once, twice] = [shifted(0.5), shifted(1.0)];
    // The object shifts along the skin, and the discs at the depths 1 and 3 follow a share of this shift. The contact
    // radius is √(R δ), with the effective radius R = 20 and the indentation δ = 1. The image scale is 319.5 px per
    // 65°.
    let apex = Markers::new(Skin::new(20.0).unwrap(), &[[0.0; 2]]).unwrap();
    let followed = |depth: f64| {
        let moved = apex.shifted(0.5, depth, 20_f64.sqrt(), [0.0; 2], 1.0);
        moved.unwrap()[0].tangential[0] / (20.0 - depth)
    };
    let expected = 319.5 / 65_f64.to_radians() * 0.5 * 0.5 * (followed(1.0) + followed(3.0));
    // The expected value neglects two effects of the shift: the discs also move towards the camera, and the visible
    // share of each disc changes.
    assert!((once / expected - 1.0).abs() < 0.07, "{once} {expected}");
    assert!((twice / once - 2.0).abs() < 0.05, "{once} {twice}");
}
