//! Checks of `auto` and of the work of scenes.
#![allow(clippy::unwrap_used)]

mod auto_check;
#[cfg(feature = "count")]
mod required_work;
