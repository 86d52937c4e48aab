//! Tables in JSON: one object per line, a list of objects or of rows, or an object with one list per column.

use std::collections::HashMap;

use csv::StringRecord;
use palpate_study::readings::spelt;
use serde_json::Value as Json;

use super::error::RecordedError;
use super::file::RecordedFile;
use super::text_table::{Record, RowResult, Text};

/// Maximum number of columns; rows may lack some of them.
const MAX_KEYS: usize = 1_000;

/// Maximum number of components of a vector or a quaternion.
const MAX_COMPONENTS: usize = 4;

/// The form in which a JSON text contains the rows of a table.
enum Rows<'a> {
    /// One JSON object per line, which is a row of the table.
    Lines(Text<'a>),
    /// A JSON list whose items (objects or lists) are the rows.
    List(Text<'a>),
    /// A JSON object with a list of values for each column.
    Columns(Vec<Vec<Json>>),
}

/// A table that is written as JSON.
pub(super) struct JsonTable<'a> {
    rows: Rows<'a>,
    header_line: usize,
}

impl<'a> JsonTable<'a> {
    /// Returns the table and the names of its columns. `first` is the first line that is not blank, followed by its
    /// line number.
    pub(super) fn of(
        file: &RecordedFile,
        text: Text<'a>,
        (first, header_line): (&str, usize),
    ) -> Result<(Self, Vec<String>), RecordedError> {
        let is_list = first.trim_start().starts_with('[');
        let is_lines = text.rows_after(header_line).next().is_some()
            && serde_json::from_str::<Json>(first).is_ok();
        let columns = match is_list || is_lines {
            true => None,
            false => columns(file, text)?,
        };
        if let Some((header, columns)) = columns {
            let rows = Rows::Columns(columns);
            return Ok((Self { rows, header_line }, header));
        }
        let rows = if is_list {
            Rows::List(text)
        } else {
            Rows::Lines(text)
        };
        let table = Self { rows, header_line };
        let (first, line) = table.objects().next().unwrap_or(("{}", header_line));
        let pairs = pairs(file, line, first)?;
        match pairs.len() {
            0 => Err(file.fail(
                line,
                "the first JSON object is empty; its keys must name the columns",
            )),
            1..=MAX_KEYS => Ok((table, pairs.into_iter().map(|(key, _)| key).collect())),
            many => Err(file.fail(
                line,
                format!("has {many} columns; at most {MAX_KEYS} are read"),
            )),
        }
    }

    /// Text of each row, with a number for messages. The number is the line of the row or, if the whole list is in one
    /// line, the index of the row, counted from 1.
    fn objects(&self) -> Box<dyn Iterator<Item = (&'a str, usize)> + 'a> {
        match self.rows {
            Rows::Lines(text) => Box::new(text.rows_after(0)),
            Rows::List(text) if text.rows_after(0).nth(1).is_none() => {
                let objects = Elements::of(text).enumerate();
                Box::new(objects.map(|(place, (object, _))| (object, place + 1)))
            }
            Rows::List(text) => Box::new(Elements::of(text)),
            Rows::Columns(_) => Box::new(std::iter::empty()),
        }
    }

    /// Calls `take` with every row that is not blank.
    pub(super) fn rows(
        &self,
        file: &RecordedFile,
        header: &[String],
        mut take: impl FnMut(Record<'_>) -> RowResult,
    ) -> RowResult {
        if let Rows::Columns(columns) = &self.rows {
            for row in 0..columns.first().map_or(0, Vec::len) {
                let fields = columns.iter().map(|column| scalar(&column[row]));
                take(Record {
                    line: row + 1,
                    is_after_gap: false,
                    fields: &fields.collect(),
                })?;
            }
            return Ok(());
        }
        let is_list = matches!(self.rows, Rows::List(_));
        let mut before = self.header_line;
        for (text, line) in self.objects() {
            let values: HashMap<String, String> = pairs(file, line, text)?.into_iter().collect();
            let of_key = |name: &String| values.get(name).map_or("", String::as_str);
            let fields: StringRecord = header.iter().map(of_key).collect();
            take(Record {
                line,
                is_after_gap: !is_list && line > before + 1,
                fields: &fields,
            })?;
            before = line;
        }
        Ok(())
    }
}

/// Names and values of the columns, if the text is a JSON object with one list per column; otherwise `None`.
#[expect(clippy::type_complexity, reason = "names and values of the columns")]
fn columns(
    file: &RecordedFile,
    text: Text<'_>,
) -> Result<Option<(Vec<String>, Vec<Vec<Json>>)>, RecordedError> {
    let Ok(Json::Object(object)) = serde_json::from_str(text.all) else {
        return Ok(None);
    };
    let is_scalar = |item: &Json| !item.is_array() && !item.is_object();
    let is_column = |value: &Json| match value {
        Json::Array(items) => items.iter().all(is_scalar),
        // pandas writes a column as an object, with the number of the row as the key of each value.
        Json::Object(items) => items
            .iter()
            .all(|(row, item)| row.parse::<u64>().is_ok() && is_scalar(item)),
        _ => false,
    };
    // A long list is a column. A short list may instead be a vector in a single row, unless its name denotes one axis.
    let is_long = |value: &Json| value.as_array().map_or(0, Vec::len) > MAX_COMPONENTS;
    let is_of_axis = |name: &String| {
        let name = spelt(name);
        let mut words = name.split('_');
        words.any(|word| matches!(word, "x" | "y" | "z" | "u" | "v"))
    };
    let is_table = object.keys().any(is_of_axis) || object.values().any(is_long);
    if !is_table || object.len() < 2 || object.len() > MAX_KEYS || !object.values().all(is_column) {
        return Ok(None);
    }
    let (mut names, mut columns) = (Vec::new(), Vec::<Vec<Json>>::new());
    for (name, value) in object {
        let column: Vec<Json> = match value {
            Json::Array(items) => items,
            Json::Object(items) => {
                let mut items: Vec<(String, Json)> = items.into_iter().collect();
                items.sort_by_key(|(row, _)| row.parse::<u64>().unwrap_or_default());
                items.into_iter().map(|(_, item)| item).collect()
            }
            _ => Vec::new(),
        };
        if let Some(first) = columns.first().filter(|first| first.len() != column.len()) {
            let (own, other) = (column.len(), first.len());
            return Err(file.error(format!(
                "has columns of different lengths: `{}` has {other} values, `{name}` has {own}",
                names[0]
            )));
        }
        names.push(name);
        columns.push(column);
    }
    Ok(Some((names, columns)))
}

/// Elements of a JSON list: the text of each element, with the line in which it begins. The elements themselves are not
/// parsed here.
struct Elements<'a> {
    text: Text<'a>,
    /// Byte index in the text at which the next element begins.
    start: usize,
    line: usize,
    /// Whether the text ends before the closing bracket of the list.
    is_cut: bool,
}

impl<'a> Elements<'a> {
    fn of(text: Text<'a>) -> Self {
        let start = text.all.find('[').map_or(0, |at| at + 1);
        let lines = text.all[..start].matches(text.end).count();
        let line = text.line + lines;
        Self {
            text,
            start,
            line,
            is_cut: false,
        }
    }
}

impl<'a> Iterator for Elements<'a> {
    type Item = (&'a str, usize);

    fn next(&mut self) -> Option<Self::Item> {
        if std::mem::take(&mut self.is_cut) {
            return Some(("", self.line));
        }
        let rest = &self.text.all[self.start..];
        let element = rest.trim_start();
        let skipped = rest.len() - element.len();
        self.line += rest[..skipped].matches(self.text.end).count();
        let (mut depth, mut is_text, mut is_escaped) = (0_usize, false, false);
        let end = element.bytes().position(|byte| {
            match byte {
                _ if is_escaped => is_escaped = false,
                b'\\' if is_text => is_escaped = true,
                b'"' => is_text = !is_text,
                _ if is_text => {}
                b'[' | b'{' => depth += 1,
                b',' | b']' if depth == 0 => return true,
                b']' | b'}' => depth = depth.saturating_sub(1),
                _ => {}
            }
            false
        });
        self.is_cut = end.is_none() && !element.is_empty();
        let end = end.unwrap_or(element.len());
        let line = self.line;
        self.line += element[..end].matches(self.text.end).count();
        self.start += skipped + end;
        // After an element, there must be a comma and another element, or the closing bracket and nothing else.
        match element[end..].starts_with(',') {
            true => self.start += 1,
            false if element[end..].starts_with(']') && element[end + 1..].trim().is_empty() => {
                self.start = self.text.all.len();
            }
            false if end == 0 => {
                self.start = self.text.all.len();
                return (!element.is_empty()).then_some((element, line));
            }
            false => {}
        }
        let element = element[..end].trim_end();
        (!element.is_empty() || self.start < self.text.all.len()).then_some((element, line))
    }
}

/// Names and values of a JSON object or list. Nested names are joined by points, as in `position.0`.
fn pairs(
    file: &RecordedFile,
    line: usize,
    text: &str,
) -> Result<Vec<(String, String)>, RecordedError> {
    const NEEDED: &str = "a list of objects is needed, or an object per line";
    let value: Json = serde_json::from_str(text).map_err(|error| {
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        let column = error.column();
        let what = format!("is no JSON object: {message} (character {column})");
        file.fail(line, format!("{what}; {NEEDED}"))
    })?;
    if !value.is_object() && !value.is_array() {
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
        value => pairs.push((name.to_owned(), scalar(value))),
    }
}

/// A JSON value as text; empty for `null`.
fn scalar(value: &Json) -> String {
    match value {
        Json::Null => String::new(),
        Json::String(text) => text.clone(),
        value => value.to_string(),
    }
}
