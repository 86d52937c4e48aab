//! `palpate design`.

use std::time::{Duration, Instant};

use palpate::{Answer, DesignError, Extreme, Region, Sought, Survey, load};

use crate::budget::runner;
use crate::cli::DesignArgs;
use crate::failure::Failure;
use crate::output::names::{DESIGN, DESIGN_CONFIG, DESIGN_FIGURE, DESIGN_REGION, DESIGN_WORDS};
use crate::{answers, progress};

/// Time after which the progress is shown.
const QUIET: Duration = Duration::from_secs(1);

/// Findings along one field, or of several.
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
    let vary = args.vary.iter().map(|vary| vary.path.as_str());
    let set = args.answer.set.iter().map(|(path, _)| path.as_str());
    answers::tell_swept(&study, vary.chain(set));
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
        let title = study.heading();
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
        Found::Line(answer) => answer.to_json(&study),
        Found::Region(region) => region.to_json(&study),
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

/// Failure of a question that cannot be answered: bad usage.
fn refused(error: DesignError) -> Failure {
    Failure::usage(match error {
        DesignError::Config(error) => anyhow::Error::new(error),
        error => anyhow::Error::new(error),
    })
}
