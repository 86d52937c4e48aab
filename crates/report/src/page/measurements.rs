//! Sections of the page for tables that do not come from studies: `tradeoff/` and `peers.csv`, if they exist.

use super::size::least;
use crate::plot;
use crate::records::Records;
use crate::tradeoff::{Answer, Promise, Tradeoff};
use crate::{Files, ReportError, Study, words};
use minijinja::context;
use minijinja::value::Value;
use palpate_study::label::with_unit;
use palpate_study::number::{self, finite};

/// Folder that holds the folders of all studies, if there is such a one.
pub(super) fn folder(studies: &[Study]) -> Option<Files> {
    let mut parents = studies.iter().map(|study| study.dir().parent());
    let first = parents.next()??;
    let is_shared = parents.all(|parent| parent == Some(first));
    is_shared.then(|| Files::in_folder(first))
}

/// Sections for the tables that the folder holds.
///
/// # Errors
/// A table is malformed.
pub(super) fn sections(folder: &Files) -> Result<Value, ReportError> {
    type Section = fn(&Files) -> Result<Value, ReportError>;
    let section = |name: &str, make: Section| {
        let there = folder.contain(name).then(|| make(folder));
        there.transpose()
    };
    let tradeoff = section("tradeoff", |folder| tradeoff(&folder.within("tradeoff")))?;
    let peers = section("peers.csv", peers)?;
    Ok(context! { tradeoff, peers })
}

fn tradeoff(folder: &Files) -> Result<Value, ReportError> {
    let tradeoff = Tradeoff::read(folder)?;
    let pictures = plot::fronts(&tradeoff)?;
    let ladders = tradeoff.ladders.iter().zip(pictures);
    let ladders: Vec<Value> = ladders
        .map(|(ladder, picture)| {
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
                least => least(&picture),
                svg => Value::from_safe_string(picture.svg),
                targets,
                scenes,
            }
        })
        .collect();
    let stages = shown(Records::read(folder, "stages.csv", &[])?.into_parts());
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
    let cost = words::cost(answer.instructions, answer.ns);
    context! { rung => &answer.rung, cost, error => answer.error.map(number::rounded) }
}

/// Header and rows of a table.
type Parts = (Vec<String>, Vec<Vec<String>>);

/// The table of peers, verdicts in its second column, and the machine where it is one.
fn peers(folder: &Files) -> Result<Value, ReportError> {
    let mut parts = Records::read(folder, "peers.csv", &[])?.into_parts();
    let machine = take_constant(&mut parts, "machine");
    let (header, rows) = &mut parts;
    let verdict = header.iter().position(|name| name == "verdict");
    if let Some(verdict) = verdict.filter(|&verdict| verdict > 1) {
        for row in std::iter::once(header).chain(rows) {
            row[1..=verdict].rotate_right(1);
        }
    }
    Ok(context! { table => shown(parts), machine })
}

/// Takes a column out of a table in whose rows it is the same.
fn take_constant((header, rows): &mut Parts, name: &str) -> Option<String> {
    let at = header.iter().position(|column| column == name)?;
    let constant = rows.first()?[at].clone();
    if rows.iter().any(|row| row[at] != constant) {
        return None;
    }
    for row in std::iter::once(header).chain(rows) {
        row.remove(at);
    }
    Some(constant)
}

/// A table as it is, headers in words.
fn shown((header, rows): Parts) -> Value {
    let header: Vec<String> = header.iter().map(|name| heading(name)).collect();
    let spoken = |row: &Vec<String>| row.iter().map(|cell| spoken(cell)).collect();
    let rows: Vec<Vec<Value>> = rows.iter().map(spoken).collect();
    context! { header, rows }
}

/// A header in words, with its unit of time in brackets.
fn heading(name: &str) -> String {
    let units = [("_us", "µs"), ("_ns", "ns")];
    let split = |(suffix, unit)| Some((name.strip_suffix(suffix)?, unit));
    let (name, unit) = units.into_iter().find_map(split).unwrap_or((name, ""));
    with_unit(&name.replace('_', " "), unit)
}

/// A cell, and whether it is a number; a long one is rounded.
fn spoken(cell: &str) -> Value {
    const LONG: usize = 6;
    match finite(cell) {
        Some(number) if cell.len() > LONG => {
            context! { text => number::significant(number, 4), number => true }
        }
        Some(_) => context! { text => cell, number => true },
        None => context! { text => cell, number => false },
    }
}
