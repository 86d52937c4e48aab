//! Tables of tests at the extremes of public entry points, one row per case: a value within its stated bound, or an
//! error by its name. [`rows!`] makes a test of a table.

mod answer;
mod numbers;
mod precise;
mod row;
mod rows;
mod table;
mod verdict;

pub use answer::{Answer, Truth};
pub use numbers::{EXTREME, NO_LENGTHS, NOT_FINITE, decades, extreme_pairs};
pub use precise::Precise;
pub use row::{Outcome, Refusal, Row};
pub use table::Table;
pub use verdict::Verdict;
