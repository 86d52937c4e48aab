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

/// Words of the quantities that are not called as in tables, `_` for a space.
const WORDS: [(&str, &str); 9] = [
    ("normal_curvature_u", "normal curvature along u"),
    ("normal_curvature_v", "normal curvature along v"),
    ("gaussian_curvature", "Gaussian curvature"),
    ("class", "share classified correctly"),
    ("r_squared", "R² of the fit"),
    ("marker_area", "image area of a marker"),
    ("greatest_fold_strain", "greatest strain of folding"),
    ("rms_fold_strain", "rms strain of folding"),
    ("pixels", "pixels evaluated per press"),
];

/// Quantities that are found by looking, not by estimating.
const MEASURED: [&str; 9] = [
    "class",
    "hue_change",
    "centroid_shift",
    "marker_area",
    "greatest_fold_strain",
    "rms_fold_strain",
    "markers_tracked",
    "wrong_matches",
    "pixels",
];

/// Quantities that are shares, which a reader sees in percent.
const SHARES: [&str; 3] = ["class", "greatest_fold_strain", "rms_fold_strain"];

/// Words of the quantity of this name.
///
/// ```
/// use palpate_study::quantity;
///
/// assert_eq!(quantity::words("gaussian_curvature"), "Gaussian curvature");
/// assert_eq!(quantity::words("relative_curvature"), "relative curvature");
/// assert!(quantity::is_measured("pixels") && !quantity::is_measured("relative_curvature"));
/// assert!(quantity::is_share("class"));
/// ```
pub fn words(name: &str) -> String {
    let known = WORDS.iter().find(|(known, _)| *known == name);
    known.map_or_else(|| name.replace('_', " "), |(_, words)| (*words).to_owned())
}

/// Whether the quantity of this name is found by looking, not by estimating: the mean of its values is no mean estimate.
pub fn is_measured(name: &str) -> bool {
    MEASURED.contains(&name)
}

/// Whether the quantity of this name is a share, which a reader sees in percent.
pub fn is_share(name: &str) -> bool {
    SHARES.contains(&name)
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
