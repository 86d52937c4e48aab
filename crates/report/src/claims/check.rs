//! A check of a claim. It computes values from the rows of a table, compares them with a bound, and describes values
//! and bound in sentences.

use super::bounds::{Bound, percent, range, short, span};
use super::row::Row;
use crate::records::by_key;

/// A sentence lists at most this many values one by one. For more values, it states only the lowest and the highest.
const LONGEST_LIST: usize = 8;

/// How a check affects the verdict on its claim.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// The claim holds only if the check meets its bound. If the check has no values, the claim is not testable.
    Decides,
    /// The claim holds only if the check meets its bound. If the check has no values, it is skipped.
    DecidesIfPresent,
    /// The check is printed, but it does not affect the verdict.
    Reports,
}

#[derive(Clone, Copy)]
pub(super) enum Portion {
    All,
    Share(f64),
    One,
}

pub(super) type Keep = Box<dyn Fn(&Row<'_>) -> bool>;
pub(super) type Values = Box<dyn for<'a> Fn(&[Row<'a>]) -> Vec<(Row<'a>, f64)>>;

/// A check of a claim. It contains a function that computes values from the study's table, and the bound that the
/// values must meet.
pub(super) struct Check {
    pub(super) keep: Vec<Keep>,
    /// Computes the checked values from the rows of the table. Each value is returned with the row from which it was
    /// computed. If a value was computed from several rows, it is returned with one of these rows.
    pub(super) values: Values,
    /// Returns a name for the value that was computed from a row of the table. All values with the same name form one
    /// range: the range is compared with the bound and printed. With `None`, each value is compared by itself.
    pub(super) name: Option<fn(&Row<'_>) -> String>,
    pub(super) merge: Option<fn(&[f64]) -> f64>,
    /// Selects the rows of the table whose values are compared with the bound; `None` selects all rows. The values of
    /// all other rows are only printed.
    pub(super) compared: Option<fn(&Row<'_>) -> bool>,
    /// Computed values that equal this number are left out of the check; with `None`, no value is left out.
    pub(super) without: Option<f64>,
    pub(super) bound: Option<Bound>,
    pub(super) portion: Portion,
    pub(super) role: Role,
    pub(super) says: String,
    pub(super) headline: &'static str,
}

pub(super) struct Outcome {
    pub(super) decides: bool,
    pub(super) holds: bool,
    /// Sentence with the values that were computed from the table.
    pub(super) measured: String,
    /// Sentence that states the bound which the values must meet.
    pub(super) rule: String,
    /// The measured value that the scorecard shows for this check; may be empty.
    pub(super) headline: String,
    /// Names of the checked values that are within 1 % of a limit of the bound, so that a small change of the value
    /// could change the verdict.
    pub(super) close: Vec<String>,
}

/// Range of all checked values with the same name. `compared` states whether the range is compared with the bound, and
/// `met` whether it meets the bound.
struct Item {
    name: String,
    range: (f64, f64),
    compared: bool,
    met: bool,
}

impl Check {
    /// Applies the check to `rows`, the table rows to which its claim applies. Returns an error if the check needs rows
    /// that are missing. Returns `None` if the check has no values and may be skipped.
    pub(super) fn outcome(&self, rows: &[Row<'_>]) -> Result<Option<Outcome>, String> {
        let is_kept = |row: &&Row<'_>| self.keep.iter().all(|keep| keep(row));
        let rows: Vec<Row<'_>> = rows.iter().filter(is_kept).copied().collect();
        let items = self.items(&rows);
        let compared: Vec<&Item> = items.iter().filter(|item| item.compared).collect();
        if compared.is_empty() {
            let says = filled(self.rule_part(), |_, _| Some("…".to_owned()));
            return match self.role {
                Role::Decides => Err(format!("the table lacks the rows to find that {says}")),
                _ => Ok(None),
            };
        }
        let met = compared.iter().filter(|item| item.met).count();
        let holds = match self.portion {
            Portion::All => met == compared.len(),
            Portion::Share(share) => met as f64 >= share * compared.len() as f64,
            Portion::One => met > 0,
        };
        let decides = self.role != Role::Reports;
        let limit = self.bound.and_then(Bound::limit).filter(|_| decides);
        let is_close = |item: &&&Item| {
            let is_near = |limit: f64| (item.range.1 / limit - 1.0).abs() <= 0.01;
            !item.name.is_empty() && limit.is_some_and(is_near)
        };
        let close = compared.iter().filter(is_close);
        let shown = |text: &str| filled(text, |key, show| shown(key, &items, &compared, met, show));
        Ok(Some(Outcome {
            decides,
            holds,
            measured: shown(&self.says.replace('|', "")),
            rule: self.rule(),
            headline: shown(self.headline),
            close: close.map(|item| item.name.clone()).collect(),
        }))
    }

    fn items(&self, rows: &[Row<'_>]) -> Vec<Item> {
        let values = (self.values)(rows).into_iter();
        let values = values.filter(|(_, value)| self.without != Some(*value));
        let named: Vec<(String, Vec<(Row<'_>, f64)>)> = match self.name {
            Some(name) => by_key(values.map(|value| (name(&value.0), value))),
            None => values.map(|value| (String::new(), vec![value])).collect(),
        };
        let item = |(name, values): (String, Vec<(Row<'_>, f64)>)| {
            let numbers: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
            let merged = self.merge.map(|merge| merge(&numbers));
            let range = merged.map_or_else(|| range(numbers), |number| Some((number, number)))?;
            let is_met = |bound: Bound| bound.holds(range.0) && bound.holds(range.1);
            Some(Item {
                name,
                range,
                compared: self.compared.is_none_or(|compared| compared(&values[0].0)),
                met: self.bound.is_none_or(is_met),
            })
        };
        named.into_iter().filter_map(item).collect()
    }

    fn rule_part(&self) -> &str {
        self.says.split('|').next().unwrap_or_default()
    }

    fn rule(&self) -> String {
        let counts = self.says.contains("{count}");
        let says = filled(self.rule_part(), |_, show| match self.portion {
            Portion::All if counts => Some("all".to_owned()),
            Portion::Share(share) if counts => Some(format!("at least {} of the", percent(share))),
            Portion::One if counts => Some("some".to_owned()),
            _ => self.bound.map(|bound| bound.words(show)),
        });
        match self.portion {
            Portion::One if !counts => format!("in at least one case {says}"),
            _ => says,
        }
    }
}

/// Text that replaces the placeholder `{key}` in the sentence of a check; `None` if there is no placeholder with the
/// name `key`.
fn shown(
    key: &str,
    items: &[Item],
    compared: &[&Item],
    met: usize,
    show: fn(f64) -> String,
) -> Option<String> {
    let ranges = || {
        range(
            compared
                .iter()
                .flat_map(|item| [item.range.0, item.range.1]),
        )
    };
    let listed = |item: &Item| match (span(item.range, show), item.name.as_str()) {
        (values, "") => values,
        (values, name) => format!("{values} ({name})"),
    };
    match key {
        "count" => Some(format!("{met} of {}", compared.len())),
        "n" => Some(items.len().to_string()),
        "range" => ranges().map(|range| span(range, show)),
        "max" => ranges().map(|(_, high)| show(high)),
        "list" if items.len() > LONGEST_LIST => {
            let lowest = items
                .iter()
                .min_by(|a, b| a.range.0.total_cmp(&b.range.0))?;
            let highest = items
                .iter()
                .max_by(|a, b| a.range.1.total_cmp(&b.range.1))?;
            let (low, high) = (listed(lowest), listed(highest));
            Some(format!("{low} to {high} in {} cases", items.len()))
        }
        "list" => Some(items.iter().map(listed).collect::<Vec<_>>().join(", ")),
        _ => None,
    }
}

/// Replaces each placeholder `{key}` of a sentence by `text(key)`. In a placeholder `{key%}`, numbers are formatted in
/// percent.
fn filled(sentence: &str, text: impl Fn(&str, fn(f64) -> String) -> Option<String>) -> String {
    let mut parts = sentence.split('{');
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (key, rest) = part.split_once('}').unwrap_or((part, ""));
        let share = key.strip_suffix('%');
        let shown = share.map_or_else(|| text(key, short), |key| text(key, percent));
        filled += &shown.unwrap_or_default();
        filled += rest;
    }
    filled
}
