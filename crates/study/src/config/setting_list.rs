//! The list of a config table's settings, for a command line or a form, and tables with some settings replaced.

use std::any::TypeId;
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use palpate_statistics::Number;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json};

use super::schema::{schema_of, variant, variants};
use super::validate::{instead_of, kind_of};

/// A setting of a table that has kinds.
///
/// ```
/// use palpate_study::config::{Accepts, PressEstimatorConfig, settings};
///
/// let settings = settings::<PressEstimatorConfig>();
/// let window = settings.iter().find(|setting| setting.key == "window").ok_or("a window")?;
/// assert_eq!(window.kinds, ["gaussian"]);
/// assert!(window.is_length);
/// let Accepts::Number(range) = &window.accepts else {
///     return Err("a number".into());
/// };
/// assert_eq!(range.parse("2.5"), Ok(2.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The key in a config. The first setting is `kind` itself.
    pub key: String,
    /// Kinds that have the setting.
    pub kinds: Vec<String>,
    /// Meaning in words.
    pub help: String,
    /// Values that the setting may have.
    pub accepts: Accepts,
    /// Default value, if there is one.
    pub default: Option<String>,
    /// Whether the setting is a length in the config's unit.
    pub is_length: bool,
}

/// Values that a setting may have.
#[derive(Clone, Debug, PartialEq)]
pub enum Accepts {
    /// A number in a range.
    Number(Range),
    /// One of these words. Each has a meaning.
    Word(Vec<(String, String)>),
}

impl Accepts {
    /// Checks that a number is in the range, or that a text is one of the words. Types are checked when the table is
    /// deserialised.
    fn check(&self, value: &Json) -> Result<(), String> {
        match (self, value) {
            (Self::Number(range), Json::Number(_)) => {
                value.as_f64().map_or(Ok(()), |number| range.check(number))
            }
            (Self::Word(words), Json::String(word)) => {
                let mut known = words.iter().map(|(known, _)| known.as_str());
                if known.clone().any(|known| known == word) {
                    return Ok(());
                }
                let last = known.next_back().unwrap_or_default();
                let others: Vec<&str> = known.collect();
                Err(format!(
                    "must be {} or {last}, is {word:?}",
                    others.join(", ")
                ))
            }
            _ => Ok(()),
        }
    }
}

/// Range of a finite number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    /// Exclusive lower bound.
    pub above: Option<f64>,
    /// Smallest value.
    pub least: Option<f64>,
    /// Largest value.
    pub most: Option<f64>,
    /// Whether the number is an integer.
    pub is_whole: bool,
}

impl Range {
    /// Numbers greater than 0.
    pub const POSITIVE: Self = Self {
        above: Some(0.0),
        least: None,
        most: None,
        is_whole: false,
    };

    /// Numbers from 0.
    pub const NOT_NEGATIVE: Self = Self {
        above: None,
        least: Some(0.0),
        ..Self::POSITIVE
    };

    /// Parses a number and checks that it is in the range.
    ///
    /// # Errors
    /// The violated condition, as a text that follows the name of the setting.
    pub fn parse(&self, text: &str) -> Result<f64, String> {
        let number: f64 = text.parse().map_err(|_| "is not a number".to_owned())?;
        match self.holds(number) {
            true => Ok(number),
            false => Err(format!("must be {self}, is {text}")),
        }
    }

    /// Whether a number is in the range.
    pub fn holds(&self, number: f64) -> bool {
        number.is_finite()
            && (!self.is_whole || number == libm::trunc(number))
            && self.above.is_none_or(|bound| number > bound)
            && self.least.is_none_or(|least| number >= least)
            && self.most.is_none_or(|most| number <= most)
    }

    /// Checks a number.
    ///
    /// # Errors
    /// The same as for [`Range::parse`].
    pub fn check(&self, number: f64) -> Result<(), String> {
        match self.holds(number) {
            true => Ok(()),
            false => Err(format!("must be {self}, is {}", Number(number))),
        }
    }

    fn from_schema(schema: &Json) -> Self {
        let limit = |key: &str| schema[key].as_f64();
        Self {
            above: limit("exclusiveMinimum"),
            least: limit("minimum"),
            most: limit("maximum"),
            is_whole: schema["type"] == "integer",
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |bound: Option<f64>| bound.map(Number);
        let number = if self.is_whole { "a whole number " } else { "" };
        match [self.above, self.least, self.most].map(shown) {
            [None, Some(least), Some(most)] => write!(f, "{number}from {least} to {most}"),
            [Some(above), _, Some(most)] => write!(f, "{number}> {above} and <= {most}"),
            [Some(above), _, None] => write!(f, "finite and > {above}"),
            [None, Some(least), None] => write!(f, "finite and >= {least}"),
            [None, None, Some(most)] => write!(f, "finite and <= {most}"),
            [None, None, None] => f.write_str("finite"),
        }
    }
}

/// Schema and settings of a type of tables.
struct TableInfo {
    schema: Json,
    settings: Vec<Setting>,
}

/// Cache: creating a schema takes longer than many estimates.
static CACHE: LazyLock<Mutex<HashMap<TypeId, Arc<TableInfo>>>> = LazyLock::new(Mutex::default);

fn table_info<T: JsonSchema + 'static>() -> Arc<TableInfo> {
    let mut all = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    let info = all.entry(TypeId::of::<T>()).or_insert_with(|| {
        let schema = schema_of::<T>();
        let settings = settings_in(&schema);
        Arc::new(TableInfo { schema, settings })
    });
    Arc::clone(info)
}

/// All settings of a table that has kinds, in the order of the kinds.
pub fn settings<T: JsonSchema + 'static>() -> Vec<Setting> {
    table_info::<T>().settings.clone()
}

fn settings_in(schema: &Json) -> Vec<Setting> {
    let mut settings: Vec<Setting> = vec![Setting {
        key: "kind".to_owned(),
        kinds: Vec::new(),
        help: text(&schema["description"]),
        accepts: Accepts::Word(Vec::new()),
        default: None,
        is_length: false,
    }];
    for variant in variants(schema) {
        let Some(kind) = kind_of(variant) else {
            continue;
        };
        settings[0].kinds.push(kind.to_owned());
        if let Accepts::Word(words) = &mut settings[0].accepts {
            words.push((kind.to_owned(), text(&variant["description"])));
        }
        let properties = variant["properties"].as_object().into_iter().flatten();
        for (key, schema) in properties.filter(|(key, _)| *key != "kind") {
            match settings.iter_mut().find(|setting| setting.key == *key) {
                Some(setting) => setting.kinds.push(kind.to_owned()),
                None => settings.push(Setting::from_schema(key, kind, schema)),
            }
        }
    }
    settings
}

impl Setting {
    fn from_schema(key: &str, kind: &str, schema: &Json) -> Self {
        let word = |word: &Json| {
            let name = word["const"].as_str()?.to_owned();
            Some((name, text(&word["description"])))
        };
        let words: Vec<_> = variants(schema).iter().filter_map(word).collect();
        Self {
            key: key.to_owned(),
            kinds: vec![kind.to_owned()],
            help: text(&schema["description"]),
            accepts: match words.is_empty() {
                true => Accepts::Number(Range::from_schema(schema)),
                false => Accepts::Word(words),
            },
            default: match &schema["default"] {
                Json::Null => None,
                Json::String(word) => Some(word.clone()),
                other => Some(
                    other
                        .as_f64()
                        .map_or(other.to_string(), |one| one.to_string()),
                ),
            },
            is_length: schema["x-unit"] == "length",
        }
    }
}

fn text(json: &Json) -> String {
    json.as_str().unwrap_or_default().replace('\n', " ")
}

/// Reasons why a table cannot have a setting.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingError {
    /// The table's kind does not have the setting.
    #[error("`{key}` is of use only to kind {}", kinds.join(" or "))]
    Useless {
        /// Key of the setting.
        key: String,
        /// Kinds that have the setting.
        kinds: Vec<String>,
    },
    /// Two settings are alternatives to each other.
    #[error("`{key}` cannot stand beside `{other}`; give one of them")]
    Both {
        /// Key of the first setting.
        key: String,
        /// Key of the second setting.
        other: String,
    },
    /// The setting cannot have the value.
    #[error("`{key}`: {message}")]
    Bad {
        /// Key of the setting; empty if several settings do not fit together.
        key: String,
        /// Problem in words.
        message: String,
    },
}

/// A table with some settings replaced. Alternatives to these settings are removed. If `kind` is replaced, settings that both
/// kinds have keep their values.
///
/// ```
/// use palpate_study::config::{GlideEstimatorConfig, with_settings};
///
/// let given = serde_json::json!({ "gamma": 2.0 });
/// let given = given.as_object().ok_or("a table")?;
/// let smoother = with_settings(&GlideEstimatorConfig::default(), given)?;
/// assert!(matches!(smoother, GlideEstimatorConfig::Penalised { gamma: 2.0, .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SettingError`] if the kind does not have a setting, if a value is out of its range or not one of the words, or if two
/// settings are alternatives.
pub fn with_settings<T>(base: &T, given: &Map<String, Json>) -> Result<T, SettingError>
where
    T: Serialize + DeserializeOwned + JsonSchema + 'static,
{
    let info = table_info::<T>();
    let bad = |key: &str, message: String| SettingError::Bad {
        key: key.to_owned(),
        message,
    };
    let mut table = match serde_json::to_value(base) {
        Ok(Json::Object(table)) => table,
        Ok(_) => Map::new(),
        Err(error) => return Err(bad("", error.to_string())),
    };
    if let Some(kind) = given.get("kind") {
        if let Some(setting) = info.settings.first() {
            let checked = setting.accepts.check(kind);
            checked.map_err(|message| bad("kind", message))?;
        }
        table.insert("kind".to_owned(), kind.clone());
    }
    let kind = table.get("kind").and_then(Json::as_str);
    let variant = variant(&info.schema, kind);
    let properties = variant.and_then(|variant| variant["properties"].as_object());
    let has = |key: &str| properties.is_some_and(|properties| properties.contains_key(key));
    table.retain(|key, _| has(key));
    for (key, value) in given {
        let setting = info.settings.iter().find(|setting| setting.key == *key);
        if !has(key) {
            let kinds = setting.map(|setting| setting.kinds.clone());
            return Err(SettingError::Useless {
                key: key.clone(),
                kinds: kinds.unwrap_or_default(),
            });
        }
        if let Some(setting) = setting {
            let checked = setting.accepts.check(value);
            checked.map_err(|message| bad(key, message))?;
        }
        let property = properties.and_then(|properties| properties.get(key));
        for other in property.into_iter().flat_map(instead_of) {
            if given.contains_key(other) {
                return Err(SettingError::Both {
                    key: key.clone(),
                    other: other.to_owned(),
                });
            }
            table.remove(other);
        }
        table.insert(key.clone(), value.clone());
    }
    serde_path_to_error::deserialize(Json::Object(table))
        .map_err(|error| bad(&error.path().to_string(), error.inner().to_string()))
}

/// The table in another unit of length: lengths are multiplied by the factor, curvatures are divided by it.
///
/// ```
/// use palpate_study::config::{PressModelConfig, in_unit};
///
/// let layer = PressModelConfig::BondedLayer { thickness: 5.0 };
/// assert_eq!(in_unit(&layer, 0.1), PressModelConfig::BondedLayer { thickness: 0.5 });
/// ```
pub fn in_unit<T>(table: &T, factor: f64) -> T
where
    T: Clone + Serialize + DeserializeOwned + JsonSchema + 'static,
{
    let scaled = serde_json::to_value(table).ok().and_then(|mut json| {
        scale(&table_info::<T>().schema, &mut json, factor);
        serde_json::from_value(json).ok()
    });
    scaled.unwrap_or_else(|| table.clone())
}

fn scale(schema: &Json, json: &mut Json, factor: f64) {
    let by = match schema["x-unit"].as_str() {
        Some("length") => factor,
        Some("1/length") => factor.recip(),
        Some("1/length^2") => (factor * factor).recip(),
        _ => 1.0,
    };
    match json {
        Json::Number(number) if by != 1.0 => {
            let scaled = number.as_f64().map(|number| number * by);
            if let Some(scaled) = scaled.and_then(serde_json::Number::from_f64) {
                *number = scaled;
            }
        }
        Json::Array(items) => {
            // The items of an array have the unit of the array.
            let of_items = match by == 1.0 {
                true => &schema["items"],
                false => schema,
            };
            for item in items {
                scale(of_items, item, factor);
            }
        }
        Json::Object(table) => {
            let kind = table.get("kind").and_then(Json::as_str);
            if let Some(variant) = variant(schema, kind) {
                for (key, value) in table.iter_mut() {
                    scale(&variant["properties"][key], value, factor);
                }
            }
        }
        _ => {}
    }
}
