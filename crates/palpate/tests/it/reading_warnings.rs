//! Tests warnings about recorded readings. Also tests settings that are rejected because they contradict the readings.

use palpate::recorded::Form;
use serde_json::Value;

use super::desk::{Desk, with_flags};
use super::readings::{GLIDE, PRESS, ROLL, changed, glide, press, roll, scaled, warnings};

/// Each row: options of a command | words of its warning, or `[]` if it must print no warning.
const PRESSES: &str = r#"
 | at the skin's surface
--depth 0 | []
--depth 2 | []
--depth 2 --method gaussian --c 1 | a Gaussian is no elastic body
--depth 2 --indentation 1.5 --indentation-std 0.02 | []
--depth 2 --indentation 1.5 | without a standard deviation
--depth 2 --indentation 1.5 --indentation-std 0 | without a standard deviation
--depth 2 --indentation 1 --indentation-std 0.02 | but the readings show 1.43 mm
--depth 2 --indentation 1 | "code":"stated-indentation"
--depth 2 --indentation 3 | "code":"stated-indentation"
--depth 2 --normal-std 0.0385 --tangential-std 0.0155 | "code":"poor-fit"
--depth 2 --indentation 1.7 --indentation-std 0.02 | the curvature is not reliable
--depth 2 --indentation 15 | but the readings show
--depth 2 --indentation 2 --indentation-std 1e-6 | a marker at the contact itself (row 1, line 2)
--depth 2 --normal-std 0.01 | stated as 0.01 mm
--depth 2 --normal-std 0.5 --tangential-std 0.2 | stated as 0.5 mm
--depth 2 --normal-std 5 --tangential-std 5 | no marker moved by more than
"#;
const ROLLS: &str = "
--pitch 0.5 | []
--shift-std 1e-300 | larger than the noise explains
--rotation-std-rad 0.01 | []
--rotation-std-rad 0.5 | roll further, or measure the rotations more exactly
";
const GLIDES: &str = "
--method two-pass --inter-finger-distance 1000 | the fingers of the readings are
--method two-pass --inter-finger-distance 0.01 | is the unit right?
--method quadric --position-std 0.5 --normal-std-deg 2 | []
--method quadric --position-std 5 | stated as 5 mm, but the readings show 0.4
--method quadric --position-std 0.01 | stated as 0.01 mm
--method quadric --position-fraction-of-ifd 0.03 | []
--method quadric --position-fraction-of-ifd 0.5 | stated as 6.9 mm
--method quadric --position-fraction-of-ifd 0.05 --inter-finger-distance 100 | stated as 5 mm
--method quadric --position-fraction-of-ifd 0.05 --inter-finger-distance 100 | 100 mm, but the fingers of the readings are 13.8
--method quadric --normal-std-deg 20 | stated as 20 degrees, but the readings show 1.9
";

#[test]
fn stated_values_that_contradict_the_readings_cause_warnings() {
    let desk = Desk::new();
    for (command, readings, table) in [
        ("press r.csv --sensor-radius 20", PRESS, PRESSES),
        ("roll r.csv --probe-radius 10", ROLL, ROLLS),
        ("glide r.csv", GLIDE, GLIDES),
    ] {
        desk.write("r.csv", readings);
        for row in table.trim_matches('\n').lines() {
            let (options, words) = row.split_once(" | ").unwrap();
            let ended = desk.palpate(&format!("estimate {command} {options}"));
            let message = if ended.status == Some(0) {
                let json: Value = serde_json::from_str(&ended.stdout).unwrap();
                assert_eq!(json["format_version"], 2);
                // The warnings are also printed on standard error.
                let lines = warnings(&json)
                    .into_iter()
                    .map(|warning| format!("warning: {}\n", with_flags(warning)));
                assert_eq!(ended.stderr, lines.collect::<String>());
                json["warnings"].to_string()
            } else {
                ended.said(1)
            };
            let is_right = message.contains(words) && !message.contains("inf ");
            assert!(is_right, "{row}: {message}");
        }
    }
}

/// Without a stated standard deviation, the indentation has a standard deviation of 2 %. For 1.5 mm, this is 0.03 mm.
#[test]
fn an_indentation_is_never_exact() {
    let desk = Desk::new();
    desk.write("r.csv", PRESS);
    let [bare, stated] = ["", "--indentation-std 0.03"].map(|std| {
        let options = format!("--sensor-radius 20 --depth 2 --indentation 1.5 {std}");
        desk.json(&format!("estimate press r.csv {options}"))
    });
    assert_eq!(bare["object_curvature"], stated["object_curvature"]);
    let warnings = bare["warnings"].to_string();
    assert!(!warnings.contains("stated-indentation"), "{bare}");
}

/// Warnings of an estimate, or its error, as text.
fn warnings_or_error(estimated: Result<Value, String>) -> String {
    estimated.map_or_else(|error| error, |json| warnings(&json).join("; "))
}

fn of_roll(table: &str) -> String {
    warnings_or_error(roll(table, Form::default()))
}

fn of_glide(table: &str) -> String {
    warnings_or_error(glide(table, Form::default()))
}

fn of_press(table: &str) -> String {
    warnings_or_error(press(table, Form::default()))
}

/// Each row: columns that are multiplied by a factor | the factor | words of the expected warning or error.
const PRESS_MISTAKES: &str = "
3 | -1 | the sign of tangential_x reversed
4 | -1 | the sign of tangential_y reversed
3 4 | -1 | both signs reversed
2 | -1 | is the sign wrong?
2 3 4 | 50 | more than the sensor's radius
0 1 2 3 4 | 1e-3 | the readings in m and the radius in mm?
2 3 4 | 1e-3 | the displacements in m and the rest in mm?
0 1 | 1e3 | half the circumference
";
const ROLL_MISTAKES: &str = "
3 | 0.1 | times as far in one direction as in another
1 2 | 57.296 | the rotations in degrees
1 2 | 1e-3 | in a smaller unit
1 2 | 0.01745 | in rad although
1 2 | 1e3 | or mrad
1 2 | 0 | all rotations from the start to the end of a roll are 0
3 4 | 1e-3 | the shifts in a larger unit
3 4 | 1e3 | half of the probe's circumference
";
const GLIDE_MISTAKES: &str = "
4 5 6 | 57.296 | lengths of about 57.3
4 5 6 | -1 | point to -z
1 2 3 | 1e-3 | are their positions in mm?
1 | 1e-3 | x has a range of only
2 | 1e-3 | y has a range of only
";

#[test]
fn wrong_signs_units_and_orders_cause_warnings() {
    let swapped = changed(PRESS, |fields| fields.swap(3, 4));
    assert!(of_press(&swapped).contains("tangential_x and tangential_y swapped"));
    for (of, csv, mistakes) in [
        (of_press as fn(&str) -> String, PRESS, PRESS_MISTAKES),
        (of_roll, ROLL, ROLL_MISTAKES),
        (of_glide, GLIDE, GLIDE_MISTAKES),
    ] {
        assert_eq!(of(csv), "");
        for row in mistakes.trim().lines() {
            let (columns, rest) = row.split_once(" | ").unwrap();
            let (factor, words) = rest.split_once(" | ").unwrap();
            let columns = columns.split(' ').map(|column| column.parse().unwrap());
            let columns: Vec<usize> = columns.collect();
            let message = of(&scaled(csv, &columns, factor.parse().unwrap()));
            assert!(message.contains(words), "{row}: {message}");
        }
    }
}

#[test]
fn implausible_rows_cause_warnings() {
    let line: String = (-6..6)
        .map(|x| format!("0,{x},0,{}\n", -0.01 * f64::from(x * x)))
        .collect();
    let metres: String = (0..36)
        .map(|row| {
            let [x, y] = [row % 12 - 6, row / 12 - 1].map(f64::from);
            format!(
                "{},{x},{},{}\n",
                row / 12,
                5e-3 * y,
                -0.01 * x * x - 0.25 * y * y
            )
        })
        .collect();
    let (first, rest) = GLIDE.split_once('\n').unwrap();
    let (row, rest) = rest.split_once('\n').unwrap();
    let inward = scaled(&format!("{first}\n{row}\n"), &[4, 5, 6], -1.0);
    for (table, words) in [
        (format!("{GLIDE}0,60,0,0,0,0,1\n"), "(far from all others)"),
        (
            format!("{first}\n0,0,0,0,0,0,1\n1,5,0,-0.3,0.1,0,1\n2,0,5,-0.3,0,0.1,1\n"),
            "do not determine their noise",
        ),
        (format!("finger,x_mm,y_mm,z_mm\n{line}"), "along one curve"),
        (
            format!("finger,x_mm,y_mm,z_mm\n{metres}"),
            "y has a range of only",
        ),
        (format!("{inward}{rest}"), "does its normal point inward?"),
    ] {
        let said = of_glide(&table);
        assert!(said.contains(words), "{words}: {said}");
    }
}
