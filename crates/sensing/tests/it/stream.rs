//! Tests streams of random numbers: the numbers are reproducible, uniformly or normally distributed, and not
//! correlated.

use palpate_sensing::{Channel, Stream};

#[test]
fn known_numbers_do_not_change() {
    // Published results state their seeds and must stay reproducible. Therefore a change of these expected numbers must
    // be recorded in the changelog.
    let stream = || Stream::new(1996, 0, Channel::AngularVelocity);
    let (mut uniform, mut normal) = (stream(), stream());
    let numbers = [(); 2].map(|()| uniform.symmetric_uniform());
    assert_eq!(numbers, [0.48625805955037826, -0.2486210525325494]);
    let numbers = [(); 2].map(|()| normal.standard_normal());
    assert_eq!(numbers, [0.5889332607386293, -0.2993812247343297]);
}

#[test]
fn normal_numbers_fill_their_distribution() {
    const DRAWS: u32 = 1_000_000;
    let mut stream = Stream::new(5, 0, Channel::Pixel);
    let mut draws: Vec<f64> = (0..DRAWS).map(|_| stream.standard_normal()).collect();
    draws.sort_by(f64::total_cmp);
    let distance = draws.iter().zip(0..).map(|(draw, rank)| {
        let expected = 0.5 * libm::erfc(-draw * std::f64::consts::FRAC_1_SQRT_2);
        (expected - f64::from(rank) / f64::from(DRAWS)).abs()
    });
    // This is a Kolmogorov–Smirnov test. If n draws have the expected distribution, the largest distance between their
    // empirical distribution function and the expected function exceeds 1.95/√n with a probability of 0.001.
    assert!(distance.fold(0.0, f64::max) < 1.95e-3);
}

fn draws(seed: u64, trial: u64, channel: Channel) -> [f64; 16] {
    let mut stream = Stream::new(seed, trial, channel);
    std::array::from_fn(|_| stream.symmetric_uniform())
}

#[test]
fn draws_of_a_trial_its_neighbours_and_its_channels_are_not_correlated() {
    const TRIALS: u64 = 1 << 14;
    let channel = Channel::AngularVelocity;
    let others: [fn(u64) -> [f64; 16]; 6] = [
        |trial| draws(3, trial, Channel::AngularVelocity),
        |trial| draws(3, trial + 1, Channel::AngularVelocity),
        |trial| draws(3, trial + 2, Channel::AngularVelocity),
        |trial| draws(3, trial ^ (1 << 40), Channel::AngularVelocity),
        |trial| draws(3, trial, Channel::PadOffset),
        |trial| draws(4, trial, Channel::AngularVelocity),
    ];
    for (index, other) in others.into_iter().enumerate() {
        let (mut products, mut squares) = ([[0.0; 16]; 16], [[0.0; 16]; 16]);
        for trial in 0..TRIALS {
            let (own, other) = (draws(3, trial, channel), other(trial));
            for (i, own) in own.iter().enumerate() {
                for (j, other) in other.iter().enumerate() {
                    products[i][j] += own * other;
                    // Also sum the products of the centred squares (squares minus their mean), because these reveal a
                    // dependence even if the draws themselves are uncorrelated.
                    squares[i][j] += (own * own - 1.0 / 3.0) * (other * other - 1.0 / 3.0);
                }
            }
        }
        // For independent draws, the products of draws have the variance (1/3)², and the products of their centred
        // squares have the variance (4/45)². `spread` is the standard deviation of a sum of products, divided by the
        // standard deviation of one product.
        let spread = (TRIALS as f64).sqrt();
        for (i, (products, squares)) in products.iter().zip(&squares).enumerate() {
            for (j, (product, square)) in products.iter().zip(squares).enumerate() {
                let is_itself = index == 0 && i == j;
                let scores = [product * 3.0 / spread, square * (45.0 / 4.0) / spread];
                // For independent draws, the largest of the 3000 scores is below 5 with probability 0.998.
                let independent = scores.iter().all(|score: &f64| score.abs() < 5.0);
                assert!(independent != is_itself, "{index} {i} {j}: {scores:?}");
            }
        }
    }
}

#[test]
fn every_choice_is_as_likely_as_any() {
    let mut counts = [0_u32; 7];
    for trial in 0..70_000 {
        let chosen = Stream::new(9, trial, Channel::WrongMarkers).choose(3, 7);
        assert!(chosen.len() == 3 && chosen.iter().all(|one| *one < 7));
        assert!(chosen[0] != chosen[1] && chosen[1] != chosen[2] && chosen[2] != chosen[0]);
        chosen.iter().for_each(|&one| counts[one] += 1);
    }
    // Each of the seven numbers is expected 30,000 times in 70,000 choices of three. The standard deviation of this
    // count is sqrt(70,000 · 3/7 · 4/7) = 131.
    assert!(
        counts.iter().all(|count| count.abs_diff(30_000) < 600),
        "{counts:?}"
    );
    let mut stream = Stream::new(9, 0, Channel::WrongMarkers);
    let mut all = stream.choose(10, 4);
    all.sort_unstable();
    assert_eq!(all, [0, 1, 2, 3]);
    assert!(stream.choose(2, 0).is_empty() && stream.choose(0, 2).is_empty());
}
