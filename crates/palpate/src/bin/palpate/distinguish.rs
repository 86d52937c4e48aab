//! `palpate distinguish`.

use palpate::config::Study;
use palpate::{Repeats, ToldApart};
use serde_json::{Value, json};

use crate::budget::runner;
use crate::cli::DistinguishArgs;
use crate::failure::Failure;
use crate::output::names::{TOLD, TOLD_FIGURE, TOLD_WORDS};
use crate::output::{self, Contents, Folder, Guard, StudyId};
use crate::results::drawings;
use crate::run::overridden;
use crate::{progress, trace};

pub(crate) fn distinguish(args: &DistinguishArgs) -> Result<(), Failure> {
    let study = overridden(&args.config, args.seed, args.trials, None)?;
    let set = args
        .set
        .iter()
        .map(|(path, value)| (path.clone(), vec![value.clone()]));
    let fields: Vec<_> = args.vary.iter().cloned().chain(set).collect();
    let study = match fields.is_empty() {
        true => study,
        false => study.varied(&fields).map_err(Failure::usage)?,
    };
    // Before the work, which would be lost where nothing can be written.
    let guard = Guard::new([&args.config], args.force);
    let mut folder = match &args.out {
        Some(dir) => Some(Folder::open(dir, guard)?),
        None => None,
    };
    let bar = progress::bar_of("cells");
    let told = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let quantity = args.quantity.as_deref();
    let found = palpate::distinguish(
        &study,
        quantity,
        args.confidence,
        &runner(args.threads)?,
        &told,
    );
    bar.finish_and_clear();
    let found = found.map_err(Failure::usage)?;
    if let Some(folder) = &mut folder {
        write(folder, &study, &found)?;
    }
    match args.json {
        true => output::print(&output::json(&value(&study, &found))?),
        false => {
            let files = args
                .out
                .iter()
                .map(|dir| format!("files    {}", dir.display()));
            output::print(
                &found
                    .sentences()
                    .into_iter()
                    .chain(files)
                    .collect::<Vec<_>>()
                    .join("\n"),
            )
        }
    }
}

fn write(folder: &mut Folder, study: &Study, found: &ToldApart) -> Result<(), Failure> {
    let title = match study.config.title.as_str() {
        "" => study.config.name.as_str(),
        title => title,
    };
    let figure = found.figure(TOLD_FIGURE, title).map_err(Failure::work)?;
    let mut files: Vec<(String, Vec<u8>)> = vec![
        (TOLD.to_owned(), found.table().to_csv().into_bytes()),
        (
            TOLD_WORDS.to_owned(),
            format!("{}\n", found.sentences().join("\n")).into_bytes(),
        ),
    ];
    files.extend(drawings(&[figure])?);
    let contents = files
        .iter()
        .map(|(name, bytes)| (name.as_str(), Contents::Bytes(bytes)));
    let of_study = StudyId::new(&study.config.name, &trace::resolved(study));
    let left = folder.replace(contents.collect(), &of_study)?;
    left.iter().for_each(|line| eprintln!("warning: {line}"));
    Ok(())
}

/// The answer as JSON.
fn value(study: &Study, found: &ToldApart) -> Value {
    let groups = found.groups.iter().map(|group| {
        let pairs = group.pairs.iter().map(|pair| {
            let [first, second] =
                [pair.first, pair.second].map(|place| found.object_in_words(&group.objects[place]));
            let repeats = match pair.repeats {
                Some(Repeats::Found(count) | Repeats::About(count)) => json!(count),
                _ => Value::Null,
            };
            json!({
                "first": first,
                "second": second,
                "told_apart": pair.order.map(|order| order.probability),
                "low95": pair.order.map(|order| order.low),
                "high95": pair.order.map(|order| order.high),
                "repeats": repeats,
            })
        });
        json!({
            "settings": found.settings_in_words(group),
            "pairs": pairs.collect::<Vec<_>>(),
        })
    });
    json!({
        "format_version": 1,
        "study": study.config.name,
        "quantity": found.quantity.name,
        "confidence": found.confidence,
        "groups": groups.collect::<Vec<_>>(),
        "answer": found.sentences(),
    })
}
