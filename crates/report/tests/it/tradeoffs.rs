//! Tests the tables of speed and accuracy, and the sections of the page that show them.

use crate::fixture::{Cells, NO_FAILURES, Numbers, config, says};
use palpate_report::{Files, Study, page, tradeoff_figures};
use std::fs;
use std::path::Path;

const LADDERS: &str = "ladder,title,error_of,evaluation,scene,what,machine
rolling,What does a roll cost?,error of the place,one roll,easy,a ball,a processor of 2 cores
rolling,What does a roll cost?,error of the place,one roll,hard,an ellipsoid,a processor of 2 cores
";
const RUNGS: &str =
    "ladder,scene,rung,setting,error,error_std,median_ns,q25_ns,q75_ns,instructions,pareto
rolling,easy,closed form,,2.2e-16,,40,39,41,200,true
rolling,easy,RK4 × 1,1,1e-3,,80,79,81,500,false
rolling,hard,RK4 × 1,1,0.2,,90,89,91,600,true
rolling,hard,RK4 × 8,8,1e-4,,900,899,901,6000,true
";
const ANSWERS: &str = "ladder,scene,target,rung,error,median_ns,instructions
rolling,easy,10 %,closed form,2.2e-16,40,200
rolling,easy,1e-6,closed form,2.2e-16,40,200
rolling,hard,10 %,RK4 × 8,1e-4,900,6000
rolling,hard,1e-6,none,,,
";
fn tables(rungs: &str) -> [(&'static str, String); 3] {
    [
        ("ladders.csv", LADDERS.to_owned()),
        ("rungs.csv", rungs.to_owned()),
        ("answers.csv", ANSWERS.to_owned()),
    ]
}

fn fill(folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    for (name, text) in tables(RUNGS) {
        fs::write(folder.join(name), text).unwrap();
    }
}

fn drawn(rungs: &str) -> String {
    let mut figures = tradeoff_figures(&Files::in_memory(tables(rungs))).unwrap();
    assert_eq!((figures.len(), figures[0].name.as_str()), (1, "rolling"));
    figures.remove(0).svg
}

#[test]
fn without_instructions_the_axis_is_time() {
    says(
        &drawn(&RUNGS.replace(",6000,", ",,")),
        &["cost of one roll (ns)"],
    );
}

#[test]
fn an_error_that_a_log_axis_cannot_show_is_named() {
    for value in ["0", "-1", "NaN", "inf", ""] {
        let rungs = RUNGS.replace(",0.2,", &format!(",{value},"));
        let error = tradeoff_figures(&Files::in_memory(tables(&rungs))).unwrap_err();
        says(&error.to_string(), &["line 4, column \"error\""]);
    }
}

#[test]
fn the_page_reports_the_check_of_auto() {
    let results = tempfile::tempdir().unwrap();
    let study = || study_in(results.path());
    let folder = results.path().join("tradeoff");
    fill(&folder);
    let write = |rows: &str| {
        let table = format!("kind,scene,competitors,ratio,kept\n{rows}");
        fs::write(folder.join("promise.csv"), table).unwrap();
    };
    write("roll,0,3,1.284,yes\nroll,1,0,1.0,yes\nroll,2,1,2.5,no\npress,0,0,,no\n");
    let html = page(&[study()]).unwrap();
    for part in [
        "roll: kept on 2 of 3 random scenes; on 2 another rung would do; at most 2.50 times the cheapest.",
        "press: kept on 0 of 1 random scenes; on 0 another rung would do.",
    ] {
        assert!(html.contains(part), "{part}\n{html}");
    }
    for (row, wrong) in [
        ("roll,0,many,1,yes", "competitors"),
        ("roll,0,1,inf,yes", "ratio"),
        ("roll,0,1,1,perhaps", "kept"),
    ] {
        write(row);
        let error = page(&[study()]).unwrap_err();
        says(&error.to_string(), &[&format!("column {wrong:?}")]);
    }
}

fn study_in(results: &Path) -> Study {
    let mut cells = Cells::new("scene.object.radius_cm");
    cells.push("5", Numbers::new(0.2, 0.1));
    let folder = results.join("study");
    fs::create_dir_all(&folder).unwrap();
    for (name, text) in [
        ("run.toml", config("sphere", "")),
        ("cells.csv", cells.text()),
        ("failures.csv", NO_FAILURES.to_owned()),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    Study::read(Files::in_folder(&folder)).unwrap()
}
