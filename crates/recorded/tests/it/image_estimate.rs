//! Estimates of presses by a fit to recorded camera frames.

use image::{Rgb, RgbImage};
use palpate_recorded::{
    CameraEstimate, Frame, FrameReader, PictureOptions, calibrate_camera, track_frames,
};
use palpate_scene::{PressScene, Scene, Scenes, SharedModels, Trials};
use palpate_study::config::{LengthUnit, Study, parse};
use serde_json::Value;

fn study() -> Study {
    parse("frames.toml", TEXT).expect("a study")
}

const TEXT: &str = r#"
name = "frames"
length_unit = "mm"
seed = 3
scene.kind = "press"
scene.object = { kind = "sphere", radius = 30.0 }
scene.motion = { indentation = 1.0, contact_deg = [6.0, 40.0] }
scene.model = { kind = "bonded-layer", thickness = 5.0 }
scene.sensor = { kind = "rendered", size_px = 400, calibration = { presses = 2, rest_frames = 1 } }
scene.noise = { pixel = { kind = "gaussian", std = 2.0 } }
scene.estimator = { kind = "image", indentation = "fitted" }
[scene.probe]
kind = "marker-sphere"
radius = 20.0
marker_depth = 2.0
discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0, misalignment = 0.25 }
"#;

fn scene(study: &Study) -> PressScene {
    let cell = study.cell(0).expect("a cell");
    match study.estimable_scene_of(0, &cell, &SharedModels::default()) {
        Ok(Scene::Press(scene)) => scene,
        other => panic!("a press: {other:?}"),
    }
}

fn frames(scene: &PressScene, study: &Study, trial: u64) -> [Frame; 2] {
    let trace = scene.trace(Some(trial), study.config.length_unit);
    let seen = trace.expect("a trace").camera.expect("a camera");
    let [rest, pressed] = seen.frames.expect("frames");
    [("rest.png", rest), ("pressed.png", pressed)].map(|(file, image)| Frame {
        file: file.to_owned(),
        image,
        compression: None,
    })
}

fn options(study: &Study) -> PictureOptions {
    PictureOptions::from_study(&study.config, study.config.length_unit).expect("options")
}

fn estimate(frames: &[Frame; 2], options: &PictureOptions) -> Result<Value, String> {
    let [rest, pressed] = frames;
    let tracked = track_frames(rest, pressed).map_err(|error| error.to_string())?;
    let reader = FrameReader::Pictures(Box::new(options.clone()));
    let read = reader.read([rest, pressed], &tracked, (3, 0.0), None);
    let estimate = read.and_then(|read| read.estimate);
    let estimate = estimate.map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(estimate).expect("a report"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// Frames of a press on a layer are fitted with two wrong bodies: a half-space and a thicker layer.
#[test]
fn a_fit_with_another_body_causes_a_warning() {
    let study = study();
    let frames = frames(&scene(&study), &study, 0);
    for body in ["poisson = 0.5", "thickness = 8.0"] {
        let text = TEXT.replace(
            r#"indentation = "fitted""#,
            &format!(r#"indentation = "known", indentation_std = 0.02, {body}"#),
        );
        let mut options = options(&parse("frames.toml", &text).expect("a study"));
        options.indentation = Some(1.0);
        let report = estimate(&frames, &options).expect("an estimate");
        let warnings = report["warnings"].as_array().expect("warnings");
        let p_value = |code: &str| {
            let mut coded = warnings.iter().filter(|one| one["code"] == code);
            number(&coded.next().expect(code)["numbers"]["p_value"])
        };
        assert!(p_value("other-body") < 0.05, "{report}");
        assert_eq!(number(&report["noise"]["p_value"]), p_value("poor-fit"));
        let warnings = report["warnings"].to_string();
        assert!(
            warnings.contains("pressed.png scatter")
                && warnings.contains("than in the fitted body"),
            "{warnings}"
        );
    }
}

/// The frame in which each pixel (x, y) is copied from the position `from(x, y)`. Positions outside of the frame are
/// white.
fn warp(frame: &Frame, from: impl Fn(f64, f64) -> [f64; 2]) -> Frame {
    let (width, height) = frame.image.dimensions();
    let image = RgbImage::from_fn(width, height, |x, y| {
        let [x, y] = from(f64::from(x), f64::from(y)).map(f64::round);
        let is_inside =
            (0.0..f64::from(width)).contains(&x) && (0.0..f64::from(height)).contains(&y);
        match is_inside {
            true => *frame.image.get_pixel(x as u32, y as u32),
            false => Rgb([255; 3]),
        }
    });
    Frame {
        image,
        ..frame.clone()
    }
}

/// If all markers move in the same way, the camera has moved. A press cannot cause such a motion.
#[test]
fn a_camera_that_moved_between_the_frames_causes_a_warning() {
    let study = study();
    let [rest, pressed] = frames(&scene(&study), &study, 0);
    let warnings = |pressed: &Frame| {
        let tracked = track_frames(&rest, pressed).expect("tracks");
        let texts = tracked.warnings().into_iter().map(|warning| warning.text);
        texts.collect::<Vec<_>>().join("; ")
    };
    assert_eq!(warnings(&pressed), "");
    let shifted = warnings(&warp(&pressed, |x, y| [x - 4.0, y]));
    assert!(shifted.contains("moved by about (4.0, "), "{shifted}");
    let (sine, cosine) = libm::sincos(0.04);
    let turned = warnings(&warp(&pressed, |x, y| {
        let (x, y) = (x - 199.5, y - 199.5);
        [199.5 + cosine * x + sine * y, 199.5 - sine * x + cosine * y]
    }));
    assert!(
        turned.contains("turned about the middle by about 2.3 degrees"),
        "{turned}"
    );
}

#[test]
fn errors_name_unusable_frames_and_cameras() {
    let study = study();
    let mut options = options(&study);
    let [rest, pressed] = frames(&scene(&study), &study, 0);
    let refused = |pressed: &Frame, options: &PictureOptions| {
        estimate(&[rest.clone(), pressed.clone()], options).expect_err("refused")
    };
    let said = refused(&rest, &options);
    assert!(
        said.contains("rest.png: no contact") && said.contains("all pixels are those of rest.png"),
        "{said}"
    );
    let mut bright = pressed.clone();
    for pixel in bright.image.pixels_mut() {
        *pixel = Rgb(pixel.0.map(|level| level.saturating_add(20)));
    }
    let said = refused(&bright, &options);
    assert!(said.contains("pressed.png: is saturated"), "{said}");
    let camera = CameraEstimate {
        length_unit: LengthUnit::Cm,
        ..calibrate_camera(&rest, &study.config).expect("a camera")
    };
    options.camera = Some(("camera.toml".to_owned(), camera));
    let said = refused(&pressed, &options);
    assert!(
        said.starts_with("camera.toml: `length_unit` is cm"),
        "{said}"
    );
}
