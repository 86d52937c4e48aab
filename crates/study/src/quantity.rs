//! Quantities that scenes estimate, and their units.

use crate::config::LengthUnit;

/// A unit, made of the study's length unit.
///
/// ```
/// use palpate_study::Unit;
/// use palpate_study::config::LengthUnit;
///
/// assert_eq!(Unit::Length.of(LengthUnit::Mm), "mm");
/// assert_eq!(Unit::PerLengthSquared.of(LengthUnit::Cm), "1/cm^2");
/// assert_eq!(Unit::Turn.of(LengthUnit::Cm), "turn");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Length.
    Length,
    /// 1/length.
    PerLength,
    /// 1/length².
    PerLengthSquared,
    /// Length².
    LengthSquared,
    /// Share, without a unit.
    One,
    /// Turn, of a hue.
    Turn,
    /// Pixel.
    Pixel,
    /// Pixel².
    PixelSquared,
}

/// A quantity that a scene estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Its name, as in `cells.csv` and the JSON of `estimate`.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
}

impl Unit {
    /// The unit in words, as in the `unit` column: `cm`, `1/cm`, `1/cm^2`.
    pub fn of(self, length: LengthUnit) -> String {
        let length = length.as_str();
        match self {
            Self::Length => length.to_owned(),
            Self::PerLength => format!("1/{length}"),
            Self::PerLengthSquared => format!("1/{length}^2"),
            Self::LengthSquared => format!("{length}^2"),
            Self::One => "1".to_owned(),
            Self::Turn => "turn".to_owned(),
            Self::Pixel => "px".to_owned(),
            Self::PixelSquared => "px^2".to_owned(),
        }
    }
}
