//! `palpate distinguish`.

use crate::budget::runner;
use crate::cli::DistinguishArgs;
use crate::failure::Failure;
use crate::output::names::{TOLD, TOLD_FIGURE, TOLD_WORDS};
use crate::run::overridden;
use crate::{answers, progress};

pub(crate) fn distinguish(args: &DistinguishArgs) -> Result<(), Failure> {
    let study = overridden(&args.answer.config, args.answer.seed, args.trials, None)?;
    let paths = args.vary.iter().map(|(path, _)| path.as_str());
    let set = args.answer.set.iter().map(|(path, _)| path.as_str());
    answers::tell_swept(&study, paths.chain(set));
    let vary = args.vary.iter().cloned();
    let fields: Vec<_> = vary.chain(answers::set(&args.answer)).collect();
    let study = match fields.is_empty() {
        true => study,
        false => study.varied(&fields).map_err(Failure::usage)?,
    };
    let mut folder = answers::folder(&args.answer)?;
    let bar = progress::bar_of("cells");
    let told = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let found = palpate::distinguish(
        &study,
        args.quantity.as_deref(),
        args.confidence,
        &runner(args.answer.threads)?,
        &told,
    );
    bar.finish_and_clear();
    let found = found.map_err(Failure::usage)?;
    if let Some(folder) = &mut folder {
        let texts = vec![
            (TOLD, found.table().to_csv()),
            (TOLD_WORDS, format!("{}\n", found.sentences().join("\n"))),
        ];
        let figure = found.figure(TOLD_FIGURE, study.heading());
        answers::write(folder, &study, texts, figure)?;
    }
    answers::print(&args.answer, found.sentences(), || found.to_json(&study))
}
