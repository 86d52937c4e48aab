//! Integration tests.
#![allow(clippy::unwrap_used)]

mod camera;
mod config;
mod glide;
mod press;
mod recorded;
mod roll;
