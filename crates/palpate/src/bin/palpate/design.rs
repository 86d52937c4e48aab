//! `palpate design`.

use std::time::{Duration, Instant};

use palpate::config::Study;
use palpate::{Answer, DesignError, Extreme, Field, Region, Side, Sought, Survey, load};
use serde_json::{Map, Value, json};

use crate::budget::runner;
use crate::cli::DesignArgs;
use crate::failure::Failure;
use crate::output::names::{DESIGN, DESIGN_CONFIG, DESIGN_FIGURE, DESIGN_REGION, DESIGN_WORDS};
use crate::{answers, progress};

/// Time after which the progress is shown.
const QUIET: Duration = Duration::from_secs(1);

/// What was found: along one field, or of several.
enum Found {
    Line(Box<Answer>),
    Region(Region),
}

pub(crate) fn design(args: &DesignArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let mut study = load(&args.answer.config).map_err(Failure::usage)?;
    if let Some(seed) = args.answer.seed {
        study.override_seed(seed).map_err(Failure::usage)?;
    }
    let mut folder = answers::folder(&args.answer)?;
    let bar = progress::bar_of("trials");
    let told = |values: usize, trials: u64| {
        if start.elapsed() >= QUIET {
            bar.set_message(format!("; {values} values"));
            bar.set_position(trials);
        }
    };
    let survey = survey(args).map_err(refused)?;
    let (runner, clock) = (runner(args.answer.threads)?, || start.elapsed());
    let found = match survey.grid.is_empty() && survey.sought.is_none() {
        true => palpate::design(&study, &survey.question, &runner, &clock, &told)
            .map(|answer| Found::Line(Box::new(answer))),
        false => palpate::region(&study, &survey, &runner, &clock, &told).map(Found::Region),
    };
    bar.finish_and_clear();
    let found = found.map_err(refused)?;
    let (sentence, lines) = match &found {
        Found::Line(answer) => (answer.sentence(), answer.lines()),
        Found::Region(region) => (region.sentence(), region.lines()),
    };
    let lines: Vec<String> = [sentence].into_iter().chain(lines).collect();
    if let Some(folder) = &mut folder {
        let title = answers::title(&study);
        let mut texts = vec![
            (DESIGN_WORDS, format!("{}\n", lines.join("\n"))),
            (DESIGN_CONFIG, palpate::resolved(&study)),
        ];
        let figure = match &found {
            Found::Line(answer) => {
                texts.push((DESIGN, answer.table().to_csv()));
                answer.figure(DESIGN_FIGURE, title)
            }
            Found::Region(region) => {
                texts.push((DESIGN, region.table().to_csv()));
                texts.push((DESIGN_REGION, region.runs().to_csv()));
                region.figure(DESIGN_FIGURE, title)
            }
        };
        answers::write(folder, &study, texts, figure)?;
    }
    answers::print(&args.answer, lines, || match &found {
        Found::Line(answer) => line(&study, answer),
        Found::Region(region) => several(&study, region),
    })
}

/// The question that the arguments ask.
fn survey(args: &DesignArgs) -> Result<Survey, DesignError> {
    let sought = |path: &Option<String>, extreme: Extreme| {
        let path = path.clone()?;
        Some(Sought { path, extreme })
    };
    let sought = sought(&args.maximise, Extreme::Largest)
        .or_else(|| sought(&args.minimise, Extreme::Smallest));
    let mut survey = Survey::new(args.target, args.vary.clone(), sought)?;
    let question = &mut survey.question;
    question.max_failures = args.max_failures;
    question.set.clone_from(&args.answer.set);
    question.gap = args.gap;
    question.most_trials = args.most_trials.get();
    question.budget = Some(args.budget);
    Ok(survey)
}

/// What was asked cannot be answered: bad usage.
fn refused(error: DesignError) -> Failure {
    Failure::usage(match error {
        DesignError::Config(error) => anyhow::Error::new(error),
        error => anyhow::Error::new(error),
    })
}

/// The answer along one field as JSON.
fn line(study: &Study, answer: &Answer) -> Value {
    let mut value = json!({
        "format_version": 1,
        "study": study.config.name,
        "answer": answer.sentence(),
        "target": answer.target.to_string(),
        "max_failures": answer.max_failures,
        "path": answer.field.path,
        "unit": answer.field.label.unit,
        "confidence": answer.confidence,
    });
    if let Some(value) = value.as_object_mut() {
        value.extend(found(answer));
    }
    value
}

/// The answer of several fields as JSON.
fn several(study: &Study, region: &Region) -> Value {
    let field = |field: &Field| json!({ "path": field.path, "unit": field.label.unit });
    let columns = region.columns.iter().map(|column| {
        let at = region.grid.iter().zip(&column.at);
        let at = at.map(|(field, value)| (field.path.clone(), shown(field, *value)));
        let mut value = Map::from_iter([("at".to_owned(), Value::Object(at.collect()))]);
        value.extend(found(&column.answer));
        Value::Object(value)
    });
    let answer = &region.columns[0].answer;
    let best = region.best().map(|best| {
        let pairs = region.grid.iter().zip(&best.column.at);
        let grid = pairs.map(|(field, value)| (field.path.clone(), shown(field, *value)));
        let searched = region.searched();
        let searched = (searched.path.clone(), shown(searched, best.searched));
        Value::Object(grid.chain([searched]).collect())
    });
    json!({
        "format_version": 1,
        "study": study.config.name,
        "answer": region.sentence(),
        "target": answer.target.to_string(),
        "max_failures": answer.max_failures,
        "grid": region.grid.iter().map(field).collect::<Vec<_>>(),
        "path": region.searched().path,
        "unit": region.searched().label.unit,
        "confidence": region.confidence,
        "sought": region.sought.as_ref().map(|sought| &sought.path),
        "best_that_meets": best,
        "columns": columns.collect::<Vec<_>>(),
    })
}

/// Value of a field: a number, or the text of one that is listed.
fn shown(field: &Field, value: f64) -> Value {
    match field.is_listed() {
        true => json!(field.text(value)),
        false => json!(value),
    }
}

/// What was found along a field.
fn found(answer: &Answer) -> Map<String, Value> {
    let text = |value: f64| shown(&answer.field, value);
    let runs = |side: Side| -> Value {
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
    Map::from_iter([
        ("meets".to_owned(), runs(Side::Meets)),
        ("misses".to_owned(), runs(Side::Misses)),
        ("best".to_owned(), best.unwrap_or(Value::Null)),
        ("narrowed".to_owned(), json!(answer.narrowed)),
        (
            "ended".to_owned(),
            json!(format!("{:?}", answer.ended).to_lowercase()),
        ),
    ])
}
