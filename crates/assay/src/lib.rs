//! Harnesses over the whole of palpate: what each rung costs and how far it errs ([`tradeoff`]), what
//! happens at the extremes of every public entry point ([`extremes`]), and whether `auto` keeps its word
//! ([`promise`]).

pub mod extremes;
pub mod measured;
pub mod promise;
pub mod tradeoff;
