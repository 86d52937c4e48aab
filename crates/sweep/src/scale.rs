//! Sums over many numbers, kept in units of a power of two so that nothing overflows or vanishes.

/// Independent partial sums, which let the compiler use vector instructions.
pub(crate) const LANES: usize = 8;
/// Units are at most 2^±1000: far enough that no square overflows or vanishes, and still a float themselves.
const MAX_EXPONENT: i32 = 1000;
/// Numbers from 2^−400 to 2^400 need no unit: their squares are floats, and so are sums of 2^60 of them.
const ORDINARY: i32 = 400;
/// Numbers from 2^−200 to 2^200 need none for the squares of their squares either.
const ORDINARY_SQUARE: i32 = ORDINARY / 2;

/// Sum of a term over all values, in a fixed order.
#[inline]
pub(crate) fn sum(values: &[f64], term: impl Fn(f64) -> f64) -> f64 {
    let mut lanes = [0.0; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        for (lane, &x) in lanes.iter_mut().zip(chunk) {
            *lane += term(x);
        }
    }
    for (lane, &x) in lanes.iter_mut().zip(rest) {
        *lane += term(x);
    }
    lanes.into_iter().sum()
}

/// Exponent of the unit 2^exponent for numbers as large as this: 0 unless it is beyond 2^±400.
pub(crate) fn exponent(largest: f64) -> i32 {
    exponent_beyond(largest, ORDINARY)
}

/// Exponent of the unit 2^exponent for numbers as large as this whose squares are squared: 0 unless it is beyond 2^±200.
pub(crate) fn exponent_of_squares(largest: f64) -> i32 {
    exponent_beyond(largest, ORDINARY_SQUARE)
}

fn exponent_beyond(largest: f64, ordinary: i32) -> i32 {
    let biased = (largest.abs().to_bits() >> 52) as i32;
    match biased - 1023 {
        exponent if exponent.abs() <= ordinary => 0,
        exponent => exponent.clamp(-MAX_EXPONENT, MAX_EXPONENT),
    }
}

/// 2^exponent for exponents up to 1023; 0 where it would be subnormal.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023).max(0) as u64) << 52)
}
