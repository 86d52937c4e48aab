//! Rao's score test. A pattern is a possible systematic part of the residuals of a fit. The test computes how much
//! chi-squared would decrease if the amplitudes of patterns were fitted in addition to the parameters of the model.

use nalgebra::{DMatrix, DVector};

use crate::{chi_squared_tail, ratio_tail};

/// Limit for testing a pattern, as a share of the pattern's squared norm. A pattern is tested only if the part that the
/// parameters of the model cannot explain has a larger share. A smaller part may only be due to the model's
/// nonlinearity. Use a larger limit for patterns that contain noise.
pub const LEFT: f64 = 0.02;

/// Decrease of a fit's chi-squared, to first order, if the model's parameters and the amplitudes of patterns in the
/// residuals are fitted together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Explained {
    /// Decrease of the fit's chi-squared if the amplitudes of the patterns are fitted too.
    pub fall: f64,
    /// Degrees of freedom of the test: the number of independent patterns that changes of the model's parameters cannot
    /// explain.
    pub freedom: usize,
}

impl Explained {
    /// Computes the decrease of a fit's chi-squared if the amplitudes of patterns are fitted too. Patterns and
    /// residuals must be divided by the standard deviations of the readings. The remainder of a pattern is the part
    /// that the parameters of the model cannot explain. `squares` are the squared norms of the patterns. `left`
    /// contains the inner products of all pairs of remainders. `by_residuals` contains the inner product of each
    /// remainder with the residuals. A combination of patterns is skipped if its remainder is at most the share `least`
    /// (usually [`LEFT`]) of the combination, measured by squared norms. If a number is not finite, all patterns are
    /// skipped.
    pub fn by(
        squares: &[f64],
        left: &DMatrix<f64>,
        by_residuals: &DVector<f64>,
        least: f64,
    ) -> Self {
        let there: Vec<usize> = (0..squares.len())
            .filter(|&pattern| squares[pattern] > 0.0)
            .collect();
        let size = |pattern: usize| squares[there[pattern]].sqrt();
        let count = there.len();
        let mut explained = Self {
            fall: 0.0,
            freedom: 0,
        };
        if count == 0 {
            return explained;
        }
        let scaled = DMatrix::from_fn(count, count, |row, column| {
            left[(there[row], there[column])] / (size(row) * size(column))
        });
        let found = DVector::from_fn(count, |row, _| by_residuals[there[row]] / size(row));
        if !scaled.iter().chain(&found).all(|number| number.is_finite()) {
            return explained;
        }
        let eigen = scaled.symmetric_eigen();
        for (index, &value) in eigen.eigenvalues.iter().enumerate() {
            if value > least {
                let along = eigen.eigenvectors.column(index).dot(&found);
                explained.fall += along * along / value;
                explained.freedom += 1;
            }
        }
        explained
    }

    /// P-value of the decrease of chi-squared. `None` if the user states the standard deviation of the noise. If it is
    /// estimated from the residuals, `estimated` contains the chi-squared and the degrees of freedom of the fit without
    /// the patterns.
    pub fn p_value(self, estimated: Option<(f64, usize)>) -> f64 {
        let Some((chi_squared, freedom)) = estimated else {
            return chi_squared_tail(self.fall, self.freedom);
        };
        let rest = freedom.saturating_sub(self.freedom);
        let below = (chi_squared - self.fall).max(0.0);
        ratio_tail(self.fall, self.freedom, below, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_that_the_unknowns_take_do_not_count() {
        // A mean is fitted to two readings, and the residuals are (1, −1). The mean completely explains the pattern (1,
        // 1), so only the pattern (1, −1) remains.
        let left = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 2.0]);
        let explained = Explained::by(&[2.0, 2.0], &left, &DVector::from_vec(vec![0.0, 2.0]), LEFT);
        assert_eq!((explained.fall, explained.freedom), (2.0, 1));
        let none = Explained::by(&[0.0], &DMatrix::zeros(1, 1), &DVector::zeros(1), LEFT);
        assert_eq!(
            (none.p_value(None), none.p_value(Some((1.0, 3)))),
            (1.0, 1.0)
        );
    }

    #[test]
    fn patterns_that_are_nearly_one_count_once() {
        let near = 1.0 - 1e-9;
        let left = DMatrix::from_row_slice(2, 2, &[1.0, near, near, 1.0]);
        let explained = Explained::by(&[1.0, 1.0], &left, &DVector::from_vec(vec![3.0, 3.0]), LEFT);
        assert_eq!(explained.freedom, 1);
        assert!((explained.fall - 9.0).abs() < 1e-7, "{}", explained.fall);
    }
}
