//! Tests the public functions of the crate with small invented studies.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod claims;
mod committed_results;
mod contacts;
mod fixture;
mod glides;
mod loading;
mod maps;
mod page;
mod patch_claims;
mod plots;
mod press_claims;
mod press_traces;
mod presses;
mod profiles;
mod sensor_claims;
mod tradeoffs;
