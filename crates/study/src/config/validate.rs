//! The walk of a tree against a JSON Schema: the config's strictness, and all its messages on keys, types and limits.

use super::error::Fault;
use super::tree::{Entry, Node, Value, nearest, number_text, suggest};
use serde_json::Value as Json;

/// The pattern of a name that is fit for a file.
pub(super) const NAME: &str = "^[a-z0-9]+(-[a-z0-9]+)*$";

/// Checks a tree against a schema as [`super::schema()`] makes them: tagged tables (`oneOf` told apart by `kind`),
/// choices of words, choices of either, objects, arrays, numbers and strings; no references. The first fault in the order of the text is reported.
pub(super) fn validate(schema: &Json, node: &Node) -> Result<(), Fault> {
    if let Some(variants) = schema["oneOf"].as_array() {
        let tables = variants.iter().any(|variant| kind_of(variant).is_some());
        let words = words(variants).next().is_some();
        return match (tables, &node.value) {
            (true, Value::Text(_)) if words => choice(variants, node),
            (true, _) => tagged(variants, node),
            (false, _) => choice(variants, node),
        };
    }
    match schema["type"].as_str() {
        Some("object") => object(schema, &[], node),
        Some("array") => array(schema, node),
        Some("number") => number(schema, node),
        Some("integer") => match node.value {
            Value::Integer(_) => number(schema, node),
            _ => Err(wrong_type("an integer", node)),
        },
        Some("boolean") => match node.value {
            Value::Boolean(_) => Ok(()),
            _ => Err(wrong_type("true or false", node)),
        },
        Some("string") => string(schema, node),
        _ => Ok(()),
    }
}

/// The schema of the field at a path of keys and array indices, in the kinds that a tree has; `None` where it has no such
/// field.
pub(super) fn at<'a>(schema: &'a Json, tree: &Node, path: &str) -> Option<&'a Json> {
    let (mut schema, mut walked) = (schema, String::new());
    for key in path.split('.') {
        let node = if walked.is_empty() {
            tree
        } else {
            tree.nearest(&walked)
        };
        let kind = node.get("kind").and_then(Node::as_text);
        let variants = schema["oneOf"].as_array();
        let of_kind = |variants: &'a Vec<Json>| {
            let mut variants = variants.iter();
            variants.find(|variant| kind_of(variant) == kind)
        };
        schema = variants.map_or(Some(schema), of_kind)?;
        schema = match &node.value {
            Value::Array(_) => schema.get("items"),
            _ => {
                let named = schema["properties"].get(key);
                named.or_else(|| {
                    schema
                        .get("additionalProperties")
                        .filter(|any| any.is_object())
                })
            }
        }?;
        walked = match walked.as_str() {
            "" => key.to_owned(),
            parent => format!("{parent}.{key}"),
        };
    }
    Some(schema)
}

/// The value of `kind` that a variant of a tagged table asks for.
pub(super) fn kind_of(variant: &Json) -> Option<&str> {
    variant["properties"]["kind"]["const"].as_str()
}

/// Fields that cannot stand beside a field of the schema of its table, because they state the same in another way.
pub(super) fn instead_of(field: &Json) -> impl Iterator<Item = &str> {
    let names = field["x-instead-of"].as_array();
    names.into_iter().flatten().filter_map(Json::as_str)
}

/// The words among the variants.
fn words(variants: &[Json]) -> impl Iterator<Item = &str> {
    variants
        .iter()
        .filter_map(|variant| variant["const"].as_str())
}

fn wrong_type(expected: &str, node: &Node) -> Fault {
    Fault::at(
        &node.span,
        format!("expected {expected}, found {}", node.describe()),
    )
}

fn tagged(variants: &[Json], node: &Node) -> Result<(), Fault> {
    let Value::Table(_) = node.value else {
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
        return Err(Fault::at(&node.span, message).under("kind"));
    };
    let Some(name) = kind.as_text() else {
        return Err(wrong_type("a string", kind).under("kind"));
    };
    match variants
        .iter()
        .find(|variant| kind_of(variant) == Some(name))
    {
        Some(variant) => object(variant, variants, node),
        None => Err(not_among("unknown kind", name, &kinds, kind).under("kind")),
    }
}

fn choice(variants: &[Json], node: &Node) -> Result<(), Fault> {
    let Some(text) = node.as_text() else {
        return Err(wrong_type("a string", node));
    };
    let known: Vec<&str> = words(variants).collect();
    if known.contains(&text) {
        Ok(())
    } else {
        let mut fault = not_among("unknown choice", text, &known, node);
        let kinds: Vec<&str> = variants.iter().filter_map(kind_of).collect();
        if !kinds.is_empty() {
            fault.message += &format!(", or a table whose `kind` is one of {}", kinds.join(", "));
        }
        Err(fault)
    }
}

fn not_among(what: &str, word: &str, known: &[&str], node: &Node) -> Fault {
    let did_you_mean = match nearest(word, known.iter().copied()) {
        Some(nearest) => format!("; did you mean `{nearest}`?"),
        None => String::new(),
    };
    let message = format!(
        "{what} {word:?}{did_you_mean} (known: {})",
        known.join(", ")
    );
    Fault::at(&node.span, message)
}

/// Checks a table, which might also be of the kinds of `others`.
fn object(schema: &Json, others: &[Json], node: &Node) -> Result<(), Fault> {
    let Value::Table(entries) = &node.value else {
        return Err(wrong_type("a table", node));
    };
    let properties = schema["properties"].as_object();
    for entry in entries {
        match properties.and_then(|properties| properties.get(&entry.key)) {
            Some(property) => match other_of(property, entries, entry) {
                Some(other) => {
                    let message = format!("cannot stand beside `{other}`; keep one of them");
                    Err(Fault::at(&entry.node.span, message))
                }
                None => validate(property, &entry.node),
            },
            None if schema["additionalProperties"] == false => {
                let known = properties
                    .into_iter()
                    .flat_map(|properties| properties.keys().map(String::as_str));
                let of_kind =
                    kind_of(schema).map_or(String::new(), |kind| format!(" for kind `{kind}`"));
                let elsewhere = match kinds_with(others, &entry.key).as_slice() {
                    [] => String::new(),
                    [kind] => format!("; kind `{kind}` has it"),
                    kinds => format!("; kinds {} have it", kinds.join(", ")),
                };
                let hint = suggest(&entry.key, known);
                let message = format!("unknown key{of_kind}; {hint}{elsewhere}");
                Err(Fault::at(&entry.key_span, message))
            }
            None => validate(&schema["additionalProperties"], &entry.node),
        }
        .map_err(|fault| fault.under(&entry.key))?;
    }
    let required = schema["required"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Json::as_str);
    match required.into_iter().find(|key| node.get(key).is_none()) {
        Some(key) => {
            let property = &schema["properties"][key];
            let is_table = property["type"] == "object" || property["oneOf"][0]["type"] == "object";
            let what = if is_table { "table" } else { "key" };
            let message = format!("missing {what}");
            Err(Fault::at(&node.span, message).under(key))
        }
        None => Ok(()),
    }
}

/// Kinds that have a key.
pub(super) fn kinds_with<'a>(variants: &'a [Json], key: &str) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for variant in variants {
        if variant["properties"].get(key).is_some() {
            found.extend(kind_of(variant));
        }
    }
    found
}

/// Key of an earlier entry that states in another way what an entry does.
fn other_of<'a>(property: &'a Json, entries: &[Entry], entry: &Entry) -> Option<&'a str> {
    let before = entries.iter().take_while(|one| one.key != entry.key);
    let before: Vec<&str> = before.map(|one| one.key.as_str()).collect();
    instead_of(property).find(|other| before.contains(other))
}

fn array(schema: &Json, node: &Node) -> Result<(), Fault> {
    let Value::Array(items) = &node.value else {
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
        return Err(Fault::at(&node.span, message));
    }
    for (index, item) in items.iter().enumerate() {
        validate(&schema["items"], item).map_err(|fault| fault.under(index))?;
    }
    Ok(())
}

fn number(schema: &Json, node: &Node) -> Result<(), Fault> {
    let Some(number) = node.as_number() else {
        return Err(wrong_type("a number", node));
    };
    let limit = |key: &str| schema[key].as_f64();
    let violated = if !number.is_finite() {
        Some("finite".to_string())
    } else if let Some(limit) = limit("exclusiveMinimum").filter(|&limit| number <= limit) {
        Some(format!("> {}", number_text(limit)))
    } else if let Some(limit) = limit("minimum").filter(|&limit| number < limit) {
        Some(format!(">= {}", number_text(limit)))
    } else {
        limit("maximum")
            .filter(|&limit| number > limit)
            .map(|limit| format!("<= {}", number_text(limit)))
    };
    match violated {
        Some(rule) => Err(Fault::at(
            &node.span,
            format!("must be {rule}, is {}", node.text()),
        )),
        None => Ok(()),
    }
}

fn string(schema: &Json, node: &Node) -> Result<(), Fault> {
    let Some(text) = node.as_text() else {
        return Err(wrong_type("a string", node));
    };
    // The only pattern in the schema is that of a name.
    if schema.get("pattern").is_some() && !is_kebab_case(text) {
        let message = format!(
            "{text:?} is not a name: lower-case letters and digits, joined by single hyphens, at most 100"
        );
        return Err(Fault::at(&node.span, message));
    }
    Ok(())
}

/// Whether a text matches [`NAME`] and is fit for a file's name.
fn is_kebab_case(text: &str) -> bool {
    text.len() <= 100
        && text.split('-').all(|part| {
            !part.is_empty()
                && part
                    .bytes()
                    .all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit())
        })
}
