//! The `[[sweep]]` section of a config. It consists of axes. Each axis is a list of rows, and each row has one value
//! for each field of the axis.

use super::error::Fault;
use super::tree::{self, as_number, describe, number_text};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};
use toml::Value;

/// One axis of the sweep. It varies one field (`path`), or several fields together (`paths`). Its values are a list
/// (`values`), a range (`from`, `to`, `count`, `spacing`), or quasi-random points (`sample`, `count`) within a range
/// for each field (`ranges`).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SweepConfig {
    /// Path of the swept field: keys and array indices joined by dots, for example `scene.object.radius`.
    pub(crate) path: Option<String>,
    /// Paths of fields that vary together. Each entry of `values` is then an array with one value per field.
    #[schemars(extend("minItems" = 1))]
    pub(crate) paths: Option<Vec<String>>,
    /// Values of the axis. A value that is a table needs a `label`, which the results show instead of the table.
    #[schemars(with = "Option<Vec<serde_json::Value>>", extend("minItems" = 1))]
    pub(crate) values: Option<Vec<toml::Value>>,
    /// First value of the axis, if its values are a range.
    pub(crate) from: Option<f64>,
    /// Last value of the axis, if its values are a range.
    pub(crate) to: Option<f64>,
    /// Number of values of a range, including both ends, or number of sampled points.
    #[schemars(extend("minimum" = 1))]
    pub(crate) count: Option<u32>,
    /// Spacing of the values of a range: `linear` or `log`. Values between the ends are rounded to 12 digits.
    pub(crate) spacing: Option<Spacing>,
    /// Method that chooses `count` points within `ranges`. If many fields are swept, such a sample needs far fewer
    /// points than a grid.
    pub(crate) sample: Option<Sample>,
    /// Range of each sampled field, with the path of the field as key. The columns of the result tables are in the
    /// alphabetical order of the paths.
    pub(crate) ranges: Option<BTreeMap<String, RangeConfig>>,
}

/// Range of the values of a sampled field.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RangeConfig {
    /// Smallest value of the sampled field.
    pub(crate) from: f64,
    /// Upper end of the range. All values of the field are below this end.
    pub(crate) to: f64,
    /// Scale on which the points are spread evenly: `linear` or `log`.
    #[serde(default)]
    pub(crate) spacing: Spacing,
}

/// Kind of quasi-random points that fill ranges evenly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Sample {
    /// Sobol's sequence with Owen's scrambling (Burley 2020). The points do not depend on the seed of the study. Of the
    /// first 2ⁿ points, equal numbers lie in each half, in each quarter and so on of every range.
    Sobol,
}

impl SweepConfig {
    pub(crate) fn targets(&self) -> impl Iterator<Item = &str> {
        self.path
            .iter()
            .chain(self.paths.iter().flatten())
            .chain(self.ranges.iter().flat_map(BTreeMap::keys))
            .map(String::as_str)
    }
}

/// Spacing of the values of a range.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Spacing {
    /// Neighbouring values have equal differences.
    #[default]
    Linear,
    /// Neighbouring values have equal ratios.
    Log,
}

impl Spacing {
    /// Number between the ends of a range, rounded to 12 digits. `share` is 0 at the end `from` and 1 at the end `to`.
    fn between(self, from: f64, to: f64, share: f64) -> f64 {
        let mix = |a: f64, b: f64| a * (1.0 - share) + b * share;
        rounded(match self {
            Self::Linear => mix(from, to),
            Self::Log => libm::pow(10_f64, mix(libm::log10(from), libm::log10(to))),
        })
    }
}

const MAX_CELLS: u64 = 1_000_000;

/// One sweep axis, converted so that its values can be inserted into the tree of a config.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) targets: Vec<Target>,
    rows: Rows,
    /// Path of the sweep axis in the config, such as `sweep.0`.
    path: String,
    /// Whether the config sets `paths` instead of `path`. Each entry of `values` is then a list with one value per
    /// field.
    is_joint: bool,
}

#[derive(Debug, Clone)]
enum Rows {
    Listed(Vec<Vec<SweptValue>>),
    Spaced(Range),
    Sampled(Points),
}

impl Rows {
    fn len(&self) -> usize {
        match self {
            Self::Listed(rows) => rows.len(),
            Self::Spaced(range) => range.steps + 1,
            Self::Sampled(points) => points.count,
        }
    }
}

impl Axis {
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn is_range(&self) -> bool {
        matches!(self.rows, Rows::Spaced(_) | Rows::Sampled(_))
    }

    pub(super) fn row(&self, index: usize) -> Cow<'_, [SweptValue]> {
        match &self.rows {
            Rows::Listed(rows) => Cow::Borrowed(&rows[index]),
            Rows::Spaced(range) => Cow::Owned(vec![SweptValue::of_number(range.number(index))]),
            Rows::Sampled(points) => Cow::Owned(points.row(index)),
        }
    }

    /// Path of the place in the config that determines one value of the axis: the value of the field with the index
    /// `column` in the row with the index `row`.
    pub(super) fn location(&self, row: usize, column: usize) -> String {
        let path = &self.path;
        match &self.rows {
            Rows::Listed(_) if self.is_joint => format!("{path}.values.{row}.{column}"),
            Rows::Listed(_) => format!("{path}.values.{row}"),
            Rows::Spaced(_) if row == 0 => format!("{path}.from"),
            Rows::Spaced(range) if row == range.steps => format!("{path}.to"),
            Rows::Spaced(_) | Rows::Sampled(_) => format!("{path}.count"),
        }
    }

    /// Indices of the extreme rows of the sweep axis: the first and the last row, and the rows with the smallest and
    /// the largest number.
    pub(super) fn extremes(&self) -> Vec<usize> {
        let last = self.len() - 1;
        let mut extremes = vec![0, last];
        if !matches!(self.rows, Rows::Spaced(_)) {
            for column in 0..self.targets.len() {
                let numbers = || {
                    let number = |row| as_number(&self.row(row)[column].value);
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

    fn check_rows(&self) -> Result<(), Fault> {
        let twice = match &self.rows {
            Rows::Listed(rows) => {
                let mut seen = HashSet::new();
                rows.iter().position(|row| {
                    let texts = row.iter().map(SweptValue::text);
                    !seen.insert(texts.collect::<Vec<_>>())
                })
            }
            Rows::Sampled(_) => None,
            // The numbers of a range are sorted, so equal numbers can only be neighbours.
            Rows::Spaced(range) => {
                (1..=range.steps).find(|&row| range.number(row) == range.number(row - 1))
            }
        };
        let Some(row) = twice else { return Ok(()) };
        let values = self.row(row);
        let texts: Vec<_> = values.iter().map(SweptValue::text).collect();
        Err(Fault {
            path: self.path.clone(),
            location: self.location(row, 0),
            ..Fault::new(format!("{} occurs twice on this axis", texts.join(", ")))
        })
    }
}

/// A field that a sweep axis sets, and the place where the config names this field: a value of the key `path` or
/// `paths`, or a key in the table `ranges`.
#[derive(Debug, Clone)]
pub(super) struct Target {
    pub(super) path: String,
    pub(super) location: String,
    pub(super) is_key: bool,
}

impl Target {
    pub(super) fn fault(&self, message: String) -> Fault {
        Fault {
            location: self.location.clone(),
            is_key: self.is_key,
            ..Fault::new(message)
        }
    }
}

#[derive(Debug, Clone)]
pub(super) struct SweptValue {
    pub(super) value: Value,
    /// Label of the value if it is a table; otherwise `None`.
    label: Option<String>,
}

impl SweptValue {
    /// A computed value of a range or of a sample. A whole number is stored as an integer, because some fields require
    /// an integer.
    fn of_number(number: f64) -> Self {
        let value = match number.fract() == 0.0 && number.abs() < 2_f64.powi(53) {
            true => Value::Integer(number as i64),
            false => Value::Float(number),
        };
        Self { value, label: None }
    }

    /// A value that the config states. The label of a table is removed from the table and stored separately.
    fn new(value: &Value) -> Result<Self, Fault> {
        let mut value = value.clone();
        let Value::Table(table) = &mut value else {
            return Ok(Self { value, label: None });
        };
        match table.remove("label") {
            Some(Value::String(text)) if !text.is_empty() => {
                let label = Some(text);
                Ok(Self { value, label })
            }
            Some(label) => {
                let found = describe(&label);
                let message = format!("expected a text that is not empty, found {found}");
                Err(Fault::new(message).under("label"))
            }
            None => Err(Fault::new(
                "a table among swept values needs a `label`, which the results show",
            )),
        }
    }

    pub(super) fn text(&self) -> Cow<'_, str> {
        let label = self.label.as_ref();
        label.map_or_else(|| tree::text(&self.value).into(), Into::into)
    }
}

pub(super) fn axes(section: &[SweepConfig]) -> Result<Vec<Axis>, Fault> {
    let mut cells = 1_u64;
    let mut first_beyond = None;
    let mut all_rows = Vec::new();
    for (index, sweep) in section.iter().enumerate() {
        let rows = sweep.rows();
        let rows = rows.map_err(|fault| fault.under(index).under("sweep"))?;
        cells = cells.saturating_mul(rows.len() as u64);
        if cells > MAX_CELLS {
            first_beyond.get_or_insert(index);
        }
        all_rows.push(rows);
    }
    if let Some(index) = first_beyond {
        let message = format!("the axes make {cells} cells; at most {MAX_CELLS} are allowed");
        return Err(Fault::new(message).under(index).under("sweep"));
    }
    let mut axes: Vec<Axis> = Vec::new();
    for (index, (sweep, rows)) in section.iter().zip(all_rows).enumerate() {
        let path = format!("sweep.{index}");
        let targets: Vec<Target> = sweep.located_targets(&path);
        for (place, target) in targets.iter().enumerate() {
            let earlier = axes.iter().flat_map(|axis| &axis.targets);
            check_target(target, earlier.chain(&targets[..place])).map_err(|message| Fault {
                path: path.clone(),
                ..target.fault(message)
            })?;
        }
        let is_joint = sweep.paths.is_some();
        let axis = Axis {
            targets,
            rows,
            path,
            is_joint,
        };
        axis.check_rows()?;
        axes.push(axis);
    }
    Ok(axes)
}

impl SweepConfig {
    /// The first of `keys` that the axis states or, if `is_given` is false, the first that it does not state.
    fn first(&self, keys: &[&'static str], is_given: bool) -> Option<&'static str> {
        let has = |key: &str| match key {
            "path" => self.path.is_some(),
            "paths" => self.paths.is_some(),
            "values" => self.values.is_some(),
            "from" => self.from.is_some(),
            "to" => self.to.is_some(),
            "count" => self.count.is_some(),
            "spacing" => self.spacing.is_some(),
            "sample" => self.sample.is_some(),
            _ => self.ranges.is_some(),
        };
        keys.iter().copied().find(|key| has(key) == is_given)
    }

    /// Rows of the sweep axis. For ranges and sampled points, each row is computed when it is needed.
    fn rows(&self) -> Result<Rows, Fault> {
        let both = |form: &str, others: &[&'static str]| match self.first(others, true) {
            Some(key) => Err(Fault::new(format!(
                "has both `{form}` and `{key}`; keep one form"
            ))),
            None => Ok(()),
        };
        if self.ranges.is_some() || self.sample.is_some() {
            let others = ["path", "paths", "values", "from", "to", "spacing"];
            both("ranges", &others)?;
            return match (&self.ranges, self.count, self.sample) {
                (Some(ranges), Some(count), Some(_)) => points(ranges, count).map(Rows::Sampled),
                _ => {
                    let missing = self.first(&["sample", "ranges", "count"], false);
                    let message = "missing key; points need `sample`, `ranges` and `count`";
                    Err(Fault::new(message).under(missing.unwrap_or_default()))
                }
            };
        }
        match (self.path.is_some(), self.paths.is_some()) {
            (true, true) => {
                return Err(Fault::new("has both `path` and `paths`; keep one of them"));
            }
            (false, false) if self.values.is_some() || self.from.is_some() => {
                return Err(Fault::new("needs `path` or `paths`"));
            }
            _ => {}
        }
        if let Some(values) = &self.values {
            both("values", &["from", "to", "count", "spacing"])?;
            return self.listed(values).map(Rows::Listed);
        }
        match (self.from, self.to, self.count) {
            (Some(_), Some(_), Some(_)) if self.paths.is_some() => {
                Err(Fault::new("a range sets one field; `paths` needs `values`"))
            }
            (Some(from), Some(to), Some(count)) => {
                let spacing = self.spacing.unwrap_or_default();
                range([from, to], count, spacing).map(Rows::Spaced)
            }
            (None, None, None) => {
                let message = "is empty: needs `values`, or `from`, `to` and `count`";
                Err(Fault::new(message))
            }
            _ => {
                let missing = self.first(&["from", "to", "count"], false);
                let message = "missing key; a range needs `from`, `to` and `count`";
                Err(Fault::new(message).under(missing.unwrap_or_default()))
            }
        }
    }

    fn listed(&self, values: &[Value]) -> Result<Vec<Vec<SweptValue>>, Fault> {
        let row = |value: &Value| match (&self.paths, value) {
            (None, value) => Ok(vec![SweptValue::new(value)?]),
            (Some(paths), Value::Array(items)) if items.len() == paths.len() => {
                let items = items.iter().enumerate();
                let values = items.map(|(column, item)| {
                    SweptValue::new(item).map_err(|fault| fault.under(column))
                });
                values.collect()
            }
            (Some(paths), Value::Array(items)) => Err(Fault::new(format!(
                "expected {} values, one for each of `paths`, found {}",
                paths.len(),
                items.len()
            ))),
            (Some(_), other) => Err(Fault::new(format!(
                "expected an array with one value for each of `paths`, found {}",
                describe(other)
            ))),
        };
        let rows = values.iter().enumerate();
        rows.map(|(index, value)| row(value).map_err(|fault| fault.under(index).under("values")))
            .collect()
    }

    fn located_targets(&self, axis: &str) -> Vec<Target> {
        let targets = self.targets().enumerate();
        targets
            .map(|(index, path)| Target {
                path: path.to_owned(),
                location: match (&self.path, &self.paths) {
                    (Some(_), _) => format!("{axis}.path"),
                    (None, Some(_)) => format!("{axis}.paths.{index}"),
                    (None, None) => format!("{axis}.ranges.{path}"),
                },
                is_key: self.ranges.is_some(),
            })
            .collect()
    }
}

/// Quasi-random points of a sampled axis: Sobol's sequence, scaled to the ranges of the fields.
#[derive(Debug, Clone)]
struct Points {
    count: usize,
    ranges: Vec<RangeConfig>,
}

/// Largest number of points (`MOST_POINTS`) and largest number of fields (`MOST_FIELDS`) for which Sobol's sequence is
/// implemented.
const MOST_POINTS: u32 = 65_536;
const MOST_FIELDS: usize = 256;

impl Points {
    fn row(&self, index: usize) -> Vec<SweptValue> {
        let ranges = self.ranges.iter().enumerate();
        let value = |(dimension, range): (usize, &RangeConfig)| {
            let share = sobol_burley::sample(index as u32, dimension as u32, 0);
            let number = range
                .spacing
                .between(range.from, range.to, f64::from(share));
            SweptValue::of_number(number)
        };
        ranges.map(value).collect()
    }
}

fn points(ranges: &BTreeMap<String, RangeConfig>, count: u32) -> Result<Points, Fault> {
    if count > MOST_POINTS {
        let message = format!("must be <= {MOST_POINTS} for sampled points, is {count}");
        return Err(Fault::new(message).under("count"));
    }
    if ranges.is_empty() || ranges.len() > MOST_FIELDS {
        let message = format!("needs 1 to {MOST_FIELDS} fields, has {}", ranges.len());
        return Err(Fault::new(message).under("ranges"));
    }
    for (path, RangeConfig { from, to, spacing }) in ranges {
        let message = if from >= to {
            format!("`from` must be < `to`: {from} is not < {to}")
        } else if *from <= 0.0 && *spacing == Spacing::Log {
            format!("`from` must be > 0 where spacing = \"log\", is {from}")
        } else {
            continue;
        };
        return Err(Fault::new(message).under(path).under("ranges"));
    }
    Ok(Points {
        count: count as usize,
        ranges: ranges.values().cloned().collect(),
    })
}

/// Rejects a field that cannot be swept, or that an earlier axis already sweeps. The error states the reason.
fn check_target<'a>(
    target: &Target,
    mut before: impl Iterator<Item = &'a Target>,
) -> Result<(), String> {
    let path = target.path.as_str();
    if !matches!(path.split('.').next(), Some("scene" | "seed" | "trials")) {
        return Err(format!(
            "cannot sweep `{path}`; a sweep sets fields of `scene`, `seed` or `trials`"
        ));
    }
    let covers = |part: &str| {
        part.strip_prefix(path)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    match before.find(|earlier| covers(&earlier.path)) {
        Some(earlier) if earlier.path == path => Err(format!("`{path}` is swept twice")),
        Some(earlier) => Err(format!(
            "`{path}` would overwrite `{}`, which is swept before it",
            earlier.path
        )),
        None => Ok(()),
    }
}

/// The numbers of a range (`from`, `to`, `count`, `spacing`). Each number is computed when it is needed.
#[derive(Debug, Clone)]
struct Range {
    ends: [f64; 2],
    steps: usize,
    spacing: Spacing,
}

impl Range {
    fn number(&self, index: usize) -> f64 {
        let [first, last] = self.ends;
        match index {
            0 => first,
            _ if index == self.steps => last,
            _ => self
                .spacing
                .between(first, last, index as f64 / self.steps as f64),
        }
    }
}

fn range(ends: [f64; 2], count: u32, spacing: Spacing) -> Result<Range, Fault> {
    let [from, to] = ends.map(number_text);
    let not_positive = ends.iter().position(|end| *end <= 0.0);
    if let Some(place) = not_positive.filter(|_| spacing == Spacing::Log) {
        let end = [&from, &to][place];
        let message = format!("must be > 0 where spacing = \"log\", is {end}");
        return Err(Fault::new(message).under(["from", "to"][place]));
    }
    if count == 1 && ends[0] != ends[1] {
        let message = format!("a range from {from} to {to} needs at least 2 values");
        return Err(Fault::new(message).under("count"));
    }
    Ok(Range {
        ends,
        steps: count as usize - 1,
        spacing,
    })
}

/// The number, rounded to 12 digits: 0.3 instead of 0.30000000000000004. The last digits of logarithms may differ
/// between machines; after rounding, the result is the same on all machines.
pub(super) fn rounded(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}
