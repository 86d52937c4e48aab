//! Rows of a text: CSV with any of the usual delimiters, or a JSON object per line.

use std::collections::HashMap;

use csv::{ReaderBuilder, StringRecord, Terminator};
use serde_json::Value as Json;

use super::error::RecordedError;
use super::file::RecordedFile;
use super::header::bracketed;
use super::table_format::Delimiter;
use palpate_study::readings::Measure;

/// Maximum number of lines of a table.
const MOST_LINES: usize = 5_000_000;
/// Maximum number of columns of a JSON table, whose rows may lack some of them.
const MOST_KEYS: usize = 1_000;
/// Number of rows that decide the delimiter if the header does not.
const ROWS_THAT_TELL: usize = 100;

/// A row of fields.
pub(super) struct Record<'a> {
    /// Line, from 1.
    pub(super) line: usize,
    /// Whether a blank line precedes the row.
    pub(super) is_after_gap: bool,
    pub(super) fields: &'a StringRecord,
}

/// A table as text, with its header.
pub(super) struct TextTable<'a> {
    pub(super) file: &'a RecordedFile,
    text: Text<'a>,
    /// Character between fields; `None` for JSON.
    delimiter: Option<Delimiter>,
    /// Names of the columns.
    pub(super) header: Vec<String>,
    /// Line of the header.
    pub(super) header_line: usize,
    /// Whether the row after the header has the units of the columns.
    has_units: bool,
}

type Taken = Result<(), RecordedError>;

/// A text and its line terminator.
#[derive(Clone, Copy)]
struct Text<'a> {
    all: &'a str,
    end: char,
    /// Line of the file where the text begins, from 1.
    line: usize,
}

impl<'a> Text<'a> {
    /// A text whose lines end with line feeds or, if it has none, with carriage returns.
    fn of(all: &'a str) -> Self {
        let end = if all.contains('\n') { '\n' } else { '\r' };
        Self { all, end, line: 1 }
    }

    /// The text from its header on, and the delimiter from a line `sep=` that Excel writes before it. Lines that
    /// begin with # are comments; but if numbers follow, the last of them is the header, as NumPy writes it.
    fn begun(self) -> (Self, Option<Delimiter>) {
        let (mut start, mut line) = (0, 1);
        let (mut comment, mut stated) = (None, None);
        for one in self.lines() {
            let text = one.trim();
            let sign = text.strip_prefix("sep=");
            let delimiter =
                sign.and_then(|sign| Delimiter::ALL.into_iter().find(|one| one.sign() == sign));
            if let Some(named) = text.strip_prefix('#') {
                let at = start + one.find('#').unwrap_or_default() + 1;
                comment = (!named.trim().is_empty()).then_some((at, line));
            } else if delimiter.is_some() && stated.is_none() {
                stated = delimiter;
            } else if !text.is_empty() {
                let is_number = |field: &str| field.trim().parse::<f64>().is_ok();
                let has_numbers = text
                    .split(|letter: char| matches!(letter, ',' | ';') || letter.is_whitespace())
                    .filter(|field| !field.is_empty())
                    .all(is_number);
                let (start, line) = comment.filter(|_| has_numbers).unwrap_or((start, line));
                let all = &self.all[start..];
                return (Self { all, line, ..self }, stated);
            }
            start += one.len() + self.end.len_utf8();
            line += 1;
        }
        (self, stated)
    }

    fn lines(self) -> impl Iterator<Item = &'a str> {
        self.all.split_terminator(self.end)
    }

    fn reader(self, text: &str, delimiter: Delimiter) -> csv::Reader<&[u8]> {
        ReaderBuilder::new()
            .delimiter(delimiter.byte())
            .terminator(Terminator::Any(self.end as u8))
            .has_headers(false)
            .flexible(true)
            .from_reader(text.as_bytes())
    }

    /// Fields of one line.
    fn split(self, line: &str, delimiter: Delimiter) -> StringRecord {
        let mut records = self.reader(line, delimiter).into_records();
        records.next().and_then(Result::ok).unwrap_or_default()
    }
}

/// Fields of a text, separated by commas. A field that contains a comma is in quotation marks.
pub(super) fn fields(text: &str) -> Result<Vec<String>, csv::Error> {
    let mut fields = Vec::new();
    for record in Text::of(text).reader(text, Delimiter::Comma).records() {
        fields.extend(record?.iter().map(str::to_owned));
    }
    Ok(fields)
}

impl<'a> TextTable<'a> {
    /// Reads the header of a file's text.
    pub(super) fn of(file: &'a RecordedFile, text: &'a str) -> Result<Self, RecordedError> {
        let text = Text::of(text);
        let lines = text.lines().count();
        if lines > MOST_LINES {
            return Err(file.error(format!("has {lines} lines; at most {MOST_LINES} are read")));
        }
        let (text, stated) = text.begun();
        let mut numbered = text.lines().zip(text.line..);
        let first = numbered.find(|(line, _)| !line.trim().is_empty());
        let (first, header_line) = first.unwrap_or(("", 1));
        let is_json = first.trim_start().starts_with(['{', '[']);
        let (delimiter, mut header) = match is_json {
            true => (None, keys(file, header_line, first)?),
            false => {
                let delimiter = file.form.delimiter.or(stated);
                let delimiter =
                    delimiter.map_or_else(|| found(file, text, first, header_line), Ok)?;
                if let Some(line) = unclosed(text, delimiter) {
                    let message =
                        "a quotation mark is not closed before the comma or the end of the line";
                    return Err(file.fail(line, message));
                }
                let fields = text.split(first, delimiter);
                (
                    Some(delimiter),
                    fields.iter().map(|name| tidy(name).to_owned()).collect(),
                )
            }
        };
        let units = delimiter.and_then(|delimiter| {
            let mut rows = text.lines().skip(header_line + 1 - text.line);
            let row = rows.find(|row| !row.trim().is_empty())?;
            units(&text.split(row, delimiter), header.len())
        });
        for (name, unit) in header.iter_mut().zip(units.iter().flatten()) {
            match bracketed(name).1 {
                _ if unit.is_empty() => {}
                None => *name = format!("{name} [{unit}]"),
                Some(own) if own == unit => {}
                Some(_) => {
                    let message = format!("column `{name}` has the unit `{unit}` in the next line");
                    return Err(file.fail(header_line, message));
                }
            }
        }
        Ok(Self {
            file,
            text,
            delimiter,
            header,
            header_line,
            has_units: units.is_some(),
        })
    }

    /// Whether the columns are separated by commas.
    pub(super) fn has_commas(&self) -> bool {
        self.delimiter == Some(Delimiter::Comma)
    }

    /// Whether there may be fields with a comma.
    pub(super) fn may_have_commas(&self) -> bool {
        let sign = if self.has_commas() { '"' } else { ',' };
        self.text.all.contains(sign)
    }

    /// Calls `take` with every row until it fails.
    pub(super) fn each(&self, mut take: impl FnMut(Record<'_>) -> Taken) -> Taken {
        match self.delimiter {
            Some(delimiter) => {
                let mut heading = 1 + usize::from(self.has_units);
                delimited(self.text, delimiter, |record| {
                    if heading > 0 {
                        heading -= 1;
                        return Ok(());
                    }
                    take(record)
                })
            }
            None => self.objects(take),
        }
    }

    fn objects(&self, mut take: impl FnMut(Record<'_>) -> Taken) -> Taken {
        let mut is_after_gap = false;
        for (text, line) in self.text.lines().zip(self.text.line..) {
            if text.trim().is_empty() {
                is_after_gap = line > self.header_line;
                continue;
            }
            let pairs = pairs(self.file, line, text)?;
            let values: HashMap<&str, &str> = pairs
                .iter()
                .map(|(key, value)| (key.as_str(), value.as_str()))
                .collect();
            let of_key = |name: &String| values.get(name.as_str()).copied().unwrap_or("");
            let fields: StringRecord = self.header.iter().map(of_key).collect();
            take(Record {
                line,
                is_after_gap,
                fields: &fields,
            })?;
            is_after_gap = false;
        }
        Ok(())
    }
}

/// A field without spaces and quotation marks around it.
pub(super) fn tidy(field: &str) -> &str {
    let field = field.trim();
    let unquoted = field
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'));
    unquoted.unwrap_or(field)
}

/// Calls `take` with every row that is not blank, the header first. No row spans lines, because open quotation marks
/// are refused before.
fn delimited(
    text: Text<'_>,
    delimiter: Delimiter,
    mut take: impl FnMut(Record<'_>) -> Taken,
) -> Taken {
    let bytes = text.all.as_bytes();
    let is_end = |byte: &&u8| char::from(**byte) == text.end;
    let (mut at, mut line) = (0, text.line);
    let (mut is_first, mut is_after_gap) = (true, false);
    let mut fields = StringRecord::new();
    let mut reader = text.reader(text.all, delimiter);
    // The text is UTF-8 and rows may have any length, so that no row is an error.
    while let Ok(true) = reader.read_record(&mut fields) {
        let start = fields
            .position()
            .map_or(at, |position| position.byte() as usize);
        let begin = start + bytes[start..].iter().take_while(is_end).count();
        let lines = bytes[at..begin].iter().filter(is_end).count();
        line += lines;
        is_after_gap |= lines > 1;
        at = begin;
        let is_blank = match is_first {
            true => fields.iter().all(|field| field.trim().is_empty()) && fields.len() == 1,
            false => fields.iter().all(|field| field.trim().is_empty()),
        };
        if is_blank {
            is_after_gap = true;
            continue;
        }
        take(Record {
            line,
            is_after_gap: is_after_gap && !is_first,
            fields: &fields,
        })?;
        is_first = false;
        is_after_gap = false;
    }
    Ok(())
}

/// Delimiter, recognised from header and rows.
fn found(
    file: &RecordedFile,
    text: Text<'_>,
    header: &str,
    header_line: usize,
) -> Result<Delimiter, RecordedError> {
    let fields = |line: &str, delimiter| text.split(line, delimiter).len();
    let mut possible: Vec<Delimiter> = Delimiter::ALL
        .into_iter()
        .filter(|&delimiter| fields(header, delimiter) > 1)
        .collect();
    if possible.is_empty() {
        return spaced(file, text, header, header_line);
    }
    if possible.len() > 1 {
        let rows = || {
            let rows = text.lines().skip(header_line + 1 - text.line);
            rows.filter(|row| !row.trim().is_empty())
                .take(ROWS_THAT_TELL)
        };
        let fits = |&delimiter: &Delimiter| {
            let expected = fields(header, delimiter);
            rows().all(|row| fields(row, delimiter) == expected)
        };
        let fitting: Vec<Delimiter> = possible.iter().copied().filter(fits).collect();
        if rows().next().is_some() && fitting.len() > 1 {
            let names: Vec<&str> = fitting.iter().map(|delimiter| delimiter.name()).collect();
            return Err(file.fail(
                header_line,
                format!(
                    "fields may be separated by {}; say which: setting `delimiter` {}",
                    names.join(" or "),
                    names[0]
                ),
            ));
        }
        if !fitting.is_empty() {
            possible = fitting;
        }
    }
    Ok(possible.first().copied().unwrap_or(Delimiter::Comma))
}

/// Refuses a table with fields separated by spaces. Any other table without a delimiter has one column.
fn spaced(
    file: &RecordedFile,
    text: Text<'_>,
    header: &str,
    header_line: usize,
) -> Result<Delimiter, RecordedError> {
    let count = header.split_whitespace().count();
    let mut rows = text.lines().skip(header_line + 1 - text.line);
    let row = rows.find(|row| !row.trim().is_empty()).unwrap_or_default();
    let has_as_many = row.split_whitespace().count() == count;
    let has_numbers = row.split_whitespace().all(|one| one.parse::<f64>().is_ok());
    match count > 1 && has_as_many && has_numbers {
        false => Ok(Delimiter::Comma),
        true => {
            let message = "fields are separated by spaces; separate them by commas";
            Err(file.fail(header_line, message))
        }
    }
}

/// Units from the row after the header, without brackets, if that row has only units.
fn units(row: &StringRecord, columns: usize) -> Option<Vec<String>> {
    const MEASURES: [Measure; 5] = [
        Measure::Length,
        Measure::Angle,
        Measure::Time,
        Measure::Turn,
        Measure::Pixel,
    ];
    let bare = |field: &str| {
        let field = tidy(field);
        let within = [('[', ']'), ('(', ')')]
            .into_iter()
            .find_map(|(open, close)| field.strip_prefix(open)?.strip_suffix(close));
        within.unwrap_or(field).trim().to_owned()
    };
    let units: Vec<String> = row.iter().map(bare).collect();
    let is_unit = |text: &String| MEASURES.iter().any(|one| one.unit(text).is_some());
    // Columns that are not used may have any unit, such as N.
    let is_word = |text: &String| text.len() <= 6 && text.parse::<f64>().is_err();
    let has_unit = units.iter().any(is_unit);
    let is_row = units.len() == columns && has_unit && units.iter().all(is_word);
    is_row.then(|| {
        let known = |text: String| match text.as_str() {
            "-" | "1" => String::new(),
            _ => text,
        };
        units.into_iter().map(known).collect()
    })
}

/// First line, from 1, with a quotation mark that is not one of a pair around a field.
fn unclosed(text: Text<'_>, delimiter: Delimiter) -> Option<usize> {
    #[derive(PartialEq)]
    enum At {
        Start,
        Bare,
        Quoted,
        Closed,
    }
    if !text.all.contains('"') {
        return None;
    }
    let delimiter = char::from(delimiter.byte());
    let (mut at, mut line) = (At::Start, text.line);
    let end = text.end;
    let mut letters = text.all.chars().peekable();
    while let Some(letter) = letters.next() {
        at = match (at, letter) {
            (At::Quoted, letter) if letter == end => return Some(line),
            (_, letter) if letter == end => At::Start,
            (At::Quoted, '"') if letters.peek() == Some(&'"') => {
                letters.next();
                At::Quoted
            }
            (At::Quoted, '"') => At::Closed,
            (At::Quoted, _) => At::Quoted,
            (_, letter) if letter == delimiter => At::Start,
            (At::Start, '"') => At::Quoted,
            (At::Start, ' ' | '\r') => At::Start,
            (At::Closed, ' ' | '\r') => At::Closed,
            (At::Closed, _) | (_, '"') => return Some(line),
            _ => At::Bare,
        };
        line += usize::from(letter == end);
    }
    (at == At::Quoted).then_some(line)
}

/// Column names from the first line of JSON, in their order.
fn keys(file: &RecordedFile, line: usize, text: &str) -> Result<Vec<String>, RecordedError> {
    let keys: Vec<String> = pairs(file, line, text)?
        .into_iter()
        .map(|(key, _)| key)
        .collect();
    match keys.len() {
        0 => Err(file.fail(line, "the first object has no keys")),
        1..=MOST_KEYS => Ok(keys),
        many => Err(file.fail(
            line,
            format!("has {many} columns; at most {MOST_KEYS} are read"),
        )),
    }
}

/// Names and values of an object; nested names are joined by points: `position.0`.
fn pairs(
    file: &RecordedFile,
    line: usize,
    text: &str,
) -> Result<Vec<(String, String)>, RecordedError> {
    let value: Json = serde_json::from_str(text).map_err(|error| {
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        let column = error.column();
        file.fail(
            line,
            format!("is no JSON object of one line: {message} (character {column}); an object per line is needed, as `jq -c '.[]'` writes of a list"),
        )
    })?;
    if !value.is_object() {
        let message =
            "is no JSON object; an object per line is needed, as `jq -c '.[]'` writes of a list";
        return Err(file.fail(line, message));
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
