//! Problems whose unknowns are not all determined: the solution of least norm.
//!
//! Dierckx, Curve and Surface Fitting with Splines (1993), section 4.1.2.

use super::triangle::{Block, Triangle};

/// The solution of least norm and the rank; diagonal entries up to `floor` count as zero.
pub(super) fn solve(triangle: &Triangle, floor: f64) -> (Vec<f64>, usize) {
    let trapezoid = Trapezoid::of(triangle, floor);
    (trapezoid.least_solution(), trapezoid.pivots.len())
}

/// The rows of a triangle whose diagonal counts.
struct Trapezoid {
    reduced: Triangle,
    /// The columns of the diagonal entries that count, ascending.
    pivots: Vec<usize>,
}

impl Trapezoid {
    /// Goes through the columns; where a diagonal entry is small it is dropped, and what is left
    /// of its row goes into the rows below.
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

    /// With the trapezoid `B` and its right-hand side `g`: `x = Bᵀ y`, where `B Bᵀ y = g`.
    fn least_solution(&self) -> Vec<f64> {
        let factor = self.factor();
        let mut multipliers: Vec<f64> = self
            .pivots
            .iter()
            .rev()
            .map(|&pivot| self.reduced.right(pivot))
            .collect();
        factor.solve_transposed_in_place(&mut multipliers);
        factor.solve_in_place(&mut multipliers);
        let mut solution = vec![0.0; self.reduced.order()];
        for (&pivot, multiplier) in self.pivots.iter().rev().zip(multipliers) {
            let row = self.reduced.row(pivot);
            for (value, entry) in solution[pivot..].iter_mut().zip(row) {
                *value += entry * multiplier;
            }
        }
        solution
    }

    /// The triangle `G` with `GᵀG = B Bᵀ`, the rows of `B` taken from the last to the first.
    ///
    /// Its equations are the columns of `B`; from the last to the first they start in ascending
    /// places.
    fn factor(&self) -> Triangle {
        let (rank, band) = (self.pivots.len(), self.reduced.band());
        let mut factor = Triangle::new(rank, band);
        let mut block = Block::new(band, 1);
        let mut above = rank;
        for column in (0..self.reduced.order()).rev() {
            while above > 0 && self.pivots[above - 1] > column {
                above -= 1;
            }
            if above == 0 {
                break;
            }
            let row = block.push(0.0);
            let pivots = self.pivots[..above].iter().rev();
            for (place, &pivot) in pivots
                .take_while(|&&pivot| column - pivot < band)
                .enumerate()
            {
                block.set(row, place, self.reduced.row(pivot)[column - pivot]);
            }
            factor.absorb(rank - above, &mut block);
        }
        factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// x + y = 2 and y + z = 4 leave a line of solutions; the nearest to 0 is (0, 2, 2).
    #[test]
    fn the_nearest_of_a_line_of_solutions() {
        let mut triangle = Triangle::new(3, 2);
        let mut block = Block::new(2, 2);
        block.push_row(&[1.0, 1.0], 2.0);
        triangle.absorb(0, &mut block);
        block.push_row(&[1.0, 1.0], 4.0);
        triangle.absorb(1, &mut block);
        let (solution, rank) = solve(&triangle, 1e-8);
        assert_eq!(rank, 2);
        for (value, expected) in solution.iter().zip([0.0, 2.0, 2.0]) {
            assert_relative_eq!(*value, expected, epsilon = 1e-14);
        }
    }

    /// An unknown in the middle that nothing measures is zero, and those behind it are found.
    #[test]
    fn an_unmeasured_unknown() {
        let mut triangle = Triangle::new(4, 3);
        let mut block = Block::new(3, 3);
        block.push_row(&[2.0, 0.0, 1.0], 3.0);
        block.push_row(&[1.0, 0.0, 1.0], 2.0);
        triangle.absorb(0, &mut block);
        block.push_row(&[0.0, 1.0, 1.0], 5.0);
        triangle.absorb(1, &mut block);
        let (solution, rank) = solve(&triangle, 1e-8);
        assert_eq!(rank, 3);
        for (value, expected) in solution.iter().zip([1.0, 0.0, 1.0, 4.0]) {
            assert_relative_eq!(*value, expected, epsilon = 1e-14);
        }
    }
}
