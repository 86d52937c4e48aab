//! The result of `distinguish`: how reliably the estimates put objects in the order of their true values. It is output
//! as sentences, table, JSON and figure.

use palpate_report::{AnswerChart, AnswerFigure, Figure, HeatPanel, ReportError, answer_figure};
use palpate_study::config::Study;
use palpate_study::{Label, Quantity, Table, label, number};
use palpate_sweep::{Order, Repeats, TrialMeans};
use serde_json::{Value, json};

use crate::Answer;
use crate::cell_trials::TrialCounts;
use crate::words::{percent, settings_in_words};

/// Limit on the share of failed trials of an object. The sentences of the answer mention failed trials only above this
/// limit.
const STATED_FAILURES: f64 = 0.05;

/// How reliably the objects of a study can be distinguished: by one trial of each object, and by the mean estimates of
/// several trials of each object.
#[derive(Clone, Debug, PartialEq)]
pub struct Discrimination {
    /// The quantity whose estimates are compared to distinguish the objects.
    pub quantity: Quantity,
    /// Unit of the compared quantity, as in `cells.csv`.
    pub unit: &'static str,
    /// Required probability that the means of several trials put two objects in the right order.
    pub confidence: f64,
    /// Words that the sentences use for trials: `presses`, `glides` or, if a trial consists of several rolls, for
    /// example `trials of 8 rolls`.
    pub trials: String,
    /// Columns of the swept fields that define the objects, such as the object's radius.
    pub object_columns: Vec<String>,
    /// Columns of the swept fields that do not define the objects, such as the indentation.
    pub columns: Vec<String>,
    /// The objects in groups. Within a group, the swept fields of `columns` have the same values for all objects.
    pub groups: Vec<Group>,
}

/// Objects that are compared with each other. They differ only in the swept fields that define objects; all other swept
/// fields have the same values.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Values of the fields in [`Discrimination::columns`] for this group, formatted as in the tables.
    pub settings: Vec<String>,
    /// The objects of the group, in ascending order of their true values. If the compared quantity is `class`, the
    /// objects are in the order of the config.
    pub objects: Vec<Object>,
    /// All pairs of the group's objects.
    pub pairs: Vec<Pair>,
}

/// One of the objects that the study sweeps.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Index of the study's cell (combination of swept values) with this object.
    pub cell: usize,
    /// Swept values that define the object, formatted as in the tables.
    pub label: Vec<String>,
    /// True value of the compared quantity, or the mean of the true values if they differ between trials; `None` if
    /// every trial failed.
    pub truth: Option<f64>,
    /// Only for the quantity `class`: the true shape class of more than half of the points on the observed patch of the
    /// object. `None` if there is no such class.
    pub class: Option<&'static str>,
    /// Number of trials of this object, and number of failed trials.
    pub counts: TrialCounts,
    /// Mean of the estimates of the compared quantity for this object; `None` if every trial failed.
    pub mean: Option<f64>,
}

/// A pair of objects of the same group, and how reliably trials distinguish them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Index in [`Group::objects`] of the first object.
    pub first: usize,
    /// Index in [`Group::objects`] of the second object. It is larger than `first`.
    pub second: usize,
    /// Probability that one trial of each object distinguishes the two objects; `None` if both have the same true
    /// value.
    pub order: Option<Order>,
    /// Number of trials per object after which the mean estimates distinguish the two objects with the required
    /// confidence; `None` if both objects have the same true value.
    pub repeats: Option<Repeats>,
}

impl Object {
    /// Creates the object of a cell of the study. For each trial, `means` contains the mean estimate and the mean true
    /// value, or `None` if the trial failed.
    pub(crate) fn new(
        cell: usize,
        label: Vec<String>,
        means: &[TrialMeans],
        class: Option<&'static str>,
    ) -> Self {
        let found = || means.iter().flatten();
        let count = found().count() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| {
            let mean: f64 = found().map(|one| of(one) / count).sum();
            (count > 0.0 && mean.is_finite()).then_some(mean)
        };
        // If the true values of all trials are exactly equal, use this value, because their mean could have a rounding
        // error. In a press, they can differ, because the true value can depend on the indentation of the trial.
        let first = found().next().map(|(_, truth)| *truth);
        let is_same = found().all(|(_, truth)| Some(*truth) == first);
        Self {
            cell,
            label,
            truth: match is_same {
                true => first,
                false => mean(|(_, truth)| *truth),
            },
            class,
            counts: means.into(),
            mean: mean(|(estimate, _)| *estimate),
        }
    }
}

impl Discrimination {
    /// Values of the swept fields that do not define objects, in words. All objects of a group share these values. The
    /// text is empty if there are no such fields.
    pub(crate) fn settings_in_words(&self, group: &Group) -> String {
        settings_in_words(&self.columns, &group.settings)
    }

    /// The swept values that define an object, in words, with their units.
    pub(crate) fn object_in_words(&self, object: &Object) -> String {
        let pairs = self.object_columns.iter().zip(&object.label);
        let said = pairs.map(|(column, text)| Label::of_field(column).value(text));
        said.collect::<Vec<_>>().join(", ")
    }

    fn pair(&self, group: &Group, pair: &Pair) -> String {
        let objects = [pair.first, pair.second].map(|place| &group.objects[place]);
        let [one, other] = objects.map(|object| self.object_in_words(object));
        let trials = &self.trials;
        let (Some(order), Some(repeats)) = (pair.order, pair.repeats) else {
            return format!("{one} and {other} have the same {}", self.quantity.words);
        };
        let sure = percent(self.confidence);
        let repeats = match repeats {
            Repeats::Found(1) => format!("one is enough for {sure} %"),
            Repeats::Found(count) => format!("{} {trials} for {sure} %", number::grouped(count)),
            Repeats::About(count) => {
                format!("about {} {trials} for {sure} %", number::grouped(count))
            }
            Repeats::Never => format!("no number of {trials} is enough for {sure} %"),
            Repeats::Unknown => {
                format!("{sure} % needs more {trials} than were simulated")
            }
        };
        let failing = objects
            .into_iter()
            .filter(|object| object.counts.failure_rate() > STATED_FAILURES);
        let failures = failing.map(|object| {
            let at = self.object_in_words(object);
            format!("; {}", object.counts.failures_in_words(trials, &at))
        });
        format!(
            "{one} and {other}: {} % of single {trials} put them in the right order ({} to {}); \
             {repeats}{}",
            percent(order.probability),
            percent(order.low),
            percent(order.high),
            failures.collect::<String>()
        )
    }
}

impl Answer for Discrimination {
    /// Table with one row per pair of objects. A row contains both objects, the probability that one trial of each
    /// object distinguishes them, and the 95 % interval of this probability. It also contains the number of trials that
    /// must be averaged to distinguish the objects with the required confidence.
    fn table(&self) -> Table {
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
            "first_main_failure",
            "second_main_failure",
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
                let truth = |object: &Object| match object.class {
                    Some(class) => class.to_owned(),
                    None => text(object.truth),
                };
                let failure = |object: &Object| {
                    let main = object.counts.main_failure;
                    main.map_or("", |(kind, _)| kind).to_owned()
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
                    one.counts.trials.to_string(),
                    other.counts.trials.to_string(),
                    one.counts.failed.to_string(),
                    other.counts.failed.to_string(),
                    failure(one),
                    failure(other),
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

    /// One sentence for each pair of objects whose true values are next to each other, in ascending order. Objects are
    /// compared only if all swept fields that do not define objects have equal values. The sentence starts with these
    /// values.
    fn lines(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        for group in &self.groups {
            let settings = self.settings_in_words(group);
            let before = match settings.as_str() {
                "" => String::new(),
                settings => format!("{settings}: "),
            };
            let neighbours = group
                .pairs
                .iter()
                .filter(|pair| pair.first + 1 == pair.second);
            sentences.extend(neighbours.map(|pair| format!("{before}{}.", self.pair(group, pair))));
        }
        sentences
    }

    /// The result as JSON. For each pair of objects, it contains the probability that one trial of each object
    /// distinguishes them, the 95 % interval of this probability, and the required number of trials. It also contains
    /// the texts of [`Answer::lines`].
    fn to_json(&self, study: &Study) -> Value {
        let groups = self.groups.iter().map(|group| {
            let pairs = group.pairs.iter().map(|pair| {
                let [first, second] = [pair.first, pair.second]
                    .map(|place| self.object_in_words(&group.objects[place]));
                let repeats = match pair.repeats {
                    Some(Repeats::Found(count) | Repeats::About(count)) => json!(count),
                    _ => Value::Null,
                };
                json!({
                    "first": first,
                    "second": second,
                    "told_apart": pair.order.map(|order| order.probability),
                    "low95": pair.order.map(|order| order.low),
                    "high95": pair.order.map(|order| order.high),
                    "repeats": repeats,
                })
            });
            let objects = group.objects.iter().map(|object| {
                json!({
                    "object": self.object_in_words(object),
                    "failing": object.counts.failure_rate(),
                    "main_failure": object.counts.main_failure.map(|(kind, _)| kind),
                })
            });
            json!({
                "settings": self.settings_in_words(group),
                "objects": objects.collect::<Value>(),
                "pairs": pairs.collect::<Value>(),
            })
        });
        json!({
            "format_version": 1,
            "study": study.config.name,
            "quantity": self.quantity.name,
            "confidence": self.confidence,
            "groups": groups.collect::<Value>(),
            "answer": self.lines(),
        })
    }

    /// Heat map with one panel per group of objects. Each square of the map belongs to a pair of objects. It shows the
    /// probability that one trial of each object distinguishes them. `name` is the name of the figure's files.
    fn figure(&self, name: &str, title: &str) -> Result<Figure, ReportError> {
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
        let (right, equal) = match self.quantity == Quantity::CLASS {
            true => ("the right class at most points of both".to_owned(), ""),
            false => (
                format!("estimates of {by} in the right order"),
                "; a pair of equal estimates counts as half right",
            ),
        };
        let objects = self.groups.iter().flat_map(|group| &group.objects);
        let most = objects.map(|object| object.counts.trials).max();
        let objects: Vec<String> = self
            .object_columns
            .iter()
            .map(|column| Label::of_field(column).words)
            .collect();
        answer_figure(&AnswerFigure {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: format!(
                "Share of pairs of single trials with {right}; {} trials of each object.",
                number::grouped(most.unwrap_or(0))
            ),
            chart: AnswerChart::Heat {
                axis: objects.join(", "),
                panels: self.groups.iter().map(panel).collect(),
            },
            notes: vec![format!("A failed trial counts as wrong{equal}.")],
        })
    }
}
