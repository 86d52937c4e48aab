//! What the page shows of the tables beside the studies: `tradeoff/`, `extremes.csv` and `peers.csv`, each where it is.

use crate::plot::{fronts_svgs, spoken_cost};
use crate::records::{Columns, Records};
use crate::table::finite;
use crate::tradeoff::{Answer, Tradeoff};
use crate::{ReportError, Study, words};
use minijinja::context;
use minijinja::value::Value;
use std::path::{Path, PathBuf};

/// The folder in which the studies' folders lie, if it is one.
pub(super) fn folder(studies: &[Study]) -> Option<PathBuf> {
    let mut parents = studies.iter().map(|study| study.dir().parent());
    let first = parents.next()??;
    parents
        .all(|parent| parent == Some(first))
        .then(|| first.to_owned())
}

/// Sections of what lies in the folder.
///
/// # Errors
/// A table is malformed.
pub(super) fn sections(folder: &Path) -> Result<Value, ReportError> {
    let there = |name: &str| Some(folder.join(name)).filter(|path| path.exists());
    let tradeoff = there("tradeoff").map(|path| tradeoff(&path)).transpose()?;
    let extremes = there("extremes.csv")
        .map(|path| extremes(&path))
        .transpose()?;
    let peers = there("peers.csv").map(|path| rows(&path)).transpose()?;
    Ok(context! { tradeoff, extremes, peers })
}

fn tradeoff(dir: &Path) -> Result<Value, ReportError> {
    let tradeoff = Tradeoff::read(dir)?;
    let pictures = fronts_svgs(&tradeoff, dir)?;
    let ladders = tradeoff.ladders.iter().zip(pictures);
    let ladders: Vec<Value> = ladders
        .map(|(ladder, svg)| {
            let targets: Vec<String> = ladder.scenes.first().map_or(Vec::new(), |scene| {
                scene.answers.iter().map(|it| it.target.clone()).collect()
            });
            let scenes: Vec<Value> = ladder
                .scenes
                .iter()
                .map(|scene| {
                    let answers: Vec<Value> = scene.answers.iter().map(answer).collect();
                    context! { ease => &scene.ease, what => &scene.what, answers }
                })
                .collect();
            context! {
                title => &ladder.title,
                error_of => &ladder.error_of,
                evaluation => &ladder.evaluation,
                svg => Value::from_safe_string(super::inline(&svg)),
                targets,
                scenes,
            }
        })
        .collect();
    let stages = rows(&dir.join("stages.csv"))?;
    Ok(context! { ladders, stages, machine => &tradeoff.machine })
}

fn answer(answer: &Answer) -> Value {
    let cost = spoken_cost(answer.instructions, answer.ns);
    context! { rung => &answer.rung, cost, error => answer.error.map(words::number) }
}

/// A table as it is, headers in words.
fn rows(path: &Path) -> Result<Value, ReportError> {
    let Records { header, rows, .. } = Records::read(path, &[])?;
    let header: Vec<String> = header.iter().map(|name| name.replace('_', " ")).collect();
    let rows: Vec<Vec<Value>> = rows
        .iter()
        .map(|row| row.iter().map(|cell| spoken(cell)).collect())
        .collect();
    Ok(context! { header, rows })
}

/// A cell, and whether it is a number; a long one is rounded.
fn spoken(cell: &str) -> Value {
    const LONG: usize = 6;
    match finite(cell) {
        Some(number) if cell.len() > LONG => {
            context! { text => words::significant(number, 4), number => true }
        }
        Some(_) => context! { text => cell, number => true },
        None => context! { text => cell, number => false },
    }
}

/// Cases of each entry point by verdict, verdicts in the order in which they appear.
fn extremes(path: &Path) -> Result<Value, ReportError> {
    let table = Columns::read(path, &["entry", "verdict"])?;
    let (mut entries, mut verdicts): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    let cases: Vec<[&str; 2]> = (0..table.rows())
        .map(|row| [table.text(row, 0), table.text(row, 1)])
        .collect();
    for [entry, verdict] in &cases {
        for (known, name) in [(&mut entries, entry), (&mut verdicts, verdict)] {
            if !known.contains(name) {
                known.push(name);
            }
        }
    }
    let count = |wanted: &dyn Fn(&[&str; 2]) -> bool| -> String {
        match cases.iter().filter(|case| wanted(case)).count() {
            0 => String::new(),
            count => words::count(count as u64),
        }
    };
    let of_entries: Vec<Value> = entries
        .iter()
        .map(|entry| {
            let counts: Vec<String> = verdicts
                .iter()
                .map(|verdict| count(&|case| case == &[*entry, *verdict]))
                .collect();
            context! { name => *entry, counts }
        })
        .collect();
    let totals: Vec<String> = verdicts
        .iter()
        .map(|verdict| count(&|case| case[1] == *verdict))
        .collect();
    let all = words::count(cases.len() as u64);
    let verdicts: Vec<String> = verdicts.into_iter().map(str::to_owned).collect();
    Ok(context! { verdicts, entries => of_entries, totals, all })
}
