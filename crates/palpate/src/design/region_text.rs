//! Answer of a design in sentences.

use palpate_study::{Bound, Label, Statistic, number};
use palpate_sweep::{EndReason, Run, Side};

use super::feasible_region::{Best, DesignPoint, Region, RegionColumn, Sample};
use super::question::{Extreme, Sought};

/// Digits of a statistic in a sentence.
const DIGITS: usize = 3;
/// Digits of its standard error.
const ERROR_DIGITS: usize = 1;
/// Largest number of clauses in a sentence.
const MAX_CLAUSES: usize = 12;

impl Region {
    /// The answer in one sentence: the best value of the sought field, or the values that meet the target.
    pub fn sentence(&self) -> String {
        if self.is_curve() {
            return self.curve_sentence();
        }
        let text = match &self.sought {
            Some(sought) => self.best_in_words(sought),
            None => self.values_that_meet(),
        };
        format!("{}.", capitalized(&text))
    }

    /// Sentence of a region without a grid: values that meet the target, values that miss it, and undecided values.
    pub(super) fn curve_sentence(&self) -> String {
        let text = self.column_in_words(&self.columns[0], &format!(" ({})", self.certainty()));
        format!("{}: {text}.", capitalized(&self.searched.label.words))
    }

    /// Details of the sentence, a line each: the target, the numbers of values and trials, what is undecided, and the
    /// answer at each combination of the grid.
    pub fn lines(&self) -> Vec<String> {
        let points = || self.columns.iter().flat_map(|column| &column.points);
        let samples = || self.columns.iter().flat_map(RegionColumn::samples);
        let values = match self.is_curve() {
            true => self.curve_values_in_words(&self.columns[0]),
            false => {
                let (count, words) = (points().count(), &self.searched.label.words);
                let places = match self.columns.len() {
                    1 => String::new(),
                    _ => format!(", at {}", self.all_columns()),
                };
                format!("{count} of {words}{places}")
            }
        };
        let fresh: u64 = points()
            .flat_map(|point| &point.fresh)
            .map(|sample| sample.trials)
            .sum();
        let trials = match samples().any(|sample| sample.trials > 1) {
            false => "1 of each value: nothing is random".to_owned(),
            true => format!(
                "{}, of which {} fresh ones verify the answer",
                number::grouped(samples().map(|sample| sample.trials).sum()),
                number::grouped(fresh)
            ),
        };
        let mut lines = vec![
            format!("target   {}", self.target_in_words()),
            format!("values   {values}"),
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

    /// Notes on the limits of the searches.
    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let ends = match self.columns.iter().map(|column| column.narrowed).sum() {
            0 => None,
            1 => Some("an end".to_owned()),
            count => Some(format!("{count} ends")),
        };
        notes.extend(ends.map(|ends| {
            format!(
                "note     fresh trials did not verify {ends} where the search had found it: the answer is narrower there"
            )
        }));
        let has_ended = |reason| self.columns.iter().any(|column| column.ended == reason);
        if has_ended(EndReason::Time) {
            notes.push(
                "note     the gap is wider than asked for, since --budget is shared by all that was looked at: a larger one narrows it"
                    .to_owned(),
            );
        }
        if has_ended(EndReason::Trials) {
            notes.push(
                "note     some values are so near the limit that more trials than are taken would be needed"
                    .to_owned(),
            );
        }
        notes
    }

    /// Label of the target's statistic.
    pub fn label(&self) -> Label {
        let name = self.target.quantity.map_or("", |quantity| quantity.name);
        self.target.statistic.label(&[name], self.unit)
    }

    /// The target in words: the statistic with its limit, the allowed failures, and the cells.
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

    /// The tried values of a region without a grid.
    fn curve_values_in_words(&self, column: &RegionColumn) -> String {
        let count = column.points.len();
        let worst = self.worst_cell(column);
        let values = match self.searched.span {
            _ if self.searched.is_listed() => format!("{count}, listed"),
            span if span.from == span.to => self.searched.value(span.from),
            span => {
                let spacing = if span.is_log { "ratios" } else { "differences" };
                let whole = if span.is_whole { " whole numbers" } else { "" };
                format!(
                    "{count}{whole} from {}, spaced by {spacing}",
                    self.searched.between(span.from, span.to)
                )
            }
        };
        format!("{values}{worst}")
    }

    /// The cell that decides most of the tried values, if there are several cells.
    fn worst_cell(&self, column: &RegionColumn) -> String {
        if self.cells.len() < 2 {
            return String::new();
        }
        let mut counts = vec![0; self.cells.len()];
        for point in &column.points {
            if let Some(count) = counts.get_mut(point.worst) {
                *count += 1;
            }
        }
        let most = counts.iter().max().copied().unwrap_or(0);
        let cell = counts.iter().position(|&count| count == most).unwrap_or(0);
        let settings = settings_in_words(&self.cell_columns, &self.cells[cell]);
        format!("; the worst cell is mostly that of {}", joined(settings))
    }

    /// Values of a column that meet the target, that miss it, and that are undecided; `certainty` follows the first verdict.
    fn column_in_words(&self, column: &RegionColumn, certainty: &str) -> String {
        let runs = |side: Side| {
            let mut runs = column.on(side).peekable();
            runs.peek()?;
            Some(joined(runs.map(|run| self.run(run))))
        };
        let (meets, misses) = (runs(Side::Meets), runs(Side::Misses));
        let undecided = self.undecided(column);
        let rest = undecided
            .as_ref()
            .map_or(String::new(), |undecided| format!("; {undecided}"));
        let best = || match self.nearest_in(column) {
            Some((point, sample)) => format!("; at best {}", self.result_at(point, sample)),
            None => String::new(),
        };
        let all = self.all_values(column);
        match (meets, misses, undecided) {
            (Some(_), None, None) => format!("{all} meets the target{certainty}"),
            (Some(meets), None, _) => format!("{meets} meets the target{certainty}{rest}"),
            (Some(meets), Some(misses), _) => {
                format!("{meets} meets the target{certainty}, {misses} misses it{rest}")
            }
            (None, Some(_), None) => format!("{all} misses the target{certainty}{}", best()),
            (None, Some(misses), _) => {
                format!("{misses} misses the target{certainty}{rest}{}", best())
            }
            (None, None, _) => format!("whether {all} meets the target is undecided{}", best()),
        }
    }

    /// Words for all values together.
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

    /// Words for the undecided values.
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
            _ if is_between => Some("between them is undecided".to_owned()),
            _ if runs.is_empty() => Some("all is undecided".to_owned()),
            _ => Some(format!("{} is undecided", joined(open))),
        }
    }

    /// Values of a run.
    fn run(&self, run: &Run) -> String {
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

    /// The statistic at a value, or the share of failed trials if too many fail.
    fn result_at(&self, point: &DesignPoint, sample: &Sample) -> String {
        let value = self.searched.value(point.value);
        if sample.failure_rate() > self.max_failures {
            return match sample.trials {
                0 => format!("the readings tell nothing at {value}"),
                _ => format!(
                    "{} % of the trials fail at {value}",
                    number::significant(100.0 * sample.failure_rate(), DIGITS)
                ),
            };
        }
        let label = self.label();
        let Some((statistic, std)) = sample.statistic else {
            return format!("no trial succeeds at {value}");
        };
        let [shown, error] = [(statistic, DIGITS), (std, ERROR_DIGITS)]
            .map(|(number, digits)| number::significant(number * label.factor, digits));
        let unit = match label.unit.as_str() {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let name = match self.target.statistic {
            Statistic::Mean => label.words.clone(),
            statistic => statistic.short().to_owned(),
        };
        match std > 0.0 {
            true => format!("{name} is {shown} ± {error}{unit} at {value}"),
            false => format!("{name} is {shown}{unit} at {value}"),
        }
    }

    /// Words for the confidence of the answer.
    fn certainty(&self) -> String {
        let percent = number::significant(100.0 * self.confidence, DIGITS);
        format!("{percent} % sure")
    }

    fn best_in_words(&self, sought: &Sought) -> String {
        let (field, place) = self.sought_field(sought);
        let (word, words) = (sought.extreme.word(), &field.label.words);
        let Some(best) = self.best() else {
            return self.no_value_meets();
        };
        let (certainty, at) = (self.certainty(), self.at_best(&best, place));
        let value = field.value(best.value);
        let head = format!("{word} {words} that meets the target ({certainty}): {value}{at}");
        if !field.is_listed() && best.value == sought.extreme.end_of(field.span) {
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

    /// Words for the values of the other fields at the best value.
    fn at_best(&self, best: &Best<'_>, sought: Option<usize>) -> String {
        let grid = self.grid.iter().zip(&best.column.at).enumerate();
        let grid = grid.filter(|(place, _)| Some(*place) != sought);
        let grid = grid
            .map(|(_, (field, value))| format!("{} {}", field.label.words, field.value(*value)));
        let runs = sought.map(|_| {
            let runs = best.column.on(Side::Meets).map(|run| self.run(run));
            format!("{} {}", self.searched.label.words, joined(runs))
        });
        match joined(grid.chain(runs)).as_str() {
            "" => String::new(),
            all => format!(", at {all}"),
        }
    }

    /// Words for a region without a value that certainly meets the target.
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
                "no value of {words} is known to meet the target{places}, some are undecided"
            ),
        };
        match self.nearest() {
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
        let clauses = self.clauses();
        if clauses.len() > MAX_CLAUSES {
            return format!(
                "{words}: some value meets the target at {count} of {} {} ({certainty})",
                self.columns.len(),
                self.columns_in_words()
            );
        }
        format!(
            "{words} that meets the target ({certainty}): {}",
            clauses.join("; ")
        )
    }

    /// Values that meet the target with their places. Neighbours along a single field with the same values share a clause.
    fn clauses(&self) -> Vec<String> {
        let mut clauses: Vec<(String, Vec<&RegionColumn>)> = Vec::new();
        for column in &self.columns {
            let values = self.values_that_meet_in(column);
            match clauses.last_mut() {
                Some((last, columns)) if *last == values && self.grid.len() == 1 => {
                    columns.push(column);
                }
                _ => clauses.push((values, vec![column])),
            }
        }
        let is_first = |place: usize| place == 0 || self.grid.len() > 1;
        let clause = |(place, (values, columns)): (usize, (String, Vec<&RegionColumn>))| {
            let at = match (columns.as_slice(), self.grid.as_slice()) {
                ([one], [field]) if !is_first(place) => field.value(one.at[0]),
                ([one], _) => self.at(one),
                (several, [field, ..]) => {
                    let [from, to] = [several[0], several[several.len() - 1]].map(|one| one.at[0]);
                    let values = match field.is_listed() {
                        true => joined(several.iter().map(|one| field.value(one.at[0]))),
                        false => field.between(from, to),
                    };
                    match is_first(place) {
                        true => format!("{} {values}", field.label.words),
                        false => values,
                    }
                }
                (_, []) => String::new(),
            };
            format!("{values} at {at}")
        };
        clauses.into_iter().enumerate().map(clause).collect()
    }

    /// Values of a column that meet the target.
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

    /// Values of the grid at a column, in words.
    fn at(&self, column: &RegionColumn) -> String {
        let pairs = self.grid.iter().zip(&column.at);
        joined(pairs.map(|(field, value)| format!("{} {}", field.label.words, field.value(*value))))
    }

    /// The columns, in words.
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
        format!("{things} of {fields} that were looked at")
    }
}

/// Text with a capital at its start.
fn capitalized(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

/// `a`, `a and b`, `a, b and c`.
fn joined(words: impl IntoIterator<Item = String>) -> String {
    match words.into_iter().collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

/// Values of swept fields with their names and units, one text per column.
pub(crate) fn settings_in_words<'a>(
    columns: &'a [String],
    values: &'a [String],
) -> impl Iterator<Item = String> + 'a {
    columns.iter().zip(values).map(|(column, text)| {
        let label = Label::of_field(column);
        format!("{} {}", label.words, label.value(text))
    })
}
