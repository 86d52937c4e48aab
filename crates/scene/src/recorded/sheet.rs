//! A CSV file of numbers, with errors that say where.

use palpate_number::Number;
use thiserror::Error;

use palpate_study::config::LengthUnit;

/// Readings that cannot be read.
#[derive(Debug, Error)]
pub enum RecordedError {
    /// The file cannot be opened or is not text.
    #[error("{file}: {message}")]
    File {
        /// The file.
        file: String,
        /// Problem in words.
        message: String,
    },
    /// A line is wrong: the header lacks or adds a column, a row a field, or a field is no number.
    #[error("{file}:{line}: {message}")]
    Line {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// Problem in words, with the column and the value.
        message: String,
    },
    /// The numbers are readable but tell nothing.
    #[error("{file}: {message}")]
    Readings {
        /// The file.
        file: String,
        /// Problem in words.
        message: String,
    },
}

/// A column that a table must have: its name, and whether a unit may follow it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) is_length: bool,
}

impl Column {
    pub(super) const fn plain(name: &'static str) -> Self {
        let is_length = false;
        Self { name, is_length }
    }

    pub(super) const fn length(name: &'static str) -> Self {
        let is_length = true;
        Self { name, is_length }
    }
}

/// Most lines of a table.
const MOST_LINES: usize = 5_000_000;

/// A header and rows of numbers, in the order of the columns asked for.
pub(super) struct Sheet {
    pub(super) file: String,
    /// The line of each row.
    lines: Vec<usize>,
    /// Row by row.
    numbers: Vec<f64>,
    columns: usize,
    /// The unit that the header states.
    pub(super) unit: Option<LengthUnit>,
}

const UNITS: [LengthUnit; 5] = [
    LengthUnit::M,
    LengthUnit::Cm,
    LengthUnit::Mm,
    LengthUnit::Um,
    LengthUnit::Unit,
];

/// The names in the header of a text.
pub(super) fn header(text: &str) -> Vec<&str> {
    records(text)
        .next()
        .map_or_else(Vec::new, |(_, fields)| fields)
}

/// The lines that are not blank: number, from 1, and fields. Numbers need no quotes, but may have
/// them.
fn records(text: &str) -> impl Iterator<Item = (usize, Vec<&str>)> {
    text.lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty())
        .map(|(index, line)| (index + 1, fields(line)))
}

fn fields(line: &str) -> Vec<&str> {
    line.split(',')
        .map(|field| field.trim().trim_matches('"'))
        .collect()
}

/// First line, from 1, with a quotation mark that is not one of a pair around a field.
fn unclosed(text: &str) -> Option<usize> {
    let is_unclosed = |field: &str| {
        let field = field.trim();
        let quoted = field
            .strip_prefix('"')
            .and_then(|rest| rest.strip_suffix('"'));
        quoted.unwrap_or(field).contains('"')
    };
    let mut lines = text.lines();
    lines
        .position(|line| line.contains('"') && line.split(',').any(is_unclosed))
        .map(|index| index + 1)
}

impl Sheet {
    /// Reads the `columns` of a text, which may come in any order but must be all.
    pub(super) fn parse(file: &str, text: &str, columns: &[Column]) -> Result<Self, RecordedError> {
        let fail = |line, message| RecordedError::Line {
            file: file.to_owned(),
            line,
            message,
        };
        if let Some(line) = unclosed(text) {
            return Err(fail(
                line,
                "a quotation mark is not closed before the comma or the end of the line".to_owned(),
            ));
        }
        let rows = text.lines().count();
        if rows > MOST_LINES {
            return Err(RecordedError::File {
                file: file.to_owned(),
                message: format!("has {rows} lines; at most {MOST_LINES} are read"),
            });
        }
        let mut records = records(text);
        let (line, header) = records.next().unwrap_or((1, Vec::new()));
        let (places, unit) = places(&header, columns).map_err(|message| fail(line, message))?;
        let (mut lines, mut numbers) = (Vec::new(), Vec::new());
        for (line, fields) in records {
            if fields.len() != header.len() {
                let (found, expected) = (fields.len(), header.len());
                return Err(fail(
                    line,
                    format!("{found} fields; the header has {expected}"),
                ));
            }
            for &place in &places {
                let number = number(fields[place]);
                numbers.push(
                    number.map_err(|what| {
                        fail(line, format!("column `{}`: {what}", header[place]))
                    })?,
                );
            }
            lines.push(line);
        }
        if lines.is_empty() {
            let message = "has a header but no readings".to_owned();
            return Err(RecordedError::Readings {
                file: file.to_owned(),
                message,
            });
        }
        Ok(Self {
            file: file.to_owned(),
            lines,
            numbers,
            columns: columns.len(),
            unit,
        })
    }

    /// Each row's line and numbers.
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, &[f64])> {
        let rows = self.numbers.chunks_exact(self.columns);
        self.lines.iter().copied().zip(rows)
    }

    /// An error in a line.
    pub(super) fn fail(&self, line: usize, message: String) -> RecordedError {
        RecordedError::Line {
            file: self.file.clone(),
            line,
            message,
        }
    }

    /// The number of a probe or finger.
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

/// The unit that the header of a file or `--length-unit` states.
pub(super) fn agreed_unit(
    file: &str,
    header: Option<LengthUnit>,
    option: Option<LengthUnit>,
) -> Result<LengthUnit, RecordedError> {
    match (header, option) {
        (Some(header), Some(option)) if header != option => {
            let (header, option) = (header.as_str(), option.as_str());
            Err(RecordedError::Readings {
                file: file.to_owned(),
                message: format!("the header says {header}, --length-unit says {option}"),
            })
        }
        (header, option) => Ok(header.or(option).unwrap_or_default()),
    }
}

/// A field as a finite number.
fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("must be finite, is {text}")),
        Err(_) if text.is_empty() => Err("is empty".to_owned()),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

/// Places of the columns in a row, and the unit that the header states.
fn places(header: &[&str], columns: &[Column]) -> Result<(Vec<usize>, Option<LengthUnit>), String> {
    let wanted = || {
        columns
            .iter()
            .map(|column| column.name)
            .collect::<Vec<_>>()
            .join(",")
    };
    let mut unit: Option<LengthUnit> = None;
    let mut places = Vec::new();
    for column in columns {
        let mut matching = header.iter().enumerate().filter_map(|(place, name)| {
            let rest = name.strip_prefix(column.name)?;
            if rest.is_empty() {
                return Some((place, None));
            }
            let unit = UNITS
                .into_iter()
                .find(|unit| rest.strip_prefix('_') == Some(unit.as_str()))?;
            column.is_length.then_some((place, Some(unit)))
        });
        let Some((place, stated)) = matching.next() else {
            return Err(format!(
                "no column `{}`; the columns must be {}",
                column.name,
                wanted()
            ));
        };
        if matching.next().is_some() {
            return Err(format!("column `{}` stands twice", column.name));
        }
        if let (Some(before), Some(stated)) = (unit, stated)
            && before != stated
        {
            let (before, stated) = (before.as_str(), stated.as_str());
            return Err(format!(
                "lengths are in {before} and in {stated}; one unit is needed"
            ));
        }
        unit = unit.or(stated);
        places.push(place);
    }
    if let Some(extra) = (0..header.len()).find(|place| !places.contains(place)) {
        let name = &header[extra];
        return Err(format!(
            "unknown column `{name}`; the columns must be {}",
            wanted()
        ));
    }
    Ok((places, unit))
}
