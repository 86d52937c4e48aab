//! Writes the tables of the measured ladders, which are lists of compared models or settings.

use std::path::Path;

use anyhow::Result;

use super::ladder::{Ease, RungError};
use super::{CostError, answer, pareto};
use crate::csv_table::{self, Column, or_empty};
use crate::timing::Spread;

/// Target errors, as text and as number. For each target, the table `answers.csv` states the cheapest rung (model or
/// setting) whose error is at most the target.
const TARGETS: [(&str, f64); 4] = [
    ("10 %", 0.1),
    ("1 %", 0.01),
    ("0.1 %", 0.001),
    ("1e-6", 1e-6),
];

/// Costs and errors of all rungs of a ladder, measured on one scene. Rungs are models or settings that answer the same
/// question.
pub(super) struct MeasuredScene {
    pub(super) ladder: &'static str,
    pub(super) title: &'static str,
    pub(super) error: &'static str,
    pub(super) evaluation: &'static str,
    pub(super) ease: Ease,
    pub(super) scene: String,
    pub(super) rungs: Vec<MeasuredRung>,
}

pub(super) struct MeasuredRung {
    pub(super) name: String,
    pub(super) setting: Option<f64>,
    pub(super) error: RungError,
    pub(super) ns: Spread,
    pub(super) instructions: Option<u64>,
}

impl MeasuredRung {
    fn cost_and_error(&self) -> CostError {
        let cost = self
            .instructions
            .map_or(self.ns.median, |count| count as f64);
        CostError {
            cost,
            error: self.error.error,
        }
    }
}

/// Writes three tables to a folder: `ladders.csv` (descriptions of the ladders, and the machine), `rungs.csv` (all
/// models and settings) and `answers.csv` (the cheapest model or setting for each target error).
pub(super) fn write(measured: &[MeasuredScene], machine: &str, folder: &Path) -> Result<()> {
    write_ladders(measured, machine, folder)?;
    write_rungs(measured, folder)?;
    write_answers(measured, folder)
}

fn write_ladders(measured: &[MeasuredScene], machine: &str, folder: &Path) -> Result<()> {
    let rows = measured.iter().map(|it| {
        let columns = [
            ("ladder", it.ladder),
            ("title", it.title),
            ("error_of", it.error),
            ("evaluation", it.evaluation),
            ("scene", it.ease.name()),
            ("what", it.scene.as_str()),
            ("machine", machine),
        ];
        columns.map(|(name, field)| (name, field.to_owned()))
    });
    csv_table::write(&folder.join("ladders.csv"), rows)
}

fn write_rungs(measured: &[MeasuredScene], folder: &Path) -> Result<()> {
    let rows = measured.iter().flat_map(|it| {
        let costs: Vec<CostError> = it.rungs.iter().map(MeasuredRung::cost_and_error).collect();
        let rungs = it.rungs.iter().zip(pareto(&costs));
        rungs.map(|(rung, on_front)| {
            let RungError { error, std } = rung.error;
            let [median, q25, q75] = nanoseconds(&rung.ns);
            [
                ("ladder", it.ladder.to_owned()),
                ("scene", it.ease.name().to_owned()),
                ("rung", rung.name.clone()),
                ("setting", or_empty(rung.setting, |one| one.to_string())),
                ("error", format!("{error:.3e}")),
                ("error_std", or_empty(std, |std| format!("{std:.3e}"))),
                median,
                q25,
                q75,
                count(rung.instructions),
                ("pareto", on_front.to_string()),
            ]
        })
    });
    csv_table::write(&folder.join("rungs.csv"), rows)
}

fn write_answers(measured: &[MeasuredScene], folder: &Path) -> Result<()> {
    let rows = measured.iter().flat_map(|it| {
        let costs: Vec<CostError> = it.rungs.iter().map(MeasuredRung::cost_and_error).collect();
        TARGETS.map(|(words, target)| {
            let rung = answer(&costs, target).map(|at| &it.rungs[at]);
            let name = rung.map_or("none", |rung| &rung.name);
            let error = or_empty(rung, |rung| format!("{:.3e}", rung.error.error));
            let median = or_empty(rung, |rung| {
                let [(_, median), ..] = nanoseconds(&rung.ns);
                median
            });
            [
                ("ladder", it.ladder.to_owned()),
                ("scene", it.ease.name().to_owned()),
                ("target", words.to_owned()),
                ("rung", name.to_owned()),
                ("error", error),
                ("median_ns", median),
                count(rung.and_then(|rung| rung.instructions)),
            ]
        })
    });
    csv_table::write(&folder.join("answers.csv"), rows)
}

/// Median and quartiles of a time as columns of a table. The numbers are rounded to their significant digits.
pub(super) fn nanoseconds(spread: &Spread) -> [Column; 3] {
    let digits = if spread.median < 100.0 { 1 } else { 0 };
    [
        ("median_ns", spread.median),
        ("q25_ns", spread.q25),
        ("q75_ns", spread.q75),
    ]
    .map(|(name, ns)| (name, format!("{ns:.digits$}")))
}

pub(super) fn count(instructions: Option<u64>) -> Column {
    let count = or_empty(instructions, |count| count.to_string());
    ("instructions", count)
}
