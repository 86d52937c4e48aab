//! `palpate run`.

mod ongoing;
mod resume;
mod tables;

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, anyhow};
use palpate::{RunOptions, Runner, Simulation, Study, Warnings, load, parse, refuse};

use crate::answers::tell_swept;
use crate::cli::RunArgs;
use crate::failure::Failure;
use crate::journal::{self, Asked, Header, Reader, Totals};
use crate::output::names::{CONFIG, JOURNAL};
use crate::output::{Contents, Folder, Format, Guard, Owned, StudyId};
use crate::{budget, trace};

use ongoing::Ongoing;
use resume::resumable;

pub(crate) use resume::difference;
pub(crate) use tables::{Drafts, TrialsOut, end, tables_of, traced};

/// More threads than this only cost their setting up.
const MOST_THREADS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(255);

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let start = Instant::now();
    args.format.supported()?;
    if let (Format::Parquet, Some(shard)) = (args.format, args.shard) {
        return Err(Failure::usage(anyhow!(
            "--format parquet: shard {} of {} leaves a journal, and no tables; give --format to `palpate merge`",
            shard.number,
            shard.of
        )));
    }
    let study = asked_study(args)?;
    let warn = |line: &str| {
        if !args.quiet {
            eprintln!("{line}");
        }
    };
    tell_swept(&study, std::iter::empty());
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
        tables_of(&study, args.format)
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
    let trials_out =
        trials_out.map(|path| TrialsOut::new(path, args.format, guard.clone(), &out, &study));
    let trials_out = trials_out.transpose()?;
    let print = |text: &str| TrialsOut::print(trials_out.as_ref(), text);
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
    if let Some(trials_out) = &trials_out {
        trials_out.refuse_other(&simulation)?;
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
    told.lines(cells).iter().for_each(|line| warn(line));
    if let Some((lines, warnings)) = said {
        for warning in warnings {
            eprintln!("warning: {warning}");
        }
        print(&lines.join("\n"))?;
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
    lines.iter().filter(is_new).for_each(|line| warn(line));
    let of_shard = match is_whole {
        true => String::new(),
        false => format!("shard {} of {}, ", shard.number, shard.of),
    };
    if is_whole {
        let reader = Reader::open(&out)?.map(|(reader, _)| reader);
        let readers = reader.into_iter().collect();
        let trials_out = trials_out.as_ref();
        let drafts = Drafts::new(&folder, &simulation, args.format, trials_out, &of_study)?;
        let (files, _) = drafts.fill(readers)?;
        end(&mut folder, files, traced, &config, &lines, &of_study)?;
        remove_journal(&out)?;
    }
    let summary = summary(&study.config.name, &of_shard, &totals, &out);
    if is_whole && !totals.is_alive {
        let most = totals.kinds.iter().max_by_key(|(_, count)| **count);
        let more = most.map_or(String::new(), |(kind, _)| {
            format!("; see `palpate explain {kind}`")
        });
        return Err(Failure::work(anyhow!(
            "every trial failed: {summary}{more}"
        )));
    }
    print(&summary)
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

fn remove_journal(out: &Path) -> Result<(), Failure> {
    let path = out.join(JOURNAL);
    let removed = std::fs::remove_file(&path);
    removed
        .with_context(|| format!("cannot remove {}", path.display()))
        .map_err(Failure::work)
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
