//! Tables in JSON: one object per line, a list of objects or of rows, an object with one list per column, or an object
//! that contains a list of objects.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt;

use csv::StringRecord;
use palpate_study::readings::spelt;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use serde_json::{Map, Value as Json};

use super::decimal::is_missing;
use super::error::RecordedError;
use super::file::RecordedFile;
use super::heading::Heading;
use super::text_table::{Record, RowResult, Text};

/// Maximum number of columns of a table; a row may lack some of these columns.
const MAX_KEYS: usize = 1_000;

/// Maximum number of fingers whose readings are side by side in a row without a time. A longer list is a series of
/// readings.
pub(super) const MAX_FINGERS: usize = 5;

/// Maximum number of components of a vector or a quaternion.
const MAX_COMPONENTS: usize = 4;

enum Rows<'a> {
    /// Text of each row (an object or a list), with a number for messages: the line of the row or, if the whole list is
    /// written in one line, the number of the row, counted from 1. If `names` contains column names, each row is a list
    /// with one value per name.
    Sequence {
        rows: Vec<(&'a str, usize)>,
        names: Option<Vec<String>>,
        is_list: bool,
    },
    Records(Vec<Json>),
    Columns(Vec<Vec<&'a RawValue>>),
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
        for value in serde_json::Deserializer::from_str(text.all).into_iter::<&RawValue>() {
            value.map_or(Ok(()), |value| check_keys(file, text, value.get()))?;
        }
        let object: BTreeMap<String, &RawValue> =
            serde_json::from_str(text.all).unwrap_or_default();
        let data = object.get("data").map(|data| Text {
            all: data.get(),
            ..text.from(data.get())
        });
        let data = data.filter(|data| data.all.starts_with('['));
        let split = object.get("columns").filter(|_| data.is_some());
        let split = split.and_then(|columns| serde_json::from_str::<Vec<Json>>(columns.get()).ok());
        let mut table = Self {
            rows: Rows::Columns(Vec::new()),
            names: Vec::new(),
            header_line,
        };
        table.rows =
            if let Some(data) = data.filter(|_| split.is_some() || object.contains_key("schema")) {
                let names = split.map(|columns| distinct(file, &columns)).transpose()?;
                sequence(file, data, names)?
            } else if let Some(rows) = indexed(&object) {
                Rows::Sequence {
                    rows,
                    names: None,
                    is_list: true,
                }
            } else if let Some((names, columns)) = columns(file, object)? {
                table.rows = Rows::Columns(columns);
                table.names.clone_from(&names);
                return Ok((table, names));
            } else {
                let object = serde_json::from_str(text.all).ok();
                let rows = object.map(|object| nested(file, &object)).transpose()?;
                match rows.flatten() {
                    Some(rows) => Rows::Records(rows),
                    None => sequence(file, text, None)?,
                }
            };
        // A lost reading may be null instead of a vector such as [x, y, z], and then has fewer columns. Therefore take
        // the column names from the first row that contains neither null nor NaN, or from the first row if there is no
        // such row.
        let is_whole = |row: &str| !["null", "NaN"].iter().any(|lost| row.contains(lost));
        let first = match &table.rows {
            Rows::Sequence { rows, names, .. } => {
                let value = |&(row, line)| Ok((value(file, names.as_deref(), line, row)?, line));
                let mut whole = rows.iter().filter(|(row, _)| is_whole(row));
                whole.next().or(rows.first()).map(value).transpose()?
            }
            Rows::Records(rows) => {
                let mut whole = rows
                    .iter()
                    .zip(1..)
                    .filter(|(row, _)| is_whole(&row.to_string()));
                let first = whole.next().or(rows.first().map(|row| (row, 1)));
                first.map(|(row, number)| (row.clone(), number))
            }
            Rows::Columns(_) => None,
        };
        let (first, line) = first.unwrap_or((Json::Null, header_line));
        if let Some(label) = label.filter(|_| has_series(&first)) {
            return Err(file.error(format!(
                "has lists of readings that may belong to one `{label}` or to one time each; write one list of readings, each with the key `{label}`"
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

    pub(super) fn rows(
        &self,
        file: &RecordedFile,
        mut take: impl FnMut(Record<'_>) -> RowResult,
    ) -> RowResult {
        let mut fields = StringRecord::new();
        let mut take = |line: usize, is_after_gap: bool, fields: &StringRecord| {
            take(Record {
                line,
                is_after_gap,
                fields,
            })
        };
        match &self.rows {
            Rows::Sequence {
                rows,
                names,
                is_list,
            } => {
                let names = names.as_deref();
                let places = self.places(names);
                let mut before = self.header_line;
                for &(row, line) in rows {
                    fields.clear();
                    match self.plain_values(row, names, &places) {
                        Some(values) => values.iter().for_each(|value| fields.push_field(value)),
                        None => {
                            let row = value(file, names, line, row)?;
                            self.nested_values(file, line, &row, &mut fields)?;
                        }
                    }
                    take(line, !is_list && line > before + 1, &fields)?;
                    before = line;
                }
            }
            Rows::Records(rows) => {
                for (row, number) in rows.iter().zip(1..) {
                    fields.clear();
                    self.nested_values(file, number, row, &mut fields)?;
                    take(number, false, &fields)?;
                }
            }
            Rows::Columns(columns) => {
                for row in 0..columns.first().map_or(0, Vec::len) {
                    fields.clear();
                    for column in columns {
                        fields.push_field(&plain(column[row]).unwrap_or_default());
                    }
                    take(row + 1, false, &fields)?;
                }
            }
        }
        Ok(())
    }

    /// For each column, the index of its value in a row that is a list. `names` contains the names of the values in a
    /// row. Without `names`, the name of a column is this index. `None` if a column has no value in the rows.
    fn places(&self, names: Option<&[String]>) -> Option<Vec<usize>> {
        let place = |name: &String| match names {
            Some(names) => names.iter().position(|one| one == name),
            None => name.parse().ok(),
        };
        self.names.iter().map(place).collect()
    }

    /// Values of a row. `None` if the row lacks a column of the table, has additional values, or contains lists or
    /// objects. `places` contains the indices of the columns in a row that is a list.
    fn plain_values<'v>(
        &self,
        row: &'v str,
        names: Option<&[String]>,
        places: &Option<Vec<usize>>,
    ) -> Option<Vec<Cow<'v, str>>> {
        let count = names.map_or(self.names.len(), <[String]>::len);
        if row.starts_with('[') || names.is_some() {
            let values: Vec<&RawValue> = serde_json::from_str(row).ok()?;
            let places = places.as_ref().filter(|_| values.len() == count)?.iter();
            return places.map(|&place| plain(values.get(place)?)).collect();
        }
        let values: BTreeMap<&str, &RawValue> = serde_json::from_str(row).ok()?;
        let names = Some(&self.names).filter(|_| values.len() == count)?.iter();
        names.map(|name| plain(values.get(&**name)?)).collect()
    }

    /// Adds the values of a row to `fields`. Lists and objects in the row are divided into one value per column.
    fn nested_values(
        &self,
        file: &RecordedFile,
        line: usize,
        row: &Json,
        fields: &mut StringRecord,
    ) -> RowResult {
        let pairs = pairs(file, line, row)?;
        if pairs.iter().map(|(name, _)| name).eq(&self.names) {
            pairs.iter().for_each(|(_, value)| fields.push_field(value));
            return Ok(());
        }
        let values: HashMap<String, String> = pairs.into_iter().collect();
        for name in &self.names {
            let value = values.get(name);
            let keys = values.keys().filter(|_| value.is_none());
            let keys = keys.filter(|key| is_within(key, name) || is_within(name, key));
            if let Some(key) = keys.min().filter(|key| !is_missing(&values[*key])) {
                let message = format!("has `{key}`, but the first row has `{name}`");
                return Err(file.fail(line, message));
            }
            fields.push_field(value.map_or("", String::as_str));
        }
        Ok(())
    }
}

/// Names of columns. Returns an error if a name occurs twice.
fn distinct(file: &RecordedFile, columns: &[Json]) -> Result<Vec<String>, RecordedError> {
    let names: Vec<String> = columns.iter().map(scalar).collect();
    match (1..names.len()).find(|&at| names[..at].contains(&names[at])) {
        Some(at) => {
            let message = format!("column `{}` occurs twice; rename one of them", names[at]);
            Err(file.fail(1, message))
        }
        None => Ok(names),
    }
}

/// The rows in a text that is a JSON list, or that has a JSON object in each line (JSON Lines).
fn sequence<'a>(
    file: &RecordedFile,
    text: Text<'a>,
    names: Option<Vec<String>>,
) -> Result<Rows<'a>, RecordedError> {
    let is_list = text.all.trim_start().starts_with('[');
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
fn indexed<'a>(object: &BTreeMap<String, &'a RawValue>) -> Option<Vec<(&'a str, usize)>> {
    let row = |(number, row): (&String, &&'a RawValue)| {
        // If this is a column instead of a row, its keys are the numbers of the rows.
        let is_row = row.get().starts_with('{') && numbered_rows(row.get()).is_none();
        let number = number.parse::<u64>().ok().filter(|_| is_row)?;
        Some((number, row.get()))
    };
    let rows = object.iter().map(row).collect::<Option<Vec<_>>>();
    let mut rows = rows.filter(|rows| !rows.is_empty())?;
    rows.sort_by_key(|(number, _)| *number);
    Some(rows.into_iter().map(|(_, row)| row).zip(1..).collect())
}

/// Parses a row. If `names` contains the names of its values, the result is an object with these keys. Returns an error
/// if the row does not have one value per name.
fn value(
    file: &RecordedFile,
    names: Option<&[String]>,
    line: usize,
    row: &str,
) -> Result<Json, RecordedError> {
    let row = serde_json::from_str(row).map_err(|error| no_json(file, line, &error))?;
    let Some(names) = names else {
        return Ok(row);
    };
    let values = match row {
        Json::Array(values) => values,
        _ => Vec::new(),
    };
    if values.len() != names.len() {
        let (found, expected) = (values.len(), names.len());
        return Err(file.fail(line, format!("{found} values for {expected} columns")));
    }
    Ok(Json::Object(names.iter().cloned().zip(values).collect()))
}

/// Whether the column `key` is a component of the value `name`, such as `position.0` of `position`.
fn is_within(key: &str, name: &str) -> bool {
    let part = key.strip_prefix(name);
    part.is_some_and(|part| part.starts_with('.'))
}

/// Whether the first row of a table contains a series of readings. A row that is a list of lists or objects is a
/// series. In a row that is an object without a time, a long list of vectors or objects, or of numbers along one axis,
/// is a series. Long means more items than a hand has fingers; a shorter list contains the fingers at one time.
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

/// Rows of the table in a JSON object. Either the object contains a single list of objects, which are the rows. Or its
/// lists have the same length, with one item per row, and the items of at least one list are vectors. The single values
/// of the object are added to each row. `None` for other objects.
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
    let is_item = |item: &Json| item.is_array() || is_missing(&scalar(item));
    let is_vector = |(_, list): (&String, &Vec<Json>)| {
        list.iter().all(is_item) && list.iter().any(Json::is_array)
    };
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
fn columns<'a>(
    file: &RecordedFile,
    object: BTreeMap<String, &'a RawValue>,
) -> Result<Option<(Vec<String>, Vec<Vec<&'a RawValue>>)>, RecordedError> {
    let (mut names, mut columns, mut shared) = (Vec::new(), Vec::new(), Vec::new());
    let mut is_table = false;
    let (mut row_numbers, mut other) = (None, None);
    for (name, value) in object {
        let column = match value.get() {
            list if list.starts_with('[') => serde_json::from_str(list).ok(),
            rows if rows.starts_with('{') => numbered_rows(rows).map(|rows| {
                let (own, column): (Vec<_>, _) = rows.into_iter().unzip();
                let (first, numbers) =
                    row_numbers.get_or_insert_with(|| (name.clone(), own.clone()));
                if *numbers != own {
                    other = Some([first.clone(), name.clone()]);
                }
                column
            }),
            _ => {
                shared.push((name, value));
                continue;
            }
        };
        let is_column = |column: &Vec<&RawValue>| column.iter().all(|value| plain(value).is_some());
        let Some(column) = column.filter(is_column) else {
            return Ok(None);
        };
        // A long list is a column. A short list is a column only if its name denotes one axis; otherwise it may be a
        // vector in a table with a single row.
        let is_long = value.get().starts_with('[') && column.len() > MAX_COMPONENTS;
        is_table |= is_of_axis(&name) || is_long;
        names.push(name);
        columns.push(column);
    }
    if !is_table || !(2..=MAX_KEYS).contains(&columns.len()) {
        return Ok(None);
    }
    let rows = columns[0].len();
    let mut others = names.iter().zip(&columns);
    if let Some((name, column)) = others.find(|(_, column)| column.len() != rows) {
        return Err(file.error(format!(
            "has columns of different lengths: `{}` has {rows} values, `{name}` has {}",
            names[0],
            column.len()
        )));
    }
    if let Some([one, other]) = other {
        return Err(file.error(format!(
            "has columns with different rows: `{one}` and `{other}` differ in the numbers of their rows"
        )));
    }
    for (name, value) in shared {
        names.push(name);
        columns.push(vec![value; rows]);
    }
    Ok(Some((names, columns)))
}

/// Values of a column by the numbers of their rows. pandas writes a column as such an object.
type NumberedRows<'a> = BTreeMap<u64, &'a RawValue>;

/// Parses a column. `None` if the keys are no numbers of rows.
fn numbered_rows(text: &str) -> Option<NumberedRows<'_>> {
    let Pairs(rows) = serde_json::from_str(text).ok()?;
    let row = |(number, value): (String, _)| Some((number.parse().ok()?, value));
    rows.into_iter().map(row).collect()
}

/// Returns an error if an object in the JSON value `value` has a key twice.
fn check_keys(file: &RecordedFile, text: Text<'_>, value: &str) -> RowResult {
    let within = |item: &RawValue| check_keys(file, text, item.get());
    if value.starts_with('[') {
        let items: Vec<&RawValue> = serde_json::from_str(value).unwrap_or_default();
        return items.into_iter().try_for_each(within);
    }
    let Pairs(pairs) = match value.starts_with('{') {
        true => serde_json::from_str(value).unwrap_or_default(),
        false => return Ok(()),
    };
    let mut keys = HashSet::with_capacity(pairs.len());
    if let Some((key, _)) = pairs.iter().find(|(key, _)| !keys.insert(key.as_str())) {
        let message = format!("the key `{key}` occurs twice in an object; rename one of them");
        return Err(file.fail(text.from(value).line, message));
    }
    pairs.iter().try_for_each(|(_, item)| within(item))
}

/// Keys and values of a JSON object, in the order of the file.
#[derive(Default)]
struct Pairs<'a>(Vec<(String, &'a RawValue)>);

impl<'de> Deserialize<'de> for Pairs<'de> {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_map(Self::default())
    }
}

impl<'de> Visitor<'de> for Pairs<'de> {
    type Value = Self;

    fn expecting(&self, text: &mut fmt::Formatter<'_>) -> fmt::Result {
        text.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut pairs: A) -> Result<Self, A::Error> {
        while let Some(pair) = pairs.next_entry()? {
            self.0.push(pair);
        }
        Ok(self)
    }
}

/// Whether a name denotes one axis, such as `x_mm`.
fn is_of_axis(name: &str) -> bool {
    let name = spelt(name);
    let mut words = name.split('_');
    words.any(|word| matches!(word, "x" | "y" | "z" | "u" | "v"))
}

const NEEDED: &str = "a list of objects is needed, or an object per line";

fn no_json(file: &RecordedFile, line: usize, error: &serde_json::Error) -> RecordedError {
    let line = line + error.line().saturating_sub(1);
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    let place = match error.column() {
        0 => String::new(),
        column => format!(" (character {column})"),
    };
    file.fail(
        line,
        format!("is no JSON object: {message}{place}; {NEEDED}"),
    )
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

/// A single JSON value as text; empty for `null`. `None` for a list or an object. Numbers are not converted, so they are
/// as precise as in the file.
fn plain(value: &RawValue) -> Option<Cow<'_, str>> {
    match value.get() {
        "null" => Some("".into()),
        text if text.starts_with(['[', '{']) => None,
        text if text.starts_with('"') => serde_json::from_str::<String>(text).ok().map(Cow::from),
        text => Some(text.into()),
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
