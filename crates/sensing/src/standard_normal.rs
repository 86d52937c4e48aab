//! Draws of a standard normal that are equal on every host.

mod edges;

use rand::Rng;
use rand_distr::Distribution;

use crate::uniform::{between_0_and_1, between_minus_1_and_1};
use edges::EDGES;

/// Normal distribution of mean 0 and standard deviation 1, by a ziggurat of 256 layers (Doornik, *An Improved Ziggurat
/// Method to Generate Normal Random Samples*, 2005).
///
/// It takes the words that [`rand_distr::StandardNormal`] takes and means the same numbers, but its functions round
/// alike on every host. 98.8 % of the draws take one word.
#[derive(Clone, Copy, Debug)]
pub struct StandardNormal;

impl Distribution<f64> for StandardNormal {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        loop {
            let word = rng.next_u64();
            // The place is made of the upper 52 bits.
            let layer = (word & 0xFF) as usize;
            let share = between_minus_1_and_1(word);
            let x = share * EDGES[layer];
            if x.abs() < EDGES[layer + 1] {
                return x;
            }
            if layer == 0 {
                return tail(rng).copysign(share);
            }
            if is_under_curve(x, layer, rng) {
                return x;
            }
        }
    }
}

/// Whether a point at a random height of a layer's rim lies under exp(−x²/2).
#[cold]
fn is_under_curve<R: Rng + ?Sized>(x: f64, layer: usize, rng: &mut R) -> bool {
    let height = |x: f64| libm::exp(-x * x / 2.0);
    let (low, high) = (height(EDGES[layer]), height(EDGES[layer + 1]));
    let share = (rng.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON);
    high + (low - high) * share < height(x)
}

/// A number beyond the lowest layer's edge (Marsaglia, *Generating a variable from the tail of the normal
/// distribution*, 1964).
#[cold]
fn tail<R: Rng + ?Sized>(rng: &mut R) -> f64 {
    let edge = EDGES[1];
    loop {
        let beyond = -libm::log(between_0_and_1(rng.next_u64())) / edge;
        let depth = -libm::log(between_0_and_1(rng.next_u64()));
        if 2.0 * depth >= beyond * beyond {
            return edge + beyond;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Stream};

    #[test]
    fn layers_are_of_one_area() {
        let height = |x: f64| libm::exp(-x * x / 2.0);
        let edge = EDGES[1];
        let tail = libm::erfc(edge * std::f64::consts::FRAC_1_SQRT_2)
            * (std::f64::consts::PI / 2.0).sqrt();
        let area = edge * height(edge) + tail;
        assert!((EDGES[0] * height(edge) / area - 1.0).abs() < 1e-14);
        for pair in EDGES[1..].windows(2) {
            let layer = pair[0] * (height(pair[1]) - height(pair[0]));
            // Heights of neighbours agree in all but their last digits.
            assert!((layer / area - 1.0).abs() < 1e-12, "{pair:?}: {layer}");
        }
        assert_eq!(EDGES[256], 0.0);
    }

    #[test]
    fn draws_are_those_of_rand_distr() {
        let mut ours = Stream::new(3, 0, Channel::Pixel);
        let mut theirs = ours.clone();
        let (mut tails, mut largest) = (0, 0.0_f64);
        for _ in 0..1_000_000 {
            let own: f64 = StandardNormal.sample(&mut ours);
            let other: f64 = rand_distr::StandardNormal.sample(&mut theirs);
            tails += u32::from(own.abs() > EDGES[1]);
            largest = largest.max((own - other).abs() / own.abs().max(1e-3));
        }
        // 258 expected.
        assert!((190..330).contains(&tails), "{tails} in the tail");
        // Their table has ten digits.
        assert!(largest < 1e-9, "{largest}");
        assert_eq!(ours.symmetric_uniform(), theirs.symmetric_uniform());
    }

    #[test]
    fn draws_fill_the_normal_distribution() {
        const DRAWS: u32 = 1_000_000;
        let mut stream = Stream::new(5, 0, Channel::Pixel);
        let mut draws: Vec<f64> = (0..DRAWS)
            .map(|_| StandardNormal.sample(&mut stream))
            .collect();
        draws.sort_by(f64::total_cmp);
        let distance = draws.iter().enumerate().map(|(rank, draw)| {
            let expected = 0.5 * libm::erfc(-draw * std::f64::consts::FRAC_1_SQRT_2);
            (expected - f64::from(rank as u32) / f64::from(DRAWS)).abs()
        });
        // Kolmogorov and Smirnov: 1.95/√n is exceeded once in a thousand times.
        assert!(distance.fold(0.0, f64::max) < 1.95e-3);
    }

    #[test]
    fn known_draws_do_not_change() {
        let mut stream = Stream::new(1996, 0, Channel::AngularVelocity);
        let draws: [f64; 4] = std::array::from_fn(|_| StandardNormal.sample(&mut stream));
        assert_eq!(
            draws,
            [
                0.5889332607404711,
                -0.2993812247352798,
                0.09163653031787823,
                0.026403411368867535
            ]
        );
    }
}
