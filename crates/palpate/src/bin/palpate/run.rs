//! Implements the command `palpate run`.

mod journal_run;
mod run_tables;

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, anyhow};
use palpate::{
    RunOptions, Runner, Simulation, Study, Warning, Warnings, check_outputs, load, parse, resolved,
};

use crate::answer_commands::note_ignored_fields;
use crate::budget;
use crate::cli::RunArgs;
use crate::failure::Failure;
use crate::journal::{self, Header, Reader, RunRequest, Totals};
use crate::output::names::{CONFIG, JOURNAL};
use crate::output::{self, Contents, Format, Guard, LockedDir, OutputDir, StudyId};

use journal_run::{JournalRun, journal_to_resume};

pub(crate) use journal_run::difference;
pub(crate) use run_tables::{Drafts, TrialsOut, output_names, requested_trace, write_results};

const MAX_THREADS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(255);

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let start = Instant::now();
    args.format.supported()?;
    if let (Format::Parquet, Some(shard)) = (args.format, args.shard) {
        return Err(Failure::usage(anyhow!(
            "--format parquet: shard {} of {} writes a journal and no tables; give --format to `palpate merge`",
            shard.number,
            shard.of
        )));
    }
    let study = study_of(args)?;
    let warn = |warning: &Warning| {
        if !args.quiet {
            output::print_note(warning);
        }
    };
    note_ignored_fields(&study, std::iter::empty());
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
        output_names(&study, args.format)
    } else {
        Vec::new()
    };
    // Check the output files now, before the planning, and again after the directory is locked.
    let check_files = |dir: &OutputDir, config: &str| {
        dir.refuse(CONFIG, Some(&Contents::Bytes(config.as_bytes())))?;
        tables.iter().try_for_each(|name| dir.refuse(name, None))
    };
    check_files(&OutputDir::read(&out, guard.clone())?, &resolved(&study))?;
    let request = RunRequest {
        config: resolved(&study),
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
        false => journal_to_resume(&out, &request)?,
    };
    let numbers = numbers_of(&study, args.every_nth_cell.get());
    let (mut choice, mut planned) = (Vec::new(), Warnings::default());
    let study = match &found {
        Some(found) => parse("run.toml", &found.header.config).map_err(Failure::usage)?,
        None => match budget::choose(&study, &numbers, args, start)? {
            Some(allowed) => {
                (choice, planned) = (allowed.lines, allowed.warnings);
                allowed.study
            }
            None => study,
        },
    };
    let runner = Runner::new(&RunOptions {
        threads: args.threads.map(|threads| threads.min(MAX_THREADS)),
        ..RunOptions::default()
    })
    .map_err(Failure::work)?;
    let cells = numbers.len();
    let first = numbers[0];
    let simulation = Simulation::of_shard(&study, numbers, shard, &runner);
    let mut simulation = match found {
        // If the run resumes a journal, do not check the cells again: all cells were checked before the journal was
        // started.
        Some(_) => simulation,
        None => simulation.and_then(Simulation::checked),
    }
    .map_err(Failure::usage)?;
    simulation.has_trials = args.trials_out.is_some();
    if let Some(trials_out) = &trials_out {
        trials_out.refuse_other(&simulation)?;
    }

    let mut folder = LockedDir::open(&out, guard)?;
    let config = resolved(&study);
    check_files(folder.output(), &config)?;
    // Compute the requested trace before the trials run, so that an impossible trace fails early.
    let trace = match is_whole {
        true => requested_trace(&study, first)?,
        false => Vec::new(),
    };
    let of_study = StudyId::new(&study.config.name, &config);
    folder.begin(&config, &of_study)?;
    let (known, of_header) = match &found {
        Some(found) => (found.warnings.clone(), found.header.warnings.clone()),
        None => {
            let mut known = planned.clone();
            known.merge(simulation.warnings.clone());
            // If only a sample of the cells was checked, each cell reports its own warnings when it runs. Do not count
            // the warnings of the check as well.
            let is_sampled = simulation.is_sampled();
            (known.clone(), if is_sampled { planned } else { known })
        }
    };
    let known = known.grouped(cells);
    known.iter().for_each(warn);
    if !choice.is_empty() {
        print(&choice.join("\n"))?;
    }
    let tasks = [simulation.tasks(), cells as u64];
    let header = Header::new(config.clone(), request, of_header, tasks);
    let run = JournalRun::begin(&simulation, &out, header, found, args.restart)?;
    let (totals, warnings) = run.run()?;
    let warnings = warnings.grouped(cells);
    let is_new = |warning: &&Warning| !known.contains(warning);
    warnings.iter().filter(is_new).for_each(warn);
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
        write_results(&mut folder, files, trace, &config, &warnings, &of_study)?;
        let path = out.join(JOURNAL);
        std::fs::remove_file(&path)
            .with_context(|| format!("cannot remove {}", path.display()))
            .map_err(Failure::work)?;
    }
    let summary = summary(&study.config.name, &of_shard, &totals, &out);
    if is_whole && !totals.has_success {
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

/// The study in the config file, with the seed and the number of trials that the arguments state. Rejects arguments
/// that contradict each other or the config.
fn study_of(args: &RunArgs) -> Result<Study, Failure> {
    let by_target = args.target_error.map(|_| "--target-error");
    let chosen_by = args.budget.map(|_| "--budget").or(by_target);
    let study = overridden(&args.config, args.seed, args.trials, chosen_by)?;
    if args.budget.is_some() && args.shard.is_some() {
        return Err(Failure::usage(anyhow!(
            "--budget depends on the machine, but all shards must have the same trials: run --budget once to write a run.toml, and run the shards from this file"
        )));
    }
    check_outputs(&study).map_err(Failure::usage)?;
    Ok(study)
}

/// Loads a study, and replaces its seed and its number of trials by the arguments `seed` and `trials`, if these are
/// given. `chosen_by` is the name of another argument that chooses the number of trials, if the user gave it. If the
/// study has a stopping rule, `trials` and the argument `chosen_by` are errors, because this rule determines the number
/// of trials.
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
            "{option} sets the number of trials, but `stop` in {} also decides it: remove one of them",
            config.display()
        )));
    }
    let trials = trials.map(|trials| trials.get());
    study
        .override_numbers(seed, trials)
        .map_err(Failure::usage)?;
    Ok(study)
}

/// Text of the arguments `--budget` and `--target-error`. A resumed run compares this text with the text in its
/// journal.
fn goal_of(args: &RunArgs) -> String {
    let budget = args.budget.map(|budget| format!("--budget {budget:?}"));
    let target = args
        .target_error
        .map(|target| format!("--target-error {target}"));
    let both: Vec<String> = budget.into_iter().chain(target).collect();
    both.join(" ")
}

/// Numbers of the cells that the run consists of: every n-th cell of the study. If the run is divided into shards,
/// these cells are divided among the shards.
pub(crate) fn numbers_of(study: &Study, every_nth_cell: usize) -> Vec<usize> {
    (0..study.cell_count()).step_by(every_nth_cell).collect()
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
