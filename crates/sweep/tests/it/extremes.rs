//! Tests statistics of trials with extreme values.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use palpate_sweep::{Observation, Record, Summary};

use crate::{Function, observation, observing, run_cell};

fn summary(trials: u64, of: impl Fn(u64) -> Observation + Sync) -> Summary {
    run_cell(trials, &observing(of)).quantities[0]
}

/// Compares statistics with closed-form results, in units from 1e-320 to 1e300. The errors are 1, 2, … n units, and the
/// true value is −4 units. In these units, the mean of the errors is (n + 1)/2, their mean square is (n + 1)(2n + 1)/6,
/// and their sample variance (with the divisor n − 1) is n(n + 1)/12.
#[test]
fn sequences_in_any_unit_have_their_closed_forms() {
    for unit in [1e-320, 1e-300, 1e-150, 1.0, 1e300] {
        // Subnormal numbers are integer multiples of the smallest positive double, so the tolerance is at least two
        // such steps.
        let bound = f64::max(1e-13, 2.0 * f64::from_bits(1) / unit);
        let close = |found: Option<f64>, due: f64| {
            let found = found.unwrap() / unit;
            assert_relative_eq!(found, due, epsilon = bound, max_relative = bound);
        };
        for trials in [2, 1023, 1024, 1025, 5000] {
            let truth = -4.0 * unit;
            let found = summary(trials, |trial| {
                observation((trial as f64 - 3.0) * unit, truth, Some(unit))
            });
            let n = trials as f64;
            let mean = 0.5 * (n + 1.0);
            let rms = ((n + 1.0) * (2.0 * n + 1.0) / 6.0).sqrt();
            assert_eq!(found.truth, Some(truth));
            close(found.mean, mean - 4.0);
            close(found.bias, mean);
            close(found.mean_abs_error, mean);
            close(found.rms_error, rms);
            close(found.std, (n * (n + 1.0) / 12.0).sqrt());
            close(found.mean_reported_std, 1.0);
            let relative = [found.relative_rms_error, found.relative_mean_abs_error];
            for (relative, due) in relative.into_iter().zip([rms, mean]) {
                assert_relative_eq!(relative.unwrap(), due / 4.0, max_relative = bound);
            }
        }
        // A share p of the n errors is 1, and all other errors are 0. Then the mean square error is p, and the variance
        // of the mean square error is p (1 − p)/(n − 1).
        let quarter = summary(4096, |trial| {
            observation(if trial % 4 == 3 { unit } else { 0.0 }, 0.0, None)
        });
        close(
            quarter.rms_error_std,
            (0.25 * 0.75_f64 / 4095.0).sqrt() / (2.0 * 0.5),
        );
        let found = summary(2001, |trial| {
            observation((trial as f64 - 1000.0) * unit, 0.0, None)
        });
        // Quantiles treat numbers below 2.3e-308 as 0, so the expected quantile is then 0.
        let side = if unit < 1e-310 { 0.0 } else { 900.0 };
        for (found, due) in [(found.q05, -side), (found.q50, 0.0), (found.q95, side)] {
            assert_abs_diff_eq!(found.unwrap() / unit, due, epsilon = 3.6);
        }
    }
}

#[test]
fn estimates_that_alternate_have_their_mean_and_spread() {
    let alternating = |one: f64, other: f64| {
        summary(4000, |trial| {
            observation(if trial % 2 == 0 { one } else { other }, 0.0, None)
        })
    };
    for (one, other) in [(1e308, 5e-324), (8e307, -8e307), (1e300, 1.0)] {
        let mean = 0.5 * one + 0.5 * other;
        let found = alternating(one, other).bias.unwrap();
        assert_abs_diff_eq!(found / one, mean / one, epsilon = 1e-13);
    }
    for offset in [1e3, 1e15, 1e100_f64] {
        let step = offset.next_up() - offset;
        let due = 0.5 * step * (4000.0_f64 / 3999.0).sqrt();
        let found = alternating(offset, offset.next_up()).std.unwrap();
        assert_relative_eq!(found, due, max_relative = 1e-12);
    }
    let alike = summary(5000, |_| observation(3.0, 3.0, Some(0.0)));
    assert_eq!((alike.std, alike.coverage95), (Some(0.0), Some(1.0)));
}

#[test]
fn invalid_observations_fail_their_trial() {
    for ([estimate, truth, std], quantity, kind) in [
        ([f64::NAN, 0.0, 0.0], 0, "not-finite"),
        ([0.0, f64::INFINITY, 0.0], 0, "not-finite"),
        ([f64::MAX, -f64::MAX, 0.0], 0, "not-finite"),
        ([0.0, 0.0, f64::NAN], 0, "not-finite"),
        ([0.0, 0.0, -5e-324], 0, "negative-std"),
        ([1.0, 1.0, 0.0], 1, "unknown-quantity"),
    ] {
        let trial = Function {
            quantities: 1,
            function: |trial: u64, record: &mut Record| {
                record.observe(0, observation(2.0, 1.0, None));
                if trial % 2 == 1 {
                    record.observe(quantity, observation(estimate, truth, Some(std)));
                }
                Ok(())
            },
        };
        let found = run_cell(3000, &trial);
        let [failure] = &found.failures[..] else {
            panic!("{found:?}");
        };
        assert_eq!((failure.kind, failure.count), (kind, 1500));
        let summary = found.quantities[0];
        assert_eq!((summary.observations, summary.bias), (1500, Some(1.0)));
    }
}

#[test]
fn no_statistic_is_defined_without_trials() {
    let none = summary(0, |_| observation(1.0, 1.0, None));
    assert_eq!(none, Summary::default());
}
