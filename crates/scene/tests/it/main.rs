//! Integration tests.
#![allow(clippy::unwrap_used)]

mod camera;
mod fingertip;
mod glide;
mod ladder;
mod press;
mod recorded;
mod roll;
