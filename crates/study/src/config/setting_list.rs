//! Lists the settings of a config table, so that a command line or a form can offer them, and replaces settings of a
//! table.

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

/// A setting of a config table.
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
    /// Key of the setting in a config. If the table has kinds, the first setting is `kind` itself.
    pub key: String,
    /// Kinds of the table (values of its key `kind`) that have this setting; empty if the table does not have kinds.
    pub kinds: Vec<String>,
    /// Meaning of the setting in words.
    pub help: String,
    /// The values that the setting accepts.
    pub accepts: Accepts,
    /// Default value as text; `None` if the schema states none.
    pub default: Option<String>,
    /// Whether the value is a length in the config's unit.
    pub is_length: bool,
}

/// The values that a setting accepts.
#[derive(Clone, Debug, PartialEq)]
pub enum Accepts {
    /// A number in a range.
    Number(Range),
    /// Words to choose from, each with its meaning.
    Word(Vec<(String, String)>),
    /// A vector with this number of components, 2 or 3.
    Vector(usize),
}

impl Accepts {
    /// Checks the value of a setting: a number must be in its range, and a word must be one of the choices. The type of
    /// the value is checked later, when the table is read.
    fn check(&self, key: &str, value: &Json) -> Result<(), SettingError> {
        match (self, value) {
            (Self::Number(range), Json::Number(number)) => match number.as_f64() {
                Some(number) if !range.holds(number) => {
                    Err(SettingError::of_number(key, number, range))
                }
                _ => Ok(()),
            },
            (Self::Word(words), Json::String(word)) => {
                let words: Vec<&str> = words.iter().map(|(word, _)| word.as_str()).collect();
                if words.contains(&word.as_str()) {
                    return Ok(());
                }
                let words = match words.as_slice() {
                    [others @ .., last] if !others.is_empty() => {
                        format!("{} or {last}", others.join(", "))
                    }
                    all => all.concat(),
                };
                Err(SettingError::new(
                    key,
                    format!("is {word:?}; it must be {words}"),
                ))
            }
            _ => Ok(()),
        }
    }
}

/// Range of the numbers that a setting accepts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    /// Limit that the number must exceed; `None` if there is no such limit.
    pub above: Option<f64>,
    /// Smallest allowed value of the setting; `None` if there is no such limit.
    pub least: Option<f64>,
    /// Largest allowed value of the setting; `None` if there is no such limit.
    pub most: Option<f64>,
    /// Whether the number must be a whole number.
    pub is_whole: bool,
    /// Whether the number may be infinite.
    pub may_be_infinite: bool,
}

impl Range {
    /// Parses a number and checks that it is in the range.
    ///
    /// # Errors
    /// A message that states the required range, as a text that follows the name of the setting.
    pub fn parse(&self, text: &str) -> Result<f64, String> {
        let number: f64 = text.parse().map_err(|_| "is not a number".to_owned())?;
        match self.holds(number) {
            true => Ok(number),
            false => Err(format!("must be {self}, is {text}")),
        }
    }

    pub(crate) fn holds(&self, number: f64) -> bool {
        self.violated(number).is_none()
    }

    /// The requirement that `number` does not meet, in words such as `a whole number`; `None` if `number` is in the
    /// range.
    pub(super) fn violated(&self, number: f64) -> Option<String> {
        if self.may_be_infinite && number == f64::INFINITY {
            return None;
        }
        if !number.is_finite() {
            return Some("finite".to_owned());
        }
        if self.is_whole && number != libm::trunc(number) {
            return Some("a whole number".to_owned());
        }
        let above = self.above.filter(|bound| number <= *bound);
        let least = self.least.filter(|least| number < *least);
        let most = self.most.filter(|most| number > *most);
        let limits = [(">", above), (">=", least), ("<=", most)];
        let mut limits = limits.into_iter();
        limits.find_map(|(sign, limit)| Some(format!("{sign} {}", Number(limit?))))
    }

    pub(super) fn of(schema: &Json) -> Self {
        let limit = |key: &str| schema[key].as_f64();
        Self {
            above: limit("exclusiveMinimum"),
            least: limit("minimum"),
            most: limit("maximum"),
            is_whole: schema["type"] == "integer",
            may_be_infinite: schema["x-infinite"] == true,
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
            [Some(above), _, None] if self.may_be_infinite => write!(f, "> {above}, or inf"),
            [Some(above), _, None] => write!(f, "finite and > {above}"),
            [None, Some(least), None] => write!(f, "finite and >= {least}"),
            [None, None, Some(most)] => write!(f, "finite and <= {most}"),
            [None, None, None] => f.write_str("finite"),
        }
    }
}

/// A config table whose settings can be replaced.
pub trait SettingTable: Clone + Serialize + DeserializeOwned + JsonSchema + 'static {
    /// The table as JSON.
    ///
    /// # Errors
    /// [`SettingError`] if a value of the table has no form in JSON.
    fn to_json(&self) -> Result<Json, SettingError> {
        json_of(self)
    }

    /// Reads the table from JSON.
    ///
    /// # Errors
    /// [`SettingError`] with the path of the value that cannot be read.
    fn from_json(json: Json) -> Result<Self, SettingError> {
        table_of(json)
    }
}

/// Implements the methods of [`SettingTable`] for each type in this crate. With default methods, every crate that
/// replaces settings of these types would compile the conversions again.
macro_rules! setting_tables {
    ($($table:ident),*) => {$(
        impl SettingTable for super::$table {
            fn to_json(&self) -> Result<Json, SettingError> {
                json_of(self)
            }

            fn from_json(json: Json) -> Result<Self, SettingError> {
                table_of(json)
            }
        }
    )*};
}

setting_tables!(
    GlideEstimatorConfig,
    PressConfig,
    PressEstimatorConfig,
    PressModelConfig,
    PressProbeConfig,
    RollEstimatorConfig,
    SceneConfig
);

fn json_of(table: &impl Serialize) -> Result<Json, SettingError> {
    serde_json::to_value(table)
        .map_err(|error| SettingError::new("kind", format!("cannot be read: {error}")))
}

fn table_of<T: DeserializeOwned>(json: Json) -> Result<T, SettingError> {
    serde_path_to_error::deserialize(json).map_err(|error| {
        let reason = format!("cannot be read: {}", error.inner());
        SettingError::new(&error.path().to_string(), reason)
    })
}

struct Known {
    schema: Json,
    settings: Vec<Setting>,
}

/// Cache of the schema and the settings of each type of config table. Without the cache, the schema could take longer
/// to compute than an estimate.
static KNOWN: LazyLock<Mutex<HashMap<TypeId, Arc<Known>>>> = LazyLock::new(Mutex::default);

fn known<T: JsonSchema + 'static>() -> Arc<Known> {
    let mut all = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let known = all.entry(TypeId::of::<T>()).or_insert_with(|| {
        let schema = schema_of::<T>();
        let settings = settings_in(&schema);
        Arc::new(Known { schema, settings })
    });
    Arc::clone(known)
}

/// All settings of a table, in the order of the schema.
pub fn settings<T: JsonSchema + 'static>() -> Vec<Setting> {
    known::<T>().settings.clone()
}

/// The setting with this key in a table; `None` if the table has no such setting.
pub fn setting<T: JsonSchema + 'static>(key: &str) -> Option<Setting> {
    known::<T>().setting(key).cloned()
}

/// Splits settings into two tables: the settings that the config table `T` has, and all others.
pub fn split_settings<T: JsonSchema + 'static>(
    given: &Map<String, Json>,
) -> [Map<String, Json>; 2] {
    let known = known::<T>();
    let (own, others): (Vec<_>, Vec<_>) = given
        .clone()
        .into_iter()
        .partition(|(key, _)| known.setting(key).is_some());
    [own, others].map(Map::from_iter)
}

impl Known {
    fn setting(&self, key: &str) -> Option<&Setting> {
        self.settings.iter().find(|setting| setting.key == key)
    }
}

fn settings_in(schema: &Json) -> Vec<Setting> {
    if schema["properties"].is_object() {
        let properties = schema["properties"].as_object().into_iter().flatten();
        return properties
            .map(|(key, schema)| Setting::of(key, Vec::new(), schema))
            .collect();
    }
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
                None => settings.push(Setting::of(key, vec![kind.to_owned()], schema)),
            }
        }
    }
    settings
}

impl Setting {
    fn of(key: &str, kinds: Vec<String>, schema: &Json) -> Self {
        let words: Vec<_> = variants(schema)
            .iter()
            .filter_map(|word| {
                Some((
                    word["const"].as_str()?.to_owned(),
                    text(&word["description"]),
                ))
            })
            .collect();
        Self {
            key: key.to_owned(),
            kinds,
            help: text(&schema["description"]),
            accepts: match words.is_empty() {
                true if schema["type"] == "array" => {
                    Accepts::Vector(if schema["minItems"] == 2 { 2 } else { 3 })
                }
                true => Accepts::Number(Range::of(schema)),
                false => Accepts::Word(words),
            },
            default: default_text(&schema["default"]),
            is_length: schema["x-unit"] == "length",
        }
    }
}

fn default_text(json: &Json) -> Option<String> {
    match json {
        Json::Null => None,
        Json::String(word) => Some(word.clone()),
        Json::Array(items) => {
            let items: Vec<String> = items.iter().filter_map(default_text).collect();
            Some(items.join(","))
        }
        other => Some(
            other
                .as_f64()
                .map_or(other.to_string(), |number| number.to_string()),
        ),
    }
}

fn text(json: &Json) -> String {
    json.as_str().unwrap_or_default().replace('\n', " ")
}

/// Error of a setting: the setting is missing, or its value is invalid, or it has no effect together with the other
/// settings.
///
/// ```
/// use palpate_study::config::SettingError;
///
/// let error = SettingError::of_number("depth", 25.0, "less than setting `sensor_radius`, 20");
/// assert_eq!(
///     error.to_string(),
///     "setting `depth` is 25; it must be less than setting `sensor_radius`, 20"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("setting `{key}` {reason}")]
pub struct SettingError {
    /// Key of the setting to which the error applies.
    pub key: String,
    /// Value of the setting; `None` if it is not a number.
    pub value: Option<f64>,
    /// Description of the problem, as a text that follows the key. The text names other settings as `` setting `key`
    /// ``.
    pub reason: String,
}

impl SettingError {
    /// Error in the setting with this key.
    pub fn new(key: &str, reason: impl Into<String>) -> Self {
        Self {
            key: key.to_owned(),
            value: None,
            reason: reason.into(),
        }
    }

    /// The error which reports that the number of a setting is invalid. `expected` describes the valid numbers.
    pub fn of_number(key: &str, value: f64, expected: impl fmt::Display) -> Self {
        Self {
            value: Some(value),
            ..Self::new(key, format!("is {}; it must be {expected}", Number(value)))
        }
    }
}

/// Replaces the names of settings in a message by the names in a user interface. A message writes the name of a setting
/// as `` setting `gain_std` ``. For each name, the function `name` returns the text that replaces this form, such as a
/// flag of the command line or a Python argument.
///
/// ```
/// use palpate_study::config::rename_settings;
///
/// let message = "setting `gain_std` is -1; it must be finite and >= 0";
/// let flag = |key: &str| format!("--{}", key.replace('_', "-"));
/// assert_eq!(rename_settings(message, flag), "--gain-std is -1; it must be finite and >= 0");
/// ```
pub fn rename_settings(message: &str, name: impl Fn(&str) -> String) -> String {
    let mut parts = message.split("setting `");
    let mut renamed = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.split_once('`') {
            Some((key, rest)) => renamed += &(name(key) + rest),
            None => renamed = renamed + "setting `" + part,
        }
    }
    renamed
}

/// Returns the table `base` with the `given` settings. Settings of `base` that state the same quantity as a given
/// setting in another way are removed. If another `kind` is given, a setting that both kinds have keeps its value.
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
/// [`SettingError`] that names a setting which the kind does not have, whose value is out of range, or whose word is
/// not one of the choices. Also an error if two given settings state the same quantity.
pub fn with_settings<T: SettingTable>(
    base: &T,
    given: &Map<String, Json>,
) -> Result<T, SettingError> {
    match given.is_empty() {
        true => Ok(base.clone()),
        false => T::from_json(known::<T>().with_settings(base.to_json()?, given)?),
    }
}

impl Known {
    /// Returns the table `base` with the `given` settings: they replace the settings with the same key. Settings that
    /// the kind of the table does not have are removed.
    fn with_settings(&self, base: Json, given: &Map<String, Json>) -> Result<Json, SettingError> {
        let mut table = match base {
            Json::Object(table) => table,
            _ => Map::new(),
        };
        if let Some((setting, kind)) = self.setting("kind").zip(given.get("kind")) {
            setting.accepts.check("kind", kind)?;
            table.insert("kind".to_owned(), kind.clone());
        }
        let kind = table.get("kind").and_then(Json::as_str);
        let variant = variant(&self.schema, kind);
        let properties = variant.and_then(|variant| variant["properties"].as_object());
        let knows = |key: &str| properties.is_some_and(|properties| properties.contains_key(key));
        table.retain(|key, _| knows(key));
        for (key, value) in given {
            let setting = self.setting(key);
            if !knows(key) {
                let kinds = setting.map(|setting| setting.kinds.join(" or "));
                let reason = kinds.map_or("does not exist".to_owned(), |kinds| {
                    format!("has an effect only with setting `kind` {kinds}")
                });
                return Err(SettingError::new(key, reason));
            }
            if let Some(setting) = setting {
                setting.accepts.check(key, value)?;
            }
            let property = properties.and_then(|properties| properties.get(key));
            for other in property.into_iter().flat_map(instead_of) {
                if given.contains_key(other) {
                    let reason =
                        format!("cannot be combined with setting `{other}`; give one of them");
                    return Err(SettingError::new(key, reason));
                }
                table.remove(other);
            }
            table.insert(key.clone(), value.clone());
        }
        Ok(Json::Object(table))
    }
}

/// The table in another unit of length: its lengths are multiplied by `factor`, and its curvatures are divided by
/// `factor`.
///
/// ```
/// use palpate_study::config::{PressModelConfig, in_unit};
///
/// let layer = |thickness| PressModelConfig::BondedLayer { thickness, modulus_kpa: None };
/// assert_eq!(in_unit(&layer(5.0), 0.1), layer(0.5));
/// ```
pub fn in_unit<T: SettingTable>(table: &T, factor: f64) -> T {
    let scaled = table.to_json().ok().and_then(|mut json| {
        scale(&known::<T>().schema, &mut json, factor);
        T::from_json(json).ok()
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
            if let Some(scaled) = number
                .as_f64()
                .and_then(|number| serde_json::Number::from_f64(number * by))
            {
                *number = scaled;
            }
        }
        Json::Array(items) => {
            // A unit of an array also applies to its items.
            let of_items = match by == 1.0 {
                true => &schema["items"],
                false => schema,
            };
            items
                .iter_mut()
                .for_each(|item| scale(of_items, item, factor));
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
