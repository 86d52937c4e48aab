//! Paths, columns, units and numbers in the words of a reader.

mod path;

pub(crate) use path::path;

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

/// A unit as a reader writes it: `per_cm2` is `1/cm²`, `rad_per_s` is `rad/s`. Nothing for a pure number.
pub(crate) fn unit(text: &str) -> String {
    let text = text.trim();
    if text.is_empty() || text == "1" || text == "-" {
        return String::new();
    }
    let text = match text.strip_prefix("per_") {
        Some(rest) => format!("1/{rest}"),
        None => text.replace("_per_", "/"),
    };
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

/// What a column shows: its words, its unit, and the factor from the table's numbers to the shown ones
/// (fractions are shown in percent).
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

/// The meaning of a statistic of a quantity whose unit in the table is `quantity_unit`.
pub(crate) fn statistic(name: &str, quantity: &str, quantity_unit: &str) -> Meaning {
    let share = quantity == "class";
    let quantity = self::quantity(quantity);
    let (words, percent, pure) = match name {
        "mean" if share => (quantity, true, true),
        "truth" => (format!("true {quantity}"), false, false),
        "trials" => ("trials".to_owned(), false, true),
        "failures" => ("failed trials".to_owned(), false, true),
        "mean" => (format!("mean estimate of {quantity}"), false, false),
        "std" => (format!("standard deviation of {quantity}"), false, false),
        "bias" => (format!("bias of {quantity}"), false, false),
        "rms_error" => (format!("rms error of {quantity}"), false, false),
        "mean_abs_error" => (format!("mean |error| of {quantity}"), false, false),
        "relative_rms_error" => (format!("rms relative error of {quantity}"), true, true),
        "relative_mean_abs_error" => (format!("mean |relative error| of {quantity}"), true, true),
        "mean_reported_std" => (format!("mean reported std of {quantity}"), false, false),
        "std_bound" => (
            format!("Cramér–Rao bound on the std of {quantity}"),
            false,
            false,
        ),
        "q50" => (format!("median estimate of {quantity}"), false, false),
        "coverage95" => (
            format!("share of 95 % intervals that hold the true {quantity}"),
            true,
            true,
        ),
        _ => match name.strip_prefix('q').and_then(|p| p.parse::<u8>().ok()) {
            Some(percent) => (
                format!("{percent} % quantile of the estimates of {quantity}"),
                false,
                false,
            ),
            None => (
                format!("{} of {quantity}", name.replace('_', " ")),
                false,
                false,
            ),
        },
    };
    match (percent, pure) {
        (true, _) => Meaning {
            words,
            unit: "%".to_owned(),
            factor: 100.0,
        },
        (false, true) => Meaning {
            words,
            unit: String::new(),
            factor: 1.0,
        },
        (false, false) => Meaning {
            words,
            unit: unit(quantity_unit),
            factor: 1.0,
        },
    }
}

/// The short name of a statistic, for a legend that already says of what.
pub(crate) fn short_statistic(name: &str) -> String {
    match name {
        "rms_error" => "rms error".to_owned(),
        "mean_abs_error" => "mean |error|".to_owned(),
        "relative_rms_error" => "rms relative error".to_owned(),
        "relative_mean_abs_error" => "mean |relative error|".to_owned(),
        "mean_reported_std" => "mean reported std".to_owned(),
        "truth" => "true value".to_owned(),
        "mean" => "mean estimate".to_owned(),
        "coverage95" => "coverage of 95 % intervals".to_owned(),
        "std" => "standard deviation".to_owned(),
        "q50" => "median estimate".to_owned(),
        "std_bound" => "Cramér–Rao bound".to_owned(),
        other => other.replace('_', " "),
    }
}

/// The words of a quantity.
pub(crate) fn quantity(name: &str) -> String {
    match name {
        "normal_curvature_u" => "normal curvature along u".to_owned(),
        "normal_curvature_v" => "normal curvature along v".to_owned(),
        "gaussian_curvature" => "Gaussian curvature".to_owned(),
        "class" => "share classified correctly".to_owned(),
        "r_squared" => "R² of the fit".to_owned(),
        other => other.replace('_', " "),
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
    fn statistics_are_words_with_units() {
        assert_eq!(
            statistic("rms_error", "gaussian_curvature", "per_cm2").label(),
            "rms error of Gaussian curvature (1/cm²)"
        );
        assert_eq!(
            statistic("relative_mean_abs_error", "normal_curvature_u", "1/cm").label(),
            "mean |relative error| of normal curvature along u (%)"
        );
        assert_eq!(
            statistic("mean", "class", "").label(),
            "share classified correctly (%)"
        );
        assert_eq!(
            statistic("std_bound", "relative_curvature", "1/mm").label(),
            "Cramér–Rao bound on the std of relative curvature (1/mm)"
        );
        assert_eq!(
            statistic("mean", "r_squared", "1").label(),
            "mean estimate of R² of the fit"
        );
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
