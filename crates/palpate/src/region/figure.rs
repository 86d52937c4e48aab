//! Figure of a region.

use palpate_report::{
    Figure, RegionAxis, RegionMap, RegionPanel, RegionStrip, ReportError, Stretch, region_figure,
};
use palpate_sweep::Side;

use super::found::{Column, Region};
use crate::design::Field;

impl Region {
    /// Figure of the region: the searched field over the last field of the grid, in a panel for each combination of the
    /// others; without a grid, the curve of the answer. `name` is that of its files.
    ///
    /// # Errors
    /// [`ReportError`] where it cannot be drawn.
    pub fn figure(&self, name: &str, title: &str) -> Result<Figure, ReportError> {
        let Some((last, further)) = self.grid.split_last() else {
            return self.columns[0].answer.figure(name, title);
        };
        let mut panels: Vec<(&[f64], Vec<&Column>)> = Vec::new();
        for column in &self.columns {
            let key = &column.at[..further.len()];
            match panels.iter_mut().find(|(known, _)| *known == key) {
                Some((_, columns)) => columns.push(column),
                None => panels.push((key, vec![column])),
            }
        }
        // A value beside the grid that was looked at for the best one is no panel.
        if panels.iter().any(|(_, columns)| columns.len() > 1) {
            panels.retain(|(_, columns)| columns.len() > 1);
        }
        let best = self.best().map(|best| (best.column, best.searched));
        let panel = |(key, columns): &(&[f64], Vec<&Column>)| {
            let pairs = further.iter().zip(*key);
            let words = pairs
                .map(|(field, value)| format!("{} {}", field.label.words, field.value(*value)));
            let here = best.filter(|(best, _)| columns.iter().any(|column| column.at == best.at));
            RegionPanel {
                title: words.collect::<Vec<_>>().join(", "),
                columns: columns.iter().map(|column| strip(column)).collect(),
                best: here.map(|(column, y)| (column.at[further.len()], y)),
            }
        };
        let panels: Vec<RegionPanel> = panels.iter().map(panel).collect();
        let words = self.sought.as_ref().map(|sought| {
            let (field, _) = self.sought_field(sought);
            format!("{} {}", sought.extreme.word(), field.label.words)
        });
        let is_marked = panels.iter().any(|panel| panel.best.is_some());
        region_figure(&RegionMap {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: format!("Target: {}.", self.columns[0].answer.target_in_words()),
            notes: vec![self.sentence()],
            x: axis(last),
            y: axis(self.searched()),
            panels,
            best: words.filter(|_| is_marked),
        })
    }
}

fn strip(column: &Column) -> RegionStrip {
    let stretch = |run: &palpate_sweep::Run| Stretch {
        from: run.from,
        to: run.to,
        meets: run.side == Side::Meets,
    };
    RegionStrip {
        x: column.at[column.at.len() - 1],
        runs: column.answer.runs.iter().map(stretch).collect(),
    }
}

fn axis(field: &Field) -> RegionAxis {
    let names = 0..field.listed.len();
    RegionAxis {
        label: field.label.clone(),
        is_log: field.span.is_log,
        ends: (field.span.from, field.span.to),
        names: names.map(|place| field.text(place as f64)).collect(),
    }
}
