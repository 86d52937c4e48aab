//! Height-field formulas: text such as `A*sin(k*x)*cos(k*y)` becomes a function of x and y with its exact first and
//! second derivatives.
//!
//! # Grammar
//!
//! - numbers `1`, `.5`, `1e-3`; the variables `x` and `y`; the constant `pi`; parameters by name;
//! - `+ - * /` and `^`, from loosest to tightest; `^` groups to the right (`2^3^2` is `2^(3^2)`), the others to the
//!   left; a sign binds looser than `^` (`-x^2` is `-(x^2)`) and may follow any operator (`2^-1`);
//! - parentheses, and the functions `sin cos tan asin acos atan sinh cosh tanh exp ln log10 sqrt cbrt abs` of one
//!   argument, `atan2(y, x)` and `hypot(a, b)` of two.
//!
//! Multiplication needs its sign: `2*x`, not `2x`. Angles are in radians.

mod error;
mod jet;
mod lexer;
mod operation;
mod parser;
mod program;

use std::collections::BTreeMap;

pub use error::{FormulaError, FormulaErrorKind};
pub use jet::Jet;
use program::Program;

/// A function z = f(x, y) that is parsed from a text. Its parameters become constants.
///
/// Evaluation neither fails nor allocates. Outside of the formula's domain the value is not finite (`ln(x)` at x ≤ 0).
///
/// ```
/// use std::collections::BTreeMap;
/// use palpate_geometry::formula::Formula;
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
    /// Largest number of characters of a formula. It limits the length of the compiled program.
    pub(crate) const MAX_CHARACTERS: usize = 10_000;
    /// Largest depth of nesting, which limits the parser's stack. Parentheses, calls, signs and right-hand sides of
    /// operators count.
    pub(crate) const MAX_NESTING: usize = 100;

    /// Parses a formula. `parameters` has the value of every name in it except `x`, `y`, `pi` and the functions.
    ///
    /// # Errors
    /// [`FormulaError`] with the place of the error in the text: if the text is not a formula, has an unknown name, or
    /// has a constant part that is not finite (`1/0`); if a parameter is not finite, is not used (probably misspelt),
    /// or has a name that is reserved.
    pub fn parse(text: &str, parameters: &BTreeMap<String, f64>) -> Result<Self, FormulaError> {
        parser::parse(text, parameters).map(|program| Self { program })
    }

    /// The height f(x, y). It equals `jet(x, y).value` to the last bit.
    pub fn value(&self, x: f64, y: f64) -> f64 {
        self.program.run(x, y)
    }

    /// The height with its first and second derivatives. Each operation adds a rounding error of 1e-15; a difference of
    /// nearly equal numbers amplifies it.
    ///
    /// Where the formula or a part of it is not twice differentiable, some component is infinite or NaN: `sqrt(x)` and
    /// `abs(x)` at x = 0, `hypot(x, y)` at the origin, and also `sqrt(x^4)` at x = 0, which is only smooth as a whole.
    /// The same holds where a derivative overflows. [`Jet::is_finite`] checks this. The only exception is the cut of
    /// `atan2`: there the jet is finite and belongs to one side.
    pub fn jet(&self, x: f64, y: f64) -> Jet {
        self.program.run(Jet::x(x), Jet::y(y))
    }
}

#[cfg(test)]
mod tests;
