//! Tests that the schema states the unit of every number exactly once.

use palpate_study::config::schema;
use serde_json::Value;
use std::collections::BTreeMap;

/// Keys of numbers without a unit, and of numbers that have the unit of the field to which they refer.
const DIMENSIONLESS: [&str; 40] = [
    "claims",              // their numbers
    "seed",                //
    "trials",              //
    "instants",            // draws per probe
    "steps",               // of an integrator
    "fraction",            // of the angular speed
    "tolerance",           // relative
    "parameters",          // of a formula, in the unit that it needs
    "from",                // in the unit of the swept field
    "to",                  //
    "count",               //
    "value",               // in the unit of the plot's axis
    "x",                   //
    "y",                   //
    "contacts_per_finger", //
    "rolls",
    "fraction_of_ifd", // of the inter-finger distance
    "position_fraction_of_ifd",
    "grid",             // places along a side
    "intervals",        // of a spline
    "gamma",            // of a criterion
    "first_degree",     // of a spline
    "second_degree",    //
    "passes",           //
    "weight",           // per inter-finger distance
    "smoothing",        // sum of squares in weights
    "second_smoothing", //
    "tangent_step",     // in inter-finger distances
    "gores",            //
    "rows",             // markers of each
    "markers",          //
    "frames",           //
    "poisson",          //
    "gain_std",         // of a factor
    "outline_samples",
    "presses",
    "rest_frames",
    "relative_standard_error",
    "min_trials",
    "max_trials",
];

const UNIT_SUFFIXES: [&str; 7] = ["_rad", "_deg", "_s", "_hz", "_rad_per_s", "_px", "_kpa"];

fn properties(schema: &Value, visit: &mut impl FnMut(&str, &Value)) {
    for variant in schema["oneOf"].as_array().into_iter().flatten() {
        properties(variant, visit);
    }
    for (key, property) in schema["properties"].as_object().into_iter().flatten() {
        visit(key, property);
        properties(property, visit);
    }
    if schema["items"].is_object() {
        properties(&schema["items"], visit);
    }
}

fn is_number(schema: &Value) -> bool {
    let candidates = [schema, &schema["items"], &schema["additionalProperties"]];
    candidates
        .iter()
        .any(|candidate| candidate["type"] == "number" || candidate["type"] == "integer")
}

#[test]
fn every_number_has_a_unit_or_is_known_to_have_none() {
    let mut numbers = 0;
    properties(&schema(), &mut |key, property| {
        if is_number(property) {
            numbers += 1;
            let stated = [
                property.get("x-unit").is_some(),
                UNIT_SUFFIXES.iter().any(|suffix| key.ends_with(suffix)),
                DIMENSIONLESS.contains(&key),
            ];
            assert_eq!(
                stated.iter().filter(|&&stated| stated).count(),
                1,
                "{key}: {property}"
            );
        }
    });
    assert!(numbers > 30, "{numbers}");
}

#[test]
fn units_are_those_that_headers_know() {
    properties(&schema(), &mut |key, property| {
        if let Some(unit) = property.get("x-unit") {
            let known = ["length", "1/length", "1/length^2", "1"];
            assert!(known.iter().any(|known| unit == known), "{key}: {unit}");
        }
    });
}

#[test]
fn every_field_and_kind_is_described() {
    properties(&schema(), &mut |key, property| {
        assert!(
            key == "kind" || property["description"].is_string(),
            "{key}: {property}"
        );
        for variant in property["oneOf"].as_array().into_iter().flatten() {
            assert!(variant["description"].is_string(), "{key}: {variant}");
        }
    });
}

/// Tests a rule: if several kinds of a table have the same key, its unit and its default are the same in all these
/// kinds. Column headers and `to_toml` rely on this rule. Defaults that are tables are not compared, because these
/// tables have kinds themselves.
#[test]
fn kinds_that_share_a_key_share_its_unit_and_default() {
    properties(&schema(), &mut |key, property| {
        let mut seen: BTreeMap<&str, (&Value, Option<&Value>)> = BTreeMap::new();
        for variant in property["oneOf"].as_array().into_iter().flatten() {
            for (name, field) in variant["properties"].as_object().into_iter().flatten() {
                let default = Some(&field["default"]).filter(|default| !default.is_object());
                let now = (&field["x-unit"], default);
                assert_eq!(*seen.entry(name).or_insert(now), now, "{key}.{name}");
            }
        }
    });
}

#[test]
fn the_schema_is_for_editors() {
    let schema = schema();
    assert_eq!(schema["$schema"], "http://json-schema.org/draft-07/schema#");
    assert_eq!(schema["title"], "palpate study");
    let text = schema.to_string();
    assert!(
        !text.contains("null") && !text.contains("$ref") && !text.contains("anyOf"),
        "{text}"
    );
}
