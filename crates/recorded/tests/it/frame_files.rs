//! Estimates from frames in several file formats and pixel encodings, as different cameras write them.

use std::io::Cursor;
use std::sync::LazyLock;

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageFormat, RgbImage};
use palpate_recorded::{
    CalibrateOptions, CameraEstimate, Frame, FrameReader, KnownDisplacements, NormalFrom,
    PictureOptions, PressOptions, RecordedFile, calibrate, calibrate_camera,
    frame_calibration_points, track_frames,
};
use palpate_study::config::{LengthUnit, parse};

const REST: &[u8] = include_bytes!("../data/rest.jpg");
const PRESSED: &[u8] = include_bytes!("../data/pressed.jpg");

/// Config of a study with the sensor that took the frames `rest.jpg` and `pressed.jpg`.
const SENSOR: &str = r#"
name = "field"
length_unit = "mm"
scene.kind = "press"
scene.object = { kind = "sphere", radius = 30.0 }
scene.motion = { indentation = 1.0 }
scene.model = { kind = "bonded-layer", thickness = 5.0 }
scene.sensor = { kind = "rendered", size_px = 640 }
scene.noise = { pixel = { kind = "gaussian", std = 2.0 } }
scene.estimator = { kind = "image", indentation = "fitted" }
[scene.probe]
kind = "marker-sphere"
radius = 20.0
marker_depth = 2.0
layout = "published"
discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 }
"#;

/// File of the camera, which is calibrated once for all tests.
static CAMERA: LazyLock<String> = LazyLock::new(|| {
    let study = parse("field.toml", SENSOR).unwrap();
    let camera = calibrate_camera(&frame(REST).unwrap(), &study.config).unwrap();
    let mut warnings = camera.warnings.iter();
    assert!(warnings.any(|one| one.code == "subsampled-colours"));
    camera.to_toml()
});

fn frame(bytes: &[u8]) -> Result<Frame, String> {
    let frame = Frame::try_from(&RecordedFile::new("frame", bytes.to_vec()));
    frame.map_err(|error| error.to_string())
}

/// The estimate from a frame at rest and a pressed frame. The camera is calibrated from the frame `rest.jpg`.
fn estimate(frames: [Frame; 2]) -> serde_json::Value {
    read(frames).unwrap()
}

fn read(frames: [Frame; 2]) -> Result<serde_json::Value, String> {
    read_by(CAMERA.clone(), frames)
}

fn read_by(camera: String, [rest, pressed]: [Frame; 2]) -> Result<serde_json::Value, String> {
    let study = parse("field.toml", SENSOR).unwrap();
    let camera = CameraEstimate::try_from(&RecordedFile::new("camera.toml", camera.into_bytes()));
    let mut options = PictureOptions::from_study(&study.config, study.config.length_unit).unwrap();
    options.camera = Some(("camera.toml".to_owned(), camera.unwrap()));
    options.indentation = Some(1.0);
    let tracked = track_frames(&rest, &pressed).unwrap();
    let reader = FrameReader::Pictures(Box::new(options));
    let read = reader.read([&rest, &pressed], &tracked, (3, 0.0), None);
    let press = read.and_then(|read| read.estimate);
    let press = press.map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(press).unwrap())
}

/// Checks that the interval of an estimate contains the curvature of the ball, and returns the codes of the warnings.
fn codes_if_right(estimate: &serde_json::Value) -> Vec<&str> {
    let curvature = &estimate["object_curvature"];
    let [low, high] = [0, 1].map(|end| curvature["interval95"][end].as_f64().unwrap());
    assert!((low..=high).contains(&(1.0 / 30.0)), "{curvature}");
    assert!(high - low < 0.01, "{curvature}");
    let warnings = estimate["warnings"].as_array().unwrap().iter();
    warnings.map(|one| one["code"].as_str().unwrap()).collect()
}

#[test]
fn frames_of_the_format_4_to_3_contain_the_image_in_their_central_square() {
    let frames = [REST, PRESSED].map(|bytes| frame(bytes).unwrap());
    let wide = frames.clone().map(|frame| {
        let mut image = RgbImage::from_pixel(854, 640, image::Rgb([255; 3]));
        image::imageops::replace(&mut image, &frame.image, 107, 0);
        Frame { image, ..frame }
    });
    assert_eq!(wide.map(Frame::central_square), frames);
}

#[test]
fn jpeg_frames_of_low_quality_are_refused_by_name() {
    let compressed = |bytes, quality| {
        let mut jpeg = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut jpeg, quality);
        frame(bytes)
            .unwrap()
            .image
            .write_with_encoder(encoder)
            .unwrap();
        frame(&jpeg).unwrap()
    };
    for quality in [60, 90] {
        let pressed = compressed(PRESSED, quality);
        let error = read([frame(REST).unwrap(), pressed]).unwrap_err();
        let words = format!("frame: is compressed as JPEG with quality {quality}, which moves");
        assert!(error.starts_with(&words), "{error}");
    }
    let rest = frame(REST).unwrap();
    let compression = |frame: &Frame| {
        frame
            .compression
            .map(|one| (one.quality, one.subsamples_colours))
    };
    assert_eq!(compression(&rest), Some((Some(92.0), true)));
    assert_eq!(
        compression(&compressed(REST, 97)),
        Some((Some(97.0), false))
    );
    let place = CAMERA
        .lines()
        .find(|line| line.starts_with("place = "))
        .unwrap();
    let camera = CAMERA.replace(place, "place = [3.0, 0.0, 0.0]");
    let error = read_by(camera, [REST, PRESSED].map(|bytes| frame(bytes).unwrap())).unwrap_err();
    assert!(
        error.contains(
            "JPEG with subsampled colours: use a lossless format, such as PNG, or JPEG 4:4:4, or calibrate"
        ),
        "{error}"
    );
    let webp = b"RIFF6\0\0\0WEBPVP8 *\0\0\0\x90\x01\0\x9d\x01*\x10\0\x10\0\x02\xc0L%\xa0\x02t\xba\0\x03\x98\0\xfe\xd0\xca\xfe-\xa4t*u\x7f\xf1\xbcu\xb7\xd6\xde\xca\0\0\0";
    let webp = Frame {
        image: rest.image.clone(),
        ..frame(webp).unwrap()
    };
    assert!(
        read([webp, rest.clone()])
            .unwrap_err()
            .contains("is compressed as lossy WebP, which")
    );
    let tiff = frame(include_bytes!("../data/jpeg-in.tif")).unwrap();
    assert_eq!(tiff.compression.unwrap().format, "JPEG in TIFF");
    codes_if_right(&estimate(
        [REST, PRESSED].map(|bytes| compressed(bytes, 97)),
    ));
}

#[test]
fn frames_that_are_encoded_by_srgb_are_found_at_rest() {
    let encoded = |bytes| {
        let mut frame = frame(bytes).unwrap();
        for pixel in frame.image.pixels_mut() {
            pixel.0 = pixel.0.map(|level| {
                let light = f64::from(level) / 255.0;
                let encoded = match light <= 0.003_130_8 {
                    true => 12.92 * light,
                    false => 1.055 * libm::pow(light, 2.4_f64.recip()) - 0.055,
                };
                libm::round(255.0 * encoded) as u8
            });
        }
        frame
    };
    let found = estimate([REST, PRESSED].map(encoded));
    assert!(codes_if_right(&found).contains(&"srgb-frames"));
    // If the user states that the frames are encoded by sRGB, there is no warning `srgb-frames`.
    let stated = estimate([REST, PRESSED].map(|bytes| encoded(bytes).linearised()));
    assert!(!codes_if_right(&stated).contains(&"srgb-frames"));
    assert_eq!(found["object_curvature"], stated["object_curvature"]);
    // A calibration that was made from frames contains the hue of the markers at rest.
    let [rest, pressed] = [REST, PRESSED].map(|bytes| frame(bytes).unwrap());
    let known = KnownDisplacements {
        normal: Some(vec![0.0, 1.0]),
        tangential: None,
        from: NormalFrom::Hue,
        px_per_rad: None,
    };
    let (points, _) =
        frame_calibration_points(&rest, &[rest.clone(), pressed.clone()], &known).unwrap();
    let report = calibrate(&[points], &CalibrateOptions::default()).unwrap();
    let reader = FrameReader::Displacements {
        calibration: Box::new(report.calibration),
        unit: LengthUnit::Mm,
        px_per_rad: Some(200.0),
        options: Box::new(PressOptions::new(20.0)),
    };
    let readings = |[rest, pressed]: [Frame; 2]| {
        let tracked = track_frames(&rest, &pressed).unwrap();
        let read = reader.read([&rest, &pressed], &tracked, (3, 0.0), None);
        read.map(|read| read.readings.to_csv())
            .map_err(|error| error.to_string())
    };
    let encoded = [REST, PRESSED].map(encoded);
    let linear = encoded.clone().map(Frame::linearised);
    assert_eq!(readings(encoded), readings(linear.clone()));
    let error = readings(linear.map(Frame::linearised)).unwrap_err();
    assert!(
        error.contains("encoded by sRGB (setting `srgb`)"),
        "{error}"
    );
}

#[test]
fn a_third_of_the_markers_may_be_dead() {
    // 77 markers are visible. Paint every third one with the colour of the skin beside it.
    let [rest, pressed] = [REST, PRESSED].map(|bytes| frame(bytes).unwrap());
    let tracked = track_frames(&rest, &pressed).unwrap();
    let dead: Vec<[f64; 2]> = (tracked.tracks.iter().skip(1).step_by(3))
        .filter_map(|track| Some(track.rest?.centroid_px))
        .collect();
    let painted = [rest, pressed].map(|mut frame| {
        for [x, y] in &dead {
            let ground = *frame.image.get_pixel((*x + 20.0) as u32, *y as u32);
            for (column, row, pixel) in frame.image.enumerate_pixels_mut() {
                let apart = libm::hypot(f64::from(column) - x, f64::from(row) - y);
                if apart < 17.0 {
                    *pixel = ground;
                }
            }
        }
        frame
    });
    let found = estimate(painted);
    assert!(found["markers"].as_u64().unwrap() < 55);
    assert!(codes_if_right(&found).contains(&"missing-markers"));
}

#[test]
fn frames_of_all_formats_have_the_same_pixels() {
    let rest = frame(REST).unwrap();
    let encoded = |image: DynamicImage, format| {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    };
    let whole = DynamicImage::from(rest.image.clone());
    for format in [
        ImageFormat::Png,
        ImageFormat::Bmp,
        ImageFormat::Tiff,
        ImageFormat::WebP,
    ] {
        let bytes = encoded(whole.clone(), format);
        assert_eq!(frame(&bytes).unwrap().image, rest.image, "{format:?}");
        let error = frame(&bytes[..bytes.len() / 2]).unwrap_err();
        assert!(
            error.contains("is a broken or truncated"),
            "{format:?}: {error}"
        );
    }
    let mut alpha = whole.to_rgba8();
    for image in [whole.to_rgb16().into(), alpha.clone().into()] {
        let read = frame(&encoded(image, ImageFormat::Png)).unwrap();
        assert_eq!(read.image, rest.image);
    }
    alpha.get_pixel_mut(7, 7).0[3] = 254;
    let error = frame(&encoded(alpha.into(), ImageFormat::Png)).unwrap_err();
    assert!(error.contains("has transparent pixels"), "{error}");
    let grey = DynamicImage::from(whole.to_luma16());
    let read = frame(&encoded(grey.clone(), ImageFormat::Tiff)).unwrap();
    assert_eq!(read.image, grey.to_rgb8());
    let error = frame(&REST[..REST.len() / 2]).unwrap_err();
    assert_eq!(
        error,
        "frame: is a truncated JPEG image: the marker of its end is missing"
    );
    assert!(
        frame(b"GIF89a")
            .unwrap_err()
            .contains("is not a PNG, JPEG, BMP, TIFF or WebP image")
    );
    let indexed = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x02\0\0\0\x01\x01\x03\0\0\0\xce\xec\xed\xc9\0\0\0\x06PLTE\xff\0\0\0\xff\0\xd2\x87\xefq\0\0\0\nIDATx\x9ccp\0\0\0B\0A)7\xf4\xef\0\0\0\0IEND\xaeB`\x82";
    assert!(
        frame(indexed)
            .unwrap_err()
            .contains("has a palette of at most 256 colours")
    );
    // `linearised` must convert levels from sRGB to linear light.
    let mut image = RgbImage::new(3, 1);
    for (pixel, level) in image.pixels_mut().zip([0, 188, 255]) {
        pixel.0 = [level; 3];
    }
    let linear = Frame { image, ..rest }.linearised();
    let levels: Vec<u8> = linear.image.pixels().map(|pixel| pixel.0[1]).collect();
    assert_eq!(levels, [0, 128, 255]);
}
