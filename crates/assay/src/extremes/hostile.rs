//! Numbers that nobody means.

/// No number at all.
pub(super) const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// No lengths: not positive, or of no use as divisors and factors.
pub(super) const NO_LENGTHS: [f64; 9] = [
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
pub(super) const EXTREME: [f64; 16] = [
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
