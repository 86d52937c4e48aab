//! Numbers that nobody means.

/// Numbers that are none.
pub const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Numbers that are no lengths: not positive, or of no use as divisors and factors.
pub const NO_LENGTHS: [f64; 9] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    -1.0,
    f64::from_bits(1),
    1e-310,
    f64::MAX,
];

/// Numbers that may be asked for all the same, from the least to the greatest.
pub const EXTREME: [f64; 16] = [
    f64::NAN,
    f64::NEG_INFINITY,
    f64::MIN,
    -1e155,
    -1e16,
    -1.0,
    -1e-310,
    -0.0,
    0.0,
    f64::from_bits(1),
    1e-150,
    1e-9,
    0.7,
    1e9,
    f64::MAX,
    f64::INFINITY,
];

/// Pairs of [`EXTREME`] numbers, all 256.
pub fn extreme_pairs() -> impl Iterator<Item = (f64, f64)> {
    let pairs = |first| EXTREME.map(|second| (first, second));
    EXTREME.into_iter().flat_map(pairs)
}

/// The double nearest to a power of ten, which `powi` misses by what the compiler makes of it.
fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}

/// Powers of ten from `10^first` to `10^last`, every `step`-th.
pub fn decades(first: i32, last: i32, step: usize) -> impl Iterator<Item = f64> {
    (first..=last).step_by(step).map(power_of_ten)
}
