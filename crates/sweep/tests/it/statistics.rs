//! Compares statistics with closed-form results and with direct computation, also for numbers near the limits of
//! doubles.

use approx::assert_relative_eq;
use palpate_sweep::{Failure, Observation, Record};

use crate::{BLOCK, Function, normal, observation, observing, run_cell};

#[test]
fn rms_errors_scatter_as_stated() {
    // There are three kinds of trials: one observation without bias; three equal observations with a bias; and one to
    // three different observations with a bias.
    let observe = |kind: u64, trial: u64, record: &mut Record| {
        let (count, bias) = [(1, 0.0), (3, 0.5), (1 + trial % 3, 2.0)][kind as usize];
        let shared = normal(2 * trial);
        for place in 0..count {
            let own = if kind == 2 {
                0.3 * normal(9 * trial + place)
            } else {
                0.0
            };
            record.observe(0, observation(5.0 + bias + shared + own, 5.0, None));
        }
        Ok(())
    };
    for kind in 0..3 {
        let (sets, trials) = (400, 150);
        let found = (0..sets).map(|set| {
            let function =
                |trial: u64, record: &mut Record| observe(kind, set * trials + trial, record);
            let summary = run_cell(
                trials,
                &Function {
                    quantities: 1,
                    function,
                },
            )
            .quantities[0];
            (summary.rms_error.unwrap(), summary.rms_error_std.unwrap())
        });
        let found: Vec<(f64, f64)> = found.collect();
        let sets = sets as f64;
        let mean = found.iter().map(|(rms, _)| rms).sum::<f64>() / sets;
        let square = found
            .iter()
            .map(|(rms, _)| (rms - mean).powi(2))
            .sum::<f64>();
        let stated = found.iter().map(|(_, std)| std * std).sum::<f64>() / sets;
        // `scattered` is the standard deviation of 400 rms errors. Its relative standard error is 3.5 %; the tolerance
        // is four standard errors.
        let scattered = (square / (sets - 1.0)).sqrt();
        assert_relative_eq!(scattered, stated.sqrt(), max_relative = 0.14);
    }
}

#[test]
fn a_normal_sample_has_the_normal_quantiles_and_coverage() {
    let trials = 200_000;
    let (truth, std) = (1000.0, 1e-6);
    let trial = observing(|trial| observation(truth + std * normal(trial), truth, Some(std)));
    let summary = run_cell(trials, &trial).quantities[0];

    // The tolerances are four standard errors of the mean and of the standard deviation.
    let four_sigma = 4.0 / (trials as f64).sqrt();
    assert!(summary.bias.unwrap().abs() < four_sigma * std);
    assert_relative_eq!(summary.std.unwrap(), std, max_relative = four_sigma);
    assert_relative_eq!(summary.rms_error.unwrap(), std, max_relative = four_sigma);
    for (coverage, share) in [
        (summary.coverage50, 0.50),
        (summary.coverage80, 0.80),
        (summary.coverage95, 0.95f64),
    ] {
        let binomial = (share * (1.0 - share)).sqrt();
        assert!(
            (coverage.unwrap() - share).abs() < four_sigma * binomial,
            "{share}"
        );
    }
    // The expected standard error of the rms error is σ/√(2n) for n trials, where σ is the standard deviation of the
    // errors. The estimated standard error is computed from the fourth powers of the errors, whose mean is less
    // accurate. So the tolerance is doubled.
    let of_rms = std / (2.0 * trials as f64).sqrt();
    assert_relative_eq!(
        summary.rms_error_std.unwrap(),
        of_rms,
        max_relative = 2.0 * four_sigma
    );
    assert_relative_eq!(
        summary.mean_reported_std.unwrap(),
        std,
        max_relative = 1e-12
    );

    let mut errors: Vec<f64> = (0..trials)
        .map(|i| (truth + std * normal(i)) - truth)
        .collect();
    errors.sort_by(f64::total_cmp);
    for (quantile, p) in [(summary.q05, 0.05), (summary.q95, 0.95)] {
        let exact = errors[(p * (trials - 1) as f64).round() as usize];
        assert_relative_eq!(quantile.unwrap() - truth, exact, max_relative = 0.01);
    }
}

#[test]
fn one_trial_is_its_own_mean_and_quantiles() {
    let summary = run_cell(1, &observing(|_| observation(0.3, 0.25, Some(0.0)))).quantities[0];
    assert_eq!(summary.mean, Some(0.3));
    assert_eq!(summary.std, None);
    assert_eq!([summary.q05, summary.q50, summary.q95], [Some(0.3); 3]);
    assert_eq!(summary.coverage95, Some(0.0));
}

#[test]
fn a_truth_of_zero_has_no_relative_errors() {
    for zero in [0.0, -0.0] {
        let trial = observing(|trial| {
            observation(normal(trial), if trial % 2 == 0 { 0.0 } else { zero }, None)
        });
        let summary = run_cell(3000, &trial).quantities[0];
        assert_eq!(summary.truth, Some(0.0));
        assert!(summary.rms_error.unwrap() > 0.9);
        assert_eq!(summary.relative_rms_error, None);
        assert_eq!(summary.relative_mean_abs_error, None);
    }
}

#[test]
fn a_varying_truth_leaves_the_errors_and_the_estimates() {
    // The true value varies between blocks (first case) or between trials (second case). The errors are ±0.5.
    for run_length in [BLOCK, 1] {
        let truth = |trial: u64| (trial / run_length % 2) as f64 * 4.0;
        let trial = observing(|trial| {
            let error = if trial / run_length / 2 % 2 == 0 {
                0.5
            } else {
                -0.5
            };
            observation(truth(trial) + error, truth(trial), None)
        });
        let trials = 4 * BLOCK;
        let summary = run_cell(trials, &trial).quantities[0];
        let n = trials as f64;
        assert_eq!(summary.truth, None);
        assert_eq!(summary.mean, Some(2.0));
        assert_relative_eq!(
            summary.std.unwrap(),
            (4.25 * n / (n - 1.0)).sqrt(),
            max_relative = 1e-14
        );
        assert_eq!(summary.bias, Some(0.0));
        assert_eq!(summary.rms_error, Some(0.5));
        assert_eq!(summary.mean_abs_error, Some(0.5));
        assert_eq!(summary.relative_rms_error, None);
        assert_eq!([summary.q05, summary.q50, summary.q95], [None; 3]);
    }
}

#[test]
fn many_observations_in_a_trial_all_count() {
    let grid = Function {
        quantities: 1,
        function: |_: u64, record: &mut Record| {
            for point in 1..=900 {
                record.observe(
                    0,
                    observation(f64::from(point), 0.0, (point > 450).then_some(1000.0)),
                );
            }
            Ok(())
        },
    };
    let summary = run_cell(1500, &grid).quantities[0];
    assert_eq!(summary.observations, 900 * 1500);
    assert_relative_eq!(summary.mean.unwrap(), 450.5, max_relative = 1e-13);
    assert_relative_eq!(summary.q95.unwrap(), 855.0, max_relative = 0.01);
    assert_eq!(summary.coverage95, Some(1.0));
    assert_eq!(summary.mean_reported_std, Some(1000.0));
}

#[test]
fn a_trial_may_report_the_coverage_of_its_interval() {
    // All errors are 1. If the reported standard deviation is 1, the 80 and 95 % intervals contain the true value. If
    // it is 0.1, no interval contains it. A trial without a standard deviation has no interval.
    let coverages = |stds: [Option<f64>; 4], holds: [Option<[bool; 3]>; 4]| {
        let trial = observing(move |trial| {
            let kind = (trial % 4) as usize;
            Observation {
                interval_holds: holds[kind],
                ..observation(3.0, 2.0, stds[kind])
            }
        });
        let summary = run_cell(3 * BLOCK, &trial).quantities[0];
        [summary.coverage50, summary.coverage80, summary.coverage95]
    };
    let third = |thirds: f64| Some(thirds / 3.0);
    let (none, all) = (Some([false; 3]), Some([true; 3]));
    let stds = [Some(1.0), Some(1.0), Some(0.1), None];
    // The half-width of the 50 % interval is less than one standard deviation, so no 50 % interval contains the true
    // value.
    assert_eq!(coverages(stds, [None; 4]), [0.0, 2.0, 2.0].map(third));
    // The second and the third trial report whether their intervals contain the true value. The reported coverage
    // differs from the coverage that follows from the standard deviations, and must replace it.
    assert_eq!(
        coverages(stds, [None, none, all, None]),
        [1.0, 2.0, 2.0].map(third)
    );
    assert_eq!(
        coverages(stds, [None, none, None, None]),
        [0.0, 1.0, 1.0].map(third)
    );
    // A trial may report whether its intervals contain the true value even if it reports no standard deviation.
    let wide = Some([false, true, true]);
    assert_eq!(
        coverages(stds, [None, None, None, wide]),
        [0.0, 0.75, 0.75].map(Some)
    );
    assert_eq!(
        coverages([None; 4], [all, None, None, none]),
        [Some(0.5); 3]
    );
    assert_eq!(coverages([None; 4], [None; 4]), [None; 3]);
}

#[test]
fn failures_are_counted_by_kind_and_leave_nothing() {
    let trial = Function {
        quantities: 2,
        function: |trial: u64, record: &mut Record| {
            record.observe(0, observation(1.0, 1.0, None));
            match trial {
                700.. if trial.is_multiple_of(2) => Err("rank"),
                1500.. if trial.is_multiple_of(3) => Err("lost-contact"),
                _ => {
                    let estimate = if trial == 1027 { f64::NAN } else { 2.0 };
                    record.observe(1, observation(estimate, 2.0, None));
                    Ok(())
                }
            }
        },
    };
    let cell = run_cell(3000, &trial);
    let failure = |kind, count, first_trial| Failure {
        kind,
        count,
        first_trial,
    };
    assert_eq!(
        cell.failures,
        [
            failure("lost-contact", 250, 1503),
            failure("not-finite", 1, 1027),
            failure("rank", 1150, 700),
        ]
    );
    assert_eq!(cell.failed(), 1401);
    assert_eq!(cell.quantities[0].observations, 3000 - 1401);
    assert_eq!(cell.quantities[1].observations, 3000 - 1401);
    assert_eq!(cell.quantities[0].rms_error, Some(0.0));
}
