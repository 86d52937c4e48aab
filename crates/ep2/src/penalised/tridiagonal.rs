//! Symmetric tridiagonal matrices. A matrix is transformed to this form if only determinants and inverses are needed,
//! because this is faster than the computation of eigenvalues.

use nalgebra::{DMatrix, SymmetricTridiagonal};

/// A symmetric matrix T whose entries are 0 except on the diagonal and beside it.
pub(super) struct Tridiagonal {
    diagonal: Vec<f64>,
    beside: Vec<f64>,
}

/// The factors L and D of 1 + s T = L D Lᵀ, where s is a number and T a tridiagonal matrix.
pub(super) struct Factors {
    pivots: Vec<f64>,
    below: Vec<f64>,
}

impl Tridiagonal {
    /// The matrix T and the orthogonal matrix Q with A = Q T Qᵀ, for a symmetric matrix A with at least one row.
    pub(super) fn of(matrix: DMatrix<f64>) -> (Self, DMatrix<f64>) {
        let (turn, diagonal, beside) = SymmetricTridiagonal::new(matrix).unpack();
        let tridiagonal = Self {
            diagonal: diagonal.as_slice().to_vec(),
            beside: beside.as_slice().to_vec(),
        };
        (tridiagonal, turn)
    }

    pub(super) fn factors(&self, s: f64) -> Factors {
        let mut pivots = Vec::with_capacity(self.diagonal.len());
        let mut below = Vec::with_capacity(self.beside.len());
        let mut carried = 0.0;
        for (index, diagonal) in self.diagonal.iter().enumerate() {
            let pivot = 1.0 + s * diagonal - carried;
            pivots.push(pivot);
            if let Some(beside) = self.beside.get(index) {
                let beside = s * beside;
                below.push(beside / pivot);
                carried = beside * beside / pivot;
            }
        }
        Factors { pivots, below }
    }
}

impl Factors {
    pub(super) fn log_determinant(&self) -> f64 {
        // Logarithms are slow, so compute one logarithm for the product of eight pivots. This product does not
        // overflow.
        let products = self.pivots.chunks(8).map(|few| few.iter().product());
        products.map(|product: f64| libm::log(product)).sum()
    }

    /// Solves (1 + s T) x = b. `right` contains b and is overwritten by x.
    pub(super) fn solve(&self, right: &mut [f64]) {
        for index in 1..right.len() {
            right[index] -= self.below[index - 1] * right[index - 1];
        }
        for (right, pivot) in right.iter_mut().zip(&self.pivots) {
            *right /= pivot;
        }
        for index in (1..right.len()).rev() {
            right[index - 1] -= self.below[index - 1] * right[index];
        }
    }

    /// Adds the inverse of 1 + s T, multiplied by `factor`, to the lower triangle of `sum`.
    pub(super) fn add_inverse(&self, sum: &mut DMatrix<f64>, factor: f64) {
        let size = self.pivots.len();
        // In each row of the inverse, the entries right of the diagonal are proportional to the entries of the next row
        // (Takahashi et al., 1973).
        let mut row = vec![0.0; size];
        for index in (0..size).rev() {
            let mut own = factor / self.pivots[index];
            if let Some(below) = self.below.get(index) {
                let below = -below;
                row[index + 1..]
                    .iter_mut()
                    .for_each(|entry| *entry *= below);
                own += below * row[index + 1];
            }
            row[index] = own;
            let column = &mut sum.as_mut_slice()[index * size..(index + 1) * size];
            for (sum, entry) in column[index..].iter_mut().zip(&row[index..]) {
                *sum += entry;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::DVector;

    #[test]
    fn a_shifted_matrix_is_solved_and_has_its_determinant() {
        for size in [1, 2, 5, 20] {
            let entry = |i: usize, j: usize| libm::sin((3 * (i + j) + i * j) as f64);
            let any = DMatrix::from_fn(size, size, entry);
            let matrix = &any * any.transpose();
            let shifted = DMatrix::identity(size, size) + &matrix * 7.0;
            let (tridiagonal, turn) = Tridiagonal::of(matrix);
            let factors = tridiagonal.factors(7.0);
            let expected = libm::log(shifted.determinant());
            assert_relative_eq!(factors.log_determinant(), expected, max_relative = 1e-10);
            let right = DVector::from_fn(size, |i, _| libm::cos(i as f64));
            let mut solution = turn.tr_mul(&right);
            factors.solve(solution.as_mut_slice());
            assert_relative_eq!(&shifted * (&turn * solution), right, epsilon = 1e-10);
            let mut inverse = DMatrix::zeros(size, size);
            factors.add_inverse(&mut inverse, 3.0);
            inverse.fill_upper_triangle_with_lower_triangle();
            let identity = &turn * inverse * turn.transpose() * shifted;
            let expected = DMatrix::identity(size, size) * 3.0;
            assert_relative_eq!(identity, expected, epsilon = 1e-9);
        }
    }
}
