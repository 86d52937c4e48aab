//! Integration tests of the rolling law.
#![allow(clippy::unwrap_used)]

mod endings;
mod extremes;
mod glide;
mod golden;
mod rungs;
mod scenes;
