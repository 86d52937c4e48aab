//! Paths, columns, units and numbers in the words of a reader.

mod path;
mod statistic;

pub(crate) use path::path;
pub(crate) use statistic::{quantity, short_statistic, statistic, statistic_of};

/// Units a header may end in, alone (`_cm`), squared (`_cm2`), inverse (`_per_cm`) or in a ratio (`_rad_per_s`).
const UNITS: [&str; 9] = ["m", "cm", "mm", "um", "unit", "rad", "deg", "s", "px"];

/// Splits the unit off the end of a header: `scene.object.radius_cm` is `scene.object.radius` in `cm`,
/// `scene.motion.rate_rad_per_s` is `scene.motion.rate` in `rad_per_s`. A header without a unit keeps its whole name.
pub(crate) fn split_unit(header: &str) -> (&str, &str) {
    let leaf = header.rfind('.').map_or(0, |dot| dot + 1);
    let tokens: Vec<&str> = header[leaf..].split('_').collect();
    let is_unit = |token: &str| UNITS.contains(&token.strip_suffix(['2', '3']).unwrap_or(token));
    // The longest unit wins, and a name must be left.
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

/// A unit as a reader writes it: `per_cm2` is `1/cm²`, `rad_per_s` is `rad/s`, `turn` is `turns`. Nothing for a pure
/// number.
pub(crate) fn unit(text: &str) -> String {
    let text = text.trim();
    if text.is_empty() || text == "1" || text == "-" {
        return String::new();
    }
    let text = match text.strip_prefix("per_") {
        Some(rest) => format!("1/{rest}"),
        None => text.replace("_per_", "/"),
    };
    let plural = |part: &str| if part == "turn" { "turns" } else { part }.to_owned();
    let text = text.split('/').map(plural).collect::<Vec<_>>().join("/");
    text.replace("um", "µm")
        .replace("deg", "°")
        .replace("^2", "²")
        .replace('2', "²")
        .replace('3', "³")
}

/// A label with its unit in brackets, if it has one.
pub(crate) fn with_unit(label: &str, unit: &str) -> String {
    if unit.is_empty() {
        label.to_owned()
    } else {
        format!("{label} ({unit})")
    }
}

/// Meaning of a column: its words, its unit, and the factor from the numbers in the table to those shown (fractions are
/// shown in percent).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Meaning {
    pub(crate) words: String,
    pub(crate) unit: String,
    pub(crate) factor: f64,
}

impl Meaning {
    /// Words and unit, as on an axis.
    pub(crate) fn label(&self) -> String {
        with_unit(&self.words, &self.unit)
    }

    /// A value of the table as shown, with its unit: `0.05` of a fraction is `5 %`; text stays as it is.
    pub(crate) fn value(&self, text: &str) -> String {
        let bare = self.bare_value(text);
        if self.unit.is_empty() || crate::table::finite(text).is_none() {
            bare
        } else if self.unit == "°" {
            format!("{bare}°")
        } else {
            format!("{bare} {}", self.unit)
        }
    }

    /// A value of the table as shown, without its unit.
    pub(crate) fn bare_value(&self, text: &str) -> String {
        crate::table::finite(text)
            .map_or_else(|| text.to_owned(), |value| number(value * self.factor))
    }
}

/// A number in six significant digits at most, without trailing zeros.
pub(crate) fn number(value: f64) -> String {
    significant(value, 6)
}

/// A number in at most `digits` significant digits, without trailing zeros; powers of ten from 1e6 up and
/// below 1e-4.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let rounded = format!("{value:.*e}", digits.max(1) - 1);
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        trim(&format!("{value:.decimals$}")).replace('-', "−")
    } else {
        format!(
            "{} × 10{}",
            trim(mantissa).replace('-', "−"),
            superscript(exponent)
        )
    }
}

/// A number in all its digits, as the shortest decimal that reads back as it: with an exponent from 1e16 up and
/// below 1e-4.
pub(crate) fn exact(value: f64) -> String {
    if value == 0.0 || (1e-4..1e16).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

fn trim(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

/// A whole number raised: `-3` is `⁻³`.
pub(crate) fn superscript(exponent: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |digit| digits[digit as usize]);
    exponent.to_string().chars().map(raise).collect()
}

/// A count with a comma between thousands.
pub(crate) fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut grouped = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// How many trials stand behind each point or cell, from their counts.
pub(crate) fn sample(trials: impl Iterator<Item = f64>, of: &str) -> String {
    let mut trials: Vec<u64> = trials.map(|n| n as u64).collect();
    trials.sort_unstable();
    trials.dedup();
    match trials.as_slice() {
        [] | [1] => "noiseless".to_owned(),
        [n] => format!("{} trials per {of}", count(*n)),
        [1, n] => format!("{} trials per {of} (1 where nothing is random)", count(*n)),
        [least, .., most] => format!("{} to {} trials per {of}", count(*least), count(*most)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_come_off_headers() {
        for (header, stem, tail) in [
            ("scene.object.radius_cm", "scene.object.radius", "cm"),
            (
                "scene.motion.rate_rad_per_s",
                "scene.motion.rate",
                "rad_per_s",
            ),
            ("scene.motion.duration_s", "scene.motion.duration", "s"),
            ("scene.object.c_per_cm", "scene.object.c", "per_cm"),
            (
                "gaussian_curvature_per_cm2",
                "gaussian_curvature",
                "per_cm2",
            ),
            (
                "scene.noise.angular_velocity.fraction",
                "scene.noise.angular_velocity.fraction",
                "",
            ),
            ("scene.object.parameters.A", "scene.object.parameters.A", ""),
            ("scene.object.s", "scene.object.s", ""),
            ("scene.object.m_per_cm", "scene.object.m", "per_cm"),
            ("", "", ""),
        ] {
            assert_eq!(split_unit(header), (stem, tail), "{header}");
        }
    }

    #[test]
    fn units_are_as_a_reader_writes_them() {
        for (written, shown) in [
            ("per_cm2", "1/cm²"),
            ("rad_per_s", "rad/s"),
            ("1/mm^2", "1/mm²"),
            ("um", "µm"),
            ("deg", "°"),
            ("turn", "turns"),
            ("turn_per_mm", "turns/mm"),
            ("px^2", "px²"),
            ("1", ""),
        ] {
            assert_eq!(unit(written), shown);
        }
    }

    #[test]
    fn numbers_are_short_and_exact_enough() {
        for (value, text) in [
            (0.0, "0"),
            (0.07 * 100.0, "7"),
            (500.0, "500"),
            (0.001, "0.001"),
            (-2.5, "−2.5"),
            (1e-9, "1 × 10⁻⁹"),
            (123456.7, "123457"),
            (999999.9, "1 × 10⁶"),
            (2.5e10, "2.5 × 10¹⁰"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(significant(11.8765, 3), "11.9");
        assert_eq!(significant(584.4, 3), "584");
        assert_eq!(significant(58_440.0, 3), "58440");
        for (value, text) in [
            (0.0, "0"),
            (7.0, "7"),
            (1.0 / 3.0, "0.3333333333333333"),
            (-1e16, "-1e16"),
            (1e300, "1e300"),
            (5e-324, "5e-324"),
            (0.0001, "0.0001"),
        ] {
            assert_eq!(exact(value), text);
        }
        assert_eq!(count(1_234_567), "1,234,567");
        assert_eq!(count(999), "999");
    }
}
