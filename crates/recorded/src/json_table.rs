//! Tables in JSON: one object per line, a list of objects or of rows, an object with one list per column, or an object
//! that contains a list of objects.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::fmt;

use csv::StringRecord;
use palpate_study::readings::spelt;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

use super::decimal::is_missing;
use super::error::RecordedError;
use super::file::RecordedFile;
use super::heading::{Heading, RowLabel, in_order, is_within, repeated, row_label};
use super::text_table::{Record, RowResult, Text};

/// Maximum number of columns of a table; a row may lack some of these columns.
const MAX_KEYS: usize = 1_000;
/// Maximum number of fingers whose readings are side by side in a row without a time. A longer list is a series of
/// readings.
pub(super) const MAX_FINGERS: usize = 5;
/// The column names are those of the longest row among this number of rows.
const COMPARED: usize = 8;
/// Maximum number of levels of nested lists and objects. More levels would overflow the stack.
const MAX_DEPTH: isize = 100;
/// Maximum number of components of a vector or a quaternion.
const MAX_COMPONENTS: usize = 4;

/// Names and values of a row or of an object, in the order of the file.
type Members<'a> = Vec<(Cow<'a, str>, &'a RawValue)>;
/// Names and texts of single values.
type Texts<'a> = Vec<(String, Cow<'a, str>)>;
/// Names and values of columns.
type Columns<'a> = Vec<(Cow<'a, str>, Vec<&'a RawValue>)>;

enum Rows<'a> {
    /// Text of each row (an object or a list), with a number for messages: the line of the row or, if the whole list is
    /// written in one line, the number of the row, counted from 1. If `names` contains column names, each row is a list
    /// with one value per name.
    Sequence {
        rows: Vec<(&'a str, usize)>,
        names: Option<Vec<String>>,
        is_list: bool,
    },
    Columns(Columns<'a>),
}

pub(super) struct JsonTable<'a> {
    rows: Rows<'a>,
    /// Single values of the object that contains the rows. They belong to every row. Each value has its path in the
    /// object as its name, such as `meta.tip_radius`.
    shared: Texts<'a>,
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
            rows: Rows::Columns(Vec::new()),
            shared: Vec::new(),
            names: Vec::new(),
            header_line,
        };
        let mut depth = 0_isize;
        let is_deep = text.all.bytes().any(|byte| {
            depth += isize::from(matches!(byte, b'[' | b'{'));
            depth -= isize::from(matches!(byte, b']' | b'}'));
            depth > MAX_DEPTH
        });
        if is_deep {
            let message = format!("has more than {MAX_DEPTH} levels of nested lists and objects");
            return Err(file.error(message));
        }
        match serde_json::from_str(text.all) {
            Ok(Object(members)) => table.read_object(file, text, members)?,
            Err(_) => table.rows = sequence(file, text, None)?,
        }
        // A row with a lost reading may lack a key, or have null instead of a vector. Therefore the column names are those
        // of the longest row among the first rows without null and NaN. If each row contains null or NaN, the column
        // names are those of the first row.
        let is_whole = |row: &str| !["null", "NaN"].iter().any(|lost| row.contains(lost));
        let is_whole = |&place: &usize| match &table.rows {
            Rows::Sequence { rows, .. } => is_whole(rows[place].0),
            Rows::Columns(columns) => columns.iter().all(|one| is_whole(one.1[place].get())),
        };
        let whole = (0..table.count()).filter(is_whole).take(COMPARED);
        let whole = whole.map(|place| table.row(file, place));
        let whole = whole.collect::<Result<Vec<_>, _>>()?;
        let (first, line) = match whole.into_iter().rev().max_by_key(|row| row.0.len()) {
            Some(row) => row,
            None if table.count() > 0 => table.row(file, 0)?,
            None => (Vec::new(), header_line),
        };
        let is_of_lists = match &table.rows {
            Rows::Sequence { rows, names, .. } if names.is_none() => {
                rows.first().is_some_and(|row| is_list(row.0))
            }
            _ => false,
        };
        if let Some(label) = label.filter(|_| has_series(&first, is_of_lists)) {
            return Err(file.error(format!(
                "has lists of readings that may belong to one `{label}` or to one time each; write one list of readings, each with the key `{label}`"
            )));
        }
        let (count, values) = (first.len(), values(file, line, &first)?);
        table.names = values.into_iter().map(|(name, _)| name).collect();
        if let Rows::Sequence { names, .. } = &mut table.rows
            && is_of_lists
        {
            *names = Some((0..count).map(|place| place.to_string()).collect());
        }
        let names: HashSet<String> = table.names.iter().cloned().collect();
        table.shared.retain(|(name, _)| !names.contains(name));
        let shared = table.shared.iter().map(|(name, _)| name.clone());
        table.names.extend(shared);
        let message = match table.names.len() {
            0 => "the first JSON object is empty; its keys must name the columns".to_owned(),
            1..=MAX_KEYS => {
                let names = table.names.clone();
                return Ok((table, names));
            }
            many => format!("has {many} columns; at most {MAX_KEYS} are read"),
        };
        Err(file.fail(line, message))
    }

    /// Finds the rows in an object with the given members. If it contains none, the object itself is the only row.
    fn read_object(
        &mut self,
        file: &RecordedFile,
        text: Text<'a>,
        mut members: Members<'a>,
    ) -> RowResult {
        if let Some(key) = repeated(members.iter().map(|(key, _)| &**key)) {
            return Err(file.fail(text.line, twice(key)));
        }
        let member = |name: &str| {
            let mut members = members.iter();
            Some(members.find(|(key, _)| key == name)?.1.get())
        };
        let within = |part: &'a str| Text {
            all: part,
            ..text.from(part)
        };
        let data = member("data").filter(|data| is_list(data));
        let split = member("columns").and_then(|columns| serde_json::from_str(columns).ok());
        if let Some(data) = data
            && (split.is_some() || member("schema").is_some())
        {
            let split: Option<Vec<&RawValue>> = split;
            let name = |name: &RawValue| plain(name).unwrap_or(name.get().into()).into_owned();
            let names: Option<Vec<String>> =
                split.map(|names| names.into_iter().map(name).collect());
            if let Some(name) = names
                .as_ref()
                .and_then(|names| repeated(names.iter().map(|name| &**name)))
            {
                let message = format!("column `{name}` occurs twice; rename one of them");
                return Err(file.fail(1, message));
            }
            self.rows = sequence(file, within(data), names)?;
            return Ok(());
        }
        if let Some(rows) = indexed(&members) {
            self.rows = rows;
            return Ok(());
        }
        let has_objects = |value: &RawValue| {
            let text = value.get().strip_prefix('[');
            text.is_some_and(|text| text.trim_start().starts_with('{')) && {
                let items = items(value);
                items.len() > 1 && items.iter().all(|item| item.get().starts_with('{'))
            }
        };
        let lists: Vec<_> = members.iter().filter(|one| has_objects(one.1)).collect();
        self.rows = match lists[..] {
            [] => match columns(file, &members)? {
                Some(columns) => {
                    members.retain(|(name, _)| columns.iter().all(|column| column.0 != *name));
                    Rows::Columns(columns)
                }
                None => sequence(file, text, None)?,
            },
            [(_, rows)] => sequence(file, within(rows.get()), None)?,
            [(one, _), (other, _), ..] => {
                return Err(file.error(format!(
                    "has several lists of objects (`{one}`, `{other}`); write the list with the readings into its own file"
                )));
            }
        };
        for (name, value) in members {
            shared_values(&name, value, &mut self.shared);
        }
        Ok(())
    }

    fn count(&self) -> usize {
        match &self.rows {
            Rows::Sequence { rows, .. } => rows.len(),
            Rows::Columns(columns) => columns.first().map_or(0, |(_, column)| column.len()),
        }
    }

    /// Names and values of a row, and its number for messages.
    fn row<'s>(
        &'s self,
        file: &RecordedFile,
        place: usize,
    ) -> Result<(Members<'s>, usize), RecordedError> {
        let (rows, names) = match &self.rows {
            Rows::Sequence { rows, names, .. } => (rows, names),
            Rows::Columns(columns) => {
                let value = |(name, column): &'s (Cow<'a, str>, Vec<&'a RawValue>)| {
                    (Cow::Borrowed(&**name), column[place])
                };
                return Ok((columns.iter().map(value).collect(), place + 1));
            }
        };
        let (row, line) = rows[place];
        let fail = |error| no_json(file, line, &error);
        let Some(names) = names else {
            let row: &RawValue = serde_json::from_str(row).map_err(fail)?;
            let members = members(row).map_err(fail)?;
            return match plain(row) {
                Some(_) => Err(file.fail(line, format!("is no JSON object; {NEEDED}"))),
                None => Ok((members, line)),
            };
        };
        let values: Vec<&RawValue> = match is_list(row) {
            true => serde_json::from_str(row).map_err(fail)?,
            false => Vec::new(),
        };
        if values.len() != names.len() {
            let (found, expected) = (values.len(), names.len());
            return Err(file.fail(line, format!("{found} values for {expected} columns")));
        }
        let names = names.iter().map(|name| Cow::Borrowed(name.as_str()));
        Ok((names.zip(values).collect(), line))
    }

    pub(super) fn rows(
        &self,
        file: &RecordedFile,
        mut take: impl FnMut(Record<'_>) -> RowResult,
    ) -> RowResult {
        let (mut fields, mut path) = (StringRecord::new(), String::new());
        let mut before = self.header_line;
        let is_by_lines = matches!(self.rows, Rows::Sequence { is_list: false, .. });
        let own = self.names.len() - self.shared.len();
        for place in 0..self.count() {
            let (row, line) = self.row(file, place)?;
            fields.clear();
            let mut push = |name: &str, value: Cow<'_, str>| {
                let is_next = self
                    .names
                    .get(fields.len())
                    .is_some_and(|next| next == name);
                fields.push_field(&value);
                is_next
            };
            let is_regular = each_value(&row, &mut path, &mut push) && fields.len() == own;
            if !is_regular {
                fields = self.irregular(file, line, &row)?;
            }
            for (_, value) in &self.shared {
                fields.push_field(value);
            }
            take(Record {
                line,
                is_after_gap: is_by_lines && line > before + 1,
                fields: &fields,
            })?;
            before = line;
        }
        Ok(())
    }

    /// Fields of a row that lacks columns of the table, has other columns, or has them in another order.
    fn irregular(
        &self,
        file: &RecordedFile,
        line: usize,
        row: &Members<'_>,
    ) -> Result<StringRecord, RecordedError> {
        let values: HashMap<String, Cow<'_, str>> = values(file, line, row)?.into_iter().collect();
        let mut fields = StringRecord::new();
        for name in &self.names[..self.names.len() - self.shared.len()] {
            let value = values.get(name);
            let keys = values.keys().filter(|_| value.is_none());
            let keys = keys.filter(|key| is_within(key, name) || is_within(name, key));
            if let Some(key) = keys.min().filter(|key| !is_missing(&values[*key])) {
                let message = format!("has `{key}`, but the first row has `{name}`");
                return Err(file.fail(line, message));
            }
            fields.push_field(value.map_or("", |value| value));
        }
        Ok(fields)
    }
}

/// The rows in a text that is a JSON list, or that has a JSON object in each line (JSON Lines).
fn sequence<'a>(
    file: &RecordedFile,
    text: Text<'a>,
    names: Option<Vec<String>>,
) -> Result<Rows<'a>, RecordedError> {
    let is_list = is_list(text.all.trim_start());
    let lines = || text.rows_after(0).map(|(row, line)| (row.trim(), line));
    let rows = if is_list {
        let rows: Vec<&RawValue> =
            serde_json::from_str(text.all).map_err(|error| no_json(file, text.line, &error))?;
        let is_one_line = lines().nth(1).is_none();
        let mut rest = text;
        let row = |(row, number): (&&'a RawValue, usize)| {
            rest = rest.from(row.get());
            (row.get(), if is_one_line { number } else { rest.line })
        };
        rows.iter().zip(1..).map(row).collect()
    } else {
        let mut rows = Vec::new();
        for (line, number) in lines() {
            for row in serde_json::Deserializer::from_str(line).into_iter::<&RawValue>() {
                let row = row.map_err(|error| no_json(file, number, &error))?;
                rows.push((row.get(), number));
            }
        }
        rows
    };
    Ok(Rows::Sequence {
        rows,
        names,
        is_list,
    })
}

/// Rows of a table that pandas wrote with the orientation `index`, with their numbers in the table; `None` if it is no
/// such table.
fn indexed<'a>(members: &Members<'a>) -> Option<Rows<'a>> {
    let row = |(number, row): &(Cow<'a, str>, &'a RawValue)| {
        // The keys of a row are names of columns. An object whose keys are labels of rows is a column.
        let is_row = row.get().starts_with('{') && labelled_rows(row).is_none();
        Some((row_label(number).filter(|_| is_row)?, row.get()))
    };
    let rows = members.iter().map(row).collect::<Option<Vec<_>>>();
    let mut rows = rows.filter(|rows| !rows.is_empty())?;
    rows.sort_by(|one, other| in_order(&one.0, &other.0));
    Some(Rows::Sequence {
        rows: rows.into_iter().map(|(_, row)| row).zip(1..).collect(),
        names: None,
        is_list: true,
    })
}

/// Whether the first row of a table contains a series of readings. A row that is a list of lists or objects is a
/// series. In a row that is an object without a time, a long list of vectors or objects, or of numbers along one axis,
/// is a series. Long means more items than a hand has fingers; a shorter list contains the fingers at one time.
fn has_series(row: &Members<'_>, is_list: bool) -> bool {
    let is_nested = |value: &&RawValue| value.get().starts_with(['[', '{']);
    let is_long = |(name, value): &(Cow<'_, str>, &RawValue)| {
        let items = items(value);
        items.len() > MAX_FINGERS && (items.iter().all(is_nested) || is_of_axis(name))
    };
    if is_list {
        return row.len() > 1 && row.iter().all(|(_, value)| is_nested(value));
    }
    let has_time = row.iter().any(|(name, _)| Heading::of(name).is_time());
    !has_time && row.iter().any(is_long)
}

/// Collects the single values in `value`, that is, the values that are neither lists nor parts of lists.
fn shared_values<'a>(path: &str, value: &'a RawValue, shared: &mut Texts<'a>) {
    if let Some(text) = plain(value) {
        shared.push((path.to_owned(), text));
    } else if !is_list(value.get()) {
        for (name, value) in members(value).unwrap_or_default() {
            shared_values(&format!("{path}.{name}"), value, shared);
        }
    }
}

/// Names and values of the columns, if the object has one list per column; otherwise `None`. The items of a list are
/// single values or vectors.
fn columns<'a>(
    file: &RecordedFile,
    members: &Members<'a>,
) -> Result<Option<Columns<'a>>, RecordedError> {
    let mut columns = Columns::new();
    let (mut is_table, mut has_vectors) = (false, false);
    let (mut row_labels, mut other) = (None, None);
    for (name, value) in members {
        let column = if is_list(value.get()) {
            items(value)
        } else if let Some((labels, column)) = labelled_rows(value) {
            let (first, expected) = row_labels.get_or_insert((name, labels.clone()));
            if *expected != labels {
                other = Some([*first, name]);
            }
            column
        } else {
            continue;
        };
        let is_plain = column.iter().all(|value| plain(value).is_some());
        let is_vector = |item: &&RawValue| {
            is_list(item.get()) || plain(item).is_some_and(|text| is_missing(&text))
        };
        if !is_plain && !column.iter().all(is_vector) {
            return Ok(None);
        }
        has_vectors |= !is_plain;
        // A long list is a column. A short list is a column only if its name denotes one axis; otherwise it may be a
        // vector in a table with a single row.
        let is_long = is_list(value.get()) && column.len() > MAX_COMPONENTS;
        is_table |= (is_plain && is_of_axis(name)) || is_long;
        columns.push((name.clone(), column));
    }
    let least = if has_vectors { 1 } else { 2 };
    if !is_table || !(least..=MAX_KEYS).contains(&columns.len()) {
        return Ok(None);
    }
    let (first, rows) = (&columns[0].0, columns[0].1.len());
    if let Some((name, column)) = columns.iter().find(|(_, column)| column.len() != rows) {
        return Err(file.error(format!(
            "has columns of different lengths: `{first}` has {rows} values, `{name}` has {}",
            column.len()
        )));
    }
    if let Some([one, other]) = other {
        return Err(file.error(format!(
            "has columns with different rows: `{one}` and `{other}` differ in the labels of their rows"
        )));
    }
    Ok(Some(columns))
}

/// Parses a column whose keys are the labels of rows, as pandas writes it. Returns these labels and the values, in the
/// order of the labels. `None` if the keys are no labels or occur twice.
fn labelled_rows(value: &RawValue) -> Option<(Vec<RowLabel<'_>>, Vec<&RawValue>)> {
    let Object(members) = serde_json::from_str(value.get()).ok()?;
    let row = |(label, value)| Some((row_label(&label)?, value));
    let rows: Option<Vec<(RowLabel<'_>, &RawValue)>> = members.into_iter().map(row).collect();
    let mut rows = rows?;
    rows.sort_by(|one, other| in_order(&one.0, &other.0));
    let is_distinct = rows.windows(2).all(|rows| rows[0].0 < rows[1].0);
    is_distinct.then(|| rows.into_iter().unzip())
}

fn twice(key: &str) -> String {
    format!("the key `{key}` occurs twice in an object; rename one of them")
}

/// A JSON object: its members in the order of the file.
struct Object<'a>(Members<'a>);

impl<'de> Deserialize<'de> for Object<'de> {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_map(ObjectVisitor)
    }
}

/// A key, which is copied only if it contains escape sequences.
#[derive(Deserialize)]
struct Key<'a>(#[serde(borrow)] Cow<'a, str>);

struct ObjectVisitor;

impl<'de> Visitor<'de> for ObjectVisitor {
    type Value = Object<'de>;

    fn expecting(&self, text: &mut fmt::Formatter<'_>) -> fmt::Result {
        text.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut pairs: A) -> Result<Self::Value, A::Error> {
        let mut members = Vec::new();
        while let Some((Key(key), value)) = pairs.next_entry()? {
            members.push((key, value));
        }
        Ok(Object(members))
    }
}

/// Names and values in an object or a list; the names in a list are 0, 1, 2 and so on.
fn members(value: &RawValue) -> Result<Members<'_>, serde_json::Error> {
    if is_list(value.get()) {
        let items: Vec<&RawValue> = serde_json::from_str(value.get())?;
        let names = (0..).map(|place: usize| Cow::Owned(place.to_string()));
        return Ok(names.zip(items).collect());
    }
    match plain(value) {
        Some(_) => Ok(Vec::new()),
        None => serde_json::from_str(value.get()).map(|Object(members)| members),
    }
}

/// Items of a list; empty for other values.
fn items(value: &RawValue) -> Vec<&RawValue> {
    serde_json::from_str(value.get()).unwrap_or_default()
}

fn is_list(text: &str) -> bool {
    text.starts_with('[')
}

/// Whether a name denotes one axis, such as `x_mm`.
fn is_of_axis(name: &str) -> bool {
    let is_axis = |word| matches!(word, "x" | "y" | "z" | "u" | "v");
    spelt(name).split('_').any(is_axis)
}

const NEEDED: &str = "a list of objects is needed, or an object per line";

fn no_json(file: &RecordedFile, line: usize, error: &serde_json::Error) -> RecordedError {
    let line = line + error.line().saturating_sub(1);
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    let column = error.column();
    let message = format!("is no JSON object: {message} (character {column}); {NEEDED}");
    file.fail(line, message)
}

/// Names and texts of all single values in a row. Returns an error if an object has a key twice.
fn values<'r>(
    file: &RecordedFile,
    line: usize,
    row: &Members<'r>,
) -> Result<Texts<'r>, RecordedError> {
    let mut values = Vec::new();
    if let Some(key) = repeated_key(row) {
        return Err(file.fail(line, twice(&key)));
    }
    each_value(row, &mut String::new(), &mut |name, value| {
        values.push((name.to_owned(), value));
        true
    });
    Ok(values)
}

/// A key that occurs twice in one of the objects in a row.
fn repeated_key(row: &Members<'_>) -> Option<String> {
    let own = repeated(row.iter().map(|(key, _)| &**key));
    own.map(str::to_owned).or_else(|| {
        let mut within = row.iter().map(|(_, value)| members(value));
        within.find_map(|members| repeated_key(&members.unwrap_or_default()))
    })
}

/// Calls `take` with the name and the text of each single value in `row`, until `take` returns false. The names of
/// nested values are joined by points, as in `position.0`; `path` is the name of `row` itself.
fn each_value<'r>(
    row: &Members<'r>,
    path: &mut String,
    take: &mut impl FnMut(&str, Cow<'r, str>) -> bool,
) -> bool {
    let length = path.len();
    row.iter().all(|(name, value)| {
        if length > 0 {
            path.push('.');
        }
        path.push_str(name);
        let is_continued = match plain(value) {
            Some(text) => take(path, text),
            None => each_value(&members(value).unwrap_or_default(), path, take),
        };
        path.truncate(length);
        is_continued
    })
}

/// A single JSON value as text; empty for `null`. `None` for a list or an object. Numbers are not converted, so they are
/// as precise as in the file.
fn plain(value: &RawValue) -> Option<Cow<'_, str>> {
    match value.get() {
        "null" => Some("".into()),
        text if text.starts_with(['[', '{']) => None,
        text if text.starts_with('"') => {
            Some(serde_json::from_str(text).map_or(text.into(), |Key(text)| text))
        }
        text => Some(text.into()),
    }
}
