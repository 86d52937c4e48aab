//! The answer of a design in sentences.

use palpate_study::{Bound, Label, Statistic, number};
use palpate_sweep::{EndReason, Run, Side};

use super::answer::{Answer, LookedAt, Sample};

/// Digits of a statistic in a sentence.
const DIGITS: usize = 3;
/// Digits of its standard error.
const OF_ERROR: usize = 1;

impl Answer {
    /// The answer in one sentence: what meets the target, what misses it, and what is undecided.
    pub fn sentence(&self) -> String {
        let sure = format!(" ({})", sure(self.confidence));
        let said = self.said(&sure);
        format!("{}: {said}.", first_letter_large(&self.field.label.words))
    }

    /// The sentence without the name of the field, with the words that tell how sure it is.
    pub(crate) fn said(&self, sure: &str) -> String {
        let said = |side: Side| {
            let runs: Vec<String> = self.on(side).map(|run| self.run(run)).collect();
            (!runs.is_empty()).then(|| joined(&runs))
        };
        let (meets, misses) = (said(Side::Meets), said(Side::Misses));
        let undecided = self.undecided();
        let rest = undecided
            .as_ref()
            .map_or(String::new(), |undecided| format!("; {undecided}"));
        let best = || match self.best() {
            Some((looked, sample)) => format!("; at best {}", self.reached(looked, sample)),
            None => String::new(),
        };
        let all = self.all();
        match (meets, misses, undecided) {
            (Some(_), None, None) => format!("{all} meets the target{sure}"),
            (Some(meets), None, _) => format!("{meets} meets the target{sure}{rest}"),
            (Some(meets), Some(misses), _) => {
                format!("{meets} meets the target{sure}, {misses} misses it{rest}")
            }
            (None, Some(_), None) => format!("{all} misses the target{sure}{}", best()),
            (None, Some(misses), _) => {
                format!("{misses} misses the target{sure}{rest}{}", best())
            }
            (None, None, _) => format!("whether {all} meets the target is undecided{}", best()),
        }
    }

    /// Words for all values together.
    pub(crate) fn all(&self) -> String {
        let span = self.field.span;
        match (self.field.is_listed(), span.from == span.to) {
            (_, true) => self.value(self.looked.first().map_or(span.from, |looked| looked.value)),
            (true, _) => "every value".to_owned(),
            (false, _) => format!("every value from {}", self.between(span.from, span.to)),
        }
    }

    /// Grounds of the sentence, a line each: the target, the values and trials, and what is left open.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!("target   {}", self.target_in_words())];
        lines.push(format!("values   {}", self.values_in_words()));
        let trials: u64 = self.samples().map(|sample| sample.trials).sum();
        let fresh = self.looked.iter().flat_map(|looked| &looked.fresh);
        let fresh: u64 = fresh.map(|sample| sample.trials).sum();
        let is_random = self.samples().any(|sample| sample.trials > 1);
        lines.push(format!(
            "trials   {}",
            trials_in_words(trials, fresh, is_random)
        ));
        lines.extend(notes(self.narrowed, &[self.ended]));
        lines
    }

    /// Label of the target's statistic.
    pub fn label(&self) -> Label {
        let name = self.target.quantity.map_or("", |quantity| quantity.name);
        self.target.statistic.label(&[name], self.unit)
    }

    /// The target in words: what is to be at most or at least how much, in which cells.
    pub fn target_in_words(&self) -> String {
        let label = self.label();
        let bound = match self.target.bound {
            Bound::AtMost => "at most",
            Bound::AtLeast => "at least",
        };
        let limit = label.value(&number::exact(self.target.limit));
        let failures = match self.max_failures {
            share if share >= 1.0 => "however many trials fail".to_owned(),
            share => format!(
                "at most {} % of the trials failing",
                number::rounded(100.0 * share)
            ),
        };
        let cells = match (self.cells.len(), self.columns.as_slice()) {
            (0 | 1, _) => String::new(),
            (cells, columns) => {
                let words = columns.iter().map(|column| Label::of_field(column).words);
                let words: Vec<String> = words.collect();
                format!(", in all {cells} cells of {}", joined(&words))
            }
        };
        format!("{} {bound} {limit}, {failures}{cells}", label.words)
    }

    fn values_in_words(&self) -> String {
        let count = self.looked.len();
        let worst = self.worst_cells();
        let values = match self.field.span {
            _ if self.field.is_listed() => format!("{count}, listed"),
            span if span.from == span.to => self.value(span.from),
            span => {
                let spacing = if span.is_log { "ratios" } else { "differences" };
                let whole = if span.is_whole { " whole numbers" } else { "" };
                format!(
                    "{count}{whole} from {}, spaced by {spacing}",
                    self.between(span.from, span.to)
                )
            }
        };
        format!("{values}{worst}")
    }

    /// The cell that decides most of the values that were looked at, where there are several.
    fn worst_cells(&self) -> String {
        if self.cells.len() < 2 {
            return String::new();
        }
        let mut counts = vec![0; self.cells.len()];
        for looked in &self.looked {
            if let Some(count) = counts.get_mut(looked.worst) {
                *count += 1;
            }
        }
        let most = counts.iter().max().copied().unwrap_or(0);
        let cell = counts.iter().position(|&count| count == most).unwrap_or(0);
        let pairs = self.columns.iter().zip(&self.cells[cell]);
        let said: Vec<String> = pairs
            .map(|(column, text)| {
                let label = Label::of_field(column);
                format!("{} {}", label.words, label.value(text))
            })
            .collect();
        format!("; the worst cell is mostly that of {}", joined(&said))
    }

    /// Words for the values that are undecided.
    fn undecided(&self) -> Option<String> {
        if self.field.is_listed() {
            let open = self.looked.iter().filter(|looked| looked.side.is_none());
            let open: Vec<String> = open.map(|looked| self.value(looked.value)).collect();
            let is = if open.len() == 1 { "is" } else { "are" };
            return (!open.is_empty()).then(|| format!("{} {is} undecided", joined(&open)));
        }
        let span = self.field.span;
        let mut open: Vec<String> = Vec::new();
        let mut end: Option<f64> = None;
        for run in &self.runs {
            let from = end.unwrap_or(span.from);
            let next = if end.is_some() && span.is_whole {
                from + 1.0
            } else {
                from
            };
            if (end.is_some() || run.from > span.from) && next < run.from {
                open.push(self.between(from, run.from));
            }
            end = Some(run.to);
        }
        let last = end.unwrap_or(span.from);
        if last < span.to || self.runs.is_empty() {
            open.push(self.between(last, span.to));
        }
        let is_between = self.runs.len() == 2
            && open.len() == 1
            && self.runs[0].from == span.from
            && self.runs[1].to == span.to;
        match open.as_slice() {
            [] => None,
            _ if is_between => Some("between them is undecided".to_owned()),
            _ if self.runs.is_empty() => Some("all is undecided".to_owned()),
            open => Some(format!("{} is undecided", joined(open))),
        }
    }

    /// Values of a run.
    pub(crate) fn run(&self, run: &Run) -> String {
        let span = self.field.span;
        if self.field.is_listed() || run.from == run.to {
            return self.value(run.from);
        }
        match (run.from == span.from, run.to == span.to) {
            (true, false) => format!("{} or less", self.value(run.to)),
            (false, true) => format!("{} or more", self.value(run.from)),
            _ => self.between(run.from, run.to),
        }
    }

    /// Value with its unit.
    pub fn value(&self, value: f64) -> String {
        self.field.value(value)
    }

    fn between(&self, from: f64, to: f64) -> String {
        self.field.between(from, to)
    }

    /// The statistic that a value reaches, or the share of its trials that fail.
    pub(crate) fn reached(&self, looked: &LookedAt, sample: &Sample) -> String {
        let value = self.value(looked.value);
        if sample.failing() > self.max_failures {
            return match sample.trials {
                0 => format!("the readings tell nothing at {value}"),
                _ => format!(
                    "{} % of the trials fail at {value}",
                    number::significant(100.0 * sample.failing(), DIGITS)
                ),
            };
        }
        let label = self.label();
        let Some((reached, std)) = sample.statistic else {
            return format!("no trial succeeds at {value}");
        };
        let [shown, error] = [(reached, DIGITS), (std, OF_ERROR)]
            .map(|(number, digits)| number::significant(number * label.factor, digits));
        let unit = match label.unit.as_str() {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let statistic = match self.target.statistic {
            Statistic::Mean => label.words.clone(),
            statistic => statistic.short().to_owned(),
        };
        match std > 0.0 {
            true => format!("{statistic} is {shown} ± {error}{unit} at {value}"),
            false => format!("{statistic} is {shown}{unit} at {value}"),
        }
    }
}

/// How sure something is.
pub(crate) fn sure(confidence: f64) -> String {
    format!("{} % sure", number::significant(100.0 * confidence, DIGITS))
}

/// Trials, and how many of them verify the answer.
pub(crate) fn trials_in_words(all: u64, fresh: u64, is_random: bool) -> String {
    match is_random {
        false => "1 of each value: nothing is random".to_owned(),
        true => format!(
            "{}, of which {} fresh ones verify the answer",
            number::grouped(all),
            number::grouped(fresh)
        ),
    }
}

/// Notes on what searches left open, a line each.
pub(crate) fn notes(narrowed: usize, ended: &[EndReason]) -> Vec<String> {
    let mut lines = Vec::new();
    if narrowed > 0 {
        let ends = match narrowed {
            1 => "an end".to_owned(),
            count => format!("{count} ends"),
        };
        lines.push(format!(
            "note     fresh trials did not verify {ends} where the search had found it: the answer is narrower there"
        ));
    }
    if ended.contains(&EndReason::Time) {
        lines.push(
            "note     the gap is wider than asked for, since --budget is shared by all that was looked at: a larger one narrows it"
                .to_owned(),
        );
    }
    if ended.contains(&EndReason::Trials) {
        lines.push(
            "note     some values are so near the limit that more trials than are taken would be needed"
                .to_owned(),
        );
    }
    lines
}

/// Words with a capital at their start.
pub(crate) fn first_letter_large(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters
        .next()
        .map(|letter| letter.to_uppercase().to_string());
    format!("{}{}", first.unwrap_or_default(), letters.as_str())
}

/// `a`, `a and b`, `a, b and c`.
pub(crate) fn joined(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}
