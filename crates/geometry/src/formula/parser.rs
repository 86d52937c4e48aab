//! A Pratt parser. Every operator has a binding power. An operand between two operators belongs to the operator with
//! the larger binding power.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::Formula;
use super::error::{FormulaError, FormulaErrorKind as Kind};
use super::operation::{Binary, FUNCTIONS, Function, Unary};
use super::program::{Expression, Program};

const X: &str = "x";
const Y: &str = "y";
const PI: &str = "pi";

/// Binding power of a sign. It is larger than the binding power of `*` and smaller than the binding power of `^`.
const SIGN: u8 = 5;

type Result<T> = std::result::Result<T, (Kind, Span)>;

pub(super) fn parse(
    text: &str,
    parameters: &BTreeMap<String, f64>,
) -> std::result::Result<Program, FormulaError> {
    let fail = |kind| Err(FormulaError::new(kind, text, None));
    let characters = text.chars().count();
    if characters > Formula::MAX_CHARACTERS {
        return fail(Kind::TooLong(characters));
    }
    for (name, &value) in parameters {
        if [X, Y, PI].contains(&name.as_str()) || Function::named(name).is_some() {
            return fail(Kind::ReservedParameter(name.clone()));
        }
        if !value.is_finite() {
            return fail(Kind::ParameterNotFinite {
                name: name.clone(),
                value,
            });
        }
    }
    if text.trim().is_empty() {
        return fail(Kind::Empty);
    }
    let (program, used) = Parser::new(text, parameters)
        .and_then(Parser::formula)
        .map_err(|(kind, span)| FormulaError::new(kind, text, Some(span)))?;
    match parameters.keys().find(|name| !used.contains(name.as_str())) {
        Some(unused) => fail(Kind::UnusedParameter(unused.clone())),
        None => Ok(program),
    }
}

struct Parser<'a> {
    text: &'a str,
    parameters: &'a BTreeMap<String, f64>,
    used: BTreeSet<&'a str>,
    lexer: Lexer<'a>,
    /// The next token of the formula. The fields `span` and `previous` are the places of this token and of the previous
    /// token in the text.
    token: Token<'a>,
    span: Span,
    previous: Span,
    nesting: usize,
}

impl<'a> Parser<'a> {
    fn new(text: &'a str, parameters: &'a BTreeMap<String, f64>) -> Result<Self> {
        let mut lexer = Lexer::new(text);
        let (token, span) = lexer.next()?;
        Ok(Self {
            text,
            parameters,
            used: BTreeSet::new(),
            lexer,
            token,
            span,
            previous: 0..0,
            nesting: 0,
        })
    }

    /// Parses the whole formula. Returns its program and the names of its parameters.
    fn formula(mut self) -> Result<(Program, BTreeSet<&'a str>)> {
        let expression = self.expression(0)?;
        match self.token {
            Token::Close => Err((Kind::Unopened, self.span)),
            Token::Comma => Err((Kind::StrayComma, self.span)),
            _ => Ok((expression.into_program(), self.used)),
        }
    }

    /// Parses an operand and all operators after it whose binding power is at least `least`.
    fn expression(&mut self, least: u8) -> Result<Expression> {
        self.nesting += 1;
        if self.nesting > Formula::MAX_NESTING {
            return Err((Kind::TooDeep, self.span.clone()));
        }
        let start = self.span.start;
        let mut left = self.operand()?;
        while let Some((operation, binding, right_binding)) = self.operator()? {
            if binding < least {
                break;
            }
            self.advance()?;
            let right = self.expression(right_binding)?;
            left = self.finite(left.binary(operation, right), start)?;
        }
        self.nesting -= 1;
        Ok(left)
    }

    /// The next token if it is an operator, with its left and right binding powers.
    fn operator(&self) -> Result<Option<(Binary, u8, u8)>> {
        Ok(Some(match self.token {
            Token::Plus => (Binary::Add, 1, 2),
            Token::Minus => (Binary::Subtract, 1, 2),
            Token::Star => (Binary::Multiply, 3, 4),
            Token::Slash => (Binary::Divide, 3, 4),
            Token::Caret => (Binary::Power, 7, 6),
            Token::Close | Token::Comma | Token::End => return Ok(None),
            Token::Number(_) | Token::Name(_) | Token::Open => {
                let left = self.text[self.previous.clone()].into();
                let right = self.text[self.span.clone()].into();
                return Err((
                    Kind::ImplicitMultiplication { left, right },
                    self.span.clone(),
                ));
            }
        }))
    }

    fn operand(&mut self) -> Result<Expression> {
        let (token, span) = (self.token, self.span.clone());
        let after_star = self.text[..span.start].ends_with('*');
        self.advance()?;
        match token {
            Token::Number(value) => self.finite(Expression::Constant(value), span.start),
            Token::Name(name) => match Function::named(name) {
                Some(function) if self.token == Token::Open => {
                    self.call(name, function, span.start)
                }
                _ => self.variable(name, span),
            },
            Token::Open => {
                let inner = self.expression(0)?;
                self.close(span)?;
                Ok(inner)
            }
            Token::Plus => self.expression(SIGN),
            Token::Minus => Ok(self.expression(SIGN)?.unary(Unary::Negate)),
            Token::End => Err((Kind::UnexpectedEnd, span)),
            Token::Star if after_star => Err((Kind::DoubleStar, span.start - 1..span.end)),
            Token::Star | Token::Slash | Token::Caret | Token::Close | Token::Comma => {
                Err((Kind::ExpectedOperand(self.text[span.clone()].into()), span))
            }
        }
    }

    fn variable(&mut self, name: &'a str, span: Span) -> Result<Expression> {
        match name {
            X => return Ok(Expression::x()),
            Y => return Ok(Expression::y()),
            PI => return Ok(Expression::Constant(std::f64::consts::PI)),
            _ => {}
        }
        if let Some(&value) = self.parameters.get(name) {
            self.used.insert(name);
            return Ok(Expression::Constant(value));
        }
        let functions = FUNCTIONS.iter().map(|&(function, _)| function);
        let kind = if self.token == Token::Open {
            Kind::UnknownFunction {
                name: name.into(),
                suggestion: nearest(name, functions),
            }
        } else if Function::named(name).is_some() {
            Kind::MissingArguments(name.into())
        } else {
            let names = self.parameters.keys().map(String::as_str).chain([X, Y, PI]);
            Kind::UnknownName {
                name: name.into(),
                suggestion: nearest(name, names),
            }
        };
        Err((kind, span))
    }

    /// Parses the arguments of `function`, whose name begins at byte `start`. The next token must be `(`.
    fn call(&mut self, name: &str, function: Function, start: usize) -> Result<Expression> {
        let open = self.span.clone();
        let mut arguments = Vec::new();
        self.advance()?;
        if self.token != Token::Close {
            arguments.push(self.expression(0)?);
        }
        while self.token == Token::Comma {
            self.advance()?;
            arguments.push(self.expression(0)?);
        }
        self.close(open)?;
        let found = arguments.len();
        let (expected, value) = match function {
            Function::Unary(operation) => (
                1,
                <[_; 1]>::try_from(arguments).map(|[a]| a.unary(operation)),
            ),
            Function::Binary(operation) => (
                2,
                <[_; 2]>::try_from(arguments).map(|[a, b]| a.binary(operation, b)),
            ),
        };
        match value {
            Ok(value) => self.finite(value, start),
            Err(_) => Err((
                Kind::WrongArity {
                    function: name.into(),
                    expected,
                    found,
                },
                start..self.previous.end,
            )),
        }
    }

    fn close(&mut self, open: Span) -> Result<()> {
        match self.token {
            Token::Close => self.advance(),
            Token::Comma => Err((Kind::StrayComma, self.span.clone())),
            _ => Err((Kind::Unclosed, open)),
        }
    }

    /// Rejects a constant expression that is not finite. The expression begins at byte `start` and ends at the previous
    /// token.
    fn finite(&self, expression: Expression, start: usize) -> Result<Expression> {
        match expression {
            Expression::Constant(value) if !value.is_finite() => {
                Err((Kind::NotFinite(value), start..self.previous.end))
            }
            expression => Ok(expression),
        }
    }

    fn advance(&mut self) -> Result<()> {
        let (token, span) = self.lexer.next()?;
        self.previous = std::mem::replace(&mut self.span, span);
        self.token = token;
        Ok(())
    }
}

/// The candidate that is most similar to `name`; `None` if more than a third of the letters, or all letters, differ.
/// Upper and lower case count as equal.
fn nearest<'n>(name: &str, candidates: impl Iterator<Item = &'n str>) -> Option<String> {
    match name {
        "log" => return Some("ln".into()),
        "e" => return Some("exp(1)".into()),
        _ => {}
    }
    let letters = name.chars().count();
    let allowed = letters.div_ceil(3).min(letters - 1);
    candidates
        .map(|candidate| {
            (
                distance(&name.to_lowercase(), &candidate.to_lowercase()),
                candidate,
            )
        })
        .filter(|&(distance, _)| distance <= allowed)
        .min()
        .map(|(_, candidate)| candidate.into())
}

/// Levenshtein distance: the smallest number of letters to insert, delete or replace that turns `a` into `b`.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, &to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

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
    pub(super) fn next(&mut self) -> Result<(Token<'a>, Span)> {
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
                let value = number
                    .parse()
                    .map_err(|_| (Kind::BadNumber(number.into()), start..start + length))?;
                (Token::Number(value), length)
            }
            Some(letter) if letter.is_alphabetic() || letter == '_' => {
                let length = length_while(rest, in_name);
                (Token::Name(&rest[..length]), length)
            }
            Some(other) => {
                let span = start..start + other.len_utf8();
                return Err((Kind::UnexpectedCharacter(other), span));
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
