//! Chooses the tolerance of a model. The model's error must shift the estimates by no more than an allowed amount.

/// Relative differences below this value count as rounding errors.
const ROUNDING: f64 = 1e-12;

/// Results of a cell without noise and with an ideal sensor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pass {
    /// Quantities that are observed.
    pub(crate) quantities: Vec<PassQuantity>,
    /// Observations, in a fixed order.
    pub(crate) values: Vec<PassValue>,
}

/// A quantity that a computation without noise observes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PassQuantity {
    /// Magnitude with which a shift is compared if no rms error was estimated, in the quantity's unit.
    pub(crate) scale: f64,
    /// Index of the same quantity among the quantities of the cell's experiment; `None` if the experiment does not
    /// observe it.
    pub(crate) in_cell: Option<usize>,
}

/// An observation in a computation without noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PassValue {
    /// Index of the quantity in [`Pass::quantities`].
    pub(crate) quantity: usize,
    /// Estimate, in the quantity's unit.
    pub(crate) estimate: f64,
    /// True value, in the quantity's unit.
    pub(crate) truth: f64,
}

/// Largest shift of a cell's estimates that the model's error may cause.
pub(super) struct Allowance {
    /// Allowed shift, relative to the rms error of a quantity; if no rms error was estimated, relative to the
    /// quantity's scale.
    pub(super) share: f64,
    /// Rms error of each quantity of the cell's experiment, if it was estimated. The list may be shorter than the list
    /// of quantities.
    pub(super) rms_errors: Vec<Option<f64>>,
}

/// The largest of the `tolerances` (sorted, largest first) at which the model shifts no estimate by more than allowed.
/// Shifts are relative to the result at the smallest tolerance. Cells that cannot be computed without noise are
/// ignored. Returns `None` if no cell can be computed without noise.
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
    /// Whether all estimates and true values of `pass` differ from `reference` by at most the allowed shift.
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

    /// Results of a test model whose error equals its tolerance. For tolerances below 1e-5, the computation fails.
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
            // In these rows, no rms error is given, so the allowed shift is relative to the scale of the quantity,
            // which is 2.
            (0.1, None, 1e-1),
            (0.01, None, 1e-2),
            (0.01, Some(0.0), 1e-2),
            // In these rows, the allowed shift is relative to the rms error in the second column.
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
