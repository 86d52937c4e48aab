//! Writes and reads tables as CSV or Parquet, row by row.

use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::Path;

use anyhow::{Context, Error};
use palpate::Column;
use palpate_study::{Rows, Table};

use super::names::Format;
use super::output_dir::begins_as;
#[cfg(feature = "parquet")]
use super::parquet;
use crate::failure::Failure;

pub(crate) struct TableWriter<W: Write + Send> {
    name: String,
    sink: Sink<W>,
}

enum Sink<W: Write + Send> {
    Csv(W),
    #[cfg(feature = "parquet")]
    Parquet(Box<parquet::Writer<W>>),
}

impl<W: Write + Send> TableWriter<W> {
    /// Starts a table with these columns. `about` contains metadata entries for a Parquet file.
    pub(crate) fn new(
        name: impl Into<String>,
        mut sink: W,
        format: Format,
        columns: Vec<Column>,
        about: &[(&str, String)],
    ) -> Result<Self, Failure> {
        let name = name.into();
        format.supported()?;
        let started = match format {
            Format::Csv => {
                let header = Table::new(columns).to_csv();
                let written = sink.write_all(header.as_bytes());
                written.map(|()| Sink::Csv(sink))
            }
            #[cfg(feature = "parquet")]
            Format::Parquet => {
                let begun = parquet::Writer::new(sink, columns, about);
                begun.map(|begun| Sink::Parquet(Box::new(begun)))
            }
            #[cfg(not(feature = "parquet"))]
            Format::Parquet => {
                let _ = about;
                Err(io::ErrorKind::Unsupported.into())
            }
        };
        match started {
            Ok(sink) => Ok(Self { name, sink }),
            Err(error) => Err(cannot(error, &name)),
        }
    }

    pub(crate) fn write(&mut self, rows: &str) -> Result<(), Failure> {
        let written = match &mut self.sink {
            Sink::Csv(sink) => sink.write_all(rows.as_bytes()),
            #[cfg(feature = "parquet")]
            Sink::Parquet(writer) => writer.write(rows),
        };
        written.map_err(|error| cannot(error, &self.name))
    }

    pub(crate) fn end(self) -> Result<W, Failure> {
        match self.sink {
            Sink::Csv(sink) => Ok(sink),
            #[cfg(feature = "parquet")]
            Sink::Parquet(writer) => writer.end().map_err(|error| cannot(error, &self.name)),
        }
    }
}

fn cannot(error: io::Error, name: &str) -> Failure {
    let error = Error::new(error);
    Failure::work(error.context(format!("cannot write {name}; the same command tries again")))
}

pub(crate) fn is_table(path: &Path, format: Format, columns: &[Column]) -> bool {
    match format {
        Format::Csv => begins_as(path, Table::new(columns.to_vec()).to_csv().as_bytes()),
        #[cfg(feature = "parquet")]
        Format::Parquet => parquet::is_table(path, columns),
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => false,
    }
}

/// Reads a table row by row, and passes the fields of the requested columns to `take`.
pub(crate) fn read<const N: usize>(
    path: &Path,
    format: Format,
    columns: [&str; N],
    take: &mut dyn FnMut([&str; N]) -> Result<(), Error>,
) -> Result<(), Failure> {
    format.supported()?;
    let read = match format {
        Format::Csv => read_csv(path, columns, take),
        #[cfg(feature = "parquet")]
        Format::Parquet => parquet::read(path, columns, take),
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => Ok(()),
    };
    read.with_context(|| format!("cannot read {}", path.display()))
        .map_err(Failure::work)
}

fn read_csv<const N: usize>(
    path: &Path,
    columns: [&str; N],
    take: &mut dyn FnMut([&str; N]) -> Result<(), Error>,
) -> Result<(), Error> {
    let mut rows = Rows::new(BufReader::new(File::open(path)?), true);
    let names = rows.header()?;
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(columns) {
        let found = names.iter().position(|column| column == name);
        *place = found.with_context(|| format!("it has no column `{name}`"))?;
    }
    while let Some((_, row)) = rows.next_row()? {
        take(places.map(|place| row.get(place).unwrap_or_default()))?;
    }
    Ok(())
}
