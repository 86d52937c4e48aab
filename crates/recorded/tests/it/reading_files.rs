//! Estimates from files of recorded readings.

use palpate_recorded::{
    ReadingNoise, RecordedError, RecordedFile, RollEstimate, RollOptions, RollRecording,
    estimate_roll,
};
use palpate_study::config::LengthUnit;

fn options() -> RollOptions {
    RollOptions::new(10.0)
}

const HEADER: &str = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm";

fn estimate(rows: &str, options: &RollOptions) -> Result<RollEstimate, RecordedError> {
    let table = format!(
        "{HEADER}
{rows}"
    )
    .into_bytes();
    estimate_roll(
        RollRecording::try_from(RecordedFile::new("readings.csv", table))?,
        options,
    )
}

/// Table of rolls, as text. A probe with a radius of 10 rolls on a surface with the normal curvatures `curvature_u`
/// along u and `curvature_v` along v.
fn rows(curvature_u: f64, curvature_v: f64, directions: usize) -> String {
    (0..directions)
        .map(|probe| {
            let angle = std::f64::consts::TAU * probe as f64 / directions as f64;
            let (sin, cos) = libm::sincos(angle);
            let [u, v] = [
                0.3 * cos / (0.1 + curvature_u),
                0.3 * sin / (0.1 + curvature_v),
            ];
            format!("{probe},{},{},{u},{v}\n", 0.3 * sin, -0.3 * cos)
        })
        .collect()
}

#[test]
fn convex_flat_concave_and_saddle_shaped_objects_are_estimated() {
    for (u, v, direction) in [
        (0.02, 0.02, None),
        (0.0, 0.0, None),
        (-0.03, -0.05, Some(0.0)),
        (0.04, -0.06, Some(0.0)),
        (0.01, 0.04, Some(90.0)),
        (0.0, 5.0, Some(90.0)),
    ] {
        for directions in [3, 4, 8, 31] {
            let estimate = estimate(&rows(u, v, directions), &options()).unwrap();
            let json = serde_json::to_value(&estimate).unwrap();
            let value = |quantity: &str| json[quantity]["value"].as_f64().unwrap();
            for (quantity, expected) in [
                ("normal_curvature_u", u),
                ("normal_curvature_v", v),
                ("gaussian_curvature", u * v),
                ("mean_curvature", 0.5 * (u + v)),
                ("principal_curvature_min", u.min(v)),
                ("principal_curvature_max", u.max(v)),
            ] {
                let off = value(quantity) - expected;
                assert!(off.abs() < 1e-12, "{u} {v} {directions} {quantity}: {off}");
            }
            // The direction of the larger curvature is undetermined if both principal curvatures are equal.
            if let Some(direction) = direction {
                let found = json["principal_direction_max_deg"].as_f64().unwrap();
                assert!((found.abs() - direction).abs() < 1e-9, "{u} {v}: {found}");
            }
            if u != 0.0 {
                let amplification = json["amplification_u"].as_f64().unwrap();
                assert!((amplification - (1.0 + 0.1 / u)).abs() < 1e-9, "{u} {v}");
            }
        }
    }
}

#[test]
fn a_flat_object_has_no_amplification() {
    let rows = "0,0,-0.5,5,0\n1,0.5,0,0,5\n";
    let json = serde_json::to_value(estimate(rows, &options()).unwrap()).unwrap();
    assert_eq!(json["normal_curvature_u"]["value"], 0.0);
    assert!(json["amplification_u"].is_null());
}

#[test]
fn the_unit_of_an_option_must_match_the_header() {
    let with = |length_unit| RollOptions {
        length_unit,
        ..options()
    };
    let rows = "0,0,-0.5,4,0\n1,0.5,0,0,4\n";
    assert!(estimate(rows, &with(Some(LengthUnit::Mm))).is_ok());
    let message = estimate(rows, &with(Some(LengthUnit::Um)))
        .unwrap_err()
        .to_string();
    assert!(
        message.ends_with("readings.csv: the header says mm, setting `length_unit` says um"),
        "{message}"
    );
}

/// Rolls of a probe with the radius 10, nearly in the direction `drive`; `spread` is their largest deviation (rad) from
/// this direction. The object has the normal curvatures 0.06 along u and 0 along v, and the twist 0.02. The shifts have
/// errors of up to `error`.
fn rolls_along(drive: [f64; 2], spread: f64, error: f64) -> String {
    let mobility = nalgebra::Matrix2::new(0.16, 0.02, 0.02, 0.1)
        .try_inverse()
        .unwrap();
    let row = |probe: i32| {
        let [size, turn, u_error, v_error] =
            [0.1 + 0.02 * f64::from(probe), 1.0, 2.0, 3.0].map(|phase| match phase {
                size if size < 1.0 => size,
                phase => libm::sin(7.3 * phase * f64::from(probe)),
            });
        let drive = nalgebra::Vector2::from(drive) * size;
        let shift = mobility * drive;
        let [across_x, across_y] = [drive.x, drive.y].map(|along| spread * turn * along);
        format!(
            "{probe},{},{},{},{}\n",
            drive.y + across_x,
            across_y - drive.x,
            shift.x + error * u_error,
            shift.y + error * v_error
        )
    };
    (0..12).map(row).collect()
}

#[test]
fn rolls_in_one_direction_determine_the_curvature_along_the_path() {
    for drive in [[1.0, 0.0], [0.0, -1.0], [0.6, 0.8], [-0.8, 0.6]] {
        for (spread, error, tolerance) in [(0.0, 0.0, 1e-9), (0.02, 0.01, 0.01)] {
            let text = rolls_along(drive, spread, error);
            let lost = format!("{text}12,{},{},0,0\n", 0.3 * drive[1], -0.3 * drive[0]);
            let lost = estimate(&lost, &options()).unwrap().values();
            let estimate = estimate(&text, &options()).unwrap();
            let json = serde_json::to_value(&estimate).unwrap();
            let found = &json["single_direction"];
            let angle = found["direction_deg"].as_f64().unwrap().to_radians();
            let (sin, cos) = libm::sincos(angle);
            let truth = 0.06 * cos * cos + 0.04 * sin * cos;
            let along = &found["curvature_along"];
            let value = along["value"].as_f64().unwrap();
            assert!(
                (value - truth).abs() < tolerance,
                "{drive:?}: {value} {truth}"
            );
            if error > 0.0 {
                let [low, high] = [0, 1].map(|end| along["interval95"][end].as_f64().unwrap());
                assert!(
                    low < truth && truth < high && high - low < 0.02,
                    "{low} {high}"
                );
            }
            for open in [
                "mean_curvature",
                "gaussian_curvature",
                "normal_curvature_u",
                "radius",
            ] {
                assert!(json[open]["value"].is_null(), "{open}");
            }
            assert!(json["principal_direction_max_deg"].is_null());
            assert_eq!(json["warnings"][0]["code"], "not-resolved-across");
            let [found, lost] = [estimate.values(), lost].map(|all| all.single_direction);
            assert_eq!(found, lost, "a lost reading must be left out");
        }
    }
}

#[test]
fn stated_errors_of_rotations_do_not_bias_the_curvature() {
    for (setting, std, count) in [
        ("relative_rotation_std", 0.025, 8),
        ("rotation_std_rad", 0.01, 1),
    ] {
        // A probe rolls four times in each direction. The four errors of the rotation have the stated variance.
        let row = |roll: i32| {
            let angle = std::f64::consts::TAU * f64::from(roll / 4) / f64::from(count);
            let (sin, cos) = libm::sincos(angle);
            let error = libm::sincos(std::f64::consts::FRAC_PI_2 * f64::from(roll));
            let [x, y] = [error.0, error.1].map(|part| 0.01 * 2.0_f64.sqrt() * part);
            let [turn_x, turn_y] = [0.4 * sin + x, y - 0.4 * cos];
            format!("{roll},{turn_x},{turn_y},{},{}\n", 3.0 * cos, 3.0 * sin)
        };
        let rows: String = (0..4 * count).map(row).collect();
        let given = serde_json::json!({ setting: std });
        let options = RollOptions::with_settings(Some(options()), given.as_object().unwrap(), None);
        let estimate = estimate(&rows, &options.unwrap()).unwrap();
        let values = estimate.values();
        let along = values
            .single_direction
            .map(|found| found.curvature_along.value);
        let value = along.unwrap_or(values.mean_curvature.value).unwrap();
        assert!((value - 1.0 / 30.0).abs() < 1e-5, "{setting}: {value}");
        assert!(estimate.p_value().is_some(), "{setting}");
    }
}

/// The threshold of the mean curvature H must be inversely proportional to the length of the rolls. The errors of the
/// curvature are small compared with the probe's curvature, so H is normally distributed. Therefore the probabilities
/// of the classes `peak` and `ridge` together must be the probability that H is above its threshold.
#[test]
fn classes_have_thresholds_and_probabilities() {
    let class = |u: f64, v: f64, shift_std: f64| {
        let noise = ReadingNoise {
            shift_std,
            ..ReadingNoise::default()
        };
        let options = RollOptions { noise, ..options() };
        let estimate = estimate(&rows(u, v, 8), &options).unwrap();
        serde_json::to_value(&estimate).unwrap()
    };
    for (u, v, name) in [
        (0.05, 0.05, "peak"),
        (-0.04, -0.04, "pit"),
        (0.05, 0.0, "ridge"),
        (0.0, -0.05, "valley"),
        (0.001, -0.001, "flat"),
        (0.05, -0.05, "minimal"),
    ] {
        let found = class(u, v, 1e-4);
        let probability = found["class_probabilities"][name].as_f64();
        assert_eq!((&found["class"], probability), (&name.into(), Some(1.0)));
    }
    let found = class(0.016, 0.016, 0.1);
    let arc = found["arc_length"]["value"].as_f64().unwrap();
    let threshold = found["thresholds"]["mean"]["value"].as_f64().unwrap();
    assert!((threshold - 0.045 / arc).abs() < 1e-12, "{threshold}");
    let mean = &found["mean_curvature"];
    let [value, std] = ["value", "std"].map(|key| mean[key].as_f64().unwrap());
    let below = palpate_statistics::normal_tail((value - threshold) / std);
    let flat = found["class_probabilities"]["flat"].as_f64().unwrap();
    let ridge = found["class_probabilities"]["ridge"].as_f64().unwrap();
    let peak = found["class_probabilities"]["peak"].as_f64().unwrap();
    assert!((0.05..0.95).contains(&below), "{below}");
    assert!(
        (1.0 - below - peak - ridge).abs() < 0.02,
        "{below}: {found}"
    );
    assert!((flat + ridge + peak - 1.0).abs() < 0.02, "{found}");
}
