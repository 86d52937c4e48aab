//! Harnesses over the whole of palpate: what each rung costs and how far it errs ([`tradeoff`]), what happens at the
//! extremes of every public entry point (`extremes`), and whether `auto` keeps its word ([`promise`]). What must not
//! get worse: instructions of the [`hot`] paths and [`accuracy`]. What palpate takes beside its peers: [`ours`]. Truth
//! of their own making: [`pressed`] for presses, [`touched`] for round tips.

pub mod accuracy;
#[cfg(feature = "extremes")]
pub mod extremes;
pub mod hot;
pub mod measured;
pub mod ours;
pub mod pressed;
pub mod promise;
pub mod touched;
pub mod tradeoff;
