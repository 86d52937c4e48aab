//! Tables of fields that are separated by commas, semicolons, tabs or spaces.

use csv::{ReaderBuilder, StringRecord, Terminator};
use palpate_study::readings::spelt;

use super::error::RecordedError;
use super::file::RecordedFile;
use super::heading::{bracketed, has_unit};
use super::table_format::Delimiter;
use super::text_table::{Record, RowResult, Text, comment};

/// Largest number of rows that are examined to find the delimiter, if the header does not determine the delimiter.
const DECIDING_ROWS: usize = 100;

/// A table in which a delimiter separates the fields of a line, such as a CSV file.
pub(super) struct DelimitedText<'a> {
    pub(super) text: Text<'a>,
    pub(super) delimiter: Delimiter,
    /// Number of lines before the readings: the line with the names of the columns and, if present, a line with units.
    pub(super) heading: usize,
    columns: usize,
    /// For each field of a row, the number of elements if the field contains a list, such as `[1, 2]`, and otherwise 0.
    /// Empty if no field contains a list.
    lists: Vec<usize>,
}

impl<'a> DelimitedText<'a> {
    /// Returns the table and the names of its columns. If the first line contains numbers instead of names, the names
    /// are 0, 1, 2 and so on. `first` is the text of the first line, followed by its line number. `stated` is the
    /// delimiter that the user stated. `fail` makes an error from a line number and a message.
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
            let message = "a quotation mark is not closed before the end of its field";
            return Err(fail(line, message.to_owned()));
        }
        let table = |heading, columns| Self {
            text,
            delimiter,
            heading,
            columns,
            lists: Vec::new(),
        };
        let fields = split(text, first, delimiter);
        let mut rows = text.rows_after(header_line);
        let mut rows = std::iter::from_fn(|| Some(split(text, rows.next()?.0, delimiter)));
        let mut next = rows.next();
        let is_split = delimiter != Delimiter::Comma || stated.is_some() || first.contains(',');
        if is_split && has_numbers(&fields, next.as_ref()) {
            let header = (0..fields.len()).map(|place| place.to_string());
            return Ok((table(0, fields.len()), header.collect()));
        }
        let mut header = names(text, first, delimiter);
        let mut heading = 1;
        if let Some(row) = next.take_if(|row| has_axes(row, &fields)) {
            header = grouped(&header, &row);
            heading += 1;
            next = rows.next();
        }
        let is_copy = |row: &StringRecord| row.iter().map(tidy).take(header.len()).eq(&header);
        let next = next.filter(|row| !is_copy(row));
        let units = next.and_then(|row| units(&row, header.len()));
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
        heading += usize::from(units.is_some());
        let data = text.rows_after(header_line).skip(heading - 1);
        let data = data.take(DECIDING_ROWS);
        let data: Vec<_> = data.map(|(row, _)| split(text, row, delimiter)).collect();
        // `write.table` of R numbers the rows, but it writes no name for the column of these numbers.
        let counts = |(row, number): (&StringRecord, usize)| {
            let is_longer = row.len() == header.len() + 1 && !row[header.len()].is_empty();
            is_longer && tidy(&row[0]).parse() == Ok(number)
        };
        if data.len() > 2 && (0..2).any(|start| data.iter().zip(start..).all(counts)) {
            header.insert(0, String::new());
        }
        let mut table = table(heading, 0);
        if let Some(row) = data.first().filter(|row| row.len() == header.len()) {
            let count = |field: &str| items(field).map_or(0, Iterator::count);
            table.lists = row.iter().map(count).collect();
        }
        if table.lists.iter().any(|&count| count > 0) {
            let names = header.iter().zip(&table.lists);
            let names = names.flat_map(|(name, &count)| match count {
                0 => vec![name.clone()],
                _ => (0..count).map(|item| format!("{name}.{item}")).collect(),
            });
            header = names.collect();
        } else {
            table.lists.clear();
        }
        table.columns = header.len();
        Ok((table, header))
    }

    /// Calls `take` for every row that is not blank, no comment and no copy of the header, as in files that were joined.
    /// A row of the right length that contains numbers is no comment. Each row is one line, because the table was
    /// rejected earlier if a quoted field continues in the next line.
    pub(super) fn rows(
        &self,
        file: &RecordedFile,
        mut take: impl FnMut(Record<'_>) -> RowResult,
    ) -> RowResult {
        let (mut fields, mut before) = (StringRecord::new(), None);
        let mut rows = self.text.rows_after(0);
        let heading = rows.by_ref().take(self.heading);
        let heading: Vec<&str> = heading.map(|(row, _)| row.trim()).collect();
        let mut read = |row: &str, line: usize| {
            if heading.contains(&row.trim()) {
                return Ok(());
            }
            match row.trim_end_matches('\r') {
                row if self.delimiter == Delimiter::Space || row.contains('"') => {
                    fields = split(self.text, row, self.delimiter);
                }
                row => {
                    fields.clear();
                    let parts = row.split(char::from(self.delimiter.byte()));
                    parts.for_each(|part| fields.push_field(part));
                }
            }
            if !self.lists.is_empty() {
                fields = self.expanded(&fields);
            }
            if comment(row).is_some() && (fields.len() != self.columns || !has_number(&fields)) {
                return Ok(());
            }
            let is_after_gap = before.is_some_and(|before| line > before + 1);
            before = Some(line);
            take(Record {
                line,
                is_after_gap,
                fields: &fields,
            })
        };
        rows.try_for_each(|(row, line)| read(row, line))?;
        let line = self.text.line + self.text.lines().count();
        file.rest((line, self.text.end), |row, line| {
            match row.trim().is_empty() {
                true => Ok(()),
                false => read(row, line),
            }
        })
    }

    /// The fields of a row, in which each element of a list is a separate field.
    fn expanded(&self, fields: &StringRecord) -> StringRecord {
        let counts = self.lists.iter().copied().chain(std::iter::repeat(0));
        let parts = fields.iter().zip(counts).flat_map(|(field, count)| {
            let items = items(field).filter(|_| count > 0);
            items.map_or_else(|| vec![field; count.max(1)], Iterator::collect)
        });
        parts.collect()
    }
}

/// Elements of a list of numbers in a field, such as `[1, 2]`; `None` if the field contains no list.
fn items(field: &str) -> Option<impl Iterator<Item = &str>> {
    let field = tidy(field).trim_start_matches('p');
    let within = [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| field.strip_prefix(open)?.strip_suffix(close))?;
    let items = || {
        let parts = within.split([',', ';', ' ']);
        parts.filter(|part| !part.is_empty())
    };
    let are_numbers = items().all(|item| item.parse::<f64>().is_ok());
    (are_numbers && items().nth(1).is_some()).then(items)
}

/// Whether the first line of a table contains numbers instead of names. The whole numbers 0, 1, 2, … count as names,
/// because pandas uses them as column names if an array has none. A line that also contains text counts as numbers only
/// if at least one number has a decimal point, and if the row `next` has numbers in the same columns.
fn has_numbers(fields: &StringRecord, next: Option<&StringRecord>) -> bool {
    let is_number = |field: &str| tidy(field).parse::<f64>().is_ok();
    let is_same = |next: &StringRecord| next.iter().map(is_number).eq(fields.iter().map(is_number));
    let has_point = fields
        .iter()
        .any(|field| field.contains('.') && is_number(field));
    let is_data = fields.iter().all(is_number) || (has_point && next.is_some_and(is_same));
    let counts = |(field, column): (&str, usize)| tidy(field).parse() == Ok(column);
    is_data && !fields.iter().zip(0..).all(counts)
}

/// Names of the columns in a header line. In files that NumPy wrote, commas may separate the names although spaces
/// separate the numbers below.
pub(super) fn names(text: Text<'_>, line: &str, delimiter: Delimiter) -> Vec<String> {
    let fields = match delimiter {
        Delimiter::Space if line.contains(',') => split(text, line, Delimiter::Comma),
        delimiter => split(text, line, delimiter),
    };
    fields.iter().map(|name| tidy(name).to_owned()).collect()
}

pub(super) fn has_number(fields: &StringRecord) -> bool {
    let mut fields = fields.iter();
    fields.any(|field| tidy(field).replacen(',', ".", 1).parse::<f64>().is_ok())
}

fn reader<'t>(text: Text<'_>, part: &'t str, delimiter: Delimiter) -> csv::Reader<&'t [u8]> {
    ReaderBuilder::new()
        .delimiter(delimiter.byte())
        .terminator(Terminator::Any(text.end as u8))
        .has_headers(false)
        .flexible(true)
        .from_reader(part.as_bytes())
}

fn split(text: Text<'_>, line: &str, delimiter: Delimiter) -> StringRecord {
    if delimiter == Delimiter::Space {
        return line.split_whitespace().collect();
    }
    let mut records = reader(text, line, delimiter).into_records();
    records.next().and_then(Result::ok).unwrap_or_default()
}

/// Splits a text at its commas into fields. A field that contains a comma must be in quotation marks.
pub(super) fn fields(text: &str) -> Result<Vec<String>, csv::Error> {
    let mut fields = Vec::new();
    for record in reader(Text::of(text), text, Delimiter::Comma).records() {
        fields.extend(record?.iter().map(str::to_owned));
    }
    Ok(fields)
}

pub(super) fn tidy(field: &str) -> &str {
    let field = field.trim();
    let unquoted = field
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'));
    unquoted.unwrap_or(field)
}

/// Finds the delimiter from the header and the rows. For a table with a single column, which needs no delimiter, the
/// result is the comma.
fn recognised(text: Text<'_>, header: &str, header_line: usize) -> Result<Delimiter, String> {
    let fields = |line: &str, delimiter| split(text, line, delimiter).len();
    let rows = || text.rows_after(header_line).map(|(row, _)| row);
    let mut possible = Delimiter::ALL.to_vec();
    possible.retain(|&delimiter| delimiter != Delimiter::Space && fields(header, delimiter) > 1);
    let has_spaces = |row| has_spaces(names(text, header, Delimiter::Space).len(), row);
    if rows().next().is_some_and(has_spaces) {
        return Ok(Delimiter::Space);
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

/// Whether the row `row` consists of `names` numbers that are separated by spaces; `names` is the number of names in
/// the header.
fn has_spaces(names: usize, row: &str) -> bool {
    let mut numbers = row.split_whitespace();
    // `write.table` of R writes the name of the row before the numbers.
    let has_count = (names..names + 2).contains(&row.split_whitespace().count());
    let is_spaced = !row.contains('\t') && names > 1 && has_count;
    // In a row whose numbers are separated by spaces, a comma inside a number is a decimal comma.
    let is_number =
        |one: &str| !one.ends_with(',') && tidy(one).replacen(',', ".", 1).parse::<f64>().is_ok();
    is_spaced && numbers.all(is_number)
}

/// Units of the columns, without brackets, from the row after the header; `None` if that row does not consist of units.
fn units(row: &StringRecord, columns: usize) -> Option<Vec<String>> {
    let bare = |field: &str| {
        let field = tidy(field);
        let within = [('[', ']'), ('(', ')')]
            .into_iter()
            .find_map(|(open, close)| field.strip_prefix(open)?.strip_suffix(close));
        within.unwrap_or(field).trim().to_owned()
    };
    let mut units: Vec<String> = row.iter().map(bare).collect();
    let is_unit = |text: &String| has_unit(text);
    // Columns that palpate does not use may have units of other quantities, such as N.
    let is_word = |text: &String| text.len() <= 6 && text.parse::<f64>().is_err();
    let is_row = units.len() == columns && units.iter().any(is_unit) && units.iter().all(is_word);
    for unit in units.iter_mut().filter(|unit| *unit == "-") {
        unit.clear();
    }
    is_row.then_some(units)
}

/// Whether the row after the first line `first` of a table names axes, such as x, y and z. The first line then contains
/// the names of groups of columns, as in files of pandas and of motion capture systems.
fn has_axes(row: &StringRecord, first: &StringRecord) -> bool {
    let is_axis = |field: &str| matches!(&*spelt(bracketed(tidy(field)).0), "x" | "y" | "z");
    // A single name is the title of the file.
    let has_groups = first.iter().filter(|name| !name.is_empty()).count() > 1;
    let is_other = has_groups && row.len() == first.len() && row != first;
    is_other && row.iter().any(is_axis) && !has_number(row)
}

/// Names of columns from a line with the names of groups and a line with the names within the groups. The name of a
/// group may be written only above its first column.
fn grouped(groups: &[String], names: &StringRecord) -> Vec<String> {
    let mut group = "";
    let mut header = Vec::new();
    for (own, name) in groups.iter().zip(names) {
        group = if own.is_empty() { group } else { own };
        let (base, unit) = bracketed(group);
        let unit = unit.map_or(String::new(), |unit| format!(" [{unit}]"));
        header.push(match (group, tidy(name)) {
            ("", name) => name.to_owned(),
            (group, "") => group.to_owned(),
            (_, name) => format!("{}_{name}{unit}", base.trim()),
        });
    }
    header
}

/// Number of the first line with an odd number of quotation marks; `None` if there is none.
fn unclosed_quote(text: Text<'_>, delimiter: Delimiter) -> Option<usize> {
    let is_open = |(row, _): &(&str, usize)| row.matches('"').count() % 2 == 1;
    let mut rows = text.rows_after(0);
    let is_quoted = text.all.contains('"') && delimiter != Delimiter::Space;
    is_quoted.then(|| rows.find(is_open).map(|(_, line)| line))?
}
