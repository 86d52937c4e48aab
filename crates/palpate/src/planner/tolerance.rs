//! Chooses the tolerance of a model: the largest tolerance at which the model's error shifts the estimates by no more
//! than an allowed amount.

/// An rms error counts as 0 if it is below this share of the quantity's typical magnitude, because such an error is
/// caused by rounding.
const ROUNDING: f64 = 1e-12;

/// Estimates and true values of a cell of the study, computed without noise and with an ideal sensor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pass {
    pub(crate) quantities: Vec<PassQuantity>,
    /// Estimates with their true values, in a fixed order.
    pub(crate) values: Vec<PassValue>,
}

/// A quantity that is estimated by a computation without noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PassQuantity {
    /// Typical magnitude of the quantity, in the quantity's unit. Shifts are divided by this magnitude if no rms error
    /// was estimated.
    pub(crate) scale: f64,
    /// Index of this quantity in the cell's experiment; `None` if the experiment does not estimate it.
    pub(crate) in_cell: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PassValue {
    /// Index of the quantity in [`Pass::quantities`].
    pub(crate) quantity: usize,
    pub(crate) estimate: f64,
    pub(crate) truth: f64,
}

/// Largest allowed shift of a cell's estimates by the error of the contact model.
pub(crate) struct Allowance {
    /// Largest allowed shift, relative to the rms error of a quantity. If no rms error was estimated, it is relative
    /// to [`PassQuantity::scale`].
    pub(crate) share: f64,
    /// Rms error of each quantity of the cell's experiment; `None` if it was not estimated. The list may be shorter
    /// than the list of quantities.
    pub(crate) rms_errors: Vec<Option<f64>>,
}

/// The largest of the `tolerances` at which the model shifts no estimate by more than the allowed shift. `tolerances`
/// must be sorted, largest first. Shifts are differences from the estimates at the smallest tolerance. Cells that
/// cannot be computed without noise are ignored. Returns `None` if all cells are ignored.
pub(crate) fn tolerance_for(
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
