//! Tests that a written calibration is read, and that unknown keys are refused.

use palpate_recorded::{RecordedError, RecordedFile, calibration_toml, parse_calibration};
use palpate_study::config::LengthUnit;
use palpate_tracking::{
    Calibration, LateralCalibration, LateralPoint, NormalCalibration, NormalFrom, NormalPoint,
};

fn parsed(text: &str) -> Result<(Calibration, LengthUnit), RecordedError> {
    parse_calibration(&RecordedFile::new("calibration.toml", text.into()))
}

fn full() -> Calibration {
    let steps = || (0..8).map(|step| 0.1 * f64::from(step));
    let normal = |marker: usize| {
        steps().map(move |normal| NormalPoint {
            marker: Some(marker),
            normal,
            hue_turns: (0.02 + 0.001 * marker as f64) * normal + 1e-3 * libm::sin(30.0 * normal),
            growth: 0.05 * normal,
        })
    };
    let normal: Vec<_> = normal(1).chain(normal(7)).collect();
    let lateral: Vec<_> = steps()
        .map(|along| LateralPoint {
            tangential: [along, 0.3],
            shift_px: [7.1 * along, 2.2],
            normal: Some(along * along),
        })
        .collect();
    let normal = NormalCalibration::fit(&normal, NormalFrom::Both).expect("a slope");
    let lateral = LateralCalibration::fit(&lateral).expect("a slope");
    Calibration::new(Some(normal.per_marker()), Some(lateral), Some(77)).expect("parts")
}

#[test]
fn a_written_calibration_is_read_and_other_keys_are_refused() {
    let calibration = full();
    let gains = calibration
        .normal_part
        .as_ref()
        .map(|part| part.gains.len());
    assert_eq!(gains, Some(2));
    let text = calibration_toml(&calibration, LengthUnit::Cm);
    assert_eq!(parsed(&text).unwrap(), (calibration, LengthUnit::Cm));

    let lines: Vec<&str> = text.lines().collect();
    let is_key = |line: &str| line.contains(" = ") && !line.starts_with('#');
    for (index, line) in lines.iter().enumerate().filter(|(_, line)| is_key(line)) {
        let (key, _) = line.split_once(" = ").unwrap();
        let renamed = line.replacen(key, "another", 1);
        let mut lines = lines.clone();
        lines[index] = &renamed;
        let error = parsed(&lines.join("\n")).unwrap_err().to_string();
        assert!(error.contains("another"), "{error}");
    }
    let error = parsed("length_unit = \"mm\"").unwrap_err().to_string();
    assert!(error.contains("0 parts"), "{error}");
}
