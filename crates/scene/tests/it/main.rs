//! Integration tests.
#![allow(clippy::unwrap_used)]

mod config;
mod glide;
mod recorded;
mod roll;
