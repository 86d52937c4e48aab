//! Results of entry points, beside the results that they should have had.

use std::fmt::{self, Debug};

use super::case::Verdict;

/// Factor by which an error may exceed what the condition explains.
const SLACK: f64 = 10.0;
/// Largest error that a condition may explain; above it hardly a digit of the result is left, and no error is excused.
const MOST_EXPLAINED: f64 = 0.1;

/// Result of a call of an entry point: numbers or an error.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Numbers, the first of which is judged.
    Value(Answer),
    /// An error, by its stable name.
    Refused(String),
}

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
    /// No known value: the number need only be finite (the case's input says why).
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
        Self::of(
            [value],
            Truth::OfScale {
                value: truth,
                scale,
            },
        )
    }

    /// The largest error of several values, each relative to its own truth.
    pub fn all_near(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self::worst(
            pairs
                .into_iter()
                .map(|(value, truth)| Self::near(value, truth)),
        )
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

    /// How far the first value errs.
    pub fn error(&self) -> Option<f64> {
        let value = self.values.first()?;
        let (truth, scale) = match self.truth {
            Truth::Relative(truth) => (truth, truth.abs()),
            Truth::OfScale { value, scale } => (value, scale),
            Truth::Finite | Truth::NoDigits => return None,
        };
        let exact = *value == truth;
        Some(if exact {
            0.0
        } else {
            (value - truth).abs() / scale
        })
    }

    pub(super) fn verdict(&self) -> Verdict {
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
}

impl Outcome {
    /// Outcome of one entry point for many inputs: all numbers of the inputs that it answered, which need only be
    /// finite; the last error if it answered none.
    pub(super) fn of_all<E: Debug, N: IntoIterator<Item = f64>>(
        attempts: impl IntoIterator<Item = Result<N, E>>,
    ) -> Self {
        let mut numbers = Vec::new();
        let mut refused = None;
        for attempt in attempts {
            match attempt {
                Ok(found) => numbers.extend(found),
                Err(error) => refused = Some(error),
            }
        }
        match refused {
            Some(error) if numbers.is_empty() => Err::<Answer, _>(error).into(),
            _ => Answer::finite(numbers).into(),
        }
    }
}

impl From<Answer> for Outcome {
    fn from(answer: Answer) -> Self {
        Self::Value(answer)
    }
}

impl<E: Debug> From<Result<Answer, E>> for Outcome {
    /// An error's stable name is that of its variant, in kebab case.
    fn from(result: Result<Answer, E>) -> Self {
        match result {
            Ok(answer) => Self::Value(answer),
            Err(error) => Self::Refused(kebab(&format!("{error:?}"))),
        }
    }
}

/// Error that stands for the `None` of an entry point.
pub(super) const NONE: Named = Named("none");

/// An error by the stable name that it gives itself.
#[derive(Clone, Copy)]
pub(super) struct Named(pub(super) &'static str);

impl Debug for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// `NotFinite { probe: 3 }` is `not-finite`.
fn kebab(debug: &str) -> String {
    let name = debug
        .split(|c: char| !c.is_alphanumeric() && c != '-')
        .next();
    let mut kebab = String::new();
    for letter in name.unwrap_or_default().chars() {
        if letter.is_uppercase() && !kebab.is_empty() {
            kebab.push('-');
        }
        kebab.extend(letter.to_lowercase());
    }
    kebab
}

#[cfg(test)]
mod tests {
    use super::{Answer, Named, Outcome, kebab};

    #[test]
    fn names_of_errors() {
        assert_eq!(kebab("NotFinite { probe: 3 }"), "not-finite");
        assert_eq!(kebab("OutOfRange"), "out-of-range");
        assert_eq!(kebab("out-of-range"), "out-of-range");
    }

    #[test]
    fn many_inputs_answer_together_or_are_refused_by_name() {
        let answered = [Ok(vec![1.0]), Err(Named("flat")), Ok(vec![2.0])];
        match Outcome::of_all(answered) {
            Outcome::Value(answer) => assert_eq!(answer.values, [1.0, 2.0]),
            Outcome::Refused(name) => panic!("{name}"),
        }
        let refused = [Err::<Vec<f64>, _>(Named("flat")), Err(Named("far-away"))];
        match Outcome::of_all(refused) {
            Outcome::Value(answer) => panic!("{answer:?}"),
            Outcome::Refused(name) => assert_eq!(name, "far-away"),
        }
    }

    #[test]
    fn the_worst_of_several_is_judged() {
        let answer = Answer::all_near([(1.0, 1.0), (2.2, 2.0), (3.0, 3.0)]);
        assert!((answer.error().unwrap() - 0.1).abs() < 1e-12);
        assert_eq!(answer.values.len(), 3);
        let nan = Answer::all_near([(1.0, 2.0), (f64::NAN, 2.0)]);
        assert!(nan.values[0].is_nan());
    }
}
