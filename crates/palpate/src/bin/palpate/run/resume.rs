//! Journals of runs that have not ended, and whether a run may go on with one.

use std::path::Path;

use anyhow::anyhow;

use crate::failure::Failure;
use crate::journal::{self, Asked, Found, Header};
use crate::output::Lock;
use crate::output::names::JOURNAL;

/// Journal with which a run goes on; refuses one of another run.
pub(super) fn resumable(out: &Path, asked: &Asked) -> Result<Option<Found>, Failure> {
    // Whoever holds the directory is told of when it is opened.
    if Lock::is_held(out) {
        return Ok(None);
    }
    let Some(found) = journal::read(out)? else {
        return Ok(None);
    };
    let Header {
        asked: known,
        version,
        ..
    } = &found.header;
    let own = env!("CARGO_PKG_VERSION");
    let why = if version != own {
        format!("of palpate {version}, and this is {own}")
    } else if known.shard != asked.shard {
        let words = |shard: Option<(u64, u64)>| match shard {
            Some((number, of)) => format!("shard {number} of {of}"),
            None => "the whole study".to_owned(),
        };
        format!("of {}, not {}", words(known.shard), words(asked.shard))
    } else if known.every_nth_cell != asked.every_nth_cell {
        let (known, own) = (known.every_nth_cell, asked.every_nth_cell);
        format!("of --every-nth-cell {known}, not {own}")
    } else if known.trials_out != asked.trials_out {
        let with = |is: bool| if is { "with" } else { "without" };
        let (known, own) = (with(known.trials_out), with(asked.trials_out));
        format!("{known} --trials-out, and this is {own}")
    } else if known.goal != asked.goal {
        let or_none = |goal: &str| match goal {
            "" => "without --budget and --target-error".to_owned(),
            goal => format!("with {goal}"),
        };
        format!(
            "{}, and this is {}",
            or_none(&known.goal),
            or_none(&asked.goal)
        )
    } else if known.config != asked.config {
        format!(
            "of another config:{}",
            difference(&known.config, &asked.config)
        )
    } else {
        return Ok(Some(found));
    };
    if !found.has_work() {
        // Nothing would be lost.
        return Ok(None);
    }
    let state = match found.is_ended {
        true => "a shard that is done",
        false => "a run that has not ended",
    };
    Err(Failure::usage(anyhow!(
        "{} is of {state}, {why}\nto drop it give --restart; to keep it, another --out",
        out.join(JOURNAL).display()
    )))
}

/// Lines in which two configs differ, the first few of them.
pub(crate) fn difference(old: &str, new: &str) -> String {
    const MOST: usize = 8;
    let only = |sign: char, text: &str, other: &str| {
        let mut rest: Vec<&str> = other.lines().collect();
        let mut lines = Vec::new();
        for line in text.lines() {
            match rest.iter().position(|one| *one == line) {
                Some(place) => drop(rest.swap_remove(place)),
                None => lines.push(format!("\n  {sign} {line}")),
            }
        }
        lines
    };
    let (gone, come) = (only('-', old, new), only('+', new, old));
    let count = gone.len() + come.len();
    let half = MOST / 2;
    let few = gone
        .into_iter()
        .take(half)
        .chain(come.into_iter().take(half));
    let mut text: String = few.collect();
    if count > MOST {
        text += "\n  …";
    }
    text
}
