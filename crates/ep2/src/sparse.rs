//! Linear maps of which few entries are not 0.

use nalgebra::DMatrix;

/// A linear map from so many coefficients to others, by its entries.
#[derive(Clone, Debug)]
pub(crate) struct SparseMap {
    from: usize,
    to: usize,
    /// Coefficient from which, coefficient to which, and the factor between them.
    entries: Vec<(usize, usize, f64)>,
}

impl SparseMap {
    pub(crate) fn new(from: usize, to: usize, entries: Vec<(usize, usize, f64)>) -> Self {
        debug_assert!(entries.iter().all(|entry| entry.0 < from && entry.1 < to));
        Self { from, to, entries }
    }

    /// Map with every entry divided by `unit`.
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

    /// The map as a matrix, a row for each coefficient from which.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        self.of_rows(&DMatrix::identity(self.from, self.from))
    }

    /// The map of every row of coefficients.
    pub(crate) fn of_rows(&self, rows: &DMatrix<f64>) -> DMatrix<f64> {
        debug_assert_eq!(rows.ncols(), self.from);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_mapped_as_by_the_whole_matrix() {
        let map = SparseMap::new(3, 2, vec![(0, 1, 2.0), (2, 1, -1.0), (1, 0, 4.0)]);
        let whole = DMatrix::from_row_slice(3, 2, &[0.0, 2.0, 4.0, 0.0, 0.0, -1.0]);
        let rows = DMatrix::from_fn(4, 3, |i, j| (i * i + 3 * j) as f64);
        assert_eq!(map.of_rows(&rows), &rows * &whole);
        assert_eq!(map.matrix(), whole);
        let back = map.of_rows(&rows);
        assert_eq!(map.transposed().of_rows(&back), &back * whole.transpose());
        assert_eq!(map.in_unit(2.0).of_rows(&rows), rows * whole / 2.0);
    }
}
