//! Formats numbers for tables and for people, and parses numbers.

use std::fmt;

/// The shortest text that parses to the same number, as in tables. A negative zero is written without its sign.
///
/// ```
/// use palpate_study::number;
///
/// assert_eq!(number::shortest(-0.0), "0");
/// assert_eq!(number::shortest(1.0 / 3.0), "0.3333333333333333");
/// assert_eq!(number::significant(-1234567.0, 3), "−1.23 × 10⁶");
/// assert_eq!(number::grouped(1_234_567), "1,234,567");
/// ```
pub fn shortest(value: f64) -> String {
    Shortest(value).to_string()
}

/// A number whose `Display` text is the text that [`shortest`] returns.
///
/// ```
/// assert_eq!(format!("{}", palpate_study::number::Shortest(-0.0)), "0");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Shortest(pub f64);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (self.0 + 0.0).fmt(f)
    }
}

/// A number as text for messages, with at most six significant digits and without trailing zeros.
pub fn rounded(value: f64) -> String {
    significant(value, 6)
}

/// A number as text for messages, with at most `digits` significant digits and without trailing zeros. If the number's
/// magnitude is at least 1e6 or below 1e-4, the text contains a power of ten.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let rounded = format!("{value:.*e}", digits.max(1) - 1);
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        trimmed(&format!("{value:.decimals$}")).replace('-', "−")
    } else {
        let mantissa = trimmed(mantissa).replace('-', "−");
        format!("{mantissa} × 10{}", superscript(exponent))
    }
}

fn trimmed(text: &str) -> &str {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => text,
    }
}

/// An integer in superscript digits: `-3` becomes `⁻³`.
pub fn superscript(exponent: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |digit| digits[digit as usize]);
    exponent.to_string().chars().map(raise).collect()
}

/// A count as text, with commas between thousands.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut grouped = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// Parses a finite number; `None` for other texts.
pub fn finite(text: &str) -> Option<f64> {
    let number: f64 = text.trim().parse().ok()?;
    number.is_finite().then_some(number)
}
