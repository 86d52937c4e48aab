//! Values of `--set` and `--vary` as the config has them: in the unit of their field, and tables with a label.

use super::error::ConfigError;
use super::load::Study;
use super::schema::{SCHEMA, unit_of};
use super::study::LengthUnit;
use super::sweep::rounded;
use super::vary::{Takes, Varied, Vary};
use toml::Value as Toml;

/// Units of numbers whose key ends with a unit, with the factor to that unit.
const UNITS_BY_KEY: [(&str, &[(&str, f64)]); 5] = [
    ("_rad_per_s", &[("rad/s", 1.0), ("deg/s", DEG)]),
    (
        "_rad",
        &[("rad", 1.0), ("mrad", 1e-3), ("deg", DEG), ("°", DEG)],
    ),
    (
        "_deg",
        &[
            ("deg", 1.0),
            ("°", 1.0),
            ("rad", 1.0 / DEG),
            ("mrad", 1e-3 / DEG),
        ],
    ),
    ("_s", &[("s", 1.0), ("ms", 1e-3), ("min", 60.0)]),
    ("_px", &[("px", 1.0)]),
];

/// A degree in radians.
const DEG: f64 = std::f64::consts::PI / 180.0;

/// Number and unit that a text such as `8mm` states; `None` if the text does not begin with a finite number.
pub(super) fn measure(text: &str) -> Option<(f64, &str)> {
    let ends = text.char_indices().map(|(end, _)| end).chain([text.len()]);
    let ends: Vec<usize> = ends.collect();
    let number = |&end: &usize| {
        Some((
            text[..end].trim_end().parse::<f64>().ok()?,
            text[end..].trim(),
        ))
    };
    let found = ends.iter().rev().find_map(number);
    found.filter(|(number, _)| number.is_finite())
}

/// Units that a field may be given in, with the factors to its own unit.
fn units_of(path: &str, length: LengthUnit) -> Vec<(String, f64)> {
    let keys: Vec<&str> = path.split('.').collect();
    let power = match unit_of(&SCHEMA, &keys) {
        Some("length") => 1,
        Some("1/length") => -1,
        Some("1/length^2") => -2,
        _ => 0,
    };
    if power != 0 {
        let units = LengthUnit::ALL
            .into_iter()
            .filter(|unit| *unit != LengthUnit::Unit);
        return units
            .filter_map(|unit| {
                let name = match power {
                    1 => unit.as_str().to_owned(),
                    -1 => format!("/{}", unit.as_str()),
                    _ => format!("/{}^2", unit.as_str()),
                };
                Some((name, unit.to(length)?.powi(power)))
            })
            .collect();
    }
    // The index of an item is no key.
    let key = keys.iter().rev().find(|key| key.parse::<usize>().is_err());
    let by_key = UNITS_BY_KEY
        .iter()
        .find(|(end, _)| key.is_some_and(|key| key.ends_with(end)));
    let units = by_key.map_or(&[("%", 0.01)][..], |(_, units)| units);
    units
        .iter()
        .map(|(name, factor)| ((*name).to_owned(), *factor))
        .collect()
}

impl Study {
    /// The field that an argument means, by its path, with its values in the unit of the field.
    ///
    /// ```
    /// use palpate_study::config::{Varied, parse};
    ///
    /// let text = r#"
    ///     name = "roll-on-a-ball"
    ///     length_unit = "cm"
    ///     scene.kind = "roll"
    ///     scene.probe = { kind = "sphere", radius = 1.0 }
    ///     scene.object = { kind = "sphere", radius = 4.0 }
    ///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
    /// "#;
    /// let study = parse("study.toml", text)?;
    /// let vary = study.resolve(&"object.radius=20mm..5".parse()?)?;
    /// assert_eq!(vary.path, "scene.object.radius");
    /// assert_eq!(vary.values, Varied::Range { from: 2.0, to: 5.0 });
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ConfigError`] if the name means no field or several, or if the field does not have a value's unit.
    pub fn resolve(&self, vary: &Vary) -> Result<Vary, ConfigError> {
        let listed = match &vary.values {
            Varied::Listed(values) => values,
            range @ Varied::Range { .. } => {
                let (path, values) = (self.path_of(&vary.path)?, range.clone());
                return Ok(Vary { path, values });
            }
        };
        let ends = match listed.as_slice() {
            [Toml::String(text)] => text.split_once(".."),
            _ => None,
        };
        if let Some((from, to)) = ends {
            let (path, ends) = self.resolve_values(&vary.path, &[from.into(), to.into()])?;
            let ends: Vec<f64> = ends.iter().filter_map(as_number).collect();
            match *ends.as_slice() {
                [from, to] if from <= to => {
                    let values = Varied::Range { from, to };
                    return Ok(Vary { path, values });
                }
                [_, _] => {
                    let message =
                        format!("the range {from}..{to} runs downwards; write {to}..{from}");
                    return Err(ConfigError::of_field(self.file(), &path, message));
                }
                _ => {}
            }
        }
        let (path, listed) = self.resolve_values(&vary.path, listed)?;
        let values = Varied::Listed(listed);
        Ok(Vary { path, values })
    }

    /// Path of the field that a name means, and values in the unit of the field. A table without a label gets one.
    ///
    /// # Errors
    /// As [`Study::resolve`].
    pub fn resolve_values(
        &self,
        name: &str,
        values: &[Toml],
    ) -> Result<(String, Vec<Toml>), ConfigError> {
        let path = self.path_of(name)?;
        let values: Result<Vec<Toml>, String> = values
            .iter()
            .map(|value| match value {
                Toml::Table(table) => Ok(labelled(table, values)),
                value => self.in_field_unit(&path, value),
            })
            .collect();
        match values {
            Ok(values) => Ok((path, values)),
            Err(message) => Err(ConfigError::of_field(self.file(), &path, message)),
        }
    }

    /// Fields with one value each, as [`Study::resolve_values`] has them.
    ///
    /// # Errors
    /// As [`Study::resolve`].
    pub fn resolve_each(
        &self,
        fields: &[(String, Toml)],
    ) -> Result<Vec<(String, Toml)>, ConfigError> {
        let fields = fields.iter().map(|(name, value)| {
            let (path, values) = self.resolve_values(name, std::slice::from_ref(value))?;
            Ok(values.into_iter().map(move |value| (path.clone(), value)))
        });
        let fields: Result<Vec<_>, ConfigError> = fields.collect();
        Ok(fields?.into_iter().flatten().collect())
    }

    /// Value in the unit of a field, if it is a text with a unit and the field is a number.
    fn in_field_unit(&self, path: &str, value: &Toml) -> Result<Toml, String> {
        let text = match value {
            Toml::String(text) => text,
            Toml::Array(items) => {
                let path = format!("{path}.0");
                let items = items.iter().map(|item| self.in_field_unit(&path, item));
                return items.collect::<Result<_, _>>().map(Toml::Array);
            }
            other => return Ok(other.clone()),
        };
        let takes = self.takes(path);
        let Some((number, unit)) =
            measure(text).filter(|_| !matches!(takes, None | Some(Takes::Other)))
        else {
            return Ok(value.clone());
        };
        let number = match unit {
            "" => number,
            unit => {
                // `µm` may be written as `um`, and `1/mm` as `/mm`.
                let plain = unit.replace(['µ', 'μ'], "u").replace("1/", "/");
                let units = units_of(path, self.config.length_unit);
                let factor = units.iter().find(|(name, _)| *name == plain);
                let Some((_, factor)) = factor else {
                    let message = match units.as_slice() {
                        [] => "the config states no `length_unit`; leave the unit out".to_owned(),
                        units => {
                            let names: Vec<&str> =
                                units.iter().map(|(name, _)| name.as_str()).collect();
                            format!("its unit may be {}", names.join(", "))
                        }
                    };
                    return Err(format!("{text:?} has the unit {unit:?}; {message}"));
                };
                rounded(number * factor)
            }
        };
        Ok(match takes == Some(Takes::Whole) && number.fract() == 0.0 {
            true => Toml::Integer(number as i64),
            false => Toml::Float(number),
        })
    }
}

fn as_number(value: &Toml) -> Option<f64> {
    match value {
        Toml::Integer(number) => Some(*number as f64),
        Toml::Float(number) => Some(*number),
        _ => None,
    }
}

/// Table with a label: its kind, or its text if another of the values has the same kind.
fn labelled(table: &toml::Table, values: &[Toml]) -> Toml {
    let mut table = table.clone();
    if !table.contains_key("label") {
        let kind = table.get("kind");
        let of_kind = values.iter().filter(|other| other.get("kind") == kind);
        let label = match kind {
            Some(Toml::String(kind)) if of_kind.count() == 1 => kind.clone(),
            _ => Toml::Table(table.clone()).to_string(),
        };
        table.insert("label".to_owned(), label.into());
    }
    Toml::Table(table)
}
