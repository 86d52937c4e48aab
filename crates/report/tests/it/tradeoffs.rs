//! Tables of speed against accuracy, and the sections that the page makes from them.

use crate::fixture::{Cells, NO_FAILURES, Numbers, config, says};
use palpate_report::{Files, ReportError, Study, page, tradeoff_figures};
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
const STAGES: &str = "scene,stage,median_ns,random_draws
roll,ideal,40,0
roll,noise,90,16
";

/// Tables with these rungs, by name.
fn tables(rungs: &str) -> [(&'static str, String); 4] {
    [
        ("ladders.csv", LADDERS.to_owned()),
        ("rungs.csv", rungs.to_owned()),
        ("answers.csv", ANSWERS.to_owned()),
        ("stages.csv", STAGES.to_owned()),
    ]
}

fn fill(folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    for (name, text) in tables(RUNGS) {
        fs::write(folder.join(name), text).unwrap();
    }
}

/// The only ladder as SVG.
fn drawn(rungs: &str) -> String {
    let mut figures = tradeoff_figures(&Files::in_memory(tables(rungs))).unwrap();
    assert_eq!((figures.len(), figures[0].name.as_str()), (1, "rolling"));
    figures.remove(0).svg
}

#[test]
fn a_bar_shows_how_far_trials_leave_an_error_open() {
    let bars = "Bars, where longer than their marker";
    assert!(!drawn(RUNGS).contains(bars));
    let plain = drawn(RUNGS).matches("<polyline").count();
    // Two errors have a standard error. The bar of one is shorter than its marker and is not drawn.
    let open = RUNGS
        .replace(",0.2,,", ",0.2,0.09,")
        .replace(",1e-4,,", ",1e-4,1e-7,");
    let svg = drawn(&open);
    assert!(svg.contains(bars), "{svg}");
    // A stroke and two caps.
    assert_eq!(svg.matches("<polyline").count(), plain + 3, "{svg}");
}

#[test]
fn a_picture_names_every_rung_that_has_room() {
    let svg = drawn(RUNGS);
    let texts = [
        "easy: a ball",
        "hard: an ellipsoid",
        "error of the place (no unit)",
        "cost of one roll (instructions)",
        "closed form",
        "RK4 × 8",
    ];
    says(&svg, &texts);
    // This rung is not on the front of the easy scene, but on that of the hard one.
    assert_eq!(svg.matches("RK4 × 1\n").count(), 2, "{svg}");
    assert_eq!(svg.matches("><title>RK4 × 1</title></polygon>").count(), 1);
    assert_eq!(svg.matches("<title>").count(), 1);
    // The key shows the name of the family.
    assert_eq!(svg.matches("RK4\n").count(), 1, "{svg}");
    assert!(!svg.contains("off the scale"));
}

#[test]
fn a_rung_off_the_scale_is_shown_as_such() {
    let rungs = RUNGS.replace(",1e-3,", ",345.6,").replace(",0.2,", ",12,");
    let texts = [
        "Points below an arrow are off the scale: they err by more than 10.",
        "><title>RK4 × 1, errs by 346</title></polygon>",
        "RK4 × 1, errs by 12\n",
    ];
    says(&drawn(&rungs), &texts);
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
        let named =
            matches!(&error, ReportError::BadCell { line: 4, column, .. } if column == "error");
        assert!(named, "{value}: {error}");
    }
}

#[test]
fn the_page_shows_what_is_measured_beside_its_studies() {
    let results = tempfile::tempdir().unwrap();
    let study = || study_in(results.path());
    assert!(!page(&[study()]).unwrap().contains("Speed against accuracy"));

    fill(&results.path().join("tradeoff"));
    fs::write(
        results.path().join("peers.csv"),
        "task,peer,peer_time_us,ratio,verdict,machine\n\
         roll <1>,other,3,3.14159265,met,a desk\nroll <2>,other,4,1,short,a desk\n",
    )
    .unwrap();
    let html = page(&[study()]).unwrap();
    for part in [
        "Speed against accuracy",
        "Measured on a processor of 2 cores.",
        "<td>hard: an ellipsoid</td><td>RK4 × 8<span class=\"cost\">900 ns, 6 k instructions</span></td><td>none</td>",
        "<td class=\"number\">16</td>",
        "on one core of a desk.",
        "<th>task</th><th>verdict</th><th>peer</th><th>peer time (µs)</th><th>ratio</th></tr>",
        "<td>roll &lt;1&gt;</td><td>met</td><td>other</td>",
        "<th>median (ns)</th>",
        "3.142",
        "<svg",
    ] {
        assert!(html.contains(part), "{part}\n{html}");
    }
    assert!(!html.contains("<?xml"));
    assert!(!html.contains("keep its word"));
}

#[test]
fn the_page_tells_whether_auto_keeps_its_word() {
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
        let named = matches!(&error, ReportError::BadCell { column, .. } if column == wrong);
        assert!(named, "{error}");
    }
}

/// A study whose folder lies in `results`.
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
    Study::load(&folder).unwrap()
}
