//! Rolls with lost readings. Drivers of sensors write zeros or a large number for a lost reading.

use palpate_recorded::{RecordedFile, RollOptions, RollRecording, estimate_roll};
use palpate_sensing::{Channel, Stream};
use serde_json::Value;

/// A log of `count` rolls by 0.5 rad. A probe with a radius of 10 mm rolls on a ball with a radius of 25 mm. Each entry
/// of `lost` is the index of a roll, and the shift that replaces the shift of this roll.
fn log(count: usize, std: f64, pitch: f64, lost: &[(usize, [f64; 2])]) -> String {
    let mut stream = Stream::new(25, 0, Channel::WristContact);
    let mut text = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n".to_owned();
    for roll in 0..count {
        let (sine, cosine) = libm::sincos(roll as f64 * 1.1);
        let shift = [cosine, sine].map(|part| {
            let shift = 0.5 / (1.0 / 10.0 + 1.0 / 25.0) * part + std * stream.standard_normal();
            if pitch > 0.0 {
                (shift / pitch).round() * pitch
            } else {
                shift
            }
        });
        let at = lost.iter().find(|(lost, _)| *lost == roll);
        let [u, v] = at.map_or(shift, |(_, value)| *value);
        text += &format!("{roll},{},{},{u},{v}\n", 0.5 * sine, -0.5 * cosine);
    }
    text
}

fn estimate(text: String) -> Result<Value, String> {
    let readings = RollRecording::try_from(RecordedFile::new("rolls.csv", text.into_bytes()));
    let readings = readings.map_err(|error| error.to_string())?;
    let estimate = estimate_roll(readings, &RollOptions::new(10.0));
    let estimate = estimate.map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(estimate).unwrap())
}

#[test]
fn lost_rolls_are_left_out_and_named() {
    let sound = estimate(log(24, 0.03, 0.0, &[])).unwrap();
    assert_eq!(sound["left_out"], Value::Array(vec![]));
    let far = [9999.0, 9999.0];
    for lost in [[0.0, 0.0], far] {
        // A roll that is too short to move the contact noticeably must not hide the lost readings.
        let short = "24,0,-0.001,0,0\n";
        let log = log(24, 0.03, 0.0, &[2, 9, 17].map(|roll| (roll, lost))) + short;
        let found = estimate(log).unwrap();
        let rows = found["left_out"].as_array().unwrap().iter();
        let rows: Vec<_> = rows.map(|one| one["row"].as_u64().unwrap()).collect();
        assert_eq!((rows, &found["probes"]), (vec![3, 10, 18], &25.into()));
        let curvature = &found["mean_curvature"];
        let ends = [0, 1].map(|end| curvature["interval95"][end].as_f64().unwrap());
        assert!(
            ends[0] < 0.04 && 0.04 < ends[1] && ends[1] < 0.05,
            "{curvature}"
        );
        let warning = &found["warnings"][0];
        assert_eq!(warning["code"], "left-out");
        assert!(
            warning["text"]
                .as_str()
                .unwrap()
                .contains("probe 2, row 3, is left out: lost")
        );
    }
    // If more than a fifth of the rolls have lost readings, there is no estimate.
    let many = [1, 3, 4].map(|roll| (roll, [0.0; 2]));
    let error = estimate(log(8, 0.03, 0.0, &many)).unwrap_err();
    assert!(
        error.contains("3 of 8 rolls have such lost readings"),
        "{error}"
    );
    let error = estimate(log(8, 0.03, 0.0, &many.map(|(roll, _)| (roll, far)))).unwrap_err();
    assert!(
        error.contains("half of the probe's circumference"),
        "{error}"
    );
}

#[test]
fn coarse_pads_may_report_zero() {
    // A roll moves the contact by 3.6 mm. With pads of 4 mm, a reading of 0 along one axis is therefore possible, and
    // is not a lost reading.
    for pitch in [2.0, 4.0] {
        let found = estimate(log(24, 0.0, pitch, &[])).unwrap();
        assert_eq!(found["left_out"], Value::Array(vec![]), "{pitch}");
    }
}

/// Six rolls as time series of 51 samples each. The contact moves by about 0.07 mm per sample. In the rows `lost`, both
/// coordinates of the contact are `value`.
fn series(lost: &[usize], value: &str) -> String {
    let mut stream = Stream::new(26, 0, Channel::WristContact);
    let mut text =
        "probe,time_s,rotation_x_rad,rotation_y_rad,contact_u_mm,contact_v_mm\n".to_owned();
    for row in 0..306 {
        let (roll, sample) = (row / 51, (row % 51) as f64);
        let (sine, cosine) = libm::sincos(roll as f64 + 0.2);
        let turn = 0.01 * sample;
        let at = [cosine, sine].map(|part| {
            0.3 + turn / (1.0 / 10.0 + 1.0 / 25.0) * part + 0.01 * stream.standard_normal()
        });
        let at = match lost.contains(&row) {
            true => format!("{value},{value}"),
            false => format!("{},{}", at[0], at[1]),
        };
        let time = 0.01 * sample;
        text += &format!("{roll},{time},{},{},{at}\n", turn * sine, -turn * cosine);
    }
    text
}

/// Some of the lost samples start or end a roll. Least squares uses only the first and the last sample of each roll.
#[test]
fn lost_samples_are_left_out_and_named() {
    assert_eq!(
        estimate(series(&[], "")).unwrap()["warnings"],
        Value::Array(vec![])
    );
    let lost = [0, 50, 70, 71, 152, 305];
    for value in ["0", "-1", "9999"] {
        let found = estimate(series(&lost, value)).unwrap();
        let curvature = found["mean_curvature"]["value"].as_f64().unwrap();
        assert!((curvature - 0.04).abs() < 0.001, "{found}");
        let warning = &found["warnings"][0];
        assert_eq!(warning["code"], "left-out");
        let text = warning["text"].as_str().unwrap();
        assert!(
            text.starts_with("6 of 306 samples") && text.contains("probe 1 after 0.19 s"),
            "{text}"
        );
    }
    let many: Vec<usize> = (0..306).step_by(4).collect();
    let error = estimate(series(&many, "0")).unwrap_err();
    assert!(
        error.contains("77 of 306 samples have such lost contacts"),
        "{error}"
    );
}

/// Rolls in opposite directions have equal rounding errors, which the residuals hardly show. The true curvature is 0.04.
#[test]
fn shifts_in_steps_widen_the_interval() {
    let rolls = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n0,0,-0.3,2,0\n1,0.3,0,0,2\n2,0,0.3,-2,0\n3,-0.3,0,0,-2\n";
    let of_equal = estimate(rolls.to_owned()).unwrap();
    assert_eq!(of_equal["mean_curvature"]["interval95"], Value::Null);
    let found = estimate(format!("{rolls}4,0,-0.44,3,0\n")).unwrap();
    let ends = [0, 1].map(|end| found["mean_curvature"]["interval95"][end].as_f64().unwrap());
    assert!(ends[0] < 0.04 && 0.055 < ends[1], "{found}");
    let warnings = found["warnings"].as_array().unwrap();
    let is_said = warnings.iter().any(|one| one["code"] == "stated-pitch");
    assert!(is_said, "{found}");
}
