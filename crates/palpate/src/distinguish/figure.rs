//! Figure of what is told apart.

use palpate_report::{Figure, Heat, HeatPanel, ReportError};
use palpate_study::{Label, Quantity, label, number};

use super::found::{Group, ToldApart};

impl ToldApart {
    /// Heat map of how surely every two objects are told apart by one trial of each, a panel per group. `name` is that of
    /// its files.
    ///
    /// # Errors
    /// [`ReportError`] where it cannot be drawn.
    pub fn figure(&self, name: &str, title: &str) -> Result<Figure, ReportError> {
        let panel = |group: &Group| {
            let count = group.objects.len();
            let mut shares = vec![vec![None; count]; count];
            for pair in &group.pairs {
                let share = pair.order.map(|order| order.probability);
                shares[pair.first][pair.second] = share;
                shares[pair.second][pair.first] = share;
            }
            HeatPanel {
                title: self.settings_in_words(group),
                names: group
                    .objects
                    .iter()
                    .map(|object| self.object_in_words(object))
                    .collect(),
                shares,
            }
        };
        let by = label::quantity(self.quantity.name);
        let told = match self.quantity == Quantity::CLASS {
            true => "classes of most places of both right".to_owned(),
            false => format!("estimates of {by} in the right order"),
        };
        let trials: Vec<u64> = self
            .groups
            .iter()
            .flat_map(|group| group.objects.iter().map(|object| object.trials))
            .collect();
        let most = trials.iter().max().copied().unwrap_or(0);
        let objects: Vec<String> = self
            .object_columns
            .iter()
            .map(|column| Label::of_field(column).words)
            .collect();
        palpate_report::heat_figure(&Heat {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: format!(
                "Share of pairs of single trials with {told}; {} trials of each object.",
                number::grouped(most)
            ),
            axis: objects.join(", "),
            panels: self.groups.iter().map(panel).collect(),
            notes: vec![
                "A trial that fails, and estimates that are alike, do not tell.".to_owned(),
            ],
        })
    }
}
