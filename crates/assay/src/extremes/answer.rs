//! What an entry point gave, and what it should have given.

use std::fmt::{self, Debug};

use super::case::Verdict;

/// Errors may be so many times what the condition explains.
const SLACK: f64 = 10.0;

/// What an entry point gave.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Numbers, the first of which is judged.
    Value(Answer),
    /// An error, by its stable name.
    Refused(String),
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
    /// Only that it is finite (the case's input says why).
    Finite,
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
        }
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
            Truth::Finite => return None,
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
        match self.error() {
            _ if !all_finite || self.values.is_empty() => Verdict::NotFinite,
            None => Verdict::WithinBound,
            Some(error) if error <= self.bound => Verdict::WithinBound,
            Some(error) if error <= SLACK * self.condition * f64::EPSILON => Verdict::Conditioned,
            Some(_) => Verdict::Unexplained,
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

/// An error by the stable name that it gives itself.
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
    use super::{Answer, kebab};

    #[test]
    fn names_of_errors() {
        assert_eq!(kebab("NotFinite { probe: 3 }"), "not-finite");
        assert_eq!(kebab("OutOfRange"), "out-of-range");
        assert_eq!(kebab("out-of-range"), "out-of-range");
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
