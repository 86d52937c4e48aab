//! Verdicts on rows, and stable names.

use std::fmt::Debug;

/// Whether a promise is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A value within the bound that the documentation states.
    WithinBound,
    /// A value beyond that bound, by no more than ten times what the reported condition explains, and no more than 0.1.
    Conditioned,
    /// Finite, where neither a truth nor a bound is known.
    Finite,
    /// Finite, where the condition leaves no digit.
    NoDigitsLeft,
    /// The error that the row names.
    Refused,
    /// Another error than the row names.
    RefusedOtherwise,
    /// An error where a value can be computed.
    NeedlesslyRefused,
    /// A value where there is none.
    WronglyAnswered,
    /// A value that errs by more than bound and condition explain, or by less than it must.
    Unexplained,
    /// NaN or infinity.
    NotFinite,
    /// A panic.
    Panicked,
}

impl Verdict {
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

/// Name of a variant in kebab case: `NotFinite { probe: 3 }` is `not-finite`. A text is its own name.
pub(crate) fn name(named: &impl Debug) -> String {
    let debug = format!("{named:?}");
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '-';
    let variant = debug
        .trim_start_matches('"')
        .split(|letter| !is_part(letter));
    let mut kebab = String::new();
    for letter in variant.take(1).flat_map(str::chars) {
        if letter.is_uppercase() && !kebab.is_empty() {
            kebab.push('-');
        }
        kebab.extend(letter.to_lowercase());
    }
    kebab
}

#[cfg(test)]
mod tests {
    use super::{Verdict, name};

    #[test]
    fn names_of_variants_and_of_texts() {
        assert_eq!(name(&Verdict::NotFinite), "not-finite");
        assert_eq!(name(&Some(1)), "some");
        assert_eq!(name(&"out-of-range"), "out-of-range");
    }
}
