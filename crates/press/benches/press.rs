//! Presses.
fn main() {}
