//! A case, its outcome, and whether that keeps what the documentation promises.

use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use super::answer::{Answer, Outcome};

/// Time after which an entry point is said to hang.
const PATIENCE: Duration = Duration::from_secs(20);

/// Call of one entry point with one extreme input.
pub struct Case {
    /// Path of the entry point, such as `rolling::Roller::roll`.
    pub entry: &'static str,
    /// Words for the extreme in the input, such as `object radius 1e9`.
    pub input: String,
    expected: Expected,
    attempt: Box<dyn FnOnce() -> Outcome + Send>,
}

/// Kind of outcome that a case must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expected {
    /// A value or a named error.
    Either,
    /// A value: the input is perfectly computable.
    Value,
    /// A named error: the input has no meaning.
    Refusal,
}

/// Outcome of a case and the verdict on it.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Path of the entry point, from [`Case`].
    pub entry: &'static str,
    /// Words for the extreme in the input, from [`Case`].
    pub input: String,
    /// `None` where it panicked or hung.
    pub outcome: Option<Outcome>,
    /// The error of the first value.
    pub error: Option<f64>,
    /// Whether it keeps the promise.
    pub verdict: Verdict,
}

/// Whether a promise is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// A value within the bound that the documentation states.
    WithinBound,
    /// A value beyond that bound, by no more than ten times what the reported condition explains, and no more than 0.1.
    Conditioned,
    /// Finite, where neither a truth nor a bound is known.
    Finite,
    /// Finite, where the condition leaves no digit.
    NoDigitsLeft,
    /// A named error.
    Refused,
    /// A named error where a value can be computed.
    NeedlesslyRefused,
    /// A value where there is none.
    WronglyAnswered,
    /// A value that errs by more than bound and condition explain, or by less than it must.
    Unexplained,
    /// NaN or infinity.
    NotFinite,
    /// A panic.
    Panicked,
    /// No answer for twenty seconds.
    Hung,
}

impl Verdict {
    /// Name of the verdict in the table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::WithinBound => "within-bound",
            Self::Conditioned => "conditioned",
            Self::Finite => "finite",
            Self::NoDigitsLeft => "no-digits-left",
            Self::Refused => "refused",
            Self::NeedlesslyRefused => "needlessly-refused",
            Self::WronglyAnswered => "wrongly-answered",
            Self::Unexplained => "unexplained",
            Self::NotFinite => "not-finite",
            Self::Panicked => "panicked",
            Self::Hung => "hung",
        }
    }

    /// Whether it breaks a promise.
    pub const fn is_broken(self) -> bool {
        !matches!(
            self,
            Self::WithinBound
                | Self::Conditioned
                | Self::Finite
                | Self::NoDigitsLeft
                | Self::Refused
        )
    }
}

impl Case {
    /// A case that may end in a value or in a named error.
    pub fn new(
        entry: &'static str,
        input: impl Into<String>,
        attempt: impl FnOnce() -> Outcome + Send + 'static,
    ) -> Self {
        Self {
            entry,
            input: input.into(),
            expected: Expected::Either,
            attempt: Box::new(attempt),
        }
    }

    /// A case whose input can be computed: an error breaks the promise.
    pub fn value<E: Debug>(
        entry: &'static str,
        input: impl Into<String>,
        attempt: impl FnOnce() -> Result<Answer, E> + Send + 'static,
    ) -> Self {
        Self {
            expected: Expected::Value,
            ..Self::new(entry, input, || attempt().into())
        }
    }

    /// A case whose input has no meaning: a value breaks the promise.
    pub fn refusal<T, E: Debug>(
        entry: &'static str,
        input: impl Into<String>,
        attempt: impl FnOnce() -> Result<T, E> + Send + 'static,
    ) -> Self {
        Self {
            expected: Expected::Refusal,
            ..Self::new(entry, input, || {
                attempt().map(|_| Answer::finite([0.0])).into()
            })
        }
    }

    /// Runs it, on a thread of its own.
    pub fn judge(self) -> Judged {
        let Self {
            entry,
            input,
            expected,
            attempt,
        } = self;
        let (sender, receiver) = mpsc::channel();
        thread::spawn(move || {
            // The other side may have lost its patience.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(attempt)));
        });
        let (outcome, verdict) = match receiver.recv_timeout(PATIENCE) {
            Err(_) => (None, Verdict::Hung),
            Ok(Err(_)) => (None, Verdict::Panicked),
            Ok(Ok(outcome)) => {
                let verdict = expected.verdict(&outcome);
                (Some(outcome), verdict)
            }
        };
        let error = match &outcome {
            Some(Outcome::Value(answer)) => answer.error(),
            _ => None,
        };
        Judged {
            entry,
            input,
            outcome,
            error,
            verdict,
        }
    }
}

impl Expected {
    fn verdict(self, outcome: &Outcome) -> Verdict {
        match (self, outcome) {
            (Self::Value, Outcome::Refused(_)) => Verdict::NeedlesslyRefused,
            (_, Outcome::Refused(_)) => Verdict::Refused,
            (Self::Refusal, Outcome::Value(_)) => Verdict::WronglyAnswered,
            (_, Outcome::Value(answer)) => answer.verdict(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::answer::{Answer, Outcome};
    use super::{Case, Verdict};

    fn verdict(attempt: impl FnOnce() -> Outcome + Send + 'static) -> Verdict {
        Case::new("here", "this", attempt).judge().verdict
    }

    #[test]
    fn every_broken_promise_is_seen() {
        let near = |value: f64| Answer::near(value, 1.0).within(1e-14);
        assert_eq!(verdict(move || near(1.0).into()), Verdict::WithinBound);
        assert_eq!(verdict(move || near(1.1).into()), Verdict::Unexplained);
        assert_eq!(
            verdict(move || near(1.01).conditioned(1e13).into()),
            Verdict::Conditioned
        );
        // A condition that explains everything explains nothing.
        assert_eq!(
            verdict(move || near(1.1).conditioned(1e15).into()),
            Verdict::Unexplained
        );
        assert_eq!(
            verdict(move || near(1.1).conditioned(1e15).or_no_digits().into()),
            Verdict::NoDigitsLeft
        );
        assert_eq!(
            verdict(move || near(1.1).conditioned(1e13).or_no_digits().into()),
            Verdict::Unexplained
        );
        assert_eq!(verdict(|| Answer::finite([1.0]).into()), Verdict::Finite);
        assert_eq!(verdict(|| Answer::finite([]).into()), Verdict::NotFinite);
        assert_eq!(
            verdict(|| Answer::near(1.0, 1.0).within(0.5).at_least(0.1).into()),
            Verdict::Unexplained
        );
        assert_eq!(
            verdict(move || near(1.0).also([f64::NAN]).into()),
            Verdict::NotFinite
        );
        assert_eq!(verdict(|| panic!("as it should")), Verdict::Panicked);
        let refused = || Err::<Answer, _>(std::fmt::Error);
        assert_eq!(verdict(move || refused().into()), Verdict::Refused);
        assert_eq!(
            Case::value("here", "this", refused).judge().verdict,
            Verdict::NeedlesslyRefused
        );
        assert_eq!(
            Case::refusal("here", "this", || Ok::<_, ()>(1))
                .judge()
                .verdict,
            Verdict::WronglyAnswered
        );
    }
}
