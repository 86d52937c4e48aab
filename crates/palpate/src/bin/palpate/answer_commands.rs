//! Implements the commands `palpate design`, `palpate distinguish` and `palpate sensitivity`.

use std::time::{Duration, Instant};

use palpate::config::{Study, Vary};
use palpate::{AnswerError, ConfigError, Extreme, Figure, Question, ReportError, Sought, load};
use serde_json::Value;

use crate::budget::runner;
use crate::cli::{AnswerArgs, DesignArgs, DistinguishArgs, SensitivityArgs};
use crate::failure::Failure;
use crate::output::names::{
    DESIGN, DESIGN_CONFIG, DESIGN_FIGURE, DESIGN_REGION, DESIGN_WORDS, DISTINGUISH,
    DISTINGUISH_FIGURE, DISTINGUISH_WORDS, SENSITIVITY, SENSITIVITY_FIGURE, SENSITIVITY_WORDS,
};
use crate::output::{self, Contents, Guard, LockedDir, StudyId};
use crate::progress;
use crate::results::drawings;
use crate::run::overridden;

/// A progress bar appears only if the work takes longer than this time.
const QUIET_TIME: Duration = Duration::from_secs(1);

pub(crate) fn design(args: &DesignArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let mut study = load(&args.answer.config).map_err(Failure::usage)?;
    if let Some(seed) = args.answer.seed {
        study.override_seed(seed).map_err(Failure::usage)?;
    }
    let question = question(args, &study).map_err(failure)?;
    let vary = question.grid.iter().chain([&question.searched]);
    let vary = vary.map(|vary| vary.path.as_str());
    let set = question.set.iter().map(|(path, _)| path.as_str());
    note_ignored_fields(&study, vary.chain(set));
    let mut folder = open_dir(&args.answer)?;
    let bar = progress::counter_of("trials");
    let show_progress = |values: usize, trials: u64| {
        if start.elapsed() >= QUIET_TIME {
            bar.set_message(format!("; {values} values"));
            bar.set_position(trials);
        }
    };
    let (runner, clock) = (runner(args.answer.threads)?, || start.elapsed());
    let found = palpate::design(&study, &question, &runner, &clock, &show_progress);
    bar.finish_and_clear();
    let found = found.map_err(failure)?;
    let lines: Vec<String> = [found.sentence()]
        .into_iter()
        .chain(found.lines())
        .collect();
    if let Some(folder) = &mut folder {
        let texts = vec![
            (DESIGN_WORDS, format!("{}\n", lines.join("\n"))),
            (DESIGN_CONFIG, palpate::resolved(&study)),
            (DESIGN, found.table().to_csv()),
            (DESIGN_REGION, found.runs().to_csv()),
        ];
        let figure = found.figure(DESIGN_FIGURE, study.heading());
        write(folder, &study, texts, figure)?;
    }
    print(&args.answer, lines, || found.to_json(&study))
}

fn question(args: &DesignArgs, study: &Study) -> Result<Question, AnswerError> {
    let sought = match (&args.maximise, &args.minimise) {
        (Some(name), _) => Some((name, Extreme::Largest)),
        (None, Some(name)) => Some((name, Extreme::Smallest)),
        (None, None) => None,
    };
    let sought = sought.map(|(name, extreme)| {
        let path = study.path_of(name)?;
        Ok::<_, ConfigError>(Sought { path, extreme })
    });
    let vary: Result<Vec<Vary>, _> = args.vary.iter().map(|vary| study.resolve(vary)).collect();
    Ok(Question {
        max_failures: args.max_failures,
        set: study.resolve_each(&args.answer.set)?,
        gap: args.gap,
        most_trials: args.most_trials.get(),
        budget: Some(args.budget),
        ..Question::new(args.target, vary?, sought.transpose()?)?
    })
}

pub(crate) fn distinguish(args: &DistinguishArgs) -> Result<(), Failure> {
    let study = overridden(&args.answer.config, args.answer.seed, args.trials, None)?;
    let set = args.answer.set.iter();
    let set = set.map(|(name, value)| study.resolve_values(name, std::slice::from_ref(value)));
    let vary = args
        .vary
        .iter()
        .map(|(name, values)| study.resolve_values(name, values));
    let fields: Result<Vec<_>, _> = vary.chain(set).collect();
    let fields = fields.map_err(Failure::usage)?;
    note_ignored_fields(&study, fields.iter().map(|(path, _)| path.as_str()));
    let study = match fields.is_empty() {
        true => study,
        false => study.varied(&fields).map_err(Failure::usage)?,
    };
    let mut folder = open_dir(&args.answer)?;
    let bar = progress::bar_of("cells");
    let show_progress = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let found = palpate::distinguish(
        &study,
        args.quantity.as_deref(),
        args.confidence,
        &runner(args.answer.threads)?,
        &show_progress,
    );
    bar.finish_and_clear();
    let found = found.map_err(failure)?;
    if let Some(folder) = &mut folder {
        let texts = vec![
            (DISTINGUISH, found.table().to_csv()),
            (
                DISTINGUISH_WORDS,
                format!("{}\n", found.sentences().join("\n")),
            ),
        ];
        let figure = found.figure(DISTINGUISH_FIGURE, study.heading());
        write(folder, &study, texts, figure)?;
    }
    print(&args.answer, found.sentences(), || found.to_json(&study))
}

pub(crate) fn sensitivity(args: &SensitivityArgs) -> Result<(), Failure> {
    let study = overridden(&args.answer.config, args.answer.seed, None, None)?;
    let set = study
        .resolve_each(&args.answer.set)
        .map_err(Failure::usage)?;
    note_ignored_fields(&study, set.iter().map(|(path, _)| path.as_str()));
    let set: Vec<_> = set
        .into_iter()
        .map(|(path, value)| (path, vec![value]))
        .collect();
    let study = study.varied(&set).map_err(Failure::usage)?;
    let mut folder = open_dir(&args.answer)?;
    let bar = progress::bar_of("fields");
    let show_progress = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let found = palpate::sensitivity(
        &study,
        args.quantity.as_deref(),
        args.trials.get(),
        args.step,
        &runner(args.answer.threads)?,
        &show_progress,
    );
    bar.finish_and_clear();
    let found = found.map_err(failure)?;
    if let Some(folder) = &mut folder {
        let texts = vec![
            (SENSITIVITY, found.table().to_csv()),
            (SENSITIVITY_WORDS, format!("{}\n", found.lines().join("\n"))),
        ];
        let figure = found.figure(SENSITIVITY_FIGURE, study.heading());
        write(folder, &study, texts, figure)?;
    }
    print(&args.answer, found.lines(), || found.to_json(&study))
}

fn failure(error: AnswerError) -> Failure {
    match error {
        AnswerError::Config(error) => Failure::usage(error),
        error => Failure::usage(error),
    }
}

/// Opens the directory for the files of the answer, if `--out` names a directory. It is opened before the answer is
/// computed, so that an unwritable directory causes an error early.
fn open_dir(args: &AnswerArgs) -> Result<Option<LockedDir>, Failure> {
    let guard = Guard::new([&args.config], args.force);
    let out = args.out.as_ref();
    out.map(|dir| LockedDir::open(dir, guard)).transpose()
}

/// Prints a note for each field to which the config gives both a value and a sweep. Fields in `paths` get no note,
/// because command-line arguments set them.
pub(crate) fn note_ignored_fields<'a>(study: &Study, paths: impl Iterator<Item = &'a str>) {
    let set: Vec<&str> = paths.collect();
    for (path, note) in study.swept_over() {
        if !set.contains(&path.as_str()) {
            eprintln!("note: {note}");
        }
    }
}

/// Writes the texts and the figure of an answer into `folder`, and replaces the files of an earlier answer.
fn write(
    folder: &mut LockedDir,
    study: &Study,
    texts: Vec<(&str, String)>,
    figure: Result<Figure, ReportError>,
) -> Result<(), Failure> {
    let texts = texts.into_iter();
    let texts = texts.map(|(name, text)| (name.to_owned(), text.into_bytes()));
    let mut files: Vec<(String, Vec<u8>)> = texts.collect();
    files.extend(drawings(&[figure.map_err(Failure::work)?])?);
    let contents = files.iter();
    let contents = contents.map(|(name, bytes)| (name.as_str(), Contents::Bytes(bytes)));
    let of_study = StudyId::new(&study.config.name, &palpate::resolved(study));
    let left = folder.replace(contents.collect(), &of_study)?;
    left.iter().for_each(|line| eprintln!("warning: {line}"));
    Ok(())
}

/// Prints an answer as JSON or as lines of text. The last line names the directory with the answer's files.
fn print(
    args: &AnswerArgs,
    mut lines: Vec<String>,
    value: impl FnOnce() -> Value,
) -> Result<(), Failure> {
    if args.json {
        return output::print(&output::json(&value())?);
    }
    let files = args.out.iter();
    lines.extend(files.map(|dir| format!("files    {}", dir.display())));
    output::print(&lines.join("\n"))
}
