//! Solves least-squares problems that do not determine all unknowns. Of all solutions, the one with the smallest norm
//! is returned.
//!
//! Dierckx, Curve and Surface Fitting with Splines (1993), section 4.1.2.

use super::triangle::{Block, Triangle};

/// The solution with the smallest norm, and the rank of the equations. Diagonal entries whose magnitude is at most
/// `floor` count as zero.
pub(super) fn solve(triangle: &Triangle, floor: f64) -> (Vec<f64>, usize) {
    let trapezoid = Trapezoid::of(triangle, floor);
    (trapezoid.least_solution(), trapezoid.pivots.len())
}

/// A triangular matrix, reduced to the rows whose diagonal entry is not negligible.
struct Trapezoid {
    reduced: Triangle,
    /// The columns whose diagonal entries are not negligible, in ascending order.
    pivots: Vec<usize>,
}

impl Trapezoid {
    /// Converts a triangle. A small diagonal entry is set to zero, and the remaining entries of its row are merged into
    /// the rows below.
    fn of(triangle: &Triangle, floor: f64) -> Self {
        let (order, band) = (triangle.order(), triangle.band());
        let mut reduced = Triangle::new(order, band);
        let mut block = Block::new(band, 2);
        let mut pivots = Vec::with_capacity(order);
        let mut carried: Option<(Vec<f64>, f64)> = None;
        for column in 0..order {
            block.push_row(triangle.row(column), triangle.right(column));
            if let Some((row, right)) = carried.take() {
                block.push_row(&row[1..], right);
            }
            reduced.absorb(column, &mut block);
            if reduced.row(column)[0] > floor {
                pivots.push(column);
            } else {
                carried = Some((reduced.row(column).to_vec(), reduced.right(column)));
                reduced.clear_row(column);
            }
        }
        Self { reduced, pivots }
    }

    /// The solution `x` of the equations `B x = g` with the smallest norm, where `B` is the matrix of this trapezoid
    /// and `g` its right-hand side. The solution has no component in the null space of `B`.
    ///
    /// The method is a QR decomposition `Bᵀ = Q G` with an orthogonal matrix `Q` and a triangular matrix `G`. Rotations
    /// merge the columns of `B` into `G` one by one, from the last column to the first. The rows of `B` are also
    /// processed from the last to the first. Then the solution is `x = Q G⁻ᵀ g`.
    fn least_solution(&self) -> Vec<f64> {
        let (rank, band) = (self.pivots.len(), self.reduced.band());
        let mut factor = Triangle::new(rank, band);
        let mut rotations = Rotations::new(band);
        let mut row = vec![0.0; band];
        let mut above = rank;
        for column in (0..self.reduced.order()).rev() {
            while above > 0 && self.pivots[above - 1] > column {
                above -= 1;
            }
            if above == 0 {
                break;
            }
            row.fill(0.0);
            let pivots = self.pivots[..above].iter().rev();
            let near = pivots.take_while(|&&pivot| column - pivot < band);
            for (entry, &pivot) in row.iter_mut().zip(near) {
                *entry = self.reduced.row(pivot)[column - pivot];
            }
            rotations.rotate_in(&mut factor, column, rank - above, &mut row);
        }
        let pivots = self.pivots.iter().rev();
        let mut values: Vec<f64> = pivots.map(|&pivot| self.reduced.right(pivot)).collect();
        factor.solve_transposed_in_place(&mut values);
        rotations.undo(values, self.reduced.order())
    }
}

/// The rotations that merged additional rows into a triangle, in the order in which they were applied.
struct Rotations {
    band: usize,
    /// For each additional row: the index of the row, and the first column in which the row has entries.
    rows: Vec<(usize, usize)>,
    /// Cosine and sine of each rotation. There are `band` pairs per additional row.
    planes: Vec<[f64; 2]>,
}

impl Rotations {
    const fn new(band: usize) -> Self {
        Self {
            band,
            rows: Vec::new(),
            planes: Vec::new(),
        }
    }

    /// Merges an additional row into the triangle by rotations, after which all entries of the row are zero. `name` is
    /// the index of the row, and `start` is the first column of its entries.
    fn rotate_in(&mut self, triangle: &mut Triangle, name: usize, start: usize, row: &mut [f64]) {
        self.rows.push((name, start));
        for offset in 0..self.band {
            let pivot = row[offset];
            if pivot == 0.0 || start + offset >= triangle.order() {
                self.planes.push([1.0, 0.0]);
                continue;
            }
            let entries = triangle.row_mut(start + offset);
            let norm = libm::hypot(entries[0], pivot);
            let [cosine, sine] = [entries[0] / norm, pivot / norm];
            entries[0] = norm;
            for (entry, left) in entries[1..].iter_mut().zip(&mut row[offset + 1..]) {
                [*entry, *left] = [
                    cosine * *entry + sine * *left,
                    cosine * *left - sine * *entry,
                ];
            }
            self.planes.push([cosine, sine]);
        }
    }

    /// Applies the inverse rotations to a vector that contains `values` at the triangle's rows and zeros at the
    /// additional rows. Returns its components at the `count` additional rows.
    fn undo(&self, mut values: Vec<f64>, count: usize) -> Vec<f64> {
        let mut result = vec![0.0; count];
        let planes = self.planes.chunks_exact(self.band);
        for (&(name, start), planes) in self.rows.iter().zip(planes).rev() {
            let own = &mut result[name];
            let touched = values[start..].iter_mut().zip(planes);
            for (value, [cosine, sine]) in touched.rev() {
                [*value, *own] = [cosine * *value - sine * *own, sine * *value + cosine * *own];
            }
        }
        result
    }
}
