//! Limits of formulas, which keep the parser's stack and the program's short.

/// Largest number of characters of a formula.
pub(super) const MAX_CHARACTERS: usize = 10_000;
/// Largest depth of nesting; parentheses, calls, signs and right-hand sides of operators all count.
pub(super) const MAX_NESTING: usize = 100;
