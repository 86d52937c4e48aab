//! Tables as rows of text fields, whatever the format of the file.

use csv::StringRecord;

use super::delimited_text::DelimitedText;
use super::error::RecordedError;
use super::file::RecordedFile;
use super::json_lines;
use super::table_format::Delimiter;

/// Maximum number of lines of a table.
const MAX_LINES: usize = 5_000_000;

/// A row of fields.
pub(super) struct Record<'a> {
    /// Line, from 1.
    pub(super) line: usize,
    /// Whether a blank line precedes the row.
    pub(super) is_after_gap: bool,
    pub(super) fields: &'a StringRecord,
}

/// Result of a function that reads one row.
pub(super) type RowResult = Result<(), RecordedError>;

/// Format of a table. Each has a file that reads its header and its rows.
enum Format<'a> {
    /// Fields that are separated by a delimiter.
    Delimited(DelimitedText<'a>),
    /// A JSON object per line.
    JsonLines(Text<'a>),
}

/// A table as text, with its header.
pub(super) struct TextTable<'a> {
    pub(super) file: &'a RecordedFile,
    format: Format<'a>,
    /// Names of the columns.
    pub(super) header: Vec<String>,
    /// Line of the header.
    pub(super) header_line: usize,
}

impl<'a> TextTable<'a> {
    /// Recognises the format of a file and reads the header.
    pub(super) fn of(file: &'a RecordedFile) -> Result<Self, RecordedError> {
        let text = Text::of(file.text("a header and one row per reading are needed")?);
        let lines = text.lines().count();
        if lines > MAX_LINES {
            return Err(file.error(format!("has {lines} lines; at most {MAX_LINES} are read")));
        }
        let (text, stated) = text.begun();
        let (first, header_line) = text.rows_after(0).next().unwrap_or(("", 1));
        let (format, header) = if first.trim_start().starts_with(['{', '[']) {
            let header = json_lines::keys(file, header_line, first)?;
            (Format::JsonLines(text), header)
        } else {
            let stated = file.form.delimiter.or(stated);
            let (text, header) =
                DelimitedText::of(text, (first, header_line), stated, |line, message| {
                    file.fail(line, message)
                })?;
            (Format::Delimited(text), header)
        };
        Ok(Self {
            file,
            format,
            header,
            header_line,
        })
    }

    /// Whether the columns are separated by commas.
    pub(super) fn has_commas(&self) -> bool {
        matches!(&self.format, Format::Delimited(text) if text.delimiter == Delimiter::Comma)
    }

    /// Whether there may be fields with a comma.
    pub(super) fn may_have_commas(&self) -> bool {
        match &self.format {
            Format::Delimited(text) if text.delimiter == Delimiter::Comma => {
                text.text.all.contains('"')
            }
            Format::Delimited(DelimitedText { text, .. }) | Format::JsonLines(text) => {
                text.all.contains(',')
            }
        }
    }

    /// Calls `take` with every row until it fails.
    pub(super) fn each(&self, take: impl FnMut(Record<'_>) -> RowResult) -> RowResult {
        match &self.format {
            Format::Delimited(text) => text.rows(take),
            Format::JsonLines(text) => {
                json_lines::rows(self.file, *text, (&self.header, self.header_line), take)
            }
        }
    }
}

/// A text and its line terminator.
#[derive(Clone, Copy)]
pub(super) struct Text<'a> {
    pub(super) all: &'a str,
    pub(super) end: char,
    /// Line of the file where the text begins, from 1.
    pub(super) line: usize,
}

impl<'a> Text<'a> {
    /// A text whose lines end with line feeds or, if it has none, with carriage returns.
    pub(super) fn of(all: &'a str) -> Self {
        let end = if all.contains('\n') { '\n' } else { '\r' };
        Self { all, end, line: 1 }
    }

    /// The text from its header on, and the delimiter from a line `sep=` that Excel writes before it. Lines that
    /// begin with # are comments; but if numbers follow, the last of them is the header, as NumPy writes it.
    fn begun(self) -> (Self, Option<Delimiter>) {
        let (mut start, mut comment, mut stated) = (0, None, None);
        for (line, number) in self.lines().zip(1..) {
            let text = line.trim();
            let delimiter = text.strip_prefix("sep=").and_then(|sign| sign.parse().ok());
            if let Some(named) = text.strip_prefix('#') {
                let at = start + line.find('#').unwrap_or_default() + 1;
                comment = (!named.trim().is_empty()).then_some((at, number));
            } else if delimiter.is_some() && stated.is_none() {
                stated = delimiter;
            } else if !text.is_empty() {
                let is_number = |field: &str| field.trim().parse::<f64>().is_ok();
                let has_numbers = text
                    .split(|letter: char| matches!(letter, ',' | ';') || letter.is_whitespace())
                    .filter(|field| !field.is_empty())
                    .all(is_number);
                let header = comment.filter(|_| has_numbers);
                let (start, line) = header.unwrap_or((start, number));
                let all = &self.all[start..];
                return (Self { all, line, ..self }, stated);
            }
            start += line.len() + self.end.len_utf8();
        }
        (self, stated)
    }

    pub(super) fn lines(self) -> impl Iterator<Item = &'a str> {
        self.all.split_terminator(self.end)
    }

    /// Lines of the file after this one that are not blank, with their numbers.
    pub(super) fn rows_after(self, line: usize) -> impl Iterator<Item = (&'a str, usize)> {
        let lines = self.lines().zip(self.line..);
        lines.filter(move |(text, number)| *number > line && !text.trim().is_empty())
    }
}
