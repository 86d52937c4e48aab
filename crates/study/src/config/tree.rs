//! A TOML document as a tree that knows where each key and value stands in the text.

use super::error::{Fault, Span};
use palpate_statistics::Number;
use serde_json::Value as Json;
use toml::de::{DeTable, DeValue};

/// A value and the bytes it was read from. Where a sweep has put it in, the bytes are those of the sweep.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) span: Span,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Datetime(toml::value::Datetime),
    Array(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key of a table; entries keep the order of the text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) key: String,
    pub(super) key_span: Span,
    pub(super) node: Node,
}

/// Parses a document into its root table.
pub(super) fn parse(text: &str) -> Result<Node, Fault> {
    let root = DeTable::parse(text).map_err(|error| Fault {
        span: error.span(),
        path: String::new(),
        message: error.message().trim_end().replace('\n', "; "),
    })?;
    let span = root.span();
    Ok(Node {
        value: table(root.get_ref())?,
        span,
    })
}

fn table(table: &DeTable<'_>) -> Result<Value, Fault> {
    let entry = |(key, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'_>>)| {
        let key_span = key.span();
        let key: &std::borrow::Cow<'_, str> = key.get_ref();
        let node = node(value).map_err(|fault| fault.under(key))?;
        Ok(Entry {
            key: key.to_string(),
            key_span,
            node,
        })
    };
    Ok(Value::Table(
        table.iter().map(entry).collect::<Result<_, Fault>>()?,
    ))
}

fn node(value: &toml::Spanned<DeValue<'_>>) -> Result<Node, Fault> {
    let span = value.span();
    let value = match value.get_ref() {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Boolean(boolean) => Value::Boolean(*boolean),
        DeValue::Datetime(datetime) => Value::Datetime(*datetime),
        DeValue::Integer(integer) => match i64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(integer) => Value::Integer(integer),
            Err(_) => {
                return Err(Fault::at(
                    &span,
                    format!("the integer {integer} does not fit into 64 bits"),
                ));
            }
        },
        // A literal like 1e999 becomes infinity here; it is refused where a number is expected.
        DeValue::Float(float) => match float.as_str().parse() {
            Ok(float) => Value::Float(float),
            Err(_) => return Err(Fault::at(&span, format!("{float} is not a number"))),
        },
        DeValue::Array(items) => {
            let item = |(index, item)| node(item).map_err(|fault| fault.under(index));
            Value::Array(
                items
                    .iter()
                    .enumerate()
                    .map(item)
                    .collect::<Result<_, _>>()?,
            )
        }
        DeValue::Table(entries) => table(entries)?,
    };
    Ok(Node { value, span })
}

impl Node {
    /// The entries of a table; none for anything else.
    pub(super) fn entries(&self) -> &[Entry] {
        match &self.value {
            Value::Table(entries) => entries,
            _ => &[],
        }
    }

    /// The items of an array; none for anything else.
    pub(super) fn items(&self) -> &[Node] {
        match &self.value {
            Value::Array(items) => items,
            _ => &[],
        }
    }

    pub(super) fn as_text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    pub(super) fn as_number(&self) -> Option<f64> {
        match self.value {
            Value::Integer(integer) => Some(integer as f64),
            Value::Float(float) => Some(float),
            _ => None,
        }
    }

    /// The value of a table's key.
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        self.entries()
            .iter()
            .find(|entry| entry.key == key)
            .map(|entry| &entry.node)
    }

    /// Takes a key and its value out of a table.
    pub(super) fn take(&mut self, key: &str) -> Option<Entry> {
        let Value::Table(entries) = &mut self.value else {
            return None;
        };
        let index = entries.iter().position(|entry| entry.key == key)?;
        Some(entries.remove(index))
    }

    /// The node at a path, or the nearest of its parents that exists.
    pub(super) fn nearest(&self, path: &str) -> &Node {
        let child = |node: &'_ Self, key: &str| -> Option<usize> {
            match &node.value {
                Value::Table(entries) => entries.iter().position(|entry| entry.key == key),
                Value::Array(items) => key.parse().ok().filter(|&index| index < items.len()),
                _ => None,
            }
        };
        let mut node = self;
        for key in path.split('.') {
            match (child(node, key), &node.value) {
                (Some(index), Value::Table(entries)) => node = &entries[index].node,
                (Some(index), Value::Array(items)) => node = &items[index],
                _ => break,
            }
        }
        node
    }

    /// A default of the schema, standing at a place of the text; `None` where a value in it has no counterpart in TOML.
    pub(super) fn of_default(value: &Json, span: &Span) -> Option<Self> {
        let value = match value {
            Json::Null => return None,
            Json::Bool(boolean) => Value::Boolean(*boolean),
            Json::Number(number) => match number.as_i64() {
                Some(integer) => Value::Integer(integer),
                None => Value::Float(number.as_f64()?),
            },
            Json::String(text) => Value::Text(text.clone()),
            Json::Array(items) => {
                let items = items.iter().map(|item| Self::of_default(item, span));
                Value::Array(items.collect::<Option<_>>()?)
            }
            Json::Object(object) => {
                // What is null is left out, as it may be.
                let entries = object.iter().filter(|(_, value)| !value.is_null());
                let entries = entries.map(|(key, value)| {
                    Some(Entry {
                        key: key.clone(),
                        key_span: span.clone(),
                        node: Self::of_default(value, span)?,
                    })
                });
                Value::Table(entries.collect::<Option<_>>()?)
            }
        };
        let span = span.clone();
        Some(Self { value, span })
    }

    /// The node at a path, if there is one.
    pub(super) fn at(&self, path: &str) -> Option<&Node> {
        path.split('.')
            .try_fold(self, |node, key| match &node.value {
                Value::Table(entries) => {
                    let entry = entries.iter().find(|entry| entry.key == key)?;
                    Some(&entry.node)
                }
                Value::Array(items) => items.get(key.parse::<usize>().ok()?),
                _ => None,
            })
    }

    /// Takes the node at a path out of its table, if there is one.
    pub(super) fn take_at(&mut self, path: &str) -> Option<Entry> {
        let (parents, key) = path.rsplit_once('.').unwrap_or(("", path));
        let mut keys = parents.split('.').filter(|key| !key.is_empty());
        let table = keys.try_fold(self, |node, key| match &mut node.value {
            Value::Table(entries) => {
                let entry = entries.iter_mut().find(|entry| entry.key == key)?;
                Some(&mut entry.node)
            }
            Value::Array(items) => items.get_mut(key.parse::<usize>().ok()?),
            _ => None,
        })?;
        table.take(key)
    }

    /// Puts a value at a path of keys and array indices. Everything but the last key must exist; a new last key takes
    /// `key_span`. The error says what is in the way.
    pub(super) fn set(&mut self, path: &str, value: Node, key_span: &Span) -> Result<(), String> {
        let mut node = self;
        let mut walked = String::from("the config");
        let mut keys = path.split('.').peekable();
        while let Some(key) = keys.next() {
            let last = keys.peek().is_none();
            let kind = node.describe();
            node = match &mut node.value {
                Value::Table(entries) => match entries.iter().position(|entry| entry.key == key) {
                    Some(index) => &mut entries[index].node,
                    None if last => {
                        entries.push(Entry {
                            key: key.into(),
                            key_span: key_span.clone(),
                            node: value,
                        });
                        return Ok(());
                    }
                    None => {
                        let known = entries.iter().map(|entry| entry.key.as_str());
                        return Err(format!("{walked} has no `{key}`; {}", suggest(key, known)));
                    }
                },
                Value::Array(items) => {
                    let length = items.len();
                    match key
                        .parse::<usize>()
                        .ok()
                        .and_then(|index| items.get_mut(index))
                    {
                        Some(item) => item,
                        None => {
                            return Err(format!(
                                "{walked} is an array of {length}, which has no item `{key}`"
                            ));
                        }
                    }
                }
                _ => return Err(format!("{walked} is {kind}, which has no `{key}`")),
            };
            walked = match walked.strip_prefix('`') {
                Some(parent) => format!("`{}.{key}`", parent.trim_end_matches('`')),
                None => format!("`{key}`"),
            };
        }
        *node = value;
        Ok(())
    }

    /// The kind of the value, with the value itself where it is short.
    pub(super) fn describe(&self) -> String {
        match &self.value {
            Value::Text(text) if text.chars().count() > 60 => "a string".into(),
            Value::Text(text) => format!("the string {text:?}"),
            Value::Integer(integer) => format!("the integer {integer}"),
            Value::Float(float) => format!("the number {}", number_text(*float)),
            Value::Boolean(boolean) => format!("the boolean {boolean}"),
            Value::Datetime(_) => "a date or time".into(),
            Value::Array(_) => "an array".into(),
            Value::Table(_) => "a table".into(),
        }
    }

    pub(super) fn to_toml(&self) -> toml::Value {
        match &self.value {
            Value::Text(text) => toml::Value::String(text.clone()),
            Value::Integer(integer) => toml::Value::Integer(*integer),
            Value::Float(float) => toml::Value::Float(*float),
            Value::Boolean(boolean) => toml::Value::Boolean(*boolean),
            Value::Datetime(datetime) => toml::Value::Datetime(*datetime),
            Value::Array(items) => toml::Value::Array(items.iter().map(Self::to_toml).collect()),
            Value::Table(entries) => toml::Value::Table(
                entries
                    .iter()
                    .map(|entry| (entry.key.clone(), entry.node.to_toml()))
                    .collect(),
            ),
        }
    }

    /// The value as a table of results shows it: strings as they are, numbers in the shortest form that reads back.
    pub(super) fn text(&self) -> String {
        match &self.value {
            Value::Text(text) => text.clone(),
            Value::Integer(integer) if (*integer as f64) as i128 == i128::from(*integer) => {
                number_text(*integer as f64)
            }
            Value::Float(float) => number_text(*float),
            Value::Array(items) => {
                let items: Vec<_> = items.iter().map(Self::text).collect();
                format!("[{}]", items.join(", "))
            }
            _ => self.to_toml().to_string(),
        }
    }
}

/// The shortest form that reads back as the same number; whole numbers without a point.
pub(super) fn number_text(number: f64) -> String {
    if number.is_nan() {
        return "nan".into();
    }
    Number(number).to_string()
}

/// The known word that looks most like the given one, if any comes near.
pub(super) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    known
        .map(|candidate| (strsim::jaro_winkler(&word, candidate), candidate))
        .filter(|&(similarity, _)| similarity >= 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// "did you mean `radius`?", or the known words when none is near.
pub(super) fn suggest<'a>(word: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    match nearest(word, known.clone()) {
        Some(nearest) => format!("did you mean `{nearest}`?"),
        None => format!("known: {}", known.collect::<Vec<_>>().join(", ")),
    }
}
