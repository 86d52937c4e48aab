//! Reads the columns of tables: the unit of each column, and its values as numbers or texts.

use palpate_study::config::{self, LengthUnit, Study};
use palpate_study::{Column, ColumnType, Label, Rows};

/// Endings of column names, each with the unit that it states.
const UNITS: [(&str, &str); 8] = [
    ("_rad", "rad"),
    ("_rad_per_s", "rad/s"),
    ("_deg_per_s", "deg/s"),
    ("_deg", "deg"),
    ("_s", "s"),
    ("_px", "px"),
    ("_px_per_rad", "px/rad"),
    ("_turns", "turn"),
];

/// Values of a column, one value per row.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers. An empty field is NaN.
    Numbers(Vec<f64>),
    /// Texts. A column contains texts if its stated type is text, or if at least one of its fields is not a number.
    Texts(Vec<String>),
}

/// Column of a swept field. `place` is the index of the field among the swept fields of the study.
pub(crate) fn swept_column(study: &Study, place: usize) -> Column {
    let (path, name) = (&study.paths[place], &study.columns[place]);
    let values = study.swept_kind(place);
    let has_unit = values != ColumnType::Text && !path.contains(".parameters.");
    Column {
        values,
        unit: has_unit.then(|| unit_of_field(name, study.config.length_unit)),
        name: name.clone(),
    }
}

fn unit_of_field(header: &str, length_unit: LengthUnit) -> String {
    let (_, tail) = config::field(header);
    let of_tail = unit_of(&format!("_{tail}"), length_unit);
    of_tail.unwrap_or_else(|| {
        let label = Label::of_field(header);
        match label.unit.as_str() {
            "°" => "deg".to_owned(),
            "turns" => "turn".to_owned(),
            // If `label.factor` is not 1, axes and messages show the field in percent. Tables contain the field as a
            // share, whose unit is 1.
            unit if unit.is_empty() || label.factor != 1.0 => "1".to_owned(),
            unit => unit.to_owned(),
        }
    })
}

/// Columns of a table in CSV text; the numbers keep every digit. `known` are columns that the table may have, with
/// their units; all other columns have no unit.
///
/// ```
/// use palpate::{Column, Values, columns};
///
/// let known = [Column::count("cell"), Column::number("shift_px", "px"), Column::text("failure")];
/// let found = columns("cell,shift_px,failure\n0,1.5,\n1,,slipped\n", &known)?;
/// assert_eq!(found[1].0.unit.as_deref(), Some("px"));
/// assert!(matches!(&found[1].1, Values::Numbers(shifts) if shifts[0] == 1.5 && shifts[1].is_nan()));
/// assert_eq!(found[2].1, Values::Texts(vec!["".to_owned(), "slipped".to_owned()]));
/// assert!(columns("cell,failure\n0\n", &known).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`csv::Error`] for a row whose number of fields differs from the header's.
pub fn columns(text: &str, known: &[Column]) -> Result<Vec<(Column, Values)>, csv::Error> {
    let mut rows = Rows::new(text.as_bytes(), true);
    let column = |name: String| {
        let known = known.iter().find(|column| column.name == name);
        known.cloned().unwrap_or_else(|| name.into())
    };
    let columns: Vec<Column> = rows.header()?.into_iter().map(column).collect();
    // Read all rows before choosing the type of a column, because a swept field or an unknown column may have a text
    // even in the last row.
    let is_numeric = |column: &Column| column.values != ColumnType::Text;
    let mut are_numbers: Vec<bool> = columns.iter().map(is_numeric).collect();
    while let Some((_, row)) = rows.next_row()? {
        for (are_numbers, field) in are_numbers.iter_mut().zip(row) {
            *are_numbers = *are_numbers && number(field).is_some();
        }
    }
    let empty = |are_numbers| match are_numbers {
        true => Values::Numbers(Vec::new()),
        false => Values::Texts(Vec::new()),
    };
    let mut all: Vec<Values> = are_numbers.into_iter().map(empty).collect();
    let mut rows = Rows::new(text.as_bytes(), true);
    while let Some((_, row)) = rows.next_row()? {
        for (values, field) in all.iter_mut().zip(row) {
            match values {
                Values::Numbers(numbers) => numbers.extend(number(field)),
                Values::Texts(texts) => texts.push(field.to_owned()),
            }
        }
    }
    Ok(columns.into_iter().zip(all).collect())
}

/// Unit that the ending of a column's name states. This unit is used only if nothing else states the unit.
pub fn unit_of(name: &str, length_unit: LengthUnit) -> Option<String> {
    let length = length_unit.as_str();
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
    // A column's name may match several endings in `UNITS`, for example `_s` and `_rad_per_s`. Use the longest one.
    let longest = ending.max_by_key(|(suffix, _)| suffix.len());
    longest.map(|(_, unit)| unit)
}

/// The number in a field: NaN if the field is empty, `None` if the field contains a text.
fn number(field: &str) -> Option<f64> {
    match field {
        "" => Some(f64::NAN),
        field => field.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swept_fields_have_the_unit_of_their_numbers() {
        let unit = |header| unit_of_field(header, LengthUnit::Mm);
        assert_eq!(unit("scene.object.radius_mm"), "mm");
        assert_eq!(unit("scene.motion.contact_deg.0"), "deg");
        assert_eq!(unit("scene.noise.angular_velocity.fraction"), "1");
        assert_eq!(unit("scene.noise.pixel.std"), "levels of 255");
        assert_eq!(unit("scene.noise.hue.std"), "turn");
        assert_eq!(unit("scene.noise.centroid.std"), "px");
        assert_eq!(unit("scene.sensor.size_px"), "px");
        assert_eq!(unit("seed"), "1");
    }
}
