//! Upper triangular band matrices of least-squares problems, computed by orthogonal transformations.

/// Number of rows of a block that are processed together. Rows of zeros are added to a block until its number of rows
/// is a multiple of this value.
const LANES: usize = 4;
/// Maximum number of rows of a block. A block of this size fits into the processor's cache.
const MOST_ROWS: usize = 128;
/// Sums of squares below this value count as zero. The rows are scaled such that their largest entries are about 1.
const VANISHING: f64 = 1e-280;

/// Rows of a least-squares problem that start in the same column. The right-hand side is the last column.
///
/// The block is stored column by column.
pub(super) struct Block {
    /// Number of entries of a row, without the right-hand side.
    width: usize,
    rows: usize,
    /// Largest number of rows of the block, as a number of groups of [`LANES`] rows.
    packs: usize,
    /// Whether the rows of the block were already merged into a triangle. The values in the block are then cleared
    /// before the next row is added.
    is_stale: bool,
    columns: Vec<[f64; LANES]>,
}

impl Block {
    pub(super) fn new(width: usize, most_rows: usize) -> Self {
        let packs = most_rows.min(MOST_ROWS).div_ceil(LANES);
        Self {
            width,
            rows: 0,
            packs,
            is_stale: false,
            columns: vec![[0.0; LANES]; (width + 1) * packs],
        }
    }

    pub(super) const fn is_full(&self) -> bool {
        self.rows == self.packs * LANES
    }

    /// Adds a row of zeros with the right-hand side `right`. Returns the index of the row.
    pub(super) fn push(&mut self, right: f64) -> usize {
        assert!(!self.is_full());
        if self.is_stale {
            self.columns.fill([0.0; LANES]);
            self.is_stale = false;
        }
        let row = self.rows;
        self.rows += 1;
        self.set(row, self.width, right);
        row
    }

    #[inline]
    pub(super) fn set(&mut self, row: usize, column: usize, value: f64) {
        self.columns[column * self.packs + row / LANES][row % LANES] = value;
    }

    pub(super) fn push_row(&mut self, entries: &[f64], right: f64) {
        let row = self.push(right);
        for (column, &entry) in entries.iter().enumerate() {
            self.set(row, column, entry);
        }
    }
}

/// The triangle `R` and the right-hand side `Qᵀb` of a banded least-squares problem `A x ≈ b`.
#[derive(Clone)]
pub(super) struct Triangle {
    order: usize,
    band: usize,
    /// For each row, `band` entries starting at the diagonal, followed by the right-hand side.
    rows: Vec<f64>,
    /// Sum of squared residuals of the least-squares solution `x`.
    pub(super) residual_sum: f64,
}

impl Triangle {
    /// A triangle without equations for `order` unknowns. Each equation may have non-zero entries in `band`
    /// neighbouring columns.
    pub(super) fn new(order: usize, band: usize) -> Self {
        Self {
            order,
            band,
            rows: vec![0.0; order * (band + 1)],
            residual_sum: 0.0,
        }
    }

    pub(super) const fn order(&self) -> usize {
        self.order
    }

    pub(super) const fn band(&self) -> usize {
        self.band
    }

    pub(super) fn row(&self, row: usize) -> &[f64] {
        &self.rows[row * (self.band + 1)..][..self.band]
    }

    pub(super) fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.rows[row * (self.band + 1)..][..self.band]
    }

    pub(super) fn right(&self, row: usize) -> f64 {
        self.rows[row * (self.band + 1) + self.band]
    }

    pub(super) fn clear_row(&mut self, row: usize) {
        let stride = self.band + 1;
        self.rows[row * stride..][..stride].fill(0.0);
    }

    /// The diagonal entries of the triangle, which are never negative.
    pub(super) fn diagonal(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().step_by(self.band + 1).copied()
    }

    /// Merges the rows of `block` into the triangle by reflections, and empties the block.
    ///
    /// Blocks must be merged in the order of ascending `start`, so that no row extends beyond the band.
    pub(super) fn absorb(&mut self, start: usize, block: &mut Block) {
        let (packs, band) = (block.packs, self.band);
        let used = block.rows.div_ceil(LANES);
        let width = block.width.min(self.order - start);
        for offset in 0..width {
            let (done, rest) = block.columns.split_at_mut((offset + 1) * packs);
            let pivot = &done[offset * packs..][..used];
            let square = dot(pivot, pivot);
            if square <= VANISHING {
                continue;
            }
            let row = &mut self.rows[(start + offset) * (band + 1)..][..=band];
            // This Householder reflection converts (row[0], pivot) to (norm, 0, …). `row[0]` is not negative.
            let norm = (row[0] * row[0] + square).sqrt();
            let head = -square / (row[0] + norm);
            let per_norm = 1.0 / norm;
            let factor = -per_norm / head;
            row[0] = norm;
            let reflect = |entry: &mut f64, column: &mut [[f64; LANES]]| {
                let share = head * *entry + dot(pivot, column);
                *entry += per_norm * share;
                subtract(column, factor * share, pivot);
            };
            let columns = rest.chunks_exact_mut(packs);
            for (entry, column) in row[1..].iter_mut().zip(columns).take(width - offset - 1) {
                reflect(entry, &mut column[..used]);
            }
            let right = rest.len() - packs;
            reflect(&mut row[band], &mut rest[right..][..used]);
        }
        let right = &block.columns[block.width * packs..][..used];
        self.residual_sum += dot(right, right);
        block.rows = 0;
        block.is_stale = true;
    }

    /// The effective degrees of freedom that these equations determine after further equations were added. They are the
    /// trace of `J⁻ᵀ RᵀR J⁻¹`, where `R` is this triangle and `J` is the triangle `joined` of all equations.
    pub(super) fn share_of(&self, joined: &Self) -> f64 {
        let mut trace = 0.0;
        let mut row = vec![0.0; self.order];
        for start in 0..self.order {
            row.fill(0.0);
            let entries = &self.row(start)[..self.band.min(self.order - start)];
            row[start..][..entries.len()].copy_from_slice(entries);
            joined.solve_transposed_in_place(&mut row);
            trace += row.iter().map(|entry| entry * entry).sum::<f64>();
        }
        trace
    }

    /// Solves `R x = Qᵀb`. No diagonal entry may be zero.
    pub(super) fn solve(&self) -> Vec<f64> {
        let mut solution = vec![0.0; self.order];
        for row in (0..self.order).rev() {
            let entries = self.row(row);
            let known: f64 = entries[1..]
                .iter()
                .zip(&solution[row + 1..])
                .map(|(entry, value)| entry * value)
                .sum();
            solution[row] = (self.right(row) - known) / entries[0];
        }
        solution
    }

    /// Solves `Rᵀ x = b`. `values` contains `b` and is overwritten by `x`.
    pub(super) fn solve_transposed_in_place(&self, values: &mut [f64]) {
        for row in 0..self.order {
            let entries = self.row(row);
            let (head, tail) = values[row..].split_at_mut(1);
            head[0] /= entries[0];
            for (value, entry) in tail.iter_mut().zip(&entries[1..]) {
                *value -= entry * head[0];
            }
        }
    }
}

#[inline]
fn dot(left: &[[f64; LANES]], right: &[[f64; LANES]]) -> f64 {
    let mut sums = [0.0; LANES];
    for (left, right) in left.iter().zip(right) {
        for lane in 0..LANES {
            sums[lane] += left[lane] * right[lane];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

#[inline]
fn subtract(column: &mut [[f64; LANES]], factor: f64, pivot: &[[f64; LANES]]) {
    for (entries, pivot) in column.iter_mut().zip(pivot) {
        for lane in 0..LANES {
            entries[lane] -= factor * pivot[lane];
        }
    }
}
