//! Numbers that entry points return, beside those that they should have returned.

use std::fmt::Debug;

use crate::verdict::{Verdict, name};

/// Factor by which an error may exceed what the condition explains.
const SLACK: f64 = 10.0;
/// Largest error that a condition may explain; above it hardly a digit of the result is left, and no error is excused.
const MOST_EXPLAINED: f64 = 0.1;

/// Numbers that an entry point returned, with the truth and the accuracy that is promised.
#[derive(Clone, Debug)]
pub struct Answer {
    /// All numbers of the result, none of which may be NaN or infinite. The first is judged.
    pub values: Vec<f64>,
    /// True value of the first number.
    pub truth: Truth,
    /// The condition number that the result reports, where it reports one; else that of the problem.
    pub condition: f64,
    /// The error that the documentation allows, in the terms of [`Truth`].
    pub bound: f64,
    /// Least error that there must be, in the same terms: a sensor that reads in whole steps is wrong if it is exact
    /// between two steps.
    pub least: f64,
}

/// True value of a number, and the scale on which its error counts.
#[derive(Clone, Copy, Debug)]
pub enum Truth {
    /// Value from a closed form or from a computation in higher precision; errors are relative to it.
    Relative(f64),
    /// Value that may be 0; errors are relative to a given scale.
    OfScale {
        /// True value.
        value: f64,
        /// Magnitude that errors are relative to.
        scale: f64,
    },
    /// No known value: the number need only be finite (the row's input says why).
    Finite,
    /// No value that could be told: the condition leaves the number no digit, and it need only be finite.
    NoDigits,
}

impl Answer {
    /// A value whose error is relative to the truth. Until [`Self::within`] says otherwise it must be
    /// exact but for [`Self::conditioned`], which is 1.
    pub fn near(value: f64, truth: f64) -> Self {
        Self::of([value], Truth::Relative(truth))
    }

    /// A value whose error is relative to a scale.
    pub fn at_scale(value: f64, truth: f64, scale: f64) -> Self {
        let truth = Truth::OfScale {
            value: truth,
            scale,
        };
        Self::of([value], truth)
    }

    /// A statement that must hold: 1 where it does.
    pub fn holds(statement: bool) -> Self {
        Self::near(f64::from(u8::from(statement)), 1.0)
    }

    /// The largest error of several values, each relative to its own truth.
    pub fn all_near(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let pairs = pairs.into_iter();
        Self::worst(pairs.map(|(value, truth)| Self::near(value, truth)))
    }

    /// The largest error of several values, all relative to one scale.
    pub fn all_at_scale(pairs: impl IntoIterator<Item = (f64, f64)>, scale: f64) -> Self {
        let pairs = pairs.into_iter();
        Self::worst(pairs.map(|(value, truth)| Self::at_scale(value, truth, scale)))
    }

    /// Values of which only finiteness is asked.
    pub fn finite(values: impl IntoIterator<Item = f64>) -> Self {
        Self::of(values, Truth::Finite)
    }

    /// Number of calls that answered, of many; all their numbers must be finite.
    ///
    /// # Errors
    /// The name of an error that is not among `errors`.
    pub fn counted<N: IntoIterator<Item = f64>, E: Debug>(
        calls: impl IntoIterator<Item = Result<N, E>>,
        answered: u32,
        errors: &[&str],
    ) -> Result<Self, String> {
        let (mut count, mut numbers) = (0.0, Vec::new());
        for call in calls {
            match call.map_err(|error| name(&error)) {
                Ok(found) => {
                    count += 1.0;
                    numbers.extend(found);
                }
                Err(name) if errors.contains(&name.as_str()) => (),
                Err(name) => return Err(name),
            }
        }
        Ok(Self::near(count, answered.into()).also(numbers))
    }

    /// The error that the documentation allows.
    #[must_use]
    pub fn within(self, bound: f64) -> Self {
        Self { bound, ..self }
    }

    /// Sets the least error that there must be.
    #[must_use]
    pub fn at_least(self, least: f64) -> Self {
        Self { least, ..self }
    }

    /// Claims nothing but that it is finite where the condition leaves no digit.
    #[must_use]
    pub fn or_no_digits(mut self) -> Self {
        if self.explained() > MOST_EXPLAINED {
            self.truth = Truth::NoDigits;
        }
        self
    }

    /// The condition number.
    #[must_use]
    pub fn conditioned(self, condition: f64) -> Self {
        Self { condition, ..self }
    }

    /// Further numbers of the result, which must be finite.
    #[must_use]
    pub fn also(mut self, values: impl IntoIterator<Item = f64>) -> Self {
        self.values.extend(values);
        self
    }

    /// Error of the first value, in the terms of [`Truth`]; none where no value is known.
    pub fn error(&self) -> Option<f64> {
        let value = *self.values.first()?;
        let (truth, scale) = match self.truth {
            Truth::Relative(truth) => (truth, truth.abs()),
            Truth::OfScale { value, scale } => (value, scale),
            Truth::Finite | Truth::NoDigits => return None,
        };
        let is_exact = value == truth;
        Some(if is_exact {
            0.0
        } else {
            (value - truth).abs() / scale
        })
    }

    /// Whether it keeps what is promised.
    pub fn verdict(&self) -> Verdict {
        let all_finite = self.values.iter().all(|value| value.is_finite());
        let explained = self.explained();
        match (self.truth, self.error()) {
            _ if !all_finite || self.values.is_empty() => Verdict::NotFinite,
            (Truth::NoDigits, _) => Verdict::NoDigitsLeft,
            (_, None) => Verdict::Finite,
            (_, Some(error)) if error < self.least => Verdict::Unexplained,
            (_, Some(error)) if error <= self.bound => Verdict::WithinBound,
            (_, Some(error)) if explained <= MOST_EXPLAINED && error <= explained => {
                Verdict::Conditioned
            }
            (_, Some(_)) => Verdict::Unexplained,
        }
    }

    fn of(values: impl IntoIterator<Item = f64>, truth: Truth) -> Self {
        Self {
            values: values.into_iter().collect(),
            truth,
            condition: 1.0,
            bound: 0.0,
            least: 0.0,
        }
    }

    /// The error that the condition explains.
    fn explained(&self) -> f64 {
        SLACK * self.condition * f64::EPSILON
    }

    /// The one that errs most, with the values of all. NaN errs more than all else.
    fn worst(answers: impl Iterator<Item = Self>) -> Self {
        let error = |answer: &Self| answer.error().filter(|error| !error.is_nan());
        let error = |answer: &Self| error(answer).unwrap_or(f64::INFINITY);
        answers
            .reduce(|worst, next| {
                if error(&next) > error(&worst) {
                    next.also(worst.values)
                } else {
                    worst.also(next.values)
                }
            })
            .unwrap_or_else(|| Self::finite([]))
    }
}

#[cfg(test)]
mod tests {
    use super::{Answer, Verdict};

    #[test]
    fn the_worst_of_several_is_judged() {
        let answer = Answer::all_near([(1.0, 1.0), (2.2, 2.0), (3.0, 3.0)]);
        assert!((answer.error().unwrap() - 0.1).abs() < 1e-12);
        assert_eq!(answer.values.len(), 3);
        let nan = Answer::all_near([(1.0, 2.0), (f64::NAN, 2.0)]);
        assert!(nan.values[0].is_nan());
    }

    #[test]
    fn every_broken_promise_is_seen() {
        let near = |value: f64| Answer::near(value, 1.0).within(1e-14);
        for (answer, verdict) in [
            (near(1.0), Verdict::WithinBound),
            (near(1.1), Verdict::Unexplained),
            (near(1.01).conditioned(1e13), Verdict::Conditioned),
            // A condition that explains everything explains nothing.
            (near(1.1).conditioned(1e15), Verdict::Unexplained),
            (
                near(1.1).conditioned(1e15).or_no_digits(),
                Verdict::NoDigitsLeft,
            ),
            (
                near(1.1).conditioned(1e13).or_no_digits(),
                Verdict::Unexplained,
            ),
            (Answer::finite([1.0]), Verdict::Finite),
            (Answer::finite([]), Verdict::NotFinite),
            (near(1.0).within(0.5).at_least(0.1), Verdict::Unexplained),
            (near(1.0).also([f64::NAN]), Verdict::NotFinite),
            (Answer::holds(true), Verdict::WithinBound),
            (Answer::holds(false), Verdict::Unexplained),
        ] {
            assert_eq!(answer.verdict(), verdict, "{answer:?}");
        }
    }

    #[test]
    fn every_call_of_many_counts() {
        #[derive(Debug)]
        enum Fault {
            Flat,
            FarAway,
        }
        let calls = |second: f64| [Ok([1.0]), Ok([second]), Err(Fault::Flat)];
        let counted = |second, answered| Answer::counted(calls(second), answered, &["flat"]);
        assert_eq!(counted(2.0, 2).unwrap().verdict(), Verdict::WithinBound);
        assert_eq!(counted(2.0, 3).unwrap().verdict(), Verdict::Unexplained);
        let nan = counted(f64::NAN, 2).unwrap();
        assert_eq!(nan.verdict(), Verdict::NotFinite);
        let other = Answer::counted([Ok([1.0]), Err(Fault::FarAway)], 1, &["flat"]);
        assert_eq!(other.unwrap_err(), "far-away");
    }
}
