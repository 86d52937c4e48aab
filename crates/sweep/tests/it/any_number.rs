//! Property tests with estimates of any magnitude: the statistics are finite, and the order of the blocks changes them
//! only by rounding errors.

use palpate_sweep::Observation;
use proptest::prelude::*;

use crate::{BLOCK, observing, run_cell};

/// A random double of any magnitude. Half of the numbers are between −2 and 2.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<u64>().prop_map(f64::from_bits), -2.0..2.0]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_observations(numbers_of in prop::collection::vec(
        (any_number(), any_number(), prop::option::of(any_number()), prop::option::of(any::<[bool; 3]>())), 1..40)
    ) {
        let trial = observing(|trial| {
            let (estimate, truth, std, interval_holds) = numbers_of[trial as usize % numbers_of.len()];
            Observation { estimate, truth, std, interval_holds }
        });
        let found = run_cell(2 * BLOCK + 7, &trial);
        let summary = &found.quantities[0];
        let printed = format!("{summary:?}");
        prop_assert!(!printed.contains("NaN") && !printed.contains("inf"), "{printed}");
        prop_assert_eq!(summary.observations + found.failed(), 2 * BLOCK + 7);
        for coverage in [summary.coverage50, summary.coverage80, summary.coverage95].into_iter().flatten() {
            prop_assert!((0.0..=1.0).contains(&coverage));
        }
        if let (Some(low), Some(middle), Some(high)) = (summary.q05, summary.q50, summary.q95) {
            prop_assert!(low <= middle && middle <= high);
        }
        if let (Some(rms), Some(mean)) = (summary.rms_error, summary.mean_abs_error) {
            prop_assert!(mean <= rms * (1.0 + 1e-12) + 1e-300);
        }
    }

    /// Runs the same blocks of trials in another order. Quantiles must be equal, and all other statistics must be equal
    /// except for rounding errors.
    #[test]
    fn blocks_in_any_order(errors in prop::collection::vec(-1e3..1e3_f64, 1..30), shift in 0..3_u64, power in -900..900) {
        let unit = 2f64.powi(power);
        let of = |shift: u64| run_cell(3 * BLOCK, &observing(|trial| {
            let error = errors[((trial + shift * BLOCK) % (3 * BLOCK)) as usize % errors.len()] * unit;
            Observation { estimate: error, truth: 0.0, std: None, interval_holds: None }
        })).quantities[0];
        let (one, other) = (of(0), of(shift));
        prop_assert_eq!((one.q05, one.q50, one.q95), (other.q05, other.q50, other.q95));
        let size = one.rms_error.unwrap();
        for (one, other) in [(one.bias, other.bias), (one.std, other.std), (one.rms_error, other.rms_error)] {
            prop_assert!((one.unwrap() - other.unwrap()).abs() <= 1e-12 * size);
        }
    }
}
