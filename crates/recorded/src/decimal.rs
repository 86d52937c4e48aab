//! Numbers in a table, with a decimal point or a decimal comma.

use super::table_format::Decimal;

/// Parses the text of a table field, which must be a finite number. The number may have separators of thousands.
pub(super) fn number(text: &str, decimal: Decimal) -> Result<f64, String> {
    let parse = |text: &str| match decimal {
        Decimal::Point => text.parse::<f64>().ok(),
        Decimal::Comma if text.contains('.') => None,
        Decimal::Comma => text.replacen(',', ".", 1).parse::<f64>().ok(),
    };
    let parsed = parse(text)
        .or_else(|| parse(&text.replace('\u{2212}', "-")))
        .or_else(|| ungrouped(text, decimal)?.parse().ok());
    match parsed {
        Some(number) if number.is_finite() => Ok(number),
        Some(_) => Err(format!("must be finite, is {text}")),
        None if text.is_empty() => Err("is empty".to_owned()),
        None if is_clock_time(text) => Err(format!("`{text}` is a date or time; write seconds")),
        None if decimal == Decimal::Comma && text.contains('.') => {
            Err(format!("`{text}` is not a number with a decimal comma"))
        }
        None => Err(format!(
            "`{text}` is not a number; leave the field empty if its number is missing"
        )),
    }
}

/// Whether a text is a time of day, such as `12:30:01.5`, with or without a date.
fn is_clock_time(text: &str) -> bool {
    let is_part = |letter: char| letter.is_ascii_digit() || ":.,-+TZ ".contains(letter);
    text.contains(':') && text.chars().all(is_part)
}

/// Whether a field states that its number is missing. Lost readings have such fields. Excel writes errors such as
/// `#NUM!`, and C programs on Windows write `1.#INF`.
pub(super) fn is_missing(text: &str) -> bool {
    const WORDS: [&str; 10] = [
        "nan", "inf", "infinity", "na", "n/a", "n.a.", "<na>", "nat", "null", "none",
    ];
    let word = text.trim_start_matches(['+', '-']);
    word.is_empty()
        || word.as_bytes().starts_with(b"#")
        || word.as_bytes().windows(2).any(|pair| pair == b".#")
        || WORDS.iter().any(|one| one.eq_ignore_ascii_case(word))
}

/// Finds the decimal sign of a table from its numbers.
#[derive(Debug, Default)]
pub(super) struct DecimalSign {
    /// Whether semicolons separate the fields of the table. Then a point may separate thousands, because Excel writes
    /// such tables in locales with a decimal comma.
    pub(super) has_semicolons: bool,
    /// First number in the table whose comma can only be a decimal comma; `None` if there is none.
    pub(super) comma: Option<String>,
    /// First number in the table whose point can only be a decimal point; `None` if there is none.
    pub(super) point: Option<String>,
    /// Whether a number surely has a separator of thousands: it has both signs, or several separators.
    pub(super) has_thousands: bool,
}

impl DecimalSign {
    /// Stores `text`, a number of the table, if its point or comma shows which decimal sign the table uses. Returns
    /// whether the number contains a comma, or a point that may separate thousands.
    pub(super) fn add(&mut self, text: &str) -> bool {
        let is_odd = |decimal| ungrouped(text, decimal).is_none();
        let count = |sign| text.bytes().filter(|byte| *byte == sign).count();
        let [commas, points] = [b',', b'.'].map(count);
        if self.comma.is_some() && (commas, points) == (1, 0) {
            return true;
        }
        let is_point = self.point.is_some() || !self.has_semicolons;
        let is_thousands = commas > 1 || points > 1 || (commas > 0 && points > 0);
        let first = match () {
            () if commas > 0 && is_odd(Decimal::Point) => &mut self.comma,
            () if points > 0 && (is_point || is_odd(Decimal::Comma)) => &mut self.point,
            () if commas > 1 => &mut self.point,
            () if points > 1 => &mut self.comma,
            () => return commas + points > 0,
        };
        self.has_thousands |= is_thousands;
        first.get_or_insert_with(|| text.to_owned());
        commas > 0 || points > 1
    }

    /// The decimal sign of the table, or an error if this sign is ambiguous. The error message quotes `odd`, a number
    /// of the table whose comma or point may separate thousands.
    pub(super) fn decimal(&self, odd: &str) -> Result<Decimal, String> {
        match (&self.comma, &self.point) {
            (Some(_), None) if self.has_thousands || !odd.contains('.') => Ok(Decimal::Comma),
            (None, Some(_)) if self.has_thousands || !odd.contains(',') => Ok(Decimal::Point),
            (Some(other), _) | (None, Some(other)) => Err(format!(
                "`{odd}` and `{other}` have different signs: write all numbers with one decimal sign, or write setting `decimal` point or comma if the other sign separates thousands"
            )),
            (None, None) => {
                let whole = odd.replace([',', '.'], "");
                let [point, comma] = match odd.contains(',') {
                    true => [whole, odd.replace(',', ".")],
                    false => [odd.to_owned(), whole],
                };
                Err(format!(
                    "`{odd}` may be {point} or {comma}; write setting `decimal` point if it is {point}, and setting `decimal` comma if it is {comma}"
                ))
            }
        }
    }
}

/// The number without separators of thousands, with a decimal point. `None` if the text has another form. In `1,234`,
/// the comma may separate thousands; in `1,5` it cannot. Spaces and apostrophes may separate thousands, too.
fn ungrouped(text: &str, decimal: Decimal) -> Option<String> {
    let (sign, separator) = match decimal {
        Decimal::Point => ('.', ','),
        Decimal::Comma => (',', '.'),
    };
    let text = text.replace('\u{2212}', "-");
    let (whole, part) = text.split_once(sign).unwrap_or((&text, ""));
    let separators = [separator, ' ', '\u{a0}', '\u{202f}', '\'', '\u{2019}'];
    let mut groups = whole.trim_start_matches(['+', '-']).split(separators);
    let is_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let is_first =
        |group: &str| (1..=3).contains(&group.len()) && is_digits(group) && !group.starts_with('0');
    let is_grouped = groups.next().is_some_and(is_first)
        && groups.all(|group| group.len() == 3 && is_digits(group));
    (is_grouped && !part.contains(separators))
        .then(|| format!("{}.{part}", whole.replace(separators, "")))
}
