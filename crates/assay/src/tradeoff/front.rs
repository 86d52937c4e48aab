//! Which rungs are worth taking, and which answers a target.

/// What a rung costs and errs; smaller is better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Worth {
    /// Instructions, or nanoseconds where none are counted.
    pub(super) cost: f64,
    /// Relative.
    pub(super) error: f64,
}

/// Costs that differ by no more count as equal.
const EQUAL: f64 = 1.02;

/// Whether each rung lies on the Pareto front: no other errs at most as much at most as dearly, and less or cheaper.
pub(super) fn pareto(rungs: &[Worth]) -> Vec<bool> {
    let beats = |a: &Worth, b: &Worth| {
        let (no_dearer, cheaper) = (a.cost <= EQUAL * b.cost, EQUAL * a.cost < b.cost);
        no_dearer && a.error <= b.error && (cheaper || a.error < b.error)
    };
    rungs
        .iter()
        .map(|one| !rungs.iter().any(|other| beats(other, one)))
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
        assert_eq!(pareto(&rungs), [true, false, true, false, true]);
        assert!(pareto(&[]).is_empty());
    }

    #[test]
    fn a_cost_one_in_a_hundred_less_is_no_reason_to_err_more() {
        let rungs = rungs(&[(100.0, 0.2), (101.0, 0.1), (102.0, 0.1)]);
        assert_eq!(pareto(&rungs), [false, true, true]);
        assert_eq!(answer(&rungs, 0.5), Some(1));
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
