//! A case, its outcome, and whether that keeps what the documentation promises.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result};

/// After so long an entry point is said to hang.
const PATIENCE: Duration = Duration::from_secs(20);
/// Errors may be so many times what the condition explains.
const SLACK: f64 = 10.0;

/// One entry point at one extreme.
pub struct Case {
    /// The entry point: `rolling::Roller::roll`.
    pub entry: &'static str,
    /// What is extreme about the input: `object radius 1e9`.
    pub input: String,
    /// Tries it.
    pub attempt: Box<dyn FnOnce() -> Outcome + Send>,
}

/// What an entry point gave.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Numbers, the first of which is judged.
    Value(Answer),
    /// An error, by its stable name.
    Refused(&'static str),
}

/// A value, and what is known of it.
#[derive(Clone, Debug)]
pub struct Answer {
    /// All that was given; none may be NaN or infinite. The first is judged.
    pub values: Vec<f64>,
    /// What it should be.
    pub truth: Truth,
    /// The condition number that the result reports, where it reports one; else that of the problem.
    pub condition: f64,
    /// The error that the documentation allows, in the terms of [`Truth`].
    pub bound: f64,
}

/// What a value should be.
#[derive(Clone, Copy, Debug)]
pub enum Truth {
    /// This, from a closed form or in higher precision; errors are relative to it.
    Relative(f64),
    /// This; errors are relative to the given scale (for truths that may be 0).
    OfScale {
        /// What it should be.
        value: f64,
        /// What errors are relative to.
        scale: f64,
    },
    /// Only that it is finite (say why in the case's input).
    Finite,
}

/// What came of a case.
#[derive(Clone, Debug)]
pub struct Judged {
    /// As in [`Case`].
    pub entry: &'static str,
    /// As in [`Case`].
    pub input: String,
    /// `None` where it panicked or hung.
    pub outcome: Option<Outcome>,
    /// The error of the first value.
    pub error: Option<f64>,
    /// Whether it keeps the promise.
    pub verdict: Verdict,
}

/// Whether a promise is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A value within the bound that the documentation states.
    WithinBound,
    /// A value beyond that bound, by no more than ten times what the reported condition explains.
    Conditioned,
    /// A named error.
    Refused,
    /// A value that errs by more.
    Unexplained,
    /// NaN or infinity.
    NotFinite,
    /// A panic.
    Panicked,
    /// No answer for twenty seconds.
    Hung,
}

impl Verdict {
    /// As the table says it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::WithinBound => "within-bound",
            Self::Conditioned => "conditioned",
            Self::Refused => "refused",
            Self::Unexplained => "unexplained",
            Self::NotFinite => "not-finite",
            Self::Panicked => "panicked",
            Self::Hung => "hung",
        }
    }

    /// Whether it breaks a promise.
    pub const fn is_broken(self) -> bool {
        matches!(
            self,
            Self::Unexplained | Self::NotFinite | Self::Panicked | Self::Hung
        )
    }
}

impl Case {
    /// A case.
    pub fn new(
        entry: &'static str,
        input: impl Into<String>,
        attempt: impl FnOnce() -> Outcome + Send + 'static,
    ) -> Self {
        Self {
            entry,
            input: input.into(),
            attempt: Box::new(attempt),
        }
    }

    /// Runs it, on a thread of its own.
    pub fn judge(self) -> Judged {
        let Self {
            entry,
            input,
            attempt,
        } = self;
        let (sender, receiver) = mpsc::channel();
        thread::spawn(move || {
            // The other side may have lost its patience.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(attempt)));
        });
        let (outcome, error, verdict) = match receiver.recv_timeout(PATIENCE) {
            Err(_) => (None, None, Verdict::Hung),
            Ok(Err(_)) => (None, None, Verdict::Panicked),
            Ok(Ok(Outcome::Refused(name))) => {
                (Some(Outcome::Refused(name)), None, Verdict::Refused)
            }
            Ok(Ok(Outcome::Value(answer))) => {
                let error = answer.error();
                let verdict = answer.verdict(error);
                (Some(Outcome::Value(answer)), error, verdict)
            }
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

impl Answer {
    fn error(&self) -> Option<f64> {
        let value = self.values.first()?;
        match self.truth {
            Truth::Relative(truth) => Some((value - truth).abs() / truth.abs()),
            Truth::OfScale {
                value: truth,
                scale,
            } => Some((value - truth).abs() / scale),
            Truth::Finite => None,
        }
    }

    fn verdict(&self, error: Option<f64>) -> Verdict {
        let all_finite = self.values.iter().all(|value| value.is_finite());
        match error {
            _ if !all_finite || self.values.is_empty() => Verdict::NotFinite,
            None => Verdict::WithinBound,
            Some(error) if error <= self.bound => Verdict::WithinBound,
            Some(error) if error <= SLACK * self.condition * f64::EPSILON => Verdict::Conditioned,
            Some(_) => Verdict::Unexplained,
        }
    }
}

/// Writes the table: `entry,input,outcome,value,truth,error,condition,bound,verdict`.
pub(super) fn write(rows: &[Judged], out: &Path) -> Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "entry",
        "input",
        "outcome",
        "value",
        "truth",
        "error",
        "condition",
        "bound",
        "verdict",
    ])?;
    let number = |value: f64| format!("{value:e}");
    for row in rows {
        let [mut value, mut truth, mut condition, mut bound] = [const { String::new() }; 4];
        let outcome = match &row.outcome {
            None => "none",
            Some(Outcome::Refused(name)) => *name,
            Some(Outcome::Value(answer)) => {
                value = answer.values.first().copied().map_or(String::new(), number);
                truth = match answer.truth {
                    Truth::Relative(truth) | Truth::OfScale { value: truth, .. } => number(truth),
                    Truth::Finite => String::new(),
                };
                condition = number(answer.condition);
                bound = number(answer.bound);
                "value"
            }
        };
        let error = row
            .error
            .map_or(String::new(), |error| format!("{error:.1e}"));
        writer.write_record([
            row.entry,
            &row.input,
            outcome,
            &value,
            &truth,
            &error,
            &condition,
            &bound,
            row.verdict.name(),
        ])?;
    }
    let bytes = writer.into_inner().context("the table is not whole")?;
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    std::io::Write::write_all(&mut file, &bytes)?;
    file.persist(out)
        .with_context(|| format!("cannot write {}", out.display()))?;
    Ok(())
}
