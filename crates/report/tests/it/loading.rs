//! Bad input: the error names the file and the place.

use crate::fixture::{Cells, Numbers, STATISTICS, config, folder};
use palpate_report::Study;
use std::fs;

const NO_FAILURES: &str = "cell,kind,count,first_trial\n";

fn good() -> String {
    let mut cells = Cells::new("scene.object.radius_cm");
    cells.push("5", Numbers::new(0.2, 0.1));
    cells.push("1", Numbers::new(1.0, 0.1));
    cells.text()
}

fn error(config: &str, cells: &str, failures: &str) -> String {
    let dir = folder(config, cells, failures);
    Study::load(dir.path()).unwrap_err().to_string()
}

fn error_of_cells(cells: &str) -> String {
    error(&config("sphere", ""), cells, NO_FAILURES)
}

#[track_caller]
fn says(error: &str, parts: &[&str]) {
    for part in parts {
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
}

#[test]
fn a_good_folder_loads() {
    let dir = folder(
        &config("sphere", "claims = [1]"),
        &good(),
        "cell,kind,count,first_trial\n1,unresolved,3,7\n",
    );
    let study = Study::load(dir.path()).unwrap();
    assert_eq!(
        (study.name(), study.title(), study.source()),
        ("study", "A question?", "somewhere")
    );
    assert_eq!(study.claims(), [1]);
    assert_eq!(study.cells().rows(), 2);
    assert_eq!(study.cells().statistic(0, "truth"), Some(0.2));
    assert_eq!(study.cells().statistic(0, "q05"), None);
    assert_eq!(study.number(1, "scene.object.radius"), Some(1.0));
    assert_eq!(study.number(1, "scene.object.radius_cm"), Some(1.0));
    assert_eq!(study.number(1, "scene.probe.radius"), Some(1.0));
    assert_eq!(study.number(1, "scene.probe.kind"), None);
    assert_eq!(study.failures()[0].first_trial, 7);
}

#[test]
fn a_byte_order_mark_and_crlf_do_no_harm() {
    let cells = format!("\u{feff}{}", good().replace('\n', "\r\n"));
    let dir = folder(
        &config("sphere", ""),
        &cells,
        "\u{feff}cell,kind,count,first_trial\r\n",
    );
    assert_eq!(Study::load(dir.path()).unwrap().cells().rows(), 2);
}

#[test]
fn missing_files_are_named() {
    for name in ["run.toml", "cells.csv", "failures.csv"] {
        let dir = folder(&config("sphere", ""), &good(), NO_FAILURES);
        fs::remove_file(dir.path().join(name)).unwrap();
        says(
            &Study::load(dir.path()).unwrap_err().to_string(),
            &[name, "No such file"],
        );
    }
}

#[test]
fn empty_tables_are_refused() {
    says(&error_of_cells(""), &["cells.csv", "empty"]);
    says(
        &error_of_cells(good().lines().next().unwrap()),
        &["cells.csv", "empty"],
    );
    says(
        &error(&config("sphere", ""), &good(), ""),
        &["failures.csv", "empty"],
    );
}

#[test]
fn missing_and_repeated_columns_are_named() {
    says(
        &error_of_cells(&good().replacen("rms_error", "rmserror", 1)),
        &["cells.csv", "\"rms_error\"", "rmserror"],
    );
    says(
        &error_of_cells(&good().replacen("quantity", "what", 1)),
        &["\"quantity\""],
    );
    says(
        &error_of_cells(&good().replacen("q50", "q05", 1)),
        &["\"q05\"", "twice"],
    );
    says(
        &error(&config("sphere", ""), &good(), "cell,kind,first_trial\n"),
        &["failures.csv", "\"count\""],
    );
}

#[test]
fn a_bad_number_is_named_with_its_place() {
    for value in ["lots", "NaN", "inf", "1,5"] {
        let cells = good().replacen("0.2,100", &format!("\"{value}\",100"), 1);
        says(
            &error_of_cells(&cells),
            &["cells.csv", "line 2", "\"truth\"", value],
        );
    }
    let cells = good().replace("\n1,1,", "\none,1,");
    says(&error_of_cells(&cells), &["line 3", "\"cell\"", "one"]);
    let failures = "cell,kind,count,first_trial\n0,unresolved,-1,0\n";
    says(
        &error(&config("sphere", ""), &good(), failures),
        &["failures.csv", "line 2", "\"count\"", "-1"],
    );
}

#[test]
fn a_short_row_is_named_with_its_line() {
    let cells = format!("cell,scene.x,quantity,unit,{STATISTICS}\n0,1,q,u,1\n");
    says(&error_of_cells(&cells), &["cells.csv", "line: 2"]);
}

#[test]
fn bad_configs_are_named() {
    says(
        &error("name = ", &good(), NO_FAILURES),
        &["run.toml", "line 1"],
    );
    says(
        &error("title = \"x\"", &good(), NO_FAILURES),
        &["run.toml", "name", "missing"],
    );
    says(
        &error("name = 3", &good(), NO_FAILURES),
        &["run.toml", "name", "3"],
    );
    says(
        &error("name = \"x\"\nclaims = [-1]", &good(), NO_FAILURES),
        &["run.toml", "claims", "-1"],
    );
}
