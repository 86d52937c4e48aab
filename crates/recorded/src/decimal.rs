//! Numbers in a table, with a decimal point or a decimal comma.

use super::table_format::Decimal;

/// Parses the text of a table field, which must be a finite number.
pub(super) fn number(text: &str, decimal: Decimal) -> Result<f64, String> {
    let parsed = match decimal {
        Decimal::Point => text.parse::<f64>(),
        Decimal::Comma if text.contains('.') => {
            return Err(format!("`{text}` is not a number with a decimal comma"));
        }
        Decimal::Comma => text.replacen(',', ".", 1).parse::<f64>(),
    };
    match parsed {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("must be finite, is {text}")),
        Err(_) if text.is_empty() => Err("is empty".to_owned()),
        Err(_) if is_clock_time(text) => Err(format!("`{text}` is a date or time; write seconds")),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

/// Whether a text is a time of day, such as `12:30:01.5`, with or without a date.
fn is_clock_time(text: &str) -> bool {
    let is_part = |letter: char| letter.is_ascii_digit() || ":.,-+TZ ".contains(letter);
    text.contains(':') && text.chars().all(is_part)
}

/// Whether a field states that its number is missing. Lost readings have such fields.
pub(super) fn is_missing(text: &str) -> bool {
    let text = text.trim_start_matches(['+', '-', '#']);
    let mut words = ["", "nan", "inf", "infinity", "na", "n/a", "null", "none"].into_iter();
    words.any(|word| word.eq_ignore_ascii_case(text))
}

#[derive(Debug, Default)]
pub(super) struct DecimalSign {
    /// First number in the table whose comma can only be a decimal comma; `None` if there is none.
    comma: Option<String>,
    /// First number in the table with a decimal point; `None` if there is none.
    point: Option<String>,
}

impl DecimalSign {
    /// Stores `text`, a number of the table, if its point or comma shows which decimal sign the table uses.
    pub(super) fn add(&mut self, text: &str) {
        let first = match () {
            () if text.contains('.') => &mut self.point,
            () if text.contains(',') && !may_be_grouped(text) => &mut self.comma,
            () => return,
        };
        first.get_or_insert_with(|| text.to_owned());
    }

    /// The decimal sign of the table, or an error if this sign is ambiguous. The error message quotes `odd`, a number
    /// of the table that contains a comma.
    pub(super) fn decimal(&self, odd: &str) -> Result<Decimal, String> {
        match (&self.comma, &self.point) {
            (Some(_), None) => Ok(Decimal::Comma),
            (Some(comma), Some(point)) => Err(format!(
                "`{comma}` has a comma and `{point}` has a point: write all numbers with one decimal sign and without separators of thousands"
            )),
            (None, Some(_)) => Err(format!(
                "`{odd}` has a separator of thousands; write it without"
            )),
            (None, None) => {
                let (as_decimal, as_whole) = (odd.replace(',', "."), odd.replace(',', ""));
                Err(format!(
                    "`{odd}` may be {as_decimal} or {as_whole}; give setting `decimal` comma if it is {as_decimal}, else write it without the comma"
                ))
            }
        }
    }
}

/// Whether the commas of a number may separate thousands: in `1,234` they may, in `1,5` they may not.
fn may_be_grouped(text: &str) -> bool {
    let digits = text.trim_start_matches(['+', '-']);
    let mut groups = digits.split(',');
    let is_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let is_first =
        |group: &str| (1..=3).contains(&group.len()) && is_digits(group) && !group.starts_with('0');
    groups.next().is_some_and(is_first) && groups.all(|group| group.len() == 3 && is_digits(group))
}
