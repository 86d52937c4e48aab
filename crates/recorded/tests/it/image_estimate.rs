//! Estimates of presses by a fit to recorded camera frames.

use image::{Rgb, RgbImage};
use palpate_recorded::{
    CameraEstimate, Frame, FrameReader, PictureOptions, RecordedFile, calibrate_camera,
    parse_camera, track_frames,
};
use palpate_scene::{PressScene, Scene, Scenes, SharedModels, Trials};
use palpate_study::config::{Study, parse};
use palpate_tracking::{Finder, Marker};
use serde_json::Value;

/// Curvature of the ball that is pressed, 1/mm.
const CURVATURE: f64 = 1.0 / 30.0;

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
        jpeg_quality: None,
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

/// If all markers move in the same way, the camera has moved; a press cannot cause this.
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

fn recolour(frame: &Frame, paint: impl Fn([u8; 3]) -> [u8; 3]) -> Frame {
    let mut image = frame.image.clone();
    for pixel in image.pixels_mut() {
        *pixel = Rgb(paint(pixel.0));
    }
    Frame {
        image,
        ..frame.clone()
    }
}

/// A copy of the frame in which `count` markers are replaced by the background.
fn without_markers(frame: &Frame, count: usize) -> Frame {
    let mut image: RgbImage = frame.image.clone();
    let found = Finder::default().find(&image).expect("markers").markers;
    for Marker { centroid_px, .. } in found.iter().skip(1).take(count) {
        let [middle_x, middle_y] = *centroid_px;
        for (x, y, pixel) in image.enumerate_pixels_mut() {
            if libm::hypot(f64::from(x) - middle_x, f64::from(y) - middle_y) < 15.0 {
                *pixel = Rgb([245, 245, 245]);
            }
        }
    }
    Frame {
        image,
        ..frame.clone()
    }
}

#[test]
fn errors_name_unusable_frames() {
    let study = study();
    let options = options(&study);
    let [rest, pressed] = frames(&scene(&study), &study, 0);
    let refused = |rest: &Frame, pressed: &Frame, words: &[&str]| {
        let said = estimate(&[rest.clone(), pressed.clone()], &options).expect_err("refused");
        for word in words {
            assert!(said.contains(word), "{word}: {said}");
        }
    };
    refused(
        &rest,
        &rest,
        &["rest.png: no contact", "all pixels are those of rest.png"],
    );
    let bright = |frame: &Frame| recolour(frame, |levels| levels.map(|one| one.saturating_add(20)));
    refused(&rest, &bright(&pressed), &["pressed.png: is saturated"]);
    let dark = |frame: &Frame| recolour(frame, |levels| levels.map(|one| one / 8));
    refused(&rest, &dark(&pressed), &["pressed.png: is under-exposed"]);
    refused(
        &without_markers(&rest, 40),
        &pressed,
        &["rest.png: shows ", " of the 77 markers"],
    );
    // If a few markers are missing, there is an estimate with a warning.
    let report = estimate(&[without_markers(&rest, 5), pressed], &options).expect("an estimate");
    let warning = report["warnings"][0]["text"].as_str().expect("a warning");
    assert!(
        warning.contains("5 of the layout's 77 markers are missing at rest"),
        "{report}"
    );
    let interval = &report["object_curvature"]["interval95"];
    assert!(
        number(&interval[0]) < CURVATURE && CURVATURE < number(&interval[1]),
        "{report}"
    );
}

#[test]
fn a_camera_in_another_unit_is_refused() {
    let study = study();
    let frames = frames(&scene(&study), &study, 0);
    let camera = calibrate_camera(&frames[0], &study.config).expect("a camera");
    let mut options = options(&study);
    options.camera = Some((
        "camera.toml".to_owned(),
        CameraEstimate {
            length_unit: palpate_study::config::LengthUnit::Cm,
            ..camera
        },
    ));
    let said = estimate(&frames, &options).expect_err("refused");
    assert!(
        said.starts_with("camera.toml: `length_unit` is cm"),
        "{said}"
    );
}

/// For any values of the camera parameters, the estimate contains finite numbers or is an error.
#[test]
fn cameras_with_extreme_numbers_return_finite_numbers_or_an_error() {
    let study = study();
    let frames = frames(&scene(&study), &study, 0);
    let good = calibrate_camera(&frames[0], &study.config).expect("a camera");
    let mut count = 0;
    for number in [f64::NAN, 1e40] {
        let with = |change: fn(&mut CameraEstimate, f64)| {
            let mut camera = good.clone();
            change(&mut camera, number);
            camera
        };
        let cameras = [
            with(|camera, number| camera.place[1] = number),
            with(|camera, number| camera.turn_deg[2] = number),
            with(|camera, number| camera.px_per_rad = number),
            with(|camera, number| camera.centre_px[0] = number),
            with(|camera, number| camera.px_per_rad_std = number),
            with(|camera, number| {
                camera.place_std[0] = number.sqrt();
                camera.covariance[3] = vec![0.0; 9];
                for row in &mut camera.covariance {
                    row[3] = 0.0;
                }
                camera.covariance[3][3] = number;
            }),
        ];
        for camera in cameras {
            let file = RecordedFile::new("camera.toml", camera.to_toml().into_bytes());
            let Ok(camera) = parse_camera(&file) else {
                count += 1;
                continue;
            };
            let mut options = options(&study);
            options.camera = Some(("camera.toml".to_owned(), camera));
            // JSON contains only finite numbers. So if there is an estimate, its numbers are finite.
            match estimate(&frames, &options) {
                Ok(report) => assert!(report["object_curvature"]["value"].is_number(), "{report}"),
                Err(said) => assert!(
                    said.contains("camera.toml") || said.contains("rest.png"),
                    "{said}"
                ),
            }
        }
    }
    assert!(count > 8, "{count}");
}
