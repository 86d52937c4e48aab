//! Sums over many numbers, scaled by a power of two if their squares would overflow or vanish.

/// Independent partial sums, which let the compiler use vector instructions.
pub(crate) const LANES: usize = 8;
/// Units are at most 2^±1000: far enough that no square overflows or vanishes, and still a float themselves.
const MAX_EXPONENT: i32 = 1000;
/// Numbers from 2^−200 to 2^200 need no unit: their fourth powers, and sums of 2^60 of these, are normal floats.
const ORDINARY: i32 = 200;

/// Sum of a term over all values, in a fixed order.
pub(crate) fn sum(values: &[f64], term: impl Fn(f64) -> f64) -> f64 {
    let mut lanes = [0.0; LANES];
    for chunk in values.chunks(LANES) {
        for (lane, &x) in lanes.iter_mut().zip(chunk) {
            *lane += term(x);
        }
    }
    lanes.into_iter().sum()
}

/// Largest magnitude of some numbers; 0 without numbers.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Exponent of the unit 2^exponent for numbers up to `largest`: 0 if `largest` is from 2^−200 to 2^200.
pub(crate) fn exponent(largest: f64) -> i32 {
    let biased = (largest.abs().to_bits() >> 52) as i32;
    match biased - 1023 {
        exponent if exponent.abs() <= ORDINARY => 0,
        exponent => exponent.clamp(-MAX_EXPONENT, MAX_EXPONENT),
    }
}

/// Whether a sum of squares is so far from overflow and underflow that it needs no scaling.
pub(crate) fn is_ordinary(squares: f64) -> bool {
    (1e-200..1e200).contains(&squares)
}

/// 2^exponent for exponents up to 1023; 0 where it would be subnormal.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023).max(0) as u64) << 52)
}
