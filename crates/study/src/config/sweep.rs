//! The `[[sweep]]` section: axes, each a list of rows of values for one or several fields.

use super::error::{Fault, Span};
use super::tree::{Node, Value};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// One axis: a field (`path`) or fields that move together (`paths`), and either a list of `values` or a range
/// (`from`, `to`, `count`, `spacing`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepConfig {
    /// The field: keys and array indices joined by dots, e.g. `scene.object.radius`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// Fields that move together; each of `values` is then an array with one value per field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minItems" = 1))]
    pub paths: Option<Vec<String>>,
    /// The values. A table needs a `label`, which the results show in its place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Vec<serde_json::Value>>", extend("minItems" = 1))]
    pub values: Option<Vec<toml::Value>>,
    /// First value of a range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// Last value of a range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
    /// Number of values of a range, both ends included.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1))]
    pub count: Option<u32>,
    /// How a range is divided. Values between the ends are rounded to 12 digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spacing: Option<Spacing>,
}

impl SweepConfig {
    /// The fields that the axis sets.
    pub fn targets(&self) -> impl Iterator<Item = &str> {
        self.path
            .iter()
            .chain(self.paths.iter().flatten())
            .map(String::as_str)
    }
}

/// How a range is divided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Spacing {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal ratios.
    Log,
}

/// Largest number of cells of a study.
const MAX_CELLS: u64 = 1_000_000;

/// One axis, ready to be put into the tree.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) targets: Vec<Target>,
    /// One value per target.
    pub(super) rows: Vec<Vec<SweptValue>>,
}

/// A field that an axis sets, and where its path is written.
#[derive(Debug, Clone)]
pub(super) struct Target {
    pub(super) path: String,
    pub(super) span: Span,
}

/// A value of an axis and the text that stands for it in results.
#[derive(Debug, Clone)]
pub(super) struct SweptValue {
    pub(super) node: Node,
    pub(super) text: String,
}

/// Reads the axes from a `sweep` section that has been validated against the schema.
pub(super) fn axes(section: &Node) -> Result<Vec<Axis>, Fault> {
    let under = |index: usize| move |fault: Fault| fault.under(index).under("sweep");
    let mut cells = 1_u64;
    for (index, table) in section.items().iter().enumerate() {
        cells = cells.saturating_mul(length(table).map_err(under(index))?);
        if cells > MAX_CELLS {
            let message = format!(
                "the axes up to this one make {cells} cells; at most {MAX_CELLS} are allowed"
            );
            return Err(under(index)(Fault::at(&table.span, message)));
        }
    }
    let mut axes: Vec<Axis> = Vec::new();
    for (index, table) in section.items().iter().enumerate() {
        let axis = axis(table, &axes).map_err(under(index))?;
        axes.push(axis);
    }
    Ok(axes)
}

/// The number of rows, without making them.
fn length(table: &Node) -> Result<u64, Fault> {
    let has = |key| table.get(key).is_some();
    let range = ["from", "to", "count"];
    match (table.get("values"), range.iter().find(|key| !has(key))) {
        (Some(values), _) => match range.iter().chain(&["spacing"]).find(|key| has(key)) {
            None => Ok(values.items().len() as u64),
            Some(key) => Err(Fault::at(
                &table.span,
                format!("has both `values` and `{key}`; keep one form"),
            )),
        },
        (None, Some(missing)) if range.iter().any(|key| has(key)) => Err(Fault::at(
            &table.span,
            "missing key; a range needs `from`, `to` and `count`",
        )
        .under(missing)),
        (None, Some(_)) => Err(Fault::at(
            &table.span,
            "is empty: needs `values`, or `from`, `to` and `count`",
        )),
        (None, None) => Ok(table.get("count").and_then(Node::as_number).unwrap_or(0.0) as u64),
    }
}

fn axis(table: &Node, earlier: &[Axis]) -> Result<Axis, Fault> {
    let (targets, together) = match (table.get("path"), table.get("paths")) {
        (Some(path), None) => (vec![target(path)], false),
        (None, Some(paths)) => (paths.items().iter().map(target).collect::<Vec<_>>(), true),
        (None, None) => return Err(Fault::at(&table.span, "needs `path` or `paths`")),
        (Some(_), Some(_)) => {
            return Err(Fault::at(
                &table.span,
                "has both `path` and `paths`; keep one of them",
            ));
        }
    };
    for (index, target) in targets.iter().enumerate() {
        let before = earlier
            .iter()
            .flat_map(|axis| &axis.targets)
            .chain(&targets[..index]);
        check_target(target, before)?;
    }
    let rows = match table.get("values") {
        Some(values) => list(values, &targets, together).map_err(|fault| fault.under("values"))?,
        None if together => {
            return Err(Fault::at(
                &table.span,
                "a range sets one field; `paths` needs `values`",
            ));
        }
        None => range(table)?,
    };
    let mut seen = HashSet::new();
    for row in &rows {
        if !seen.insert(row.iter().map(|setting| &setting.text).collect::<Vec<_>>()) {
            let texts: Vec<_> = row.iter().map(|setting| setting.text.as_str()).collect();
            let span = row
                .first()
                .map_or(&table.span, |setting| &setting.node.span);
            return Err(Fault::at(
                span,
                format!("{} stands twice on this axis", texts.join(", ")),
            ));
        }
    }
    Ok(Axis { targets, rows })
}

fn target(path: &Node) -> Target {
    Target {
        path: path.as_text().unwrap_or_default().into(),
        span: path.span.clone(),
    }
}

fn check_target<'a>(
    target: &Target,
    mut before: impl Iterator<Item = &'a Target>,
) -> Result<(), Fault> {
    let path = target.path.as_str();
    let fault = |message: String| Err(Fault::at(&target.span, message));
    if !matches!(path.split('.').next(), Some("scene" | "seed" | "trials")) {
        return fault(format!(
            "cannot sweep `{path}`; a sweep sets fields of `scene`, `seed` or `trials`"
        ));
    }
    let covers = |part: &str| {
        part == path
            || part
                .strip_prefix(path)
                .is_some_and(|rest| rest.starts_with('.'))
    };
    match before.find(|earlier| covers(&earlier.path)) {
        Some(earlier) if earlier.path == path => fault(format!("`{path}` is swept twice")),
        Some(earlier) => fault(format!(
            "`{path}` would overwrite `{}`, which is swept before it",
            earlier.path
        )),
        None => Ok(()),
    }
}

fn list(values: &Node, targets: &[Target], together: bool) -> Result<Vec<Vec<SweptValue>>, Fault> {
    let row = |(index, value): (usize, &Node)| {
        let row = match (&value.value, together) {
            (_, false) => setting(value).map(|setting| vec![setting]),
            (Value::Array(items), true) if items.len() == targets.len() => {
                items.iter().map(setting).collect()
            }
            (Value::Array(items), true) => {
                let message = format!(
                    "expected {} values, one for each of `paths`, found {}",
                    targets.len(),
                    items.len()
                );
                Err(Fault::at(&value.span, message))
            }
            (_, true) => {
                let message = format!(
                    "expected an array with one value for each of `paths`, found {}",
                    value.describe()
                );
                Err(Fault::at(&value.span, message))
            }
        };
        row.map_err(|fault: Fault| fault.under(index))
    };
    values.items().iter().enumerate().map(row).collect()
}

/// A table gives up its label, which then stands for it.
fn setting(value: &Node) -> Result<SweptValue, Fault> {
    let mut node = value.clone();
    let Value::Table(_) = node.value else {
        return Ok(SweptValue {
            text: node.text(),
            node,
        });
    };
    match node.take("label").map(|entry| entry.node) {
        Some(Node {
            value: Value::Text(text),
            ..
        }) if !text.is_empty() => Ok(SweptValue { node, text }),
        Some(label) => {
            let message = format!(
                "expected a text that is not empty, found {}",
                label.describe()
            );
            Err(Fault::at(&label.span, message).under("label"))
        }
        None => Err(Fault::at(
            &value.span,
            "a table among swept values needs a `label`, which the results show",
        )),
    }
}

fn range(table: &Node) -> Result<Vec<Vec<SweptValue>>, Fault> {
    let (Some(from), Some(to), Some(count)) =
        (table.get("from"), table.get("to"), table.get("count"))
    else {
        return Err(Fault::at(&table.span, "needs `from`, `to` and `count`"));
    };
    let (Some(first), Some(last), Some(n)) = (from.as_number(), to.as_number(), count.as_number())
    else {
        return Err(Fault::at(&table.span, "needs numbers"));
    };
    let log = table.get("spacing").and_then(Node::as_text) == Some("log");
    if let Some((key, end)) = [("from", from), ("to", to)]
        .into_iter()
        .find(|(_, end)| end.as_number() <= Some(0.0))
        && log
    {
        let message = format!("must be > 0 where spacing = \"log\", is {}", end.text());
        return Err(Fault::at(&end.span, message).under(key));
    }
    if n == 1.0 && first != last {
        let message = format!("1 value cannot reach from {} to {}", from.text(), to.text());
        return Err(Fault::at(&count.span, message).under("count"));
    }
    let steps = n as usize - 1;
    let value = |index: usize| {
        let t = index as f64 / steps as f64;
        let mix = |a: f64, b: f64| a * (1.0 - t) + b * t;
        match index {
            0 => (first, from),
            _ if index == steps => (last, to),
            _ if log => (
                rounded(libm::pow(
                    10_f64,
                    mix(libm::log10(first), libm::log10(last)),
                )),
                count,
            ),
            _ => (rounded(mix(first, last)), count),
        }
    };
    let setting = |index| {
        let (number, origin) = value(index);
        // A whole number is an integer, so that a range may also set a field that counts.
        let value = match number.fract() == 0.0 && number.abs() < 2_f64.powi(53) {
            true => Value::Integer(number as i64),
            false => Value::Float(number),
        };
        let node = Node {
            value,
            span: origin.span.clone(),
        };
        vec![SweptValue {
            text: node.text(),
            node,
        }]
    };
    Ok((0..=steps).map(setting).collect())
}

/// Number rounded to 12 digits: 0.3 rather than 0.30000000000000004, and the same on machines whose logarithms differ.
fn rounded(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}
