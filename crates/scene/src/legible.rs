//! Numbers in messages.

/// A message in which no number is written out in long rows of zeros: those from 1e16 up and below
/// 1e-5 get an exponent, the others stay as they are.
pub(crate) fn legible(message: &str) -> String {
    let is_of_number = |one: char| one.is_ascii_digit() || one == '.';
    let mut text = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(start) = rest.find(|one: char| one.is_ascii_digit()) {
        let (before, from) = rest.split_at(start);
        let (written, after) = from.split_at(from.find(|c| !is_of_number(c)).unwrap_or(from.len()));
        text.push_str(before);
        text.push_str(&with_exponent(written).unwrap_or_else(|| written.to_owned()));
        rest = after;
    }
    text + rest
}

fn with_exponent(written: &str) -> Option<String> {
    let number: f64 = written.parse().ok()?;
    let is_long = number >= 1e16 || (number > 0.0 && number < 1e-5);
    (is_long && number.is_finite()).then(|| format!("{number:e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_rows_of_digits_get_an_exponent() {
        for number in [1e300, 2.5e-300, 1e16, 9.9e-6, f64::MIN_POSITIVE, f64::MAX] {
            let message =
                |number: &str| format!("3 contacts: x is -{number}; between 1e-150 and 4.");
            assert_eq!(
                legible(&message(&number.to_string())),
                message(&format!("{number:e}"))
            );
        }
        for same in [
            "",
            "0.00001, 0, 0.0",
            "1234567890123456.",
            "of 1.5e300",
            "1.2.3 …",
        ] {
            assert_eq!(legible(same), same);
        }
    }
}
