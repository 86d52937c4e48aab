//! Errors of formulas. The text of an error shows the formula, with a marker under the wrong part.

use std::fmt;
use std::ops::Range;

use super::Formula;

/// Error in the text of a formula or in its parameters.
///
/// The displayed text begins with the reason. If the error has a place in the formula, the formula follows, with a
/// second line that marks this place:
///
/// ```text
/// unknown name `kk` (did you mean `k`?)
///   A*sin(kk*x)
///         ^^
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct FormulaError {
    /// Reason of the error, without the place in the formula.
    pub message: String,
    /// Byte range of the wrong part in the text. If something is missing at the end of the text, the range is empty and
    /// lies at this end. `None` if the error has no single place.
    pub span: Option<Range<usize>>,
    text: String,
}

/// Kinds of errors in a formula or its parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum FormulaErrorKind {
    /// The text is empty or has only white space.
    #[error("the formula is empty")]
    Empty,
    /// The formula is longer than 10,000 characters.
    #[error("the formula has {0} characters; at most {max} are allowed", max = Formula::MAX_CHARACTERS)]
    TooLong(usize),
    /// The formula is nested deeper than 100 levels.
    #[error("nested more than {} deep", Formula::MAX_NESTING)]
    TooDeep,
    /// A character that is not allowed in formulas.
    #[error("unexpected character `{}`", .0.escape_debug())]
    UnexpectedCharacter(char),
    /// A malformed number, such as `1.2.3` or `1e+`.
    #[error("`{0}` is not a number")]
    BadNumber(String),
    /// A part of the formula that is constant and whose value is infinite or undefined.
    #[error("this part is {0}, not finite")]
    NotFinite(f64),
    /// A name that is neither a variable nor a parameter.
    #[error("unknown name `{name}`{}", did_you_mean(.suggestion))]
    UnknownName {
        /// The unknown name in the formula.
        name: String,
        /// The most similar valid name, if one is similar enough.
        suggestion: Option<String>,
    },
    /// A call of an unknown function.
    #[error("unknown function `{name}`{}", did_you_mean(.suggestion))]
    UnknownFunction {
        /// The unknown name of the function.
        name: String,
        /// The most similar valid name, if one is similar enough.
        suggestion: Option<String>,
    },
    /// The name of a function that is not followed by parentheses.
    #[error("`{0}` is a function: write `{0}(...)`")]
    MissingArguments(String),
    /// A function call with too few or too many arguments.
    #[error("`{function}` takes {expected} argument{}, not {found}", if *.expected == 1 { "" } else { "s" })]
    WrongArity {
        /// Name of the called function.
        function: String,
        /// Number of arguments that the function takes.
        expected: usize,
        /// Number of arguments in the call.
        found: usize,
    },
    /// Two operands without an operator between them, as in `2x`.
    #[error("multiplication needs a sign: write `{left}*{right}`")]
    ImplicitMultiplication {
        /// Last word of the operand on the left side of the missing operator.
        left: String,
        /// First word of the operand on the right side of the missing operator.
        right: String,
    },
    /// `**`, which other languages use for a power. In formulas, a power is written as `^`.
    #[error("write `^` for a power, not `**`")]
    DoubleStar,
    /// A token that is not an operand, where an operand is required.
    #[error("expected a number, a name or `(`, found `{0}`")]
    ExpectedOperand(String),
    /// The formula ends where an operand is required.
    #[error("the formula ends where a number, a name or `(` should follow")]
    UnexpectedEnd,
    /// A `(` without its `)`.
    #[error("this `(` has no matching `)`")]
    Unclosed,
    /// A `)` without its `(`.
    #[error("this `)` has no matching `(`")]
    Unopened,
    /// A comma outside a function's arguments.
    #[error("a comma belongs only between the arguments of a function")]
    StrayComma,
    /// A parameter that is infinite or NaN.
    #[error("parameter `{name}` is {value}; it must be finite")]
    ParameterNotFinite {
        /// Name of the parameter.
        name: String,
        /// Value of the parameter.
        value: f64,
    },
    /// A parameter with the name of a variable, a function or `pi`.
    #[error("`{0}` is reserved in formulas and cannot name a parameter")]
    ReservedParameter(String),
    /// A parameter that the formula does not use.
    #[error("parameter `{0}` does not occur in the formula")]
    UnusedParameter(String),
}

impl FormulaError {
    pub(super) fn new(kind: FormulaErrorKind, text: &str, span: Option<Range<usize>>) -> Self {
        Self {
            message: kind.to_string(),
            span,
            text: text.into(),
        }
    }
}

fn did_you_mean(suggestion: &Option<String>) -> String {
    suggestion
        .as_ref()
        .map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

impl fmt::Display for FormulaError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        /// Largest number of characters of a formula in a message.
        const SHOWN: usize = 72;
        /// Largest number of characters before the marked part, if a message shows only a part of a long formula.
        const BEFORE: usize = 36;

        f.write_str(&self.message)?;
        let Some(span) = &self.span else {
            return Ok(());
        };
        let column = self.text[..span.start].chars().count();
        let width = self.text[span.clone()].chars().count().max(1);
        let total = self.text.chars().count();
        let start = if total > SHOWN {
            column.saturating_sub(BEFORE)
        } else {
            0
        };
        let excerpt: String = (self.text.chars().skip(start).take(SHOWN))
            .map(|c| {
                if c.is_control() || c.is_whitespace() {
                    ' '
                } else {
                    c
                }
            })
            .collect();
        let (cut, more) = (
            if start > 0 { "…" } else { "" },
            if start + SHOWN < total { "…" } else { "" },
        );
        let indent = column - start + cut.chars().count();
        let width = width.min((start + SHOWN - column).max(1));
        write!(
            f,
            "\n  {cut}{}{more}\n  {:indent$}{:^<width$}",
            excerpt.trim_end(),
            "",
            ""
        )
    }
}
