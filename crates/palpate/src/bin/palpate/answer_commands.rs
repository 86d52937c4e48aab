//! Implements the commands `palpate design`, `palpate distinguish` and `palpate sensitivity`.

use std::time::Instant;

use palpate::config::{Study, Vary};
use palpate::{Answer, AnswerError, ConfigError, Extreme, Question, Sought, load};

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

pub(crate) fn design(args: &DesignArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let mut study = load(&args.answer.config).map_err(Failure::usage)?;
    study
        .override_numbers(args.answer.seed, None)
        .map_err(Failure::usage)?;
    let question = question(args, &study).map_err(failure)?;
    let vary = question.grid.iter().chain([&question.searched]);
    let vary = vary.map(|vary| vary.path.as_str());
    let set = question.set.iter().map(|(path, _)| path.as_str());
    note_ignored_fields(&study, vary.chain(set));
    let folder = open_dir(&args.answer)?;
    let bar = progress::counter_of("trials");
    let show_progress = |values: usize, trials: u64| {
        if start.elapsed() >= progress::QUIET_TIME {
            bar.set_message(format!("; {values} values"));
            bar.set_position(trials);
        }
    };
    let (runner, clock) = (runner(args.answer.threads)?, || start.elapsed());
    let found = palpate::design(&study, &question, &runner, &clock, &show_progress);
    bar.finish_and_clear();
    let found = found.map_err(failure)?;
    let others = [
        (DESIGN_CONFIG, palpate::resolved(&study)),
        (DESIGN_REGION, found.runs().to_csv()),
    ];
    let names = [DESIGN, DESIGN_WORDS, DESIGN_FIGURE];
    output_answer(&args.answer, folder, &study, &found, names, others.into())
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
    let folder = open_dir(&args.answer)?;
    let (quantity, runner) = (args.quantity.as_deref(), runner(args.answer.threads)?);
    let found = progress::counting("cells", |progress| {
        palpate::distinguish(&study, quantity, args.confidence, &runner, progress)
    })
    .map_err(failure)?;
    let names = [DISTINGUISH, DISTINGUISH_WORDS, DISTINGUISH_FIGURE];
    output_answer(&args.answer, folder, &study, &found, names, Vec::new())
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
    let folder = open_dir(&args.answer)?;
    let (quantity, runner) = (args.quantity.as_deref(), runner(args.answer.threads)?);
    let (trials, step) = (args.trials.get(), args.step);
    let found = progress::counting("fields", |progress| {
        palpate::sensitivity(&study, quantity, trials, step, &runner, progress)
    })
    .map_err(failure)?;
    let names = [SENSITIVITY, SENSITIVITY_WORDS, SENSITIVITY_FIGURE];
    output_answer(&args.answer, folder, &study, &found, names, Vec::new())
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
            output::print_note(format_args!("note: {note}"));
        }
    }
}

/// Writes the files of an answer into `folder`, in place of the files of an earlier answer, and prints the answer as JSON
/// or as lines of text. The last line names the directory. `names` are the names of the table, of the text and of the
/// figure; `others` are the names and contents of further files.
fn output_answer(
    args: &AnswerArgs,
    folder: Option<LockedDir>,
    study: &Study,
    answer: &impl Answer,
    [table, words, figure]: [&str; 3],
    others: Vec<(&str, String)>,
) -> Result<(), Failure> {
    let mut lines = answer.lines();
    if let Some(mut folder) = folder {
        let texts = [
            (table, answer.table().to_csv()),
            (words, format!("{}\n", lines.join("\n"))),
        ];
        let texts = texts.into_iter().chain(others);
        let texts = texts.map(|(name, text)| (name.to_owned(), text.into_bytes()));
        let mut files: Vec<(String, Vec<u8>)> = texts.collect();
        let figure = answer.figure(figure, study.heading());
        files.extend(drawings(&[figure.map_err(Failure::work)?])?);
        let contents = files.iter();
        let contents = contents.map(|(name, bytes)| (name.as_str(), Contents::Bytes(bytes)));
        let of_study = StudyId::new(&study.config.name, &palpate::resolved(study));
        let left = folder.replace(contents.collect(), &of_study)?;
        left.iter()
            .for_each(|line| output::print_note(format_args!("warning: {line}")));
    }
    if args.json {
        return output::print(&output::json(&answer.to_json(study))?);
    }
    let files = args.out.iter();
    lines.extend(files.map(|dir| format!("files    {}", dir.display())));
    output::print(&lines.join("\n"))
}
