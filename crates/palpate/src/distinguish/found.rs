//! How surely objects are told apart.

use palpate_study::{Quantity, Table, number};
use palpate_sweep::{Order, Repeats, TrialMeans};

/// How surely the objects of a study are told apart, by one trial of each and by the mean of several.
#[derive(Clone, Debug, PartialEq)]
pub struct ToldApart {
    /// Quantity by which they are.
    pub quantity: Quantity,
    /// Its unit, as in `cells.csv`.
    pub unit: &'static str,
    /// Required probability that the means of repeated trials distinguish two objects.
    pub confidence: f64,
    /// Name of the repeated experiment: presses, glides, or trials of several rolls.
    pub trials: String,
    /// Columns of the swept fields that make the objects.
    pub object_columns: Vec<String>,
    /// Columns of the other swept fields.
    pub columns: Vec<String>,
    /// Objects that differ in nothing else, for each combination of the other swept fields.
    pub groups: Vec<Group>,
}

/// Objects with the same other settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Values of the other swept fields, as results show them.
    pub settings: Vec<String>,
    /// The objects, by growing truth; of classes, in the order of the config.
    pub objects: Vec<Object>,
    /// Every two of them.
    pub pairs: Vec<Pair>,
}

/// Object of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Number of its cell.
    pub cell: usize,
    /// Swept values that make it, as results show them.
    pub label: Vec<String>,
    /// True value of the quantity, over a patch its mean; `None` where every trial failed.
    pub truth: Option<f64>,
    /// True class of most places of a patch, where that is asked for.
    pub class: Option<String>,
    /// Trials run.
    pub trials: u64,
    /// Number of them that failed.
    pub failed: u64,
    /// Mean of the estimates; `None` where every trial failed.
    pub mean: Option<f64>,
}

/// Two objects of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Place of one among the objects.
    pub first: usize,
    /// Place of the other, which is behind it.
    pub second: usize,
    /// Probability that one trial of each tells them apart; `None` where they do not differ in the quantity.
    pub order: Option<Order>,
    /// Trials of each whose mean does, with the confidence that is asked for; `None` where they do not differ.
    pub repeats: Option<Repeats>,
}

impl Object {
    pub(crate) fn of(
        cell: usize,
        label: Vec<String>,
        told: &[TrialMeans],
        class: Option<String>,
    ) -> Self {
        let count = told.iter().flatten().count();
        let mean = |of: fn(&(f64, f64)) -> f64| {
            let shares = told.iter().flatten().map(|told| of(told) / count as f64);
            (count > 0)
                .then(|| shares.sum::<f64>())
                .filter(|mean| mean.is_finite())
        };
        // The same in all trials, but for rounding; of a press's indentation it may differ.
        let first = told.iter().flatten().next().map(|(_, truth)| *truth);
        let is_same = told
            .iter()
            .flatten()
            .all(|(_, truth)| Some(*truth) == first);
        Self {
            cell,
            label,
            truth: if is_same {
                first
            } else {
                mean(|(_, truth)| *truth)
            },
            class,
            trials: told.len() as u64,
            failed: (told.len() - count) as u64,
            mean: mean(|(estimate, _)| *estimate),
        }
    }
}

impl ToldApart {
    /// Table with one row per pair of objects: both objects, the probability that one trial of each tells them apart with
    /// its 95 % interval, and the trials whose mean does with the confidence that was asked for.
    pub fn table(&self) -> Table {
        let names = |of: &str| -> Vec<String> {
            self.object_columns
                .iter()
                .map(|column| format!("{of}.{column}"))
                .collect()
        };
        let (first, second) = (names("first"), names("second"));
        let statistics = [
            "quantity",
            "unit",
            "first_truth",
            "second_truth",
            "first_trials",
            "second_trials",
            "first_failures",
            "second_failures",
            "told_apart",
            "low95",
            "high95",
            "repeats",
            "repeats_are",
        ];
        let fields = self.columns.iter().cloned().chain(first).chain(second);
        let mut table = Table::new(fields.chain(statistics.map(str::to_owned)));
        let text = |number: Option<f64>| number.map_or(String::new(), number::shortest);
        for group in &self.groups {
            for pair in &group.pairs {
                let [one, other] = [pair.first, pair.second].map(|place| &group.objects[place]);
                let truth = |object: &Object| match &object.class {
                    Some(class) => class.clone(),
                    None => text(object.truth),
                };
                let (repeats, known) = match pair.repeats {
                    Some(Repeats::Found(count)) => (count.to_string(), "found"),
                    Some(Repeats::About(count)) => (count.to_string(), "estimated"),
                    Some(Repeats::Never) => (String::new(), "never-enough"),
                    Some(Repeats::Unknown) => (String::new(), "unknown"),
                    None => (String::new(), "alike"),
                };
                let order = pair.order;
                let statistics = [
                    self.quantity.name.to_owned(),
                    self.unit.to_owned(),
                    truth(one),
                    truth(other),
                    one.trials.to_string(),
                    other.trials.to_string(),
                    one.failed.to_string(),
                    other.failed.to_string(),
                    text(order.map(|order| order.probability)),
                    text(order.map(|order| order.low)),
                    text(order.map(|order| order.high)),
                    repeats,
                    known.to_owned(),
                ];
                let labels = group.settings.iter().chain(&one.label).chain(&other.label);
                table.rows.push(labels.cloned().chain(statistics).collect());
            }
        }
        table
    }
}
