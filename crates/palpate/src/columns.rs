//! Tables by columns, as other programs take them.

use palpate_study::Table;
use palpate_study::config::LengthUnit;

/// Units that names of columns end with, and how they are written.
const UNITS: [(&str, &str); 6] = [
    ("_rad", "rad"),
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

/// Values of a column, one per row.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; `None` where the field is empty.
    Numbers(Vec<Option<f64>>),
    /// Texts of a column in which some field is no number.
    Texts(Vec<String>),
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
    let column = |(place, name): (usize, &String)| Column {
        name: name.clone(),
        unit: unit_of(name, length_unit.as_str()),
        values: values(table.rows.iter().map(|row| row[place].as_str())),
    };
    table.header.iter().enumerate().map(column).collect()
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
    let number = |field: &str| match field {
        "" => Ok(None),
        field => field.parse().map(Some),
    };
    let numbers: Result<Vec<Option<f64>>, std::num::ParseFloatError> =
        fields.clone().map(number).collect();
    numbers.map_or_else(
        |_| Values::Texts(fields.map(str::to_owned).collect()),
        Values::Numbers,
    )
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
