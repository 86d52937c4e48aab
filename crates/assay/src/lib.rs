//! Harnesses over the whole of palpate. They measure the cost and the error of each rung ([`tradeoff`]), and check that
//! `auto` chooses a cheap rung that is accurate enough ([`promise`]), that the answers of `design` and `distinguish` hold
//! ([`answers`]), and that stated intervals contain the true value ([`intervals`]). The instructions of the [`hot`]
//! paths and the errors in [`accuracy`] must not grow. [`ours`] times palpate on the tasks of its peers. The true
//! values come from independent computations: [`pressed`] for presses, [`touched`] for fingertips with a radius,
//! [`rolled`] for rolls.

pub mod accuracy;
pub mod answers;
mod columns;
pub mod hot;
pub mod intervals;
pub mod measured;
pub mod ours;
pub mod pressed;
pub mod promise;
pub mod rolled;
pub mod touched;
pub mod tradeoff;
