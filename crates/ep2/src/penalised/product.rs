//! Products of dense matrices, summed in one order on every processor.

use nalgebra::DMatrix;

/// Columns that are added in one pass over the sum.
const ABREAST: usize = 4;

/// Product of the last columns of A with B, as many as B has rows.
pub(super) fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let height = a.nrows();
    let columns = &a.as_slice()[(a.ncols() - b.nrows()) * height..];
    let mut product = DMatrix::zeros(height, b.ncols());
    let sums = product.as_mut_slice().chunks_exact_mut(height.max(1));
    for (sum, factors) in sums.zip(b.as_slice().chunks_exact(b.nrows().max(1))) {
        add_columns(sum, columns, height, |column| factors[column]);
    }
    product
}

/// Adds A Bᵀ, which must be symmetric: one triangle is computed.
pub(super) fn add_symmetric(sum: &mut DMatrix<f64>, a: &DMatrix<f64>, b: &DMatrix<f64>) {
    let size = sum.nrows();
    for row in 0..size {
        let below = &mut sum.as_mut_slice()[row * size + row..(row + 1) * size];
        add_columns(below, a.as_slice(), size, |column| b[(row, column)]);
    }
    sum.fill_upper_triangle_with_lower_triangle();
}

/// Adds the last entries of columns of this height, each times its factor; in their order, four at a time.
#[inline]
fn add_columns(sum: &mut [f64], columns: &[f64], height: usize, factor: impl Fn(usize) -> f64) {
    let skipped = height - sum.len();
    let count = columns.len().checked_div(height).unwrap_or(0);
    let column = |index: usize| &columns[index * height + skipped..(index + 1) * height];
    for first in (0..count).step_by(ABREAST) {
        let last = count - 1;
        let [a, b, c, d] =
            [first, first + 1, first + 2, first + 3].map(|one| column(one.min(last)));
        // What is not there counts 0.
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
            // Whole numbers, which do not round.
            let expected = DMatrix::identity(rows, rows) + &a * b.transpose();
            assert_eq!(sum, expected, "{rows} x {columns}");
            let last = columns.min(3);
            let (few, rest) = (a.columns(columns - last, last), b.transpose());
            let rest = rest.rows(columns - last, last).into_owned();
            assert_eq!(product(&a, &rest), few * &rest);
        }
    }
}
