//! Formats numbers for messages.

use std::fmt;

/// A number, formatted for messages. It has the smallest number of digits that identify the number exactly. The text
/// has an exponent if the number's magnitude is at least 1e16 or below 1e-4. Zero has no sign. If the format states a
/// precision, as in `{:.4}`, small numbers have no exponent.
///
/// ```
/// use palpate_statistics::Number;
///
/// let shown = [0.1, -3.0, 1e15, 1e16, 2.5e-300, -0.0].map(|number| Number(number).to_string());
/// assert_eq!(shown, ["0.1", "-3", "1000000000000000", "1e16", "2.5e-300", "0"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number(pub f64);

impl Number {
    /// The number, rounded to three significant digits.
    #[must_use]
    pub fn rounded(number: f64) -> Self {
        Self(format!("{number:.2e}").parse().unwrap_or(number))
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = self.0 + 0.0;
        let size = number.abs();
        let is_long = size >= 1e16 || (size > 0.0 && size < 1e-4 && f.precision().is_none());
        if is_long && size.is_finite() {
            fmt::LowerExp::fmt(&number, f)
        } else {
            fmt::Display::fmt(&number, f)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_reads_back_the_same_and_is_short() {
        for exponent in -323..=308 {
            let number: f64 = format!("-1.2345678901234567e{exponent}")
                .parse()
                .unwrap_or(0.0);
            let shown = Number(number).to_string();
            assert_eq!(shown.parse(), Ok(number));
            assert!(shown.len() <= 24, "{shown}");
        }
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        assert_eq!(
            odd.map(|odd| Number(odd).to_string()),
            ["NaN", "inf", "-inf"]
        );
        let shown = [2.0 / 3.0, 123_456.0, -1e-9].map(|number| Number::rounded(number).to_string());
        assert_eq!(shown, ["0.667", "123000", "-1e-9"]);
        let shown = [1.0 / 3.0, 1e-9, 1e40 / 3.0].map(|number| format!("{:.2}", Number(number)));
        assert_eq!(shown, ["0.33", "0.00", "3.33e39"]);
    }
}
