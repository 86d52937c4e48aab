//! Implements the command `palpate status`.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, anyhow};
use indicatif::HumanCount;
use palpate::parse;

use crate::cli::StatusArgs;
use crate::duration::{exact, roughly};
use crate::failure::Failure;
use crate::journal::{self, JournalState, Totals};
use crate::merge::{Shards, listed, mismatch, shards_of, totals_of};
use crate::output::names::{CONFIG, text_of};
use crate::output::{self, Format, Lock, refuse_no_directory, table_writer};

pub(crate) fn status(args: &StatusArgs) -> Result<(), Failure> {
    let dir = &args.dir;
    refuse_no_directory(dir)?;
    let own = journal::read(dir)?;
    let Shards {
        by_number: shards,
        faults,
    } = match own {
        Some(_) => Shards::default(),
        None => shards_of(std::slice::from_ref(dir))?,
    };
    let mut text = String::new();
    let first = shards.values().next();
    let of = first
        .and_then(|(_, found)| found.header.request.shard)
        .map(|(_, of)| of);
    if let Some(of) = of {
        let names = ["done", "running", "failed", "missing", "foreign"];
        let mut states = names.map(|name| (name, Vec::<u64>::new()));
        let others = |found: &JournalState| {
            let (dir, first) = first?;
            mismatch(found, dir, first)
        };
        let mut strangers = String::new();
        for number in 1..=of {
            let state = match shards.get(&number) {
                None => 3,
                Some((dir, found)) => match others(found) {
                    Some(why) => {
                        let _ = writeln!(strangers, "{} {why}", dir.display());
                        4
                    }
                    None if found.is_ended && !found.is_torn => 0,
                    None if Lock::is_held(dir) => 1,
                    None => 2,
                },
            };
            states[state].1.push(number);
        }
        let founds: Vec<&JournalState> = shards.values().map(|(_, found)| found).collect();
        let name = study_name(&founds[0].header.config);
        let _ = writeln!(text, "study    {name}, {of} shards");
        for (state, numbers) in &states {
            if !numbers.is_empty() {
                let (count, shards) = (numbers.len(), listed(numbers));
                let _ = writeln!(text, "{state:8} {count}: shards {shards}");
            }
        }
        text += &strangers;
        for fault in &faults {
            let _ = writeln!(text, "{fault}");
        }
        let founds: Vec<&JournalState> = founds
            .into_iter()
            .filter(|found| others(found).is_none())
            .collect();
        let running = states[1].1.len().max(1) as f64;
        let tasks = founds[0].header.all_tasks;
        text += &counts(&founds, tasks, running, !states[1].1.is_empty());
        if !states[2].1.is_empty() {
            text += "again    run the command of a failed shard again to resume it\n";
        }
    } else if let Some(found) = &own {
        let is_held = Lock::is_held(dir);
        let state = match (found.is_ended, is_held) {
            (true, _) => "done",
            (false, true) => "running",
            (false, false) => "stopped: the same command resumes it",
        };
        let shard = found.header.request.shard;
        let shard = shard.map_or_else(String::new, |(number, of)| {
            format!(", shard {number} of {of}")
        });
        let _ = writeln!(text, "study    {}{shard}", study_name(&found.header.config));
        let _ = writeln!(text, "state    {state}");
        text += &counts(&[found], found.header.tasks, 1.0, is_held);
    } else if let Some(format) = Format::found_in(dir) {
        let config = text_of(&dir.join(CONFIG)).unwrap_or_default();
        let _ = writeln!(text, "study    {}", study_name(&config));
        let _ = writeln!(text, "state    done");
        text += &match format.supported() {
            Ok(()) => {
                let totals = totals_in_tables(dir, format)?;
                let cells = HumanCount(totals.cells);
                format!("cells    {cells}\n{}", trials(&totals))
            }
            Err(why) => format!("tables   Parquet; {why}\n"),
        };
    } else if let Some(fault) = faults.into_iter().next() {
        return Err(fault);
    } else {
        return Err(Failure::work(anyhow!(
            "{} has no run and no shards: `palpate run` has not written there",
            dir.display()
        )));
    }
    output::print(text.trim_end())
}

/// Lines with the numbers of finished cells and trials, the number of cells per second, and the remaining time.
fn counts(founds: &[&JournalState], all: u64, threads: f64, is_running: bool) -> String {
    let tasks: u64 = founds.iter().map(|found| found.tasks).sum();
    let totals = totals_of(founds.iter().copied());
    let mut text = format!("cells    {} of {}\n", HumanCount(tasks), HumanCount(all));
    text += &trials(&totals);
    let seconds: f64 = founds.iter().map(|found| found.time.as_secs_f64()).sum();
    if seconds > 0.0 && tasks > 0 {
        let rate = tasks as f64 / seconds * threads;
        let shown = exact((rate * 10.0).round() / 10.0);
        let _ = writeln!(text, "rate     {shown} cells a second");
        if is_running && tasks < all {
            let left = roughly((all - tasks) as f64 / rate);
            let _ = writeln!(text, "left     about {left}");
        }
    }
    text
}

fn trials(totals: &Totals) -> String {
    let (all, failed) = (totals.trials, totals.kinds.values().sum());
    let kinds = match totals.failures() {
        none if none.is_empty() => none,
        kinds => format!(" ({kinds})"),
    };
    let (all, failed) = (HumanCount(all), HumanCount(failed));
    format!("trials   {all}, {failed} failed{kinds}\n")
}

/// Numbers of cells, trials and failures, counted from the tables of a finished run.
fn totals_in_tables(dir: &Path, format: Format) -> Result<Totals, Failure> {
    let mut totals = Totals::default();
    let [cells, failures, _] = format.tables();
    let mut last = String::new();
    let columns = ["cell", "trials"];
    table_writer::read(&dir.join(cells), format, columns, &mut |[cell, trials]| {
        if totals.cells == 0 || cell != last {
            totals.cells += 1;
            totals.trials += count(trials)?;
            cell.clone_into(&mut last);
        }
        Ok(())
    })?;
    let columns = ["kind", "count"];
    table_writer::read(&dir.join(failures), format, columns, &mut |[
        kind,
        failed,
    ]| {
        *totals.kinds.entry(kind.to_owned()).or_default() += count(failed)?;
        Ok(())
    })?;
    Ok(totals)
}

fn count(field: &str) -> Result<u64, anyhow::Error> {
    let number = field.parse();
    number.with_context(|| format!("`{field}` is not a number of trials"))
}

fn study_name(config: &str) -> String {
    let study = parse("run.toml", config);
    study.map_or_else(|_| "?".to_owned(), |study| study.config.name)
}
