//! Recorded readings, from a file to an estimate.

use std::path::{Path, PathBuf};

use palpate_recorded::{
    Form, RecordedError, RecordedFile, RollEstimate, RollOptions, column_names, estimate_roll,
    parse_roll, read_roll,
};
use palpate_study::config::LengthUnit;
use tempfile::TempDir;

fn options() -> RollOptions {
    RollOptions::new(10.0)
}

const HEADER: &str = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm";

fn file(contents: impl AsRef<[u8]>) -> (TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("readings.csv");
    std::fs::write(&path, contents).unwrap();
    (dir, path)
}

fn estimate(rows: &str, options: &RollOptions) -> Result<RollEstimate, RecordedError> {
    let (_dir, path) = file(format!("{HEADER}\n{rows}"));
    estimate_roll(read_roll(&path)?, options)
}

/// The value and the standard error of a quantity.
fn measured(estimate: &RollEstimate, quantity: &str) -> (f64, Option<f64>) {
    let json = serde_json::to_value(estimate).unwrap();
    (
        json[quantity]["value"].as_f64().unwrap(),
        json[quantity]["std"].as_f64(),
    )
}

/// Shifts of a probe of radius 10 on a surface with these normal curvatures along u and v.
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

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-12
}

#[test]
fn convex_flat_concave_and_saddle_shaped_objects_are_estimated() {
    for (u, v) in [
        (0.02, 0.02),
        (0.0, 0.0),
        (-0.03, -0.05),
        (0.04, -0.06),
        (0.0, 5.0),
    ] {
        for directions in [3, 4, 8, 31] {
            let estimate = estimate(&rows(u, v, directions), &options()).unwrap();
            let value = |quantity| measured(&estimate, quantity).0;
            assert!(
                close(value("normal_curvature_u"), u),
                "{u} {v} {directions}"
            );
            assert!(
                close(value("normal_curvature_v"), v),
                "{u} {v} {directions}"
            );
            assert!(
                close(value("gaussian_curvature"), u * v),
                "{u} {v} {directions}"
            );
            assert!(
                close(value("mean_curvature"), 0.5 * (u + v)),
                "{u} {v} {directions}"
            );
            assert!(
                close(value("principal_curvature_min"), u.min(v)),
                "{u} {v} {directions}"
            );
            assert!(
                close(value("principal_curvature_max"), u.max(v)),
                "{u} {v} {directions}"
            );
        }
    }
}

#[test]
fn the_principal_direction_belongs_to_the_largest_curvature() {
    for (u, v, direction) in [(0.04, 0.01, 0.0), (0.01, 0.04, 90.0)] {
        let estimate = estimate(&rows(u, v, 8), &options()).unwrap();
        let json = serde_json::to_value(&estimate).unwrap();
        let found = json["principal_direction_max_deg"].as_f64().unwrap();
        assert!((found.abs() - direction).abs() < 1e-9, "{found}");
        assert!((json["amplification_u"].as_f64().unwrap() - (1.0 + 0.1 / u)).abs() < 1e-9);
    }
}

#[test]
fn a_flat_object_has_no_amplification() {
    let rows = "0,0,-0.5,5,0\n1,0.5,0,0,5\n";
    let json = serde_json::to_value(estimate(rows, &options()).unwrap()).unwrap();
    assert_eq!(json["normal_curvature_u"]["value"], 0.0);
    assert!(json["amplification_u"].is_null());
}

/// With all lengths multiplied by a power of two, curvatures are divided by it, to the last bit.
#[test]
fn curvatures_scale_with_lengths() {
    let scaled = |scale: f64| {
        let [a, b, c] = [4.1, 3.7, 0.2].map(|length| length * scale);
        let rows = format!("0,0,-0.5,{a},{c}\n1,0.5,0,{c},{b}\n2,0,0.25,-{c},0\n");
        let options = RollOptions {
            probe_radius: 10.0 * scale,
            ..options()
        };
        estimate(&rows, &options).unwrap()
    };
    let (one, other) = (scaled(1.0), scaled(1024.0));
    for quantity in ["normal_curvature_u", "normal_curvature_v", "mean_curvature"] {
        let (value, std) = measured(&one, quantity);
        let (scaled_value, scaled_std) = measured(&other, quantity);
        assert_eq!(value, 1024.0 * scaled_value, "{quantity}");
        assert_eq!(std.unwrap(), 1024.0 * scaled_std.unwrap(), "{quantity}");
    }
}

#[test]
fn standard_errors_increase_with_the_scatter() {
    let std = |scatter: f64| {
        let [more, less] = [4.0 + scatter, 4.0 - scatter];
        let rows =
            format!("0,0,-0.5,{more},0\n1,0,-0.5,{less},0\n2,0.5,0,0,{more}\n3,0.5,0,0,{less}\n");
        measured(&estimate(&rows, &options()).unwrap(), "normal_curvature_u")
            .1
            .unwrap()
    };
    assert!((std(0.2) / std(0.1) - 2.0).abs() < 1e-9);
    assert!(std(1e-9) > 0.0);
}

#[test]
fn errors_have_a_kind() {
    let read = |contents: &[u8]| {
        let (_dir, path) = file(contents);
        read_roll(&path).unwrap_err()
    };
    assert!(matches!(read(b""), RecordedError::File { .. }));
    assert!(matches!(read(b"\xff"), RecordedError::File { .. }));
    assert!(matches!(
        read_roll(Path::new("/nowhere")),
        Err(RecordedError::File { .. })
    ));
    assert!(matches!(
        read(b"\nprobe\n"),
        RecordedError::Line { line: 2, .. }
    ));
    let broken = format!("{HEADER}\r\n\r\n0,0,-0.5,4,x\r\n");
    assert!(matches!(
        read(broken.as_bytes()),
        RecordedError::Line { line: 3, .. }
    ));
    assert!(matches!(
        read(HEADER.as_bytes()),
        RecordedError::Readings { .. }
    ));
    let parallel = estimate("0,0,-0.5,4,0\n1,0,-0.5,4,0\n", &options()).unwrap_err();
    assert!(matches!(parallel, RecordedError::Readings { .. }));
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

/// Numbers at the ends of the range return an estimate or an error, never a NaN.
#[test]
fn extreme_numbers_return_an_estimate_or_an_error() {
    let numbers = [
        "0", "-0", "5e-324", "1e-160", "1e-9", "1", "1e9", "1e160", "1.7e308", "-1e160",
    ];
    let mut estimates = 0;
    for rotation in numbers {
        for shift in numbers {
            for (radius, pitch) in [(10.0, None), (1e-300, Some(1e-301)), (1e300, Some(1e-300))] {
                let rows = format!("0,0,-{rotation},{shift},0\n1,{rotation},0,0,{shift}\n")
                    .replace("--", "");
                let options = RollOptions {
                    probe_radius: radius,
                    noise: pitch
                        .and_then(|pitch| RollOptions::noise_of_pads(radius, pitch).ok())
                        .unwrap_or_default(),
                    ..options()
                };
                let Ok(estimate) = estimate(&rows, &options) else {
                    continue;
                };
                estimates += 1;
                for quantity in ["normal_curvature_u", "gaussian_curvature", "arc_length"] {
                    let json = serde_json::to_value(&estimate).unwrap();
                    // JSON has no NaN: it would be null.
                    assert!(
                        json[quantity]["value"].is_f64(),
                        "{rows} {options:?}: {json}"
                    );
                }
            }
        }
    }
    assert!(estimates > 0);
}

/// A file of arbitrary bytes is read or refused.
#[test]
fn arbitrary_bytes_are_read_or_refused() {
    let mut state = 1_u64;
    for _ in 0..500 {
        let bytes: Vec<u8> = (0..60)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                b"0123,,,,\n\n\r-+.eE\"\" infNa\t\xef\xbb\xbf"[(state >> 33) as usize % 28]
            })
            .collect();
        let mut contents = format!("{HEADER}\n").into_bytes();
        contents.extend(&bytes);
        let (_dir, path) = file(&contents);
        if let Err(error) = read_roll(&path) {
            assert!(error.to_string().contains("readings.csv"), "{error}");
        }
    }
}

/// A table of two rolls of a probe of radius 10 on a ball of radius 40. `write` arranges the quaternion components.
fn quaternions(header: &str, write: fn([f64; 4]) -> [f64; 4]) -> String {
    let (half, shift) = (0.1_f64, 0.2 / (1.0 / 10.0 + 1.0 / 40.0));
    let (sine, cosine) = libm::sincos(half);
    let mut table = format!("{header}\n");
    for (probe, ([x, y], [u, v])) in [([0.0, -sine], [shift, 0.0]), ([sine, 0.0], [0.0, shift])]
        .into_iter()
        .enumerate()
    {
        let [a, b, c, d] = write([x, y, 0.0, cosine]);
        table += &format!("{probe},{a},{b},{c},{d},{u},{v}\n");
    }
    table
}

fn roll_of(table: String) -> Result<serde_json::Value, String> {
    let readings = parse_roll(RecordedFile::new("q.csv", table.into_bytes()))
        .map_err(|error| error.to_string())?;
    let estimate =
        estimate_roll(readings, &RollOptions::new(10.0)).map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(estimate).unwrap())
}

#[test]
fn quaternions_are_rotations() {
    let last = quaternions("probe,qx,qy,qz,qw,shift_u_mm,shift_v_mm", |q| q);
    let first = quaternions(
        "probe,quat_w,quat_x,quat_y,quat_z,shift_u_mm,shift_v_mm",
        |[x, y, z, w]| [w, x, y, z],
    );
    let ros = quaternions(
        "probe,pose.orientation.x,pose.orientation.y,pose.orientation.z,pose.orientation.w,shift_u_mm,shift_v_mm",
        |q| q.map(|part| -part),
    );
    // Names that form a quaternion only by the last letters of all four.
    let lettered = [
        "rotation.x,rotation.y,rotation.z,rotation.w",
        "rx,ry,rz,rw",
        "quatX,quatY,quatZ,quatW",
    ];
    let lettered =
        lettered.map(|names| quaternions(&format!("probe,{names},shift_u_mm,shift_v_mm"), |q| q));
    for table in [last, first, ros].into_iter().chain(lettered) {
        let estimate = roll_of(table).unwrap();
        let curvature = estimate["mean_curvature"]["value"].as_f64().unwrap();
        assert!((curvature - 0.025).abs() < 1e-12, "{curvature}");
    }
}

#[test]
fn unusable_quaternions_are_refused() {
    let refused = |table: String, words: &str| {
        let error = roll_of(table).unwrap_err();
        assert!(error.contains(words), "{error}");
    };
    let header = "probe,qx,qy,qz,qw,shift_u_mm,shift_v_mm";
    refused(
        quaternions(header, |q| q.map(|part| 1.1 * part)),
        "q.csv:2: columns `qx` to `qw`: a rotation is a quaternion of length 1, this one has 1.1",
    );
    refused(
        quaternions("time_s,qx,qy,qz,qw,shift_u_mm,shift_v_mm", |q| q),
        "column `time_s`: a time series of a roll is not read with quaternions; give one row per roll, with a column `probe`",
    );
    refused(
        quaternions("header_stamp_secs,qx,qy,qz,qw,shift_u_mm,shift_v_mm", |q| q),
        "column `header_stamp_secs`: a time series of a roll",
    );
    refused(
        quaternions("probe,q0,q1,q2,q3,shift_u_mm,shift_v_mm", |q| q),
        "a quaternion is read from qx,qy,qz,qw, where qw is its scalar part",
    );
    let readings = RecordedFile::new("q.csv", quaternions(header, |q| q).into_bytes());
    let form = Form {
        columns: column_names("rotation_x_rad=qx,rotation_y_rad=qy").unwrap(),
        ..Form::default()
    };
    let error = parse_roll(readings.written(form)).unwrap_err().to_string();
    assert!(
        error.contains("`rotation_x_rad` is said to be `qx`, which is part of a quaternion"),
        "{error}"
    );
    refused(
        quaternions(header, |q| q).replace("\n1,", "\n0,"),
        "probe 0 stands twice: a time series of a roll",
    );
    // Components of a quaternion are never proposed for a rotation vector.
    let hint = roll_of(quaternions(
        "probe,qx,qy,qz,real,shift_u_mm,shift_v_mm",
        |q| q,
    ))
    .unwrap_err();
    assert!(
        hint.contains("no column `qw`") && !hint.contains("rotation_x_rad=q"),
        "{hint}"
    );
}
