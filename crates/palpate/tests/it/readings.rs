//! Makes tables of readings, and computes estimates from them with the library.

use palpate::config::LengthUnit;
use palpate::recorded::{
    Form, GlideOptions, GlideRecording, PressOptions, PressRecording, RecordedFile, RollOptions,
    RollRecording, column_names, estimate_glide, estimate_press, estimate_roll,
};
use serde::Serialize;
use serde_json::Value;

/// Rolls of a ball of radius 10 on a ball of radius 20. After 0.3 rad, the contact has moved by 0.3 / (1/10 + 1/20) =
/// 2.
pub(crate) const ROLLS: &str = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n\
                     0,0,-0.3,2.125,0.25\n1,0.3,0,-0.25,2.125\n2,0,0.3,-2,0\n3,-0.3,0,0,-2\n";
pub(crate) const ROLL: &str = include_str!("../../../../examples/roll-readings.csv");
pub(crate) const GLIDE: &str = include_str!("../../../../examples/glide-readings.csv");
pub(crate) const PRESS: &str = include_str!("../../../../examples/press-readings.csv");

/// A table format with these column names, written as in `--columns`.
pub(crate) fn named(columns: &str) -> Form {
    let columns = column_names(columns).unwrap();
    Form {
        columns,
        ..Form::default()
    }
}

/// An estimate as JSON, or the text of the error that prevented it.
type Estimated = Result<Value, String>;

fn json<T: Serialize>(estimate: Result<T, impl ToString>) -> Estimated {
    let estimate = estimate.map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(estimate).unwrap())
}

fn file(contents: impl AsRef<[u8]>, form: Form) -> RecordedFile {
    let mut file = RecordedFile::new("r.csv", contents.as_ref().to_vec());
    file.form = form;
    file
}

/// Copies of the table format `form`, each with one setting that a message proposes.
fn proposed(message: &str, form: &Form) -> Vec<Form> {
    let mut forms = Vec::new();
    for part in message.split("setting `").skip(1) {
        let (key, rest) = part.split_once("` ").unwrap_or_default();
        // A message separates alternatives by "or": 'x=a' or 'x=b'.
        for one in rest.split(" or ") {
            let quoted = one
                .strip_prefix('\'')
                .and_then(|one| one.split('\'').next());
            let word = one.split([' ', ';']).next().unwrap_or_default();
            let mut form = form.clone();
            match (key, quoted) {
                ("columns", Some(columns)) => {
                    form.columns.extend(column_names(columns).expect(message))
                }
                ("delimiter", _) => form.delimiter = word.parse().ok(),
                ("decimal", _) => form.decimal = word.parse().ok(),
                ("length_unit", _) if word == "mm" => form.length_unit = Some(LengthUnit::Mm),
                ("rotation_frame", _) => form.rotation_frame = word.parse().ok(),
                _ => break,
            }
            forms.push(form);
        }
    }
    forms
}

/// The estimate from a table with the format `form`. If a message proposes a setting, an estimate with this setting
/// must not fail with the same message, and the setting must name columns of the file.
fn estimated(form: Form, estimate: impl Fn(Form) -> Estimated) -> Estimated {
    let found = estimate(form.clone());
    let message = match &found {
        Ok(found) => warnings(found).join("; "),
        Err(error) => error.clone(),
    };
    for proposed in proposed(&message, &form) {
        if let Err(again) = estimate(proposed) {
            assert_ne!(again, message);
            assert!(!again.contains("`columns` assigns `"), "{message}\n{again}");
        }
    }
    found
}

/// Estimate from rolls of a probe with radius 10.
pub(crate) fn roll(contents: impl AsRef<[u8]>, form: Form) -> Estimated {
    estimated(form, |form| {
        let options = RollOptions {
            length_unit: form.length_unit,
            ..RollOptions::new(10.0)
        };
        let readings = RollRecording::try_from(file(&contents, form));
        json(readings.and_then(|readings| estimate_roll(readings, &options)))
    })
}

pub(crate) fn glide(contents: impl AsRef<[u8]>, form: Form) -> Estimated {
    estimated(form, |form| {
        let readings = GlideRecording::try_from(file(&contents, form));
        let options = GlideOptions::default();
        let fitted = readings.and_then(|readings| estimate_glide(&readings, &options));
        json(fitted.map(|(estimate, _)| estimate))
    })
}

/// Estimate from a press with a sensor of radius 20 and markers at a depth of 2.
pub(crate) fn press(contents: impl AsRef<[u8]>, form: Form) -> Estimated {
    let options = PressOptions {
        marker_depth: Some(2.0),
        ..PressOptions::new(20.0)
    };
    estimated(form, |form| {
        let readings = PressRecording::try_from(file(&contents, form));
        json(readings.and_then(|readings| estimate_press(&readings, &options)))
    })
}

/// Checks that tables are rejected. Each row of `list` is `edit | columns | :line | words of the expected error`. An
/// edit is either `text => replacement` in the table `base`, or a whole table; `\n` and `\r` end lines. `columns` is
/// the value of `--columns`, or `-` for none.
pub(crate) fn refuses(estimate: fn(&str, Form) -> Estimated, base: &str, list: &str) {
    let mut wrong = Vec::new();
    for row in list.trim().lines() {
        let columns: Vec<&str> = row.split(" | ").collect();
        let [edit, columns, line, words] = columns[..] else {
            panic!("{row}")
        };
        let edit = edit.replace("\\n", "\n").replace("\\r", "\r");
        let table = match edit.split_once(" => ") {
            Some((from, to)) => super::desk::edited(base, from, to),
            None => edit,
        };
        let form = match columns {
            "-" => Form::default(),
            columns => named(columns),
        };
        let error = estimate(&table, form).expect_err(row);
        let place = format!("r.csv{}: ", line.trim_start_matches('-'));
        if !error.starts_with(&place) || !error.contains(words) {
            wrong.push(format!("{row}\n{error}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

pub(crate) fn mean_curvature(estimate: &Value) -> f64 {
    estimate["mean_curvature"]["value"].as_f64().unwrap()
}

pub(crate) fn warnings(estimate: &Value) -> Vec<&str> {
    let all = estimate["warnings"].as_array().unwrap().iter();
    all.map(|warning| warning["text"].as_str().unwrap())
        .collect()
}

pub(crate) fn scaled(csv: &str, columns: &[usize], factor: f64) -> String {
    changed(csv, |fields| {
        for &column in columns {
            let number: f64 = fields[column].parse().unwrap();
            fields[column] = (number * factor).to_string();
        }
    })
}

pub(crate) fn changed(csv: &str, change: impl Fn(&mut Vec<String>)) -> String {
    let (header, rows) = csv.split_once('\n').unwrap();
    let row = |line: &str| {
        let mut fields = line.split(',').map(str::to_owned).collect();
        change(&mut fields);
        format!("{}\n", fields.join(","))
    };
    format!("{header}\n{}", rows.lines().map(row).collect::<String>())
}
