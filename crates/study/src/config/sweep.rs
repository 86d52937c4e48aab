//! The `[[sweep]]` section: axes, each a list of rows of values for one or several fields.

use super::error::{Fault, Span};
use super::tree::{Node, Value};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};

/// One axis: a field (`path`) or fields that move together (`paths`), and either a list of `values` or a range
/// (`from`, `to`, `count`, `spacing`); or quasi-random points (`sample`, `count`) in `ranges` of fields.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// How points are chosen in `ranges`, `count` of them: far fewer than a grid of as many fields needs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sample: Option<Sample>,
    /// Ranges of the fields that are sampled, by their paths. The order of the paths in the alphabet is that of the
    /// columns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ranges: Option<BTreeMap<String, RangeConfig>>,
}

/// Range of a field that is sampled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RangeConfig {
    /// Least value.
    pub from: f64,
    /// Largest value, which itself is not taken.
    pub to: f64,
    /// Spacing in which values are as likely everywhere.
    #[serde(default)]
    pub spacing: Spacing,
}

/// Kind of points that fill ranges evenly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Sample {
    /// Sobol's sequence with Owen's scrambling (Burley 2020), the same for every seed of the study: each half, quarter and so
    /// on of every range has as many of the first 2ⁿ points.
    Sobol,
}

impl SweepConfig {
    /// The fields that the axis sets.
    pub fn targets(&self) -> impl Iterator<Item = &str> {
        self.path
            .iter()
            .chain(self.paths.iter().flatten())
            .chain(self.ranges.iter().flat_map(BTreeMap::keys))
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

impl Spacing {
    /// Spacing of a range, as far as it has one.
    fn of(node: Option<&Node>) -> Self {
        match node.and_then(Node::as_text) {
            Some("log") => Self::Log,
            _ => Self::Linear,
        }
    }

    /// Number at a share of the way from one end to the other, rounded to 12 digits.
    fn between(self, from: f64, to: f64, share: f64) -> f64 {
        let mix = |a: f64, b: f64| a * (1.0 - share) + b * share;
        rounded(match self {
            Self::Linear => mix(from, to),
            Self::Log => libm::pow(10_f64, mix(libm::log10(from), libm::log10(to))),
        })
    }
}

/// Largest number of cells of a study.
const MAX_CELLS: u64 = 1_000_000;

/// One axis, ready to be put into the tree.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) targets: Vec<Target>,
    rows: Rows,
}

/// Rows of an axis, with one value per target.
#[derive(Debug, Clone)]
enum Rows {
    Listed(Vec<Vec<SweptValue>>),
    Spaced(Range),
    Sampled(Points),
}

impl Axis {
    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        match &self.rows {
            Rows::Listed(rows) => rows.len(),
            Rows::Spaced(range) => range.steps + 1,
            Rows::Sampled(points) => points.count,
        }
    }

    /// Whether its values are numbers from one end to another.
    pub(super) fn is_range(&self) -> bool {
        matches!(self.rows, Rows::Spaced(_) | Rows::Sampled(_))
    }

    /// Values of a row, one per target.
    pub(super) fn row(&self, index: usize) -> Cow<'_, [SweptValue]> {
        match &self.rows {
            Rows::Listed(rows) => Cow::Borrowed(&rows[index]),
            Rows::Spaced(range) => Cow::Owned(vec![range.setting(index)]),
            Rows::Sampled(points) => Cow::Owned(points.settings(index)),
        }
    }

    /// First and last row, and those with the least and the largest number.
    pub(super) fn extremes(&self) -> Vec<usize> {
        let last = self.len() - 1;
        let mut extremes = vec![0, last];
        if !matches!(self.rows, Rows::Spaced(_)) {
            for column in 0..self.targets.len() {
                let numbers = || {
                    let number = |row| self.row(row)[column].node.as_number();
                    (0..=last).filter_map(move |row| Some((row, number(row)?)))
                };
                let by_size = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
                let found = numbers()
                    .min_by(by_size)
                    .into_iter()
                    .chain(numbers().max_by(by_size));
                extremes.extend(found.map(|(row, _)| row));
            }
        }
        extremes.sort_unstable();
        extremes.dedup();
        extremes
    }
}

/// A field that an axis sets, and where its path is written.
#[derive(Debug, Clone)]
pub(super) struct Target {
    pub(super) path: String,
    pub(super) span: Span,
}

/// A value of an axis.
#[derive(Debug, Clone)]
pub(super) struct SweptValue {
    pub(super) node: Node,
    /// Label of a table.
    label: Option<String>,
}

impl SweptValue {
    /// Number that is made, not written. A whole one is an integer, so that it may also set a field that counts.
    fn of_number(number: f64, span: &Span) -> Self {
        let value = match number.fract() == 0.0 && number.abs() < 2_f64.powi(53) {
            true => Value::Integer(number as i64),
            false => Value::Float(number),
        };
        let span = span.clone();
        let node = Node { value, span };
        Self { node, label: None }
    }

    /// Text that stands for it in results.
    pub(super) fn text(&self) -> Cow<'_, str> {
        match &self.label {
            Some(label) => label.into(),
            None => self.node.text().into(),
        }
    }
}

/// Reads the axes from a `sweep` section that has been validated against the schema.
pub(super) fn axes(section: &Node) -> Result<Vec<Axis>, Fault> {
    let under = |index: usize| move |fault: Fault| fault.under(index).under("sweep");
    let mut cells = 1_u64;
    let mut first_beyond = None;
    for (index, table) in section.items().iter().enumerate() {
        cells = cells.saturating_mul(length(table).map_err(under(index))?);
        if cells > MAX_CELLS {
            first_beyond.get_or_insert((index, table));
        }
    }
    if let Some((index, table)) = first_beyond {
        let message = format!("the axes make {cells} cells; at most {MAX_CELLS} are allowed");
        return Err(under(index)(Fault::at(&table.span, message)));
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
    if has("ranges") || has("sample") {
        return sampled_length(table);
    }
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

/// The number of points of a sampled axis.
fn sampled_length(table: &Node) -> Result<u64, Fault> {
    let others = ["path", "paths", "values", "from", "to", "spacing"];
    let both = others.iter().find(|key| table.get(key).is_some());
    if let Some(key) = both {
        let message = format!("has both `ranges` and `{key}`; keep one form");
        return Err(Fault::at(&table.span, message));
    }
    for key in ["sample", "ranges", "count"] {
        if table.get(key).is_none() {
            let message = "missing key; points need `sample`, `ranges` and `count`";
            return Err(Fault::at(&table.span, message).under(key));
        }
    }
    let count = table.get("count").and_then(Node::as_number).unwrap_or(0.0) as u64;
    Ok(count)
}

/// Quasi-random points in ranges.
#[derive(Debug, Clone)]
struct Points {
    count: usize,
    /// Place where the count is written.
    span: Span,
    ranges: Vec<([f64; 2], Spacing)>,
}

/// Most points and fields that Sobol's sequence is known for.
const MOST_POINTS: f64 = 65_536.0;
const MOST_FIELDS: usize = 256;

impl Points {
    fn settings(&self, index: usize) -> Vec<SweptValue> {
        let ranges = self.ranges.iter().enumerate();
        let setting = |(dimension, ([from, to], spacing)): (usize, &([f64; 2], Spacing))| {
            let share = sobol_burley::sample(index as u32, dimension as u32, 0);
            let number = spacing.between(*from, *to, f64::from(share));
            SweptValue::of_number(number, &self.span)
        };
        ranges.map(setting).collect()
    }
}

/// Targets and points of a sampled axis.
fn points(table: &Node, ranges: &Node) -> Result<(Vec<Target>, Points), Fault> {
    let count = table.get("count");
    let span = count.map_or(&table.span, |count| &count.span);
    let number = count.and_then(Node::as_number).unwrap_or(0.0);
    if number > MOST_POINTS {
        let message = format!("must be <= {MOST_POINTS} where points are sampled, is {number}");
        return Err(Fault::at(span, message).under("count"));
    }
    let mut entries: Vec<_> = ranges.entries().iter().collect();
    entries.sort_by(|one, other| one.key.cmp(&other.key));
    if entries.is_empty() || entries.len() > MOST_FIELDS {
        let message = format!("needs 1 to {MOST_FIELDS} fields, has {}", entries.len());
        return Err(Fault::at(&ranges.span, message).under("ranges"));
    }
    let mut targets = Vec::new();
    let mut all = Vec::new();
    for entry in entries {
        let range = &entry.node;
        let end = |key| range.get(key).and_then(Node::as_number).unwrap_or(0.0);
        let ends = [end("from"), end("to")];
        let spacing = Spacing::of(range.get("spacing"));
        let fault = |message: String| {
            let fault = Fault::at(&range.span, message);
            Err(fault.under(&entry.key).under("ranges"))
        };
        if ends[0] >= ends[1] {
            return fault(format!(
                "`from` must be < `to`: {} is not < {}",
                ends[0], ends[1]
            ));
        }
        if ends[0] <= 0.0 && spacing == Spacing::Log {
            return fault(format!(
                "`from` must be > 0 where spacing = \"log\", is {}",
                ends[0]
            ));
        }
        targets.push(Target {
            path: entry.key.clone(),
            span: entry.key_span.clone(),
        });
        all.push((ends, spacing));
    }
    Ok((
        targets,
        Points {
            count: number as usize,
            span: span.clone(),
            ranges: all,
        },
    ))
}

fn axis(table: &Node, earlier: &[Axis]) -> Result<Axis, Fault> {
    if let Some(ranges) = table.get("ranges") {
        let (targets, points) = points(table, ranges)?;
        check_targets(&targets, earlier)?;
        let rows = Rows::Sampled(points);
        return Ok(Axis { targets, rows });
    }
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
    check_targets(&targets, earlier)?;
    let rows = match table.get("values") {
        Some(values) => {
            let rows = list(values, &targets, together).map_err(|fault| fault.under("values"))?;
            Rows::Listed(rows)
        }
        None if together => {
            return Err(Fault::at(
                &table.span,
                "a range sets one field; `paths` needs `values`",
            ));
        }
        None => Rows::Spaced(range(table)?),
    };
    let twice = match &rows {
        Rows::Listed(rows) => {
            let mut seen = HashSet::new();
            let mut rows = rows.iter();
            let twice = rows.find(|row| {
                let texts = row.iter().map(SweptValue::text);
                !seen.insert(texts.collect::<Vec<_>>())
            });
            twice.cloned()
        }
        Rows::Sampled(_) => None,
        // Numbers of a range follow each other.
        Rows::Spaced(range) => {
            let mut last = range.number(0);
            let twice = (1..=range.steps).find(|&index| {
                let before = std::mem::replace(&mut last, range.number(index));
                last == before
            });
            twice.map(|index| vec![range.setting(index)])
        }
    };
    if let Some(row) = twice {
        let texts: Vec<_> = row.iter().map(SweptValue::text).collect();
        let span = row.first().map_or(&table.span, |one| &one.node.span);
        let message = format!("{} stands twice on this axis", texts.join(", "));
        return Err(Fault::at(span, message));
    }
    Ok(Axis { targets, rows })
}

fn target(path: &Node) -> Target {
    Target {
        path: path.as_text().unwrap_or_default().into(),
        span: path.span.clone(),
    }
}

/// Refuses targets that cannot be swept, or that those before them or of earlier axes set.
fn check_targets(targets: &[Target], earlier: &[Axis]) -> Result<(), Fault> {
    let of_axes = || earlier.iter().flat_map(|axis| &axis.targets);
    targets
        .iter()
        .enumerate()
        .try_for_each(|(index, target)| check_target(target, of_axes().chain(&targets[..index])))
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
        return Ok(SweptValue { node, label: None });
    };
    match node.take("label").map(|entry| entry.node) {
        Some(Node {
            value: Value::Text(text),
            ..
        }) if !text.is_empty() => Ok(SweptValue {
            node,
            label: Some(text),
        }),
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

/// Numbers from one end to another, made as they are asked for.
#[derive(Debug, Clone)]
struct Range {
    /// Ends, and where they are written.
    ends: [(f64, Span); 2],
    /// Place where their count is written.
    count: Span,
    /// Number of steps between the ends.
    steps: usize,
    spacing: Spacing,
}

impl Range {
    fn number(&self, index: usize) -> f64 {
        let [first, last] = [self.ends[0].0, self.ends[1].0];
        match index {
            0 => first,
            _ if index == self.steps => last,
            _ => self
                .spacing
                .between(first, last, index as f64 / self.steps as f64),
        }
    }

    fn setting(&self, index: usize) -> SweptValue {
        let span = match index {
            0 => &self.ends[0].1,
            _ if index == self.steps => &self.ends[1].1,
            _ => &self.count,
        };
        SweptValue::of_number(self.number(index), span)
    }
}

fn range(table: &Node) -> Result<Range, Fault> {
    let (Some(from), Some(to), Some(count)) =
        (table.get("from"), table.get("to"), table.get("count"))
    else {
        return Err(Fault::at(&table.span, "needs `from`, `to` and `count`"));
    };
    let (Some(first), Some(last), Some(n)) = (from.as_number(), to.as_number(), count.as_number())
    else {
        return Err(Fault::at(&table.span, "needs numbers"));
    };
    let spacing = Spacing::of(table.get("spacing"));
    if let Some((key, end)) = [("from", from), ("to", to)]
        .into_iter()
        .find(|(_, end)| end.as_number() <= Some(0.0))
        && spacing == Spacing::Log
    {
        let message = format!("must be > 0 where spacing = \"log\", is {}", end.text());
        return Err(Fault::at(&end.span, message).under(key));
    }
    if n == 1.0 && first != last {
        let message = format!("1 value cannot reach from {} to {}", from.text(), to.text());
        return Err(Fault::at(&count.span, message).under("count"));
    }
    Ok(Range {
        ends: [(first, from.span.clone()), (last, to.span.clone())],
        count: count.span.clone(),
        steps: n as usize - 1,
        spacing,
    })
}

/// Number rounded to 12 digits: 0.3 rather than 0.30000000000000004, and the same on machines whose logarithms differ.
fn rounded(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}
