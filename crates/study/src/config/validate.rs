//! Validates the tree of a config against a JSON Schema. All messages about keys, types and limits are in this file.

use super::error::Fault;
use super::infinite_length::is_infinite;
use super::setting_list::Range;
use super::tree::{as_number, child, describe, nearest, suggest, text};
use serde_json::Value as Json;
use toml::Value;

/// Pattern of a name that can be used as a file name.
pub(super) const NAME: &str = "^[a-z0-9]+(-[a-z0-9]+)*$";

/// Checks a tree against a schema in the form that [`super::schema()`] returns. Only the parts of JSON Schema that
/// occur in this form are supported: `oneOf` for the kinds of a table and for choices of words, alternative keys,
/// objects, arrays, numbers and strings, but no references. The error is the first fault in the order of the text.
pub(super) fn validate(schema: &Json, node: &Value) -> Result<(), Fault> {
    if let Some(variants) = schema["oneOf"].as_array() {
        let tables = variants.iter().any(|variant| kind_of(variant).is_some());
        let words = words(variants).next().is_some();
        return match (tables, node) {
            (true, Value::String(_)) if words => choice(variants, node),
            (true, _) => tagged(variants, node),
            (false, _) => choice(variants, node),
        };
    }
    match schema["type"].as_str() {
        Some("object") => object(schema, &[], node),
        Some("array") => array(schema, node),
        Some("number") => number(schema, node),
        Some("integer") => match node {
            Value::Integer(_) => number(schema, node),
            _ => Err(wrong_type("an integer", node)),
        },
        Some("boolean") => match node {
            Value::Boolean(_) => Ok(()),
            _ => Err(wrong_type("true or false", node)),
        },
        Some("string") => string(schema, node),
        _ => Ok(()),
    }
}

/// The schema of the field at a path of keys and array indices. The tree states the kind of each table on the path (key
/// `kind`), and each kind has its own schema. `None` if the stated kinds have no such field.
pub(super) fn at<'a>(schema: &'a Json, tree: &Value, path: &str) -> Option<&'a Json> {
    let (mut schema, mut node) = (schema, Some(tree));
    for key in path.split('.') {
        let kind = node.and_then(|node| node.get("kind")?.as_str());
        if let Some(variants) = schema["oneOf"].as_array() {
            schema = variants.iter().find(|variant| kind_of(variant) == kind)?;
        }
        schema = match schema["type"] == "array" {
            true => schema.get("items"),
            false => {
                let any = schema.get("additionalProperties");
                let named = schema["properties"].get(key);
                named.or_else(|| any.filter(|any| any.is_object()))
            }
        }?;
        node = node.and_then(|node| child(node, key));
    }
    Some(schema)
}

/// The kind that `variant`, a schema of a table, describes; `None` for a table without kinds.
pub(super) fn kind_of(variant: &Json) -> Option<&str> {
    variant["properties"]["kind"]["const"].as_str()
}

/// Keys of the same table that state the same quantity as `field` in another way. A config may state only one of them.
pub(super) fn instead_of(field: &Json) -> impl Iterator<Item = &str> {
    let names = field["x-instead-of"].as_array();
    names.into_iter().flatten().filter_map(Json::as_str)
}

/// The words that a value may have, from the variants of its schema.
fn words(variants: &[Json]) -> impl Iterator<Item = &str> {
    variants
        .iter()
        .filter_map(|variant| variant["const"].as_str())
}

fn wrong_type(expected: &str, node: &Value) -> Fault {
    Fault::new(format!("expected {expected}, found {}", describe(node)))
}

fn tagged(variants: &[Json], node: &Value) -> Result<(), Fault> {
    let Value::Table(_) = node else {
        let words: Vec<String> = words(variants).map(|word| format!("{word:?}")).collect();
        let expected = match words.is_empty() {
            true => "a table with `kind`".to_owned(),
            false => format!("{} or a table with `kind`", words.join(", ")),
        };
        return Err(wrong_type(&expected, node));
    };
    let kinds: Vec<&str> = variants.iter().filter_map(kind_of).collect();
    let Some(kind) = node.get("kind") else {
        let message = format!("missing key, one of {}", kinds.join(", "));
        return Err(Fault::new(message).under("kind"));
    };
    let Some(name) = kind.as_str() else {
        return Err(wrong_type("a string", kind).under("kind"));
    };
    let is_meant = |variant: &&Json| kind_of(variant) == Some(name);
    let variant = variants.iter().find(is_meant);
    let unknown = || not_among("unknown kind", name, &kinds).under("kind");
    object(variant.ok_or_else(unknown)?, variants, node)
}

fn choice(variants: &[Json], node: &Value) -> Result<(), Fault> {
    let Some(text) = node.as_str() else {
        return Err(wrong_type("a string", node));
    };
    let known: Vec<&str> = words(variants).collect();
    if known.contains(&text) {
        Ok(())
    } else {
        let mut fault = not_among("unknown choice", text, &known);
        let kinds: Vec<&str> = variants.iter().filter_map(kind_of).collect();
        if !kinds.is_empty() {
            fault.message += &format!(", or a table whose `kind` is one of {}", kinds.join(", "));
        }
        Err(fault)
    }
}

fn not_among(what: &str, word: &str, known: &[&str]) -> Fault {
    let nearest = nearest(word, known.iter().copied());
    let did_you_mean = nearest.map_or_else(String::new, |word| format!("; did you mean `{word}`?"));
    Fault::new(format!(
        "{what} {word:?}{did_you_mean} (known: {})",
        known.join(", ")
    ))
}

/// Checks a table against its schema. `others` are the schemas of the table's other kinds; messages use them for hints.
fn object(schema: &Json, others: &[Json], node: &Value) -> Result<(), Fault> {
    let Value::Table(table) = node else {
        return Err(wrong_type("a table", node));
    };
    let properties = schema["properties"].as_object();
    for (key, value) in table {
        match properties.and_then(|properties| properties.get(key)) {
            Some(property) => match other_of(property, table, key) {
                Some(other) => {
                    let message = format!("cannot be combined with `{other}`; keep one of them");
                    Err(Fault::new(message).under(key))
                }
                None => validate(property, value).map_err(|fault| fault.under(key)),
            },
            None if schema["additionalProperties"] == false => {
                let known = properties
                    .into_iter()
                    .flat_map(|properties| properties.keys().map(String::as_str));
                let of_kind =
                    kind_of(schema).map_or(String::new(), |kind| format!(" for kind `{kind}`"));
                let elsewhere = match kinds_with(others, key).as_slice() {
                    [] => String::new(),
                    [kind] => format!("; kind `{kind}` has it"),
                    kinds => format!("; kinds {} have it", kinds.join(", ")),
                };
                let hint = suggest(key, known);
                let message = format!("unknown key{of_kind}; {hint}{elsewhere}");
                Err(Fault::of_key(key, message))
            }
            None => {
                validate(&schema["additionalProperties"], value).map_err(|fault| fault.under(key))
            }
        }?;
    }
    let required = schema["required"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Json::as_str);
    match required.into_iter().find(|key| !table.contains_key(*key)) {
        Some(key) => {
            let property = &schema["properties"][key];
            let is_table = property["type"] == "object" || property["oneOf"][0]["type"] == "object";
            let what = if is_table { "table" } else { "key" };
            Err(Fault::new(format!("missing {what}")).under(key))
        }
        None => Ok(()),
    }
}

pub(super) fn kinds_with<'a>(variants: &'a [Json], key: &str) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for variant in variants {
        if variant["properties"].get(key).is_some() {
            found.extend(kind_of(variant));
        }
    }
    found
}

/// A key that is stated before `key` in the same table, and that states the same quantity in another way; `None` if
/// there is no such key.
fn other_of<'a>(property: &'a Json, table: &toml::Table, key: &str) -> Option<&'a str> {
    let before: Vec<&String> = table.keys().take_while(|other| *other != key).collect();
    instead_of(property).find(|other| before.iter().any(|earlier| earlier == other))
}

fn array(schema: &Json, node: &Value) -> Result<(), Fault> {
    let Value::Array(items) = node else {
        let expected = match schema["items"]["type"] == "object" {
            true => "an array of tables, in [[double]] brackets",
            false => "an array",
        };
        return Err(wrong_type(expected, node));
    };
    let length = items.len() as u64;
    let min = schema["minItems"].as_u64().unwrap_or(0);
    let max = schema["maxItems"].as_u64().unwrap_or(u64::MAX);
    if !(min..=max).contains(&length) {
        let at_least = if min == max { "" } else { "at least " };
        let plural = if min == 1 { "" } else { "s" };
        let message = format!("expected {at_least}{min} item{plural}, found {length}");
        return Err(Fault::new(message));
    }
    for (index, item) in items.iter().enumerate() {
        validate(&schema["items"], item).map_err(|fault| fault.under(index))?;
    }
    Ok(())
}

fn number(schema: &Json, node: &Value) -> Result<(), Fault> {
    let range = Range::of(schema);
    if range.may_be_infinite && is_infinite(node.as_str()) {
        return Ok(());
    }
    let Some(number) = as_number(node) else {
        return Err(wrong_type("a number", node));
    };
    match range.violated(number) {
        Some(rule) => Err(Fault::new(format!("must be {rule}, is {}", text(node)))),
        None => Ok(()),
    }
}

fn string(schema: &Json, node: &Value) -> Result<(), Fault> {
    let Some(text) = node.as_str() else {
        return Err(wrong_type("a string", node));
    };
    // The only pattern in the schema is the pattern of a name, so no regular expression is needed to check it.
    if schema.get("pattern").is_some() && !is_kebab_case(text) {
        let message = format!(
            "{text:?} is not a name: lower-case letters and digits, joined by single hyphens, at most 100"
        );
        return Err(Fault::new(message));
    }
    Ok(())
}

fn is_kebab_case(text: &str) -> bool {
    text.len() <= 100
        && text.split('-').all(|part| {
            !part.is_empty()
                && part
                    .bytes()
                    .all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit())
        })
}
