//! Warnings about contradictions between the readings and the model.

use palpate_statistics::Number;

use palpate_study::Warning;

/// StatedMismatch between the readings and the model, as an estimator reports it.
pub(super) trait Misfit {
    /// The contradiction as a warning with its p-value.
    fn warning(&self) -> Warning;
}

macro_rules! warns {
    ($($doubt:ty),+) => {$(
        impl Misfit for $doubt {
            fn warning(&self) -> Warning {
                Warning::new(self.name(), self.to_string(), [("p_value", self.p_value())])
            }
        }
    )+};
}

warns!(palpate_press::Doubt);

/// Adds the p-value of each contradiction to the warnings with the same code. If there is none, the contradiction is
/// added as a new warning.
pub(super) fn with_p_values(
    mut warnings: Vec<Warning>,
    contradictions: impl Iterator<Item = Warning>,
) -> Vec<Warning> {
    for contradiction in contradictions {
        let same = warnings
            .iter_mut()
            .filter(|one| one.code == contradiction.code);
        let numbered = same.map(|one| {
            let numbers = contradiction.numbers.iter();
            numbers.for_each(|(name, number)| {
                one.numbers.entry(name.clone()).or_insert(*number);
            });
        });
        if numbered.count() == 0 {
            warnings.push(contradiction);
        }
    }
    warnings
}

/// Goodness-of-fit p-value below which there is always a warning.
const ALWAYS_WARNED: f64 = 1e-6;

/// Warns of a fit that is too poor to be explained by noise, unless there are other warnings.
pub(super) fn poor_fit(p_value: Option<f64>, has_doubts: bool) -> Option<Warning> {
    let p_value = p_value.filter(|p_value| *p_value < ALWAYS_WARNED && !has_doubts)?;
    let shown = Number::rounded(p_value);
    let text = format!(
        "the residuals are larger than the stated noise makes them (p-value {shown}): the readings contradict the model or the noise"
    );
    Some(Warning::new("poor-fit", text, [("p_value", p_value)]))
}
