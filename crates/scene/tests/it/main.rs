//! Integration tests.
#![allow(clippy::unwrap_used)]

mod config;
mod recorded;
mod roll;
