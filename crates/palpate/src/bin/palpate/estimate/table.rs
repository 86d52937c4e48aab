//! Input and output that all `estimate` commands share: tables from files or standard input, and warnings.

use std::io::IsTerminal;
use std::path::Path;

use palpate_recorded::{Form, RecordedFile};
use palpate_study::readings::{columns_of, of_key};

use serde::Serialize;

use super::like::Like;
use super::summary::summary;
use crate::cli::FormArgs;
use crate::failure::{Failure, with_flags};
use crate::output;

pub(crate) fn table(path: &Path, form: Form) -> Result<RecordedFile, Failure> {
    let file = match path == Path::new("-") {
        true => RecordedFile::read_stream("standard input", std::io::stdin().lock()),
        false => RecordedFile::read(path),
    };
    file.map(|file| file.written(form)).map_err(Failure::work)
}

/// Format of a table, as the arguments state it. The study of `--like` supplies the column names that are not stated.
pub(crate) fn form(args: &FormArgs, like: Option<&Like>) -> Form {
    let mut form = args.form();
    let Some(like) = like else {
        return form;
    };
    let columns = columns_of(like.config.scene.kind());
    for (key, name) in &like.config.columns {
        let column = of_key(key, &columns);
        let mut keys = form.columns.keys();
        if !keys.any(|key| of_key(key, &columns) == column) {
            form.columns.insert(key.clone(), name.clone());
        }
    }
    form
}

/// Text of an estimate for standard output: a few lines on a terminal, otherwise (or with `--json`) JSON.
pub(crate) fn shown(estimate: &impl Serialize, json: bool) -> Result<String, Failure> {
    if json || !std::io::stdout().is_terminal() {
        return output::json(estimate);
    }
    let estimate = serde_json::to_value(estimate).map_err(Failure::work)?;
    Ok(summary(&estimate))
}

/// Prints the warnings of an estimate to the stream stderr.
pub(crate) fn warn(estimate: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_value(estimate).map_err(Failure::work)?;
    let warnings = json["warnings"].as_array().into_iter().flatten();
    for warning in warnings.filter_map(|warning| warning["text"].as_str()) {
        eprintln!("warning: {}", with_flags(warning));
    }
    Ok(())
}
