//! `palpate run`.

use std::io::Write;
use std::num::{NonZeroU64, NonZeroUsize};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, anyhow};
use palpate::config::Output;
use palpate::{
    Finished, Partial, RunOptions, Runner, Simulation, Study, SweepError, Taken, Warnings, load,
    parse, refuse,
};

use crate::cli::RunArgs;
use crate::failure::Failure;
use crate::journal::{
    self, Asked, CellRecord, Found, Header, Item, Journal, Reader, Superblock, Totals, TrialRows,
};
use crate::output::names::{
    CELLS, CONFIG, FAILURES, FRAMES, JOURNAL, MAP, MARKERS, NEXT_CONFIG, READINGS, TRACE, WARNINGS,
};
use crate::output::{Contents, Draft, Folder, Guard, Lock, Owned, Single, StudyId, Written};
use crate::progress::Progress;
use crate::{budget, output, stopped, trace};

/// More threads than this only cost their setting up.
const MOST_THREADS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(255);

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let study = asked_study(args)?;
    let shard = args.shard.unwrap_or_default();
    let is_whole = args.shard.is_none();
    let out = args.out.clone().unwrap_or_else(|| {
        let out = PathBuf::from("out").join(&study.config.name);
        match is_whole {
            true => out,
            false => out.join(format!("shard-{}-of-{}", shard.number, shard.of)),
        }
    });
    let guard = Guard::new([&args.config], args.force);
    let tables = if is_whole {
        tables_of(&study)
    } else {
        Vec::new()
    };
    // Before the planning, and once more when no other process writes there.
    let refuse = |owned: &Owned, config: &str| {
        owned.refuse(CONFIG, Some(&Contents::Bytes(config.as_bytes())))?;
        tables.iter().try_for_each(|name| owned.refuse(name, None))
    };
    refuse(&Owned::read(&out, guard.clone())?, &trace::resolved(&study))?;
    let asked = Asked {
        config: trace::resolved(&study),
        goal: goal_of(args),
        every_nth_cell: args.every_nth_cell.get() as u64,
        shard: args.shard.map(|shard| (shard.number, shard.of)),
        trials_out: args.trials_out.is_some(),
    };
    let trials_out = args.trials_out.as_ref();
    let trials_out = trials_out.map(|path| Single::new("--trials-out", path, guard.clone()));
    let trials_out = trials_out.transpose()?;
    let found = match args.restart {
        true => {
            journal::refuse_other(&out)?;
            None
        }
        false => resumable(&out, &asked)?,
    };
    let numbers = numbers_of(&study, args.every_nth_cell.get());
    let mut said = None;
    let study = match &found {
        Some(found) => parse("run.toml", &found.header.config).map_err(Failure::usage)?,
        None => {
            let allowed = budget::choose(&study, &numbers, args, start)?;
            match allowed {
                Some(allowed) => {
                    said = Some((allowed.lines, allowed.warnings));
                    allowed.study
                }
                None => study,
            }
        }
    };
    let runner = Runner::new(&RunOptions {
        threads: args.threads.map(|threads| threads.min(MOST_THREADS)),
        ..RunOptions::default()
    })
    .map_err(Failure::work)?;
    let cells = numbers.len();
    let first = numbers[0];
    let simulation = Simulation::of_shard(&study, numbers, shard, &runner);
    let simulation = match found {
        // What the journal has of it was checked, and what it lacks, before it was begun.
        Some(_) => simulation,
        None => simulation.and_then(Simulation::checked),
    }
    .map_err(Failure::usage)?;
    let simulation = match args.trials_out.is_some() {
        true => simulation.with_trials(),
        false => simulation,
    };
    if let (Some(trials_out), [.., Some(header)]) = (&trials_out, simulation.headers()) {
        trials_out.refuse_other(&header)?;
    }

    let mut folder = Folder::open(&out, guard)?;
    let config = trace::resolved(&study);
    refuse(folder.owned(), &config)?;
    // Before the work, which would be lost where there is no pass to follow.
    let traced = match is_whole {
        true => traced(&study, first)?,
        false => Vec::new(),
    };
    let of_study = StudyId::new(&study.config.name, &config);
    folder.begin(&config, &of_study)?;
    let told = match &found {
        Some(found) => found.warnings.clone(),
        None => simulation.told().clone(),
    };
    told.lines(cells)
        .iter()
        .for_each(|line| eprintln!("{line}"));
    if let Some((lines, warnings)) = said {
        for warning in warnings {
            eprintln!("warning: {warning}");
        }
        output::print(&lines.join("\n"))?;
    }
    // Cells that tell their warnings when they are run are not counted twice.
    let of_header = match simulation.is_sampled() {
        true => Warnings::default(),
        false => told.clone(),
    };
    let tasks = [simulation.tasks(), simulation.all_tasks()];
    let header = Header::new(config.clone(), asked, &of_header, tasks);
    let ongoing = Ongoing::begin(&simulation, &out, header, of_header, found, args.restart)?;
    let (totals, warnings) = ongoing.run()?;
    let known = told.lines(cells);
    let lines = warnings.lines(cells);
    let is_new = |line: &&String| simulation.is_sampled() && !known.contains(line);
    lines
        .iter()
        .filter(is_new)
        .for_each(|line| eprintln!("{line}"));
    let of_shard = match is_whole {
        true => String::new(),
        false => format!("shard {} of {}, ", shard.number, shard.of),
    };
    if is_whole {
        let reader = Reader::open(&out)?.map(|(reader, _)| reader);
        let readers = reader.into_iter().collect();
        let drafts = Drafts::new(&folder, &simulation, trials_out.as_ref())?;
        let (files, _) = drafts.fill(&simulation, readers, false)?;
        end(&mut folder, files, traced, &config, &lines, &of_study)?;
        remove_journal(&out)?;
    }
    let summary = summary(&study.config.name, &of_shard, &totals, &out);
    if is_whole && !totals.is_alive {
        return Err(Failure::work(anyhow!("every trial failed: {summary}")));
    }
    output::print(&summary)
}

/// The study with what arguments change of it.
fn asked_study(args: &RunArgs) -> Result<Study, Failure> {
    let chooses = [
        ("--budget", args.budget.is_some()),
        ("--target-error", args.target_error.is_some()),
    ];
    let chosen = chooses.iter().find(|(_, is_given)| *is_given);
    let study = overridden(
        &args.config,
        args.seed,
        args.trials,
        chosen.map(|(name, _)| *name),
    )?;
    if args.budget.is_some() && args.shard.is_some() {
        return Err(Failure::usage(anyhow!(
            "--budget hangs on the machine, and shards must have the same trials: run --budget once for a run.toml, \
             and its shards from that"
        )));
    }
    refuse(&study).map_err(Failure::usage)?;
    Ok(study)
}

/// Study of a config with another seed and number of trials. `chosen_by` names another argument that chooses trials.
pub(crate) fn overridden(
    config: &Path,
    seed: Option<u64>,
    trials: Option<NonZeroU64>,
    chosen_by: Option<&str>,
) -> Result<Study, Failure> {
    let mut study = load(config).map_err(Failure::usage)?;
    let option = trials.map(|_| "--trials").or(chosen_by);
    if let (Some(option), Some(_)) = (option, &study.config.stop) {
        return Err(Failure::usage(anyhow!(
            "{option} sets the number of trials, and `stop` in {} decides it: leave one of them out",
            config.display()
        )));
    }
    if let Some(seed) = seed {
        study.override_seed(seed).map_err(Failure::usage)?;
    }
    if let Some(trials) = trials {
        study
            .override_trials(trials.get())
            .map_err(Failure::usage)?;
    }
    Ok(study)
}

/// Arguments that choose trials and model, as they are compared.
fn goal_of(args: &RunArgs) -> String {
    let budget = args.budget.map(|budget| format!("--budget {budget:?}"));
    let target = args
        .target_error
        .map(|target| format!("--target-error {target}"));
    let both: Vec<String> = budget.into_iter().chain(target).collect();
    both.join(" ")
}

/// Numbers of the cells that all shards run together.
pub(crate) fn numbers_of(study: &Study, every_nth_cell: usize) -> Vec<usize> {
    (0..study.cell_count()).step_by(every_nth_cell).collect()
}

/// Journal with which a run goes on; refuses one of another run.
fn resumable(out: &Path, asked: &Asked) -> Result<Option<Found>, Failure> {
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

/// Files of the pass of a cell, where the config asks for them.
pub(crate) fn traced(study: &Study, cell: usize) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
    if !study.config.outputs.contains(&Output::Trace) {
        return Ok(Vec::new());
    }
    let trace = palpate::trace(study, cell, None).map_err(trace::refused)?;
    trace::files(&trace)
}

/// Run of which some tasks are done.
struct Ongoing<'s, 'a> {
    simulation: &'s Simulation<'a>,
    journal: Journal,
    totals: Totals,
    warnings: Warnings,
    /// Number of tasks that are done.
    tasks: u64,
    /// Sums of the heavy cell that has not been completed.
    open: Option<Partial>,
    /// Sums of the first trials of the next task, and the number of the trial that follows.
    started: Option<(Partial, u64)>,
    /// Rows of trials of the task that has not been completed.
    rows: String,
    is_shared: bool,
}

/// Rows of trials that are kept in memory before they are written, bytes.
const MOST_ROWS: usize = 1 << 20;

impl<'s, 'a> Ongoing<'s, 'a> {
    /// Begins a journal, or goes on with one that was found.
    fn begin(
        simulation: &'s Simulation<'a>,
        out: &Path,
        header: Header,
        warnings: Warnings,
        found: Option<Found>,
        restarts: bool,
    ) -> Result<Self, Failure> {
        let is_shared = header.asked.shard.is_some();
        // Since it was looked for, another process may have ended it, or begun one.
        let now = match restarts {
            true => None,
            false => journal::read(out)?.filter(Found::has_work),
        };
        let is_known = now.as_ref().is_none_or(|now| {
            let found = found.as_ref();
            found.is_some_and(|found| found.header == now.header)
        });
        let path = out.join(JOURNAL);
        let cannot = || format!("cannot write {}", path.display());
        if !is_known {
            return Err(Failure::work(anyhow!(
                "another process wrote {} meanwhile: give the same command again",
                path.display()
            )));
        }
        let Some(found) = now else {
            let journal = Journal::new(out, &header).with_context(cannot);
            return Ok(Self {
                simulation,
                journal: journal.map_err(Failure::work)?,
                totals: Totals::default(),
                warnings,
                tasks: 0,
                open: None,
                started: None,
                rows: String::new(),
                is_shared,
            });
        };
        if found.is_torn {
            eprintln!(
                "note: the end of {} is damaged, and is done again",
                path.display()
            );
        }
        let (all, started) = (simulation.tasks(), found.started.as_ref());
        let what = match found.superblock_trials {
            0 => "cells",
            _ => "parts",
        };
        let started = started.map_or_else(String::new, |(_, trial)| {
            format!(", and {trial} trials of the next")
        });
        eprintln!(
            "note: goes on after {} of {all} {what}{started}",
            found.tasks
        );
        let journal = Journal::resumed(out, &found).with_context(cannot);
        let mut ongoing = Self {
            simulation,
            journal: journal.map_err(Failure::work)?,
            totals: found.totals,
            warnings: found.warnings,
            tasks: found.tasks,
            open: None,
            started: found.started,
            rows: String::new(),
            is_shared,
        };
        if let Some(open) = found.open.filter(|_| !is_shared) {
            match open.superblock + 1 == open.of {
                true => ongoing.end_of_cell(open)?,
                false => ongoing.open = Some(open.partial),
            }
        }
        Ok(ongoing)
    }

    /// Notes a heavy cell all superblocks of which are in the journal.
    fn end_of_cell(&mut self, open: Superblock) -> Result<(), Failure> {
        let cell = open.cell as usize;
        let finished = self.simulation.finished(cell, open.partial);
        let rows = self.simulation.rows(&finished.map_err(Failure::usage)?);
        let noted = self.cell(CellRecord::new(cell, false, rows));
        noted
            .context("cannot write the journal")
            .map_err(Failure::work)
    }

    /// Notes a cell that is done.
    fn cell(&mut self, record: CellRecord) -> std::io::Result<()> {
        self.totals.add(&record);
        let warnings = record.warnings.clone();
        self.warnings.add(record.cell as usize, warnings);
        self.journal.cell(record)
    }

    /// Runs the tasks that are left.
    fn run(mut self) -> Result<(Totals, Warnings), Failure> {
        let simulation = self.simulation;
        let all = simulation.trials();
        let done = simulation.trials_before(self.tasks);
        let progress = Progress::new(all, done);
        let signals = stopped::Signals::new()?;
        let first = self.tasks;
        let mut error = None;
        let ran = simulation.stream(
            first,
            self.started.take(),
            signals.stop(),
            &|trials| progress.add(trials),
            |finished| match finished.superblock() {
                (_, 1) => Made::Cell(CellRecord::new(
                    finished.cell(),
                    true,
                    simulation.rows(&finished),
                )),
                _ => Made::Superblock(Box::new(finished)),
            },
            &mut |number, taken| match self.take(number, taken) {
                Ok(()) => {
                    progress.tell(&self.totals);
                    ControlFlow::Continue(())
                }
                Err(cause) => {
                    error = Some(cause);
                    ControlFlow::Break(())
                }
            },
        );
        progress.end();
        let path = self.journal.path().display().to_string();
        let again = "the same command goes on from there";
        if let Some(error) = error {
            let error = error.context(format!(
                "cannot write {path}; what is written stays, and {again}"
            ));
            return Err(Failure::work(error));
        }
        let flushed = self.journal.flush();
        match ran {
            Err(SweepError::Cancelled) => {
                flushed
                    .with_context(|| format!("cannot write {path}"))
                    .map_err(Failure::work)?;
                Err(Failure::Stopped(
                    anyhow!(
                        "stopped: {} of {} {} are in {path}; {again}",
                        self.tasks,
                        simulation.tasks(),
                        "parts of the run"
                    ),
                    signals.status(),
                ))
            }
            Err(error) => Err(Failure::of_sweep(error)),
            Ok(()) => {
                let ended = match self.is_shared {
                    true => self.journal.end(),
                    false => flushed,
                };
                let cannot = || format!("cannot write {path}; {again}");
                ended.with_context(cannot).map_err(Failure::work)?;
                Ok((self.totals, self.warnings))
            }
        }
    }

    /// Notes rows of trials of the task of this number.
    fn trials(&mut self, number: u64, rows: &str) -> Result<(), anyhow::Error> {
        self.rows.push_str(rows);
        if self.rows.len() > MOST_ROWS {
            self.put_rows(number)?;
        }
        Ok(())
    }

    /// Writes the rows of trials of the task of this number.
    fn put_rows(&mut self, number: u64) -> std::io::Result<()> {
        let rows = std::mem::take(&mut self.rows);
        if rows.is_empty() {
            return Ok(());
        }
        let (cell, superblock) = self.simulation.place(number);
        self.journal.trials(TrialRows {
            cell: cell as u64,
            superblock,
            rows,
        })
    }

    /// Notes what a task gave.
    fn take(&mut self, number: u64, taken: Taken<Made>) -> Result<(), anyhow::Error> {
        let made = match taken {
            Taken::Note(rows) => return self.trials(number, &rows),
            Taken::Open(partial, trial) => {
                self.put_rows(number)?;
                return Ok(self.journal.started(partial, trial)?);
            }
            Taken::Result(made) => made,
        };
        match made {
            Made::Cell(mut record) => {
                record.rows[3] = std::mem::take(&mut self.rows);
                self.cell(record)?;
            }
            Made::Superblock(finished) => {
                let (superblock, of) = finished.superblock();
                let cell = finished.cell();
                let partial = finished.partial().clone();
                self.put_rows(number)?;
                self.journal.superblock(Superblock {
                    cell: cell as u64,
                    superblock,
                    of,
                    partial: partial.clone(),
                })?;
                if self.is_shared {
                    self.totals.trials += partial.trials();
                } else {
                    let mut open = self.open.take().unwrap_or_default();
                    open.merge(partial);
                    if superblock + 1 == of {
                        let rows = self.simulation.rows(&finished.with(open));
                        self.cell(CellRecord::new(cell, false, rows))?;
                    } else {
                        self.open = Some(open);
                    }
                }
            }
        }
        self.tasks += 1;
        Ok(())
    }
}

/// What a task gave.
enum Made {
    Cell(CellRecord),
    Superblock(Box<Finished>),
}

/// Tables that are filled from journals.
pub(crate) struct Drafts<'s> {
    drafts: [Option<Draft>; 3],
    /// Table of trials.
    trials: Option<Written<'s>>,
    lacks: &'static str,
}

/// Tables with their names.
type Filled = Vec<(&'static str, Draft)>;

/// Names of the tables, in the order in which records have their rows.
const TABLES: [&str; 3] = [CELLS, FAILURES, MAP];

impl<'s> Drafts<'s> {
    /// Tables of a simulation, with their headers; that of trials is a file of its own.
    pub(crate) fn new(
        folder: &Folder,
        simulation: &Simulation<'_>,
        trials_out: Option<&'s Single>,
    ) -> Result<Self, Failure> {
        let mut drafts = [None, None, None];
        let [.., of_trials] = simulation.headers();
        let mut trials = trials_out.map(Single::begin).transpose()?;
        if let (Some(trials), Some(header)) = (&mut trials, of_trials) {
            trials.write(&header)?;
        }
        for ((draft, header), name) in drafts.iter_mut().zip(simulation.headers()).zip(TABLES) {
            if let Some(header) = header {
                let mut file = folder.draft(name)?;
                put(&mut file, name, &header)?;
                *draft = Some(file);
            }
        }
        Ok(Self {
            drafts,
            trials,
            lacks: simulation.lacks(),
        })
    }

    /// Tables with the rows of journals that share the cells of a simulation.
    pub(crate) fn fill(
        mut self,
        simulation: &Simulation<'_>,
        readers: Vec<Reader>,
        is_shared: bool,
    ) -> Result<(Filled, Totals), Failure> {
        let mut failed: Vec<String> = Vec::new();
        let mut totals = Totals::default();
        merge(simulation, readers, is_shared, &mut |merged| {
            let trials = self.trials.as_mut();
            let record = match merged {
                Merged::Trials(rows) => {
                    return trials.map_or(Ok(()), |trials| trials.write(rows));
                }
                Merged::Cell(record) => record,
            };
            if let Some(trials) = trials {
                trials.write(&record.rows[3])?;
            }
            totals.add(record);
            let rows = self.drafts.iter_mut().zip(&record.rows).zip(TABLES);
            for ((draft, rows), name) in rows {
                if let Some(draft) = draft {
                    put(draft, name, rows)?;
                }
            }
            if let Some(kind) = &record.map_failed {
                failed.push(format!("{} ({kind})", record.cell));
            }
            Ok(())
        })?;
        if !failed.is_empty() && self.drafts[2].is_some() {
            let (lacks, cells) = (self.lacks, failed.join(", "));
            eprintln!("warning: map.csv lacks {lacks} whose trial 0 failed: {cells}");
        }
        if let Some(trials) = self.trials {
            trials.end()?;
        }
        let files = TABLES.into_iter().zip(self.drafts);
        let files = files.filter_map(|(name, draft)| Some((name, draft?)));
        Ok((files.collect(), totals))
    }
}

fn put(draft: &mut Draft, name: &str, text: &str) -> Result<(), Failure> {
    let written = draft.write_all(text.as_bytes());
    written
        .with_context(|| format!("cannot write {name}; the same command tries again"))
        .map_err(Failure::work)
}

/// What journals have together, in the order of the cells.
enum Merged<'r> {
    /// Rows of trials of the cell that follows.
    Trials(&'r str),
    Cell(&'r CellRecord),
}

/// Hands over the cells of journals in the order of their numbers; heavy cells are put together from their superblocks.
fn merge(
    simulation: &Simulation<'_>,
    readers: Vec<Reader>,
    is_shared: bool,
    take: &mut dyn FnMut(Merged<'_>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let next = |reader: &mut Reader| loop {
        match reader.item()? {
            // A whole run has the cell itself after them.
            Item::Superblock(_) if !is_shared => {}
            item => return Some(item),
        }
    };
    let mut heads: Vec<(Reader, Option<Item>)> = Vec::new();
    for mut reader in readers {
        let first = next(&mut reader);
        heads.push((reader, first));
    }
    let place = |item: &Item| match item {
        Item::Trials(trials) => (trials.cell, trials.superblock),
        Item::Cell(record) => (record.cell, 0),
        Item::Superblock(superblock) => (superblock.cell, superblock.superblock),
    };
    let mut open = Partial::default();
    loop {
        let present = heads.iter_mut().filter(|(_, item)| item.is_some());
        let Some((reader, item)) = present.min_by_key(|(_, item)| item.as_ref().map(place)) else {
            return Ok(());
        };
        let Some(item) = std::mem::replace(item, next(reader)) else {
            return Ok(());
        };
        match item {
            Item::Trials(trials) => take(Merged::Trials(&trials.rows))?,
            Item::Cell(record) => take(Merged::Cell(&record))?,
            Item::Superblock(superblock) => {
                open.merge(superblock.partial);
                if superblock.superblock + 1 == superblock.of {
                    let cell = superblock.cell as usize;
                    let finished = simulation.finished(cell, std::mem::take(&mut open));
                    let rows = simulation.rows(&finished.map_err(Failure::usage)?);
                    take(Merged::Cell(&CellRecord::new(cell, false, rows)))?;
                }
            }
        }
    }
}

/// Gives the tables of a run their names.
pub(crate) fn end(
    folder: &mut Folder,
    tables: Filled,
    traced: Vec<(&'static str, Vec<u8>)>,
    config: &str,
    warnings: &[String],
    study: &StudyId,
) -> Result<(), Failure> {
    let told = warnings.join("\n") + "\n";
    let mut files: Vec<(&str, Contents<'_>)> = Vec::new();
    files.extend(
        tables
            .into_iter()
            .map(|(name, draft)| (name, Contents::Draft(draft))),
    );
    files.push((CONFIG, Contents::Bytes(config.as_bytes())));
    files.extend(
        traced
            .iter()
            .map(|(name, bytes)| (*name, Contents::Bytes(bytes))),
    );
    if !warnings.is_empty() {
        files.push((WARNINGS, Contents::Bytes(told.as_bytes())));
    }
    let written = folder.replace(files, study);
    let ended = folder.end();
    for line in written? {
        eprintln!("note: {line}");
    }
    ended
}

fn remove_journal(out: &Path) -> Result<(), Failure> {
    let path = out.join(JOURNAL);
    let removed = std::fs::remove_file(&path);
    removed
        .with_context(|| format!("cannot remove {}", path.display()))
        .map_err(Failure::work)
}

/// All that a run of the study may write besides its config.
pub(crate) fn tables_of(study: &Study) -> Vec<&'static str> {
    let mut names = vec![NEXT_CONFIG, CELLS, FAILURES, WARNINGS];
    if study.config.outputs.contains(&Output::Trace) {
        names.extend([TRACE, READINGS, MARKERS]);
        names.extend(FRAMES);
    }
    if study.config.outputs.contains(&Output::Map) {
        names.push(MAP);
    }
    names
}

pub(crate) fn summary(name: &str, of_shard: &str, totals: &Totals, out: &Path) -> String {
    let failed: u64 = totals.kinds.values().sum();
    let kinds = match failed {
        0 => String::new(),
        _ => format!(" ({})", totals.failures()),
    };
    format!(
        "{name}: {of_shard}{} cells, {} trials, {failed} failed{kinds} -> {}",
        totals.cells,
        totals.trials,
        out.display()
    )
}
