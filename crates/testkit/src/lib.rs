//! What tests and measurements share.

pub mod frames;
