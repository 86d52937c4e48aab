//! Harnesses over the whole of palpate. They measure the cost and the error of each rung ([`tradeoff`]), and check that
//! `auto` takes an adequate and cheap rung ([`promise`]), that answers keep their word ([`answers`]), and that stated
//! intervals hold ([`intervals`]). The instructions of the [`hot`] paths and the errors in [`accuracy`] must not grow.
//! [`ours`] times palpate on the tasks of its peers. The truths come from independent computations: [`pressed`] for presses,
//! [`touched`] for fingertips with a radius, [`rolled`] for rolls.

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
