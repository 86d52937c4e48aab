//! Headers of swept fields' columns, read back.

use super::{LengthUnit, schema};
use serde_json::Value as Json;
use std::sync::LazyLock;

/// Name of a swept field without its unit, and the unit as its header has it, from the header of its column; `None` if no
/// field has such a column.
///
/// ```
/// use palpate_study::config::field;
///
/// assert_eq!(field("scene.object.c_per_cm"), Some(("scene.object.c", "per_cm")));
/// assert_eq!(field("scene.motion.rate_rad_per_s"), Some(("scene.motion.rate", "rad_per_s")));
/// assert_eq!(field("scene.object.parameters.half_s"), Some(("scene.object.parameters.half_s", "")));
/// assert_eq!(field("scene.weather_cm"), None);
/// ```
pub fn field(header: &str) -> Option<(&str, &str)> {
    static SCHEMA: LazyLock<Json> = LazyLock::new(schema::schema);
    let split = |unit: &'static str| {
        let stem = header.strip_suffix(unit)?.strip_suffix('_')?;
        Some((stem, &header[stem.len() + 1..]))
    };
    for unit in LENGTHS.into_iter().flatten() {
        let found = split(unit)
            .filter(|(stem, _)| schema::column(&SCHEMA, stem, LengthUnit::Unit) != *stem);
        if found.is_some() {
            return found;
        }
    }
    let keys: Vec<&str> = header.split('.').collect();
    let own = || IN_KEYS.into_iter().find_map(split);
    match known(&SCHEMA, &keys)? {
        true => own().or(Some((header, ""))),
        false => Some((header, "")),
    }
}

/// Ends of headers by the schema's `x-unit`, for each unit of length.
const LENGTHS: [[&str; 3]; 5] = [
    ["per_mm2", "per_mm", "mm"],
    ["per_cm2", "per_cm", "cm"],
    ["per_um2", "per_um", "um"],
    ["per_unit2", "per_unit", "unit"],
    ["per_m2", "per_m", "m"],
];
/// Units that stand in keys.
const IN_KEYS: [&str; 5] = ["rad_per_s", "rad", "deg", "s", "px"];

/// Whether a field is named by the schema, rather than by the one who writes the config; `None` if there is no such field.
fn known(schema: &Json, keys: &[&str]) -> Option<bool> {
    let Some((key, rest)) = keys.split_first() else {
        return Some(true);
    };
    if schema["type"] == "array" {
        return Some(true);
    }
    let variants = schema["oneOf"]
        .as_array()
        .map_or(std::slice::from_ref(schema), Vec::as_slice);
    let named = variants
        .iter()
        .find_map(|variant| known(variant["properties"].get(key)?, rest));
    let free = || {
        variants
            .iter()
            .any(|variant| variant["additionalProperties"].is_object())
    };
    named.or_else(|| free().then_some(false))
}
