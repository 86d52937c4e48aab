//! Converts the values of `--set` and `--vary`. A number with a unit is converted to the unit of its field. A TOML
//! table gets a label, which the results show instead of the table.

use super::error::ConfigError;
use super::load::Study;
use super::schema::{SCHEMA, unit_of};
use super::study::LengthUnit;
use super::sweep::rounded;
use super::tree::as_number;
use super::vary::{Takes, Varied, Vary};
use crate::readings::Measure;
use toml::Value as Toml;

/// Splits a text such as `8mm` into its number and its unit. Returns `None` if the text does not begin with a finite
/// number.
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

/// Unit of a field, as a power of a basic unit: `/mm^2` is the basic unit mm with the power −2. `around` contains the
/// texts before and after the basic unit, here `/` and `^2`.
struct FieldUnit {
    measure: Measure,
    around: [&'static str; 2],
    power: i32,
    /// Factor that converts a number from the base unit of the physical quantity (for example rad for an angle) to the
    /// unit of the field.
    factor: f64,
}

impl FieldUnit {
    /// Unit of the field at a path; `None` if the field is a pure number.
    fn of(path: &str) -> Option<Self> {
        let keys: Vec<&str> = path.split('.').collect();
        // Drop array indices from the path, because the schema has only keys.
        let key = keys
            .iter()
            .rev()
            .find(|key| key.parse::<usize>().is_err())?;
        let (measure, around, power, factor) = match unit_of(&SCHEMA, &keys) {
            Some("length") => (Measure::Length, ["", ""], 1, 1.0),
            Some("1/length") => (Measure::Length, ["/", ""], -1, 1.0),
            Some("1/length^2") => (Measure::Length, ["/", "^2"], -2, 1.0),
            _ if key.ends_with("_rad_per_s") => (Measure::Angle, ["", "/s"], 1, 1.0),
            _ if key.ends_with("_rad") => (Measure::Angle, ["", ""], 1, 1.0),
            _ if key.ends_with("_deg_per_s") => (Measure::Angle, ["", "/s"], 1, 1_f64.to_degrees()),
            _ if key.ends_with("_deg") => (Measure::Angle, ["", ""], 1, 1_f64.to_degrees()),
            _ if key.ends_with("_s") => (Measure::Time, ["", ""], 1, 1.0),
            _ if key.ends_with("_px") => (Measure::Pixel, ["", ""], 1, 1.0),
            _ => return None,
        };
        Some(Self {
            measure,
            around,
            power,
            factor,
        })
    }

    /// Factor that converts a number in `unit` to the unit of the field; `None` if the units do not match. `length` is
    /// the unit of lengths in the config.
    fn factor_from(&self, unit: &str, length: LengthUnit) -> Option<f64> {
        let [before, after] = self.around;
        let unit = unit.strip_prefix(before)?.strip_suffix(after)?;
        Some(self.measure.unit(unit)?.to(length)?.powi(self.power) * self.factor)
    }

    fn names(&self) -> String {
        let [before, after] = self.around;
        let separator = format!("{after}, {before}");
        let names = self.measure.units().replace(", ", &separator);
        format!("{before}{names}{after}")
    }
}

impl Study {
    /// Finds the field to which the name in `vary` refers, and converts the values in `vary` to the unit of this field.
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
    /// [`ConfigError`] if the name refers to no field or to several, or if a value has a unit that the field cannot
    /// have.
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

    /// Returns the path of the field to which `name` refers, and `values` in the unit of this field. A value that is a
    /// TOML table without a label gets a label, which the results show instead of the table.
    ///
    /// # Errors
    /// The same errors as [`Study::resolve`].
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

    /// Converts the names and values of several fields in the same way as [`Study::resolve_values`]. Each field has one
    /// value.
    ///
    /// # Errors
    /// The same errors as [`Study::resolve`].
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

    /// If `value` is a text with a unit, such as `8mm`, converts it to a number in the unit of the field at `path`.
    /// Returns any other value unchanged.
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
                let length = self.config.length_unit;
                let of_field = FieldUnit::of(path);
                // `1/mm` may be written as `/mm`.
                let plain = unit.replace("1/", "/");
                let factor = match &of_field {
                    Some(of_field) => of_field.factor_from(&plain, length),
                    None => (plain == "%").then_some(0.01),
                };
                let Some(factor) = factor else {
                    let message = match of_field {
                        Some(of_field)
                            if of_field.measure == Measure::Length
                                && length == LengthUnit::Unit =>
                        {
                            "the config states no `length_unit`; leave the unit out".to_owned()
                        }
                        Some(of_field) => format!("its unit may be {}", of_field.names()),
                        None => "its unit may be %".to_owned(),
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

/// Adds a label to a value that is a TOML table, because the results show the label instead of the table. The label is
/// the kind of the table. If another of the `values` has the same kind, the label is the text of the table.
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
