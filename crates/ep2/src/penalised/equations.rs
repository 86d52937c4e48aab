//! The normal equations of a bicubic spline, summed separately for each knot interval, and the roughness penalty of the
//! spline.

use nalgebra::{DMatrix, DVector};

use crate::Patch;
use crate::knots::Knots;
use crate::noise::Kinds;
use crate::square_quadric::{Square, SquareQuadric};

pub(super) const DEGREE: usize = 3;
/// Number of B-splines along one direction that are not 0 at a position.
const SUPPORT: usize = DEGREE + 1;
/// Number of products of two B-splines (along u and along v) that are not 0 at a position.
const LOCAL: usize = SUPPORT * SUPPORT;

/// Normal equations for the coefficients of a spline that describes the deviation of the surface from a quadric. The
/// equations of heights and of slopes are stored separately, and are for observations with variance 1.
pub(super) struct Equations {
    pub(super) grams: Kinds<DMatrix<f64>>,
    pub(super) right_sides: Kinds<DVector<f64>>,
    /// Weighted sums of the squared deviations of the observed heights and slopes from the quadric.
    pub(super) squares: Kinds<f64>,
    pub(super) count: Kinds<usize>,
}

/// Contribution to the normal equations by the contacts in one cell of the knots: one interval along u and one along v.
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

    /// Adds one observation to the right side of the equations and, if `with_gram`, to their matrix.
    #[inline]
    fn add(
        &mut self,
        along_a: &[f64],
        along_b: &[f64],
        [value, weight]: [f64; 2],
        with_gram: bool,
    ) {
        let mut row = [0.0; LOCAL];
        for (chunk, a) in row.chunks_exact_mut(SUPPORT).zip(along_a) {
            for (entry, b) in chunk.iter_mut().zip(along_b) {
                *entry = a * b;
            }
        }
        for ((gram, right), entry) in self.gram.iter_mut().zip(&mut self.right).zip(row) {
            let weighted = weight * entry;
            *right += weighted * value;
            if !with_gram {
                continue;
            }
            for (sum, other) in gram.iter_mut().zip(row) {
                *sum += weighted * other;
            }
        }
    }
}

impl Equations {
    /// Sums the equations for the deviations of a patch's contacts from `quadric`. If `with_grams` is false, only the
    /// right sides are computed.
    pub(super) fn around(
        quadric: &SquareQuadric,
        patch: &Patch,
        square: &Square,
        knots: &[Knots; 2],
        with_grams: bool,
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
            heights[cell].add(&a, &b, [one.height, one.height_weight], with_grams);
            squares.heights += one.height_weight * one.height * one.height;
            if has_slopes {
                let [slope_a, slope_b] = one.slopes;
                let [weight_a, weight_b] = one.slope_weights;
                slopes[cell].add(&da, &b, [slope_a, weight_a], with_grams);
                slopes[cell].add(&a, &db, [slope_b, weight_b], with_grams);
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
                slopes: patch.equations() - patch.samples.len(),
            },
        }
    }

    pub(super) const fn has_slopes(&self) -> bool {
        self.count.slopes > 0
    }

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

    /// Two parts of the fit's effective degrees of freedom: the part that the heights determine, and the part that the
    /// slopes determine. `inverse` is (A + λP)⁻¹ with the matrix A of the normal equations, the penalty matrix P and
    /// the smoothing weight λ.
    pub(super) fn effective_unknowns(
        &self,
        inverse: &DMatrix<f64>,
        variances: &Kinds<f64>,
    ) -> Kinds<f64> {
        Kinds {
            heights: inverse.dot(&self.grams.heights) / variances.heights,
            slopes: inverse.dot(&self.grams.slopes) / variances.slopes,
        }
    }
}

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

/// Nodes and weights of the Gauss rule with four nodes on [−1, 1]. It is exact for polynomials up to degree 7.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Returns the matrix P with which the roughness of a spline is cᵀPc, where c are the coefficients of the spline. The
/// roughness of a spline w(a, b) is the integral ∬ w_aaa² + 3 w_aab² + 3 w_abb² + w_bbb² over the square. The integrand
/// does not depend on the directions of the axes.
pub(super) fn roughness_penalty(knots: &[Knots; 2]) -> DMatrix<f64> {
    let grams: [[DMatrix<f64>; 4]; 2] = knots
        .each_ref()
        .map(|knots| std::array::from_fn(|order| gram(knots, order)));
    let coefficients = knots[0].functions() * knots[1].functions();
    let mut penalty = DMatrix::zeros(coefficients, coefficients);
    for (order, count) in [(3, 1.0), (2, 3.0), (1, 3.0), (0, 1.0)] {
        penalty += grams[0][order].kronecker(&grams[1][3 - order]) * count;
    }
    penalty
}

/// Integrals ∫ B_i⁽ᵐ⁾ B_j⁽ᵐ⁾ of products of the B-splines' derivatives of order m.
fn gram(knots: &Knots, order: usize) -> DMatrix<f64> {
    let mut result = DMatrix::zeros(knots.functions(), knots.functions());
    let mut ends = vec![knots.domain().0];
    ends.extend_from_slice(knots.interior());
    ends.push(knots.domain().1);
    for (first, pair) in ends.windows(2).enumerate() {
        let half = 0.5 * (pair[1] - pair[0]);
        for (node, weight) in GAUSS {
            let x = pair[0] + half * (1.0 + node);
            let basis = knots.derivatives::<4>(first, x)[order];
            for (i, one) in basis[..=knots.degree()].iter().enumerate() {
                for (j, other) in basis[..=knots.degree()].iter().enumerate() {
                    result[(first + i, first + j)] += half * weight * one * other;
                }
            }
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::DVector;

    #[test]
    fn third_derivatives_are_penalised_and_quadrics_are_not() {
        let knots = [3, 5].map(|intervals| Knots::uniform(3, -1.0, 1.0, intervals));
        // If a spline equals 1, x, x² or x³, its coefficients are means of products (blossoms). Each product has none,
        // one, two or three different inner knots as factors.
        let powers = |knots: &Knots, function: usize| {
            let t = &knots.as_slice()[function + 1..function + 4];
            [
                1.0,
                (t[0] + t[1] + t[2]) / 3.0,
                (t[0] * t[1] + t[0] * t[2] + t[1] * t[2]) / 3.0,
                t[0] * t[1] * t[2],
            ]
        };
        let penalty = |power_a: usize, power_b: usize| {
            let [a, b] = &knots;
            let width = b.functions();
            let coefficients = DVector::from_fn(a.functions() * width, |index, _| {
                powers(a, index / width)[power_a] * powers(b, index % width)[power_b]
            });
            coefficients.dot(&(roughness_penalty(&knots) * &coefficients))
        };
        for (power_a, power_b) in [(0, 0), (1, 0), (0, 2), (1, 1), (2, 0)] {
            assert_relative_eq!(penalty(power_a, power_b), 0.0, epsilon = 1e-10);
        }
        // The penalty is the integral of the squared third derivatives over the area 4. For a³, the only third
        // derivative is 6, so the penalty is 4 · 6². For a²b, the derivative 2 occurs in three orders, so the penalty
        // is 4 · 3 · 2².
        assert_relative_eq!(penalty(3, 0), 144.0, max_relative = 1e-12);
        assert_relative_eq!(penalty(2, 1), 48.0, max_relative = 1e-12);
        assert_relative_eq!(penalty(1, 2), 48.0, max_relative = 1e-12);
    }
}
