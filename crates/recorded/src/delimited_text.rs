//! Tables of fields that are separated by commas, semicolons or tabs.

use csv::{ReaderBuilder, StringRecord, Terminator};
use palpate_study::readings::Measure;

use super::error::RecordedError;
use super::header::bracketed;
use super::table_format::Delimiter;
use super::text_table::{Record, RowResult, Text};

/// Number of rows that decide the delimiter if the header does not.
const DECIDING_ROWS: usize = 100;

/// A table of separated fields.
pub(super) struct DelimitedText<'a> {
    pub(super) text: Text<'a>,
    pub(super) delimiter: Delimiter,
    /// Whether the row after the header has the units of the columns.
    has_units: bool,
}

impl<'a> DelimitedText<'a> {
    /// The table with its column names. `first` is the header with its line, `stated` the stated delimiter, and `fail`
    /// makes an error in a line.
    pub(super) fn of(
        text: Text<'a>,
        (first, header_line): (&str, usize),
        stated: Option<Delimiter>,
        fail: impl Fn(usize, String) -> RecordedError,
    ) -> Result<(Self, Vec<String>), RecordedError> {
        let found = || recognised(text, first, header_line);
        let delimiter = stated.map_or_else(found, Ok);
        let delimiter = delimiter.map_err(|message| fail(header_line, message))?;
        if let Some(line) = unclosed_quote(text, delimiter) {
            let message =
                "a quotation mark is not closed before the delimiter or the end of the line";
            return Err(fail(line, message.to_owned()));
        }
        let fields = split(text, first, delimiter);
        let mut header: Vec<String> = fields.iter().map(|name| tidy(name).to_owned()).collect();
        let row = text.rows_after(header_line).next();
        let units = row.and_then(|(row, _)| units(&split(text, row, delimiter), header.len()));
        for (name, unit) in header.iter_mut().zip(units.iter().flatten()) {
            match bracketed(name).1 {
                _ if unit.is_empty() => {}
                None => *name = format!("{name} [{unit}]"),
                Some(own) if own == unit => {}
                Some(_) => {
                    let message = format!("column `{name}` has the unit `{unit}` in the next line");
                    return Err(fail(header_line, message));
                }
            }
        }
        let has_units = units.is_some();
        let table = Self {
            text,
            delimiter,
            has_units,
        };
        Ok((table, header))
    }

    /// Calls `take` with every row that is not blank. No row spans lines, because open quotation marks are rejected
    /// before.
    pub(super) fn rows(&self, mut take: impl FnMut(Record<'_>) -> RowResult) -> RowResult {
        let text = self.text;
        let bytes = text.all.as_bytes();
        let is_end = |byte: &&u8| char::from(**byte) == text.end;
        let (mut at, mut line) = (0, text.line);
        let (mut heading, mut is_after_gap) = (1 + usize::from(self.has_units), false);
        let mut fields = StringRecord::new();
        let mut reader = reader(text, text.all, self.delimiter);
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
            let is_header = heading == 1 + usize::from(self.has_units);
            if fields.iter().all(|field| field.trim().is_empty())
                && (fields.len() == 1 || !is_header)
            {
                is_after_gap = true;
                continue;
            }
            if heading > 0 {
                heading -= 1;
            } else {
                take(Record {
                    line,
                    is_after_gap,
                    fields: &fields,
                })?;
            }
            is_after_gap = false;
        }
        Ok(())
    }
}

fn reader<'t>(text: Text<'_>, part: &'t str, delimiter: Delimiter) -> csv::Reader<&'t [u8]> {
    ReaderBuilder::new()
        .delimiter(delimiter.byte())
        .terminator(Terminator::Any(text.end as u8))
        .has_headers(false)
        .flexible(true)
        .from_reader(part.as_bytes())
}

/// Fields of one line.
fn split(text: Text<'_>, line: &str, delimiter: Delimiter) -> StringRecord {
    let mut records = reader(text, line, delimiter).into_records();
    records.next().and_then(Result::ok).unwrap_or_default()
}

/// Fields of a text, separated by commas. A field that contains a comma is in quotation marks.
pub(super) fn fields(text: &str) -> Result<Vec<String>, csv::Error> {
    let mut fields = Vec::new();
    for record in reader(Text::of(text), text, Delimiter::Comma).records() {
        fields.extend(record?.iter().map(str::to_owned));
    }
    Ok(fields)
}

/// A field without spaces and quotation marks around it.
pub(super) fn tidy(field: &str) -> &str {
    let field = field.trim();
    let unquoted = field
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'));
    unquoted.unwrap_or(field)
}

/// Delimiter, recognised from header and rows. A table without a delimiter has one column.
fn recognised(text: Text<'_>, header: &str, header_line: usize) -> Result<Delimiter, String> {
    let fields = |line: &str, delimiter| split(text, line, delimiter).len();
    let rows = || text.rows_after(header_line).map(|(row, _)| row);
    let mut possible = Delimiter::ALL.to_vec();
    possible.retain(|&delimiter| fields(header, delimiter) > 1);
    if possible.is_empty() && has_spaces(header, rows().next().unwrap_or_default()) {
        return Err("fields are separated by spaces; separate them by commas".to_owned());
    }
    if possible.len() > 1 {
        let fits = |&delimiter: &Delimiter| {
            let expected = fields(header, delimiter);
            let mut rows = rows().take(DECIDING_ROWS);
            rows.all(|row| fields(row, delimiter) == expected)
        };
        let fitting: Vec<Delimiter> = possible.iter().copied().filter(fits).collect();
        if rows().next().is_some() && fitting.len() > 1 {
            let names: Vec<&str> = fitting.iter().map(|delimiter| delimiter.name()).collect();
            return Err(format!(
                "fields may be separated by {}; say which: setting `delimiter` {}",
                names.join(" or "),
                names[0]
            ));
        }
        if !fitting.is_empty() {
            possible = fitting;
        }
    }
    Ok(possible.first().copied().unwrap_or(Delimiter::Comma))
}

/// Whether spaces separate the fields of the header and the numbers of the first row.
fn has_spaces(header: &str, row: &str) -> bool {
    let count = header.split_whitespace().count();
    let mut numbers = row.split_whitespace();
    count > 1
        && row.split_whitespace().count() == count
        && numbers.all(|one| one.parse::<f64>().is_ok())
}

/// Units from the row after the header, without brackets, if that row has only units.
fn units(row: &StringRecord, columns: usize) -> Option<Vec<String>> {
    const MEASURES: [Measure; 6] = [
        Measure::Length,
        Measure::Angle,
        Measure::Time,
        Measure::Turn,
        Measure::Pixel,
        Measure::Force,
    ];
    let bare = |field: &str| {
        let field = tidy(field);
        let within = [('[', ']'), ('(', ')')]
            .into_iter()
            .find_map(|(open, close)| field.strip_prefix(open)?.strip_suffix(close));
        within.unwrap_or(field).trim().to_owned()
    };
    let mut units: Vec<String> = row.iter().map(bare).collect();
    let is_unit = |text: &String| MEASURES.iter().any(|one| one.unit(text).is_some());
    // Columns that are not used may have any unit, such as N.
    let is_word = |text: &String| text.len() <= 6 && text.parse::<f64>().is_err();
    let is_row = units.len() == columns && units.iter().any(is_unit) && units.iter().all(is_word);
    for unit in units.iter_mut().filter(|unit| *unit == "-") {
        unit.clear();
    }
    is_row.then_some(units)
}

/// First line, from 1, with a quotation mark that is not one of a pair around a field.
fn unclosed_quote(text: Text<'_>, delimiter: Delimiter) -> Option<usize> {
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
    let (delimiter, end) = (char::from(delimiter.byte()), text.end);
    let (mut at, mut line) = (At::Start, text.line);
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
