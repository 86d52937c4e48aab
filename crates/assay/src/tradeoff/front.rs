//! Which rungs are worth taking, and which answers a target.

/// Cost and error of a rung; smaller is better in both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Worth {
    /// Instructions, or nanoseconds where none are counted.
    pub(super) cost: f64,
    /// Relative error.
    pub(super) error: f64,
}

/// Ratio of two costs up to which they count as equal.
const EQUAL: f64 = 1.02;
/// Error below which rounding decides; smaller errors count as equal.
const ROUNDING: f64 = 1e-14;

/// Whether each rung lies on the Pareto front: no other rung is at most as dear and errs at most as much while being
/// better in one of the two. Of rungs that are equal in both, the first counts as on the front.
pub(super) fn pareto(rungs: &[Worth]) -> Vec<bool> {
    let beats = |a: usize, b: usize| {
        let ([a_cost, b_cost], [a_error, b_error]) = (
            [a, b].map(|one| rungs[one].cost),
            [a, b].map(|one| rungs[one].error.max(ROUNDING)),
        );
        let (no_dearer, cheaper) = (a_cost <= EQUAL * b_cost, EQUAL * a_cost < b_cost);
        let better = cheaper || a_error < b_error;
        let equal = b_cost <= EQUAL * a_cost && a_error == b_error;
        no_dearer && a_error <= b_error && (better || equal && a < b)
    };
    (0..rungs.len())
        .map(|one| !(0..rungs.len()).any(|other| beats(other, one)))
        .collect()
}

/// The cheapest rung on the front that errs by `target` at most.
pub(super) fn answer(rungs: &[Worth], target: f64) -> Option<usize> {
    let on_front = pareto(rungs);
    let adequate = |rung: &usize| on_front[*rung] && rungs[*rung].error <= target;
    (0..rungs.len())
        .filter(adequate)
        .min_by(|&a, &b| rungs[a].cost.total_cmp(&rungs[b].cost))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rungs(worths: &[(f64, f64)]) -> Vec<Worth> {
        worths
            .iter()
            .map(|&(cost, error)| Worth { cost, error })
            .collect()
    }

    #[test]
    fn the_front_leaves_out_what_another_beats() {
        let rungs = rungs(&[(1.0, 0.1), (2.0, 0.2), (3.0, 0.01), (3.0, 0.02), (1.0, 0.1)]);
        assert_eq!(pareto(&rungs), [true, false, true, false, false]);
        assert!(pareto(&[]).is_empty());
    }

    #[test]
    fn a_cost_one_in_a_hundred_less_is_no_reason_to_err_more() {
        let rungs = rungs(&[(100.0, 0.2), (101.0, 0.1), (102.0, 0.1)]);
        assert_eq!(pareto(&rungs), [false, true, false]);
        assert_eq!(answer(&rungs, 0.5), Some(1));
    }

    #[test]
    fn errors_of_rounding_are_equal() {
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
