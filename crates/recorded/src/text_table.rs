//! Reads tables of any file format as rows of text fields.

use std::collections::BTreeMap;

use csv::StringRecord;
use palpate_study::readings::{COLUMNS, Column, Measure, of_key};

use super::delimited_text::{DelimitedText, names, tidy};
use super::error::RecordedError;
use super::file::RecordedFile;
use super::header::Header;
use super::heading::is_value;
use super::json_table::JsonTable;
use super::numpy::NumpyTable;
use super::table_format::Delimiter;
use super::table_layout::{
    Wide, assigned, is_of_rostopic, names_by_order, numbered_quaternion, of_matrix, of_rostopic,
    transform, wide,
};

/// If the first line of a file lacks columns, it may be a title. The error message then names the later line that looks
/// like the header. This constant is the largest number of lines that are searched for it.
const MAX_TITLE_LINES: usize = 100;

pub(super) struct Record<'a> {
    pub(super) line: usize,
    pub(super) is_after_gap: bool,
    pub(super) fields: &'a StringRecord,
}

impl Record<'_> {
    /// Whether the row has `count` fields. A row may end in a delimiter: the empty field after the last delimiter does
    /// not count.
    pub(super) fn has(&self, count: usize) -> bool {
        let found = self.fields.len();
        found == count || (found == count + 1 && self.fields[count].trim().is_empty())
    }
}

pub(super) type RowResult = Result<(), RecordedError>;

/// Format of a table. For each format, a separate module reads the header and the rows.
enum Format<'a> {
    Delimited(DelimitedText<'a>),
    Json(JsonTable<'a>, Text<'a>),
    Numpy(NumpyTable<'a>),
}

pub(super) struct TextTable<'a> {
    pub(super) file: &'a RecordedFile,
    format: Format<'a>,
    pub(super) header: Vec<String>,
    pub(super) header_line: usize,
    /// For a wide table, in which a row contains several fingers: the names of its columns, and the division of these
    /// columns among the fingers. `None` for other tables.
    wide: Option<(Vec<String>, Wide)>,
    /// Note on how the columns were recognised; `None` if they were found by their names.
    note: Option<String>,
    numbered_quaternion: Option<[String; 4]>,
}

impl<'a> TextTable<'a> {
    /// Recognises the format of a file and reads the header. `orders` contains lists of columns. The first list
    /// contains the required columns; columns without names in the file get these names. A wide table (several fingers
    /// per row) may have the columns of the last list.
    pub(super) fn of(file: &'a RecordedFile, orders: &[&[Column]]) -> Result<Self, RecordedError> {
        let (format, header, header_line) = match NumpyTable::of(file) {
            Some(table) => {
                let (table, header) = table?;
                (Format::Numpy(table), header, 1)
            }
            None => {
                let label = orders.last().and_then(|columns| columns.first());
                let label = label.filter(|label| label.measure == Measure::Plain);
                Self::of_text(file, label.map(|label| label.name))?
            }
        };
        let mut table = Self {
            file,
            format,
            header,
            header_line,
            wide: None,
            note: None,
            numbered_quaternion: None,
        };
        table
            .name_columns(orders)
            .map_err(|message| file.fail(header_line, message))?;
        Ok(table)
    }

    /// Recognises columns that do not have palpate's names. Columns that the setting `columns` names are not changed.
    fn name_columns(&mut self, orders: &[&[Column]]) -> Result<(), String> {
        let names = &self.file.form.columns;
        let is_named = !names.is_empty();
        let count = match &self.format {
            Format::Numpy(table) => table.columns(),
            _ => self.header.len(),
        };
        let counts = |(name, place): (&String, usize)| *name == place.to_string();
        if self.header.iter().zip(0..).all(counts) {
            self.header = (0..count).map(|place| place.to_string()).collect();
        }
        self.name_transforms();
        if !is_named && !orders.is_empty() && self.header.iter().zip(0..).all(counts) {
            let has = |count| orders.iter().any(|order| order.len() == count);
            if let Format::Numpy(NumpyTable { rows, .. }) = self.format
                && count > rows
                && has(rows)
                && !has(count)
            {
                return Err(format!(
                    "an array of shape ({rows}, {count}) has one column per reading; transpose it (.T), because one row per reading is needed"
                ));
            }
            self.header = names_by_order(count, orders, self.leading())?;
            let names = self.header.join(",");
            let numbers = match &self.format {
                Format::Delimited(text) if text.heading > 0 => ", and the first line numbers them",
                _ => "",
            };
            self.note = Some(format!(
                "the columns have no names{numbers}; they are read as {names}"
            ));
        }
        let Some(columns) = orders.last() else {
            return Ok(());
        };
        let is_free = |name: &String| names.values().all(|one| one.trim() != name.trim());
        if columns.contains(&COLUMNS.matrix[0])
            && let Some(header) = of_matrix(&self.header)
        {
            let mut pairs = self.header.iter().zip(&header);
            if pairs.all(|(own, name)| own == name || is_free(own)) {
                self.header = header;
            }
        }
        let quaternion = numbered_quaternion(&self.header);
        if let Some(places) = quaternion.filter(|_| columns.contains(&COLUMNS.quaternion[0])) {
            let own = places.map(|place| self.header[place].clone());
            if own.iter().all(is_free) {
                for (place, column) in places.into_iter().zip(COLUMNS.quaternion) {
                    self.header[place] = column.name.to_owned();
                }
                self.numbered_quaternion = Some(own);
            }
        }
        let is_known = |key: &String| of_key(key, columns).is_some();
        if is_named && names.keys().all(is_known) {
            return Ok(());
        }
        let is_ros = is_of_rostopic(&self.header);
        let length = if is_ros { "m" } else { "" };
        if let Some(wide) = wide(&assigned(&self.header, names), columns, length)? {
            let header = std::mem::replace(&mut self.header, wide.header.clone());
            self.wide = Some((header, wide));
        } else if is_named {
        } else if is_ros && let Some((header, pairs)) = of_rostopic(&self.header, columns) {
            self.header = header;
            self.note = Some(format!(
                "a log of ROS, whose lengths are in metres, is read by setting `columns` '{pairs}'"
            ));
        }
        Ok(())
    }

    /// Names that the user assigned to single columns. In a wide table, they are already in the header.
    pub(super) const fn names(&self) -> &'a BTreeMap<String, String> {
        static NONE: BTreeMap<String, String> = BTreeMap::new();
        match self.wide {
            Some(_) => &NONE,
            None => &self.file.form.columns,
        }
    }

    /// Names the columns of a table whose rows contain homogeneous 4 x 4 matrices. The last row of such a matrix, which
    /// is 0, 0, 0, 1, shows whether the elements are listed by rows or by columns.
    fn name_transforms(&mut self) {
        let mut assigned = self.file.form.columns.values();
        let is_free = |&place: &usize| assigned.all(|name| name.trim() != self.header[place]);
        let places = transform(&self.header).filter(|places| places.iter().all(is_free));
        let Some(places) = places else {
            return;
        };
        let (mut is_by_rows, mut is_by_columns) = (true, true);
        let is_read = self.rows(|Record { fields, .. }| {
            let is_last = |elements: [usize; 4]| {
                let mut numbers = elements.iter().zip([0.0, 0.0, 0.0, 1.0]);
                numbers.all(|(&element, number)| {
                    let field = fields.get(places[element]);
                    field.is_some_and(|field| tidy(field).parse() == Ok(number))
                })
            };
            is_by_rows &= is_last([12, 13, 14, 15]);
            is_by_columns &= is_last([3, 7, 11, 15]);
            Ok(())
        });
        if is_read.is_err() || is_by_rows == is_by_columns {
            return;
        }
        let own = [0, 15].map(|element| self.header[places[element]].clone());
        for (element, &place) in places.iter().enumerate() {
            let [row, column] = match is_by_rows {
                true => [element / 4, element % 4],
                false => [element % 4, element / 4],
            };
            self.header[place] = match (row, column) {
                (3, _) => String::new(),
                (row, 3) => "xyz"[row..=row].to_owned(),
                (row, column) => COLUMNS.matrix[3 * row + column].name.to_owned(),
            };
        }
        let order = if is_by_rows { "rows" } else { "columns" };
        self.note = Some(format!(
            "the columns `{}` to `{}` are read as 4 x 4 matrices, listed by {order}",
            own[0], own[1]
        ));
    }

    /// Whether the first column of a table without a header may contain the numbers of fingers, and the number of
    /// columns before the first measured column, such as times.
    fn leading(&self) -> (bool, usize) {
        let (mut first, mut text) = (Vec::new(), None);
        let number = |field: &str| field.trim().parse::<f64>().ok();
        let is_read = self.rows(|Record { fields, .. }| {
            let last_text = || (0..fields.len()).rfind(|&place| number(&fields[place]).is_none());
            text.get_or_insert_with(last_text);
            first.push(number(&fields[0]).unwrap_or(f64::NAN));
            Ok(())
        });
        let text = text.flatten().map(|place| place + 1);
        let is_time =
            is_read.is_ok() && first.len() > 1 && first.is_sorted_by(|one, next| one < next);
        let is_label = first.iter().all(|one| *one >= 0.0 && one.fract() == 0.0);
        let is_label = is_label && !is_time && text.is_none();
        (is_label, text.unwrap_or(usize::from(is_time)))
    }

    /// Name of a column as the file has it. For a wide table, `label` is the first field of the row.
    pub(super) fn own_name(&self, index: usize, label: &str) -> &str {
        let own = self.wide.as_ref().and_then(|(header, wide)| {
            let group = wide.groups.iter().find(|group| group.name == label)?;
            let place = index.checked_sub(1)?;
            let mut places = group.places.iter().chain(&wide.shared);
            header.get(*places.nth(place)?)
        });
        own.unwrap_or(&self.header[index])
    }

    /// Number of fingers in a row of a wide table; `None` for other tables.
    pub(super) fn fingers(&self) -> Option<usize> {
        self.wide.as_ref().map(|(_, wide)| wide.groups.len())
    }

    /// Hint for a file whose first line is not its header, but a title: the line that names the columns.
    pub(super) fn header_hint(&self, required: &[Column], may: &[Column]) -> String {
        let Format::Delimited(DelimitedText { text, heading, .. }) = &self.format else {
            return String::new();
        };
        let is_header = |row: &str| {
            Delimiter::ALL.into_iter().find_map(|delimiter| {
                let header: Vec<String> = names(*text, row, delimiter);
                if header.iter().any(|name| is_value(name)) {
                    return None;
                }
                let header = Header::new(&header, &self.file.form.columns);
                let places = required
                    .iter()
                    .chain(may)
                    .map(|column| header.place(column));
                let is_twice = |_: &_| self.file.form.columns.is_empty();
                let is_name = |place: &Result<Option<_>, _>| {
                    place.as_ref().map_or_else(is_twice, Option::is_some)
                };
                let found: Vec<_> = places.filter(is_name).collect();
                (found.len() > 1 || header.offers(required))
                    .then(|| found.iter().any(Result::is_err))
            })
        };
        let rows = text.rows_after(self.header_line);
        let rows = rows.skip(heading.saturating_sub(1)).take(MAX_TITLE_LINES);
        let mut before = None;
        let line = rows.into_iter().find_map(|(row, line)| {
            let before = before.replace(line);
            // If names occur twice, the line before contains the names of their groups.
            let line_of = |is_twice: bool| before.filter(|_| is_twice).unwrap_or(line);
            is_header(row).map(line_of)
        });
        line.map_or_else(String::new, |line| {
            format!("; line {line} names columns: write # before the lines above it")
        })
    }

    /// Column names of a quaternion whose components have only numbers as names in the file; `None` if there is no such
    /// quaternion. The last component is assumed to be the scalar part.
    pub(super) const fn numbered_quaternion(&self) -> Option<&[String; 4]> {
        self.numbered_quaternion.as_ref()
    }

    /// Note on how the columns were recognised; `None` if they were found by their names.
    pub(super) fn note(&self) -> Option<String> {
        let Some((_, wide)) = &self.wide else {
            return self.note.clone();
        };
        let names = wide.groups.iter().map(|group| group.name.as_str());
        let names = names.collect::<Vec<_>>().join(", ");
        let label = &self.header[0];
        Some(format!(
            "each row holds the columns of several values of `{label}`: {names}"
        ))
    }

    fn of_text(
        file: &'a RecordedFile,
        label: Option<&str>,
    ) -> Result<(Format<'a>, Vec<String>, usize), RecordedError> {
        let text = Text::of(file.start("a header and one row per reading are needed")?);
        let (text, stated) = text.begun();
        let (first, header_line) = text.rows_after(0).next().unwrap_or(("", 1));
        let (format, header) = if first.trim_start().starts_with(['{', '[']) {
            let (table, header) = JsonTable::of(file, text, header_line, label)?;
            (Format::Json(table, text), header)
        } else {
            let stated = file.form.delimiter.or(stated);
            let (text, header) =
                DelimitedText::of(text, (first, header_line), stated, |line, message| {
                    file.fail(line, message)
                })?;
            (Format::Delimited(text), header)
        };
        Ok((format, header, header_line))
    }

    /// Whether this delimiter separates the fields of the table.
    pub(super) fn has(&self, delimiter: Delimiter) -> bool {
        matches!(&self.format, Format::Delimited(text) if text.delimiter == delimiter)
    }

    pub(super) fn may_have_commas(&self) -> bool {
        match &self.format {
            Format::Delimited(text) if text.delimiter == Delimiter::Comma => {
                text.text.all.contains('"')
            }
            Format::Delimited(table) => {
                table.delimiter == Delimiter::Semicolon || table.text.all.contains(',')
            }
            // In JSON, only a number in quotation marks may have a decimal comma.
            Format::Json(_, text) => text.all.split('"').any(|part| {
                part.starts_with(|one: char| "+-".contains(one) || one.is_ascii_digit())
                    && part.contains(',')
            }),
            Format::Numpy(_) => false,
        }
    }

    /// Calls `take` with every row. Stops if `take` returns an error.
    pub(super) fn each(&self, mut take: impl FnMut(Record<'_>) -> RowResult) -> RowResult {
        let Some((header, wide)) = &self.wide else {
            return self.rows(take);
        };
        self.rows(|record| {
            let (found, expected) = (record.fields.len(), header.len());
            if found < expected {
                let message = format!("{found} fields; the header has {expected}");
                return Err(self.file.fail(record.line, message));
            }
            let field = |place: &usize| &record.fields[*place];
            for group in &wide.groups {
                let own = group.places.iter().chain(&wide.shared).map(field);
                let fields = [group.name.as_str()].into_iter().chain(own);
                // If a row has more fields than the header, keep the additional fields, so that the reader rejects the
                // row.
                let more = record.fields.iter().skip(header.len());
                take(Record {
                    fields: &fields.chain(more).collect(),
                    ..record
                })?;
            }
            Ok(())
        })
    }

    fn rows(&self, take: impl FnMut(Record<'_>) -> RowResult) -> RowResult {
        match &self.format {
            Format::Delimited(text) => text.rows(self.file, take),
            Format::Json(table, _) => table.rows(self.file, take),
            Format::Numpy(table) => table.rows(take),
        }
    }
}

/// Text of a comment, without the sign at its start; `None` if the line is no comment. A log of rostopic begins with
/// `%time`, which is no comment.
pub(super) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let mut signs = ["#", "%", "//"].into_iter();
    let text = signs.find_map(|sign| line.strip_prefix(sign));
    text.filter(|_| !line.starts_with("%time"))
}

#[derive(Clone, Copy)]
pub(super) struct Text<'a> {
    pub(super) all: &'a str,
    pub(super) end: char,
    pub(super) line: usize,
}

impl<'a> Text<'a> {
    /// A text whose lines end with line feeds or, if the text has no line feeds, with carriage returns.
    pub(super) fn of(all: &'a str) -> Self {
        let end = if all.contains('\n') { '\n' } else { '\r' };
        Self { all, end, line: 1 }
    }

    /// Returns the text without the lines before its header, and the delimiter if a line such as `sep=;` states it.
    /// Excel writes this line before the header. If numbers follow the comments, the last comment is the header, as in
    /// files of NumPy.
    fn begun(self) -> (Self, Option<Delimiter>) {
        let (mut last, mut stated) = (None, None);
        for line in self.lines() {
            let text = line.trim();
            let delimiter = text.strip_prefix("sep=").and_then(|sign| sign.parse().ok());
            if let Some(named) = comment(text) {
                last = Some(named).filter(|named| !named.trim().is_empty());
            } else if delimiter.is_some() && stated.is_none() {
                stated = delimiter;
            } else if !text.is_empty() {
                let is_number = |field: &str| field.trim().parse::<f64>().is_ok();
                let has_numbers = text
                    .split(|letter: char| {
                        matches!(letter, ',' | ';' | '|') || letter.is_whitespace()
                    })
                    .filter(|field| !field.is_empty())
                    .all(is_number);
                let header = last.filter(|_| has_numbers);
                return (self.from(header.unwrap_or(line)), stated);
            }
        }
        (self, stated)
    }

    pub(super) fn lines(self) -> impl Iterator<Item = &'a str> {
        self.all.split_terminator(self.end)
    }

    /// The rest of this text from `part` on; `part` must be a slice of this text.
    pub(super) fn from(self, part: &'a str) -> Self {
        let start = part.as_ptr() as usize - self.all.as_ptr() as usize;
        Self {
            all: &self.all[start..],
            line: self.line + self.all[..start].matches(self.end).count(),
            ..self
        }
    }

    pub(super) fn rows_after(self, line: usize) -> impl Iterator<Item = (&'a str, usize)> {
        let lines = self.lines().zip(self.line..);
        lines.filter(move |(text, number)| *number > line && !text.trim().is_empty())
    }
}
