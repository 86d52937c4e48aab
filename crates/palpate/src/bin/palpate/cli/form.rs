//! Form of a table of readings, as arguments.

use clap::Args;
use palpate_recorded::{Decimal, Delimiter, Form, column_names};
use palpate_study::config::LengthUnit;
use palpate_study::readings::ColumnNames;

use super::number::length_unit;

/// Form of a table, as far as it does not tell it itself.
#[derive(Debug, Args)]
pub(crate) struct FormArgs {
    /// The file's names of columns that it calls otherwise, such as x=Finger X [m],y=Finger Y [m]; a pair with a comma in
    /// it stands in quotation marks. A unit behind palpate's name (x_mm) is that of a header that states none.
    #[arg(long, value_name = "NAME=COLUMN,...", value_parser = column_names)]
    pub(crate) columns: Option<ColumnNames>,
    /// Character between fields: comma, semicolon or tab [default: as header and rows show].
    #[arg(long, value_name = "NAME", value_parser = delimiter)]
    pub(crate) delimiter: Option<Delimiter>,
    /// Decimal sign: point or comma [default: as the numbers show].
    #[arg(long, value_name = "NAME", value_parser = decimal)]
    pub(crate) decimal: Option<Decimal>,
    /// The unit of lengths in options and output, and in a file whose header states none (x_mm does); lengths
    /// in other units are converted to it [default: the header's unit].
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    pub(crate) length_unit: Option<LengthUnit>,
}

impl FormArgs {
    /// Flag of this struct's own that only tables have use for, if one was given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        match self {
            Self {
                columns: Some(_), ..
            } => Some("--columns"),
            Self {
                delimiter: Some(_), ..
            } => Some("--delimiter"),
            Self {
                decimal: Some(_), ..
            } => Some("--decimal"),
            _ => None,
        }
    }

    /// Form of a table.
    pub(crate) fn form(&self) -> Form {
        Form {
            columns: self.columns.clone().unwrap_or_default(),
            delimiter: self.delimiter,
            decimal: self.decimal,
            length_unit: self.length_unit,
        }
    }
}

fn delimiter(text: &str) -> Result<Delimiter, String> {
    let mut all = Delimiter::ALL.into_iter();
    all.find(|one| one.name() == text || one.sign() == text)
        .ok_or_else(|| "must be comma, semicolon or tab".to_owned())
}

fn decimal(text: &str) -> Result<Decimal, String> {
    let mut all = Decimal::ALL.into_iter();
    all.find(|one| one.name() == text || one.sign() == text)
        .ok_or_else(|| "must be point or comma".to_owned())
}
