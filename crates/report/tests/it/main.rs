//! Studies made by hand, through the public interface.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod claims;
mod fixture;
mod loading;
mod page;
mod plots;
