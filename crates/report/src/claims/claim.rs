//! Description of a claim as data: the rows of a table to which the claim applies, and the checks that decide on the
//! claim.

use super::bounds::{Bound, near, within};
use super::check::{Check, Keep, Outcome, Portion, Role};
use super::row::{Row, groups, sorted};
use crate::{Study, phrases};

/// A claim of a paper and its checks. Methods such as `values` add a check. The methods that restrict or describe a
/// check change only the check that was added last.
pub(super) struct Claim {
    pub(super) number: u32,
    /// The claim in at most six words.
    pub(super) title: &'static str,
    pub(super) published: &'static str,
    pub(super) paper_says: &'static str,
    rows: Keep,
    /// Words that describe, in error messages, the rows of the table to which the claim applies.
    what: &'static str,
    numbers: &'static [&'static str],
    needs: Vec<(String, Keep)>,
    checks: Vec<Check>,
    remark: &'static str,
}

#[derive(Default)]
pub(super) struct Finding {
    pub(super) holds: bool,
    pub(super) measured: String,
    pub(super) headline: String,
    pub(super) why: String,
}

impl Claim {
    /// Creates a claim that applies to the rows of the table that `rows` accepts. `what` describes these rows in error
    /// messages.
    pub(super) fn new(
        number: u32,
        [title, published, paper_says]: [&'static str; 3],
        what: &'static str,
        rows: impl Fn(&Row<'_>) -> bool + 'static,
    ) -> Self {
        Self {
            number,
            title,
            published,
            paper_says,
            rows: Box::new(rows),
            what,
            numbers: &[],
            needs: Vec::new(),
            checks: Vec::new(),
            remark: "",
        }
    }

    /// Requires a numeric value of some config fields in every table row to which the claim applies. `numbers` contains
    /// the paths of these fields.
    pub(super) fn numbers(self, numbers: &'static [&'static str]) -> Self {
        Self { numbers, ..self }
    }

    /// Requires at least one row of the table that `is_it` accepts. `what` describes this row in the error message.
    pub(super) fn needs(
        mut self,
        what: impl Into<String>,
        is_it: impl Fn(&Row<'_>) -> bool + 'static,
    ) -> Self {
        self.needs.push((what.into(), Box::new(is_it)));
        self
    }

    /// Sets a remark, which is printed after the rules of the checks.
    pub(super) fn remark(self, remark: &'static str) -> Self {
        Self { remark, ..self }
    }

    /// Adds a check. `values` computes its values from the rows of the table, and returns each value with a row from
    /// which it was computed.
    pub(super) fn values(
        mut self,
        values: impl for<'a> Fn(&[Row<'a>]) -> Vec<(Row<'a>, f64)> + 'static,
    ) -> Self {
        self.checks.push(Check {
            keep: Vec::new(),
            values: Box::new(values),
            name: None,
            merge: None,
            compared: None,
            without: None,
            bound: None,
            portion: Portion::All,
            role: Role::Decides,
            says: String::new(),
            headline: "",
        });
        self
    }

    /// Adds a check with one value per row of the table: `value(row)`. Rows without a value (`None`) are left out.
    pub(super) fn rows(self, value: impl Fn(&Row<'_>) -> Option<f64> + 'static) -> Self {
        self.values(move |rows| {
            let values = rows.iter().filter_map(|row| Some((*row, value(row)?)));
            values.collect()
        })
    }

    /// Adds a check with one value per group of table rows. The rows of a group differ only in swept fields whose paths
    /// begin with one of the texts in `free`.
    pub(super) fn groups(
        self,
        free: &'static [&'static str],
        value: impl Fn(&[Row<'_>]) -> Option<f64> + 'static,
    ) -> Self {
        self.values(move |rows| {
            let groups = groups(rows, free).into_iter();
            let values = groups.filter_map(|group| Some((group[0], value(&group)?)));
            values.collect()
        })
    }

    /// Adds a check of the ratios y₂/y₁. The rows of a group of table rows are sorted by `x`, and y₁ and y₂ are the
    /// values of `y` in two successive rows. The rows of a group differ only in swept fields whose paths begin with one
    /// of the texts in `free`.
    pub(super) fn steps(
        self,
        free: &'static [&'static str],
        x: impl Fn(&Row<'_>) -> Option<f64> + 'static,
        y: impl Fn(&Row<'_>) -> Option<f64> + 'static,
    ) -> Self {
        self.values(move |rows| {
            let mut ratios = Vec::new();
            for group in groups(rows, free) {
                for pair in sorted(&group, &x, &y).windows(2) {
                    let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
                    let ratio = if near(y0, y1) || y0 == y1 {
                        1.0
                    } else {
                        y1 / y0
                    };
                    ratios.extend((!near(x0, x1)).then_some((group[0], ratio)));
                }
            }
            ratios
        })
    }

    /// Adds a check of the ratios `value(one) / value(other)` for all pairs of table rows that `is_pair` accepts. The
    /// rows of a pair differ only in swept fields whose paths begin with one of the texts in `free`. Each ratio is
    /// returned with the row `other`.
    pub(super) fn pairs(
        self,
        free: &'static [&'static str],
        is_pair: impl Fn(&Row<'_>, &Row<'_>) -> bool + 'static,
        value: impl Fn(&Row<'_>) -> Option<f64> + 'static,
    ) -> Self {
        self.values(move |rows| {
            let mut ratios = Vec::new();
            for group in groups(rows, free) {
                for one in &group {
                    let others = group.iter().filter(|other| is_pair(one, other));
                    let ratio = |other: &Row<'_>| Some(value(one)? / value(other)?);
                    ratios.extend(others.filter_map(|other| Some((*other, ratio(other)?))));
                }
            }
            ratios
        })
    }

    fn last(mut self, change: impl FnOnce(&mut Check)) -> Self {
        self.checks.last_mut().map(change);
        self
    }

    /// Restricts the check that was added last to the table rows for which `keep` returns true.
    pub(super) fn when(self, keep: impl Fn(&Row<'_>) -> bool + 'static) -> Self {
        self.last(|check| check.keep.push(Box::new(keep)))
    }

    /// Restricts the check that was added last to the table rows of the quantity `quantity`.
    pub(super) fn of(self, quantity: &'static str) -> Self {
        self.when(move |row| row.quantity() == quantity)
    }

    /// Restricts the check that was added last to the table rows for which `number(row)` meets a bound.
    pub(super) fn only(
        self,
        number: impl Fn(&Row<'_>) -> Option<f64> + 'static,
        bound: Bound,
    ) -> Self {
        self.when(within(number, bound))
    }

    /// In the check that was added last, ignores all values that equal `value`.
    pub(super) fn without(self, value: f64) -> Self {
        self.last(|check| check.without = Some(value))
    }

    /// Names the values of the check that was added last. All values with the same name are compared and printed as one
    /// range.
    pub(super) fn named(self, name: fn(&Row<'_>) -> String) -> Self {
        self.last(|check| check.name = Some(name))
    }

    pub(super) fn merged(self, merge: fn(&[f64]) -> f64) -> Self {
        self.last(|check| check.merge = Some(merge))
    }

    /// In the check that was added last, compares only the values of the table rows that `compared` accepts with the
    /// bound. The values of all other rows are only printed.
    pub(super) fn comparing(self, compared: fn(&Row<'_>) -> bool) -> Self {
        self.last(|check| check.compared = Some(compared))
    }

    pub(super) fn bound(self, bound: Bound) -> Self {
        self.last(|check| check.bound = Some(bound))
    }

    /// At least this share of the values of the check that was added last must meet the bound. By default, all values
    /// must meet it.
    pub(super) fn in_share(self, share: f64) -> Self {
        self.last(|check| check.portion = Portion::Share(share))
    }

    /// At least one value of the check that was added last must meet the bound. By default, all values must meet it.
    pub(super) fn in_one(self) -> Self {
        self.last(|check| check.portion = Portion::One)
    }

    /// Skips the check that was added last if it has no values. By default, a claim is not testable if one of its
    /// checks has no values.
    pub(super) fn if_present(self) -> Self {
        self.last(|check| check.role = Role::DecidesIfPresent)
    }

    /// Sets the sentence, without the full stop, of the check that was added last. The sentence is used twice: for the
    /// result, with the values, and for the rule, with the bound.
    ///
    /// In the result, placeholders are replaced: `{count}` by the number of compared values that meet the bound, `{n}`
    /// by the number of all values, `{range}` and `{max}` by the range and the largest of the compared values, and
    /// `{list}` by all values. With `%` before the closing brace, numbers are in percent. In the rule, the bound
    /// replaces every placeholder. Text after a `|` appears only in the result.
    pub(super) fn says(self, says: impl Into<String>) -> Self {
        self.last(|check| check.says = says.into())
    }

    /// Sets the sentence of a check that is only printed and does not affect the verdict.
    pub(super) fn reports(self, says: impl Into<String>) -> Self {
        self.says(says).last(|check| check.role = Role::Reports)
    }

    /// Sets the measured value that the scorecard shows for the check that was added last. It may contain the same
    /// placeholders as [`Self::says`].
    pub(super) fn headline(self, headline: &'static str) -> Self {
        self.last(|check| check.headline = headline)
    }

    /// Tests the claim with the tables of a study. Returns an error if the tables lack rows or numbers; the error names
    /// them.
    pub(super) fn finding(&self, study: &Study) -> Result<Finding, String> {
        let rows: Vec<Row<'_>> = Row::all(study).filter(|row| (self.rows)(row)).collect();
        if rows.is_empty() {
            return Err(format!("the table has no {}", self.what));
        }
        let lacks = |path: &&&str| rows.iter().any(|row| row.number(path).is_none());
        if let Some(path) = self.numbers.iter().find(lacks) {
            return Err(format!("no number for {path} in the table or the config"));
        }
        let lacks = |need: &&(String, Keep)| !rows.iter().any(|row| need.1(row));
        if let Some((what, _)) = self.needs.iter().find(lacks) {
            return Err(format!("the table has no {what}"));
        }
        let outcomes = self.checks.iter().map(|check| check.outcome(&rows));
        let outcomes = outcomes.collect::<Result<Vec<_>, _>>()?;
        let outcomes: Vec<Outcome> = outcomes.into_iter().flatten().collect();
        let (measured, headline) = (
            joined(&outcomes, |one| &one.measured),
            joined(&outcomes, |one| &one.headline),
        );
        let deciding = outcomes.iter().filter(|outcome| outcome.decides);
        let mut why = format!("Holds if {}.", joined(deciding.clone(), |one| &one.rule));
        if !self.remark.is_empty() {
            why += &format!(" {}", self.remark);
        }
        let close: Vec<&str> = outcomes
            .iter()
            .flat_map(|one| &one.close)
            .map(String::as_str)
            .collect();
        if !close.is_empty() {
            why += &format!(
                " The verdict is close: within 1 % of a limit is {}.",
                close.join("; ")
            );
        }
        Ok(Finding {
            holds: deciding.clone().all(|outcome| outcome.holds),
            measured: phrases::sentence(&[], &measured),
            headline,
            why,
        })
    }
}

/// Computes `text(outcome)` for each outcome, and joins the texts by semicolons. Empty texts are left out.
fn joined<'a>(
    outcomes: impl IntoIterator<Item = &'a Outcome>,
    text: fn(&Outcome) -> &String,
) -> String {
    let texts = outcomes.into_iter().map(|one| text(one).as_str());
    texts
        .filter(|text| !text.is_empty())
        .collect::<Vec<_>>()
        .join("; ")
}
