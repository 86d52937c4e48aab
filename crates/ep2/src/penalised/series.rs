//! The normal equations of a series of Chebyshev polynomials that describes a surface.

use nalgebra::{DMatrix, DVector};

use crate::Patch;
use crate::chebyshev::{count, derivative, products, values};
use crate::noise::Variances;
use crate::square_quadric::{Square, SquareQuadric};

/// Normal equations for the coefficients of a series that describes the deviation of the surface from a quadric. The
/// equations contain heights and slopes, weighted with their inverse variances.
pub(super) struct SeriesEquations {
    pub(super) gram: DMatrix<f64>,
    pub(super) right: DVector<f64>,
    pub(super) square: f64,
}

/// Weighted sums over the observations of one kind (heights or slopes). A product of two Chebyshev polynomials is a sum
/// of Chebyshev polynomials. Therefore the matrix of the normal equations follows from sums of single polynomials
/// (`moments`) up to twice the degree.
struct Sums {
    degree: usize,
    /// Sums of weight · T_p(a) T_q(b) over the contacts, for all p and q with p + q up to twice the degree. The sums
    /// are ordered first by p, then by q.
    moments: Vec<f64>,
    /// Sums of weight · value · T_i(a) T_j(b) over the contacts, for all i and j with i + j up to the degree. The sums
    /// are ordered first by i, then by j.
    right: Vec<f64>,
    square: f64,
}

impl Sums {
    fn new(degree: usize) -> Self {
        let square = |side: usize| vec![0.0; side * side];
        Self {
            degree,
            moments: square(2 * degree + 1),
            right: square(degree + 1),
            square: 0.0,
        }
    }

    fn add(&mut self, a: &[f64], b: &[f64], value: f64, weight: f64) {
        let weighted = weight * value;
        add_products(&mut self.moments, 2 * self.degree, a, b, weight);
        add_products(&mut self.right, self.degree, a, b, weighted);
        self.square += weighted * value;
    }

    fn right(&self) -> DVector<f64> {
        let all = products(self.degree).map(|[i, j]| self.right[i * (self.degree + 1) + j]);
        DVector::from_iterator(count(self.degree), all)
    }

    fn gram(&self) -> DMatrix<f64> {
        let side = 2 * self.degree + 1;
        let size = count(self.degree);
        let mut gram = DMatrix::zeros(size, size);
        for (row, [i, j]) in products(self.degree).enumerate() {
            for (column, [k, l]) in products(self.degree).enumerate().take(row + 1) {
                let (high, low) = ((i + k) * side, i.abs_diff(k) * side);
                let (far, near) = (j + l, j.abs_diff(l));
                let moments = &self.moments;
                let sum = moments[high + far]
                    + moments[high + near]
                    + moments[low + far]
                    + moments[low + near];
                gram[(row, column)] = 0.25 * sum;
                gram[(column, row)] = 0.25 * sum;
            }
        }
        gram
    }
}

/// Adds the products a[p] b[q] with p + q ≤ `degree` to the sums, each multiplied by `weight`.
#[inline]
fn add_products(sums: &mut [f64], degree: usize, a: &[f64], b: &[f64], weight: f64) {
    let rows = sums.chunks_exact_mut(degree + 1).zip(a);
    for (p, (row, a)) in rows.enumerate() {
        let weighted = weight * a;
        for (sum, b) in row[..=degree - p].iter_mut().zip(b) {
            *sum += weighted * b;
        }
    }
}

impl SeriesEquations {
    /// Sums the equations of a series of the degree `degree`, for the deviations of a patch's contacts from `quadric`.
    pub(super) fn around(
        quadric: &SquareQuadric,
        patch: &Patch,
        square: &Square,
        variances: &Variances,
        degree: usize,
    ) -> Self {
        let (per_height, per_slope) = (1.0 / variances.heights, 1.0 / variances.slopes);
        let mut heights = Sums::new(degree);
        let mut slopes = [Sums::new(degree - 1), Sums::new(degree - 1)];
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for one in quadric.observations(patch, square) {
            for (polynomials, x) in [(&mut a, one.a), (&mut b, one.b)] {
                polynomials.clear();
                polynomials.extend(values(x, 2 * degree));
            }
            heights.add(&a, &b, one.height, one.height_weight * per_height);
            if patch.has_normals() {
                let along = one.slopes.into_iter().zip(one.slope_weights);
                for (sums, (slope, weight)) in slopes.iter_mut().zip(along) {
                    sums.add(&a, &b, slope, weight * per_slope);
                }
            }
        }
        let mut equations = Self {
            gram: heights.gram(),
            right: heights.right(),
            square: heights.square,
        };
        if patch.has_normals() {
            for (axis, sums) in slopes.iter().enumerate() {
                equations.add_derivatives(sums, axis, degree);
            }
        }
        equations
    }

    /// Adds the equations of the slopes along `axis`. `sums` contains the sums of the slopes for a series that
    /// represents the derivative along this axis.
    fn add_derivatives(&mut self, sums: &Sums, axis: usize, degree: usize) {
        let adjoint = derivative(degree, axis).transposed();
        let half = adjoint.apply_to_rows(&sums.gram());
        self.gram += adjoint.apply_to_rows(&half.transpose());
        let right = sums.right();
        let right = DMatrix::from_row_slice(1, right.len(), right.as_slice());
        self.right += adjoint.apply_to_rows(&right).transpose().column(0);
        self.square += sums.square;
    }
}
