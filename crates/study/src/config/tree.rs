//! Parses the text of a config to a tree of values, and accesses values by their path.

use super::error::Fault;
use palpate_statistics::Number;
use toml::Value;
use toml::de::{DeTable, DeValue};

pub(super) fn parse(text: &str) -> Result<Value, Fault> {
    let root = DeTable::parse(text).map_err(|error| Fault {
        span: error.span(),
        ..Fault::new(error.message().trim_end().replace('\n', "; "))
    })?;
    value(&DeValue::Table(root.into_inner()))
}

fn value(value: &DeValue<'_>) -> Result<Value, Fault> {
    Ok(match value {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Boolean(boolean) => Value::Boolean(*boolean),
        DeValue::Datetime(datetime) => Value::Datetime(*datetime),
        DeValue::Integer(integer) => {
            let parsed = i64::from_str_radix(integer.as_str(), integer.radix());
            let too_large =
                |_| Fault::new(format!("the integer {integer} does not fit into 64 bits"));
            Value::Integer(parsed.map_err(too_large)?)
        }
        // A literal like 1e999 becomes infinity here. The schema rejects infinity later.
        DeValue::Float(float) => {
            let no_number = |_| Fault::new(format!("{float} is not a number"));
            Value::Float(float.as_str().parse().map_err(no_number)?)
        }
        DeValue::Array(items) => {
            let items = items.iter().enumerate();
            let items = items.map(|(index, item)| {
                self::value(item.get_ref()).map_err(|fault| fault.under(index))
            });
            Value::Array(items.collect::<Result<_, _>>()?)
        }
        DeValue::Table(entries) => {
            let entries = entries.iter().map(|(key, item)| {
                let key = key.get_ref().to_string();
                let item = self::value(item.get_ref()).map_err(|fault| fault.under(&key))?;
                Ok((key, item))
            });
            Value::Table(entries.collect::<Result<_, Fault>>()?)
        }
    })
}

pub(super) fn child<'a>(value: &'a Value, key: &str) -> Option<&'a Value> {
    match value {
        Value::Array(items) => items.get(key.parse::<usize>().ok()?),
        value => value.get(key),
    }
}

fn child_mut<'a>(value: &'a mut Value, key: &str) -> Option<&'a mut Value> {
    match value {
        Value::Array(items) => items.get_mut(key.parse::<usize>().ok()?),
        value => value.get_mut(key),
    }
}

pub(super) fn at<'a>(tree: &'a Value, path: &str) -> Option<&'a Value> {
    path.split('.').try_fold(tree, child)
}

/// The value at a path in the tree; `None` if the path does not exist. The empty path is the path of the whole tree.
pub(super) fn at_mut<'a>(tree: &'a mut Value, path: &str) -> Option<&'a mut Value> {
    let mut keys = path.split('.').filter(|key| !key.is_empty());
    keys.try_fold(tree, child_mut)
}

pub(super) fn take(tree: &mut Value, path: &str) -> Option<Value> {
    let (parents, key) = path.rsplit_once('.').unwrap_or(("", path));
    at_mut(tree, parents)?.as_table_mut()?.remove(key)
}

/// Sets the value at a path of keys and array indices. All keys before the last one must exist. Otherwise, the error
/// states which part of the path does not exist.
pub(super) fn set(tree: &mut Value, path: &str, value: Value) -> Result<(), String> {
    let (parents, last) = path.rsplit_once('.').unwrap_or(("", path));
    let (mut node, mut walked) = (tree, String::new());
    let missing = |node: &Value, walked: &str, key: &str| {
        let walked = match walked {
            "" => "the config".to_owned(),
            walked => format!("`{walked}`"),
        };
        match node {
            Value::Table(_) => format!("{walked} has no `{key}`"),
            Value::Array(items) => {
                format!(
                    "{walked} is an array of {}, which has no item `{key}`",
                    items.len()
                )
            }
            other => format!("{walked} is {}, which has no `{key}`", describe(other)),
        }
    };
    for key in parents.split('.').filter(|key| !key.is_empty()) {
        if child(node, key).is_none() {
            return Err(missing(node, &walked, key));
        }
        let dot = if walked.is_empty() { "" } else { "." };
        walked = format!("{walked}{dot}{key}");
        node = match child_mut(node, key) {
            Some(child) => child,
            None => return Ok(()),
        };
    }
    match (child(node, last).is_some(), node) {
        (_, Value::Table(table)) => drop(table.insert(last.to_owned(), value)),
        (true, node) => {
            if let Some(item) = child_mut(node, last) {
                *item = value;
            }
        }
        (false, node) => return Err(missing(node, &walked, last)),
    }
    Ok(())
}

pub(super) fn as_number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(integer) => Some(*integer as f64),
        Value::Float(float) => Some(*float),
        _ => None,
    }
}

/// Describes a value for a message: its type in words, and the value itself if it is short.
pub(super) fn describe(value: &Value) -> String {
    match value {
        Value::String(text) if text.chars().count() > 60 => "a string".into(),
        Value::String(text) => format!("the string {text:?}"),
        Value::Integer(integer) => format!("the integer {integer}"),
        Value::Float(float) => format!("the number {}", number_text(*float)),
        Value::Boolean(boolean) => format!("the boolean {boolean}"),
        Value::Datetime(_) => "a date or time".into(),
        Value::Array(_) => "an array".into(),
        Value::Table(_) => "a table".into(),
    }
}

/// The text that result tables show for a value: strings unchanged, and numbers in the shortest form that parses to the
/// same number.
pub(super) fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Integer(integer) if (*integer as f64) as i128 == i128::from(*integer) => {
            number_text(*integer as f64)
        }
        Value::Float(float) => number_text(*float),
        Value::Array(items) => {
            let items: Vec<_> = items.iter().map(text).collect();
            format!("[{}]", items.join(", "))
        }
        other => other.to_string(),
    }
}

/// The shortest text that parses to the same number; whole numbers have no decimal point.
pub(super) fn number_text(number: f64) -> String {
    if number.is_nan() {
        return "nan".into();
    }
    Number(number).to_string()
}

/// The word of `known` that is most similar to `word`; `None` if no word is similar.
pub(super) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    known
        .map(|candidate| (strsim::jaro_winkler(&word, candidate), candidate))
        .filter(|&(similarity, _)| similarity >= 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// A hint for a misspelt word, such as "did you mean `radius`? (known: kind, radius)". If none of the valid words
/// (`known`) is similar, the hint only lists the valid words.
pub(crate) fn suggest<'a>(word: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    let all = known.clone().collect::<Vec<_>>().join(", ");
    match nearest(word, known) {
        Some(nearest) => format!("did you mean `{nearest}`? (known: {all})"),
        None => format!("known: {all}"),
    }
}

pub(super) fn quoted<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let words: Vec<String> = words.map(|word| format!("`{word}`")).collect();
    match words.as_slice() {
        [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        all => all.concat(),
    }
}
