//! Normal random numbers in groups, by the transform of Box and Muller (*A Note on the Generation of Random Normal
//! Deviates*, 1958).
//!
//! A pair of normal numbers is r cos θ and r sin θ, where −r²/2 is the logarithm of a uniformly distributed number and
//! θ a uniformly distributed angle. Logarithm, sine and cosine are computed with additions, multiplications, divisions
//! and roots only, so the results are the same for any vector width. The library `rand_distr` draws one number at a
//! time. It takes nearly twice as long, and even longer on processors with wide vectors.

use std::f32::consts::{FRAC_PI_2, LN_2, SQRT_2};

/// Number of pairs of normal numbers that are computed together.
pub(crate) const PAIRS: usize = 8;

/// Coefficients of the powers of θ² in cos θ. The first omitted term is below 1e-8 at θ = 90°.
const COSINE: [f32; 7] = alternating(0);

/// Coefficients of the powers of θ² in sin θ / θ. The first omitted term is below 4e-8 at θ = 90°.
const SINC: [f32; 6] = alternating(1);

/// Coefficients of the powers of x² in artanh x / x. The first omitted term is below 3e-9 at the largest value of x,
/// (√2 − 1) / (√2 + 1).
const ARTANH: [f32; 5] = [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0];

/// Coefficients (−1)^k / (2k + odd)! of the power series of cos θ (`odd` is 0) or of sin θ / θ (`odd` is 1).
const fn alternating<const TERMS: usize>(odd: usize) -> [f32; TERMS] {
    let mut coefficients = [1.0; TERMS];
    let (mut term, mut divisor) = (1, 1);
    while term < TERMS {
        let last = 2 * term + odd;
        divisor *= last * (last - 1);
        let sign = if term % 2 == 0 { 1.0 } else { -1.0 };
        coefficients[term] = (sign / divisor as f64) as f32;
        term += 1;
    }
    coefficients
}

#[inline(always)]
fn series<const TERMS: usize>(coefficients: [f32; TERMS], number: f32) -> f32 {
    let mut sum = coefficients[TERMS - 1];
    for coefficient in coefficients[..TERMS - 1].iter().rev() {
        sum = sum * number + coefficient;
    }
    sum
}

/// Radius r = √(−2 ln u) of a pair of normal numbers. The uniform number is u = (k + ½) / 2³¹, where `k` is a random
/// integer below 2³¹.
#[inline(always)]
fn radius(k: u32) -> f32 {
    // Convert k to a floating-point number as a signed integer, because processors have one instruction for this.
    let bits = (k as i32 as f32 + 0.5).to_bits() as i32;
    // Decompose the number: k + ½ = 2^power (1 + x) / (1 − x). The fraction (1 + x) / (1 − x) is between √½ and √2.
    let power = (bits - (0.5 * SQRT_2).to_bits() as i32) >> 23;
    let fraction = f32::from_bits((bits - (power << 23)) as u32);
    let x = (fraction - 1.0) / (fraction + 1.0);
    ((31 - power) as f32 * (2.0 * LN_2) - 4.0 * x * series(ARTANH, x * x)).sqrt()
}

/// Independent normal numbers from random words: first the numbers r cos θ of all pairs, then the numbers r sin θ. Each
/// word gives one pair.
#[inline(always)]
pub(crate) fn normals(words: [u64; PAIRS]) -> [f32; 2 * PAIRS] {
    // Store the two halves of each word in separate arrays, so that compilers can use vector instructions.
    let (mut lengths, mut angles) = ([0; PAIRS], [0; PAIRS]);
    for (pair, word) in words.into_iter().enumerate() {
        lengths[pair] = (word >> 32) as u32;
        angles[pair] = word as u32;
    }
    let mut normals = [0.0; 2 * PAIRS];
    let (cosines, sines) = normals.split_at_mut(PAIRS);
    for pair in 0..PAIRS {
        // The angle is between −90° and 90°. The radius has a random sign, so that the pairs also cover the other half
        // of the circle.
        let angle = angles[pair] as i32 as f32 * (FRAC_PI_2 / 2_147_483_648.0);
        let square = angle * angle;
        let length = radius(lengths[pair] >> 1).to_bits();
        let radius = f32::from_bits(length ^ lengths[pair] << 31);
        cosines[pair] = radius * series(COSINE, square);
        sines[pair] = radius * (angle * series(SINC, square));
    }
    normals
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// The two normally distributed numbers from one random word, computed in double precision.
    fn exact(word: u64) -> [f64; 2] {
        let uniform = ((word >> 33) as f64 + 0.5) / 2_f64.powi(31);
        let radius = (-2.0 * libm::log(uniform)).sqrt();
        let turned = if word >> 32 & 1 == 1 { PI } else { 0.0 };
        let (sine, cosine) =
            libm::sincos(turned + f64::from(word as u32 as i32) * PI / 2_f64.powi(32));
        [radius * cosine, radius * sine]
    }

    /// Largest error of the normal numbers from `words`, relative to the error that single precision allows. The
    /// allowed error is larger for a pair with a small radius, because its uniform number u is near 1, where single
    /// precision has a resolution of only 24 bits.
    fn largest_error(words: [u64; PAIRS]) -> f64 {
        let normals = normals(words);
        let errors = words.iter().enumerate().flat_map(|(pair, &word)| {
            let exact = exact(word);
            let allowed = (2e-6 + 6e-8 / libm::hypot(exact[0], exact[1])).min(2.5e-4);
            let made = [normals[pair], normals[PAIRS + pair]];
            std::iter::zip(made, exact)
                .map(move |(made, exact)| (f64::from(made) - exact).abs() / allowed)
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn pairs_are_those_of_box_and_muller() {
        let mut word = 1_u64;
        let mut next = || {
            word = word.wrapping_mul(0xD134_2543_DE82_EF95).wrapping_add(1);
            word ^ word >> 29
        };
        for _ in 0..100_000 {
            let words: [u64; PAIRS] = std::array::from_fn(|_| next());
            assert!(largest_error(words) < 1.0, "{words:x?}");
            // A pair of normal numbers has a large radius if the uniform number u is small. Shift the words, so that
            // small numbers u are more frequent.
            let far = |pair: usize| words[pair] >> (pair * 4) | words[pair] & 0xFFFF_FFFF;
            let far = std::array::from_fn(far);
            assert!(largest_error(far) < 1.0, "{far:x?}");
        }
    }

    #[test]
    fn the_longest_and_the_shortest_are_numbers() {
        for angle in [0, 1, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF_u64] {
            for length in [0, 1, 2, 0x7FFF_FFFF, 0xFFFF_FFFE, 0xFFFF_FFFF_u64] {
                let word = length << 32 | angle;
                let normals = normals([word; PAIRS]);
                assert!(normals.iter().all(|normal| normal.abs() < 6.67), "{word:x}");
                assert!(largest_error([word; PAIRS]) < 1.0, "{word:x}");
            }
        }
        // For k = 0, the uniform number u is 2⁻³², so the radius √(−2 ln u) is √(64 ln 2) = 6.660_43.
        assert!((radius(0) - 6.660_43).abs() < 1e-5);
        assert_eq!(radius(u32::MAX >> 1), 0.0);
    }
}
