//! Tables with a JSON object per line.

use std::collections::HashMap;

use csv::StringRecord;
use serde_json::Value as Json;

use super::error::RecordedError;
use super::file::RecordedFile;
use super::text_table::{Record, RowResult, Text};

/// Maximum number of columns; rows may lack some of them.
const MAX_KEYS: usize = 1_000;

/// Column names from the first line, in their order.
pub(super) fn keys(
    file: &RecordedFile,
    line: usize,
    text: &str,
) -> Result<Vec<String>, RecordedError> {
    let pairs = pairs(file, line, text)?;
    match pairs.len() {
        0 => Err(file.fail(
            line,
            "the first JSON object is empty; its keys must name the columns",
        )),
        1..=MAX_KEYS => Ok(pairs.into_iter().map(|(key, _)| key).collect()),
        many => Err(file.fail(
            line,
            format!("has {many} columns; at most {MAX_KEYS} are read"),
        )),
    }
}

/// Calls `take` with every row that is not blank.
pub(super) fn rows(
    file: &RecordedFile,
    text: Text<'_>,
    (header, header_line): (&[String], usize),
    mut take: impl FnMut(Record<'_>) -> RowResult,
) -> RowResult {
    let mut before = header_line;
    for (text, line) in text.rows_after(0) {
        let values: HashMap<String, String> = pairs(file, line, text)?.into_iter().collect();
        let of_key = |name: &String| values.get(name).map_or("", String::as_str);
        let fields: StringRecord = header.iter().map(of_key).collect();
        take(Record {
            line,
            is_after_gap: line > before + 1,
            fields: &fields,
        })?;
        before = line;
    }
    Ok(())
}

/// Names and values of an object; nested names are joined by points: `position.0`.
fn pairs(
    file: &RecordedFile,
    line: usize,
    text: &str,
) -> Result<Vec<(String, String)>, RecordedError> {
    const NEEDED: &str = "an object per line is needed, as `jq -c '.[]'` writes of a list";
    let value: Json = serde_json::from_str(text).map_err(|error| {
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        let column = error.column();
        let what = format!("is no JSON object of one line: {message} (character {column})");
        file.fail(line, format!("{what}; {NEEDED}"))
    })?;
    if !value.is_object() {
        return Err(file.fail(line, format!("is no JSON object; {NEEDED}")));
    }
    let mut pairs = Vec::new();
    flatten("", &value, &mut pairs);
    Ok(pairs)
}

fn flatten(name: &str, value: &Json, pairs: &mut Vec<(String, String)>) {
    let within = |key: &str| match name.is_empty() {
        true => key.to_owned(),
        false => format!("{name}.{key}"),
    };
    match value {
        Json::Object(object) => {
            for (key, value) in object {
                flatten(&within(key), value, pairs);
            }
        }
        Json::Array(items) => {
            for (index, value) in items.iter().enumerate() {
                flatten(&within(&index.to_string()), value, pairs);
            }
        }
        Json::Null => pairs.push((name.to_owned(), String::new())),
        Json::String(text) => pairs.push((name.to_owned(), text.clone())),
        Json::Bool(_) | Json::Number(_) => pairs.push((name.to_owned(), value.to_string())),
    }
}
