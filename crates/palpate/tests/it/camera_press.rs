//! Tests `palpate sensor track --method image`, which fits a press to two camera frames.

use serde_json::Value;

use super::desk::{Desk, edited};

pub(crate) const PRESS: &str = r#"name = "pressed"
length_unit = "mm"
seed = 3
trials = 1
[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0, misalignment = 0.2 } }
object = { kind = "sphere", radius = 30.0 }
motion = { indentation = 1.0, contact_deg = [6.0, 40.0] }
model = { kind = "bonded-layer", thickness = 5.0 }
sensor = { kind = "rendered", size_px = 400, calibration = { presses = 2, rest_frames = 1 } }
noise = { pixel = { kind = "gaussian", std = 2.0 } }
estimator = { kind = "image", indentation_std = 0.02 }
"#;
const FRAMES: &str = "t/rest.png t/pressed.png --out o";
const IMAGE: &str = "--like c.toml --method image";

fn desk() -> Desk {
    let desk = Desk::with(PRESS);
    desk.palpate("trace c.toml --trial 0 --out t").printed();
    desk
}

fn track(desk: &Desk, arguments: &str) -> Value {
    let printed = desk.palpate(&format!("sensor track {arguments}")).printed();
    serde_json::from_str(&printed).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

fn interval_contains(estimate: &Value, truth: f64) -> bool {
    let interval = &estimate["interval95"];
    number(&interval[0]) < truth && truth < number(&interval[1])
}

#[test]
fn image_fit_estimates_the_traced_press() {
    let desk = desk();
    let known = "--indentation 1 --indentation-std 0.02";
    let estimate = track(&desk, &format!("{FRAMES} {IMAGE} {known}"));
    assert_eq!(
        (&estimate["method"], &estimate["markers"]),
        (&"image".into(), &77.into())
    );
    assert!(
        interval_contains(&estimate["object_curvature"], 1.0 / 30.0),
        "{estimate}"
    );
    assert!(
        interval_contains(&estimate["indentation"], 1.0),
        "{estimate}"
    );
    assert_eq!(estimate["warnings"], Value::Array(vec![]));
    // The contact is 6 degrees from the apex, in the direction of 40 degrees.
    let distance = 20.0 * 6.0_f64.to_radians();
    let (sine, cosine) = libm::sincos(40.0_f64.to_radians());
    for (axis, direction) in [cosine, sine].into_iter().enumerate() {
        let off = number(&estimate["contact"][axis]) - distance * direction;
        assert!(
            off.abs() < 4.0 * number(&estimate["contact_std"][axis]),
            "{estimate}"
        );
    }

    // The frames are of trial 0. A run of the study has the same estimate for this trial.
    desk.palpate("run c.toml --trials-out trials.csv --out r")
        .printed();
    let trials = desk.table("trials.csv");
    let row =
        (0..trials.rows.len()).find(|&row| trials.text(row, "quantity") == "object_curvature");
    let row = row.unwrap();
    let std = trials.number(row, "std");
    let off = number(&estimate["object_curvature"]["value"]) - trials.number(row, "estimate");
    assert!(off.abs() < 0.1 * std, "{off} {std}");
    assert!((number(&estimate["object_curvature"]["std"]) / std - 1.0).abs() < 0.02);

    let names = [
        "difference.png",
        "field.csv",
        "markers.csv",
        "overlay.png",
        "readings.csv",
    ];
    assert_eq!(desk.names("o"), names);
    let readings = desk.table("o/readings.csv");
    assert_eq!(readings.rows.len(), 77);
    assert_eq!(readings.header, desk.table("o/field.csv").header);

    // Each estimated normal displacement differs from the true one by at most five standard deviations of the noise,
    // each tangential displacement by at most 0.01 mm.
    let truth = desk.table("t/trace.csv");
    let normal_std = number(&estimate["noise"]["normal_std"]["value"]);
    for row in 0..77 {
        let place = |table: &super::desk::Table, row: usize| {
            ["x_mm", "y_mm"].map(|name| table.number(row, name))
        };
        let [x, y] = place(&readings, row);
        let marker = (0..77).find(|&marker| {
            let [at, beside] = place(&truth, marker);
            libm::hypot(at - x, beside - y) < 1e-6
        });
        let marker = marker.unwrap();
        for (name, most) in [
            ("normal_displacement_mm", 5.0 * normal_std),
            ("tangential_x_mm", 0.01),
        ] {
            let off = readings.number(row, name) - truth.number(marker, name);
            assert!(off.abs() < most, "{marker} {name}: {off}");
        }
    }
    // Without --method, `sensor track` uses the estimator of the study.
    let again = track(
        &desk,
        &format!("{FRAMES} --like c.toml {known} --young 0.1"),
    );
    assert_eq!(again["object_curvature"], estimate["object_curvature"]);
    assert!(number(&again["force"]["value"]) > 0.0 && estimate["force"].is_null());
}

/// Each row: key of a line in the camera file | replacement for this line | words of the expected error.
const CAMERA_EDITS: &str = r#"
place | place = [nan, 0.0, 0.0] | `place[0]` is NaN; it must be finite
place_std | place_std = [1.0, 1.0, 1.0] | `covariance[3][3]` belongs to a standard deviation
place_std |  | missing field `place_std`
turn_deg | turn_deg = [1e40, 0.0, 0.0] | contradicts the frame at rest
px_per_rad | px_per_rad = -1.0 | `px_per_rad` is -1; it must be finite and > 0
covariance | covariance = [[1.0]] | `covariance` must have 11 rows of 11 numbers
turn_deg | turned = 1 | turned
length_unit | length_unit = "unit" | length_unit
"#;

/// The camera is not in the centre of the sensor. Its position is calibrated with a frame at rest. The estimate of the
/// press then uses this position.
#[test]
fn image_fit_uses_the_camera_calibrated_from_a_frame_at_rest() {
    let desk = Desk::with(&edited(
        PRESS,
        "size_px = 400",
        "size_px = 400, place = [0.5, 0.0, -0.4]",
    ));
    desk.palpate("trace c.toml --trial 0 --out t").printed();
    desk.write("c.toml", PRESS);
    let said = desk
        .palpate(&format!("sensor track {FRAMES} {IMAGE}"))
        .said(1);
    assert!(
        said.contains("rest.png: contradicts")
            && said.contains("place[")
            && said.contains("by `sensor calibrate`"),
        "{said}"
    );
    assert!(desk.names("o").contains(&"markers.csv".to_owned()));
    // This study has two cells with frames of 300 and 400 pixels. The frames of this test belong to the second cell,
    // which is cell 1.
    let sizes = "[[sweep]]\npath = \"scene.sensor.size_px\"\nvalues = [300, 400]\n";
    desk.write("sizes.toml", PRESS.to_owned() + sizes);
    let calibrate = "sensor calibrate --rest t/rest.png --layout sizes.toml --out camera.toml";
    desk.palpate(&format!("{calibrate} --cell 1")).printed();
    desk.palpate(&format!("{calibrate} --cell 2"))
        .fails(2, "--cell is 2");
    let run = format!("{FRAMES} {IMAGE} --calibration camera.toml");
    let estimate = track(&desk, &run);
    assert!(
        interval_contains(&estimate["object_curvature"], 1.0 / 30.0),
        "{estimate}"
    );
    assert_eq!(estimate["warnings"], Value::Array(vec![]));

    let camera = desk.read("camera.toml");
    let line = |key: &str| {
        let start = format!("{key} = ");
        let line = camera.lines().find(|line| line.starts_with(&start));
        line.unwrap().to_owned()
    };
    for row in CAMERA_EDITS.trim().lines() {
        let columns: Vec<&str> = row.split(" | ").collect();
        let [key, to, words] = columns[..] else {
            panic!("{row}")
        };
        desk.write("camera.toml", edited(&camera, &line(key), to));
        let ended = desk.palpate(&format!("sensor track {run}"));
        assert!(matches!(ended.status, Some(1 | 2)), "{row}: {ended:?}");
        assert!(ended.stderr.contains(words), "{row}: {}", ended.stderr);
    }
    let row = camera.find("covariance = [[").unwrap() + "covariance = [[".len();
    let first = &camera[row..row + camera[row..].find(',').unwrap()];
    desk.write(
        "camera.toml",
        edited(&camera, &format!("[[{first}"), "[[1e6"),
    );
    desk.palpate(&format!("sensor track {run}")).fails(
        1,
        "camera.toml: `centre_px[0]` has a standard deviation of 1000 px; it must be at most 5",
    );
    desk.write("camera.toml", "\n");
    desk.palpate(&format!("sensor track {run}")).fails(
        1,
        "camera.toml: is empty; a camera is needed, as `sensor calibrate` writes it from a frame at rest",
    );
    desk.write("camera.toml", &camera);
    // A study of the same sensor, with lengths in centimetres.
    let mut in_cm = edited(PRESS, "\"mm\"", "\"cm\"");
    for (mm, cm) in [
        ("radius = 20.0", "radius = 2.0"),
        ("marker_depth = 2.0", "marker_depth = 0.2"),
        ("magenta_diameter = 2.0", "magenta_diameter = 0.2"),
        ("yellow_diameter = 2.0", "yellow_diameter = 0.2"),
        ("separation = 2.0", "separation = 0.2"),
        ("radius = 30.0", "radius = 3.0"),
        ("indentation = 1.0", "indentation = 0.1"),
        ("thickness = 5.0", "thickness = 0.5"),
        ("indentation_std = 0.02", "indentation_std = 0.002"),
    ] {
        in_cm = edited(&in_cm, mm, cm);
    }
    desk.write("cm.toml", in_cm);
    let again = track(
        &desk,
        &format!("{FRAMES} --like cm.toml --calibration camera.toml"),
    );
    assert_eq!(again["length_unit"], "mm");
    for key in ["value", "std"] {
        let [one, other] =
            [&estimate, &again].map(|estimate| number(&estimate["object_curvature"][key]));
        assert!((one / other - 1.0).abs() < 1e-4, "{key}: {one} {other}");
    }
    // A calibration of displacements cannot be used as a camera, and a camera cannot be used as a calibration of
    // displacements.
    desk.write(
        "t.csv",
        "normal_displacement_mm,hue_turns\n1,0.02\n2,0.05\n",
    );
    desk.palpate("sensor calibrate t.csv --out other.toml")
        .printed();
    desk.palpate(&format!(
        "sensor track {FRAMES} {IMAGE} --calibration other.toml"
    ))
    .fails(
        1,
        "other.toml: is a calibration of displacements (`normal`)",
    );
    desk.palpate(&format!(
        "sensor track {FRAMES} --calibration camera.toml --sensor-radius 20 --depth 2"
    ))
    .fails(1, "camera.toml: is a camera from a frame at rest");
}

#[test]
fn errors_name_frames_and_arguments_that_do_not_match() {
    let desk = desk();
    desk.write("size.toml", edited(PRESS, "size_px = 400", "size_px = 500"));
    for (arguments, words) in [
        (
            "--like size.toml --method image",
            "rest.png: has 400 x 400 px; the layout's camera takes 500 x 500",
        ),
        ("--like c.toml --calibration none.toml", "none.toml"),
    ] {
        desk.palpate(&format!("sensor track {FRAMES} {arguments}"))
            .fails(1, words);
    }
    let estimate = track(&desk, &format!("{FRAMES} {IMAGE} --indentation 1.3"));
    let warnings = estimate["warnings"].to_string();
    assert!(
        warnings.contains("the indentation is stated as 1.3 mm"),
        "{estimate}"
    );
}
