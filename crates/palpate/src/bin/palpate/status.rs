//! `palpate status`.

use std::fmt::Write;
use std::path::Path;

use anyhow::anyhow;
use indicatif::HumanCount;
use palpate::parse;

use crate::cli::StatusArgs;
use crate::duration::{exact, roughly};
use crate::failure::Failure;
use crate::journal::{self, Found};
use crate::merge::{foreign, listed, shards_of, totals_of};
use crate::output::names::{CELLS, CONFIG, text_of};
use crate::output::{self, Lock};

pub(crate) fn status(args: &StatusArgs) -> Result<(), Failure> {
    let dir = &args.dir;
    if !dir.is_dir() {
        return Err(Failure::work(anyhow!("{} is no directory", dir.display())));
    }
    let own = journal::read(dir)?;
    let shards = match own {
        Some(_) => Default::default(),
        None => shards_of(std::slice::from_ref(dir))?,
    };
    let mut text = String::new();
    let first = shards.values().next();
    let of = first
        .and_then(|(_, found)| found.header.asked.shard)
        .map(|(_, of)| of);
    if let Some(of) = of {
        let mut states: [(&str, Vec<u64>); 5] = [
            ("done", vec![]),
            ("running", vec![]),
            ("failed", vec![]),
            ("missing", vec![]),
            ("foreign", vec![]),
        ];
        let others = |found: &Found| {
            let (dir, first) = first?;
            foreign(found, dir, first)
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
        let founds: Vec<&Found> = shards.values().map(|(_, found)| found).collect();
        let _ = writeln!(text, "study    {}, {of} shards", name_of(founds[0]));
        for (state, numbers) in &states {
            if !numbers.is_empty() {
                let _ = writeln!(
                    text,
                    "{state:8} {}: shards {}",
                    numbers.len(),
                    listed(numbers)
                );
            }
        }
        text += &strangers;
        let founds: Vec<&Found> = founds
            .into_iter()
            .filter(|found| others(found).is_none())
            .collect();
        let running = states[1].1.len().max(1) as f64;
        let tasks = founds[0].header.all_tasks;
        text += &counts(&founds, tasks, running, !states[1].1.is_empty());
        if !states[2].1.is_empty() {
            let _ = writeln!(
                text,
                "again    the command of a failed shard goes on where it ended"
            );
        }
    } else if let Some(found) = &own {
        let is_held = Lock::is_held(dir);
        let state = match (found.is_ended, is_held) {
            (true, _) => "done",
            (false, true) => "running",
            (false, false) => "stopped: the same command goes on with it",
        };
        let shard = found.header.asked.shard;
        let shard = shard.map_or_else(String::new, |(number, of)| {
            format!(", shard {number} of {of}")
        });
        let _ = writeln!(text, "study    {}{shard}", name_of(found));
        let _ = writeln!(text, "state    {state}");
        text += &counts(&[found], found.header.tasks, 1.0, is_held);
    } else if dir.join(CELLS).is_file() {
        let _ = writeln!(text, "study    {}", finished_name(dir));
        let _ = writeln!(text, "state    done");
    } else {
        return Err(Failure::work(anyhow!(
            "{} has no run, and no shards: `palpate run` writes there",
            dir.display()
        )));
    }
    output::print(text.trim_end())
}

/// Lines on cells, trials and time.
fn counts(founds: &[&Found], all: u64, threads: f64, is_running: bool) -> String {
    let tasks: u64 = founds.iter().map(|found| found.tasks).sum();
    let is_split = founds.iter().any(|found| found.superblock_trials > 0);
    let what = if is_split { "parts" } else { "cells" };
    let totals = totals_of(founds.iter().copied());
    let failed: u64 = totals.kinds.values().sum();
    let mut text = format!("{what:8} {} of {}\n", HumanCount(tasks), HumanCount(all));
    let _ = write!(
        text,
        "trials   {}, {} failed",
        HumanCount(totals.trials),
        HumanCount(failed)
    );
    let kinds = totals.failures();
    let _ = writeln!(
        text,
        "{}",
        if kinds.is_empty() {
            kinds
        } else {
            format!(" ({kinds})")
        }
    );
    let seconds: f64 = founds.iter().map(|found| found.time.as_secs_f64()).sum();
    if seconds > 0.0 && tasks > 0 {
        let rate = tasks as f64 / seconds * threads;
        let _ = writeln!(
            text,
            "rate     {} {what} a second",
            exact((rate * 10.0).round() / 10.0)
        );
        if is_running && tasks < all {
            let left = roughly((all - tasks) as f64 / rate);
            let _ = writeln!(text, "left     about {left}");
        }
    }
    text
}

fn name_of(found: &Found) -> String {
    let study = parse("run.toml", &found.header.config);
    study.map_or_else(|_| "?".to_owned(), |study| study.config.name)
}

fn finished_name(dir: &Path) -> String {
    let text = text_of(&dir.join(CONFIG)).unwrap_or_default();
    let study = parse("run.toml", &text);
    study.map_or_else(|_| "?".to_owned(), |study| study.config.name)
}
