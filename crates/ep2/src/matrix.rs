//! Sparse linear maps, and products of dense matrices.

use nalgebra::DMatrix;

/// A linear map between vectors of coefficients, stored as its few non-zero entries.
#[derive(Clone, Debug)]
pub(crate) struct SparseMap {
    from: usize,
    to: usize,
    /// Each entry consists of the index of the input coefficient, the index of the output coefficient, and a factor.
    entries: Vec<(usize, usize, f64)>,
}

impl SparseMap {
    pub(crate) fn new(from: usize, to: usize, entries: Vec<(usize, usize, f64)>) -> Self {
        assert!(entries.iter().all(|entry| entry.0 < from && entry.1 < to));
        Self { from, to, entries }
    }

    pub(crate) fn in_unit(mut self, unit: f64) -> Self {
        self.entries.iter_mut().for_each(|entry| entry.2 /= unit);
        self
    }

    pub(crate) fn transposed(&self) -> Self {
        let turned = |&(from, to, factor): &(usize, usize, f64)| (to, from, factor);
        Self {
            from: self.to,
            to: self.from,
            entries: self.entries.iter().map(turned).collect(),
        }
    }

    /// This linear map as a matrix, with a row for each input coefficient.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        self.apply_to_rows(&DMatrix::identity(self.from, self.from))
    }

    pub(crate) fn apply_to_rows(&self, rows: &DMatrix<f64>) -> DMatrix<f64> {
        assert_eq!(rows.ncols(), self.from);
        let height = rows.nrows();
        let mut result = DMatrix::zeros(height, self.to);
        let (rows, sums) = (rows.as_slice(), result.as_mut_slice());
        for &(from, to, factor) in &self.entries {
            let source = &rows[from * height..(from + 1) * height];
            let sums = &mut sums[to * height..(to + 1) * height];
            for (sum, entry) in sums.iter_mut().zip(source) {
                *sum += factor * entry;
            }
        }
        result
    }
}

/// Number of columns of a matrix that one pass over a sum adds to it. Several columns per pass reduce the number of
/// memory accesses.
const COLUMNS_PER_PASS: usize = 4;

/// The product A B. B is the matrix `b`. A consists of the last columns of `a`: as many columns as `b` has rows.
pub(crate) fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let height = a.nrows();
    let columns = &a.as_slice()[(a.ncols() - b.nrows()) * height..];
    let mut product = DMatrix::zeros(height, b.ncols());
    let sums = product.as_mut_slice().chunks_exact_mut(height.max(1));
    for (sum, factors) in sums.zip(b.as_slice().chunks_exact(b.nrows().max(1))) {
        add_columns(sum, columns, height, |column| factors[column]);
    }
    product
}

/// Adds A Bᵀ to `sum`. The product must be symmetric, because only one triangle of it is computed.
pub(crate) fn add_symmetric(sum: &mut DMatrix<f64>, a: &DMatrix<f64>, b: &DMatrix<f64>) {
    let size = sum.nrows();
    for row in 0..size {
        let below = &mut sum.as_mut_slice()[row * size + row..(row + 1) * size];
        add_columns(below, a.as_slice(), size, |column| b[(row, column)]);
    }
    sum.fill_upper_triangle_with_lower_triangle();
}

/// Adds the columns, each multiplied by its factor, to `sum`. Each column has `height` entries, but only the last
/// `sum.len()` entries are used. The order of the additions is fixed, so that all processors return the same sum.
#[inline]
fn add_columns(sum: &mut [f64], columns: &[f64], height: usize, factor: impl Fn(usize) -> f64) {
    let skipped = height - sum.len();
    let count = columns.len().checked_div(height).unwrap_or(0);
    let column = |index: usize| &columns[index * height + skipped..(index + 1) * height];
    for first in (0..count).step_by(COLUMNS_PER_PASS) {
        let last = count - 1;
        let [a, b, c, d] =
            [first, first + 1, first + 2, first + 3].map(|one| column(one.min(last)));
        // `count` need not be a multiple of four. In the last pass, missing columns get the factor 0, so they add
        // nothing.
        let factor = |index: usize| if index < count { factor(index) } else { 0.0 };
        let (by_a, by_b) = (factor(first), factor(first + 1));
        let (by_c, by_d) = (factor(first + 2), factor(first + 3));
        for ((((sum, a), b), c), d) in sum.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *sum += a * by_a + b * by_b + c * by_c + d * by_d;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_all_entries() {
        for (rows, columns) in [(1, 1), (3, 4), (5, 9), (8, 3), (2, 0), (0, 2)] {
            let a = DMatrix::from_fn(rows, columns, |i, j| ((7 * i + 3 * j) % 11) as f64 - 4.0);
            let weights =
                DMatrix::from_diagonal(&nalgebra::DVector::from_fn(columns, |j, _| j as f64));
            let b = &a * weights;
            let mut sum = DMatrix::identity(rows, rows);
            add_symmetric(&mut sum, &a, &b);
            // All entries are whole numbers, so there are no rounding errors.
            let expected = DMatrix::identity(rows, rows) + &a * b.transpose();
            assert_eq!(sum, expected, "{rows} x {columns}");
            let last = columns.min(3);
            let (few, rest) = (a.columns(columns - last, last), b.transpose());
            let rest = rest.rows(columns - last, last).into_owned();
            assert_eq!(product(&a, &rest), few * &rest);
        }
    }
}
