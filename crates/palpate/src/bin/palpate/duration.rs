//! Reads and writes durations as people write them, for example 1.5h.

use std::time::Duration;

/// Unit suffixes, each with its length in seconds.
const UNITS: [(&str, f64); 4] = [("s", 1.0), ("m", 60.0), ("h", 3600.0), ("", 1.0)];
/// Longest accepted duration, s. It is far below the limit of [`Duration`].
const LONGEST_S: f64 = 1e10;
const SHORTEST_S: f64 = 1e-9;
/// Range of numbers that are printed without an exponent.
const PLAIN: std::ops::Range<f64> = 1e-4..1e6;

pub(crate) fn parse(text: &str) -> Result<Duration, String> {
    let (number, unit) = UNITS
        .iter()
        .find_map(|(suffix, unit)| Some((text.strip_suffix(suffix)?, unit)))
        .unwrap_or((text, &1.0));
    let number: f64 = number
        .trim_end()
        .parse()
        .map_err(|_| "is not a duration; write 30s, 5m or 1.5h".to_owned())?;
    let seconds = number * unit;
    if (SHORTEST_S..=LONGEST_S).contains(&seconds) {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err(format!(
            "must be from {SHORTEST_S:e} to {LONGEST_S:e} seconds, is {text}"
        ))
    }
}

/// An approximate time as text, for a forecast.
pub(crate) fn roughly(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "a second".to_owned(),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A measured time as text, rounded to two significant digits.
pub(crate) fn short(seconds: f64) -> String {
    let (number, unit) = match seconds {
        s if s < 1e-6 => (1e9 * s, "ns"),
        s if s < 1e-3 => (1e6 * s, "us"),
        s if s < 1.0 => (1e3 * s, "ms"),
        s => (s, "s"),
    };
    format!("{} {unit}", two_digits(number))
}

pub(crate) fn two_digits(number: f64) -> String {
    exact(format!("{number:.1e}").parse().unwrap_or(number))
}

/// A number with all its digits, with an exponent if the number is very small or very large.
pub(crate) fn exact(number: f64) -> String {
    if number == 0.0 || PLAIN.contains(&number.abs()) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}
