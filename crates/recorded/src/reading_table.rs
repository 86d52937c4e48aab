//! Reads the numbers of a table and converts them to palpate's units. Errors state the line and the column.

use std::collections::{BTreeMap, HashMap};
use std::f64::consts::PI;

use palpate_statistics::Number;
use palpate_study::config::LengthUnit;
use palpate_study::readings::{Column, ColumnUnit, Measure, check_names};
use palpate_study::{FieldError, Warning};

use super::decimal::{DecimalSign, is_missing, number};
use super::delimited_text::{has_number, tidy};
use super::error::RecordedError;
use super::header::{Header, Place};
use super::log_warnings::{LISTED_ROWS, listed};
use super::source::ReadingSource;
use super::table_format::{Decimal, Delimiter, pair};
use super::text_table::TextTable;

/// Largest number of rows of a table.
const MAX_ROWS: usize = 5_000_000;
/// Rows of time series, glides and presses are thinned out if there are more than this number.
const MAX_DENSE_ROWS: usize = 1 << 19;

/// Maximum size of all columns that palpate does not use, MiB.
const MAX_EXTRA_MIB: usize = 256;

pub(super) struct ReadingTable {
    pub(super) source: ReadingSource,
    /// Indices of the rows that follow a blank line.
    pub(super) after_gaps: Vec<usize>,
    /// Numbers of the requested columns, row by row.
    numbers: Vec<f64>,
    columns: usize,
    pub(super) unit: Option<LengthUnit>,
    pub(super) extras: ExtraColumns,
    /// Error about the first row that is left out because a number is missing. Callers that must not leave out rows,
    /// such as the calibration, return this error.
    pub(super) first_lost: Option<RecordedError>,
}

impl ReadingTable {
    /// Reads the columns `columns` of a table. The file may contain them in any order and among other columns. All
    /// these columns are required. If some are missing, the error also names the optional columns `may`. If the table
    /// has very many rows, some of them are left out. `is_spare` receives three successive rows, and states whether the
    /// second one may be left out.
    pub(super) fn read(
        table: &TextTable<'_>,
        columns: &[Column],
        may: &[Column],
        is_spare: impl Fn([&[f64]; 3]) -> bool,
    ) -> Result<Self, RecordedError> {
        let form = &table.file.form;
        let fail = |message| table.file.fail(table.header_line, message);
        let mut header = Header::new(&table.header, table.names());
        if header.places(columns, may).is_err() {
            let angles = header.angles(columns);
            table.each(|record| {
                let fields = angles.iter().filter_map(|&index| record.fields.get(index));
                let mut numbers = fields.filter_map(|field| field.trim().parse::<f64>().ok());
                header.is_in_degrees |= numbers.any(|number| number.abs() > PI);
                Ok(())
            })?;
        }
        let places = header.places(columns, may);
        let places = places.map_err(|message| fail(message + &table.header_hint(columns, may)))?;
        let unit = length_unit(&header, columns, &places, form.length_unit).map_err(fail)?;
        let factors: Vec<f64> = columns
            .iter()
            .zip(&places)
            .map(|(column, place)| factor(column, place, unit))
            .collect::<Option<_>>()
            .ok_or_else(|| fail("lengths cannot be converted".to_owned()))?;
        let decimal = match form.decimal {
            Some(decimal) => decimal,
            None => {
                let numbers = places.iter().zip(columns);
                let numbers = numbers.filter(|(_, column)| !is_label(column));
                let numbers: Vec<Place> = numbers.map(|(place, _)| *place).collect();
                decimal_of(table, &header, &numbers)?
            }
        };
        let is_other = |index: &usize| {
            let is_read = places.iter().any(|place| place.index == *index);
            !is_read && !table.header[*index].is_empty()
        };
        let others: Vec<usize> = (0..table.header.len()).filter(is_other).collect();
        let names = others.iter().map(|&index| table.header[index].clone());
        let mut all = Self {
            source: ReadingSource::new(&table.file.name, Vec::new()),
            after_gaps: Vec::new(),
            numbers: Vec::new(),
            columns: columns.len(),
            unit,
            extras: ExtraColumns::new(names.collect()),
            first_lost: None,
        };
        let mut labels = Labels::default();
        let (mut count, mut is_after_gap) = (0, false);
        let (mut stride, mut dense_rows) = (1, MAX_DENSE_ROWS);
        let (mut lost, mut left_out) = (Vec::new(), 0);
        table.each(|record| {
            let (found, expected) = (record.fields.len(), table.header.len());
            let row = count / table.fingers().unwrap_or(1);
            count += 1;
            if !record.has(expected) {
                let hint = match table.has(Delimiter::Comma) && found > expected {
                    true => "; if its commas are decimal signs, separate the fields by ; or tabs",
                    false => "",
                };
                let message = format!("{found} fields; the header has {expected}{hint}");
                return Err(table.file.fail(record.line, message));
            }
            is_after_gap |= record.is_after_gap || record.fields.iter().all(str::is_empty);
            let fail = |place: &Place, what: String| {
                let name = table.own_name(place.index, &record.fields[0]);
                let message = format!("column `{name}`: {what}");
                table.file.fail(record.line, message)
            };
            let is_lost = |(place, column): &(&Place, &Column)| {
                !is_label(column) && is_missing(tidy(&record.fields[place.index]))
            };
            if let Some((place, _)) = places.iter().zip(columns).find(is_lost) {
                let text = tidy(&record.fields[place.index]);
                all.first_lost
                    .get_or_insert_with(|| fail(place, format!("`{text}` is no number")));
                let of = |_| format!("`{}` in ", &record.fields[0]);
                let of = table.fingers().map_or_else(String::new, of);
                if lost.len() < LISTED_ROWS {
                    lost.push(format!("{of}row {}, line {}", row + 1, record.line));
                }
                left_out += 1;
                return Ok(());
            }
            for ((place, &factor), column) in places.iter().zip(&factors).zip(columns) {
                if is_label(column)
                    && let Some(place) = labels.place(tidy(&record.fields[place.index]), row)
                {
                    all.numbers.push(place);
                    continue;
                }
                let read = number(tidy(&record.fields[place.index]), decimal).and_then(|number| {
                    let converted = number * factor;
                    match converted.is_finite() {
                        true => Ok(converted),
                        false => Err(format!(
                            "must be finite, is {} times {factor}",
                            Number(number)
                        )),
                    }
                });
                all.numbers.push(read.map_err(|what| {
                    let hint = match row == 0 && !has_number(record.fields) {
                        true => "; write # before a line without numbers",
                        false => "",
                    };
                    fail(place, what + hint)
                })?);
            }
            let read = all.source.lines.len();
            if std::mem::take(&mut is_after_gap) && read > 0 {
                all.after_gaps.push(read);
            }
            all.source.lines.push(record.line);
            all.source.rows.push(row);
            all.extras
                .push(others.iter().map(|&index| tidy(&record.fields[index])));
            if read == dense_rows {
                all.thin(&mut stride, &is_spare);
                dense_rows = dense_rows.max(2 * all.source.lines.len());
            }
            match () {
                () if read >= MAX_ROWS => Err(table
                    .file
                    .error(format!("has more than {MAX_ROWS} rows that palpate needs"))),
                () if all.extras.bytes() > MAX_EXTRA_MIB << 20 => Err(table.file.error(format!(
                    "the columns that palpate does not use have more than {MAX_EXTRA_MIB} MiB"
                ))),
                () => Ok(()),
            }
        })?;
        let source = &mut all.source;
        let unread = header.unread(may, &places);
        // In a wide table (several fingers per row), omit the proposed setting `columns`, because it reads only one
        // finger.
        let notes = [table.note(), unread.filter(|_| table.fingers().is_none())];
        let notes = notes.into_iter().flatten();
        source
            .notes
            .extend(notes.map(|note| Warning::new("assumed-columns", note, [])));
        if source.lines.is_empty() {
            let empty = || source.fail("has a header, but no readings");
            return Err(all.first_lost.unwrap_or_else(empty));
        }
        if left_out > 0 {
            let listed = listed((0..left_out).map(|at: usize| lost[at].clone()));
            let left_out = left_out as f64;
            let text = format!(
                "{left_out} of {count} readings are left out, because numbers are missing: {listed}"
            );
            let numbers = [("without_numbers", left_out)];
            source.notes.push(Warning::new("left-out", text, numbers));
        }
        if stride > 1 {
            all.thin(&mut stride, &is_spare);
            let source = &mut all.source;
            let text = format!(
                "{} of {count} readings are used: of so many successive readings, one in {stride} is enough",
                source.lines.len()
            );
            source.notes.push(Warning::new("left-out", text, []));
        }
        Ok(all)
    }

    /// Removes spare rows until at most three quarters of [`MAX_DENSE_ROWS`] rows remain. About one spare row in
    /// `stride` remains; `stride` is doubled until few enough rows remain.
    fn thin(&mut self, stride: &mut usize, is_spare: impl Fn([&[f64]; 3]) -> bool) {
        while *stride < MAX_ROWS {
            let rows: Vec<&[f64]> = self.numbers.chunks_exact(self.columns).collect();
            if !rows
                .windows(3)
                .any(|near| is_spare([near[0], near[1], near[2]]))
            {
                return;
            }
            // Fractions of multiples of the golden ratio are evenly distributed, so the remaining rows contain all
            // fingers, even if the fingers take turns row by row.
            let is_sample =
                |row: usize| (row as u32).wrapping_mul(0x9e37_79b9) <= u32::MAX / *stride as u32;
            let is_start = |row| self.after_gaps.binary_search(&row).is_ok();
            let is_kept = |&row: &usize| {
                is_sample(self.source.rows[row])
                    || row == 0
                    || row + 1 == rows.len()
                    || is_start(row)
                    || is_start(row + 1)
                    || !is_spare([rows[row - 1], rows[row], rows[row + 1]])
            };
            let kept: Vec<usize> = (0..rows.len()).filter(is_kept).collect();
            self.keep(&kept);
            if 4 * kept.len() <= 3 * MAX_DENSE_ROWS {
                return;
            }
            *stride *= 2;
        }
    }

    fn keep(&mut self, kept: &[usize]) {
        let row = |&row: &usize| &self.numbers[row * self.columns..(row + 1) * self.columns];
        self.numbers = kept.iter().flat_map(row).copied().collect();
        let gaps = self.after_gaps.iter_mut();
        gaps.for_each(|gap| *gap = kept.partition_point(|row| row < gap));
        self.source = self.source.selected(kept);
        self.extras = self.extras.selected(kept);
    }

    /// Leaves out each row that equals the row before it and, if the rows have numbers of probes, copies of the whole
    /// table. Adds a warning.
    pub(super) fn leave_out_copies(&mut self, has_probes: bool) {
        let rows: Vec<&[f64]> = self.numbers.chunks_exact(self.columns).collect();
        // The first row of a roll stays, although it may equal the last row of the roll before.
        let starts = &self.after_gaps;
        let is_copied = |&count: &usize| {
            rows.len().is_multiple_of(count) && rows.iter().zip(&rows[count..]).all(|(a, b)| a == b)
        };
        let mut counts = (2..=rows.len() / 2).filter(|_| has_probes);
        let count = counts.find(is_copied).unwrap_or(rows.len());
        let is_new = |&row: &usize| {
            row == 0 || rows[row] != rows[row - 1] || starts.binary_search(&row).is_ok()
        };
        let kept: Vec<usize> = (0..count).filter(is_new).collect();
        let count = rows.len() - kept.len();
        if count == 0 {
            return;
        }
        self.keep(&kept);
        let text = format!(
            "{count} rows equal the row before them, or are in a copy of the whole table: copies count once"
        );
        let note = Warning::new("repeated-rows", text, []);
        self.source.notes.push(note);
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, &[f64])> {
        let rows = self.numbers.chunks_exact(self.columns);
        self.source.lines.iter().copied().zip(rows)
    }

    pub(super) fn fail(&self, line: usize, message: String) -> RecordedError {
        RecordedError::line(&self.source.name, line, message)
    }

    /// Converts the number of a probe or finger to an integer. Returns an error unless it is whole and at least 0.
    pub(super) fn index(
        &self,
        line: usize,
        column: &str,
        number: f64,
    ) -> Result<u64, RecordedError> {
        if number >= 0.0 && number.fract() == 0.0 && number < 1e15 {
            return Ok(number as u64);
        }
        let message = format!(
            "column `{column}`: must be a whole number from 0, is {}",
            Number(number)
        );
        Err(self.fail(line, message))
    }
}

/// Index of each name of a finger or probe, in the order in which the names first appear.
#[derive(Default)]
struct Labels(HashMap<String, usize>);

impl Labels {
    /// Index of the finger or probe with the name `text`. `None` if `text` is empty, or if the first row of the table
    /// is not labelled with a name but, for example, with a number.
    fn place(&mut self, text: &str, row: usize) -> Option<f64> {
        let is_word = !text.is_empty() && text.parse::<f64>().is_err();
        if self.0.is_empty() && !(row == 0 && is_word) {
            return None;
        }
        let next = self.0.len();
        let place = match self.0.get(text) {
            Some(&place) => place,
            None if text.is_empty() => return None,
            None => *self.0.entry(text.to_owned()).or_insert(next),
        };
        Some(place as f64)
    }
}

/// Header of a table. Returns an error if the setting `columns` assigns a name to a column that is not one of
/// `columns`.
pub(super) fn header<'a>(
    table: &'a TextTable<'_>,
    columns: &[Column],
) -> Result<Header<'a>, RecordedError> {
    let names = table.names();
    check_names(names, columns).map_err(|FieldError { message, .. }| {
        RecordedError::readings(&table.file.name, format!("setting `columns`: {message}"))
    })?;
    Ok(Header::new(&table.header, names))
}

fn length_unit(
    header: &Header<'_>,
    columns: &[Column],
    places: &[Place],
    option: Option<LengthUnit>,
) -> Result<Option<LengthUnit>, String> {
    let mut lengths: Vec<_> = columns.iter().zip(places).collect();
    lengths.retain(|(column, _)| column.measure == Measure::Length);
    let mut stated: Vec<ColumnUnit> = Vec::new();
    let mut bare: Option<(&Column, &Place)> = None;
    for (column, place) in lengths {
        match place.unit {
            Some(unit) if !stated.contains(&unit) => stated.push(unit),
            Some(_) => {}
            None => bare = bare.or(Some((column, place))),
        }
    }
    let Some(target) = option else {
        return match stated.as_slice() {
            [] => Ok(None),
            [unit] => {
                let nearest = nearest(*unit);
                let is_converted = nearest.map(ColumnUnit::Length) != Some(*unit);
                match bare.filter(|_| is_converted) {
                    Some(column) => Err(without_unit(header, column, *unit)),
                    None => Ok(nearest),
                }
            }
            [first, second, ..] => {
                let target = nearest(*first).unwrap_or_default().as_str();
                Err(format!(
                    "lengths are in {} and in {}; setting `length_unit` {target} converts them to one unit",
                    unit_name(*first),
                    unit_name(*second)
                ))
            }
        };
    };
    for unit in &stated {
        if unit.to(target).is_none() {
            let (unit, target) = (unit_name(*unit), target.as_str());
            return Err(format!(
                "the header says {unit}, setting `length_unit` says {target}, and neither is a multiple of the other"
            ));
        }
        if let Some(column) = bare.filter(|_| *unit != ColumnUnit::Length(target)) {
            return Err(without_unit(header, column, *unit));
        }
    }
    Ok(Some(target))
}

fn without_unit(header: &Header<'_>, column: (&Column, &Place), other: ColumnUnit) -> String {
    let (column, place) = column;
    let (stem, name, other) = (column.stem(), header.name(place.index), unit_name(other));
    let pair = pair(&format!("{stem}_{other}"), name);
    format!(
        "column `{name}` states no unit, but others are in {other}; write setting `columns` '{pair}' if it is in {other} too"
    )
}

fn factor(column: &Column, place: &Place, unit: Option<LengthUnit>) -> Option<f64> {
    match (place.unit, column.measure, unit) {
        (None, _, _) | (_, Measure::Length, None) => Some(1.0),
        (Some(own), _, unit) => own.to(unit.unwrap_or_default()),
    }
}

/// Whether a column contains names or numbers of fingers or probes.
fn is_label(column: &Column) -> bool {
    matches!(column.name, "finger" | "probe")
}

/// Detects the decimal sign of the numbers in a table. The sign is a point, unless a number contains a comma or, in a
/// table with semicolons, its point may separate thousands.
fn decimal_of(
    table: &TextTable<'_>,
    header: &Header<'_>,
    places: &[Place],
) -> Result<Decimal, RecordedError> {
    if !table.may_have_commas() {
        return Ok(Decimal::Point);
    }
    let mut odd: Option<(usize, usize, String)> = None;
    let mut sign = DecimalSign {
        has_semicolons: table.has(Delimiter::Semicolon),
        ..DecimalSign::default()
    };
    table.each(|record| {
        // Rows with a wrong number of fields are ignored here. Such rows are rejected later, when the numbers are read.
        let is_whole = record.has(table.header.len());
        for place in places.iter().filter(|_| is_whole) {
            let field = tidy(&record.fields[place.index]);
            if sign.add(field) && odd.is_none() {
                odd = Some((record.line, place.index, field.to_owned()));
            }
        }
        // Other columns may show the sign of a table with semicolons, too.
        let is_unknown = is_whole && sign.has_semicolons && sign.point.is_none();
        for field in record.fields.iter().map(tidy).filter(|_| is_unknown) {
            let is_number = |decimal| number(field, decimal).is_ok();
            if is_number(Decimal::Point) || is_number(Decimal::Comma) {
                sign.add(field);
            }
        }
        Ok(())
    })?;
    let Some((line, index, field)) = odd else {
        return Ok(Decimal::Point);
    };
    sign.decimal(&field).map_err(|what| {
        let name = header.name(index);
        table.file.fail(line, format!("column `{name}`: {what}"))
    })
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ExtraColumns {
    pub(super) names: Vec<String>,
    text: String,
    /// Byte position in `text` at which each field ends.
    ends: Vec<usize>,
}

impl ExtraColumns {
    pub(super) fn new(names: Vec<String>) -> Self {
        let (text, ends) = Default::default();
        Self { names, text, ends }
    }

    pub(super) fn push<'a>(&mut self, fields: impl Iterator<Item = &'a str>) {
        for field in fields {
            self.text.push_str(field);
            self.ends.push(self.text.len());
        }
    }

    pub(super) const fn bytes(&self) -> usize {
        self.text.len() + self.ends.len()
    }

    pub(super) fn selected(&self, rows: &[usize]) -> Self {
        let mut selected = Self::new(self.names.clone());
        for &row in rows {
            selected.push(self.row(row).iter().map(String::as_str));
        }
        selected
    }

    /// Fields of a row in the columns that palpate does not use; empty if palpate uses all columns.
    pub(super) fn row(&self, row: usize) -> Vec<String> {
        let first = row * self.names.len();
        let ends = self.ends.iter().skip(first).take(self.names.len());
        let before = first.checked_sub(1).map(|before| self.ends[before]);
        let mut start = before.unwrap_or_default();
        let field = |end: &usize| self.text[std::mem::replace(&mut start, *end)..*end].to_owned();
        ends.map(field).collect()
    }

    pub(super) fn named(&self, row: usize) -> BTreeMap<String, String> {
        self.names.iter().cloned().zip(self.row(row)).collect()
    }
}

/// Default length unit of the output for readings in this unit: the unit itself or, for inches and nanometres, a
/// unit that studies can use (millimetres and micrometres). `None` if this unit is not a length.
fn nearest(unit: ColumnUnit) -> Option<LengthUnit> {
    match unit {
        ColumnUnit::Length(length) => Some(length),
        ColumnUnit::Inch => Some(LengthUnit::Mm),
        ColumnUnit::Nanometre => Some(LengthUnit::Um),
        ColumnUnit::Factor(_) => None,
    }
}

/// Name of the unit in messages.
fn unit_name(unit: ColumnUnit) -> &'static str {
    match unit {
        ColumnUnit::Length(length) => length.as_str(),
        ColumnUnit::Inch => "in",
        ColumnUnit::Nanometre => "nm",
        ColumnUnit::Factor(_) => "another unit",
    }
}
