//! Cholesky decomposition of small symmetric matrices. The matrices are first scaled such that their diagonal is 1.

use nalgebra::{SMatrix, SVector};

/// Solves the system `matrix` · x = `right`. Returns `None` if the matrix is not positive definite or x is not finite.
pub(crate) fn solve<const N: usize>(
    matrix: &SMatrix<f64, N, N>,
    right: &SVector<f64, N>,
) -> Option<SVector<f64, N>> {
    let scale = scale(matrix)?;
    let scaled = matrix.component_mul(&(scale * scale.transpose()));
    let factor = scaled.cholesky()?;
    let solution = factor
        .solve(&right.component_mul(&scale))
        .component_mul(&scale);
    solution
        .iter()
        .all(|entry| entry.is_finite())
        .then_some(solution)
}

/// Inverse of a matrix; `None` if the smallest diagonal entry of the scaled Cholesky factor is at most `singular`.
pub(crate) fn inverse<const N: usize>(
    matrix: &SMatrix<f64, N, N>,
    singular: f64,
) -> Option<SMatrix<f64, N, N>> {
    let scale = scale(matrix)?;
    let outer = scale * scale.transpose();
    let factor = matrix.component_mul(&outer).cholesky()?;
    let lower = factor.l_dirty();
    let least = (0..N)
        .map(|index| lower[(index, index)])
        .fold(f64::INFINITY, f64::min);
    (least > singular).then(|| factor.inverse().component_mul(&outer))
}

/// Factors by which rows and columns must be multiplied so that the diagonal of the matrix is 1.
fn scale<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Option<SVector<f64, N>> {
    let scale = SVector::<f64, N>::from_fn(|index, _| matrix[(index, index)].sqrt().recip());
    scale.iter().all(|entry| entry.is_finite()).then_some(scale)
}
