//! Form in which a table of readings is written, as far as it does not tell that itself.

use palpate_study::config::LengthUnit;
use palpate_study::readings::ColumnNames;

use super::written::fields;

/// Form of a table of readings. What is not stated is found in the table, where it can be told.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// The file's names of columns that it calls otherwise than palpate: by palpate's name, with or without a unit.
    pub columns: ColumnNames,
    /// Character between fields.
    pub delimiter: Option<Delimiter>,
    /// Decimal sign of numbers.
    pub decimal: Option<Decimal>,
    /// Unit to which lengths are converted whose unit the header states, and in which all others are.
    pub length_unit: Option<LengthUnit>,
}

/// Character between the fields of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// A tab.
    Tab,
    /// `;`.
    Semicolon,
    /// `,`.
    Comma,
}

impl Delimiter {
    /// Delimiters, in the order in which they are tried.
    pub const ALL: [Self; 3] = [Self::Tab, Self::Semicolon, Self::Comma];

    /// Name, as options have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tab => "tab",
            Self::Semicolon => "semicolon",
            Self::Comma => "comma",
        }
    }

    /// The character itself.
    pub const fn sign(self) -> &'static str {
        match self {
            Self::Tab => "\t",
            Self::Semicolon => ";",
            Self::Comma => ",",
        }
    }

    pub(super) const fn byte(self) -> u8 {
        self.sign().as_bytes()[0]
    }
}

/// Decimal sign of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decimal {
    /// `1.5`.
    Point,
    /// `1,5`.
    Comma,
}

impl Decimal {
    /// Both signs.
    pub const ALL: [Self; 2] = [Self::Point, Self::Comma];

    /// Name, as options have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Comma => "comma",
        }
    }

    /// The sign itself.
    pub const fn sign(self) -> &'static str {
        match self {
            Self::Point => ".",
            Self::Comma => ",",
        }
    }
}

/// Names of columns from a text such as `x=Finger X [m],y=Finger Y [m]`; a pair with a comma in it stands in quotation
/// marks.
///
/// ```
/// use palpate_scene::recorded::column_names;
///
/// let names = column_names(r#"x=Finger X [m],"z=Height, raw""#)?;
/// assert_eq!(names["x"], "Finger X [m]");
/// assert_eq!(names["z"], "Height, raw");
/// assert!(column_names("x").is_err());
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
/// Problem in words, of a pair without `=` or with nothing on one side of it, and of a name that stands twice.
pub fn column_names(text: &str) -> Result<ColumnNames, String> {
    let mut names = ColumnNames::new();
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
            return Err(format!("`{name}` stands twice"));
        }
    }
    match names.is_empty() {
        true => Err("names no column; write x=Finger X [m],y=…".to_owned()),
        false => Ok(names),
    }
}

/// A pair of names as [`column_names`] reads it.
pub(super) fn pair(name: &str, in_file: &str) -> String {
    let pair = format!("{name}={in_file}");
    match pair.contains([',', '"']) {
        true => format!("\"{}\"", pair.replace('"', "\"\"")),
        false => pair,
    }
}
