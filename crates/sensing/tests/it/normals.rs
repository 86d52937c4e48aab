//! Tests the distribution and the independence of normally distributed numbers that are drawn in groups.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use palpate_sensing::{Channel, Stream};

const DRAWS: usize = 1 << 24;

fn draws(seed: u64, trial: u64) -> impl Iterator<Item = [f32; Stream::NORMALS]> {
    let mut stream = Stream::new(seed, trial, Channel::Pixel);
    std::iter::repeat_with(move || stream.standard_normals())
}

/// Cumulative distribution function of the standard normal distribution.
fn below(limit: f64) -> f64 {
    0.5 * libm::erfc(-limit * FRAC_1_SQRT_2)
}

/// Tests the distribution of random numbers: a χ² test of their counts in intervals of width 1/16, up to more than six
/// standard deviations. The intervals in the tails contain too few numbers for the test, so each tail is tested as a
/// whole.
#[test]
fn every_interval_and_both_tails_have_their_share() {
    const PER_UNIT: f64 = 16.0;
    const MIDDLE: usize = 128;
    let mut counts = [0_u32; 2 * MIDDLE];
    for draw in draws(13, 0).take(DRAWS / Stream::NORMALS).flatten() {
        let interval = (f64::from(draw) * PER_UNIT).floor() as isize + MIDDLE as isize;
        counts[interval as usize] += 1;
    }
    let edge = |interval: usize| (interval as f64 - MIDDLE as f64) / PER_UNIT;
    let (mut square, mut freedom) = (0.0, -1.0);
    for (interval, &count) in counts.iter().enumerate() {
        let expected = DRAWS as f64 * (below(edge(interval + 1)) - below(edge(interval)));
        if expected >= 20.0 {
            square += (f64::from(count) - expected).powi(2) / expected;
            freedom += 1.0;
        }
    }
    let score = (square - freedom) / (2.0 * freedom).sqrt();
    assert!(
        freedom > 120.0 && score.abs() < 4.0,
        "{square} of {freedom}"
    );
    for units in [3, 4, 5] {
        let beyond = units * PER_UNIT as usize;
        let expected = DRAWS as f64 * below(-(units as f64));
        let (low, high) = (&counts[..MIDDLE - beyond], &counts[MIDDLE + beyond..]);
        for tail in [low, high] {
            let count = f64::from(tail.iter().sum::<u32>());
            // The expected count of numbers beyond five standard deviations is 4.8. The count is 0 with a probability
            // of 1/120, and 16 or more with a probability of 1/10,000.
            assert!(
                (count - expected).abs() < 4.0 * expected.sqrt() + 2.0 && count > 0.0,
                "{units}: {count} of {expected}"
            );
        }
    }
}

#[test]
fn no_draw_depends_on_another() {
    const TRIALS: u64 = 1 << 15;
    type Draws = [f64; Stream::NORMALS];
    let first = |stream: &mut Stream| stream.standard_normals().map(f64::from);
    let draws = |trial| first(&mut Stream::new(3, trial, Channel::Pixel));
    let others: [&dyn Fn(u64) -> Draws; 2] = [&draws, &|trial| {
        let mut stream = Stream::new(3, trial, Channel::Pixel);
        stream.standard_normals();
        first(&mut stream)
    }];
    for (index, other) in others.into_iter().enumerate() {
        let mut sums = [[[0.0; 2]; Stream::NORMALS]; Stream::NORMALS];
        for trial in 0..TRIALS {
            let (own, other) = (draws(trial), other(trial));
            for (sums, own) in sums.iter_mut().zip(own) {
                for (sums, other) in sums.iter_mut().zip(other) {
                    sums[0] += own * other;
                    // Also sum the products of the centred squares (squares minus their mean), because these reveal a
                    // dependence even if the draws are uncorrelated.
                    sums[1] += (own * own - 1.0) * (other * other - 1.0);
                }
            }
        }
        for (i, sums) in sums.iter().enumerate() {
            for (j, [product, square]) in sums.iter().enumerate() {
                let is_itself = index == 0 && i == j;
                // If draws are independent, their products have variance 1, and the products of their centred squares
                // have variance 4. A score is the sum of such products, divided by the standard deviation of the sum.
                // With a probability of 0.999, the largest of 1,000 scores is below 5.
                let scores = [*product, square / 2.0].map(|sum| sum / (TRIALS as f64).sqrt());
                let independent = scores.iter().all(|score| score.abs() < 5.0);
                assert!(independent != is_itself, "{index} {i} {j}: {scores:?}");
            }
        }
    }
}

/// Tests the direction of pairs of numbers. If the two numbers are the coordinates of a vector, the direction of this
/// vector must be uniformly distributed and independent of its length.
#[test]
fn pairs_have_no_direction() {
    const SECTORS: usize = 48;
    let half = Stream::NORMALS / 2;
    let mut counts = [[0_u32; SECTORS]; 2];
    for normals in draws(14, 0).take(DRAWS / Stream::NORMALS) {
        for (x, y) in normals[..half].iter().zip(&normals[half..]) {
            let (x, y) = (f64::from(*x), f64::from(*y));
            let turn = 0.5 * (libm::atan2(y, x) / PI + 1.0);
            let is_far = x * x + y * y > 2.0 * std::f64::consts::LN_2;
            counts[usize::from(is_far)][(turn * SECTORS as f64) as usize % SECTORS] += 1;
        }
    }
    // The test counts the pairs in each sector of the vector's angle, separately for short and long vectors. Half of
    // the vectors are longer than √(2 ln 2).
    let expected = DRAWS as f64 / 2.0 / (2 * SECTORS) as f64;
    let squares = counts
        .iter()
        .flatten()
        .map(|&count| (f64::from(count) - expected).powi(2));
    let square = squares.sum::<f64>() / expected;
    let freedom = (2 * SECTORS - 1) as f64;
    let score = (square - freedom) / (2.0 * freedom).sqrt();
    assert!(score.abs() < 4.0, "{square} of {freedom}");
}

#[test]
fn known_draws_do_not_change() {
    // Published results state their seeds and must stay reproducible. Therefore a change of these expected numbers must
    // be recorded in the changelog.
    let normals = Stream::new(1996, 0, Channel::Pixel).standard_normals();
    assert_eq!(
        normals[..4],
        [-1.899_609_2, 0.039_138_686, -0.737_819_97, -0.914_319_04]
    );
}
