//! Columns of recorded readings: their names, their physical quantities and the accepted units.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use crate::config::{FieldError, LengthUnit};
use crate::{Column as TableColumn, Unit};

/// Physical quantity of the numbers in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Length.
    Length,
    /// An angle. Its values are converted to radians.
    Angle,
    /// A time. Its values are converted to seconds.
    Time,
    /// A hue difference. Its values are converted to turns, that is, fractions of the hue circle.
    Turn,
    /// A length in an image, in pixels.
    Pixel,
    /// A force, in newtons.
    Force,
    /// A number or a direction without a unit.
    Plain,
}

/// Unit of the numbers in a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColumnUnit {
    /// A length unit that studies may use.
    Length(LengthUnit),
    /// Inch, 25.4 mm.
    Inch,
    /// Nanometre.
    Nanometre,
    /// A unit that is not a length. The factor converts numbers to the base unit of the physical quantity (for example
    /// rad, s or turn).
    Factor(f64),
}

impl ColumnUnit {
    /// Factor that converts numbers in this unit to the unit `length`. If this unit is not a length, the factor
    /// converts to the base unit of its physical quantity. `None` if one of the two units is a metric length, and the
    /// other is the unspecified unit of length (`unit`).
    pub fn to(self, length: LengthUnit) -> Option<f64> {
        let of_metres = |metres: f64| LengthUnit::M.to(length).map(|factor| factor * metres);
        match self {
            Self::Length(unit) => unit.to(length),
            Self::Inch => of_metres(0.0254),
            Self::Nanometre => of_metres(1e-9),
            Self::Factor(factor) => Some(factor),
        }
    }
}

impl Measure {
    /// Parses a unit of this physical quantity, ignoring case; `None` if the text is no such unit.
    pub fn unit(self, text: &str) -> Option<ColumnUnit> {
        use ColumnUnit::{Factor, Inch, Length, Nanometre};
        let text = text.trim().to_lowercase();
        let unit = match (self, text.as_str()) {
            (Self::Length, "m" | "metre" | "metres" | "meter" | "meters") => Length(LengthUnit::M),
            (Self::Length, "cm") => Length(LengthUnit::Cm),
            (Self::Length, "mm") => Length(LengthUnit::Mm),
            // Accept the micro sign and the Greek letter mu, which look alike but are different characters.
            (Self::Length, "um" | "\u{b5}m" | "\u{3bc}m") => Length(LengthUnit::Um),
            (Self::Length, "nm") => Nanometre,
            (Self::Length, "in" | "inch" | "inches") => Inch,
            (Self::Length, "unit") => Length(LengthUnit::Unit),
            (Self::Angle, "rad" | "radian" | "radians") => Factor(1.0),
            (Self::Angle, "mrad") => Factor(1e-3),
            (Self::Angle, "deg" | "degree" | "degrees" | "\u{b0}") => Factor(PI / 180.0),
            (Self::Time, "s" | "sec" | "seconds") => Factor(1.0),
            (Self::Time, "ms") => Factor(1e-3),
            (Self::Time, "us" | "\u{b5}s" | "\u{3bc}s") => Factor(1e-6),
            (Self::Time, "ns") => Factor(1e-9),
            (Self::Time, "min") => Factor(60.0),
            (Self::Turn, "turn" | "turns") => Factor(1.0),
            (Self::Turn, "deg" | "degree" | "degrees" | "\u{b0}") => Factor(1.0 / 360.0),
            (Self::Turn, "rad") => Factor(1.0 / TAU),
            (Self::Pixel, "px" | "pixel" | "pixels") => Factor(1.0),
            // Units are compared in lower case, so "mn" is always mN. MN (meganewton) is not supported.
            (Self::Force, "n" | "newton" | "newtons") => Factor(1.0),
            (Self::Force, "mn") => Factor(1e-3),
            (Self::Force, "kn") => Factor(1e3),
            (Self::Plain, "" | "-" | "1") => Factor(1.0),
            _ => return None,
        };
        Some(unit)
    }

    /// Accepted units, as a text for messages.
    pub const fn units(self) -> &'static str {
        match self {
            Self::Length => "m, cm, mm, um, nm, in",
            Self::Angle => "rad, mrad, deg",
            Self::Time => "s, ms, us, ns, min",
            Self::Turn => "turns, deg, rad",
            Self::Pixel => "px",
            Self::Force => "N, mN, kN",
            Self::Plain => "none",
        }
    }

    /// Unit at the end of the column names that palpate uses for this physical quantity; `None` if these names have no
    /// unit.
    const fn in_name(self) -> Option<&'static str> {
        match self {
            Self::Length | Self::Plain => None,
            Self::Angle => Some("rad"),
            Self::Time => Some("s"),
            Self::Turn => Some("turns"),
            Self::Pixel => Some("px"),
            Self::Force => Some("n"),
        }
    }
}

/// A column in recorded readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name of the column. It includes the unit, unless the unit is a length: `x`, `rotation_x_rad`.
    pub name: &'static str,
    /// Physical quantity of the numbers in the column.
    pub measure: Measure,
}

impl Column {
    const fn of(name: &'static str, measure: Measure) -> Self {
        Self { name, measure }
    }

    /// Name of the column without its unit.
    pub fn stem(&self) -> &'static str {
        let unit = self.measure.in_name();
        unit.and_then(|unit| self.name.strip_suffix(unit)?.strip_suffix('_'))
            .unwrap_or(self.name)
    }

    /// Compares `name`, the name of a column in a file, with the name of this column. `name` must have the form that
    /// [`spelt`] returns. If the names differ, the result is `None`. If they agree, the result contains the unit at the
    /// end of `name`, if `name` ends with a unit: `x` has none, `x_mm` has mm, and `rotation_x_deg` has degrees.
    pub fn is_named(&self, name: &str) -> Option<Option<ColumnUnit>> {
        if COLUMNS.quaternion.contains(self) {
            return (quaternion_part(name)? == *self).then_some(None);
        }
        // The column of times is named with the abbreviation "t", but files also use the full word "time".
        let is_time = self.measure == Measure::Time && name.starts_with("time");
        let stem = if is_time { "time" } else { self.stem() };
        let rest = name.strip_prefix(stem)?;
        if rest.is_empty() {
            return Some(None);
        }
        let unit = self.measure.unit(rest.strip_prefix('_')?)?;
        (self.measure != Measure::Plain).then_some(Some(unit))
    }
}

/// Converts a name to lower case, with one underscore between words. Letters, digits and degree signs form words; all
/// other characters separate them. A capital letter after two small letters begins a word, as in `normalX`.
pub fn spelt(name: &str) -> String {
    let (mut words, mut small) = (String::new(), 0);
    for letter in name.chars() {
        let is_part = letter.is_alphanumeric() || letter == '\u{b0}';
        let is_start = !is_part || (small > 1 && letter.is_uppercase());
        if is_start && !words.is_empty() && !words.ends_with('_') {
            words.push('_');
        }
        small = if letter.is_lowercase() { small + 1 } else { 0 };
        words.extend(letter.to_lowercase().filter(|_| is_part));
    }
    words.truncate(words.trim_end_matches('_').len());
    words
}

/// The columns of the tables of readings, by the kind of reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadingColumns {
    /// Columns of readings of rolls, with one row per roll.
    pub rolls: [Column; 5],
    /// Columns of a unit quaternion. A file may have these columns instead of those of a rotation vector. `qw` is the
    /// scalar part.
    pub quaternion: [Column; 4],
    /// The nine columns of a file that state a rotation matrix, in the order of its rows. Each column vector of the
    /// matrix is an axis of the probe.
    pub matrix: [Column; 9],
    /// Columns of a rotation, stated as a unit axis and an angle.
    pub axis_angle: [Column; 4],
    /// Columns of a rotation vector. The last column may be missing.
    pub rotation_vector: [Column; 3],
    /// Columns of the contact's position on the probe, in a time series of a roll.
    pub contacts: [Column; 2],
    /// Columns of the contact's position on the probe at the start of a roll, in a time series of the roll. The columns
    /// may be missing.
    pub roll_starts: [Column; 2],
    /// Columns of readings of rolls, if the readings of each roll are a time series.
    pub roll_series: [Column; 6],
    /// Columns of readings of glides, with one row per contact. The last three columns may be missing.
    pub glides: [Column; 7],
    /// Columns of readings of presses, with one row per marker. The last two columns may be missing.
    pub presses: [Column; 5],
    /// Columns of readings of a press whose markers lie on a line through the apex, with one row per marker.
    pub press_row: [Column; 2],
}

/// Columns of one physical quantity.
const fn columns<const N: usize>(names: [&'static str; N], measure: Measure) -> [Column; N] {
    let mut columns = [PROBE; N];
    let mut place = 0;
    while place < N {
        columns[place] = Column::of(names[place], measure);
        place += 1;
    }
    columns
}

const PROBE: Column = Column::of("probe", Measure::Plain);
const FINGER: Column = Column::of("finger", Measure::Plain);
const TIME: Column = Column::of("t_s", Measure::Time);
const ANGLE: Column = Column::of("angle_rad", Measure::Angle);
const DISPLACEMENT: Column = Column::of("normal_displacement", Measure::Length);
const TURNS: [Column; 3] = columns(
    ["rotation_x_rad", "rotation_y_rad", "rotation_z_rad"],
    Measure::Angle,
);
const SHIFTS: [Column; 2] = columns(["shift_u", "shift_v"], Measure::Length);
const PADS: [Column; 2] = columns(["pad_u", "pad_v"], Measure::Length);
const PLACES: [Column; 3] = columns(["x", "y", "z"], Measure::Length);
const NORMALS: [Column; 3] = columns(["normal_x", "normal_y", "normal_z"], Measure::Plain);
const ALONG: [Column; 2] = columns(["tangential_x", "tangential_y"], Measure::Length);
const AXIS: [Column; 3] = columns(["axis_x", "axis_y", "axis_z"], Measure::Plain);

/// The columns of all tables of readings.
pub const COLUMNS: ReadingColumns = ReadingColumns {
    rolls: [PROBE, TURNS[0], TURNS[1], SHIFTS[0], SHIFTS[1]],
    quaternion: columns(["qx", "qy", "qz", "qw"], Measure::Plain),
    matrix: columns(
        [
            "r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33",
        ],
        Measure::Plain,
    ),
    axis_angle: [AXIS[0], AXIS[1], AXIS[2], ANGLE],
    rotation_vector: TURNS,
    contacts: columns(["contact_u", "contact_v"], Measure::Length),
    roll_starts: columns(["start_u", "start_v"], Measure::Length),
    roll_series: [PROBE, TIME, TURNS[0], TURNS[1], PADS[0], PADS[1]],
    glides: [
        FINGER, PLACES[0], PLACES[1], PLACES[2], NORMALS[0], NORMALS[1], NORMALS[2],
    ],
    presses: [PLACES[0], PLACES[1], DISPLACEMENT, ALONG[0], ALONG[1]],
    press_row: [Column::of("radial_position", Measure::Length), DISPLACEMENT],
};

/// The column of `quaternion` in [`COLUMNS`] to which `name` refers, such as `qx`, `quat_x` or `pose_orientation_x`;
/// `None` if it refers to no such column. `name` must have the form that [`spelt`] returns.
pub fn quaternion_part(name: &str) -> Option<Column> {
    let is_quaternion = |prefix: &str| {
        let word = prefix.trim_end_matches('_').rsplit('_').next();
        let is_word = prefix.ends_with('_') || prefix.is_empty() || prefix.ends_with('q');
        let word = word.map(|word| {
            if word.len() > 1 {
                word.trim_end_matches('s')
            } else {
                word
            }
        });
        is_word && matches!(word, Some("q" | "quat" | "quaternion" | "orientation"))
    };
    // The components of a quaternion are also called i, j, k, and r or s for the scalar part.
    let letters = [
        ["x", "i", "x"],
        ["y", "j", "y"],
        ["z", "k", "z"],
        ["w", "r", "s"],
    ];
    let parts = COLUMNS.quaternion.into_iter().zip(letters);
    let is_part = |letter: &str| name.strip_suffix(letter).is_some_and(is_quaternion);
    let mut found = parts.filter(|(_, letters)| letters.iter().any(|letter| is_part(letter)));
    found.next().map(|(column, _)| column)
}

/// The columns `columns` of a table of readings that palpate writes, with lengths in `unit`. If the first column has no
/// unit, it contains the numbers of probes or fingers.
pub fn table_columns(columns: &[Column], unit: LengthUnit) -> Vec<TableColumn> {
    let column = |(place, column): (usize, &Column)| match column.measure {
        Measure::Length => {
            let [length] = TableColumn::in_length([column.name], Unit::Length, unit);
            length
        }
        Measure::Angle => TableColumn::number(column.name, "rad"),
        Measure::Time => TableColumn::number("time_s", "s"),
        _ if place == 0 => TableColumn::count(column.name),
        _ => TableColumn::number(column.name, "1"),
    };
    columns.iter().enumerate().map(column).collect()
}

/// All columns that the readings of this kind of scene may have, without repetitions. The list is empty if the kind has
/// no tables of readings.
pub fn columns_of(kind: &str) -> Vec<Column> {
    let all: &[&[Column]] = match kind {
        "roll" => &[
            &COLUMNS.rolls,
            &COLUMNS.roll_series,
            &COLUMNS.quaternion,
            &COLUMNS.rotation_vector,
            &COLUMNS.matrix,
            &COLUMNS.axis_angle,
            &COLUMNS.contacts,
            &COLUMNS.roll_starts,
        ],
        "glide" => &[&COLUMNS.glides],
        "press" => &[&COLUMNS.presses, &COLUMNS.press_row],
        _ => &[],
    };
    let mut columns: Vec<Column> = Vec::new();
    for column in all.iter().copied().flatten() {
        if !columns.contains(column) {
            columns.push(*column);
        }
    }
    columns
}

/// Checks a map from palpate's names of columns (the keys) to the names in a file, which a study or an option states. A
/// key may end with a unit, such as `x_mm`.
///
/// # Errors
/// [`FieldError`] for a key that is not in `columns`, for an empty name, for two keys that refer to the same
/// column, and for two keys that state the same name.
pub fn check_names(names: &BTreeMap<String, String>, columns: &[Column]) -> Result<(), FieldError> {
    let fault = |key: &str, message: String| Err(FieldError::at(key, message));
    let mut known: Vec<(&str, &str, &str)> = Vec::new();
    for (key, name) in names {
        let Some(column) = of_key(key, columns) else {
            let all: Vec<&str> = columns.iter().map(|column| column.name).collect();
            return fault(
                key,
                match all.is_empty() {
                    true => format!("`{key}` is no column: there are no readings with columns"),
                    false => format!(
                        "`{key}` is no column of these readings; known: {}",
                        all.join(", ")
                    ),
                },
            );
        };
        if name.trim().is_empty() {
            return fault(key, format!("`{key}` has no name"));
        }
        for (other_key, other_column, other_name) in &known {
            if *other_column == column.name {
                return fault(key, format!("`{other_key}` and `{key}` are one column"));
            }
            if other_name.trim() == name.trim() {
                let message = format!("`{other_key}` and `{key}` are both `{}`", name.trim());
                return fault(key, message);
            }
        }
        known.push((key, column.name, name));
    }
    Ok(())
}

/// The column to which `key` refers; `None` if there is none. The key may end with a unit.
pub fn of_key<'a>(key: &str, columns: &'a [Column]) -> Option<&'a Column> {
    let key = spelt(key);
    columns
        .iter()
        .find(|column| column.is_named(&key).is_some())
}
