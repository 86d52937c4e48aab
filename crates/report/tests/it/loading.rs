//! Tests that invalid input is rejected. The error must name the file, and the position in this file.

use crate::fixture::{Cells, NO_FAILURES, Numbers, config, drawn, says, study};
use palpate_report::{Files, Study};
use std::fs;

fn good() -> String {
    let mut cells = Cells::new("scene.object.radius_cm");
    cells.push("5", Numbers::new(0.2, 0.1));
    cells.push("1", Numbers::new(1.0, 0.1));
    cells.text()
}

fn error(config: &str, cells: &str, failures: &str) -> String {
    let files = [
        ("run.toml", config),
        ("cells.csv", cells),
        ("failures.csv", failures),
    ];
    Study::read(Files::in_memory(files))
        .unwrap_err()
        .to_string()
}

fn error_of_cells(cells: &str) -> String {
    error(&config("sphere", ""), cells, NO_FAILURES)
}

#[test]
fn a_table_may_lack_how_exact_its_errors_are() {
    let lacking = ["rms_error_std", "coverage50", "coverage80"];
    let cells = good();
    let header: Vec<&str> = cells.lines().next().unwrap().split(',').collect();
    let kept = |line: &str| {
        let fields = line.split(',').zip(&header);
        let fields = fields.filter(|(_, name)| !lacking.contains(name));
        fields.map(|(field, _)| field).collect::<Vec<_>>().join(",") + "\n"
    };
    let cells: String = cells.lines().map(kept).collect();
    assert!(!drawn(&study(&config("sphere", ""), &cells, NO_FAILURES, &[])).is_empty());
}

#[test]
fn a_byte_order_mark_and_crlf_do_no_harm() {
    let cells = format!("\u{feff}{}", good().replace('\n', "\r\n"));
    let failures = "\u{feff}cell,kind,count,first_trial\r\n";
    assert!(!drawn(&study(&config("sphere", ""), &cells, failures, &[])).is_empty());
}

#[test]
fn missing_files_are_named() {
    let files = [
        ("run.toml", config("sphere", "")),
        ("cells.csv", good()),
        ("failures.csv", NO_FAILURES.to_owned()),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for (name, text) in &files {
        fs::write(path(name), text).unwrap();
    }
    assert_eq!(
        Study::read(Files::in_folder(folder.path())).unwrap().dir(),
        folder.path()
    );
    for (name, text) in &files {
        fs::remove_file(path(name)).unwrap();
        let error = Study::read(Files::in_folder(folder.path()))
            .unwrap_err()
            .to_string();
        says(&error, &[&path(name).display().to_string(), "No such file"]);
        fs::write(path(name), text).unwrap();
        let others = files.clone().into_iter().filter(|(other, _)| other != name);
        let error = Study::read(Files::in_memory(others))
            .unwrap_err()
            .to_string();
        says(&error, &[name, "not found"]);
    }
}

#[test]
fn bad_tables_are_named() {
    let change = |from: &str, to: &str| good().replacen(from, to, 1);
    let header = good().lines().next().unwrap().to_owned();
    let short = format!("{header}\n0,5,q,u,1\n");
    for (cells, parts) in [
        (String::new(), &["cells.csv", "empty"][..]),
        (header, &["cells.csv", "empty"]),
        (
            change("rms_error", "rmserror"),
            &["cells.csv", "\"rms_error\"", "rmserror"],
        ),
        (change("quantity", "what"), &["\"quantity\""]),
        (change("quantity,unit", "unit,quantity"), &["\"unit\""]),
        (change("q50", "q05"), &["\"q05\"", "twice"]),
        (change("\n1,1,", "\none,1,"), &["line 3", "\"cell\"", "one"]),
        (change("0.2,", "lots,"), &["line 2", "\"truth\"", "lots"]),
        (change("0.2,", "inf,"), &["line 2", "\"truth\"", "inf"]),
        (short, &["cells.csv", "line: 2"]),
    ] {
        says(&error_of_cells(&cells), parts);
    }
    for (failures, parts) in [
        ("", &["failures.csv", "empty"][..]),
        ("cell,kind,first_trial\n", &["failures.csv", "\"count\""]),
        (
            "cell,kind,count,first_trial\n0,unresolved,-1,0\n",
            &["failures.csv", "line 2", "\"count\"", "-1"],
        ),
    ] {
        says(&error(&config("sphere", ""), &good(), failures), parts);
    }
}

#[test]
fn bad_configs_are_named() {
    for (config, parts) in [
        ("name = ", &["run.toml", "line 1"][..]),
        ("title = \"x\"", &["run.toml", "name", "missing"]),
        ("name = 3", &["run.toml", "name", "3"]),
        ("name = \"x\"\nclaims = [-1]", &["run.toml", "claims", "-1"]),
    ] {
        says(&error(config, &good(), NO_FAILURES), parts);
    }
}
