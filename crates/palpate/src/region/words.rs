//! A region in sentences.

use palpate_sweep::{EndReason, Side};

use super::found::{Best, Column, Region};
use super::survey::{Extreme, Sought};
use crate::design::{first_letter_large, joined, notes, sure, trials_in_words};

/// Most clauses of a sentence.
const MOST_CLAUSES: usize = 12;

impl Region {
    /// The answer in one sentence: the best value of what is sought, or the values that meet the target at each combination
    /// of the grid.
    pub fn sentence(&self) -> String {
        let said = match &self.sought {
            Some(sought) => self.best_in_words(sought),
            None => self.values_that_meet(),
        };
        format!("{}.", first_letter_large(&said))
    }

    fn best_in_words(&self, sought: &Sought) -> String {
        let (field, place) = self.sought_field(sought);
        let (word, words) = (sought.extreme.word(), &field.label.words);
        let sure = sure(self.confidence);
        let Some(best) = self.best() else {
            return self.nothing();
        };
        let at = self.beside(&best, place);
        let value = field.value(best.value);
        let head = format!("{word} {words} that meets the target ({sure}): {value}{at}");
        let end = match sought.extreme {
            Extreme::Largest => field.span.to,
            Extreme::Smallest => field.span.from,
        };
        if !field.is_listed() && best.value == end {
            return format!("{head}, the {word} of the range");
        }
        let direction = match sought.extreme {
            Extreme::Largest => "more",
            Extreme::Smallest => "less",
        };
        match self.missed_from() {
            Some(missed) => {
                let missed = field.value(missed);
                let everywhere = match self.columns.len() {
                    1 => String::new(),
                    _ => format!(" at {}", self.all_columns()),
                };
                format!("{head}; {missed} or {direction} misses it{everywhere}")
            }
            None if place.is_none() && !field.is_listed() => {
                format!("{head}; whether {direction} does is undecided")
            }
            None => head,
        }
    }

    /// Words for the other values beside a best one.
    fn beside(&self, best: &Best<'_>, sought: Option<usize>) -> String {
        let grid = self.grid.iter().zip(&best.column.at).enumerate();
        let grid = grid.filter(|(place, _)| Some(*place) != sought);
        let grid = grid
            .map(|(_, (field, value))| format!("{} {}", field.label.words, field.value(*value)));
        let runs = sought.map(|_| {
            let runs = best.column.answer.on(Side::Meets);
            let runs: Vec<String> = runs.map(|run| best.column.answer.run(run)).collect();
            format!("{} {}", self.searched().label.words, joined(&runs))
        });
        let all: Vec<String> = grid.chain(runs).collect();
        match all.as_slice() {
            [] => String::new(),
            all => format!(", at {}", joined(all)),
        }
    }

    /// Words where no value is known to meet the target.
    fn nothing(&self) -> String {
        let is_known = self.columns.iter().all(|column| {
            let answer = &column.answer;
            let is_all = |run: &palpate_sweep::Run| {
                (run.from, run.to) == (answer.field.span.from, answer.field.span.to)
            };
            match answer.field.is_listed() {
                true => answer.on(Side::Misses).count() == answer.looked.len(),
                false => answer.on(Side::Misses).any(is_all),
            }
        });
        let words = &self.searched().label.words;
        let places = match self.columns.len() {
            1 => String::new(),
            count => format!(" at any of {count} {}", self.columns_in_words()),
        };
        let said = match is_known {
            true => format!(
                "no value of {words} meets the target{places} ({})",
                sure(self.confidence)
            ),
            false => {
                format!(
                    "no value of {words} is known to meet the target{places}, some are undecided"
                )
            }
        };
        match self.nearest() {
            Some((column, looked, sample)) => {
                let at = match self.at(column) {
                    at if at.is_empty() => at,
                    at => format!(" and {at}"),
                };
                format!(
                    "{said}; at best {}{at}",
                    column.answer.reached(looked, sample)
                )
            }
            None => said,
        }
    }

    fn values_that_meet(&self) -> String {
        let words = &self.searched().label.words;
        let sure = match self.columns.len() {
            1 => sure(self.confidence),
            _ => format!("{} of all", sure(self.confidence)),
        };
        let meets = |column: &&Column| column.answer.on(Side::Meets).next().is_some();
        let count = self.columns.iter().filter(meets).count();
        if count == 0 {
            return self.nothing();
        }
        let clauses = self.clauses();
        if clauses.len() > MOST_CLAUSES {
            return format!(
                "{words}: some value meets the target at {count} of {} {} ({sure})",
                self.columns.len(),
                self.columns_in_words()
            );
        }
        let clauses: Vec<String> = clauses
            .into_iter()
            .map(|(values, at)| format!("{values} at {at}"))
            .collect();
        format!(
            "{words} that meets the target ({sure}): {}",
            clauses.join("; ")
        )
    }

    /// Values that meet the target, and where; neighbours along a single field that have the same stand together.
    fn clauses(&self) -> Vec<(String, String)> {
        let mut clauses: Vec<(String, Vec<&Column>)> = Vec::new();
        for column in &self.columns {
            let said = meets(column);
            match clauses.last_mut() {
                Some((last, columns)) if *last == said && self.grid.len() == 1 => {
                    columns.push(column);
                }
                _ => clauses.push((said, vec![column])),
            }
        }
        let is_first = |place: usize| place == 0 || self.grid.len() > 1;
        let told = clauses.into_iter().enumerate();
        let told = told.map(|(place, (said, columns))| {
            let at = match (columns.as_slice(), self.grid.as_slice()) {
                ([one], [field]) if !is_first(place) => field.value(one.at[0]),
                ([one], _) => self.at(one),
                (several, [field, ..]) => {
                    let [from, to] = [several[0], several[several.len() - 1]].map(|one| one.at[0]);
                    let values = match field.is_listed() {
                        true => joined(
                            &several
                                .iter()
                                .map(|one| field.value(one.at[0]))
                                .collect::<Vec<_>>(),
                        ),
                        false => field.between(from, to),
                    };
                    match is_first(place) {
                        true => format!("{} {values}", field.label.words),
                        false => values,
                    }
                }
                (_, []) => String::new(),
            };
            (said, at)
        });
        told.collect()
    }

    /// Values of the grid at a column, in words.
    pub(super) fn at(&self, column: &Column) -> String {
        let pairs = self.grid.iter().zip(&column.at);
        let words =
            pairs.map(|(field, value)| format!("{} {}", field.label.words, field.value(*value)));
        joined(&words.collect::<Vec<_>>())
    }

    /// The columns, in words.
    fn all_columns(&self) -> String {
        match self.columns.len() {
            2 => format!("both {}", self.columns_in_words()),
            count => format!("all {count} {}", self.columns_in_words()),
        }
    }

    fn columns_in_words(&self) -> String {
        let fields = self.grid.iter().map(|field| field.label.words.clone());
        let fields = joined(&fields.collect::<Vec<_>>());
        let things = match self.grid.len() {
            1 => "values",
            _ => "combinations",
        };
        format!("{things} of {fields} that were looked at")
    }

    /// Grounds of the sentence, a line each: the target, the values and trials, what is left open, and the answer at each
    /// combination of the grid.
    pub fn lines(&self) -> Vec<String> {
        let answers = || self.columns.iter().map(|column| &column.answer);
        let first = &self.columns[0].answer;
        let mut lines = vec![format!("target   {}", first.target_in_words())];
        let looked: usize = answers().map(|answer| answer.looked.len()).sum();
        let places = match self.columns.len() {
            1 => String::new(),
            _ => format!(", at {}", self.all_columns()),
        };
        lines.push(format!(
            "values   {looked} of {}{places}",
            first.field.label.words
        ));
        let samples = || answers().flat_map(|answer| answer.samples());
        let all: u64 = samples().map(|sample| sample.trials).sum();
        let fresh = answers().flat_map(|answer| answer.looked.iter().flat_map(|one| &one.fresh));
        let fresh: u64 = fresh.map(|sample| sample.trials).sum();
        let is_random = samples().any(|sample| sample.trials > 1);
        lines.push(format!(
            "trials   {}",
            trials_in_words(all, fresh, is_random)
        ));
        let ended: Vec<EndReason> = answers().map(|answer| answer.ended).collect();
        let narrowed = answers().map(|answer| answer.narrowed).sum();
        lines.extend(notes(narrowed, &ended));
        if !self.grid.is_empty() {
            let at = |column: &Column| {
                format!("at       {}: {}", self.at(column), column.answer.said(""))
            };
            lines.extend(self.columns.iter().map(at));
        }
        lines
    }
}

/// Values of a column that meet the target.
fn meets(column: &Column) -> String {
    let answer = &column.answer;
    let runs: Vec<String> = answer.on(Side::Meets).map(|run| answer.run(run)).collect();
    let is_all = answer.runs.len() == 1 && !answer.field.is_listed();
    match runs.as_slice() {
        [] if answer.on(Side::Misses).next().is_some() => "none".to_owned(),
        [] => "none for sure".to_owned(),
        [_] if is_all
            && answer.runs[0].from == answer.field.span.from
            && answer.runs[0].to == answer.field.span.to =>
        {
            answer.all()
        }
        runs => joined(runs),
    }
}
