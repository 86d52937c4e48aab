//! Promises of the harnesses, as tests.
#![allow(clippy::unwrap_used)]

#[cfg(feature = "count")]
mod promise;
#[cfg(feature = "count")]
mod required;
