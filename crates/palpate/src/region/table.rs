//! Tables of a region.

use palpate_study::{Table, number};

use super::found::Region;
use crate::design::verdict;

impl Region {
    /// Table of all trials: that of each column's answer ([`Answer::table`](crate::Answer::table)), behind the values of the
    /// grid.
    pub fn table(&self) -> Table {
        let fields = self.grid.iter().map(|field| field.column.clone());
        let tables: Vec<Table> = self
            .columns
            .iter()
            .map(|column| column.answer.table())
            .collect();
        let header = tables.first().map_or(&[][..], |table| &table.header);
        let mut all = Table::new(fields.chain(header.iter().cloned()));
        for (place, table) in tables.into_iter().enumerate() {
            let at = self.texts(place);
            let rows = table.rows.into_iter();
            all.rows
                .extend(rows.map(|row| at.iter().cloned().chain(row).collect()));
        }
        all
    }

    /// Table of what was found: a row per run of values of the searched field that meet the target, or miss it, behind the
    /// values of the grid. What is between runs is undecided.
    pub fn runs(&self) -> Table {
        let column = &self.searched().column;
        let fields = self.grid.iter().map(|field| field.column.clone());
        let ends = [format!("{column}.from"), format!("{column}.to")];
        let header = fields.chain(ends).chain(["verdict".to_owned()]);
        let mut table = Table::new(header);
        for (place, column) in self.columns.iter().enumerate() {
            let field = &column.answer.field;
            let text = |value: f64| match field.is_listed() {
                true => field.text(value),
                false => number::shortest(value),
            };
            for run in &column.answer.runs {
                let ends = [
                    text(run.from),
                    text(run.to),
                    verdict(Some(run.side)).to_owned(),
                ];
                table
                    .rows
                    .push(self.texts(place).into_iter().chain(ends).collect());
            }
        }
        table
    }

    /// Values of the grid at a column, as results show them.
    fn texts(&self, place: usize) -> Vec<String> {
        let pairs = self.grid.iter().zip(&self.columns[place].at);
        pairs.map(|(field, value)| field.text(*value)).collect()
    }
}
