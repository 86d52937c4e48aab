//! Implements the command `palpate merge`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use palpate::{RunOptions, Runner, Shard, Simulation, Warnings, parse, resolved};

use crate::cli::MergeArgs;
use crate::failure::Failure;
use crate::journal::{self, Header, JournalState, Reader, Totals};
use crate::output::names::{CONFIG, JOURNAL};
use crate::output::{Contents, Guard, LockedDir, StudyId, refuse_no_directory};
use crate::run::{
    Drafts, TrialsOut, difference, numbers_of, output_names, requested_trace, summary,
    write_results,
};

/// Largest number of shards that an error message lists by number.
const MAX_LISTED: usize = 20;

pub(crate) fn merge(args: &MergeArgs) -> Result<(), Failure> {
    args.format.supported()?;
    let shards = shards_of(&args.dirs)?.sound()?;
    let Some((_, (first_dir, first))) = shards.iter().next() else {
        let dirs: Vec<String> = args
            .dirs
            .iter()
            .map(|dir| dir.display().to_string())
            .collect();
        return Err(Failure::work(anyhow!(
            "no shards in {}: run each shard with `palpate run CONFIG --shard K/N` into its own directory",
            dirs.join(", ")
        )));
    };
    for (dir, found) in shards.values() {
        if let Some(why) = mismatch(found, first_dir, first) {
            return Err(Failure::work(anyhow!("{} {why}", dir.display())));
        }
        refuse_damaged(dir, found)?;
    }
    let header = &first.header;
    let of = header.request.shard.map_or(1, |(_, of)| of);
    let missing: Vec<u64> = (1..=of)
        .filter(|number| !shards.contains_key(number))
        .collect();
    if !missing.is_empty() {
        return Err(Failure::work(anyhow!(
            "shard{} {} of {of} {} missing",
            if missing.len() == 1 { "" } else { "s" },
            listed(&missing),
            if missing.len() == 1 { "is" } else { "are" },
        )));
    }
    let study = parse("run.toml", &header.config).map_err(Failure::usage)?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| match args.dirs.as_slice() {
            [one] if !one.join(JOURNAL).exists() => one.clone(),
            _ => PathBuf::from("out").join(&study.config.name),
        });
    let runner = Runner::new(&RunOptions::default()).map_err(Failure::work)?;
    let numbers = numbers_of(&study, header.request.every_nth_cell as usize);
    let (cells, first_cell) = (numbers.len(), numbers[0]);
    let simulation = Simulation::of_shard(&study, numbers, Shard::default(), &runner);
    let mut simulation = simulation.map_err(Failure::usage)?;
    simulation.has_trials = args.trials_out.is_some();
    if args.trials_out.is_some() && !header.request.trials_out {
        return Err(Failure::usage(anyhow!(
            "the shards have no rows of trials: they were run without --trials-out"
        )));
    }
    let trials_out = args.trials_out.as_ref();
    let guard = Guard::new([], args.force);
    let trials_out = trials_out.map(|path| TrialsOut::new(path, args.format, guard, &out, &study));
    let trials_out = trials_out.transpose()?;
    let trials_out = trials_out.as_ref();

    let mut folder = LockedDir::open(&out, Guard::new([], args.force))?;
    let config = resolved(&study);
    let dir = folder.output();
    dir.refuse(CONFIG, Some(&Contents::Bytes(config.as_bytes())))?;
    let mut tables = output_names(&study, args.format).into_iter();
    tables.try_for_each(|name| dir.refuse(name, None))?;
    let trace = requested_trace(&study, first_cell)?;
    let of_study = StudyId::new(&study.config.name, &config);
    folder.begin(&config, &of_study)?;
    let mut warnings = Warnings::default();
    for (_, found) in shards.values() {
        warnings.merge(found.warnings.clone());
    }
    let warnings = warnings.grouped(cells);
    let mut readers = Vec::new();
    for (dir, _) in shards.values() {
        readers.extend(Reader::open(dir)?.map(|(reader, _)| reader));
    }
    let drafts = Drafts::new(&folder, &simulation, args.format, trials_out, &of_study)?;
    let (files, totals) = drafts.fill(readers)?;
    if totals.cells != cells as u64 {
        return Err(Failure::work(anyhow!(
            "the shards have only {} of {cells} cells: a shard has changed since it was read",
            totals.cells
        )));
    }
    write_results(&mut folder, files, trace, &config, &warnings, &of_study)?;
    let summary = summary(&study.config.name, "", &totals, &out);
    match totals.has_success {
        true => TrialsOut::print(trials_out, &summary),
        false => Err(Failure::work(anyhow!("every trial failed: {summary}"))),
    }
}

#[derive(Default)]
pub(crate) struct Shards {
    /// Directory and journal of each shard, by the number of the shard.
    pub(crate) by_number: BTreeMap<u64, (PathBuf, JournalState)>,
    /// One failure for each journal that cannot be used.
    pub(crate) faults: Vec<Failure>,
}

impl Shards {
    /// Returns the shards by their numbers, or the first failure if at least one journal cannot be used.
    pub(crate) fn sound(self) -> Result<BTreeMap<u64, (PathBuf, JournalState)>, Failure> {
        match self.faults.into_iter().next() {
            Some(fault) => Err(fault),
            None => Ok(self.by_number),
        }
    }

    fn add(&mut self, place: PathBuf) -> Result<(), Failure> {
        let Some(found) = journal::read(&place)? else {
            return Ok(());
        };
        // A journal without a shard number belongs to an unfinished run of the whole study in the same directory, so
        // skip it.
        let Some((number, of)) = found.header.request.shard else {
            return Ok(());
        };
        match self.by_number.get(&number) {
            Some((other, _)) if *other != place => {
                let (other, place) = (other.display(), place.display());
                Err(Failure::work(anyhow!(
                    "shard {number} of {of} is in {other} and in {place}: name only one of them"
                )))
            }
            _ => {
                self.by_number.insert(number, (place, found));
                Ok(())
            }
        }
    }
}

pub(crate) fn shards_of(dirs: &[PathBuf]) -> Result<Shards, Failure> {
    let mut shards = Shards::default();
    for dir in dirs {
        refuse_no_directory(dir)?;
        let listed = fs::read_dir(dir);
        listed
            .with_context(|| format!("cannot read {}", dir.display()))
            .map_err(Failure::work)?;
        let places = journals_in(dir, 2);
        if places.is_empty() && dirs.len() > 1 {
            let dir = dir.display();
            return Err(Failure::work(anyhow!(
                "{dir} has no shard: `palpate run --shard` writes {JOURNAL} there"
            )));
        }
        for place in places {
            let added = shards.add(place);
            shards.faults.extend(added.err());
        }
    }
    Ok(shards)
}

/// Directories that contain a journal: the given directory itself, or directories up to two levels below it.
fn journals_in(dir: &Path, depth: usize) -> Vec<PathBuf> {
    if dir.join(JOURNAL).exists() {
        return vec![dir.to_owned()];
    }
    if depth == 0 {
        return Vec::new();
    }
    let entries = fs::read_dir(dir).into_iter().flatten().flatten();
    let is_dir = |path: &PathBuf| fs::symlink_metadata(path).is_ok_and(|found| found.is_dir());
    let mut dirs: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_dir).collect();
    dirs.sort();
    let below = dirs.iter().flat_map(|dir| journals_in(dir, depth - 1));
    below.collect()
}

/// Reason why the shards with the journals `found` and `of` belong to different runs; `None` if they belong to the same
/// run.
pub(crate) fn mismatch(found: &JournalState, first: &Path, of: &JournalState) -> Option<String> {
    let (one, other) = (&found.header, &of.header);
    let own = env!("CARGO_PKG_VERSION");
    let number = |header: &Header| header.request.shard.map_or(1, |(_, of)| of);
    Some(if one.version != own {
        format!("was written by palpate {}, but this is {own}", one.version)
    } else if number(one) != number(other) {
        let (one, other) = (number(one), number(other));
        format!(
            "belongs to a run of {one} shards, but {} belongs to a run of {other} shards",
            first.display()
        )
    } else if one.config != other.config {
        let lines = difference(&other.config, &one.config);
        format!("belongs to another config than {}:{lines}", first.display())
    } else if one.request.trials_out != other.request.trials_out {
        format!("and {} differ in --trials-out", first.display())
    } else if one.request.every_nth_cell != other.request.every_nth_cell {
        format!("has another --every-nth-cell than {}", first.display())
    } else {
        return None;
    })
}

fn refuse_damaged(dir: &Path, found: &JournalState) -> Result<(), Failure> {
    let (number, of) = found.header.request.shard.unwrap_or((1, 1));
    let all = found.header.tasks;
    let shard = format!("shard {number} of {of} in {}", dir.display());
    let done = format!("{} of {all} cells", found.tasks);
    match (found.is_ended, found.is_torn) {
        (true, false) if found.tasks == all => Ok(()),
        (false, false) => Err(Failure::work(anyhow!(
            "{shard} is not finished ({done}): run its command again to resume it"
        ))),
        _ => Err(Failure::work(anyhow!(
            "{shard} is damaged after {done}: run its command again to repeat the rest"
        ))),
    }
}

/// The shard numbers as text. If there are more than [`MAX_LISTED`] numbers, the text lists only the first of them.
pub(crate) fn listed(numbers: &[u64]) -> String {
    let few = numbers.iter().take(MAX_LISTED).map(u64::to_string);
    let few: Vec<String> = few.collect();
    match numbers.len() > MAX_LISTED {
        true => format!("{} and {} more", few.join(", "), numbers.len() - MAX_LISTED),
        false => few.join(", "),
    }
}

pub(crate) fn totals_of<'f>(all: impl Iterator<Item = &'f JournalState>) -> Totals {
    let mut totals = Totals::default();
    for found in all {
        totals.cells += found.totals.cells;
        totals.trials += found.totals.trials;
        for (kind, count) in &found.totals.kinds {
            *totals.kinds.entry(kind.clone()).or_default() += count;
        }
    }
    totals
}
