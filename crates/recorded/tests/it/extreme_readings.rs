//! Recorded readings with extremely large or small numbers.

use palpate_recorded::{
    CalibrateOptions, CalibrationPoints, GlideOptions, GlideRecording, PressOptions,
    PressRecording, RecordedError, RecordedFile, RollOptions, RollRecording, calibrate,
    estimate_glide, estimate_press, estimate_roll,
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

/// Mean curvature estimated from four rolls of a probe with the radius `radius`. `shift` is the shift of the contact in
/// two of the rolls.
fn roll(shift: &str, radius: f64) -> Result<f64, RecordedError> {
    let other = if radius.is_normal() { -radius } else { -1.0 };
    let text = format!(
        "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n\
         0,0,-0.8,{shift},0\n1,0,-0.8,{shift},0\n2,-0.8,0,0,{other:e}\n3,-0.8,0,0,{other:e}\n"
    );
    let estimate = estimate_roll(
        RollRecording::try_from(file(&text))?,
        &RollOptions::new(radius),
    )?;
    Ok(mean_curvature(&estimate))
}

/// Mean curvature estimated from 36 contacts on a paraboloid. `height` replaces the height of one contact.
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
    let (estimate, _) = estimate_glide(
        &GlideRecording::try_from(file(&text))?,
        &GlideOptions::default(),
    )?;
    Ok(mean_curvature(&estimate))
}

fn mean_curvature(estimate: &impl serde::Serialize) -> f64 {
    let json = serde_json::to_value(estimate).unwrap();
    json["mean_curvature"]["value"].as_f64().unwrap()
}

/// Curvature of the object estimated from 25 markers. `displacement` is the displacement of one marker.
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
    let estimate = estimate_press(&PressRecording::try_from(file(&text))?, &options)?;
    let json = serde_json::to_value(estimate).unwrap();
    Ok(json["object_curvature"]["value"].as_f64().unwrap())
}

/// Slope of a calibration from three points. `displacement` is the displacement of the first point.
fn calibrated(displacement: &str) -> Result<f64, RecordedError> {
    let rows = "0,0\n1,0.1,0\n2,0.2,0\n";
    let text = format!("normal_displacement_mm,hue_turns,growth\n{displacement},{rows}");
    let points = CalibrationPoints::try_from(&file(&text))?;
    let report = calibrate(&[points], &CalibrateOptions::default())?;
    Ok(report.calibration.normal_part.as_ref().unwrap().line.slope)
}

#[test]
fn huge_numbers_are_errors_and_tiny_numbers_count_as_0() {
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
        // A sensor with an infinite radius is a flat pad.
        if bad != f64::INFINITY {
            assert_eq!(kind(press("0.5", bad)), "readings", "{bad}");
        }
        assert!(RollOptions::noise_of_pads(1.0, bad).is_err());
    }
}
