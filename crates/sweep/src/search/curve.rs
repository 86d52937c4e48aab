//! Questions of a search, and what it is told.

/// Scores of the conditions of a target in one cell: standard deviations by which each is met, negative where it is
/// missed. There is one for the statistic, and one for the share of trials that fail.
pub type Scores = [f64; 2];

/// Question to a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ask {
    /// Value of the field that is varied; where values are listed, the place in the list.
    pub value: f64,
    /// Cell of those that are to meet the target together.
    pub cell: usize,
    /// Number of trials that are to be run at least.
    pub trials: u64,
    /// Whether the trials are to be others than those that the search has seen.
    pub fresh: bool,
}

/// Curve over the values of a field: how surely some cells meet a target.
///
/// Trials of one number must draw the same random numbers at every value, so that values compare trial by trial.
pub trait Curves {
    /// Reason why there is no score.
    type Error;

    /// Number of cells that are to meet the target together; at least 1.
    fn cells(&self) -> usize;

    /// Scores of what is asked for, in its order.
    ///
    /// # Errors
    /// Reason why there is one without a score.
    fn look(&mut self, asked: &[Ask]) -> Result<Vec<Scores>, Self::Error>;
}
