//! Uniform numbers from random words.

/// Number in [−1, 1) by the upper 52 bits of a word.
#[inline(always)]
pub(crate) const fn between_minus_1_and_1(word: u64) -> f64 {
    // A float in [2, 4) less its middle.
    f64::from_bits(word >> 12 | 2_f64.to_bits()) - 3.0
}

/// Number in (0, 1) by the upper 52 bits of a word.
#[inline(always)]
pub(crate) const fn between_0_and_1(word: u64) -> f64 {
    // A float in [1, 2) less the one below 1.
    f64::from_bits(word >> 12 | 1_f64.to_bits()) - (1.0 - 0.5 * f64::EPSILON)
}
