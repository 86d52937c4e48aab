//! Sections at the end of the page, which do not belong to a single study: coverage of the intervals, measurements, and
//! glossary.

use crate::interval_coverage::{Coverage, Estimator, mean_shares};
use crate::page::least_width;
use crate::phrases::with_unit;
use crate::records::Records;
use crate::tradeoff::{Answer, AutoModel, Tradeoff};
use crate::{Files, ReportError, Study, phrases, plot};
use minijinja::context;
use minijinja::value::Value;
use palpate_study::glossary::{SUBJECTS, meaning};
use palpate_study::label;
use palpate_study::number::{self, finite, grouped};
use palpate_study::{Quantity, Statistic};

/// The page reports 95 % intervals as too narrow if less than this share of them contains the true value.
const MIN_COVERAGE: f64 = 0.90;

/// Section about the coverage of the intervals of each estimator; `None` if the studies have no intervals.
///
/// # Errors
/// [`ReportError`] if the figure cannot be drawn.
pub(crate) fn coverage(studies: &[Study]) -> Result<Option<Value>, ReportError> {
    let estimators = Estimator::all(studies);
    if estimators.is_empty() {
        return Ok(None);
    }
    let figure = plot::coverage_figure(&estimators)?;
    let least = least_width(&figure);
    let svg = Value::from_safe_string(figure.svg);
    let estimators: Vec<Value> = estimators.iter().map(|it| estimator(it, studies)).collect();
    Ok(Some(
        context! { svg, least, estimators, short => percent(MIN_COVERAGE) },
    ))
}

fn estimator(estimator: &Estimator, studies: &[Study]) -> Value {
    let rows: Vec<&Coverage> = estimator.rows().collect();
    let of_studies: Vec<Value> = estimator
        .studies
        .iter()
        .map(|(place, rows)| {
            let study = &studies[*place];
            let lowest = rows
                .iter()
                .min_by(|a, b| a.shares[2].total_cmp(&b.shares[2]));
            let lowest = lowest.map(|row| (percent(row.shares[2]), words(study, row.row)));
            context! {
                section => place + 1,
                name => study.name(),
                lowest,
                ..counted(&rows.iter().collect::<Vec<_>>())
            }
        })
        .collect();
    context! { name => &estimator.name, studies => of_studies, ..counted(&rows) }
}

/// Values for the page template: the number of `rows`, the mean coverage over these rows, and the number of rows whose
/// intervals are too narrow.
fn counted(rows: &[&Coverage]) -> Value {
    let shares = mean_shares(rows.iter().copied()).map(percent);
    let short = rows
        .iter()
        .filter(|row| row.shares[2] < MIN_COVERAGE)
        .count();
    context! { rows => grouped(rows.len() as u64), shares, short => grouped(short as u64) }
}

fn words(study: &Study, row: usize) -> String {
    let table = study.cells();
    let quantity = label::quantity(table.quantity(row));
    let values = plot::swept_values(table, row);
    std::iter::once(quantity)
        .chain(values)
        .collect::<Vec<_>>()
        .join(", ")
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// The folder that contains the folders of all studies; `None` if the studies are in different places.
pub(crate) fn folder(studies: &[Study]) -> Option<Files> {
    let mut parents = studies.iter().map(|study| study.dir().parent());
    let first = parents.next()??;
    let is_shared = parents.all(|parent| parent == Some(first));
    is_shared.then(|| Files::in_folder(first))
}

/// Sections about the measurements in `tradeoff/` (speed and accuracy of models) and `peers.csv` (other programs), if
/// the folder contains them.
///
/// # Errors
/// [`ReportError`] if a table is malformed.
pub(crate) fn measurements(folder: &Files) -> Result<Value, ReportError> {
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
    let pictures = plot::pareto_figures(&tradeoff)?;
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
                least => least_width(&picture),
                svg => Value::from_safe_string(picture.svg),
                targets,
                scenes,
            }
        })
        .collect();
    let promises: Vec<Value> = tradeoff.auto_models.iter().map(auto_model).collect();
    Ok(context! { ladders, promises, machine => &tradeoff.machine })
}

fn auto_model(model: &AutoModel) -> Value {
    context! {
        kind => &model.kind,
        scenes => model.scenes,
        kept => model.successes,
        with_rivals => model.with_rivals,
        ratio => model.largest_ratio.map(|ratio| format!("{ratio:.2}")),
    }
}

fn answer(answer: &Answer) -> Value {
    let cost = phrases::cost(answer.instructions, answer.ns);
    context! { rung => &answer.rung, cost, error => answer.error.map(number::rounded) }
}

type Parts = (Vec<String>, Vec<Vec<String>>);

/// The table `peers.csv`, which compares palpate with other programs. The column of verdicts is moved to the second
/// place. If all rows were measured on the same machine, the name of the machine is removed from the rows and returned
/// separately.
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

/// If all cells of the column `name` have the same text, removes the column and returns this text. Otherwise, returns
/// `None`.
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

/// The table in the form that the page template needs, with readable column names.
fn shown((header, rows): Parts) -> Value {
    let header: Vec<String> = header.iter().map(|name| heading(name)).collect();
    let spoken = |row: &Vec<String>| row.iter().map(|cell| spoken(cell)).collect();
    let rows: Vec<Vec<Value>> = rows.iter().map(spoken).collect();
    context! { header, rows }
}

/// Column name as readable text, with the unit of time in brackets.
fn heading(name: &str) -> String {
    let units = [("_us", "µs"), ("_ns", "ns")];
    let split = |(suffix, unit)| Some((name.strip_suffix(suffix)?, unit));
    let (name, unit) = units.into_iter().find_map(split).unwrap_or((name, ""));
    with_unit(&name.replace('_', " "), unit)
}

/// Text of a table cell, and whether it is a number. Long numbers are rounded.
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

/// Section with the glossary of `palpate explain`: first the terms by subject, then quantities and statistics. Other
/// parts of the page can link to a term, but not to a quantity or a statistic.
pub(crate) fn glossary() -> Vec<Value> {
    let words = SUBJECTS.iter().map(|subject| {
        let terms = subject.terms.iter();
        let terms: Vec<Value> = terms
            .map(|term| context! { place => place(term.name), ..entry(term.name, term.meaning) })
            .collect();
        context! { title => subject.title, terms }
    });
    let quantities = Quantity::ALL.iter();
    let quantities: Vec<Value> = quantities.map(|one| entry(one.name, one.meaning)).collect();
    let statistics = Statistic::ALL.into_iter().chain([Statistic::StdBound]);
    let statistics: Vec<Value> = statistics
        .map(|one| entry(one.name(), one.meaning()))
        .collect();
    words
        .chain([
            context! { title => "Quantities", terms => quantities },
            context! { title => "Statistics of them over the trials of a cell", terms => statistics },
        ])
        .collect()
}

fn entry(name: &str, meaning: &str) -> Value {
    context! { name, meaning }
}

/// Anchor on the page of the glossary term `word`; `None` if the glossary has no such term.
pub(crate) fn address(word: &str) -> Option<String> {
    let term = meaning(word)?;
    (term.name == word).then(|| place(word))
}

/// Anchor of a glossary term: the letters and digits of the term, with dashes instead of other characters.
fn place(word: &str) -> String {
    let parts = word.split(|letter: char| !letter.is_ascii_alphanumeric());
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    format!("word-{}", parts.join("-"))
}
