//! Recorded readings: files of extreme numbers.

use palpate_scene::recorded::{
    CalibrateOptions, GlideOptions, PressOptions, ReadingNoise, RecordedError, RecordedFile,
    RollOptions, calibrate, estimate_glide, estimate_press, estimate_roll,
    parse_calibration_points, parse_glide, parse_press, parse_roll,
};
use palpate_verdict::{Answer, rows};
use serde_json::Value;

const ROLL: &str = "scene::recorded::estimate_roll";
const GLIDE: &str = "scene::recorded::estimate_glide";
const PRESS: &str = "scene::recorded::estimate_press";
const CALIBRATE: &str = "scene::recorded::calibrate";
/// Texts that are no finite numbers.
const NO_NUMBERS: [&str; 6] = ["NaN", "inf", "-inf", "1e400", "", "1e999999999"];
const HUGE: [&str; 2] = ["-1e308", "1e308"];
const NEXT_TO_0: [&str; 4] = ["5e-324", "-0", "0", "1e-320"];
const NO_LENGTHS: [f64; 6] = [f64::NAN, 0.0, -1.0, f64::INFINITY, 5e-324, 1e308];
const SCALES: [f64; 4] = [1e-100, 1e-9, 1e9, 1e100];
/// Texts that are no readings, and the errors of roll, glide and press.
const NO_READINGS: [(&str, [&str; 3]); 8] = [
    ("", ["file"; 3]),
    ("\n", ["file"; 3]),
    ("probe", ["line"; 3]),
    ("\u{feff}", ["file"; 3]),
    (",,,,", ["line"; 3]),
    ("x_mm,y_mm\n1,2", ["line"; 3]),
    ("\"", ["line"; 3]),
    ("finger,x_mm,y_mm,z_mm\n", ["line", "readings", "line"]),
];

rows! {
    ROLL, "a shift of \"{number}\"", "line" => roll(number, 1.0, None), for number in NO_NUMBERS;
    ROLL, "a shift of \"{number}\"", "readings" => roll(number, 1.0, None),
        for number in HUGE.into_iter().chain(NEXT_TO_0);
    GLIDE, "a height of \"{number}\"", "line" => glide(number, 1.0), for number in NO_NUMBERS.into_iter().chain(HUGE);
    GLIDE, "a height of \"{number}\": next to 0 as 0" => as_0(number, |number| glide(number, 1.0)),
        for number in NEXT_TO_0;
    PRESS, "a displacement of \"{number}\"", "line" => press(number, 20.0),
        for number in NO_NUMBERS.into_iter().chain(HUGE);
    PRESS, "a displacement of \"{number}\": next to 0 as 0" => as_0(number, |number| press(number, 20.0)),
        for number in NEXT_TO_0;
    CALIBRATE, "a displacement of \"{number}\" where the hue is at rest", "line" => calibrated(number),
        for number in NO_NUMBERS.into_iter().chain(HUGE);
    CALIBRATE, "a displacement of \"{number}\" where the hue is at rest: turns per length" => calibrated(number),
        for number in NEXT_TO_0;
    ROLL, "lengths of {scale:e}: as of 1, scaled" => scaled(scale, |scale| roll(&format!("{scale:e}"), scale, None)),
        for scale in SCALES;
    GLIDE, "lengths of {scale:e}: as of 1, scaled" => scaled(scale, |scale| glide("-0.032", scale)),
        for scale in SCALES;
    PRESS, "a sensor of radius {bad:e}", "readings" => press("0.5", bad), for bad in NO_LENGTHS;
    ROLL, "a probe of radius {bad:e}", "readings" => roll("1", bad, None), for bad in NO_LENGTHS;
    "scene::recorded::RollOptions::noise_of_pads", "pitch {bad:e}", "invalid-sensor" => RollOptions::noise_of_pads(1.0, bad),
        for bad in NO_LENGTHS.into_iter().chain([1.1]);
    "scene::recorded::RollOptions::noise_of_shifts", "deviation {bad:e}", "invalid-sensor" =>
        RollOptions::noise_of_shifts(1.0, bad), for bad in [f64::NAN, -1.0, f64::INFINITY, 1.1];
    ROLL, "pads of pitch {pitch:e}" => roll("1", 1.0, Some(pitch)).map(Answer::finite), for pitch in [1e-14, 1.0];
    "scene::recorded::parse_roll", "{text:?}", errors[0] => parse_roll(file(text.to_owned())),
        for (text, errors) in NO_READINGS;
    "scene::recorded::parse_glide", "{text:?}", errors[1] => parse_glide(file(text.to_owned())),
        for (text, errors) in NO_READINGS;
    "scene::recorded::parse_press", "{text:?}", errors[2] => parse_press(file(text.to_owned())),
        for (text, errors) in NO_READINGS;
}

fn file(text: String) -> RecordedFile {
    RecordedFile::new("readings.csv", text.into_bytes())
}

fn roll(shift: &str, probe_radius: f64, pitch: Option<f64>) -> Result<Vec<f64>, RecordedError> {
    let is_length = probe_radius.is_normal();
    let other = if is_length { -probe_radius } else { -1.0 };
    let text = format!(
        "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n\
         0,0,-0.4,{shift},0\n1,0,-0.4,{shift},0\n2,-0.4,0,0,{other:e}\n3,-0.4,0,0,{other:e}\n"
    );
    let options = RollOptions {
        noise: pitch.map_or_else(ReadingNoise::default, |pitch| {
            RollOptions::noise_of_pads(probe_radius, pitch).expect("a pitch of a probe")
        }),
        ..RollOptions::new(probe_radius)
    };
    Ok(values(&estimate_roll(&parse_roll(file(text))?, &options)?))
}

fn glide(number: &str, scale: f64) -> Result<Vec<f64>, RecordedError> {
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
    Ok(values(&estimate))
}

fn press(number: &str, sensor_radius: f64) -> Result<Vec<f64>, RecordedError> {
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
        marker_depth: Some(2.0),
        indentation: Some(1.2),
        ..PressOptions::new(sensor_radius)
    };
    Ok(values(&estimate_press(
        &parse_press(file(text))?,
        &options,
    )?))
}

/// A number next to 0 tells what 0 does.
fn as_0(
    number: &str,
    estimated: impl Fn(&str) -> Result<Vec<f64>, RecordedError>,
) -> Result<Answer, RecordedError> {
    let of_0 = estimated(if number == "0" { "-0" } else { "0" })?;
    Ok(Answer::all_near(estimated(number)?.into_iter().zip(of_0)).within(1e-9))
}

/// Every estimate in another unit is that in the first by a power of the unit from -2 to 2.
fn scaled(
    scale: f64,
    estimated: impl Fn(f64) -> Result<Vec<f64>, RecordedError>,
) -> Result<Answer, RecordedError> {
    let (found, of_one) = (estimated(scale)?, estimated(1.0)?);
    let pairs = found
        .iter()
        .zip(of_one)
        .filter(|(_, of_one)| *of_one != 0.0);
    let pairs = pairs.map(|(found, of_one)| {
        let power = libm::log((found / of_one).abs()) / libm::log(scale);
        let power = power.round().clamp(-2.0, 2.0);
        (found / libm::pow(scale, power), of_one)
    });
    Ok(Answer::all_near(pairs)
        .within(1e-6)
        .also(found.iter().copied()))
}

/// 0.1 turns per length through rest, of which the point tells nothing but where rest is.
fn calibrated(number: &str) -> Result<Answer, RecordedError> {
    let text = format!("normal_displacement_mm,hue_turns,growth\n{number},0,0\n1,0.1,0\n2,0.2,0\n");
    let points = parse_calibration_points(&file(text))?;
    let report = calibrate(&[points], &CalibrateOptions::default())?;
    let normal = report.calibration.normal_part().unwrap();
    Ok(Answer::near(normal.line.slope, 0.1).within(1e-12))
}

/// The values of what is printed; JSON knows neither NaN nor infinity, which become null: where a value must be.
fn values(estimate: &impl serde::Serialize) -> Vec<f64> {
    let mut values = Vec::new();
    collect(&serde_json::to_value(estimate).unwrap(), &mut values);
    values
}

fn collect(json: &Value, values: &mut Vec<f64>) {
    match json {
        Value::Array(all) => all.iter().for_each(|one| collect(one, values)),
        Value::Object(all) => {
            values.extend(
                all.get("value")
                    .map(|value| value.as_f64().unwrap_or(f64::NAN)),
            );
            all.values().for_each(|one| collect(one, values));
        }
        _ => {}
    }
}
