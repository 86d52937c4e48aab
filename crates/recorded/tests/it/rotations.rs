//! The same rolls with rotations as vectors, quaternions, matrices and axes with angles, in rows and as time series.

use nalgebra::{UnitQuaternion, Vector3};
use palpate_recorded::{
    Form, RecordedFile, RollOptions, RollRecording, RotationFrame, column_names, estimate_roll,
};
use palpate_study::config::LengthUnit;
use serde_json::Value;

use super::table_files::hint;

fn roll(table: &str, columns: &str, frame: Option<RotationFrame>) -> Result<Value, String> {
    let form = Form {
        rotation_frame: frame,
        ..Form::default()
    };
    roll_in(table, columns, form)
}

fn roll_in(table: &str, columns: &str, form: Form) -> Result<Value, String> {
    let mut form = form;
    if !columns.is_empty() {
        form.columns = column_names(columns).unwrap();
    }
    let mut file = RecordedFile::new("r.csv", table.as_bytes().to_vec());
    file.form = form;
    let readings = RollRecording::try_from(file).map_err(|error| error.to_string())?;
    let estimate = estimate_roll(readings, &RollOptions::new(10.0));
    let estimate = estimate.map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(estimate).unwrap())
}

fn mean(estimate: &Value) -> f64 {
    estimate["mean_curvature"]["value"].as_f64().unwrap()
}

type Write = fn(UnitQuaternion<f64>) -> Vec<f64>;

fn quaternion(rotation: UnitQuaternion<f64>) -> Vec<f64> {
    rotation.coords.iter().copied().collect()
}

fn scalar_first(rotation: UnitQuaternion<f64>) -> Vec<f64> {
    let [x, y, z, w]: [f64; 4] = rotation.coords.into();
    vec![-w, -x, -y, -z]
}

fn matrix(rotation: UnitQuaternion<f64>) -> Vec<f64> {
    let matrix = rotation.to_rotation_matrix();
    matrix.matrix().transpose().iter().copied().collect()
}

fn axis_angle(rotation: UnitQuaternion<f64>) -> Vec<f64> {
    let axis = rotation
        .axis()
        .map_or([0.0; 3], |axis| axis.into_inner().into());
    [&axis[..], &[rotation.angle()]].concat()
}

fn vector(rotation: UnitQuaternion<f64>) -> Vec<f64> {
    rotation.scaled_axis().iter().copied().collect()
}

/// Rolls of a probe with a radius of 10 on a surface with the normal curvatures 0.04 and 0.01. The probe also rotates a
/// little about the normal.
fn rolls() -> Vec<(Vector3<f64>, [f64; 2])> {
    (0..6)
        .map(|probe| {
            let (sin, cos) = libm::sincos(f64::from(probe));
            let turned = Vector3::new(0.3 * sin, -0.3 * cos, 0.01 * cos);
            (turned, [0.3 * cos / 0.14, 0.3 * sin / 0.11])
        })
        .collect()
}

/// Table of rolls, as text. Each row contains a probe, a time (only in time series), a rotation and a position. If
/// `start` is given, the table contains time series, and `start` is the orientation of the probe at the start of each
/// roll. With `None`, the table has one row per roll.
fn table(header: &str, start: Option<UnitQuaternion<f64>>, write: Write) -> String {
    let mut table = format!("{header}\n");
    for (probe, (turned, [u, v])) in rolls().into_iter().enumerate() {
        let mut push = |time: Option<f64>, rotation, [u, v]: [f64; 2]| {
            let numbers = time.into_iter().chain(write(rotation)).chain([u, v]);
            let numbers: Vec<String> = numbers.map(|number: f64| number.to_string()).collect();
            table += &format!("{probe},{}\n", numbers.join(","));
        };
        match start {
            None => push(None, UnitQuaternion::from_scaled_axis(turned), [u, v]),
            Some(start) => {
                for step in 0..=4 {
                    let share = f64::from(step) / 4.0;
                    let rotation = start * UnitQuaternion::from_scaled_axis(share * turned);
                    push(Some(share), rotation, [0.2 + share * u, share * v - 0.1]);
                }
            }
        }
    }
    table
}

const FORMS: [(&str, Write); 24] = [
    (
        "pose.orientation.x,pose.orientation.y,pose.orientation.z,pose.orientation.w",
        quaternion,
    ),
    ("rotation.x,rotation.y,rotation.z,rotation.w", quaternion),
    ("rx,ry,rz,rw", quaternion),
    ("quatX,quatY,quatZ,quatW", quaternion),
    ("rotation_x_rad,rotation_y_rad,rotation_z_rad", vector),
    ("rvec_x,rvec_y,rvec_z", vector),
    ("rotvec.0,rotvec.1,rotvec.2", vector),
    ("x,y,z,w", quaternion),
    ("i,j,k,w", quaternion),
    ("rxx,rxy,rxz,ryx,ryy,ryz,rzx,rzy,rzz", matrix),
    ("qi,qj,qk,qr", quaternion),
    (
        "rotm_1,rotm_2,rotm_3,rotm_4,rotm_5,rotm_6,rotm_7,rotm_8,rotm_9",
        matrix,
    ),
    ("ax,ay,az,theta", axis_angle),
    ("axis[0],axis[1],axis[2],angle_rad", axis_angle),
    (
        "rotation_axis_x,rotation_axis_y,rotation_axis_z,rotation_angle_rad",
        axis_angle,
    ),
    ("qx,qy,qz,qw", quaternion),
    ("quat_w,quat_x,quat_y,quat_z", scalar_first),
    ("q0,q1,q2,q3", quaternion),
    ("q1,q2,q3,q4", scalar_first),
    (
        "orientation.0,orientation.1,orientation.2,orientation.3",
        scalar_first,
    ),
    ("r11,r12,r13,r21,r22,r23,r31,r32,r33", matrix),
    (
        "R_0_0,R_0_1,R_0_2,R_1_0,R_1_1,R_1_2,R_2_0,R_2_1,R_2_2",
        matrix,
    ),
    (
        "rot.0,rot.1,rot.2,rot.3,rot.4,rot.5,rot.6,rot.7,rot.8",
        matrix,
    ),
    ("axis_x,axis_y,axis_z,angle_rad", axis_angle),
];

/// Computes the estimate from the text of a table. If this fails, uses the setting that the error message proposes, and
/// computes the estimate again.
fn followed(table: &str) -> Value {
    roll(table, "", None).unwrap_or_else(|message| {
        let found = roll(table, hint(&message), None);
        found.unwrap_or_else(|error| panic!("{message}\n{error}\n{table}"))
    })
}

/// Numbers above π cannot be rotations of a roll in rad, so the error message proposes degrees.
#[test]
fn rolls_without_a_unit_may_be_in_degrees() {
    let table = |unit: &str| {
        let header = format!("probe,rotation_x{unit},rotation_y{unit},shift_u_mm,shift_v_mm");
        format!(
            "{header}
0,0,-20,5,0
1,20,0,0,5
"
        )
    };
    let expected = roll(&table("_deg"), "", None).unwrap();
    assert_eq!(followed(&table("")), expected);
}

#[test]
fn the_same_rolls_in_each_form_have_one_estimate() {
    let header = "probe,rotation_x_rad,rotation_y_rad,rotation_z_rad,shift_u_mm,shift_v_mm";
    let expected = roll(&table(header, None, vector), "", None).unwrap();
    assert!((mean(&expected) - 0.025).abs() < 1e-12);
    let same = |found: Value, what: &str| {
        for quantity in [
            "normal_curvature_u",
            "normal_curvature_v",
            "gaussian_curvature",
        ] {
            let [found, expected] =
                [&found, &expected].map(|one| one[quantity]["value"].as_f64().unwrap());
            assert!(
                (found - expected).abs() < 1e-9,
                "{what} {quantity}: {found} {expected}"
            );
        }
    };
    let turned = UnitQuaternion::from_scaled_axis(Vector3::new(0.4, 1.1, -0.7));
    for (names, write) in FORMS {
        let rows = table(&format!("probe,{names},shift_u_mm,shift_v_mm"), None, write);
        same(followed(&rows), &rows);
        // The same table without its header contains only numbers, like an array.
        let bare = |table: &str| table.split_once('\n').unwrap().1.to_owned();
        same(followed(&bare(&rows)), &bare(&rows));
        let header = format!("probe,time_s,{names},contact_u_mm,contact_v_mm");
        for start in [UnitQuaternion::identity(), turned] {
            let series = table(&header, Some(start), write);
            let found = followed(&series);
            same(followed(&bare(&series)), &bare(&series));
            let warnings = found["warnings"].to_string();
            assert_eq!(
                warnings.contains("`rotation_frame` world"),
                start == turned,
                "{warnings}"
            );
            same(found, &series);
        }
    }
    // The rotations are stated in the axes of the world. Before the roll, the probe was turned by a quarter turn about
    // its normal, so the probe's axes differ from the axes of the world.
    let quarter = UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_2);
    let header = "probe,time_s,qx,qy,qz,qw,contact_u_mm,contact_v_mm";
    let series = table(header, Some(quarter), |rotation| {
        let quarter = UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_2);
        quaternion(quarter.inverse() * rotation * quarter)
    });
    same(
        roll(&series, "", Some(RotationFrame::World)).unwrap(),
        "world",
    );
    assert!(roll(&series, "", Some(RotationFrame::Probe)).is_err());
    let found = roll(&series, "", None).unwrap();
    assert!(
        found["warnings"]
            .to_string()
            .contains("`rotation_frame` world")
    );
    same(found, "world");
    // The columns are named as if the scalar part were last, but their numbers have the scalar part first.
    let swapped = table(
        "probe,qx,qy,qz,qw,shift_u_mm,shift_v_mm",
        None,
        scalar_first,
    );
    assert!(roll(&swapped, "", None).is_err());
    same(followed(&swapped), "swapped");
}

/// Rows with the orientation of the probe at the end of a roll, instead of the rotation since the start of the roll.
#[test]
fn orientations_are_no_rotations() {
    for start in [
        [0.5, 0.1, 0.0],
        [0.12, -0.05, 0.0],
        [0.01, 0.01, 0.0],
        [0.4, 1.1, -0.7],
        [0.0, 0.0, 1.5],
    ] {
        let start = UnitQuaternion::from_scaled_axis(Vector3::from(start));
        for (names, write) in [
            ("qx,qy,qz,qw", &quaternion as &dyn Fn(_) -> _),
            ("rotation_x_rad,rotation_y_rad,rotation_z_rad", &vector),
        ] {
            let header = format!("probe,{names},shift_u_mm,shift_v_mm\n");
            let row = |(probe, (turned, [u, v])): (usize, (Vector3<f64>, [f64; 2]))| {
                let numbers: Vec<f64> = write(start * UnitQuaternion::from_scaled_axis(turned));
                let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
                format!("{probe},{},{u},{v}\n", numbers.join(","))
            };
            let rows: String = rolls().into_iter().enumerate().map(row).collect();
            let found = roll(&(header + &rows), "", None);
            let error = found.map_or_else(|error| error, |found| found["warnings"].to_string());
            let is_named = ["since the start", "not-rolling"]
                .iter()
                .any(|words| error.contains(words));
            assert!(is_named, "{start}: {error}");
        }
    }
}

/// A probe of radius 10 mm that turns by 3.5 rad on a ball of radius 40 mm rolls over 28 mm.
#[test]
fn rotations_by_more_than_half_a_turn_are_not_shortened() {
    let rows = "probe,axis_x,axis_y,axis_z,angle_rad,shift_u_mm,shift_v_mm\n0,0,-1,0,3.5,28,0\n1,1,0,0,3.5,0,28\n";
    let header = "probe,time_s,rotation_x_rad,rotation_y_rad,contact_u_mm,contact_v_mm";
    let of_u = "0,0,0,0,0,0\n0,1,0,-1.75,14,0\n0,2,0,-3.5,28,0";
    let of_v = "1,0,0,0,0,0\n1,1,1.75,0,0,14\n1,2,3.5,0,0,28";
    // The same kind of roll by 0.7 rad, stated as a longer rotation about the opposite axis.
    let opposite = "probe,axis_x,axis_y,axis_z,angle_rad,shift_u_mm,shift_v_mm\n0,0,1,0,5.583185307179586,5.6,0\n1,-1,0,0,5.583185307179586,0,5.6\n";
    for text in [rows, opposite, &format!("{header}\n{of_u}\n{of_v}\n")] {
        assert!((mean(&roll(text, "", None).unwrap()) - 0.025).abs() < 1e-12);
    }
}

/// Each row of the table is for one time. It contains the orientations and contacts of all probes side by side.
#[test]
fn wide_tables_hold_rotations_of_several_probes() {
    for (parts, write) in [
        (&["qx", "qy", "qz", "qw"][..], quaternion as Write),
        (&["qw", "qx", "qy", "qz"], scalar_first),
    ] {
        let columns = parts.iter().chain(&["contact_u_mm", "contact_v_mm"]);
        let names = (0..6).flat_map(|probe| {
            columns
                .clone()
                .map(move |one| format!("probe{probe}_{one}"))
        });
        let mut wide = format!("time_s,{}\n", names.collect::<Vec<_>>().join(","));
        for step in 0..=4 {
            let share = f64::from(step) / 4.0;
            let row = rolls().into_iter().flat_map(|(turned, [u, v])| {
                let numbers = write(UnitQuaternion::from_scaled_axis(share * turned));
                numbers.into_iter().chain([share * u, share * v])
            });
            let row: Vec<String> = row.map(|number| number.to_string()).collect();
            wide += &format!("{share},{}\n", row.join(","));
        }
        let found = roll(&wide, "", None).unwrap_or_else(|error| panic!("{error}\n{wide}"));
        assert_eq!(found["probes"], 6);
        assert!((mean(&found) - 0.025).abs() < 1e-9, "{found}");
    }
}

#[test]
fn rolls_of_the_field_have_their_answer() {
    let log = include_str!("../data/rolls-quaternions.csv");
    let error = roll(log, "", None).unwrap_err();
    let hint = hint(&error);
    assert_eq!(hint, "contact_u=cop_x,contact_v=cop_y,probe=trial");
    // The columns of the log are in metres, but their names do not state this. So rename them.
    let in_metres = hint.replace("cop_x", "cop_x_m").replace("cop_y", "cop_y_m");
    let form = Form {
        length_unit: Some(LengthUnit::Mm),
        ..Form::default()
    };
    let log = log.replace("cop_x,cop_y", "cop_x_m,cop_y_m");
    let found = roll_in(&log, &in_metres, form).unwrap();
    assert_eq!(found["arc_length"]["unit"], "mm");
    assert!((mean(&found) - 0.04).abs() < 0.003, "{found}");
}

#[test]
fn unusable_rotations_are_refused_with_line_and_value() {
    let header = "probe,r11,r12,r13,r21,r22,r23,r31,r32,r33,shift_u_mm,shift_v_mm";
    let left = |rotation| matrix(rotation).iter().map(|number| -number).collect();
    let skewed = |rotation| matrix(rotation).iter().map(|number| 1.1 * number).collect();
    let long = |rotation| {
        quaternion(rotation)
            .iter()
            .map(|number| 1.1 * number)
            .collect()
    };
    for (table, words) in [
        (
            table(header, None, left),
            "r.csv:2: columns `r11` to `r33`: the matrix is left-handed, with a determinant of -1;",
        ),
        (
            table(header, None, skewed),
            "r.csv:2: columns `r11` to `r33`: the axes of a rotation matrix are orthogonal and of length 1; their products here differ by 0.21",
        ),
        (
            table("probe,qx,qy,qz,qw,shift_u_mm,shift_v_mm", None, long),
            "r.csv:2: columns `qx` to `qw`: a rotation needs a quaternion of length 1 within 0.001, but the length is 1.10000",
        ),
        (
            table(
                "probe,axis_x,axis_y,axis_z,angle_rad,shift_u_mm,shift_v_mm",
                None,
                |rotation| vec![1.0, 1.0, 0.0, rotation.angle()],
            ),
            "r.csv:2: columns `axis_x` to `axis_z`",
        ),
        (
            table("probe,r11,r12,r13,shift_u_mm,shift_v_mm", None, vector),
            "no columns `r21`, `r22`",
        ),
        (
            table(
                "header_stamp_secs,qx,qy,qz,qw,shift_u_mm,shift_v_mm",
                None,
                quaternion,
            ),
            "column `header_stamp_secs`: the rows may be a time series",
        ),
        (
            table(
                "probe,time_s,qx,qy,qz,qw,contact_u_mm,contact_v_cm",
                Some(UnitQuaternion::identity()),
                quaternion,
            ),
            "lengths are in mm and in cm",
        ),
    ] {
        let error = roll(&table, "", None).unwrap_err();
        assert!(error.contains(words), "{words}: {error}");
    }
    let quaternions = table("probe,qx,qy,qz,qw,shift_u_mm,shift_v_mm", None, quaternion);
    let error = roll(&quaternions, "rotation_x_rad=qx,rotation_y_rad=qy", None).unwrap_err();
    assert!(error.contains("which is part of a quaternion"), "{error}");
    // These rolls do not show whether the scalar part of the quaternion is the first or the last number. The message
    // must propose both orders, and the table must be readable with each.
    let two =
        "probe,q0,q1,q2,q3,shift_u_mm,shift_v_mm\n0,0.7,0.1,0.1,0.7,1,0\n1,0.7,0.1,-0.1,0.7,0,1\n";
    let error = roll(two, "", None).unwrap_err();
    assert!(
        error.contains("'qx=q1,qy=q2,qz=q3,qw=q0' or 'qx=q0,qy=q1,qz=q2,qw=q3'"),
        "{error}"
    );
    // A time series needs columns with the position of the contact. The message proposes the columns of shifts instead,
    // and this proposal must work.
    let header = "probe,time_s,qx,qy,qz,qw,shift_u_mm,shift_v_mm";
    let series = table(header, Some(UnitQuaternion::identity()), quaternion);
    let error = roll(&series, "", None).unwrap_err();
    assert!((mean(&followed(&series)) - 0.025).abs() < 1e-9, "{error}");
    // Each row of this file is a roll, although it has a column of times.
    let timed = table("time,qx,qy,qz,qw,shift_u_mm,shift_v_mm", None, quaternion);
    assert!((mean(&followed(&timed)) - 0.025).abs() < 1e-9);
    // In this file, the times increase from roll to roll, so only the column that counts the rolls can separate them.
    // The user must assign this column to `probe`.
    let start = Some(UnitQuaternion::identity());
    let counted = table(
        "trial,stamp,qx,qy,qz,qw,contact_u,contact_v",
        start,
        quaternion,
    );
    let error = roll(&counted, "", None).unwrap_err();
    assert_eq!(hint(&error), "t_s=stamp,probe=trial");
    let error = roll(&counted, "t_s=stamp", None).unwrap_err();
    assert_eq!(hint(&error), "probe=trial");
    assert!((mean(&followed(&counted)) - 0.025).abs() < 1e-9, "{error}");
    // An estimate from rolls needs the positions of the contact on the probe. This file has only the positions of the
    // tip.
    let poses = table(
        "probe,time_s,x,y,z,qx,qy,qz,qw,seen,valid",
        Some(UnitQuaternion::identity()),
        |rotation| [vector(rotation), quaternion(rotation)].concat(),
    );
    let error = roll(&poses, "", None).unwrap_err();
    assert!(error.contains("no contacts on the probe"), "{error}");
}
