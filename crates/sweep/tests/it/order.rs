//! Tests the probabilities that two estimates are in the right order: their values against closed-form results, and the
//! coverage of their intervals.

use palpate_statistics::normal_tail;
use palpate_sweep::{Order, Repeats, TrialMeans, in_order, repeats};

use crate::{normal, observation, observing, runner, uniform};

/// Results of trials whose estimates are normally distributed with this mean and with the standard deviation 1.
fn normals(seed: u64, count: u64, mean: f64) -> Vec<TrialMeans> {
    (0..count)
        .map(|trial| Ok((mean + normal((seed << 32) + trial), mean)))
        .collect()
}

/// Share of 400 samples in which the 95 % interval of the probability of the right order contains the true probability.
fn coverage(probability: f64, found: impl Fn(u64) -> Order) -> f64 {
    let held = (0..400).filter(|seed| {
        let Order { low, high, .. } = found(*seed);
        (low..=high).contains(&probability)
    });
    held.count() as f64 / 400.0
}

#[test]
fn intervals_hold_the_probability_in_95_of_100() {
    // For normal numbers with variance 1 whose means differ by d, the probability of the right order is Φ(d/√2), with
    // the normal distribution function Φ.
    for (distance, trials) in [
        (0.0, 100),
        (0.5, 100),
        (1.5, 100),
        (1.5, 1000),
        (3.0, 300),
        (5.0, 300),
    ] {
        let probability = normal_tail(-distance / 2.0_f64.sqrt());
        let covered = coverage(probability, |seed| {
            in_order(
                &normals(2 * seed, trials, 0.0),
                &normals(2 * seed + 1, trials, distance),
                None,
            )
        });
        assert!(covered > 0.925, "{distance} {trials}: {covered}");
    }
}

#[test]
fn unequal_samples_and_failures() {
    // Each trial succeeds with a probability of 0.9.
    let some = |seed: u64, count: u64, mean: f64| -> Vec<TrialMeans> {
        let all = normals(seed, count, mean).into_iter().enumerate();
        all.map(
            |(trial, means)| match uniform((seed << 33) + trial as u64) < 0.9 {
                true => means,
                false => Err("slipped"),
            },
        )
        .collect()
    };
    let probability = 0.81 * normal_tail(-1.0 / 2.0_f64.sqrt());
    let covered = coverage(probability, |seed| {
        in_order(
            &some(3 * seed, 1000, 0.0),
            &some(3 * seed + 1, 100, 1.0),
            None,
        )
    });
    assert!(covered > 0.925, "{covered}");
}

#[test]
fn both_must_be_above_the_limit() {
    let probability = normal_tail(-1.0) * normal_tail(-0.5);
    let covered = coverage(probability, |seed| {
        in_order(
            &normals(2 * seed, 200, 1.0),
            &normals(2 * seed + 1, 300, 0.5),
            Some(0.0),
        )
    });
    assert!(covered > 0.925, "{covered}");
}

/// Number of trials to average, for two experiments whose estimates are normally distributed with these means.
fn repeats_of(seed: u64, count: u64, means: [f64; 2], limit: Option<f64>) -> Repeats {
    let [one, other] = [0, 1].map(|place| normals(seed + place, count, means[place as usize]));
    repeats(&one, &other, limit, 0.95)
}

#[test]
fn repeats_are_those_of_normal_means() {
    // If the means of both experiments differ by d, the condition for n trials is Φ(√(n/2) d) ≥ 0.95, with the normal
    // distribution function Φ. This is equivalent to n ≥ 2 (1.645/d)².
    for (distance, expected) in [(4.0, 1), (1.0, 6), (0.5, 22)] {
        let Repeats::Found(found) = repeats_of(1, 40_000, [0.0, distance], None) else {
            panic!("{distance}")
        };
        let off = found.abs_diff(expected) as f64;
        assert!(off <= 1.0 + 0.1 * expected as f64, "{distance}: {found}");
    }
    let Repeats::About(found) = repeats_of(3, 40_000, [0.0, 0.1], None) else {
        panic!("too many for groups")
    };
    assert!(found.abs_diff(541) < 200, "{found}");
    assert_eq!(repeats_of(5, 1000, [1.0, 0.0], None), Repeats::Never);
    assert_eq!(repeats_of(7, 100, [0.0; 2], None), Repeats::Unknown);
    // The mean of n trials of an experiment is above the limit with the probability Φ(√n d). Here d is the distance of
    // the true mean from the limit, and Φ is the normal distribution function. For both experiments, the required
    // condition is Φ(√n d)² ≥ 0.95.
    let found = repeats_of(9, 40_000, [0.5; 2], Some(0.0));
    assert!(matches!(found, Repeats::Found(14..=17)), "{found:?}");
}

#[test]
fn exact_failed_and_missing_trials_are_sound() {
    let exact = |value: f64| vec![Ok((value, value))];
    let order = |low: &[TrialMeans], high: &[TrialMeans]| {
        let Order {
            probability,
            low,
            high,
        } = in_order(low, high, None);
        (probability, low, high)
    };
    assert_eq!(order(&exact(1.0), &exact(2.0)), (1.0, 1.0, 1.0));
    assert_eq!(order(&exact(2.0), &exact(2.0)), (0.5, 0.5, 0.5));
    assert_eq!(order(&[Err("slipped"); 50], &exact(2.0)).0, 0.0);
    assert_eq!(order(&[], &[]), (0.0, 0.0, 1.0));
    let (probability, low, high) = order(&normals(1, 100, -50.0), &exact(2.0));
    assert!(probability == 1.0 && low > 0.95 && high == 1.0, "{low}");
    for (one, other) in [
        (exact(2.0), exact(2.0)),
        (vec![Err("slipped"); 50], exact(2.0)),
        (vec![], vec![]),
    ] {
        assert_eq!(repeats(&one, &other, None, 0.95), Repeats::Never);
    }
    for extreme in [f64::MAX, f64::MIN, 5e-324] {
        let wide: Vec<TrialMeans> = (0..600)
            .map(|trial| Ok((if trial % 2 == 0 { extreme } else { -extreme }, 0.0)))
            .collect();
        let (probability, low, high) = order(&wide, &normals(1, 600, 0.0));
        assert!(low <= probability && probability <= high, "{extreme:e}");
        let _ = repeats(&wide, &normals(1, 600, 0.0), None, 0.95);
    }
}

#[test]
fn means_of_trials() {
    let trial = observing(|trial| observation(trial as f64, 1.0, None));
    let means = runner(2).trial_means(&trial, 0, 5..8);
    assert_eq!(means, [Ok((5.0, 1.0)), Ok((6.0, 1.0)), Ok((7.0, 1.0))]);
    let none = Err("not-finite");
    assert_eq!(runner(1).trial_means(&trial, 7, 0..1), [none]);
    let failing = observing(|_| observation(f64::NAN, 1.0, None));
    assert_eq!(runner(1).trial_means(&failing, 0, 0..2), [none; 2]);
}
