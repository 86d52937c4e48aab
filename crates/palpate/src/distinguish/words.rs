//! Sentences on objects that are told apart.

use palpate_study::{Label, number};
use palpate_sweep::Repeats;

use super::found::{Group, Object, Pair, ToldApart};

/// Digits of a share in percent.
const DIGITS: usize = 3;

impl ToldApart {
    /// A sentence for every two objects that are neighbours in a group, the group's settings before it.
    pub fn sentences(&self) -> Vec<String> {
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

    /// Settings of a group in words; empty where nothing else is swept.
    pub fn settings_in_words(&self, group: &Group) -> String {
        let pairs = self.columns.iter().zip(&group.settings);
        let said = pairs.map(|(column, text)| {
            let label = Label::of_field(column);
            format!("{} {}", label.words, label.value(text))
        });
        said.collect::<Vec<_>>().join(", ")
    }

    /// Object in words: its swept values with their units.
    pub fn object_in_words(&self, object: &Object) -> String {
        let pairs = self.object_columns.iter().zip(&object.label);
        let said = pairs.map(|(column, text)| Label::of_field(column).value(text));
        said.collect::<Vec<_>>().join(", ")
    }

    fn pair(&self, group: &Group, pair: &Pair) -> String {
        let [one, other] =
            [pair.first, pair.second].map(|place| self.object_in_words(&group.objects[place]));
        let trials = &self.trials;
        let (Some(order), Some(repeats)) = (pair.order, pair.repeats) else {
            return format!("{one} and {other} are alike in {}", self.quantity.words);
        };
        let share = |share: f64| number::significant(100.0 * share, DIGITS);
        let sure = share(self.confidence);
        let repeats = match repeats {
            Repeats::Found(1) => format!("one is enough for {sure} %"),
            Repeats::Found(count) => format!("{} {trials} for {sure} %", number::grouped(count)),
            Repeats::About(count) => {
                format!("about {} {trials} for {sure} %", number::grouped(count))
            }
            Repeats::Never => format!("no number of {trials} is enough for {sure} %"),
            Repeats::Unknown => format!("more {trials} than these can tell for {sure} %"),
        };
        format!(
            "{one} and {other}: {} % of single {trials} tell them apart ({} to {}); {repeats}",
            share(order.probability),
            share(order.low),
            share(order.high)
        )
    }
}
