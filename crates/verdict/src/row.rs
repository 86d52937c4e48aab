//! A row: the call of an entry point, how it ended, and whether that keeps what is promised.

use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::answer::{Answer, Truth};
use crate::verdict::{Verdict, name};

/// End of a call of an entry point: numbers or an error.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Numbers, the first of which is judged.
    Value(Answer),
    /// An error, by its stable name.
    Refused(String),
}

impl From<Answer> for Outcome {
    fn from(answer: Answer) -> Self {
        Self::Value(answer)
    }
}

impl<E: Debug> From<Result<Answer, E>> for Outcome {
    fn from(result: Result<Answer, E>) -> Self {
        match result {
            Ok(answer) => Self::Value(answer),
            Err(error) => Self::Refused(name(&error)),
        }
    }
}

impl From<Option<Answer>> for Outcome {
    fn from(answer: Option<Answer>) -> Self {
        answer.ok_or("none").into()
    }
}

/// Result of a call that should be refused, whatever its value would be. `None` is refused as `none`.
pub trait Refusal {
    /// The error, or a value that there should not be.
    fn outcome(self) -> Outcome;
}

impl<T, E: Debug> Refusal for Result<T, E> {
    fn outcome(self) -> Outcome {
        self.map(|_| Answer::finite([0.0])).into()
    }
}

impl<T> Refusal for Option<T> {
    fn outcome(self) -> Outcome {
        self.ok_or("none").outcome()
    }
}

/// A row of a table.
#[derive(Clone, Debug)]
pub struct Row {
    /// Path of the entry point, such as `rolling::Roller::roll`.
    pub entry: &'static str,
    /// Words for the extreme in the input, such as `object radius 1e9`.
    pub input: String,
    /// End of the call; none where it panicked.
    pub outcome: Option<Outcome>,
    /// Whether that keeps the promise.
    pub verdict: Verdict,
}

impl Row {
    /// Columns of a record.
    pub const COLUMNS: [&str; 9] = [
        "entry",
        "input",
        "outcome",
        "value",
        "truth",
        "error",
        "condition",
        "bound",
        "verdict",
    ];

    /// Row of an input that must end in a value, or in the error named.
    pub fn of(
        entry: &'static str,
        input: String,
        error: Option<&str>,
        call: impl FnOnce() -> Outcome,
    ) -> Self {
        let outcome = catch_unwind(AssertUnwindSafe(call)).ok();
        let verdict = match (&outcome, error) {
            (None, _) => Verdict::Panicked,
            (Some(Outcome::Value(_)), Some(_)) => Verdict::WronglyAnswered,
            (Some(Outcome::Value(answer)), None) => answer.verdict(),
            (Some(Outcome::Refused(_)), None) => Verdict::NeedlesslyRefused,
            (Some(Outcome::Refused(name)), Some(error)) if name == error => Verdict::Refused,
            (Some(Outcome::Refused(_)), Some(_)) => Verdict::RefusedOtherwise,
        };
        Self {
            entry,
            input,
            outcome,
            verdict,
        }
    }

    /// Record of the row, in the order of [`Self::COLUMNS`].
    pub fn record(&self) -> [String; 9] {
        let number = |value: f64| format!("{value:e}");
        let [mut value, mut truth, mut error, mut condition, mut bound] =
            [const { String::new() }; 5];
        let outcome = match &self.outcome {
            None => "none",
            Some(Outcome::Refused(name)) => name,
            Some(Outcome::Value(answer)) => {
                value = answer.values.first().copied().map_or(value, number);
                error = answer.error().map_or(error, |error| format!("{error:.1e}"));
                condition = number(answer.condition);
                bound = number(answer.bound);
                truth = match answer.truth {
                    Truth::Relative(truth) | Truth::OfScale { value: truth, .. } => number(truth),
                    Truth::Finite | Truth::NoDigits => truth,
                };
                "value"
            }
        };
        [
            self.entry.to_owned(),
            self.input.clone(),
            outcome.to_owned(),
            value,
            truth,
            error,
            condition,
            bound,
            name(&self.verdict),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::{Answer, Outcome, Refusal, Row, Verdict};

    fn verdict(error: Option<&str>, call: impl FnOnce() -> Outcome) -> Verdict {
        Row::of("here", "this".to_owned(), error, call).verdict
    }

    #[test]
    fn every_end_but_the_promised_is_seen() {
        let value = || Answer::near(1.0, 1.0).into();
        let refused = || Err::<f64, _>(Some("of any kind")).outcome();
        assert_eq!(verdict(None, value), Verdict::WithinBound);
        assert_eq!(verdict(None, refused), Verdict::NeedlesslyRefused);
        assert_eq!(verdict(None, || panic!("as it should")), Verdict::Panicked);
        assert_eq!(verdict(Some("some"), refused), Verdict::Refused);
        assert_eq!(verdict(Some("flat"), refused), Verdict::RefusedOtherwise);
        assert_eq!(verdict(Some("some"), value), Verdict::WronglyAnswered);
        let none = || None::<f64>.outcome();
        assert_eq!(verdict(Some("none"), none), Verdict::Refused);
    }
}
