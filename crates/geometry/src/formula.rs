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
//! Multiplication is always written: `2*x`, never `2x`. Angles are in radians.

mod error;
mod jet;
mod lexer;
mod limits;
mod operation;
mod parser;
mod program;

use std::collections::BTreeMap;

pub use error::{FormulaError, FormulaErrorKind};
pub use jet::Jet;
use program::Program;

/// A function z = f(x, y) read from text, its parameters folded in as constants.
///
/// Evaluation neither fails nor allocates. Outside the formula's domain the value is not finite (`ln(x)` at x ≤ 0).
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
    /// The longest formula accepted, in characters.
    pub const MAX_CHARACTERS: usize = limits::MAX_CHARACTERS;
    /// The deepest nesting accepted; parentheses, calls, signs and right-hand sides of operators all count.
    pub const MAX_NESTING: usize = limits::MAX_NESTING;

    /// Reads a formula. `parameters` gives the value of every name in it besides `x`, `y`, `pi` and the functions.
    ///
    /// # Errors
    /// [`FormulaError`], which shows the offending place, if the text is no formula, names something unknown, or has a
    /// constant part that is not finite (`1/0`); if a parameter is not finite, is unused (a likely misspelling), or
    /// takes a name the grammar already uses.
    pub fn parse(text: &str, parameters: &BTreeMap<String, f64>) -> Result<Self, FormulaError> {
        parser::parse(text, parameters).map(|program| Self { program })
    }

    /// The height f(x, y); equal to the last bit to `jet(x, y).value`.
    pub fn value(&self, x: f64, y: f64) -> f64 {
        self.program.run(x, y)
    }

    /// The height with its first and second derivatives, exact up to rounding: within 1e-15 per operation, and what
    /// the differences in the formula make of that.
    ///
    /// Where the formula or a part of it is not twice differentiable, some component is infinite or NaN: `sqrt(x)` and
    /// `abs(x)` at x = 0, `hypot(x, y)` at the origin, and also `sqrt(x^4)` at x = 0, which is smooth only as a whole.
    /// The same holds where a derivative is beyond the range of numbers. [`Jet::is_finite`] tells. The one exception is
    /// the cut of `atan2`: there the jet is finite and that of one side.
    pub fn jet(&self, x: f64, y: f64) -> Jet {
        self.program.run(Jet::x(x), Jet::y(y))
    }
}

#[cfg(test)]
mod tests;
