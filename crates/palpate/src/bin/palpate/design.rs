//! `palpate design`.

use std::time::{Duration, Instant};

use palpate::config::Study;
use palpate::{Answer, DesignError, Question, Side, load};
use serde_json::{Value, json};

use crate::budget::runner;
use crate::cli::DesignArgs;
use crate::failure::Failure;
use crate::output::names::{DESIGN, DESIGN_CONFIG, DESIGN_FIGURE, DESIGN_WORDS};
use crate::output::{self, Contents, Folder, Guard, StudyId};
use crate::results::drawings;
use crate::{progress, trace};

/// Time after which the progress is shown.
const QUIET: Duration = Duration::from_secs(1);

pub(crate) fn design(args: &DesignArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let mut study = load(&args.config).map_err(Failure::usage)?;
    if let Some(seed) = args.seed {
        study.override_seed(seed).map_err(Failure::usage)?;
    }
    // Before the work, which would be lost where nothing can be written.
    let guard = Guard::new([&args.config], args.force);
    let mut folder = match &args.out {
        Some(dir) => Some(Folder::open(dir, guard)?),
        None => None,
    };
    let question = Question {
        max_failures: args.max_failures,
        set: args.set.clone(),
        gap: args.gap,
        most_trials: args.most_trials.get(),
        budget: Some(args.budget),
        ..Question::new(args.target, args.vary.clone())
    };
    let bar = progress::bar_of("trials");
    let told = |values: usize, trials: u64| {
        if start.elapsed() >= QUIET {
            bar.set_message(format!("; {values} values"));
            bar.set_position(trials);
        }
    };
    let answer = palpate::design(
        &study,
        &question,
        &runner(args.threads)?,
        &|| start.elapsed(),
        &told,
    );
    bar.finish_and_clear();
    let answer = answer.map_err(refused)?;
    if let Some(folder) = &mut folder {
        write(folder, &study, &answer)?;
    }
    match args.json {
        true => output::print(&output::json(&value(&study, &answer))?),
        false => {
            let lines = [answer.sentence(), answer.lines().join("\n")];
            let files = args
                .out
                .as_ref()
                .map(|dir| format!("files    {}", dir.display()));
            output::print(
                &lines
                    .into_iter()
                    .chain(files)
                    .collect::<Vec<_>>()
                    .join("\n"),
            )
        }
    }
}

/// Bad usage: a question that has no answer.
fn refused(error: DesignError) -> Failure {
    Failure::usage(match error {
        DesignError::Config(error) => anyhow::Error::new(error),
        error => anyhow::Error::new(error),
    })
}

fn write(folder: &mut Folder, study: &Study, answer: &Answer) -> Result<(), Failure> {
    let config = trace::resolved(study);
    let title = match study.config.title.as_str() {
        "" => study.config.name.as_str(),
        title => title,
    };
    let figure = answer.figure(DESIGN_FIGURE, title).map_err(Failure::work)?;
    let words = format!("{}\n{}\n", answer.sentence(), answer.lines().join("\n"));
    let mut files: Vec<(String, Vec<u8>)> = vec![
        (DESIGN.to_owned(), answer.table().to_csv().into_bytes()),
        (DESIGN_WORDS.to_owned(), words.into_bytes()),
        (DESIGN_CONFIG.to_owned(), config.clone().into_bytes()),
    ];
    files.extend(drawings(&[figure])?);
    let contents = files
        .iter()
        .map(|(name, bytes)| (name.as_str(), Contents::Bytes(bytes)));
    let of_study = StudyId::new(&study.config.name, &config);
    let left = folder.replace(contents.collect(), &of_study)?;
    left.iter().for_each(|line| eprintln!("warning: {line}"));
    Ok(())
}

/// The answer as JSON.
fn value(study: &Study, answer: &Answer) -> Value {
    let text = |value: f64| match answer.is_listed() {
        true => json!(answer.field.text(value)),
        false => json!(value),
    };
    let runs = |side: Side| -> Vec<Value> {
        let runs = answer.on(side);
        runs.map(|run| json!({ "from": text(run.from), "to": text(run.to) }))
            .collect()
    };
    let best = answer.best().map(|(looked, sample)| {
        json!({
            "value": text(looked.value),
            "statistic": sample.statistic.map(|(value, _)| value),
            "std_error": sample.statistic.map(|(_, std)| std),
            "failing": sample.failing(),
        })
    });
    json!({
        "format_version": 1,
        "study": study.config.name,
        "answer": answer.sentence(),
        "target": answer.target.to_string(),
        "max_failures": answer.max_failures,
        "path": answer.field.path,
        "unit": answer.field.label.unit,
        "confidence": 0.95,
        "meets": runs(Side::Meets),
        "misses": runs(Side::Misses),
        "best": best,
        "narrowed": answer.narrowed,
        "ended": format!("{:?}", answer.ended).to_lowercase(),
    })
}
