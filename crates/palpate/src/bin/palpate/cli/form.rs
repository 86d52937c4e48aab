//! Defines the arguments about the format of a table of readings.

use clap::Args;
use palpate_recorded::{Decimal, Delimiter, Form, column_names};
use palpate_study::config::LengthUnit;
use palpate_study::readings::ColumnNames;

use super::number::length_unit;

/// Format of a table of readings, for properties that palpate cannot detect in the table itself.
#[derive(Debug, Args)]
pub(crate) struct FormArgs {
    /// Names of columns in the file that differ from palpate's names, such as x=Finger X [m],y=Finger Y [m]. Put a pair
    /// that contains a comma in quotation marks. If the header of the file states no unit, the unit in palpate's name
    /// (x_mm) applies.
    #[arg(long, value_name = "NAME=COLUMN,...", value_parser = column_names)]
    pub(crate) columns: Option<ColumnNames>,
    /// Character between fields: comma, semicolon, tab or space [default: detected from header and rows].
    #[arg(long, value_name = "NAME")]
    pub(crate) delimiter: Option<Delimiter>,
    /// Decimal sign: point or comma [default: detected from the numbers].
    #[arg(long, value_name = "NAME")]
    pub(crate) decimal: Option<Decimal>,
    /// Unit of lengths in options and output, and in a file whose header states no unit. Lengths in other units are
    /// converted to this unit [default: the header's unit].
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    pub(crate) length_unit: Option<LengthUnit>,
}

impl FormArgs {
    /// Name of the first given flag that affects only tables (not camera frames); `None` if no such flag was given.
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

    pub(crate) fn form(&self) -> Form {
        Form {
            columns: self.columns.clone().unwrap_or_default(),
            delimiter: self.delimiter,
            decimal: self.decimal,
            length_unit: self.length_unit,
            rotation_frame: None,
        }
    }
}
