//! Reads and writes tables in Parquet format. The metadata of a file contain the unit of the column `x` as `unit.x`.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Error};
use palpate::{Column, ColumnType};
use palpate_study::Rows;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::types::{Type, TypePtr};

/// Number of rows in one row group of the file. Rows are collected in memory until a group is complete.
const GROUP: usize = 1 << 16;
const VERSION_KEY: &str = "palpate_version";

pub(super) struct Writer<W: Write + Send> {
    file: SerializedFileWriter<W>,
    columns: Vec<(Column, Values)>,
    rows: usize,
}

/// Collected values of one column, which are not written yet.
struct Values {
    /// One number per row: 1 if the row has a value, 0 if the value is missing. The field `present` contains only
    /// existing values.
    levels: Vec<i16>,
    present: Present,
}

enum Present {
    Numbers(Vec<f64>),
    /// Whole numbers. An unsigned number is stored as the signed number that has the same bits.
    Whole(Vec<i64>),
    Texts(Vec<ByteArray>),
}

impl<W: Write + Send> Writer<W> {
    /// Starts a table with these columns and no rows. `about` contains additional metadata entries.
    pub(super) fn new(sink: W, columns: Vec<Column>, about: &[(&str, String)]) -> io::Result<Self> {
        let version = KeyValue::new(VERSION_KEY.to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        let about = about.iter();
        let about = about.map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()));
        let units = columns.iter().filter_map(|column| {
            let unit = column.unit.clone()?;
            Some(KeyValue::new(format!("unit.{}", column.name), unit))
        });
        let entries = std::iter::once(version).chain(about).chain(units);
        let properties = WriterProperties::builder()
            .set_key_value_metadata(Some(entries.collect()))
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_offset_index_disabled(true);
        let schema = schema(&columns).map_err(plain)?;
        let file = SerializedFileWriter::new(sink, schema, Arc::new(properties.build()));
        Ok(Self {
            file: file.map_err(plain)?,
            columns: columns.into_iter().map(empty_column).collect(),
            rows: 0,
        })
    }

    pub(super) fn write(&mut self, rows: &str) -> io::Result<()> {
        let mut rows = Rows::new(rows.as_bytes(), false);
        while let Some((_, row)) = rows.next_row().map_err(io::Error::other)? {
            if row.len() != self.columns.len() {
                let (fields, columns) = (row.len(), self.columns.len());
                let problem = format!("a row has {fields} fields, and the table {columns} columns");
                return Err(io::Error::other(problem));
            }
            for ((column, values), field) in self.columns.iter_mut().zip(row) {
                if !values.push(column.values, field) {
                    let (name, word) = (&column.name, word(column.values));
                    let problem = format!("column {name}: `{field}` is no {word}");
                    return Err(io::Error::other(problem));
                }
            }
            self.rows += 1;
            if self.rows == GROUP {
                self.write_group().map_err(plain)?;
            }
        }
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        let mut columns = self.columns.iter_mut();
        while let Some(mut writer) = group.next_column()? {
            let Some((_, values)) = columns.next() else {
                break;
            };
            let levels = Some(values.levels.as_slice());
            match &mut values.present {
                Present::Numbers(numbers) => {
                    let writer = writer.typed::<DoubleType>();
                    writer.write_batch(numbers, levels, None)?;
                    numbers.clear();
                }
                Present::Whole(numbers) => {
                    let writer = writer.typed::<Int64Type>();
                    writer.write_batch(numbers, levels, None)?;
                    numbers.clear();
                }
                Present::Texts(texts) => {
                    let writer = writer.typed::<ByteArrayType>();
                    writer.write_batch(texts, levels, None)?;
                    texts.clear();
                }
            }
            values.levels.clear();
            writer.close()?;
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }

    pub(super) fn end(mut self) -> io::Result<W> {
        if self.rows > 0 {
            self.write_group().map_err(plain)?;
        }
        self.file.into_inner().map_err(plain)
    }
}

fn empty_column(column: Column) -> (Column, Values) {
    let present = match column.values {
        ColumnType::Number => Present::Numbers(Vec::new()),
        ColumnType::Whole | ColumnType::Count => Present::Whole(Vec::new()),
        ColumnType::Text => Present::Texts(Vec::new()),
    };
    let levels = Vec::new();
    (column, Values { levels, present })
}

impl Values {
    /// Adds the value of a field; an empty field is a missing value. Returns false if the field does not have the
    /// column's type.
    fn push(&mut self, kind: ColumnType, field: &str) -> bool {
        self.levels.push(i16::from(!field.is_empty()));
        if field.is_empty() {
            return true;
        }
        match &mut self.present {
            Present::Numbers(numbers) => added(numbers, field.parse().ok()),
            Present::Whole(numbers) if kind == ColumnType::Count => {
                added(numbers, field.parse().ok().map(u64::cast_signed))
            }
            Present::Whole(numbers) => added(numbers, whole(field)),
            Present::Texts(texts) => added(texts, Some(field.into())),
        }
    }
}

fn word(kind: ColumnType) -> &'static str {
    match kind {
        ColumnType::Number => "number",
        ColumnType::Whole => "whole number",
        ColumnType::Count => "whole number from 0 on",
        ColumnType::Text => "text",
    }
}

fn added<T>(values: &mut Vec<T>, value: Option<T>) -> bool {
    let is_value = value.is_some();
    values.extend(value);
    is_value
}

/// Parses a whole number, also in a notation like 1e7.
fn whole(field: &str) -> Option<i64> {
    /// Largest number up to which `f64` can represent every whole number exactly.
    const MAX_EXACT: f64 = 9_007_199_254_740_992.0;
    let of_float = || {
        let number: f64 = field.parse().ok()?;
        (number.fract() == 0.0 && number.abs() <= MAX_EXACT).then_some(number as i64)
    };
    field.parse().ok().or_else(of_float)
}

fn schema(columns: &[Column]) -> Result<TypePtr, ParquetError> {
    let field = |column: &Column| {
        let (physical, logical) = match column.values {
            ColumnType::Number => (Physical::DOUBLE, None),
            ColumnType::Whole => (Physical::INT64, Some(LogicalType::integer(64, true))),
            ColumnType::Count => (Physical::INT64, Some(LogicalType::integer(64, false))),
            ColumnType::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        Type::primitive_type_builder(&column.name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()
            .map(Arc::new)
    };
    let fields: Result<Vec<TypePtr>, ParquetError> = columns.iter().map(field).collect();
    let schema = Type::group_type_builder("schema").with_fields(fields?);
    schema.build().map(Arc::new)
}

/// Converts a Parquet error to an I/O error. If another error caused the Parquet error, the message states only the
/// cause.
fn plain(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(cause) => match cause.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(cause) => io::Error::other(cause),
        },
        error => io::Error::other(error),
    }
}

pub(super) fn is_table(path: &Path, columns: &[Column]) -> bool {
    let reader = File::open(path).map(SerializedFileReader::new);
    let Ok(Ok(reader)) = reader else {
        return false;
    };
    let about = reader.metadata().file_metadata();
    let mut keys = about.key_value_metadata().into_iter().flatten();
    let fields = about.schema().get_fields().iter().map(|field| field.name());
    keys.any(|entry| entry.key == VERSION_KEY)
        && fields.eq(columns.iter().map(|column| column.name.as_str()))
}

pub(super) fn read<const N: usize>(
    path: &Path,
    columns: [&str; N],
    take: &mut dyn FnMut([&str; N]) -> Result<(), Error>,
) -> Result<(), Error> {
    let reader = SerializedFileReader::new(File::open(path)?)?;
    let fields = reader.metadata().file_metadata().schema().get_fields();
    let mut chosen = Vec::new();
    for name in columns {
        let field = fields.iter().find(|field| field.name() == name);
        let field = field.with_context(|| format!("it has no column `{name}`"))?;
        chosen.push(Arc::clone(field));
    }
    let chosen = Type::group_type_builder("schema").with_fields(chosen);
    for row in reader.get_row_iter(Some(chosen.build()?))? {
        let row = row?;
        let text = |name: &str| {
            let field = row.get_column_iter().find(|(column, _)| *column == name);
            match field {
                Some((_, Field::Str(text))) => text.clone(),
                None | Some((_, Field::Null)) => String::new(),
                Some((_, field)) => field.to_string(),
            }
        };
        let texts = columns.map(text);
        take(std::array::from_fn(|place| texts[place].as_str()))?;
    }
    Ok(())
}
