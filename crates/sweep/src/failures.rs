//! Trials that gave no result, counted by kind.

/// Kind of a trial that recorded an estimate, truth, error or standard deviation that is NaN or infinite.
pub const NOT_FINITE: &str = "not-finite";
/// Kind of a trial that recorded a standard deviation below zero.
pub const NEGATIVE_STD: &str = "negative-std";
/// Kind of a trial that recorded a quantity outside `0..Trial::quantities()`.
pub const UNKNOWN_QUANTITY: &str = "unknown-quantity";

/// All failures of one kind in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Stable kebab-case name of the kind.
    pub kind: &'static str,
    /// Number of trials that failed so.
    pub count: u64,
    /// Smallest number of a trial that failed so.
    pub first_trial: u64,
}

/// Failures by kind, in no particular order until [`Failures::sorted`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Failures(Vec<Failure>);

impl Failures {
    pub(crate) fn add(&mut self, failure: Failure) {
        match self.0.iter_mut().find(|known| known.kind == failure.kind) {
            Some(known) => {
                known.count += failure.count;
                known.first_trial = known.first_trial.min(failure.first_trial);
            }
            None => self.0.push(failure),
        }
    }

    pub(crate) fn merge(&mut self, other: Failures) {
        other.0.into_iter().for_each(|failure| self.add(failure));
    }

    /// Failures ordered by kind.
    pub(crate) fn sorted(mut self) -> Vec<Failure> {
        self.0.sort_by_key(|failure| failure.kind);
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failure(kind: &'static str, count: u64, first_trial: u64) -> Failure {
        Failure {
            kind,
            count,
            first_trial,
        }
    }

    #[test]
    fn merging_adds_counts_and_keeps_the_first_trial_whichever_side_it_is_on() {
        let side = |failures: &[Failure]| {
            let mut side = Failures::default();
            failures.iter().for_each(|&failure| side.add(failure));
            side
        };
        let left = side(&[failure("rank", 2, 7), failure("lost", 1, 9)]);
        let right = side(&[failure("rank", 3, 4)]);
        let expected = vec![failure("lost", 1, 9), failure("rank", 5, 4)];

        let mut forward = left.clone();
        forward.merge(right.clone());
        assert_eq!(forward.sorted(), expected);

        let mut backward = right;
        backward.merge(left);
        assert_eq!(backward.sorted(), expected);
    }
}
