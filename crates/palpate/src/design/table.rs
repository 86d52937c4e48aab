//! Tables of a design's answer.

use palpate_study::{Table, number};
use palpate_sweep::Side;

use super::answer::{Answer, LookedAt, Sample};

impl Answer {
    /// Table of all trials: one row per value, cell and sample (what the search saw, and the fresh trials that verify),
    /// with the target's statistic, its standard error, and the side on which the value lies.
    pub fn table(&self) -> Table {
        let quantity = self.target.quantity.map_or("", |quantity| quantity.name);
        let fields = [self.field.column.as_str(), "cell"].into_iter();
        let statistics = [
            "quantity",
            "unit",
            "sample",
            "trials",
            "failures",
            self.target.statistic.name(),
            "std_error",
            "verdict",
        ];
        let columns = self.columns.iter().map(String::as_str);
        let header = fields.chain(columns).chain(statistics);
        let mut table = Table::new(header.map(str::to_owned));
        let mut push = |looked: &LookedAt, name: &str, sample: &Sample| {
            let text = |number: Option<f64>| number.map_or(String::new(), number::shortest);
            let fields = [self.field.text(looked.value), sample.cell.to_string()].into_iter();
            let coordinates = self.cells.get(sample.cell).into_iter().flatten().cloned();
            let statistics = [
                quantity.to_owned(),
                self.unit.to_owned(),
                name.to_owned(),
                sample.trials.to_string(),
                sample.failed.to_string(),
                text(sample.statistic.map(|(value, _)| value)),
                text(sample.statistic.map(|(_, std)| std)),
                verdict(looked.side).to_owned(),
            ];
            let row = fields.chain(coordinates).chain(statistics);
            table.rows.push(row.collect());
        };
        for looked in &self.looked {
            looked
                .searched
                .iter()
                .for_each(|sample| push(looked, "search", sample));
            looked
                .fresh
                .iter()
                .for_each(|sample| push(looked, "fresh", sample));
        }
        table
    }
}

/// Side of a value as a word.
pub(crate) fn verdict(side: Option<Side>) -> &'static str {
    match side {
        Some(Side::Meets) => "meets",
        Some(Side::Misses) => "misses",
        None => "undecided",
    }
}
