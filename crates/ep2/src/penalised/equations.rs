//! The normal equations of a bicubic spline, gathered interval by interval.

use nalgebra::{DMatrix, DVector};

use crate::noise::Kinds;
use crate::square::Square;
use crate::square_quadric::SquareQuadric;
use crate::{Knots, Patch};

/// Degree of the spline.
pub(super) const DEGREE: usize = 3;
const SUPPORT: usize = DEGREE + 1;
/// B-splines that do not vanish at a place.
const LOCAL: usize = SUPPORT * SUPPORT;

/// The normal equations of heights and of slopes, each of unit variance, for the deviation from a
/// quadric.
pub(super) struct Equations {
    pub(super) grams: Kinds<DMatrix<f64>>,
    pub(super) right_sides: Kinds<DVector<f64>>,
    /// Weighted sums of squares of the deviations.
    pub(super) squares: Kinds<f64>,
    /// Numbers of equations.
    pub(super) count: Kinds<usize>,
}

/// Contribution of the contacts over one interval of both sides to the normal equations.
#[derive(Clone)]
struct Cell {
    gram: [[f64; LOCAL]; LOCAL],
    right: [f64; LOCAL],
}

impl Cell {
    const EMPTY: Self = Self {
        gram: [[0.0; LOCAL]; LOCAL],
        right: [0.0; LOCAL],
    };

    #[inline]
    fn add(&mut self, along_a: &[f64], along_b: &[f64], value: f64, weight: f64) {
        let mut row = [0.0; LOCAL];
        for (chunk, a) in row.chunks_exact_mut(SUPPORT).zip(along_a) {
            for (entry, b) in chunk.iter_mut().zip(along_b) {
                *entry = a * b;
            }
        }
        for ((gram, right), entry) in self.gram.iter_mut().zip(&mut self.right).zip(row) {
            let weighted = weight * entry;
            *right += weighted * value;
            for (sum, other) in gram.iter_mut().zip(row) {
                *sum += weighted * other;
            }
        }
    }
}

impl Equations {
    /// The equations of the deviation of a patch from `quadric`.
    pub(super) fn around(
        quadric: &SquareQuadric,
        patch: &Patch,
        square: &Square,
        knots: &[Knots; 2],
    ) -> Self {
        let [knots_a, knots_b] = knots;
        let [along_a, along_b] = intervals(knots);
        let has_slopes = patch.has_normals();
        let mut heights = vec![Cell::EMPTY; along_a * along_b];
        let mut slopes = vec![Cell::EMPTY; if has_slopes { along_a * along_b } else { 0 }];
        let mut squares = Kinds::default();
        for one in quadric.observations(patch, square) {
            let (first_a, first_b) = (knots_a.first_function(one.a), knots_b.first_function(one.b));
            let [a, da] = knots_a.derivatives::<2>(first_a, one.a);
            let [b, db] = knots_b.derivatives::<2>(first_b, one.b);
            let cell = first_a * along_b + first_b;
            heights[cell].add(&a, &b, one.height, one.height_weight);
            squares.heights += one.height_weight * one.height * one.height;
            if has_slopes {
                let [slope_a, slope_b] = one.slopes;
                let [weight_a, weight_b] = one.slope_weights;
                slopes[cell].add(&da, &b, slope_a, weight_a);
                slopes[cell].add(&a, &db, slope_b, weight_b);
                squares.slopes += weight_a * slope_a * slope_a + weight_b * slope_b * slope_b;
            }
        }
        let (gram_heights, right_heights) = assembled(&heights, knots);
        let (gram_slopes, right_slopes) = assembled(&slopes, knots);
        Self {
            grams: Kinds {
                heights: gram_heights,
                slopes: gram_slopes,
            },
            right_sides: Kinds {
                heights: right_heights,
                slopes: right_slopes,
            },
            squares,
            count: Kinds {
                heights: patch.samples.len(),
                slopes: if has_slopes {
                    2 * patch.samples.len()
                } else {
                    0
                },
            },
        }
    }

    pub(super) const fn has_slopes(&self) -> bool {
        self.count.slopes > 0
    }

    /// Weighted sums of squared residuals.
    pub(super) fn residuals(&self, deviation: &DVector<f64>) -> Kinds<f64> {
        let residual = |gram: &DMatrix<f64>, right: &DVector<f64>, square: f64| {
            (square - 2.0 * deviation.dot(right) + deviation.dot(&(gram * deviation))).max(0.0)
        };
        Kinds {
            heights: residual(
                &self.grams.heights,
                &self.right_sides.heights,
                self.squares.heights,
            ),
            slopes: residual(
                &self.grams.slopes,
                &self.right_sides.slopes,
                self.squares.slopes,
            ),
        }
    }

    /// Effective numbers of unknowns that a fit takes from heights and from slopes, by its (A + λP)⁻¹.
    pub(super) fn taken(&self, inverse: &DMatrix<f64>, variances: &Kinds<f64>) -> Kinds<f64> {
        Kinds {
            heights: inverse.dot(&self.grams.heights) / variances.heights,
            slopes: inverse.dot(&self.grams.slopes) / variances.slopes,
        }
    }
}

/// Intervals along both sides.
fn intervals(knots: &[Knots; 2]) -> [usize; 2] {
    knots.each_ref().map(|knots| knots.interior().len() + 1)
}

fn assembled(cells: &[Cell], knots: &[Knots; 2]) -> (DMatrix<f64>, DVector<f64>) {
    let [_, along_b] = intervals(knots);
    let width = knots[1].functions();
    let coefficients = knots[0].functions() * width;
    let mut gram = DMatrix::zeros(coefficients, coefficients);
    let mut right = DVector::zeros(coefficients);
    for (index, cell) in cells.iter().enumerate() {
        let (first_a, first_b) = (index / along_b, index % along_b);
        let place = |local: usize| (first_a + local / SUPPORT) * width + first_b + local % SUPPORT;
        for (one, entries) in cell.gram.iter().enumerate() {
            right[place(one)] += cell.right[one];
            for (other, entry) in entries.iter().enumerate() {
                gram[(place(other), place(one))] += entry;
            }
        }
    }
    (gram, right)
}
