//! Recorded readings: files of extreme numbers.

use palpate_scene::recorded::{
    CalibrateOptions, GlideOptions, PressOptions, RecordedError, RecordedFile, RollOptions,
    calibrate, estimate_glide, estimate_press, estimate_roll, parse_calibration_points,
    parse_glide, parse_press, parse_roll,
};
use serde_json::Value;

use crate::extremes::{Answer, Case};

/// Numbers as files have them.
const NUMBERS: [&str; 12] = [
    "NaN",
    "inf",
    "-inf",
    "1e400",
    "-1e308",
    "1e308",
    "5e-324",
    "-0",
    "0",
    "",
    "1e-320",
    "1e999999999",
];

fn file(text: String) -> RecordedFile {
    RecordedFile::new("readings.csv", text.into_bytes())
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for number in NUMBERS {
        cases.push(Case::new(
            "scene::recorded::estimate_roll",
            format!("a shift of \"{number}\""),
            move || estimated_roll(number, 1.0).into(),
        ));
        cases.push(Case::new(
            "scene::recorded::estimate_glide",
            format!("a height of \"{number}\": next to 0 as 0"),
            move || beside_0(number, |number| estimated_glide(number, 1.0)).into(),
        ));
        cases.push(Case::new(
            "scene::recorded::estimate_press",
            format!("a displacement of \"{number}\": next to 0 as 0"),
            move || beside_0(number, |number| estimated_press(number, 20.0)).into(),
        ));
        cases.push(Case::new(
            "scene::recorded::calibrate",
            format!("a displacement of \"{number}\" where the hue is at rest: turns per length"),
            move || calibrated(number).into(),
        ));
    }
    for scale in [1e-100, 1e-9, 1e9, 1e100] {
        cases.push(Case::new(
            "scene::recorded::estimate_roll",
            format!("lengths of {scale:e}: as of 1, scaled"),
            move || scaled(scale, |scale| estimated_roll("1", scale)).into(),
        ));
        cases.push(Case::new(
            "scene::recorded::estimate_glide",
            format!("lengths of {scale:e}: as of 1, scaled"),
            move || scaled(scale, |scale| estimated_glide("-0.032", scale)).into(),
        ));
    }
    for radius in [f64::NAN, 0.0, -1.0, f64::INFINITY, 5e-324, 1e308] {
        cases.push(Case::refusal(
            "scene::recorded::estimate_press",
            format!("a sensor of radius {radius:e}"),
            move || estimated_press("0.5", radius),
        ));
        cases.push(Case::new(
            "scene::recorded::estimate_roll",
            format!("a probe of radius {radius:e}"),
            move || estimated_roll_of("1", radius, None).into(),
        ));
        cases.push(Case::new(
            "scene::recorded::estimate_roll",
            format!("pads of pitch {radius:e}"),
            move || estimated_roll_of("1", 1.0, Some(radius)).into(),
        ));
    }
    for text in [
        "",
        "\n",
        "probe",
        "\u{feff}",
        ",,,,",
        "x_mm,y_mm\n1,2",
        "\"",
        "finger,x_mm,y_mm,z_mm\n",
    ] {
        cases.push(Case::refusal(
            "scene::recorded::parse_roll",
            format!("{text:?}"),
            move || parse_roll(file(text.to_owned())),
        ));
        cases.push(Case::refusal(
            "scene::recorded::parse_glide",
            format!("{text:?}"),
            move || parse_glide(file(text.to_owned())),
        ));
        cases.push(Case::refusal(
            "scene::recorded::parse_press",
            format!("{text:?}"),
            move || parse_press(file(text.to_owned())),
        ));
    }
    cases
}

fn estimated_roll(number: &str, scale: f64) -> Result<Answer, RecordedError> {
    let scaled = number
        .parse::<f64>()
        .map(|number| format!("{:e}", number * scale));
    let is_plain = scale == 1.0;
    let number = scaled
        .ok()
        .filter(|_| !is_plain)
        .unwrap_or_else(|| number.to_owned());
    estimated_roll_of(&number, scale, None)
}

fn estimated_roll_of(
    number: &str,
    probe_radius: f64,
    pitch: Option<f64>,
) -> Result<Answer, RecordedError> {
    let other = if probe_radius.is_normal() {
        -probe_radius
    } else {
        -1.0
    };
    let text = format!(
        "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n\
         0,0,-0.4,{number},0\n1,0,-0.4,{number},0\n2,-0.4,0,0,{other:e}\n3,-0.4,0,0,{other:e}\n"
    );
    let options = RollOptions {
        noise: pitch
            .and_then(|pitch| RollOptions::noise_of_pads(probe_radius, pitch).ok())
            .unwrap_or_default(),
        ..RollOptions::new(probe_radius)
    };
    let estimate = estimate_roll(&parse_roll(file(text))?, &options)?;
    Ok(finite(&estimate))
}

fn estimated_glide(number: &str, scale: f64) -> Result<Answer, RecordedError> {
    let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
    for index in 0..36_u32 {
        let [x, y] = [index % 6, index / 6].map(|step| f64::from(step) / 5.0);
        let z = if index == 14 && scale == 1.0 {
            number.to_owned()
        } else {
            format!("{:e}", -0.1 * scale * (x * x + y * y))
        };
        text += &format!("{},{:e},{:e},{z}\n", index / 6, x * scale, y * scale);
    }
    let (estimate, _) = estimate_glide(&parse_glide(file(text))?, &GlideOptions::default())?;
    Ok(finite(&estimate))
}

fn estimated_press(number: &str, sensor_radius: f64) -> Result<Answer, RecordedError> {
    let mut text = "x_mm,y_mm,normal_displacement_mm\n".to_owned();
    for index in 0..25_i32 {
        let [x, y] = [index % 5, index / 5].map(|step| 2.0 * f64::from(step - 2));
        let moved = if index == 3 {
            number.to_owned()
        } else {
            format!("{:e}", libm::exp(-(x * x + y * y) / 30.0))
        };
        text += &format!("{x},{y},{moved}\n");
    }
    let options = PressOptions {
        marker_depth: 2.0,
        indentation: Some(1.2),
        ..PressOptions::new(sensor_radius)
    };
    let estimate = estimate_press(&parse_press(file(text))?, &options)?;
    Ok(finite(&estimate))
}

/// A number next to 0 tells what 0 does.
fn beside_0(
    number: &str,
    estimated: impl Fn(&str) -> Result<Answer, RecordedError>,
) -> Result<Answer, RecordedError> {
    let found = estimated(number)?;
    let is_next_to_0 = number
        .parse()
        .is_ok_and(|number: f64| number.abs() < 1e-300);
    if !is_next_to_0 {
        return Ok(found);
    }
    let of_0 = estimated(if number == "0" { "-0" } else { "0" })?;
    let pairs = found.values.iter().copied().zip(of_0.values);
    Ok(Answer::all_near(pairs.collect::<Vec<_>>()).within(1e-9))
}

/// Every estimate in another unit is that in the first by a power of the unit from -2 to 2.
fn scaled(
    scale: f64,
    estimated: impl Fn(f64) -> Result<Answer, RecordedError>,
) -> Result<Answer, RecordedError> {
    let (found, of_one) = (estimated(scale)?, estimated(1.0)?);
    let pairs = found.values.iter().zip(&of_one.values);
    let pairs = pairs.filter(|(_, of_one)| **of_one != 0.0);
    let pairs = pairs.map(|(found, of_one)| {
        let power = (libm::log((found / of_one).abs()) / libm::log(scale))
            .round()
            .clamp(-2.0, 2.0);
        (found / libm::pow(scale, power), *of_one)
    });
    let answer = Answer::all_near(pairs.collect::<Vec<_>>()).within(1e-6);
    Ok(answer.also(found.values))
}

/// 0.1 turns per length through rest, of which the point tells nothing but where rest is.
fn calibrated(number: &str) -> Result<Answer, RecordedError> {
    let text = format!("normal_displacement_mm,hue_turns,growth\n{number},0,0\n1,0.1,0\n2,0.2,0\n");
    let points = parse_calibration_points(&file(text))?;
    let report = calibrate(&[points], &CalibrateOptions::default())?;
    let slope = (report.calibration.normal_part()).map_or(f64::NAN, |part| part.line.slope);
    let is_rest = number
        .parse()
        .is_ok_and(|number: f64| number.abs() < 1e-300);
    Ok(if is_rest {
        Answer::near(slope, 0.1).within(1e-12)
    } else {
        Answer::finite([slope])
    })
}

/// The values of what is printed; JSON knows neither NaN nor infinity, which become null: where a value must be.
fn finite(estimate: &impl serde::Serialize) -> Answer {
    let json = serde_json::to_value(estimate).unwrap_or(Value::Null);
    let mut values = Vec::new();
    collect(&json, &mut values);
    Answer::finite(values)
}

fn collect(json: &Value, values: &mut Vec<f64>) {
    match json {
        Value::Array(all) => all.iter().for_each(|one| collect(one, values)),
        Value::Object(all) => {
            if let Some(value) = all.get("value") {
                values.push(value.as_f64().unwrap_or(f64::NAN));
            }
            all.values().for_each(|one| collect(one, values));
        }
        _ => {}
    }
}
