//! The answer of `palpate design` (a region of values that meet the target) in sentences.

use palpate_report::Stretch;
use palpate_statistics::Number;
use palpate_study::{Bound, Label, Statistic, number};

use crate::question::Sought;
use crate::region::{Best, DesignPoint, Region, RegionColumn, Sample};
use crate::search::{EndReason, Side};
use crate::words::{DIGITS, capitalized, joined, percent, settings_in_words};

const ERROR_DIGITS: usize = 1;
/// Largest number of clauses in a sentence. A longer list of results is shortened.
const MAX_CLAUSES: usize = 12;

impl Region {
    /// The lines below the sentence that states the answer. They state the target, the numbers of values and trials,
    /// the searches that reached a limit, and the answer at each combination of the grid.
    pub(crate) fn details(&self) -> Vec<String> {
        let samples = || self.columns.iter().flat_map(RegionColumn::samples);
        let points = self.columns.iter().flat_map(|column| &column.points);
        let fresh = points.flat_map(|point| &point.fresh);
        let trials = match samples().any(|sample| sample.counts.trials > 1) {
            false => "1 per value, because the scene has no random numbers".to_owned(),
            true => format!(
                "{}; {} new ones verify the answer",
                number::grouped(samples().map(|sample| sample.counts.trials).sum()),
                number::grouped(fresh.map(|sample| sample.counts.trials).sum())
            ),
        };
        let mut lines = vec![
            format!("target   {}", self.target_in_words()),
            format!("values   {}", self.values_in_words()),
            format!("trials   {trials}"),
        ];
        lines.extend(self.notes());
        if !self.grid.is_empty() {
            let line = |column: &RegionColumn| {
                let (at, text) = (self.at(column), self.column_in_words(column, ""));
                format!("at       {at}: {text}")
            };
            lines.extend(self.columns.iter().map(line));
        }
        lines
    }

    /// The answer in one sentence: the best value of the optimised field or, if no field is optimised, the values that
    /// meet the target.
    pub(crate) fn sentence(&self) -> String {
        let text = match (&self.question.sought, self.grid.is_empty()) {
            (Some(sought), _) => self.best_in_words(sought),
            (None, false) => self.values_that_meet(),
            (None, true) => {
                let certainty = format!(" ({})", self.certainty());
                let text = self.column_in_words(&self.columns[0], &certainty);
                format!("{}: {text}", self.searched.label.words)
            }
        };
        format!("{}.", capitalized(&text))
    }

    /// Notes about ends of ranges that new trials did not confirm, and about searches that reached the limit of time or
    /// of trials.
    fn notes(&self) -> Vec<String> {
        let narrowed: usize = self.columns.iter().map(|column| column.narrowed).sum();
        let ends = match narrowed {
            1 => "an end".to_owned(),
            count => format!("{count} ends"),
        };
        let has_ended = |reason| self.columns.iter().any(|column| column.ended == reason);
        let notes = [
            (
                narrowed > 0,
                format!(
                    "new trials did not verify {ends} of the answer, so the answer is narrower \
                     there"
                ),
            ),
            (
                has_ended(EndReason::Time),
                "the time ran out before the gap was as small as requested; a larger --budget \
                 narrows the gap"
                    .to_owned(),
            ),
            (
                has_ended(EndReason::Trials),
                "some values are so close to the limit that they need more trials than allowed"
                    .to_owned(),
            ),
        ];
        let notes = notes.into_iter().filter(|(is_true, _)| *is_true);
        notes.map(|(_, note)| format!("note     {note}")).collect()
    }

    pub(crate) fn label(&self) -> Label {
        let target = &self.question.target;
        let name = target.quantity.map_or("", |quantity| quantity.name);
        target.statistic.label(&[name], self.unit)
    }

    pub(crate) fn target_in_words(&self) -> String {
        let label = self.label();
        let bound = match self.question.target.bound {
            Bound::AtMost => "at most",
            Bound::AtLeast => "at least",
        };
        let limit = label.value(&Number(self.question.target.limit).to_string());
        let failures = match self.question.max_failures {
            share if share >= 1.0 => "any share of the trials may fail".to_owned(),
            share => format!(
                "at most {} % of the trials may fail",
                number::rounded(100.0 * share)
            ),
        };
        let cells = match self.cells.len() {
            0 | 1 => String::new(),
            cells => {
                let columns = self.cell_columns.iter();
                let words = columns.map(|column| Label::of_field(column).words);
                format!(", in all {cells} cells of {}", joined(words))
            }
        };
        format!("{} {bound} {limit}, {failures}{cells}", label.words)
    }

    fn values_in_words(&self) -> String {
        let points = self.columns.iter().map(|column| column.points.len());
        let count: usize = points.sum();
        let (field, span) = (&self.searched, self.searched.span);
        let values = match self.columns.len() {
            1 if field.is_listed() => format!("{count}, listed"),
            1 if span.from == span.to => field.value(span.from),
            1 => {
                let spacing = if span.is_log { "ratios" } else { "differences" };
                let whole = if span.is_whole { " whole numbers" } else { "" };
                let range = field.between(span.from, span.to);
                format!("{count}{whole} from {range}, spaced by {spacing}")
            }
            _ => format!(
                "{count} of {}, at {}",
                field.label.words,
                self.all_columns()
            ),
        };
        format!("{values}{}", self.worst_cell())
    }

    /// Text that names the cell of the study that is the worst one at most tested values; empty if the study has only
    /// one cell. The worst cell misses the target most clearly, or meets it least clearly.
    fn worst_cell(&self) -> String {
        if self.cells.len() < 2 {
            return String::new();
        }
        let points = || self.columns.iter().flat_map(|column| &column.points);
        let decided = |cell: &usize| points().filter(|point| point.worst == *cell).count();
        // `max_by_key` returns the last of several equal maxima. The cells are in reverse order here, so the cell with
        // the smallest index is returned.
        let worst = (0..self.cells.len()).rev().max_by_key(decided);
        let settings = settings_in_words(&self.cell_columns, &self.cells[worst.unwrap_or(0)]);
        format!("; the worst cell is mostly {settings}")
    }

    /// Text about the searched field at one combination of the other varied fields' values. It states which values of
    /// the searched field meet the target, which miss it, and which are undecided. The text `certainty` is inserted
    /// after the first of these statements.
    fn column_in_words(&self, column: &RegionColumn, certainty: &str) -> String {
        let runs = |side: Side| {
            let runs: Vec<String> = column.on(side).map(|run| self.run(run)).collect();
            (!runs.is_empty()).then(|| joined(runs))
        };
        let (meets, misses) = (runs(Side::Meets), runs(Side::Misses));
        let undecided = self.undecided(column);
        let rest = undecided
            .as_ref()
            .map_or(String::new(), |undecided| format!("; {undecided}"));
        let best = || match self.nearest([column]) {
            Some((_, point, sample)) => format!("; at best {}", self.result_at(point, sample)),
            None => String::new(),
        };
        let all = self.all_values(column);
        match (meets, misses, undecided) {
            (Some(_), None, None) => format!("{all} meets the target{certainty}"),
            (Some(meets), None, _) => {
                let meet = verb(&meets, MEETS);
                format!("{meets} {meet} the target{certainty}{rest}")
            }
            (Some(meets), Some(misses), _) => {
                let failures = self.failures_in_words(column);
                let (meet, miss) = (verb(&meets, MEETS), verb(&misses, MISSES));
                format!("{meets} {meet} the target{certainty}, {misses} {miss} it{failures}{rest}")
            }
            (None, Some(_), None) => format!("{all} misses the target{certainty}{}", best()),
            (None, Some(misses), _) => {
                let miss = verb(&misses, MISSES);
                format!("{misses} {miss} the target{certainty}{rest}{}", best())
            }
            (None, None, _) => format!("whether {all} meets the target is undecided{}", best()),
        }
    }

    /// Text that states that values miss the target because too many trials fail; empty if this is not the reason.
    fn failures_in_words(&self, column: &RegionColumn) -> String {
        match self.failing_end(column) {
            Some((point, sample)) => format!(", because {}", self.result_at(point, sample)),
            None => String::new(),
        }
    }

    /// Examines the ends of the ranges that miss the target, except the ends of the whole searched range. Returns the
    /// first end at which too many trials fail, and the result of the cell with the largest share of failures there.
    pub(crate) fn failing_end<'a>(
        &self,
        column: &'a RegionColumn,
    ) -> Option<(&'a DesignPoint, &'a Sample)> {
        let span = self.searched.span;
        let ends = column.on(Side::Misses).flat_map(|run| [run.from, run.to]);
        let mut inner = ends.filter(|end| {
            self.searched.is_listed() || span.from == span.to || ![span.from, span.to].contains(end)
        });
        inner.find_map(|end| {
            let point = column.points.iter().find(|point| point.value == end)?;
            let sample = self.decisive(point)?;
            self.is_failing(sample).then_some((point, sample))
        })
    }

    /// Text for a combination of the other varied fields' values at which all values of the searched field meet the
    /// target, or all miss it.
    fn all_values(&self, column: &RegionColumn) -> String {
        let (field, span) = (&self.searched, self.searched.span);
        match (field.is_listed(), span.from == span.to) {
            (_, true) => {
                let first = column.points.first();
                field.value(first.map_or(span.from, |point| point.value))
            }
            (true, _) => "every value".to_owned(),
            (false, _) => format!("every value from {}", field.between(span.from, span.to)),
        }
    }

    fn undecided(&self, column: &RegionColumn) -> Option<String> {
        let (field, span, runs) = (&self.searched, self.searched.span, &column.runs);
        if field.is_listed() {
            let open = column.points.iter().filter(|point| point.side.is_none());
            let open: Vec<String> = open.map(|point| field.value(point.value)).collect();
            let is = if open.len() == 1 { "is" } else { "are" };
            return (!open.is_empty()).then(|| format!("{} {is} undecided", joined(open)));
        }
        let mut open: Vec<String> = Vec::new();
        let mut end: Option<f64> = None;
        for run in runs {
            let from = end.unwrap_or(span.from);
            let next = match end.is_some() && span.is_whole {
                true => from + 1.0,
                false => from,
            };
            if (end.is_some() || run.from > span.from) && next < run.from {
                open.push(field.between(from, run.from));
            }
            end = Some(run.to);
        }
        let last = end.unwrap_or(span.from);
        if last < span.to || runs.is_empty() {
            open.push(field.between(last, span.to));
        }
        let is_between = open.len() == 1
            && matches!(runs[..], [first, second] if first.from == span.from && second.to == span.to);
        match open.is_empty() {
            true => None,
            _ if is_between => Some("values between them are undecided".to_owned()),
            _ if runs.is_empty() => Some("all is undecided".to_owned()),
            _ => Some(format!("{} is undecided", joined(open))),
        }
    }

    fn run(&self, run: &Stretch) -> String {
        let (field, span) = (&self.searched, self.searched.span);
        if field.is_listed() || run.from == run.to {
            return field.value(run.from);
        }
        match (run.from == span.from, run.to == span.to) {
            (true, false) => format!("{} or less", field.value(run.to)),
            (false, true) => format!("{} or more", field.value(run.from)),
            _ => field.between(run.from, run.to),
        }
    }

    /// The result at a tested value in words. If too many trials fail, this is the share of failed trials; otherwise,
    /// it is the target's statistic.
    fn result_at(&self, point: &DesignPoint, sample: &Sample) -> String {
        let (value, label) = (self.searched.value(point.value), self.label());
        if self.is_failing(sample) || sample.counts.failed == sample.counts.trials {
            return sample.counts.failures_in_words("the trials", &value);
        }
        let name = match self.question.target.statistic {
            Statistic::Mean => label.words.clone(),
            statistic => statistic.short().to_owned(),
        };
        let Some((statistic, std)) = sample.statistic else {
            return format!("{name} is undefined at {value}");
        };
        let [shown, error] = [(statistic, DIGITS), (std, ERROR_DIGITS)]
            .map(|(number, digits)| number::significant(number * label.factor, digits));
        let unit = match label.unit.as_str() {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        match std > 0.0 {
            true => format!("{name} is {shown} ± {error}{unit} at {value}"),
            false => format!("{name} is {shown}{unit} at {value}"),
        }
    }

    fn certainty(&self) -> String {
        format!("{} % sure", percent(self.question.confidence))
    }

    fn best_in_words(&self, sought: &Sought) -> String {
        let (field, place) = self.sought_field(sought);
        let ([word, direction], words) = (sought.extreme.words(), &field.label.words);
        let Some(best) = self.best() else {
            return self.no_value_meets();
        };
        let (certainty, at) = (self.certainty(), self.at_best(&best, place));
        let value = field.value(best.value);
        let head = format!("{word} {words} that meets the target ({certainty}): {value}{at}");
        if !field.is_listed() && best.value == sought.extreme.end_of(field.span) {
            return format!("{head}, the {word} of the range");
        }
        match self.missed_from() {
            Some(missed) => {
                let missed = field.value(missed);
                let everywhere = match self.columns.len() {
                    1 => String::new(),
                    _ => format!(" at {}", self.all_columns()),
                };
                let failures = self.failures_in_words(best.column);
                format!("{head}; {missed} or {direction} misses it{everywhere}{failures}")
            }
            None if place.is_none() && !field.is_listed() => {
                format!("{head}; whether {direction} does is undecided")
            }
            None => head,
        }
    }

    /// Text with the values of the other varied fields for which the best value meets the target.
    fn at_best(&self, best: &Best<'_>, sought: Option<usize>) -> String {
        let grid = self.grid.iter().zip(&best.column.at).enumerate();
        let grid = grid.filter(|(place, _)| Some(*place) != sought);
        let grid = grid.map(|(_, (field, value))| field.named_value(*value));
        let runs = sought.map(|_| {
            let runs = best.column.on(Side::Meets).map(|run| self.run(run));
            format!("{} {}", self.searched.label.words, joined(runs))
        });
        match joined(grid.chain(runs)).as_str() {
            "" => String::new(),
            all => format!(", at {all}"),
        }
    }

    fn no_value_meets(&self) -> String {
        let span = self.searched.span;
        let all_miss = self.columns.iter().all(|column| {
            let mut misses = column.on(Side::Misses);
            match self.searched.is_listed() {
                true => misses.count() == column.points.len(),
                false => misses.any(|run| (run.from, run.to) == (span.from, span.to)),
            }
        });
        let words = &self.searched.label.words;
        let places = match self.columns.len() {
            1 => String::new(),
            count => format!(" at any of {count} {}", self.columns_in_words()),
        };
        let text = match all_miss {
            true => format!(
                "no value of {words} meets the target{places} ({})",
                self.certainty()
            ),
            false => format!(
                "no value of {words} certainly meets the target{places}; some are undecided"
            ),
        };
        match self.nearest(&self.columns) {
            Some((column, point, sample)) => {
                let at = match self.at(column) {
                    at if at.is_empty() => at,
                    at => format!(" and {at}"),
                };
                format!("{text}; at best {}{at}", self.result_at(point, sample))
            }
            None => text,
        }
    }

    /// Text that lists, for each combination of the other varied fields' values, the values of the searched field that
    /// meet the target. Neighbouring combinations with the same result share a clause if they differ in a single field.
    fn values_that_meet(&self) -> String {
        let words = &self.searched.label.words;
        let certainty = match self.columns.len() {
            1 => self.certainty(),
            _ => format!("{} of all", self.certainty()),
        };
        let meets = |column: &&RegionColumn| column.on(Side::Meets).next().is_some();
        let count = self.columns.iter().filter(meets).count();
        if count == 0 {
            return self.no_value_meets();
        }
        let is_alike = |one: &RegionColumn, other: &RegionColumn| {
            self.grid.len() == 1 && self.values_that_meet_in(one) == self.values_that_meet_in(other)
        };
        let groups: Vec<&[RegionColumn]> = self.columns.chunk_by(is_alike).collect();
        if groups.len() > MAX_CLAUSES {
            return format!(
                "{words}: some value meets the target at {count} of {} {} ({certainty})",
                self.columns.len(),
                self.columns_in_words()
            );
        }
        let clauses = groups.iter().enumerate().map(|(number, columns)| {
            let values = self.values_that_meet_in(&columns[0]);
            let at = match (self.grid.as_slice(), columns) {
                ([field], [first, .., last]) => {
                    let values = match field.is_listed() {
                        true => joined(columns.iter().map(|one| field.value(one.at[0]))),
                        false => field.between(first.at[0], last.at[0]),
                    };
                    match number {
                        0 => format!("{} {values}", field.label.words),
                        _ => values,
                    }
                }
                ([field], [one]) if number > 0 => field.value(one.at[0]),
                _ => self.at(&columns[0]),
            };
            format!("{values} at {at}")
        });
        let clauses: Vec<String> = clauses.collect();
        format!(
            "{words} that meets the target ({certainty}): {}",
            clauses.join("; ")
        )
    }

    fn values_that_meet_in(&self, column: &RegionColumn) -> String {
        let (span, is_listed) = (self.searched.span, self.searched.is_listed());
        let mut runs = column.on(Side::Meets).peekable();
        match (runs.peek(), column.runs.as_slice()) {
            (None, []) => "none for sure".to_owned(),
            (None, _) => "none".to_owned(),
            (_, [run]) if !is_listed && (run.from, run.to) == (span.from, span.to) => {
                self.all_values(column)
            }
            _ => joined(runs.map(|run| self.run(run))),
        }
    }

    fn at(&self, column: &RegionColumn) -> String {
        let pairs = self.grid.iter().zip(&column.at);
        joined(pairs.map(|(field, value)| field.named_value(*value)))
    }

    /// Words for all tested combinations of the varied fields that are not searched, for example `all 9 values of the
    /// indentation that were tested`.
    fn all_columns(&self) -> String {
        match self.columns.len() {
            2 => format!("both {}", self.columns_in_words()),
            count => format!("all {count} {}", self.columns_in_words()),
        }
    }

    fn columns_in_words(&self) -> String {
        let fields = joined(self.grid.iter().map(|field| field.label.words.clone()));
        let things = match self.grid.len() {
            1 => "values",
            _ => "combinations",
        };
        format!("{things} of {fields} that were tested")
    }
}

const MEETS: [&str; 2] = ["meets", "meet"];
const MISSES: [&str; 2] = ["misses", "miss"];

/// Returns the verb that agrees with its subject `values`: the singular `one` if this text states one value or one
/// range, and the plural `many` if it states a list.
fn verb(values: &str, [one, many]: [&'static str; 2]) -> &'static str {
    if values.contains(" and ") { many } else { one }
}
