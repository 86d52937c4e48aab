//! Splits a formula into tokens with their places in the text.

use std::ops::Range;

use super::error::FormulaErrorKind;

pub(super) type Span = Range<usize>;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    Plus,
    Minus,
    Star,
    Slash,
    Caret,
    Open,
    Close,
    Comma,
    End,
}

/// Returns the tokens of a formula one by one, so that the parser reports the first error in the text.
#[derive(Debug)]
pub(super) struct Lexer<'a> {
    text: &'a str,
    position: usize,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self {
            text: text.trim_end(),
            position: 0,
        }
    }

    /// The next token, with its place in the text. After the last token of the formula, every call returns
    /// [`Token::End`].
    pub(super) fn next(&mut self) -> Result<(Token<'a>, Span), (FormulaErrorKind, Span)> {
        let start = self.text.len() - self.text[self.position..].trim_start().len();
        let rest = &self.text[start..];
        let (token, length) = match rest.chars().next() {
            None => (Token::End, 0),
            Some('+') => (Token::Plus, 1),
            Some('-') => (Token::Minus, 1),
            Some('*') => (Token::Star, 1),
            Some('/') => (Token::Slash, 1),
            Some('^') => (Token::Caret, 1),
            Some('(') => (Token::Open, 1),
            Some(')') => (Token::Close, 1),
            Some(',') => (Token::Comma, 1),
            Some('0'..='9' | '.') => {
                let length = number_length(rest);
                let number = &rest[..length];
                let value = number.parse().map_err(|_| {
                    (
                        FormulaErrorKind::BadNumber(number.into()),
                        start..start + length,
                    )
                })?;
                (Token::Number(value), length)
            }
            Some(letter) if letter.is_alphabetic() || letter == '_' => {
                let length = length_while(rest, in_name);
                (Token::Name(&rest[..length]), length)
            }
            Some(other) => {
                let span = start..start + other.len_utf8();
                return Err((FormulaErrorKind::UnexpectedCharacter(other), span));
            }
        };
        self.position = start + length;
        Ok((token, start..self.position))
    }
}

/// Length in bytes of the number at the start of `text`: digits and points, then an exponent. The number may be
/// malformed. In `2exp(x)` the `e` starts a function; in `2e` and `2e+x` it starts an incomplete exponent.
fn number_length(text: &str) -> usize {
    let mantissa = length_while(text, |c| c.is_ascii_digit() || c == '.');
    let rest = &text[mantissa..];
    if !rest.starts_with(['e', 'E']) {
        return mantissa;
    }
    let exponent = &rest[1..];
    let sign = usize::from(exponent.starts_with(['+', '-']));
    let digits = length_while(&exponent[sign..], |c| c.is_ascii_digit());
    if digits == 0 && exponent.starts_with(in_name) {
        return mantissa;
    }
    mantissa + 1 + sign + digits
}

fn in_name(c: char) -> bool {
    c.is_alphabetic() || c.is_ascii_digit() || c == '_'
}

fn length_while(text: &str, belongs: impl Fn(char) -> bool) -> usize {
    text.find(|c| !belongs(c)).unwrap_or(text.len())
}
