//! Tests the files of `palpate run`, and that its results do not depend on threads, shards or vector instructions.

use std::sync::atomic::AtomicBool;

use palpate::{Arch, RunOptions, Runner, Simulation};

use super::desk::{Desk, RUN_FILES, STUDY, edited};

const HEADER: &str = "cell,scene.object.radius_mm,quantity,unit,truth,trials,failures,\
    mean,std,bias,rms_error,rms_error_std,mean_abs_error,relative_rms_error,relative_mean_abs_error,\
    q05,q50,q95,mean_reported_std,coverage50,coverage80,coverage95";

const QUANTITIES: [(&str, &str); 5] = [
    ("normal_curvature_u", "1/mm"),
    ("normal_curvature_v", "1/mm"),
    ("gaussian_curvature", "1/mm^2"),
    ("mean_curvature", "1/mm"),
    ("arc_length", "mm"),
];

#[test]
fn cells_have_a_row_per_cell_and_quantity() {
    let desk = Desk::with(STUDY);
    let printed = desk.palpate("run c.toml --out o").printed();
    assert_eq!(printed, "a-study: 2 cells, 40 trials, 0 failed -> o\n");
    assert_eq!(desk.names("o"), RUN_FILES);
    assert_eq!(desk.read("o/failures.csv"), "cell,kind,count,first_trial\n");
    assert_eq!(desk.read("o/cells.csv").lines().next(), Some(HEADER));
    let table = desk.table("o/cells.csv");
    assert_eq!(table.rows.len(), 2 * QUANTITIES.len());
    for row in 0..table.rows.len() {
        let (cell, (quantity, unit)) = (row / 5, QUANTITIES[row % 5]);
        assert_eq!(table.rows[row][0], cell.to_string());
        assert_eq!(table.rows[row][1], ["50", "5"][cell]);
        assert_eq!(table.text(row, "quantity"), quantity);
        assert_eq!(table.text(row, "unit"), unit);
        assert_eq!(table.text(row, "trials"), "20");
        assert_eq!(table.text(row, "failures"), "0");
        let statistic = |name| table.number(row, name);
        assert!((statistic("mean") - statistic("truth") - statistic("bias")).abs() < 1e-12);
        assert!(statistic("rms_error") >= statistic("mean_abs_error"));
        assert!(statistic("q05") <= statistic("q50") && statistic("q50") <= statistic("q95"));
        // The estimator computes no standard error of the arc length.
        assert_eq!(
            table.text(row, "coverage95").is_empty(),
            quantity == "arc_length"
        );
        assert_eq!(
            table.text(row, "mean_reported_std").is_empty(),
            quantity == "arc_length"
        );
    }
    assert_eq!(table.number(0, "truth"), 0.02);
    assert_eq!(table.number(7, "truth"), 0.2 * 0.2);
}

#[test]
fn default_directory() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml").printed();
    assert_eq!(desk.names("out/a-study"), RUN_FILES);
    assert_eq!(desk.names(""), ["c.toml", "out"]);
}

#[test]
fn run_toml_runs_again_to_the_same_bytes() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out first --seed 9 --trials 30")
        .printed();
    desk.palpate("run first/run.toml --out second").printed();
    for file in RUN_FILES {
        assert_eq!(
            desk.read(&format!("first/{file}")),
            desk.read(&format!("second/{file}"))
        );
    }
    let resolved = desk.read("first/run.toml");
    for line in ["seed = 9", "trials = 30", "crate_version = "] {
        assert!(resolved.contains(line), "{line} is not in {resolved}");
    }
    let here = desk.path("");
    assert!(!resolved.contains(here.to_str().unwrap()), "{resolved}");
    assert!(
        !resolved.contains("threads") && !resolved.contains("date"),
        "{resolved}"
    );
}

#[test]
fn threads_and_vectors_do_not_change_a_byte() {
    // The 2,500 trials are divided into three blocks of up to 1,024 trials, so the last block is shorter.
    let config = edited(STUDY, "trials = 20", "trials = 2500");
    let desk = Desk::with(&config);
    for line in [
        "run c.toml --out one --threads 1",
        "run c.toml --out two --threads 2",
    ] {
        desk.palpate(line).printed();
    }
    for file in RUN_FILES {
        let one = desk.read(&format!("one/{file}"));
        assert_eq!(one, desk.read(&format!("two/{file}")));
    }
    let study = palpate::parse("c.toml", &config).unwrap();
    let runner = Runner::new(&RunOptions::default()).unwrap();
    let mut narrow = Simulation::new(&study, 0..study.cell_count(), &runner).unwrap();
    narrow.arch = Arch::Scalar;
    let tables = narrow.run(&AtomicBool::new(false), &|_| ()).unwrap();
    assert_eq!(tables.cells.to_csv(), desk.read("one/cells.csv"));
}

#[test]
fn every_nth_cell_keeps_numbers_and_bytes() {
    // After the check, a run keeps only a limited number of cells in memory. This study has more cells.
    let range = "from = 1\nto = 50\ncount = 70";
    let desk = Desk::with(&edited(STUDY, "values = [50, 5]", range));
    desk.palpate("run c.toml --out all").printed();
    desk.palpate("run c.toml --out some --every-nth-cell 3")
        .printed();
    let all = desk.read("all/cells.csv");
    let is_third = |line: &&str| {
        let number = line.split(',').next().unwrap().parse::<usize>();
        number.is_err() || number.is_ok_and(|cell| cell.is_multiple_of(3))
    };
    let expected: Vec<&str> = all.lines().filter(is_third).collect();
    assert_eq!(
        desk.read("some/cells.csv").lines().collect::<Vec<_>>(),
        expected
    );
    assert_eq!(expected.len(), 1 + 24 * 5);
}

#[test]
fn outputs_can_include_a_trace() {
    let outputs = "outputs = [\"cells\", \"trace\"]\nlength_unit";
    let desk = Desk::with(&edited(STUDY, "length_unit", outputs));
    desk.palpate("run c.toml --out o").printed();
    desk.palpate("trace c.toml --out t").printed();
    assert_eq!(
        desk.names("o"),
        [
            "cells.csv",
            "failures.csv",
            "readings.csv",
            "run.toml",
            "trace.csv"
        ]
    );
    assert_eq!(desk.read("o/trace.csv"), desk.read("t/trace.csv"));
    assert_eq!(desk.read("o/readings.csv"), desk.read("t/readings.csv"));
}

/// In the tables of this study, the column `trials` contains two things: the swept field `trials`, and the statistic of
/// this name.
#[test]
fn trials_can_be_swept_and_drawn() {
    let plots = "\n[[plot]]\nname = \"along\"\nx = \"trials\"\ny = \"rms_error\"\nquantity = \"mean_curvature\"\n\
        [[plot]]\nname = \"by\"\nx = \"scene.object.radius\"\ny = \"rms_error\"\nseries = \"trials\"\n\
        quantity = \"mean_curvature\"\nwhere = { trials = [20, 80] }\n";
    let axis = "[50, 5]\n\n[[sweep]]\npath = \"trials\"\nvalues = [20, 40, 80]";
    let desk = Desk::with(&(edited(STUDY, "[50, 5]", axis) + plots));
    let along = edited(
        &desk.read("c.toml"),
        "quantity = \"mean",
        "where = { \"scene.object.radius\" = 50 }\nquantity = \"mean",
    );
    desk.write("c.toml", along);
    desk.palpate("run c.toml --out o").printed();
    let table = desk.table("o/cells.csv");
    let named = |name: &&String| *name == "trials";
    assert_eq!(table.header.iter().filter(named).count(), 1);
    assert_eq!(desk.read("o/cells.csv").lines().next(), Some(HEADER));
    for (cell, trials) in ["20", "40", "80"].into_iter().cycle().take(6).enumerate() {
        assert_eq!(
            table.text(table.row_of(cell, "mean_curvature"), "trials"),
            trials
        );
    }
    let drawn = desk.palpate("plot o").printed();
    assert!(
        drawn.contains("along.svg") && drawn.contains("by.svg"),
        "{drawn}"
    );
}
