//! Creates and changes configs from code, without a text file.

use serde_json::Value as Json;
use toml::Value as Toml;

use super::error::{ConfigError, Fault};
use super::load::Study;
use super::schema::alternatives;
use super::tree;

/// Converts a JSON table to the text of a config. Keys with the value `null` are omitted.
///
/// ```
/// use palpate_study::config::{of_json, parse};
///
/// let config = serde_json::json!({
///     "name": "roll-on-a-ball",
///     "scene": {
///         "kind": "roll",
///         "probe": { "kind": "sphere", "radius": 1.0 },
///         "object": { "kind": "sphere", "radius": 4.0 },
///         "motion": { "rate_rad_per_s": 0.1, "duration_s": 1.0 },
///         "sensor": null,
///     },
/// });
/// let study = parse("study", &of_json("study", &config)?)?;
/// assert_eq!(study.config.name, "roll-on-a-ball");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ConfigError`] if the value is not a table, or if TOML cannot represent one of its numbers.
pub fn of_json(file: &str, config: &Json) -> Result<String, ConfigError> {
    match value(file, "", config)? {
        Some(table @ Toml::Table(_)) => to_text(file, &table),
        _ => Err(ConfigError::of_field(file, "", "must be a table")),
    }
}

/// Sets fields of a config, and returns the text of the changed config. The path of a field consists of keys and
/// indices joined by dots. The value `null` removes a field. Fields that state the same quantity as a changed field are
/// removed, for example `duration_s` if `arc_length` is set. Fields and values are validated only when the returned
/// text is parsed.
///
/// ```
/// use palpate_study::config::with_fields;
///
/// let pitch = ("scene.sensor.pitch".to_owned(), serde_json::json!(0.2));
/// let text = with_fields("study", "[scene.sensor]\nkind = \"pads\"\n", &[pitch])?;
/// assert_eq!(text, "[scene.sensor]\nkind = \"pads\"\npitch = 0.2\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ConfigError`] if a path leads through a value that is not a table, or if the text is not TOML.
pub fn with_fields(
    file: &str,
    text: &str,
    fields: &[(String, Json)],
) -> Result<String, ConfigError> {
    let mut config = Toml::Table(table(file, text)?);
    for (path, json) in fields {
        let Some(value) = value(file, path, json)? else {
            tree::take(&mut config, path);
            continue;
        };
        for other in alternatives(path) {
            if !fields.iter().any(|(field, _)| *field == other) {
                tree::take(&mut config, &other);
            }
        }
        let refused = |message| ConfigError::of_field(file, path, message);
        for (end, _) in path.match_indices('.') {
            if tree::at(&config, &path[..end]).is_none() {
                let empty = Toml::Table(toml::Table::new());
                tree::set(&mut config, &path[..end], empty).map_err(refused)?;
            }
        }
        tree::set(&mut config, path, value).map_err(refused)?;
    }
    to_text(file, &config)
}

/// Adds a sweep axis for each field in `axes`, and returns the text of the changed config. `axes` contains the path and
/// the values of each field.
///
/// ```
/// use palpate_study::config::with_axes;
///
/// let radii = ("scene.object.radius".to_owned(), serde_json::json!([20.0, 40.0]));
/// let text = with_axes("study", "name = \"balls\"\n", &[radii])?;
/// let axis = "[[sweep]]\npath = \"scene.object.radius\"\nvalues = [20.0, 40.0]\n";
/// assert_eq!(text, format!("name = \"balls\"\n\n{axis}"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Errors of [`with_fields`].
pub fn with_axes(file: &str, text: &str, axes: &[(String, Json)]) -> Result<String, ConfigError> {
    let mut config = table(file, text)?;
    let sweep = config
        .entry("sweep")
        .or_insert_with(|| Toml::Array(Vec::new()));
    let Toml::Array(sweep) = sweep else {
        let message = "must be a list of tables";
        return Err(ConfigError::of_field(file, "sweep", message));
    };
    for (path, values) in axes {
        let Some(values @ Toml::Array(_)) = value(file, path, values)? else {
            let message = "must be swept over a list of values";
            return Err(ConfigError::of_field(file, path, message));
        };
        let mut axis = toml::Table::new();
        axis.insert("path".to_owned(), Toml::String(path.clone()));
        axis.insert("values".to_owned(), values);
        sweep.push(Toml::Table(axis));
    }
    to_text(file, &Toml::Table(config))
}

fn table(file: &str, text: &str) -> Result<toml::Table, ConfigError> {
    let refused = |error: toml::de::Error| ConfigError::of_field(file, "", error.message());
    text.parse().map_err(refused)
}

fn to_text(file: &str, table: &Toml) -> Result<String, ConfigError> {
    let refused = |error: toml::ser::Error| ConfigError::of_field(file, "", error.to_string());
    toml::to_string(table).map_err(refused)
}

/// Converts a JSON value to TOML; `None` for `null`.
pub(super) fn value(file: &str, path: &str, json: &Json) -> Result<Option<Toml>, ConfigError> {
    let under = |key: &dyn std::fmt::Display| match path {
        "" => key.to_string(),
        path => format!("{path}.{key}"),
    };
    Ok(Some(match json {
        Json::Null => return Ok(None),
        Json::Bool(value) => Toml::Boolean(*value),
        Json::String(text) => Toml::String(text.clone()),
        Json::Number(number) => match (number.as_i64(), number.is_u64()) {
            (Some(whole), _) => Toml::Integer(whole),
            (None, true) => {
                let message = format!("must be at most {}, is {number}", i64::MAX);
                return Err(ConfigError::of_field(file, path, message));
            }
            (None, false) => Toml::Float(number.as_f64().unwrap_or(f64::NAN)),
        },
        Json::Array(items) => {
            let items = items.iter().enumerate();
            let items = items.map(|(place, item)| value(file, &under(&place), item));
            let items: Result<Vec<Option<Toml>>, _> = items.collect();
            Toml::Array(items?.into_iter().flatten().collect())
        }
        Json::Object(table) => {
            let mut items = toml::Table::new();
            for (key, item) in table {
                if let Some(item) = value(file, &under(key), item)? {
                    items.insert(key.clone(), item);
                }
            }
            Toml::Table(items)
        }
    }))
}

impl Study {
    /// Replaces the seed and the number of trials of all cells. `None` keeps the number of the config.
    ///
    /// # Errors
    /// [`ConfigError`] if the config sweeps a replaced number, if a new number is too large for a TOML integer, or if
    /// the new number of trials is 0.
    pub fn override_numbers(
        &mut self,
        seed: Option<u64>,
        trials: Option<u64>,
    ) -> Result<(), ConfigError> {
        if let Some(seed) = seed {
            self.check_override("seed", seed, 0)?;
            self.config.seed = seed;
        }
        if let Some(trials) = trials {
            self.check_override("trials", trials, 1)?;
            self.config.trials = trials;
        }
        Ok(())
    }

    fn check_override(&self, key: &str, value: u64, least: u64) -> Result<(), ConfigError> {
        let target = self.grid.targets().find(|target| target.path == key);
        let message = match target {
            Some(_) => format!("is swept, and so cannot be set to {value}"),
            None if (least..=i64::MAX as u64).contains(&value) => return Ok(()),
            None => format!("must be between {least} and {}, is {value}", i64::MAX),
        };
        let fault = match target {
            Some(target) => target.fault(message),
            None => Fault::new(message),
        };
        let path = key.into();
        Err(self.source.error(Fault { path, ..fault }))
    }
}
