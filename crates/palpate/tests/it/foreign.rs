//! Tables of other programs, and what `palpate estimate` makes of them.

use serde_json::Value;

use super::desk::Desk;

/// Rolls of a ball of radius 10 on one of radius 20: 0.3 turns into 0.3 / (1/10 + 1/20) = 2.
pub(crate) const ROLLS: &str = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n\
                     0,0,-0.3,2.125,0.25\n1,0.3,0,-0.25,2.125\n2,0,0.3,-2,0\n3,-0.3,0,0,-2\n";

/// Desk with a file of readings.
pub(crate) fn desk(contents: impl AsRef<[u8]>) -> Desk {
    let desk = Desk::new();
    desk.write("r.csv", contents);
    desk
}

/// JSON that a line of the shell prints.
#[track_caller]
pub(crate) fn told(desk: &Desk, line: &str) -> Value {
    serde_json::from_str(&desk.shell(line).printed()).unwrap()
}

/// Estimate of rolls in `r.csv`.
#[track_caller]
pub(crate) fn rolls(contents: impl AsRef<[u8]>, options: &str) -> Value {
    told(
        &desk(contents),
        &format!("\"$palpate\" estimate roll r.csv --probe-radius 10 {options}"),
    )
}

/// Message about `r.csv`, which is no table of rolls.
#[track_caller]
pub(crate) fn refused(contents: impl AsRef<[u8]>, options: &str) -> String {
    let line = format!("\"$palpate\" estimate roll r.csv --probe-radius 10 {options}");
    let said = desk(contents).shell(&line).said(1);
    said.strip_prefix("error: ").unwrap().trim_end().to_owned()
}

#[track_caller]
pub(crate) fn mean_curvature(estimate: &Value) -> f64 {
    estimate["mean_curvature"]["value"].as_f64().unwrap()
}

pub(crate) fn warnings(estimate: &Value) -> Vec<&str> {
    let all = estimate["warnings"].as_array().unwrap();
    all.iter()
        .map(|warning| warning["text"].as_str().unwrap())
        .collect()
}
