//! The table that compares the times and errors of palpate with those of its peers (other programs).

use std::fmt;

use anyhow::{Context, Result};
use serde::Deserialize;

#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(crate) struct Figure {
    pub(crate) task: String,
    pub(crate) peer: String,
    pub(crate) version: String,
    pub(crate) time_us: f64,
    pub(crate) error: f64,
}

impl Figure {
    /// Reads the output of a program, which has one line of JSON per task.
    pub(crate) fn read(lines: &str) -> Result<Vec<Figure>> {
        let lines = lines.lines().filter(|line| !line.trim().is_empty());
        let figure =
            |line| serde_json::from_str(line).with_context(|| format!("not a figure: {line}"));
        lines.map(figure).collect()
    }
}

/// Median time and median error of each program on each task. Programs and tasks are in the order in which they first
/// appear.
pub(crate) fn medians(figures: Vec<Figure>) -> Vec<Figure> {
    let mut medians: Vec<Figure> = Vec::new();
    for figure in &figures {
        let same = |other: &&Figure| (&other.task, &other.peer) == (&figure.task, &figure.peer);
        if medians.iter().any(|known| same(&known)) {
            continue;
        }
        let median = |of: fn(&Figure) -> f64| {
            let mut all: Vec<f64> = figures.iter().filter(same).map(of).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        medians.push(Figure {
            time_us: median(|figure| figure.time_us),
            error: median(|figure| figure.error),
            ..figure.clone()
        });
    }
    medians
}

/// A row of the table: a peer program compared with a model of palpate on the same task.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    peer: Figure,
    ours: Figure,
    ratio: f64,
    target: f64,
    verdict: Verdict,
}

/// Whether palpate is as fast and as accurate as required.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Palpate reaches the required ratio of times, and is at least as accurate as the peer program.
    Met,
    /// Palpate is at least as accurate as the peer program, but does not reach the required ratio of times.
    Short,
    /// Palpate is less accurate than the peer program, so the times cannot be compared.
    ErrsMore,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Met => "met",
            Self::Short => "short",
            Self::ErrsMore => "errs more",
        })
    }
}

const HEADER: [&str; 12] = [
    "task",
    "peer",
    "version",
    "peer_time_us",
    "peer_error",
    "ours",
    "our_time_us",
    "our_error",
    "ratio",
    "target",
    "verdict",
    "machine",
];

/// One row for each combination of a task, a peer program and a model of palpate.
pub(crate) fn rows(
    peers: &[Figure],
    ours: &[Figure],
    target_of: impl Fn(&str) -> f64,
    slack: f64,
) -> Vec<Row> {
    let mut rows = Vec::new();
    for peer in peers {
        for ours in ours.iter().filter(|ours| ours.task == peer.task) {
            let (ratio, target) = (peer.time_us / ours.time_us, target_of(&peer.task));
            let verdict = match (ours.error <= peer.error * (1.0 + slack), ratio >= target) {
                (false, _) => Verdict::ErrsMore,
                (true, true) => Verdict::Met,
                (true, false) => Verdict::Short,
            };
            let (peer, ours) = (peer.clone(), ours.clone());
            rows.push(Row {
                peer,
                ours,
                ratio,
                target,
                verdict,
            });
        }
    }
    rows
}

pub(crate) fn render(rows: &[Row]) -> String {
    let mut text = String::new();
    let mut task = "";
    for row in rows {
        if row.peer.task != task {
            task = &row.peer.task;
            text += &format!("\n{task}, target {} x\n", row.target);
        }
        let (peer, ours) = (&row.peer, &row.ours);
        text += &format!(
            "  {:<44}{:>12.4} us  err {:<9.2e}| {:<44}{:>12.4} us  err {:<9.2e}| {:>9.2} x  {}\n",
            format!("{} {}", peer.peer, peer.version),
            peer.time_us,
            peer.error,
            ours.peer,
            ours.time_us,
            ours.error,
            row.ratio,
            row.verdict,
        );
    }
    text
}

pub(crate) fn csv(rows: &[Row], machine: &str) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(HEADER)?;
    for row in rows {
        let (peer, ours) = (&row.peer, &row.ours);
        writer.write_record([
            &peer.task,
            &peer.peer,
            &peer.version,
            &four_digits(peer.time_us),
            &four_digits(peer.error),
            &ours.peer,
            &four_digits(ours.time_us),
            &four_digits(ours.error),
            &four_digits(row.ratio),
            &row.target.to_string(),
            &row.verdict.to_string(),
            machine,
        ])?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// The committed table, in which the rows of the measured tasks are replaced by new rows.
pub(crate) fn merged(committed: &str, measured: &str) -> Result<String> {
    let read = |text: &str| -> Result<Vec<csv::StringRecord>> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        Ok(reader.records().collect::<Result<_, _>>()?)
    };
    let (mut rows, measured) = (read(committed)?, read(measured)?);
    let is_measured = |row: &csv::StringRecord| measured.iter().any(|one| one.get(0) == row.get(0));
    let place = rows.iter().position(is_measured).unwrap_or(rows.len());
    rows.retain(|row| !is_measured(row));
    rows.splice(place..place, measured.iter().cloned());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(HEADER)?;
    rows.iter().try_for_each(|row| writer.write_record(row))?;
    Ok(String::from_utf8(writer.into_inner()?)?)
}

fn four_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-4..1e7).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        rounded.to_string()
    }
}
