//! Output of commands: standard output, and files that are written completely or not at all.

mod locked_dir;
mod manifest;
pub(crate) mod names;
mod output_dir;
mod output_file;
#[cfg(feature = "parquet")]
mod parquet;
mod stage;
pub(crate) mod table_writer;

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use anyhow::{Context, Error};
use serde::Serialize;

use crate::failure::Failure;

pub(crate) use locked_dir::{Lock, LockedDir, make_directory, refuse_no_directory};
pub(crate) use manifest::StudyId;
pub(crate) use names::Format;
pub(crate) use output_dir::{Guard, OutputDir};
pub(crate) use output_file::{OutputFile, OutputWriter};
pub(crate) use stage::{Contents, Draft, folder_of};

/// Prints a text and a newline to standard output. A closed pipe is not an error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    write_stdout(format!("{text}\n").as_bytes())
}

/// Prints a line to standard error. The work goes on if standard error is closed, for example by `head`.
pub(crate) fn print_note(text: impl Display) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

fn write_stdout(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::work(
            Error::new(error).context("cannot write to standard output"),
        )),
        _ => Ok(()),
    }
}

/// A value as JSON, with one number per line. The number −0 is written as 0.
pub(crate) fn json(estimate: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(estimate).map_err(Failure::work)?;
    let lines = text.lines().map(|line| {
        let (value, comma) = line
            .strip_suffix(',')
            .map_or((line, ""), |value| (value, ","));
        // Replace the number -0.0 by 0.0. If a line ends in -0.0, its value is a number, because a string would end in
        // a quotation mark.
        let key = value.strip_suffix("-0.0");
        key.map_or_else(|| line.to_owned(), |key| format!("{key}0.0{comma}"))
    });
    Ok(lines.collect::<Vec<_>>().join("\n"))
}

pub(crate) fn png(picture: &image::RgbImage) -> Result<Vec<u8>, Failure> {
    let bytes = palpate_frames::png(picture, None).context("cannot write a picture as PNG");
    bytes.map_err(Failure::work)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn zero_has_no_sign() {
        let text = json(&BTreeMap::from([("a", vec![-0.0, 1.0]), ("b", vec![-0.5])])).unwrap();
        let text: String = text.split_whitespace().collect();
        assert_eq!(text, r#"{"a":[0.0,1.0],"b":[-0.5]}"#);
        let text = json(&BTreeMap::from([("a", -0.0)])).unwrap();
        assert_eq!(text, "{\n  \"a\": 0.0\n}");
        let words = "{\n  \"a\": \"of -0.0\"\n}";
        assert_eq!(json(&BTreeMap::from([("a", "of -0.0")])).unwrap(), words);
    }
}
