//! Tables in JSON: one object per line, a list of objects or of rows, an object with one list per column, or an object
//! that contains a list of objects.

use std::collections::HashMap;

use csv::StringRecord;
use palpate_study::readings::spelt;
use serde_json::{Map, Value as Json};

use super::error::RecordedError;
use super::file::RecordedFile;
use super::heading::Heading;
use super::text_table::{Record, RowResult, Text};

/// Maximum number of columns of a table; a row may lack some of these columns.
const MAX_KEYS: usize = 1_000;

/// Maximum number of fingers whose readings are in one row that states no time.
pub(super) const MAX_FINGERS: usize = 5;

/// Maximum number of components of a vector or a quaternion.
const MAX_COMPONENTS: usize = 4;

enum Rows<'a> {
    /// JSON objects one after the other, or a JSON list whose items (objects or lists) are the rows.
    Sequence(Text<'a>),
    Records(Vec<Json>),
    Columns(Vec<Vec<Json>>),
}

pub(super) struct JsonTable<'a> {
    rows: Rows<'a>,
    names: Vec<String>,
    header_line: usize,
}

impl<'a> JsonTable<'a> {
    /// Returns the table and the names of its columns. `header_line` is the first line that is not blank. `label` is the
    /// name of the column with the number of a finger or probe; `None` if the table has no such column.
    pub(super) fn of(
        file: &RecordedFile,
        text: Text<'a>,
        header_line: usize,
        label: Option<&str>,
    ) -> Result<(Self, Vec<String>), RecordedError> {
        let mut table = Self {
            rows: Rows::Sequence(text),
            names: Vec::new(),
            header_line,
        };
        if let Ok(object) = serde_json::from_str(text.all) {
            if let Some(rows) = match records(file, &object)? {
                Some(rows) => Some(rows),
                None => nested(file, &object)?,
            } {
                table.rows = Rows::Records(rows);
            } else if let Some((names, columns)) = columns(file, object)? {
                table.rows = Rows::Columns(columns);
                table.names.clone_from(&names);
                return Ok((table, names));
            }
        }
        let first = table.objects(file).next().transpose()?;
        let (first, line) = first.unwrap_or((Json::Null, header_line));
        if let Some(label) = label.filter(|_| has_series(&first)) {
            return Err(file.error(format!(
                "has lists of readings that may belong to one `{label}` or to one time each; write one list of \
                 readings, each with the key `{label}`"
            )));
        }
        let pairs = pairs(file, line, &first)?;
        match pairs.len() {
            0 => Err(file.fail(
                line,
                "the first JSON object is empty; its keys must name the columns",
            )),
            1..=MAX_KEYS => {
                table.names = pairs.into_iter().map(|(key, _)| key).collect();
                let names = table.names.clone();
                Ok((table, names))
            }
            many => Err(file.fail(
                line,
                format!("has {many} columns; at most {MAX_KEYS} are read"),
            )),
        }
    }

    /// The JSON object of each row, with a number for messages: the line of the object or, if the whole list is written
    /// in one line, the number of the object, counted from 1.
    fn objects<'f>(&'f self, file: &'f RecordedFile) -> Box<dyn Iterator<Item = Object> + 'f> {
        match &self.rows {
            Rows::Sequence(text) => {
                let is_one_line = text.rows_after(0).nth(1).is_none();
                let objects = Elements::of(file, *text).zip(1..);
                Box::new(objects.map(move |(object, place)| {
                    let (object, line) = object?;
                    Ok((object, if is_one_line { place } else { line }))
                }))
            }
            Rows::Records(rows) => Box::new(rows.iter().cloned().zip(1..).map(Ok)),
            Rows::Columns(_) => Box::new(std::iter::empty()),
        }
    }

    pub(super) fn rows(
        &self,
        file: &RecordedFile,
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
        let is_list = matches!(self.rows, Rows::Sequence(text) if is_list(text));
        let mut before = self.header_line;
        for object in self.objects(file) {
            let (object, line) = object?;
            let values: HashMap<String, String> = pairs(file, line, &object)?.into_iter().collect();
            let mut fields = StringRecord::new();
            for name in &self.names {
                let value = values.get(name);
                let keys = values.keys().filter(|_| value.is_none());
                let keys = keys.filter(|key| is_within(key, name) || is_within(name, key));
                if let Some(key) = keys.min() {
                    let message = format!("has `{key}`, but the first row has `{name}`");
                    return Err(file.fail(line, message));
                }
                fields.push_field(value.map_or("", String::as_str));
            }
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

/// Whether the column `key` is a component of the value `name`, such as `position.0` of `position`.
fn is_within(key: &str, name: &str) -> bool {
    let part = key.strip_prefix(name);
    part.is_some_and(|part| part.starts_with('.'))
}

/// Whether the first row of a table contains a series of readings. A list of objects or vectors, or the numbers along
/// one axis, are a series if they have more items than a hand has fingers and the row states no time. Otherwise, the
/// items are fingers at one time.
fn has_series(row: &Json) -> bool {
    let is_list = |items: &[Json]| items.iter().all(|item| item.is_array() || item.is_object());
    let is_long = |(name, value): (&String, &Json)| {
        let items = value.as_array().filter(|items| items.len() > MAX_FINGERS);
        items.is_some_and(|items| is_list(items) || is_of_axis(name))
    };
    match row {
        Json::Array(items) => items.len() > 1 && is_list(items),
        Json::Object(row) if row.keys().any(|name| Heading::of(name).is_time()) => false,
        row => row.as_object().is_some_and(|row| row.iter().any(is_long)),
    }
}

/// Rows of a table, if the object contains a single list of objects (the rows), or if its lists have the same length
/// and one of them contains a vector for each row. The single values of the object are added to each row. `None` for
/// other objects.
///
/// # Errors
/// An error if the object contains several lists of objects.
fn nested(
    file: &RecordedFile,
    object: &Map<String, Json>,
) -> Result<Option<Vec<Json>>, RecordedError> {
    let lists = || {
        let lists = object.iter();
        lists.filter_map(|(name, value)| Some((name, value.as_array()?)))
    };
    let mut single = Vec::new();
    single_values(object, "", &mut single);
    let shared = || single.iter().cloned();
    let has_objects = |list: &[Json]| list.len() > 1 && list.iter().all(Json::is_object);
    let of_objects: Vec<_> = lists().filter(|(_, list)| has_objects(list)).collect();
    match of_objects[..] {
        [] => {}
        [(_, rows)] => {
            let row = |row: &Json| shared().chain(row.as_object().cloned().unwrap_or_default());
            return Ok(Some(rows.iter().map(|one| row(one).collect()).collect()));
        }
        [(one, _), (other, _), ..] => {
            return Err(file.error(format!(
                "has several lists of objects (`{one}`, `{other}`); write the list with the readings into its own file"
            )));
        }
    }
    let count = lists().map(|(_, list)| list.len()).max().unwrap_or(0);
    let is_vector = |(_, list): (&String, &Vec<Json>)| list.iter().all(Json::is_array);
    if count <= MAX_COMPONENTS || lists().any(|(_, list)| list.len() != count) {
        return Ok(None);
    }
    let row = |row: usize| {
        let own = lists().map(|(name, list)| (name.clone(), list[row].clone()));
        shared().chain(own).collect()
    };
    Ok(lists()
        .any(is_vector)
        .then(|| (0..count).map(row).collect()))
}

/// Collects the single values of a JSON object, that is, the values that are neither lists nor parts of lists. Each
/// value is stored with its path in the object, such as `meta.tip_radius`.
fn single_values(object: &Map<String, Json>, path: &str, values: &mut Vec<(String, Json)>) {
    for (name, value) in object {
        let name = format!("{path}{name}");
        match value {
            Json::Array(_) => {}
            Json::Object(inner) => single_values(inner, &format!("{name}."), values),
            value => values.push((name, value.clone())),
        }
    }
}

/// Names and values of the columns, if the object has one list per column; otherwise `None`. Single values of the
/// object are added to each row.
#[expect(clippy::type_complexity, reason = "names and values of the columns")]
fn columns(
    file: &RecordedFile,
    object: Map<String, Json>,
) -> Result<Option<(Vec<String>, Vec<Vec<Json>>)>, RecordedError> {
    let is_scalar = |item: &Json| !item.is_array() && !item.is_object();
    let is_column = |value: &Json| match value {
        Json::Array(items) => items.iter().all(is_scalar),
        // pandas writes a column as an object, with the number of the row as the key of each value.
        Json::Object(items) => items
            .iter()
            .all(|(row, item)| row.parse::<u64>().is_ok() && is_scalar(item)),
        _ => false,
    };
    // A long list is a column. A short list may instead be a vector in a table with a single row, unless its name
    // denotes one axis.
    let is_long = |value: &Json| value.as_array().map_or(0, Vec::len) > MAX_COMPONENTS;
    let is_list = |value: &Json| value.is_array() || value.is_object();
    let (lists, shared): (Vec<_>, Vec<_>) =
        object.into_iter().partition(|(_, value)| is_list(value));
    let count = lists.len();
    let is_table = (lists.iter()).any(|(name, value)| is_of_axis(name) || is_long(value));
    if !is_table || !(2..=MAX_KEYS).contains(&count) || !lists.iter().all(|(_, one)| is_column(one))
    {
        return Ok(None);
    }
    let (mut names, mut columns) = (Vec::new(), Vec::<Vec<Json>>::new());
    for (name, value) in lists {
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
    let rows = columns[0].len();
    for (name, value) in shared {
        names.push(name);
        columns.push(vec![value; rows]);
    }
    Ok(Some((names, columns)))
}

/// Whether a name denotes one axis, such as `x_mm`.
fn is_of_axis(name: &str) -> bool {
    let name = spelt(name);
    let mut words = name.split('_');
    words.any(|word| matches!(word, "x" | "y" | "z" | "u" | "v"))
}

/// Rows of a table that pandas wrote with the orientation `split`, `table` or `index`; `None` if it is no such table.
/// Returns an error if a column occurs twice, or if a row has another number of values than there are columns.
fn records(
    file: &RecordedFile,
    object: &Map<String, Json>,
) -> Result<Option<Vec<Json>>, RecordedError> {
    let Some(Json::Array(rows)) = object.get("data") else {
        let row = |(number, row): (&String, &Json)| {
            // If this is a column instead of a row, its keys are the numbers of the rows.
            let keys = row.as_object()?.keys();
            let has_names = keys.into_iter().any(|key| key.parse::<u64>().is_err());
            let number = number.parse::<u64>().ok().filter(|_| has_names)?;
            Some((number, row.clone()))
        };
        let rows = object.iter().map(row).collect::<Option<Vec<_>>>();
        let mut rows = rows.unwrap_or_default();
        rows.sort_by_key(|(number, _)| *number);
        let rows: Vec<Json> = rows.into_iter().map(|(_, row)| row).collect();
        return Ok(Some(rows).filter(|rows| !rows.is_empty()));
    };
    let Some(names) = object.get("columns").and_then(Json::as_array) else {
        return Ok(object.contains_key("schema").then(|| rows.clone()));
    };
    let names: Vec<String> = names.iter().map(scalar).collect();
    if let Some(name) = (1..names.len()).find(|&at| names[..at].contains(&names[at])) {
        let message = format!("column `{}` occurs twice; rename one of them", names[name]);
        return Err(file.fail(1, message));
    }
    let row = |(number, row): (usize, &Json)| {
        let values = row.as_array().map_or(&[][..], Vec::as_slice);
        if values.len() != names.len() {
            let (found, expected) = (values.len(), names.len());
            return Err(file.fail(number, format!("{found} values for {expected} columns")));
        }
        let pairs = names.iter().cloned().zip(values.iter().cloned());
        Ok(Json::Object(pairs.collect()))
    };
    (1..).zip(rows).map(row).collect::<Result<_, _>>().map(Some)
}

/// The JSON object of a row, and the line where it begins.
type Object = Result<(Json, usize), RecordedError>;

fn is_list(text: Text<'_>) -> bool {
    text.all.trim_start().starts_with('[')
}

/// JSON values in a list or one after the other, each with the line where it begins.
struct Elements<'a> {
    file: &'a RecordedFile,
    rest: &'a str,
    end: char,
    line: usize,
    is_list: bool,
}

impl<'a> Elements<'a> {
    fn of(file: &'a RecordedFile, text: Text<'a>) -> Self {
        let mut elements = Self {
            file,
            rest: text.all,
            end: text.end,
            line: text.line,
            is_list: is_list(text),
        };
        elements.advance(0);
        elements.advance(usize::from(elements.is_list));
        if elements.is_list && elements.rest == "]" {
            elements.rest = "";
        }
        elements
    }

    fn advance(&mut self, bytes: usize) {
        let rest = self.rest[bytes..].trim_start();
        let skipped = &self.rest[..self.rest.len() - rest.len()];
        self.line += skipped.matches(self.end).count();
        self.rest = rest;
    }
}

impl Iterator for Elements<'_> {
    type Item = Object;

    fn next(&mut self) -> Option<Object> {
        if self.rest.is_empty() {
            return None;
        }
        let line = self.line;
        // Outside of a list, each object is on a line of its own (JSON Lines). In a list, an object may extend over
        // several lines.
        let end = if self.is_list {
            None
        } else {
            self.rest.find(self.end)
        };
        let text = &self.rest[..end.unwrap_or(self.rest.len())];
        let mut elements = serde_json::Deserializer::from_str(text).into_iter::<Json>();
        let element = match elements.next()? {
            Ok(element) => element,
            Err(error) => {
                self.rest = "";
                return Some(Err(no_json(self.file, line, text, &error)));
            }
        };
        self.advance(elements.byte_offset());
        if self.is_list {
            match self.rest.strip_prefix([',', ']']) {
                Some(rest) if rest.trim().is_empty() == self.rest.starts_with(']') => {
                    self.advance(1)
                }
                _ => {
                    let message = format!("is no JSON object: the list is not closed; {NEEDED}");
                    return Some(Err(self.file.fail(self.line, message)));
                }
            }
        }
        Some(Ok((element, line)))
    }
}

const NEEDED: &str = "a list of objects is needed, or an object per line";

fn no_json(
    file: &RecordedFile,
    line: usize,
    text: &str,
    error: &serde_json::Error,
) -> RecordedError {
    let mut lines = text.lines().skip(error.line().saturating_sub(1));
    let before = error.column().saturating_sub(1);
    let rest = lines.next().and_then(|line| line.get(before..));
    let is_no_number = |name: &&str| rest.is_some_and(|rest| rest.starts_with(*name));
    if let Some(name) = ["NaN", "Infinity"].into_iter().find(is_no_number) {
        let line = line + error.line().saturating_sub(1);
        return file.fail(
            line,
            format!("`{name}` is no number of JSON; leave such rows out"),
        );
    }
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    let what = format!(
        "is no JSON object: {message} (character {})",
        error.column()
    );
    file.fail(line, format!("{what}; {NEEDED}"))
}

/// Names and values of an object or a list; nested names are joined by points, as in `position.0`.
fn pairs(
    file: &RecordedFile,
    line: usize,
    value: &Json,
) -> Result<Vec<(String, String)>, RecordedError> {
    if !value.is_object() && !value.is_array() {
        return Err(file.fail(line, format!("is no JSON object; {NEEDED}")));
    }
    let mut pairs = Vec::new();
    flatten("", value, &mut pairs);
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
