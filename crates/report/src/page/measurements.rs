//! Sections of the page for the tables beside the studies: `tradeoff/`, `extremes.csv` and `peers.csv`, as far as they
//! exist.

mod extremes;

use crate::plot::{fronts_svgs, spoken_cost};
use crate::records::Records;
use crate::table::finite;
use crate::tradeoff::{Answer, Promise, Tradeoff};
use crate::{ReportError, Study, words};
use minijinja::context;
use minijinja::value::Value;
use std::path::{Path, PathBuf};

/// Folder that holds the folders of all studies, if there is such a one.
pub(super) fn folder(studies: &[Study]) -> Option<PathBuf> {
    let mut parents = studies.iter().map(|study| study.dir().parent());
    let first = parents.next()??;
    parents
        .all(|parent| parent == Some(first))
        .then(|| first.to_owned())
}

/// Sections for the tables that the folder holds.
///
/// # Errors
/// A table is malformed.
pub(super) fn sections(folder: &Path) -> Result<Value, ReportError> {
    let there = |name: &str| Some(folder.join(name)).filter(|path| path.exists());
    let tradeoff = there("tradeoff").map(|path| tradeoff(&path)).transpose()?;
    let extremes = there("extremes.csv")
        .map(|path| extremes::section(&path))
        .transpose()?;
    let peers = there("peers.csv").map(|path| peers(&path)).transpose()?;
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
    let stages = shown(&Records::read(&dir.join("stages.csv"), &[])?);
    let promises: Vec<Value> = tradeoff.promises.iter().map(promise).collect();
    Ok(context! { ladders, stages, promises, machine => &tradeoff.machine })
}

fn promise(promise: &Promise) -> Value {
    context! {
        kind => &promise.kind,
        scenes => promise.scenes,
        kept => promise.kept,
        with_rivals => promise.with_rivals,
        ratio => promise.dearest.map(|ratio| format!("{ratio:.2}")),
    }
}

fn answer(answer: &Answer) -> Value {
    let cost = spoken_cost(answer.instructions, answer.ns);
    context! { rung => &answer.rung, cost, error => answer.error.map(words::number) }
}

/// The table of peers, verdicts in its second column, and the machine where it is one.
fn peers(path: &Path) -> Result<Value, ReportError> {
    let mut records = Records::read(path, &[])?;
    let machine = take_constant(&mut records, "machine");
    let verdict = records.header.iter().position(|name| name == "verdict");
    if let Some(verdict) = verdict.filter(|&verdict| verdict > 1) {
        for row in std::iter::once(&mut records.header).chain(&mut records.rows) {
            row[1..=verdict].rotate_right(1);
        }
    }
    Ok(context! { table => shown(&records), machine })
}

/// Takes a column out of a table in whose rows it is the same.
fn take_constant(records: &mut Records, name: &str) -> Option<String> {
    let at = records.header.iter().position(|column| column == name)?;
    let constant = records.rows.first()?[at].clone();
    if records.rows.iter().any(|row| row[at] != constant) {
        return None;
    }
    for row in std::iter::once(&mut records.header).chain(&mut records.rows) {
        row.remove(at);
    }
    Some(constant)
}

/// A table as it is, headers in words.
fn shown(Records { header, rows, .. }: &Records) -> Value {
    let header: Vec<String> = header.iter().map(|name| heading(name)).collect();
    let rows: Vec<Vec<Value>> = rows
        .iter()
        .map(|row| row.iter().map(|cell| spoken(cell)).collect())
        .collect();
    context! { header, rows }
}

/// A header in words, with its unit of time in brackets.
fn heading(name: &str) -> String {
    let units = [("_us", "µs"), ("_ns", "ns")];
    let split = |(suffix, unit)| Some((name.strip_suffix(suffix)?, unit));
    let (name, unit) = units.into_iter().find_map(split).unwrap_or((name, ""));
    words::with_unit(&name.replace('_', " "), unit)
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
