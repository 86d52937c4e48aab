//! Arguments that are numbers, directions or units.

use palpate_study::config::{LengthUnit, Range};

/// Components of a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction(pub(crate) [f64; 3]);

pub(super) fn positive(text: &str) -> Result<f64, String> {
    Range::POSITIVE.parse(text)
}

pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    Range::NOT_NEGATIVE.parse(text)
}

/// Standard deviation of an angle, rad: up to half a turn.
pub(super) fn angle_std(text: &str) -> Result<f64, String> {
    let most = Some(std::f64::consts::PI);
    Range {
        most,
        ..Range::NOT_NEGATIVE
    }
    .parse(text)
}

/// Share, from none to all.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let most = Some(1.0);
    Range {
        most,
        ..Range::NOT_NEGATIVE
    }
    .parse(text)
}

pub(super) fn direction(text: &str) -> Result<Direction, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| {
            part.trim()
                .parse()
                .map_err(|_| format!("`{part}` is not a number"))
        })
        .collect::<Result<_, _>>()?;
    let components: [f64; 3] = numbers
        .try_into()
        .map_err(|numbers: Vec<f64>| format!("needs 3 numbers, X,Y,Z; has {}", numbers.len()))?;
    let largest = components
        .iter()
        .fold(0.0, |largest: f64, one| largest.max(one.abs()));
    if components.iter().all(|one| one.is_finite()) && largest > 0.0 {
        Ok(Direction(components.map(|one| one / largest)))
    } else {
        Err("must be finite and not zero".to_owned())
    }
}

pub(super) fn length_unit(text: &str) -> Result<LengthUnit, String> {
    use LengthUnit::{Cm, M, Mm, Um, Unit};
    [M, Cm, Mm, Um, Unit]
        .into_iter()
        .find(|unit| unit.as_str() == text)
        .ok_or_else(|| "must be one of m, cm, mm, um, unit".to_owned())
}
