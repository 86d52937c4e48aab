//! Recorded readings with extreme numbers, and files without readings.

use image::{ImageFormat, Rgb, RgbImage};
use palpate_recorded::{
    CalibrateOptions, GlideOptions, PressOptions, RecordedError, RecordedFile, RollOptions,
    calibrate, estimate_glide, estimate_press, estimate_roll, parse_calibration,
    parse_calibration_points, parse_frame, parse_glide, parse_press, parse_roll,
};

fn file(text: &str) -> RecordedFile {
    RecordedFile::new("readings.csv", text.as_bytes().to_vec())
}

fn kind<T>(result: Result<T, RecordedError>) -> &'static str {
    match result.err() {
        None => "none",
        Some(RecordedError::File { .. }) => "file",
        Some(RecordedError::Line { .. }) => "line",
        Some(RecordedError::Array { .. }) => "array",
        Some(RecordedError::Readings { .. }) => "readings",
    }
}

/// Mean curvature from four rolls of a probe. Two of the rolls have this shift of the contact.
fn roll(shift: &str, radius: f64) -> Result<f64, RecordedError> {
    let other = if radius.is_normal() { -radius } else { -1.0 };
    let text = format!(
        "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n\
         0,0,-0.8,{shift},0\n1,0,-0.8,{shift},0\n2,-0.8,0,0,{other:e}\n3,-0.8,0,0,{other:e}\n"
    );
    let estimate = estimate_roll(parse_roll(file(&text))?, &RollOptions::new(radius))?;
    Ok(mean_curvature(&estimate))
}

/// Mean curvature from 36 contacts on a paraboloid. `height` replaces the height of one contact.
fn glide(height: Option<&str>, scale: f64) -> Result<f64, RecordedError> {
    let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
    for index in 0..36_u32 {
        let [x, y] = [index % 6, index / 6].map(|step| f64::from(step) / 5.0);
        let z = match height {
            Some(height) if index == 14 => height.to_owned(),
            _ => format!("{:e}", -0.1 * scale * (x * x + y * y)),
        };
        text += &format!("{},{:e},{:e},{z}\n", index / 6, x * scale, y * scale);
    }
    let (estimate, _) = estimate_glide(&parse_glide(file(&text))?, &GlideOptions::default())?;
    Ok(mean_curvature(&estimate))
}

fn mean_curvature(estimate: &impl serde::Serialize) -> f64 {
    let json = serde_json::to_value(estimate).unwrap();
    json["mean_curvature"]["value"].as_f64().unwrap()
}

/// Estimated curvature of the object from 25 markers. One of the markers has this displacement.
fn press(displacement: &str, radius: f64) -> Result<f64, RecordedError> {
    let mut text = "x_mm,y_mm,normal_displacement_mm\n".to_owned();
    for index in 0..25_i32 {
        let [x, y] = [index % 5, index / 5].map(|step| 2.0 * f64::from(step - 2));
        let moved = match index {
            3 => displacement.to_owned(),
            _ => format!("{:e}", libm::exp(-(x * x + y * y) / 30.0)),
        };
        text += &format!("{x},{y},{moved}\n");
    }
    let options = PressOptions {
        marker_depth: Some(2.0),
        indentation: Some(1.2),
        ..PressOptions::new(radius)
    };
    let estimate = estimate_press(&parse_press(file(&text))?, &options)?;
    let json = serde_json::to_value(estimate).unwrap();
    Ok(json["object_curvature"]["value"].as_f64().unwrap())
}

/// Slope of a calibration from three points; the first has this displacement.
fn calibrated(displacement: &str) -> Result<f64, RecordedError> {
    let rows = "0,0\n1,0.1,0\n2,0.2,0\n";
    let text = format!("normal_displacement_mm,hue_turns,growth\n{displacement},{rows}");
    let points = parse_calibration_points(&file(&text))?;
    let report = calibrate(&[points], &CalibrateOptions::default())?;
    Ok(report.calibration.normal_part().unwrap().line.slope)
}

#[test]
fn errors_name_the_line_of_numbers_out_of_range_and_tiny_numbers_count_as_0() {
    for text in ["NaN", "inf", "1e400", ""] {
        assert_eq!(kind(roll(text, 1.0)), "line", "{text}");
        assert_eq!(kind(glide(Some(text), 1.0)), "line", "{text}");
        assert_eq!(kind(press(text, 20.0)), "line", "{text}");
        assert_eq!(kind(calibrated(text)), "line", "{text}");
    }
    assert_eq!(kind(roll("1e308", 1.0)), "readings");
    assert_eq!(kind(glide(Some("1e308"), 1.0)), "line");
    assert_eq!(kind(press("1e308", 20.0)), "line");
    assert_eq!(kind(calibrated("1e308")), "line");
    for text in ["5e-324", "-0", "1e-320"] {
        assert_eq!(kind(roll(text, 1.0)), "readings", "{text}");
        let near = |one: f64, other: f64| assert!((one / other - 1.0).abs() < 1e-9, "{text}");
        near(
            glide(Some(text), 1.0).unwrap(),
            glide(Some("0"), 1.0).unwrap(),
        );
        near(press(text, 20.0).unwrap(), press("0", 20.0).unwrap());
        near(calibrated(text).unwrap(), 0.1);
    }
}

#[test]
fn readings_of_any_size_have_a_curvature() {
    let [of_roll, of_glide] = [roll("0.6", 1.0), glide(None, 1.0)].map(Result::unwrap);
    for scale in [1e-100, 1e-9, 1e9, 1e100] {
        let found = roll(&format!("{:e}", 0.6 * scale), scale).unwrap();
        assert!((found * scale / of_roll - 1.0).abs() < 1e-6, "{scale:e}");
        let found = glide(None, scale).unwrap();
        assert!((found * scale / of_glide - 1.0).abs() < 1e-6, "{scale:e}");
    }
    for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY, 5e-324, 1e308] {
        assert_eq!(kind(roll("0.6", bad)), "readings", "{bad}");
        assert_eq!(kind(press("0.5", bad)), "readings", "{bad}");
        assert!(RollOptions::noise_of_pads(1.0, bad).is_err());
    }
    for bad in [f64::NAN, -1.0, 1.1] {
        assert!(RollOptions::noise_of_shifts(1.0, bad).is_err());
    }
}

#[test]
fn files_without_readings_are_refused() {
    for (text, kinds) in [
        ("", ["file"; 3]),
        ("\u{feff}", ["file"; 3]),
        ("probe", ["line"; 3]),
        (",,,,", ["line"; 3]),
        ("x_mm,y_mm\n1,2", ["line"; 3]),
        ("\"", ["line"; 3]),
        ("finger,x_mm,y_mm,z_mm\n", ["line", "readings", "line"]),
    ] {
        let found = [
            kind(parse_roll(file(text))),
            kind(parse_glide(file(text))),
            kind(parse_press(file(text))),
        ];
        assert_eq!(found, kinds, "{text:?}");
    }
}

#[test]
fn calibrations_accept_any_finite_slope_except_0() {
    let calibration = |slope: &str, weight: &str| {
        let text = format!(
            "length_unit = \"mm\"\n[normal]\nfrom = \"hue\"\nhue_weight = {weight}\nnearness_weight = 0.0\n\
             range = [0.0, 1.0]\nper_marker = false\n\
             [normal.line]\nslope = {slope}\nr_squared = 1.0\nresidual_rms = 0.0\npoints = 9\n"
        );
        let file = RecordedFile::new("calibration.toml", text.into());
        parse_calibration(&file).map(|(found, _)| found.normal_part().unwrap().line.slope)
    };
    for slope in [1e-50, -1e-9, 1e50] {
        assert_eq!(calibration(&format!("{slope:e}"), "1.0").unwrap(), slope);
    }
    for (slope, weight) in [
        ("nan", "1.0"),
        ("0.0", "1.0"),
        ("1e999", "1.0"),
        ("0.5", "inf"),
    ] {
        assert_eq!(kind(calibration(slope, weight)), "file", "{slope} {weight}");
    }
    for text in ["", "\0", "length_unit = \"mm\"", "markers = -1", "[normal]"] {
        let file = RecordedFile::new("calibration.toml", text.into());
        assert_eq!(kind(parse_calibration(&file)), "file", "{text:?}");
    }
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = RgbImage::from_fn(width, height, |x, y| Rgb([x as u8, y as u8, 7]));
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

#[test]
fn images_are_read_or_refused() {
    let read = |bytes: Vec<u8>| parse_frame(&RecordedFile::new("frame.png", bytes));
    for (width, height) in [(1, 4096), (8192, 2)] {
        let image = read(png(width, height)).unwrap().image;
        assert_eq!(image.dimensions(), (width, height));
        assert_eq!(image.get_pixel(width - 1, 0).0, [(width - 1) as u8, 0, 7]);
    }
    assert_eq!(kind(read(png(8193, 1))), "file");
    assert_eq!(kind(read(b"GIF89a".to_vec())), "file");
    for kept in [0, 8, 33] {
        assert_eq!(kind(read(png(64, 64)[..kept].to_vec())), "file", "{kept}");
    }
    // The width in bytes 16 to 19 does not match the checksum.
    let mut bytes = png(64, 64);
    bytes[16..20].copy_from_slice(&u32::MAX.to_be_bytes());
    assert_eq!(kind(read(bytes)), "file");
}
