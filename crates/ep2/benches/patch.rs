//! Benchmarks of the estimators of a patch.
fn main() {}
