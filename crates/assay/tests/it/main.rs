//! Promises of the harnesses, as tests.
#![allow(clippy::unwrap_used)]

#[cfg(feature = "count")]
mod answers;
mod promise;
#[cfg(feature = "count")]
mod required;
