//! Height-field formulas: text such as `A*sin(k*x)*cos(k*y)` becomes a function of x and y with its exact first and
//! second derivatives.
//!
//! # Grammar
//!
//! - numbers `1`, `.5`, `1e-3`; the variables `x` and `y`; the constant `pi`; parameters by name;
//! - the operators `+ - * /` and `^`. The operator `^` has the highest precedence and groups to the right (`2^3^2` is
//!   `2^(3^2)`); the others group to the left. A sign has a lower precedence than `^` (`-x^2` is `-(x^2)`), and may
//!   follow any operator (`2^-1`);
//! - parentheses; the functions `sin cos tan asin acos atan sinh cosh tanh exp ln log10 sqrt cbrt abs` of one argument,
//!   and `atan2(y, x)` and `hypot(a, b)` of two arguments.
//!
//! A multiplication must be written as `2*x`, not as `2x`. Angles are in radians.

mod error;
mod jet;
mod operation;
mod parser;
mod program;

use std::collections::BTreeMap;

pub use error::FormulaError;
#[cfg(test)]
use error::FormulaErrorKind;
pub use jet::Jet;
use program::Program;

/// A function z = f(x, y), parsed from a text. When the text is parsed, the values of its parameters become constants.
///
/// Evaluation never fails and allocates no memory. Outside of the formula's domain, the value is not finite, for
/// example `ln(x)` at x ≤ 0.
///
/// ```
/// use std::collections::BTreeMap;
/// use palpate_geometry::Formula;
///
/// let parameters = BTreeMap::from([("a".to_owned(), 0.5)]);
/// let bowl = Formula::parse("a*(x^2 + y^2)", &parameters)?;
/// assert_eq!(bowl.value(1.0, 2.0), 2.5);
/// assert_eq!(bowl.jet(1.0, 2.0).gradient, [1.0, 2.0]);
/// assert_eq!(bowl.jet(1.0, 2.0).hessian, [1.0, 0.0, 1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    program: Program,
}

impl Formula {
    /// Maximum number of characters of a formula. It also limits the length of the compiled program.
    pub(crate) const MAX_CHARACTERS: usize = 10_000;
    /// Maximum depth of nesting, which limits the size of the parser's stack. Parentheses, function calls, signs and
    /// right-hand operands each add one level.
    pub(crate) const MAX_NESTING: usize = 100;

    /// Parses a formula. `parameters` must contain the value of every name in the formula except `x`, `y`, `pi` and the
    /// functions.
    ///
    /// # Errors
    /// [`FormulaError`] with the place of the error in the text: the text is no formula, a name is unknown, or a
    /// constant part is not finite (`1/0`). It is also an error if a parameter is not finite, has a reserved name, or
    /// is not used by the formula. An unused parameter is probably misspelt.
    pub fn parse(text: &str, parameters: &BTreeMap<String, f64>) -> Result<Self, FormulaError> {
        parser::parse(text, parameters).map(|program| Self { program })
    }

    /// The height f(x, y). It equals `jet(x, y).value` to the last bit.
    pub fn value(&self, x: f64, y: f64) -> f64 {
        self.program.run(x, y)
    }

    /// Coefficients of 1, x, y, x², xy and y², if the formula is written as a polynomial of at most degree two;
    /// otherwise `None`.
    pub(crate) fn quadratic(&self) -> Option<[f64; 6]> {
        self.program.quadratic()
    }

    /// Whether the formula is written as a function of x² + y² alone, so that its graph is a surface of revolution.
    pub(crate) fn is_revolved(&self) -> bool {
        self.program.is_revolved()
    }

    /// Whether the form of the formula shows that it is an even function of x and of y. Its graph is then symmetric
    /// about the planes x = 0 and y = 0.
    pub(crate) fn is_even(&self) -> bool {
        self.program.is_even()
    }

    /// The height with its first and second derivatives. Each operation adds a relative rounding error of 1e-15. A
    /// subtraction of nearly equal numbers amplifies the rounding errors.
    ///
    /// Where the formula or a part of it is not twice differentiable, or where a derivative overflows, some component
    /// is infinite or NaN. Examples are `sqrt(x)` and `abs(x)` at x = 0, and `hypot(x, y)` at the origin. Another
    /// example is `sqrt(x^4)` at x = 0: the formula is smooth there, but its part `sqrt` is not. Call
    /// [`Jet::is_finite`] to detect these places. The only place that it does not detect is the branch cut of `atan2`:
    /// the jet there is finite and is the limit from one side.
    pub fn jet(&self, x: f64, y: f64) -> Jet {
        self.program.run(Jet::x(x), Jet::y(y))
    }
}

#[cfg(test)]
mod tests;
