//! Streams of random numbers. Each stream depends only on seed, trial and channel.

use std::convert::Infallible;

use rand::rand_core::{TryRng, utils};
use rand_distr::{Distribution, StandardNormal};

use crate::Channel;
use crate::normal_deviates::{PAIRS, normals};

/// The random numbers of one channel in one trial. These numbers depend only on seed, trial and channel.
///
/// The generator is SplitMix64 (Steele, Lea and Flood, 2014). Its start, `key`, is a hash of seed, trial and channel.
/// Word k is `mix(key + k STEP)`, so words can be computed in parallel. All streams are parts of one cycle of 2^64
/// words. Streams of one seed and channel start at different words. The probability that any two of n streams with w
/// words each overlap is about `n² w / 2^64`: 1e-4 for ten million trials of 16 words.
///
/// ```
/// use palpate_sensing::{Channel, Stream};
///
/// let draw = |trial| Stream::new(1996, trial, Channel::Position).symmetric_uniform();
/// // A trial can be repeated alone, and differs from the next trial.
/// assert_eq!(draw(7), draw(7));
/// assert_ne!(draw(7), draw(8));
/// assert!((-1.0..1.0).contains(&draw(7)));
/// ```
#[derive(Clone, Debug)]
pub struct Stream {
    state: u64,
}

/// The odd number nearest to 2^64 divided by the golden ratio.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// A bijection of 64-bit words in which every input bit affects all output bits (the finaliser of SplitMix64).
#[inline(always)]
const fn mix(mut word: u64) -> u64 {
    word = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    word ^ (word >> 31)
}

impl Stream {
    /// The stream of `channel` in trial number `trial` of a study with `seed`.
    #[inline(always)]
    pub fn new(seed: u64, trial: u64, channel: Channel) -> Self {
        let study = mix(seed.wrapping_add((channel as u64).wrapping_mul(STEP)));
        Self {
            state: mix(study ^ trial.wrapping_mul(STEP)),
        }
    }

    #[inline(always)]
    fn next_word(&mut self) -> u64 {
        palpate_statistics::work::drew(1);
        self.state = self.state.wrapping_add(STEP);
        mix(self.state)
    }

    /// A uniform number in [−1, 1), in steps of 2^−51.
    #[inline(always)]
    pub fn symmetric_uniform(&mut self) -> f64 {
        // The random bits form a double-precision number in [2, 4). Subtracting the middle of this range gives a number
        // in [−1, 1).
        f64::from_bits(self.next_word() >> 12 | 2_f64.to_bits()) - 3.0
    }

    /// Chooses `count` different numbers out of `0..of`, each with equal probability. If `count` exceeds `of`, the
    /// function returns all numbers in random order. The function needs memory for `of` numbers and draws one random
    /// number per chosen number.
    pub fn choose(&mut self, count: usize, of: usize) -> Vec<usize> {
        let mut items: Vec<usize> = (0..of).collect();
        let count = count.min(of);
        for place in 0..count {
            let share = 0.5 * (self.symmetric_uniform() + 1.0);
            let left = of - place;
            // The result is limited to `left - 1`, because `share` times `left` may be rounded up to `left`, although
            // `share` is below 1.
            let offset = ((share * left as f64) as usize).min(left - 1);
            items.swap(place, place + offset);
        }
        items.truncate(count);
        items
    }

    /// A normally distributed number with mean 0 and standard deviation 1.
    #[inline]
    pub fn standard_normal(&mut self) -> f64 {
        StandardNormal.sample(self)
    }

    /// Independent normal numbers in single precision, with mean 0, standard deviation 1 and absolute values up to
    /// 6.67. The numbers are computed with vector instructions, several times as fast as with
    /// [`Self::standard_normal`]. Each random word gives two numbers.
    #[inline(always)]
    pub fn standard_normals(&mut self) -> [f32; Self::NORMALS] {
        palpate_statistics::work::drew(PAIRS as u64);
        let key = self.state;
        self.state = key.wrapping_add(STEP.wrapping_mul(PAIRS as u64));
        normals(std::array::from_fn(|pair| {
            mix(key.wrapping_add(STEP.wrapping_mul(pair as u64 + 1)))
        }))
    }

    /// Number of normal numbers that [`Self::standard_normals`] returns.
    pub const NORMALS: usize = 2 * PAIRS;
}

impl TryRng for Stream {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok((self.next_word() >> 32) as u32)
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.next_word())
    }

    #[inline]
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        utils::fill_bytes_via_next_word(bytes, || Ok(self.next_word()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_published_generator() {
        let mut stream = Stream { state: 0 };
        let words = [(); 3].map(|()| stream.next_word());
        assert_eq!(
            words,
            [
                0xE220_A839_7B1D_CDAF,
                0x6E78_9E6A_A1B9_65F4,
                0x06C4_5D18_8009_454F
            ]
        );
    }

    #[test]
    fn every_bit_is_fair() {
        const TRIALS: u64 = 1 << 16;
        let mut ones = [0_i64; 64];
        for trial in 0..TRIALS {
            let word = Stream::new(0, trial, Channel::AngularVelocity).next_word();
            for (bit, ones) in ones.iter_mut().enumerate() {
                *ones += (word >> bit & 1) as i64;
            }
        }
        let deviation = 0.5 * (TRIALS as f64).sqrt();
        for (bit, ones) in ones.into_iter().enumerate() {
            let score = (ones - TRIALS as i64 / 2) as f64 / deviation;
            assert!(score.abs() < 5.0, "{bit}: {score}");
        }
    }
}
