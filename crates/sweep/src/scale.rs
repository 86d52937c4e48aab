//! Sums over many numbers, kept in units of a power of two so that nothing overflows or vanishes.

/// Independent partial sums, which let the compiler use vector instructions.
const LANES: usize = 8;
/// Units are 2^±1000: far enough that no square overflows or vanishes, and still a float themselves.
const MAX_EXPONENT: i32 = 1000;

/// Smallest and largest of the values and `first`.
pub(crate) fn range(values: &[f64], first: f64) -> (f64, f64) {
    let (mut min, mut max) = ([first; LANES], [first; LANES]);
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        for (lane, &x) in chunk.iter().enumerate() {
            // Comparisons, not `f64::min`, which would also care for NaN.
            min[lane] = if x < min[lane] { x } else { min[lane] };
            max[lane] = if x > max[lane] { x } else { max[lane] };
        }
    }
    let all = |lanes: [f64; LANES]| lanes.into_iter().chain(rest.iter().copied());
    (
        all(min).fold(first, f64::min),
        all(max).fold(first, f64::max),
    )
}

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

/// Binary exponent of a number, within ±[`MAX_EXPONENT`].
pub(crate) fn exponent(number: f64) -> i32 {
    let biased = (number.abs().to_bits() >> 52) as i32;
    (biased - 1023).clamp(-MAX_EXPONENT, MAX_EXPONENT)
}

/// 2^exponent for exponents up to 1023; 0 where it would be subnormal.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023).max(0) as u64) << 52)
}
