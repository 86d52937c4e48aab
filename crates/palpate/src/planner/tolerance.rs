//! Choice of a model's tolerance from the shift of the estimates that it causes.

/// Differences below this share of a value are rounding errors.
const ROUNDING: f64 = 1e-12;

/// Results of a noiseless pass of a cell with an ideal sensor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pass {
    /// Quantities that the pass observes.
    pub(crate) quantities: Vec<PassQuantity>,
    /// Observations, in a fixed order.
    pub(crate) values: Vec<PassValue>,
}

/// Quantity of a noiseless pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PassQuantity {
    /// Magnitude with which a shift is compared if the rms error was not estimated, in the quantity's unit.
    pub(crate) scale: f64,
    /// Index of the same quantity in the cell's experiment, if the experiment observes it.
    pub(crate) in_cell: Option<usize>,
}

/// Observation of a noiseless pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PassValue {
    /// Index of the quantity in [`Pass::quantities`].
    pub(crate) quantity: usize,
    /// Estimate, in the quantity's unit.
    pub(crate) estimate: f64,
    /// True value, in the quantity's unit.
    pub(crate) truth: f64,
}

/// Largest shift of a cell's estimates that the model may cause.
pub(super) struct Allowance {
    /// Allowed shift as a share of a quantity's rms error, or of its scale if there is no rms error.
    pub(super) share: f64,
    /// Rms error of each quantity of the cell's experiment, if estimated. The list may be shorter than the list of
    /// quantities.
    pub(super) rms_errors: Vec<Option<f64>>,
}

/// Largest of the `tolerances` (sorted, largest first) at which the model shifts no estimate by more than its
/// allowance. Shifts are relative to the pass at the smallest tolerance. Cells without a pass do not count; `None` if
/// no cell has one.
pub(super) fn tolerance_for(
    allowances: &[Allowance],
    tolerances: &[f64],
    pass: impl Fn(usize, f64) -> Option<Pass>,
) -> Option<f64> {
    let reference = |cell: usize| {
        let mut finest = tolerances.iter().rev();
        finest.find_map(|&tolerance| Some((cell, tolerance, pass(cell, tolerance)?)))
    };
    let references: Vec<(usize, f64, Pass)> = (0..allowances.len()).filter_map(reference).collect();
    let smallest = references.iter().map(|(_, tolerance, _)| *tolerance);
    let smallest = smallest.reduce(f64::max)?;
    let is_met = |tolerance: f64| {
        references.iter().all(|(cell, _, reference)| {
            let pass = pass(*cell, tolerance);
            pass.is_some_and(|pass| allowances[*cell].is_met(&pass, reference))
        })
    };
    let mut larger = tolerances.iter().copied().filter(|&one| one > smallest);
    Some(larger.find(|&one| is_met(one)).unwrap_or(smallest))
}

impl Allowance {
    /// Whether no estimate and no truth of a pass differs from the reference by more than is allowed.
    fn is_met(&self, pass: &Pass, reference: &Pass) -> bool {
        let allowed = |quantity: usize| {
            let PassQuantity { scale, in_cell } = reference.quantities[quantity];
            let rms = in_cell.and_then(|place| self.rms_errors.get(place).copied().flatten());
            self.share * rms.filter(|&rms| rms > ROUNDING * scale).unwrap_or(scale)
        };
        let pairs = || pass.values.iter().zip(&reference.values);
        pass.values.len() == reference.values.len()
            && pairs().all(|(one, other)| {
                let of_estimate = (one.estimate - other.estimate).abs();
                let shift = of_estimate.max((one.truth - other.truth).abs());
                shift <= allowed(one.quantity)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pass of a model whose error is its tolerance; there is no pass below 1e-5.
    fn pass(_: usize, tolerance: f64) -> Option<Pass> {
        let estimate = 2.0 + tolerance;
        let scale = 2.0;
        let in_cell = Some(0);
        (tolerance >= 1e-5).then(|| Pass {
            quantities: vec![PassQuantity { scale, in_cell }],
            values: vec![PassValue {
                quantity: 0,
                estimate,
                truth: 2.0,
            }],
        })
    }

    #[test]
    fn the_largest_tolerance_with_an_allowed_shift_is_chosen() {
        let tolerances = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
        for (share, rms_error, expected) in [
            // Relative to the scale of 2.
            (0.1, None, 1e-1),
            (0.01, None, 1e-2),
            (0.01, Some(0.0), 1e-2),
            // Relative to the rms error.
            (0.01, Some(0.2), 1e-3),
            (1e-9, Some(0.2), 1e-5),
        ] {
            let rms_errors = vec![rms_error];
            let allowances = [Allowance { share, rms_errors }];
            let found = tolerance_for(&allowances, &tolerances, pass);
            assert_eq!(found, Some(expected), "{share}, {rms_error:?}");
        }
    }

    #[test]
    fn cells_without_a_pass_are_left_out() {
        let allowance = || Allowance {
            share: 0.01,
            rms_errors: Vec::new(),
        };
        let first = |cell: usize, tolerance| pass(cell, tolerance).filter(|_| cell == 0);
        let found = tolerance_for(&[allowance(), allowance()], &[1e-1, 1e-3], first);
        assert_eq!(found, Some(1e-3));
        assert_eq!(tolerance_for(&[allowance()], &[1e-1], |_, _| None), None);
        assert_eq!(tolerance_for(&[allowance()], &[], pass), None);
    }
}
