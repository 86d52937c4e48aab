//! Integration tests of studies.
#![allow(clippy::unwrap_used)]

mod config;
