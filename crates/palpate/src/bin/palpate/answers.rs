//! Output of commands that answer questions: where they write, and what they print.

use palpate::config::Study;
use palpate::{Figure, ReportError};
use serde_json::Value;

use crate::cli::AnswerArgs;
use crate::failure::Failure;
use crate::output::{self, Contents, Folder, Guard, StudyId};
use crate::results::drawings;
use crate::trace;

/// Folder that an answer is written to, if it is. It is opened before the work, which would be lost where nothing can be
/// written.
pub(crate) fn folder(args: &AnswerArgs) -> Result<Option<Folder>, Failure> {
    let guard = Guard::new([&args.config], args.force);
    let out = args.out.as_ref();
    out.map(|dir| Folder::open(dir, guard)).transpose()
}

/// Fields that `--set` gives one value.
pub(crate) fn set(args: &AnswerArgs) -> impl Iterator<Item = (String, Vec<toml::Value>)> {
    let set = args.set.iter();
    set.map(|(path, value)| (path.clone(), vec![value.clone()]))
}

/// Tells of fields that the config writes although it sweeps them, but for those at `paths`, which arguments set.
pub(crate) fn tell_swept<'a>(study: &Study, paths: impl Iterator<Item = &'a str>) {
    let set: Vec<&str> = paths.collect();
    for (path, note) in study.swept_over() {
        if !set.contains(&path.as_str()) {
            eprintln!("note: {note}");
        }
    }
}

/// Replaces what an earlier answer has written by these texts and a figure.
pub(crate) fn write(
    folder: &mut Folder,
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
    let of_study = StudyId::new(&study.config.name, &trace::resolved(study));
    let left = folder.replace(contents.collect(), &of_study)?;
    left.iter().for_each(|line| eprintln!("warning: {line}"));
    Ok(())
}

/// Prints an answer: its lines and where its files are, or as JSON.
pub(crate) fn print(
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
