//! Settings that describe the form of a table, for everything that the table itself does not state.

use std::collections::BTreeMap;
use std::str::FromStr;

use palpate_study::config::LengthUnit;

use super::delimited_text::fields;
use super::roll_rotation::RotationFrame;

/// Form of a table of readings. Settings that are `None` are detected from the table if possible.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// Names that the user assigned to columns of a file that does not use palpate's names. The keys are palpate's
    /// names of the columns, with or without a unit. The values are the names in the file.
    pub columns: BTreeMap<String, String>,
    /// Character that separates the fields of a row. By default, it is detected.
    pub delimiter: Option<Delimiter>,
    /// Decimal sign of the numbers in the table. By default, it is detected.
    pub decimal: Option<Decimal>,
    /// Unit of lengths. If the header states another unit for a length, the length is converted. If the header states
    /// no unit, this unit is assumed.
    pub length_unit: Option<LengthUnit>,
    /// Frame of reference for rotations, if the file states orientations over time. By default, it is the frame of the
    /// probe.
    pub rotation_frame: Option<RotationFrame>,
}

/// Character that separates the fields of a row in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// Fields are separated by a tab.
    Tab,
    /// Fields are separated by `;`.
    Semicolon,
    /// Fields are separated by `,`.
    Comma,
    /// Fields are separated by `|`.
    Pipe,
    /// Fields are separated by any number of spaces and tabs.
    Space,
}

impl Delimiter {
    /// All delimiters, in the order in which a file is tested for them.
    pub(super) const ALL: [Self; 5] = [
        Self::Tab,
        Self::Semicolon,
        Self::Comma,
        Self::Pipe,
        Self::Space,
    ];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Tab => "tab",
            Self::Semicolon => "semicolon",
            Self::Comma => "comma",
            Self::Pipe => "pipe",
            Self::Space => "space",
        }
    }

    pub(super) const fn byte(self) -> u8 {
        match self {
            Self::Tab => b'\t',
            Self::Semicolon => b';',
            Self::Comma => b',',
            Self::Pipe => b'|',
            Self::Space => b' ',
        }
    }
}

/// Parses the name of a delimiter, such as `tab`, or the character itself.
impl FromStr for Delimiter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_named = |one: &Self| one.name() == text || text.as_bytes() == [one.byte()];
        let found = Self::ALL.into_iter().find(is_named);
        found.ok_or_else(|| "must be comma, semicolon, tab, pipe or space".to_owned())
    }
}

/// Decimal sign of the numbers in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decimal {
    /// A decimal point, as in `1.5`.
    Point,
    /// A decimal comma, as in `1,5`.
    Comma,
}

/// Parses the name of a decimal sign (`point`, `comma`), or the character itself.
impl FromStr for Decimal {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "point" | "." => Ok(Self::Point),
            "comma" | "," => Ok(Self::Comma),
            _ => Err("must be point or comma".to_owned()),
        }
    }
}

/// Parses names of columns from a text such as `x=Finger X [m],y=Finger Y [m]`. A pair that contains a comma must be in
/// quotation marks.
///
/// ```
/// use palpate_recorded::column_names;
///
/// let names = column_names(r#"x=Finger X [m],"z=Height, raw""#)?;
/// assert_eq!(names["x"], "Finger X [m]");
/// assert_eq!(names["z"], "Height, raw");
/// assert!(column_names("x").is_err());
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
/// A message, if a pair has no `=` or nothing on one side of it, or if a name occurs twice.
pub fn column_names(text: &str) -> Result<BTreeMap<String, String>, String> {
    let mut names = BTreeMap::new();
    for pair in fields(text).map_err(|error| error.to_string())? {
        let sides = pair.split_once('=');
        let sides = sides.map(|(name, in_file)| (name.trim(), in_file.trim()));
        let Some((name, in_file)) =
            sides.filter(|(name, in_file)| !name.is_empty() && !in_file.is_empty())
        else {
            return Err(format!(
                "`{pair}` is no pair of names; write a column of palpate, =, and the file's column: x=Finger X [m]"
            ));
        };
        if names.insert(name.to_owned(), in_file.to_owned()).is_some() {
            return Err(format!("`{name}` is given twice"));
        }
    }
    match names.is_empty() {
        true => Err("names no column; write a pair such as x=Finger X [m]".to_owned()),
        false => Ok(names),
    }
}

/// A pair of names in the format that [`column_names`] reads.
pub(super) fn pair(name: &str, in_file: &str) -> String {
    let pair = format!("{name}={in_file}");
    match pair.contains([',', '"']) {
        true => format!("\"{}\"", pair.replace('"', "\"\"")),
        false => pair,
    }
}
