//! Fields whose values come from the command line (`--vary` and `--set`) instead of the config.

use super::config_output::to_toml;
use super::error::{ConfigError, Source};
use super::field_value::measure;
use super::load::{Study, read};
use super::schema::{SCHEMA, alternatives, fields_at};
use super::study::{Output, StudyConfig};
use super::sweep::SweepConfig;
use super::validate;
use std::str::FromStr;

/// An argument that states a field and its values, such as `scene.sensor.pitch=0.05..2` or
/// `scene.sensor.normal_from=hue,both`. The path of the field has the same form as in a sweep.
///
/// ```
/// use palpate_study::config::{Varied, Vary};
///
/// let vary: Vary = "scene.sensor.pitch=0.05..2".parse()?;
/// assert_eq!(vary.path, "scene.sensor.pitch");
/// assert_eq!(vary.values, Varied::Range { from: 0.05, to: 2.0 });
/// let vary: Vary = "scene.sensor.normal_from=hue,both".parse()?;
/// assert_eq!(vary.values, Varied::Listed(vec!["hue".into(), "both".into()]));
/// let error = "scene.sensor.pitch=2..0.05".parse::<Vary>().expect_err("runs downwards");
/// assert_eq!(error.to_string(), "the range 2..0.05 runs downwards; write 0.05..2");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Vary {
    /// Path of the field: keys and array indices joined by dots.
    pub path: String,
    /// Values that the field gets instead of its value in the config.
    pub values: Varied,
}

/// Values of a varied field. A range whose ends have units, such as `1mm..2mm`, is stored as a text in `Listed` until
/// [`Study::resolve`] converts it.
#[derive(Debug, Clone, PartialEq)]
pub enum Varied {
    /// A range of numbers between two finite ends. The second end is not smaller than the first.
    Range {
        /// Lower end of the range of the field's values.
        from: f64,
        /// Upper end of the range of the field's values.
        to: f64,
    },
    /// A list of at least one value.
    Listed(Vec<toml::Value>),
}

/// Reason why the text of an argument (`PATH=VALUES`) is invalid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum VaryError {
    /// The text contains no field or no values.
    #[error(
        "{0:?} is not of the form PATH=LO..HI or PATH=A,B,C, such as scene.sensor.pitch=0.05..2"
    )]
    NoValues(String),
    /// An end of a range is not a finite number.
    #[error(
        "the range {range} needs a finite number on each side of `..`, but {end:?} is not a finite number"
    )]
    NoNumber {
        /// The range as the user wrote it.
        range: String,
        /// The end of the range that is not a finite number, as the user wrote it.
        end: String,
    },
    /// The first end of a range is larger than the second.
    #[error("the range {0}..{1} runs downwards; write {1}..{0}")]
    Downwards(String, String),
}

/// Type of the values that a config field accepts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// Any number.
    Number,
    /// Whole numbers.
    Whole,
    /// Other values: words, Booleans, lists or tables.
    Other,
}

impl FromStr for Vary {
    type Err = VaryError;

    fn from_str(text: &str) -> Result<Self, VaryError> {
        let no_values = || VaryError::NoValues(text.to_owned());
        let (path, values) = text.split_once('=').ok_or_else(no_values)?;
        let (path, values) = (path.trim(), values.trim());
        if path.is_empty() || path.contains(char::is_whitespace) || values.is_empty() {
            return Err(no_values());
        }
        let is_quoted = values.contains(['"', '\'', '{', '[']);
        let values = match values.split_once("..").filter(|_| !is_quoted) {
            Some((from, to)) => range(values, from, to)?,
            None => Varied::Listed(listed(values).ok_or_else(no_values)?),
        };
        Ok(Self {
            path: path.to_owned(),
            values,
        })
    }
}

fn range(range: &str, from: &str, to: &str) -> Result<Varied, VaryError> {
    let has_unit = |end: &str| measure(end.trim()).is_some_and(|(_, unit)| !unit.is_empty());
    if [from, to].iter().all(|end| measure(end.trim()).is_some())
        && (has_unit(from) || has_unit(to))
    {
        return Ok(Varied::Listed(vec![range.into()]));
    }
    let number = |end: &str| {
        let number = end.trim().parse().ok();
        number
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| VaryError::NoNumber {
                range: range.to_owned(),
                end: end.trim().to_owned(),
            })
    };
    let ends = (number(from)?, number(to)?);
    match ends {
        (from, to) if from <= to => Ok(Varied::Range { from, to }),
        _ => Err(VaryError::Downwards(from.trim().into(), to.trim().into())),
    }
}

/// Parses values as a TOML list without brackets. If this fails, parses them as words without quotation marks. `None`
/// if there are no values.
fn listed(values: &str) -> Option<Vec<toml::Value>> {
    let parsed = |text: &str| -> Option<Vec<toml::Value>> {
        let list: toml::Value = format!("[{text}]").parse().ok()?;
        list.as_array().cloned()
    };
    let word = |text: &str| match parsed(text).as_deref() {
        Some([value]) => value.clone(),
        _ => text.into(),
    };
    let values = parsed(values).unwrap_or_else(|| {
        let words = values.split(',').map(str::trim);
        words.filter(|text| !text.is_empty()).map(word).collect()
    });
    (!values.is_empty()).then_some(values)
}

impl Study {
    /// Returns the study with additional sweep axes for `fields`. The new axes vary faster than the existing axes. They
    /// replace the values of the same fields in the config and its sweeps. Fields that state the same quantity in
    /// another way are removed. The new study has no plots, no claims and no stopping rule, and its only output is the
    /// table of cells.
    ///
    /// Errors state the config file and the field. They state no line, because the values are not in the file.
    ///
    /// ```
    /// use palpate_study::config::parse;
    ///
    /// let text = r#"
    ///     name = "roll-on-a-ball"
    ///     scene.kind = "roll"
    ///     scene.probe = { kind = "sphere", radius = 1.0 }
    ///     scene.object = { kind = "sphere", radius = 4.0 }
    ///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
    ///     sweep = [{ path = "scene.object.radius", values = [2.0, 4.0] }]
    /// "#;
    /// let study = parse("study.toml", text)?;
    /// // Defaults can be set, too.
    /// let pads = [("scene.sensor".to_owned(), vec![toml::toml! {
    ///     label = "pads"
    ///     kind = "pads"
    ///     pitch = 0.1
    /// }.into()])];
    /// let with_pads = study.varied(&pads)?;
    /// assert_eq!(with_pads.cell(1)?.coordinates, ["4", "pads"]);
    /// let one = study.varied(&[("scene.object.radius".to_owned(), vec![3.0.into()])])?;
    /// assert_eq!(one.cell_count(), 1);
    /// let error = study.varied(&[("scene.object.radios".to_owned(), vec![3.0.into()])]);
    /// assert!(error.expect_err("a typo").to_string().starts_with("study.toml: scene.object.radios: "));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The same errors as [`parse`](super::parse), but without a line.
    pub fn varied(&self, fields: &[(String, Vec<toml::Value>)]) -> Result<Study, ConfigError> {
        let is_varied = |path: &str| {
            let mut fields = fields.iter().map(|(field, _)| field);
            fields.any(|field| {
                let rest = path.strip_prefix(field.as_str());
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
                    || alternatives(field).iter().any(|one| one == path)
            })
        };
        let mut sweep: Vec<SweepConfig> = self.config.sweep.to_vec();
        sweep.retain_mut(|axis| {
            axis.forget(is_varied);
            axis.targets().next().is_some()
        });
        sweep.extend(fields.iter().map(|(path, values)| SweepConfig {
            path: Some(path.clone()),
            values: Some(values.clone()),
            ..SweepConfig::default()
        }));
        let config = StudyConfig {
            sweep,
            plot: Vec::new(),
            claims: Vec::new(),
            outputs: vec![Output::Cells],
            stop: None,
            ..self.config.clone()
        };
        read(Source::made(self.file(), &to_toml(&config)))
    }

    /// Type of the values that a field accepts in the first cell of the study; `None` if no scene has such a field.
    pub fn takes(&self, path: &str) -> Option<Takes> {
        let keys: Vec<&str> = path.split('.').collect();
        let in_any_kind = || fields_at(&SCHEMA, &keys).into_iter().next();
        let schema = validate::at(&SCHEMA, &self.first_tree(), path).or_else(in_any_kind)?;
        Some(match schema["type"].as_str() {
            Some("number") => Takes::Number,
            Some("integer") => Takes::Whole,
            _ => Takes::Other,
        })
    }
}

impl SweepConfig {
    /// Removes from this sweep axis all fields for whose paths `is_out` returns true.
    fn forget(&mut self, is_out: impl Fn(&str) -> bool) {
        if self.path.as_deref().is_some_and(&is_out) {
            self.path = None;
        }
        if let Some(ranges) = &mut self.ranges {
            ranges.retain(|path, _| !is_out(path));
        }
        let Some(paths) = &mut self.paths else { return };
        let count = paths.len();
        for place in (0..paths.len()).rev() {
            if !is_out(&paths[place]) {
                continue;
            }
            paths.remove(place);
            for row in self.values.iter_mut().flatten() {
                if let toml::Value::Array(row) = row
                    && place < row.len()
                {
                    row.remove(place);
                }
            }
        }
        if let (true, Some(rows)) = (paths.len() < count, &mut self.values) {
            let mut distinct = Vec::new();
            rows.retain(|row| {
                let is_new = !distinct.contains(row);
                distinct.extend(is_new.then(|| row.clone()));
                is_new
            });
        }
    }
}
