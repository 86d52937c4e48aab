//! Promises of the harnesses, as tests.
#![allow(clippy::unwrap_used)]

mod promise;
#[cfg(feature = "count")]
mod required;
