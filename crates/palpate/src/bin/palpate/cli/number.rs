//! Parses arguments that are numbers, vectors or units.

use palpate_study::config::{LengthUnit, Range};

pub(super) fn positive(text: &str) -> Result<f64, String> {
    Range::POSITIVE.parse(text)
}

pub(super) fn radius(text: &str) -> Result<f64, String> {
    let range = Range {
        may_be_infinite: true,
        ..Range::POSITIVE
    };
    range.parse(text)
}

pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    Range::NOT_NEGATIVE.parse(text)
}

/// Parses `size` numbers, separated by commas. Error messages show `name` as the expected form.
pub(super) fn vector(text: &str, size: usize, name: &str) -> Result<Vec<f64>, String> {
    let number = |part: &str| {
        let number = part
            .trim()
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| format!("`{part}` is not a number"))
    };
    let numbers: Vec<f64> = text.split(',').map(number).collect::<Result<_, _>>()?;
    match numbers.len() {
        count if count == size => Ok(numbers),
        count => Err(format!("needs {size} numbers, {name}; has {count}")),
    }
}

pub(super) fn length_unit(text: &str) -> Result<LengthUnit, String> {
    use LengthUnit::{Cm, M, Mm, Um, Unit};
    [M, Cm, Mm, Um, Unit]
        .into_iter()
        .find(|unit| unit.as_str() == text)
        .ok_or_else(|| "must be one of m, cm, mm, um, unit".to_owned())
}
