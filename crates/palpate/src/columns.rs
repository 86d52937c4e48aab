//! Tables by columns, as other programs take them.

use palpate_study::config::{self, LengthUnit, Study, SweptKind};
use palpate_study::{Label, Rows, Table};

/// Units that names of columns end with, and how they are written.
const UNITS: [(&str, &str); 7] = [
    ("_rad", "rad"),
    ("_rad_per_s", "rad/s"),
    ("_deg", "deg"),
    ("_s", "s"),
    ("_px", "px"),
    ("_px_per_rad", "px/rad"),
    ("_turns", "turn"),
];

/// Column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the table's header, which ends with the unit.
    pub name: String,
    /// Unit of all its numbers; `None` where they have none, or each row its own (in `cells.csv` that of the column
    /// `unit`).
    pub unit: Option<String>,
    /// One value per row.
    pub values: Values,
}

impl Column {
    /// Name of the column without the length unit of its table: `x` for `x_mm`; `rotation_x_rad` is unchanged.
    pub fn stem(&self, length_unit: LengthUnit) -> &str {
        let length = length_unit.as_str();
        let endings = [
            format!("_per_{length}2"),
            format!("_per_{length}"),
            format!("_{length}"),
        ];
        let stem = endings.iter().find_map(|end| self.name.strip_suffix(end));
        stem.unwrap_or(&self.name)
    }
}

/// Values of a column, one per row.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; `None` where the field is empty.
    Numbers(Vec<Option<f64>>),
    /// Texts of a column that is of texts, or in which some field is no number.
    Texts(Vec<String>),
}

/// Column of a table that a run fills row by row: what is known of it before the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnType {
    /// Name in the table's header.
    pub name: String,
    /// Kind of its values.
    pub kind: ValueKind,
    /// Unit of all its numbers, `1` of pure numbers; [`ColumnType::UNIT_OF_ROW`] where each row has its own. `None` of
    /// texts, and of parameters of a formula, which alone knows.
    pub unit: Option<String>,
}

/// Kind of the values of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueKind {
    /// Numbers.
    Number,
    /// Whole numbers.
    Whole,
    /// Whole numbers that are not negative: counts, and numbers of cells and trials.
    Count,
    /// Texts.
    Text,
}

/// Columns of counts, and of numbers by which things are told apart.
const COUNTS: [&str; 7] = [
    "cell",
    "trial",
    "trials",
    "failures",
    "count",
    "first_trial",
    "region",
];
/// Columns of texts.
const TEXTS: [&str; 6] = ["quantity", "unit", "kind", "failure", "class", "true_class"];
/// Columns of pure numbers among those whose other numbers have the unit of their row.
const SHARES: [&str; 5] = [
    "relative_rms_error",
    "relative_mean_abs_error",
    "coverage50",
    "coverage80",
    "coverage95",
];

impl ColumnType {
    /// Unit of numbers of which the column `unit` tells that of each row.
    pub const UNIT_OF_ROW: &'static str = "column unit";

    /// Column of a swept field, by its place among those of the study.
    pub(crate) fn of_swept(study: &Study, place: usize) -> Self {
        let (path, name) = (&study.paths[place], &study.columns[place]);
        let kind = match study.swept_kind(place) {
            SweptKind::Number => ValueKind::Number,
            SweptKind::Whole => ValueKind::Whole,
            SweptKind::Text => ValueKind::Text,
        };
        let is_known = kind != ValueKind::Text && !path.contains(".parameters.");
        Self {
            kind,
            unit: is_known.then(|| unit_of_field(name, study.config.length_unit)),
            name: name.clone(),
        }
    }

    /// Column of a table that has the unit of its numbers in a column `unit`.
    pub(crate) fn beside_unit(name: &str) -> Self {
        let column = Self::named(name, LengthUnit::Unit);
        let is_pure = column.kind != ValueKind::Number || SHARES.contains(&name);
        Self {
            unit: match is_pure {
                true => column.unit,
                false => Some(Self::UNIT_OF_ROW.to_owned()),
            },
            ..column
        }
    }

    /// Column of a table whose names end with their unit.
    pub(crate) fn named(name: &str, length_unit: LengthUnit) -> Self {
        let kind = if COUNTS.contains(&name) {
            ValueKind::Count
        } else if TEXTS.contains(&name) {
            ValueKind::Text
        } else {
            ValueKind::Number
        };
        let unit = || unit_of(name, length_unit.as_str()).unwrap_or_else(|| "1".to_owned());
        Self {
            name: name.to_owned(),
            kind,
            unit: (kind != ValueKind::Text).then(unit),
        }
    }
}

/// Unit of a swept field, by the header of its column.
fn unit_of_field(header: &str, length_unit: LengthUnit) -> String {
    let (_, tail) = config::field(header);
    let of_tail = unit_of(&format!("_{tail}"), length_unit.as_str());
    of_tail.unwrap_or_else(|| {
        let label = Label::of_field(header);
        match label.unit.as_str() {
            "°" => "deg".to_owned(),
            "turns" => "turn".to_owned(),
            // Shares, which readers see in percent.
            unit if unit.is_empty() || label.factor != 1.0 => "1".to_owned(),
            unit => unit.to_owned(),
        }
    })
}

/// Columns of a table whose lengths are in `length_unit`, with every digit of their numbers.
///
/// ```
/// use palpate::{Values, columns};
/// use palpate::config::LengthUnit;
///
/// let text = r#"
/// name = "a-ball"
/// length_unit = "mm"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 40.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let trace = palpate::trace(&palpate::parse("a-ball.toml", text)?, 0, None)?;
/// let columns = columns(&trace.readings, LengthUnit::Mm);
/// assert_eq!((columns[3].name.as_str(), columns[3].unit.as_deref()), ("shift_u_mm", Some("mm")));
/// assert_eq!((columns[0].name.as_str(), columns[0].unit.as_deref()), ("probe", None));
/// assert!(matches!(&columns[3].values, Values::Numbers(shifts) if shifts.len() == 8));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn columns(table: &Table, length_unit: LengthUnit) -> Vec<Column> {
    let column = |(place, name): (usize, &String)| {
        let fields = table.rows.iter().map(|row| row[place].as_str());
        Column {
            name: name.clone(),
            unit: unit_of(name, length_unit.as_str()),
            values: match TEXTS.contains(&name.as_str()) {
                true => Values::Texts(fields.map(str::to_owned).collect()),
                false => values(fields),
            },
        }
    };
    table.header.iter().enumerate().map(column).collect()
}

/// Columns of a table that is CSV text, as [`columns`] has them.
///
/// ```
/// use palpate::{Values, columns_of_csv};
/// use palpate::config::LengthUnit;
///
/// let columns = columns_of_csv("cell,shift_mm,failure\n0,1.5,\n1,,slipped\n", LengthUnit::Mm)?;
/// assert_eq!((columns[1].unit.as_deref(), &columns[1].values), (Some("mm"), &Values::Numbers(vec![Some(1.5), None])));
/// assert_eq!(columns[2].values, Values::Texts(vec!["".to_owned(), "slipped".to_owned()]));
/// assert!(columns_of_csv("cell,kind\n0\n", LengthUnit::Mm).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`csv::Error`] for a row that has not as many fields as the header.
pub fn columns_of_csv(text: &str, length_unit: LengthUnit) -> Result<Vec<Column>, csv::Error> {
    let mut rows = Rows::new(text.as_bytes());
    let header = rows.header()?;
    // Which other columns are numbers is known behind the last row.
    let is_of_texts = |name: &String| TEXTS.contains(&name.as_str());
    let mut are_numbers: Vec<bool> = header.iter().map(|name| !is_of_texts(name)).collect();
    while let Some((_, row)) = rows.next_row()? {
        for (are_numbers, field) in are_numbers.iter_mut().zip(row) {
            *are_numbers &= number(field).is_some();
        }
    }
    let mut all: Vec<Values> = are_numbers
        .into_iter()
        .map(|are_numbers| match are_numbers {
            true => Values::Numbers(Vec::new()),
            false => Values::Texts(Vec::new()),
        })
        .collect();
    let mut rows = Rows::new(text.as_bytes());
    while let Some((_, row)) = rows.next_row()? {
        for (values, field) in all.iter_mut().zip(row) {
            match values {
                Values::Numbers(numbers) => numbers.push(number(field).flatten()),
                Values::Texts(texts) => texts.push(field.to_owned()),
            }
        }
    }
    let column = |(name, values): (String, Values)| Column {
        unit: unit_of(&name, length_unit.as_str()),
        name,
        values,
    };
    Ok(header.into_iter().zip(all).map(column).collect())
}

/// Unit that the name of a column ends with.
fn unit_of(name: &str, length: &str) -> Option<String> {
    let of_length = [
        (format!("_per_{length}2"), format!("1/{length}^2")),
        (format!("_per_{length}"), format!("1/{length}")),
        (format!("_{length}"), length.to_owned()),
    ];
    let of_length = of_length.into_iter();
    let others = UNITS.map(|(suffix, unit)| (suffix.to_owned(), unit.to_owned()));
    let ending = of_length
        .chain(others)
        .filter(|(suffix, _)| name.ends_with(suffix));
    // Of the endings that fit the longest counts.
    let longest = ending.max_by_key(|(suffix, _)| suffix.len());
    longest.map(|(_, unit)| unit)
}

fn values<'a>(fields: impl Iterator<Item = &'a str> + Clone) -> Values {
    let numbers: Option<Vec<Option<f64>>> = fields.clone().map(number).collect();
    numbers.map_or_else(
        || Values::Texts(fields.map(str::to_owned).collect()),
        Values::Numbers,
    )
}

/// Number of a field, inside `None` where it is empty; `None` where it is a text.
fn number(field: &str) -> Option<Option<f64>> {
    match field {
        "" => Some(None),
        field => field.parse().ok().map(Some),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_end_with_their_unit() {
        for (name, unit) in [
            ("scene.object.radius_mm", Some("mm")),
            ("gaussian_curvature_std_per_mm2", Some("1/mm^2")),
            ("mean_curvature_per_mm", Some("1/mm")),
            ("camera_px_per_rad", Some("px/rad")),
            ("t_s", Some("s")),
            ("rotation_x_rad", Some("rad")),
            ("hue_turns", Some("turn")),
            ("normal_x", None),
            ("failures", None),
        ] {
            assert_eq!(unit_of(name, "mm").as_deref(), unit, "{name}");
        }
    }

    #[test]
    fn swept_fields_have_the_unit_of_their_numbers() {
        for (header, unit) in [
            ("scene.object.radius_mm", "mm"),
            ("scene.object.c_per_mm", "1/mm"),
            ("scene.motion.rate_rad_per_s", "rad/s"),
            ("scene.motion.duration_s", "s"),
            ("scene.motion.contact_deg.0", "deg"),
            ("scene.noise.angular_velocity.fraction", "1"),
            ("scene.noise.pixel.std", "levels of 255"),
            ("scene.noise.hue.std", "turn"),
            ("scene.noise.centroid.std", "px"),
            ("scene.sensor.size_px", "px"),
            ("scene.probe.layout.gores", "1"),
            ("seed", "1"),
        ] {
            assert_eq!(unit_of_field(header, LengthUnit::Mm), unit, "{header}");
        }
    }

    #[test]
    fn a_word_makes_a_column_of_texts() {
        let fields = |fields: &[&'static str]| values(fields.iter().copied());
        assert_eq!(
            fields(&["1", "", "2e-3"]),
            Values::Numbers(vec![Some(1.0), None, Some(2e-3)])
        );
        assert_eq!(
            fields(&["1", "ball"]),
            Values::Texts(vec!["1".to_owned(), "ball".to_owned()])
        );
    }
}
