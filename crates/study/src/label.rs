//! Converts the names of columns, quantities and units to the words that figures and messages show.

use crate::number;
use crate::quantity::Quantity;

/// Label of a column: its words, its unit in the usual notation, and a factor. The numbers of the column are multiplied
/// by the factor before they are displayed. The factor is 100 for shares, which are displayed in percent, and 1 for
/// other numbers.
///
/// ```
/// use palpate_study::Label;
///
/// let noise = Label::of_field("scene.noise.angular_velocity.fraction");
/// assert_eq!(noise.to_string(), "angular velocity noise (%)");
/// assert_eq!(noise.value("0.05"), "5 %");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Name of the column in words, without the unit.
    pub words: String,
    /// The unit in the usual notation; empty for a pure number.
    pub unit: String,
    /// Factor by which numbers of the column are multiplied before they are displayed.
    pub factor: f64,
}

/// The words and, in brackets, the unit.
impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.words)?;
        match self.unit.as_str() {
            "" => Ok(()),
            unit => write!(f, " ({unit})"),
        }
    }
}

impl Label {
    /// Label of a column whose numbers are displayed without a factor. `unit` is in the usual notation, such as
    /// `1/cm²`.
    pub(crate) fn in_unit(words: impl Into<String>, unit: &str) -> Self {
        Self {
            words: words.into(),
            unit: unit.to_owned(),
            factor: 1.0,
        }
    }

    /// Label of a column of shares, which are displayed in percent. `unit` is a percent sign, or a percent sign with
    /// its reference, such as `% of the IFD` (inter-finger distance).
    pub(crate) fn in_percent(words: impl Into<String>, unit: &str) -> Self {
        Self {
            words: words.into(),
            unit: unit.to_owned(),
            factor: 100.0,
        }
    }

    /// A value of a table as it is displayed, with its unit: a share of `0.05` becomes `5 %`. Texts that are not
    /// numbers stay unchanged.
    pub fn value(&self, text: &str) -> String {
        let bare = self.bare_value(text);
        match self.unit.as_str() {
            _ if number::finite(text).is_none() => bare,
            "" => bare,
            "°" => format!("{bare}°"),
            unit => format!("{bare} {unit}"),
        }
    }

    /// A value of a table as it is displayed, without its unit.
    pub fn bare_value(&self, text: &str) -> String {
        number::finite(text).map_or_else(
            || text.to_owned(),
            |value| number::rounded(value * self.factor),
        )
    }
}

/// The name of a quantity in words. For an unknown quantity, underscores in `name` are replaced by spaces.
///
/// ```
/// use palpate_study::label;
///
/// assert_eq!(label::quantity("gaussian_curvature"), "Gaussian curvature");
/// assert_eq!(label::quantity("rolling_speed"), "rolling speed");
/// ```
pub fn quantity(name: &str) -> String {
    let known = Quantity::named(name);
    known.map_or_else(
        || name.replace('_', " "),
        |quantity| quantity.words.to_owned(),
    )
}

/// Units that may be at the end of a header: alone (`_cm`), squared (`_cm2`), inverse (`_per_cm`) or in a ratio
/// (`_rad_per_s`).
const UNITS: [&str; 10] = ["m", "cm", "mm", "um", "unit", "rad", "deg", "s", "hz", "px"];

/// Splits the header of a column into name and unit: `scene.object.radius_cm` is `scene.object.radius` in `cm`,
/// `scene.motion.rate_rad_per_s` is `scene.motion.rate` in `rad_per_s`. A header without a unit is the whole name.
pub fn split_unit(header: &str) -> (&str, &str) {
    let leaf = header.rfind('.').map_or(0, |dot| dot + 1);
    let tokens: Vec<&str> = header[leaf..].split('_').collect();
    let is_unit = |token: &str| UNITS.contains(&token.strip_suffix(['2', '3']).unwrap_or(token));
    // Use the longest unit that matches, but keep at least one word of the header as the name.
    for length in (1..=3.min(tokens.len() - 1)).rev() {
        let found = match tokens[tokens.len() - length..] {
            [a, "per", b] => is_unit(a) && is_unit(b),
            ["per", b] | [b] => is_unit(b),
            _ => false,
        };
        if found {
            let unit: usize = tokens[tokens.len() - length..]
                .iter()
                .map(|token| token.len() + 1)
                .sum();
            let cut = header.len() - unit;
            return (&header[..cut], &header[cut + 1..]);
        }
    }
    (header, "")
}

/// Converts a unit from a header to the usual notation: `per_cm2` becomes `1/cm²`, `rad_per_s` becomes `rad/s`, `turn`
/// becomes `turns`. The result is empty for a pure number.
pub fn spoken_unit(text: &str) -> String {
    let text = text.trim();
    if text.is_empty() || text == "1" || text == "-" {
        return String::new();
    }
    let inverse = text.strip_prefix("per_");
    let text = inverse.map_or_else(|| text.replace("_per_", "/"), |rest| format!("1/{rest}"));
    let plural = |part: &str| if part == "turn" { "turns" } else { part }.to_owned();
    let text = text.split('/').map(plural).collect::<Vec<_>>().join("/");
    text.replace("um", "µm")
        .replace("deg", "°")
        .replace("hz", "Hz")
        .replace("^2", "²")
        .replace('2', "²")
        .replace('3', "³")
}
