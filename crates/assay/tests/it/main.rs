//! Tests of the choices of `auto`, and of the computational work that scenes cause.
#![allow(clippy::unwrap_used)]

mod auto_check;
#[cfg(feature = "count")]
mod required_work;
