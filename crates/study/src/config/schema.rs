//! The JSON Schema of a config, which also states the units of the keys. Configs are validated against it, and editors
//! use it to complete keys.

use std::sync::LazyLock;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Value as Json, json};

use super::study::{LengthUnit, StudyConfig};
use super::validate::{instead_of, kind_of};

/// The JSON Schema (draft 7) of a study's config, without references.
///
/// `x-unit` states the unit of a number: `length`, `1/length` or `1/length^2`, where the length is in the config's
/// `length_unit`. If the same key has a unit in another table, but is a pure number in this table, its `x-unit` is `1`.
/// `x-instead-of` lists the alternatives of a key, that is, keys that state the same quantity in another way. A config
/// may state only one of them. If a key ends in `_rad`, `_deg`, `_s`, `_rad_per_s` or `_px`, this ending states the
/// unit.
///
/// ```
/// use palpate_study::config::schema;
///
/// let schema = schema();
/// assert_eq!(schema["title"], "palpate study");
/// assert_eq!(schema["properties"]["trials"]["minimum"], 1);
/// assert_eq!(schema["properties"]["length_unit"]["default"], "unit");
/// ```
pub fn schema() -> Json {
    let mut schema = schema_of::<StudyConfig>();
    schema["title"] = json!("palpate study");
    schema
}

pub(super) static SCHEMA: LazyLock<Json> = LazyLock::new(schema);

pub(super) fn schema_of<T: JsonSchema>() -> Json {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings
        .into_generator()
        .into_root_schema_for::<T>()
        .to_value();
    tidy(&mut schema);
    schema
}

/// The variants (`oneOf`) in a schema: the schemas of all kinds of a table, or of all words that a value may be. If the
/// schema has no variants, the result is the schema itself.
pub(super) fn variants(schema: &Json) -> &[Json] {
    schema["oneOf"]
        .as_array()
        .map_or(std::slice::from_ref(schema), Vec::as_slice)
}

/// Removes the type null from a schema, because TOML has no null, and adds the limits of 32-bit numbers.
fn tidy(schema: &mut Json) {
    match schema {
        Json::Object(object) => {
            object.retain(|_, value| !value.is_null());
            if let Some(Json::Array(types)) = object.get_mut("type") {
                types.retain(|name| name != "null");
                if let [single] = &types[..] {
                    let single = single.clone();
                    object.insert("type".into(), single);
                }
            }
            for key in ["enum", "oneOf", "anyOf"] {
                if let Some(Json::Array(variants)) = object.get_mut(key) {
                    variants.retain(|variant| !variant.is_null() && variant["type"] != "null");
                }
            }
            if let Some(Json::Array(variants)) = object.get("anyOf")
                && let [Json::Object(only)] = &variants[..]
            {
                let only = only.clone();
                object.remove("anyOf");
                for (key, value) in only {
                    object.entry(key).or_insert(value);
                }
            }
            if let Some(Json::Array(variants)) = object.remove("anyOf") {
                object.insert("oneOf".into(), Json::Array(flattened(variants)));
            }
            if object.get("format") == Some(&json!("uint32")) {
                object.entry("maximum").or_insert(json!(u32::MAX));
            }
            object.values_mut().for_each(tidy);
        }
        Json::Array(items) => items.iter_mut().for_each(tidy),
        _ => {}
    }
}

/// Merges nested lists of a value's variants (`oneOf` within `oneOf`) into a single list. The merged list accepts the
/// same values, because the variants exclude each other.
fn flattened(variants: Vec<Json>) -> Vec<Json> {
    let alone = |variant: Json| match variant["oneOf"].as_array() {
        Some(inner) => inner.clone(),
        None => vec![variant],
    };
    variants.into_iter().flat_map(alone).collect()
}

/// The variant of a table's schema that describes this `kind`. If `kind` is `None`, the schema of a table without
/// kinds.
pub(super) fn variant<'a>(schema: &'a Json, kind: Option<&str>) -> Option<&'a Json> {
    variants(schema)
        .iter()
        .find(|variant| kind_of(variant) == kind)
}

/// Header of the column of a swept field: the path and the unit of the field, for example `scene.object.c_per_cm`.
pub(super) fn column(schema: &Json, path: &str, unit: LengthUnit) -> String {
    let keys: Vec<&str> = path.split('.').collect();
    let unit = match unit_of(schema, &keys) {
        Some("length") => format!("_{}", unit.as_str()),
        Some("1/length") => format!("_per_{}", unit.as_str()),
        Some("1/length^2") => format!("_per_{}2", unit.as_str()),
        _ => String::new(),
    };
    format!("{path}{unit}")
}

/// Schemas of the field with these `keys`: one schema for each kind of its table that has this field.
pub(super) fn fields_at<'a>(schema: &'a Json, keys: &[&str]) -> Vec<&'a Json> {
    let Some((key, rest)) = keys.split_first() else {
        return vec![schema];
    };
    if schema["type"] == "array" {
        return fields_at(&schema["items"], rest);
    }
    let properties = variants(schema).iter();
    let properties = properties.filter_map(|variant| variant["properties"].get(key));
    properties
        .flat_map(|property| fields_at(property, rest))
        .collect()
}

/// The unit of a field; `None` if the field has no unit. A table may have several kinds, which have different fields. A
/// field has the same unit in all kinds that have it. The items of an array have the unit of the array.
pub(super) fn unit_of<'a>(schema: &'a Json, keys: &[&str]) -> Option<&'a str> {
    let unit = |field: &'a Json| field["x-unit"].as_str();
    let parents = (1..=keys.len()).rev();
    let mut fields = parents.flat_map(|end| fields_at(schema, &keys[..end]));
    fields.find_map(unit)
}

/// Paths of the fields that state the same quantity as the field at `path` in another way, for all kinds of tables. A
/// config must not state two of these fields.
pub(super) fn alternatives(path: &str) -> Vec<String> {
    let keys: Vec<&str> = path.split('.').collect();
    let Some((parent, _)) = path.rsplit_once('.') else {
        return Vec::new();
    };
    let fields = fields_at(&SCHEMA, &keys).into_iter();
    let mut all: Vec<&str> = fields.flat_map(instead_of).collect();
    all.sort_unstable();
    all.dedup();
    all.iter().map(|key| format!("{parent}.{key}")).collect()
}

/// Whether a field accepts only whole numbers. A table may have several kinds, which have different fields. The answer
/// is the same for all kinds that have the field.
pub(super) fn is_whole(schema: &Json, keys: &[&str]) -> bool {
    let field = fields_at(schema, keys).into_iter().next();
    field.is_some_and(|field| field["type"] == "integer")
}

pub(super) const fn whole<const N: u32>() -> u32 {
    N
}

pub(super) const fn count<const N: u64>() -> u64 {
    N
}

pub(super) fn number<const N: u32>() -> f64 {
    f64::from(N)
}
