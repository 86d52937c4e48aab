//! The Pareto front of a ladder's rungs, and the recommended rung for a target error.

/// Cost and error of a rung (a model or setting). Smaller values are better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CostError {
    /// Number of processor instructions, or time in nanoseconds if instructions were not counted.
    pub(super) cost: f64,
    pub(super) error: f64,
}

/// Two costs count as equal if their ratio is at most this number.
const EQUAL_COST_RATIO: f64 = 1.02;
/// Errors below this value are caused by rounding, so they count as equal.
const ROUNDING: f64 = 1e-14;

/// Whether each rung (model or setting) is on the Pareto front, that is, whether no other rung dominates it. One rung
/// dominates another if neither its cost nor its error is larger, and at least one of them is smaller. Of several rungs
/// with equal cost and error, only the first can be on the front.
pub(super) fn pareto(rungs: &[CostError]) -> Vec<bool> {
    let beats = |a: usize, b: usize| {
        let ([a_cost, b_cost], [a_error, b_error]) = (
            [a, b].map(|one| rungs[one].cost),
            [a, b].map(|one| rungs[one].error.max(ROUNDING)),
        );
        let (no_dearer, cheaper) = (
            a_cost <= EQUAL_COST_RATIO * b_cost,
            EQUAL_COST_RATIO * a_cost < b_cost,
        );
        let better = cheaper || a_error < b_error;
        let equal = b_cost <= EQUAL_COST_RATIO * a_cost && a_error == b_error;
        no_dearer && a_error <= b_error && (better || equal && a < b)
    };
    (0..rungs.len())
        .map(|one| !(0..rungs.len()).any(|other| beats(other, one)))
        .collect()
}

/// Index of the cheapest rung on the Pareto front whose error is at most `target`.
pub(super) fn answer(rungs: &[CostError], target: f64) -> Option<usize> {
    let on_front = pareto(rungs);
    let adequate = |rung: &usize| on_front[*rung] && rungs[*rung].error <= target;
    (0..rungs.len())
        .filter(adequate)
        .min_by(|&a, &b| rungs[a].cost.total_cmp(&rungs[b].cost))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rungs(worths: &[(f64, f64)]) -> Vec<CostError> {
        worths
            .iter()
            .map(|&(cost, error)| CostError { cost, error })
            .collect()
    }

    #[test]
    fn rungs_that_are_worse_in_both_are_not_on_the_front() {
        let rungs = rungs(&[(1.0, 0.1), (2.0, 0.2), (3.0, 0.01), (3.0, 0.02), (1.0, 0.1)]);
        assert_eq!(pareto(&rungs), [true, false, true, false, false]);
        assert!(pareto(&[]).is_empty());
    }

    #[test]
    fn a_difference_of_one_percent_in_cost_does_not_count() {
        let rungs = rungs(&[(100.0, 0.2), (101.0, 0.1), (102.0, 0.1)]);
        assert_eq!(pareto(&rungs), [false, true, false]);
        assert_eq!(answer(&rungs, 0.5), Some(1));
    }

    #[test]
    fn rounding_errors_are_equal() {
        let rungs = rungs(&[(5.0, 9e-16), (20.0, 2e-16), (20.0, 2e-16)]);
        assert_eq!(pareto(&rungs), [true, false, false]);
    }

    #[test]
    fn the_answer_is_the_cheapest_adequate_rung_or_none() {
        let rungs = rungs(&[(5.0, 1e-9), (1.0, 0.1), (3.0, 0.009)]);
        let targets = [0.1, 0.01, 0.001, 1e-12];
        assert_eq!(
            targets.map(|target| answer(&rungs, target)),
            [Some(1), Some(2), Some(0), None]
        );
    }
}
