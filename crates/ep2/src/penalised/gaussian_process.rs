//! A Gaussian process with a squared-exponential covariance (a random smooth surface), as a series of Chebyshev
//! polynomials.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use crate::chebyshev::{place, products, values};
use crate::matrix::SparseMap;
use crate::matrix::product;
use crate::square_quadric::UNKNOWNS;

/// The random surface is a sum of functions with random factors. A function is omitted if, at all places, it
/// contributes less than this value to the variance of the surface's second derivatives. The whole variance is 1.
const MIN_VARIANCE: f64 = 1e-3;

/// A random surface, as a linear map from independent random factors of variance 1 to the coefficients of a Chebyshev
/// series. The map is returned in transposed form. The coefficients of polynomials that form quadrics are left out.
///
/// The covariance of heights is proportional to exp(−d²/2ℓ²). Here d is the distance between two places and ℓ is
/// `length`, both in units of half a side of the square. The second derivatives along an axis have unit variance.
pub(super) fn factors(length: f64, degree: usize) -> SparseMap {
    let side = covariance(length, degree);
    let square = length * length;
    let unit = square * square / 3.0;
    let mut entries = Vec::new();
    let mut count = 0;
    // Coefficients of even and odd polynomials are not correlated. Therefore the covariance is factorised separately
    // for each parity (even or odd) of the polynomials in a and in b.
    for parity in [[0, 0], [1, 0], [0, 1], [1, 1]] {
        let class: Vec<[usize; 2]> = products(degree)
            .skip(UNKNOWNS)
            .filter(|product| product.map(|order| order % 2) == parity)
            .collect();
        // `done` holds the columns of the Cholesky factor of the covariance. Columns with a small variance are omitted.
        let mut done: Vec<f64> = Vec::with_capacity(class.len() * class.len());
        for (pivot, product) in class.iter().enumerate() {
            let start = done.len();
            done.extend(
                class.iter().map(|other| {
                    unit * side[(other[0], product[0])] * side[(other[1], product[1])]
                }),
            );
            let (before, column) = done.split_at_mut(start);
            for before in before.chunks_exact(class.len()) {
                let factor = before[pivot];
                for (entry, before) in column.iter_mut().zip(before) {
                    *entry -= factor * before;
                }
            }
            let own = column[pivot];
            if own * max_square_second_derivative(*product) > MIN_VARIANCE {
                let per_root = 1.0 / own.sqrt();
                column[..pivot].fill(0.0);
                column.iter_mut().for_each(|entry| *entry *= per_root);
                let rough = class[pivot..]
                    .iter()
                    .map(|&product| place(product) - UNKNOWNS);
                let own = rough.zip(&column[pivot..]);
                entries.extend(own.map(|(place, entry)| (place, count, *entry)));
                count += 1;
            } else {
                done.truncate(start);
            }
        }
    }
    SparseMap::new(products(degree).count() - UNKNOWNS, count, entries)
}

/// Square of the largest second derivative of the product T_i(a) T_j(b) for a and b in [−1, 1]. The derivative is
/// largest at a corner of this range.
fn max_square_second_derivative([i, j]: [usize; 2]) -> f64 {
    let [i, j] = [i, j].map(|order| (order * order) as f64);
    let bends = [i * (i - 1.0) / 3.0, i * j, j * (j - 1.0) / 3.0];
    bends
        .map(|bend| bend * bend)
        .into_iter()
        .fold(0.0, f64::max)
}

/// Covariance of the coefficients of the Chebyshev polynomials T_0 to T_degree, for a process of one variable with
/// variance 1. It is computed by Gauss–Chebyshev quadrature.
fn covariance(length: f64, degree: usize) -> DMatrix<f64> {
    let nodes = 2 * degree + 2;
    let places: Vec<f64> = (0..nodes)
        .map(|node| libm::cos((node as f64 + 0.5) * PI / nodes as f64))
        .collect();
    let kernel = DMatrix::from_fn(nodes, nodes, |one, other| {
        let distance = (places[one] - places[other]) / length;
        libm::exp(-0.5 * distance * distance)
    });
    let polynomials = places.iter().flat_map(|&x| values(x, degree));
    // The matrix `rule` of the quadrature has one row for each polynomial and one column for each node.
    let mut rule = DMatrix::from_iterator(degree + 1, nodes, polynomials);
    rule *= 2.0 / nodes as f64;
    rule.row_mut(0).scale_mut(0.5);
    product(&rule, &product(&kernel, &rule.transpose()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chebyshev::{count, derivative};
    use approx::assert_relative_eq;

    #[test]
    fn coefficients_make_the_process() {
        for length in [0.8, 1.5, 4.0] {
            let degree = 14;
            let series = covariance(length, degree);
            for (x, y) in [(-1.0, 1.0), (0.3, -0.4), (0.9, 0.9)] {
                let mut sum = 0.0;
                for (i, at_x) in values(x, degree).enumerate() {
                    for (j, at_y) in values(y, degree).enumerate() {
                        sum += at_x * series[(i, j)] * at_y;
                    }
                }
                let distance = (x - y) / length;
                let expected = libm::exp(-0.5 * distance * distance);
                assert_relative_eq!(sum, expected, epsilon = 1e-6);
            }
        }
    }

    /// Variance of the process's second derivative along a at the place (a, b). The first result includes all products
    /// of polynomials; the second omits the products that form quadrics.
    fn bends(length: f64, degree: usize, [a, b]: [f64; 2]) -> [f64; 2] {
        let [a, b] = [a, b].map(|x| values(x, degree).collect::<Vec<f64>>());
        let here: Vec<f64> = products(degree).map(|[i, j]| a[i] * b[j]).collect();
        let here = DMatrix::from_row_slice(1, here.len(), &here);
        let second = derivative(degree - 1, 0).transposed();
        let lower = here.columns(0, count(degree - 2)).into_owned();
        let slopes = second.apply_to_rows(&lower);
        let bends = derivative(degree, 0).transposed().apply_to_rows(&slopes);
        let side = covariance(length, degree);
        let unit = length * length * length * length / 3.0;
        let mut all = 0.0;
        for (one, bend_one) in products(degree).zip(&bends) {
            for (other, bend_other) in products(degree).zip(&bends) {
                let covariance = unit * side[(one[0], other[0])] * side[(one[1], other[1])];
                all += bend_one * covariance * bend_other;
            }
        }
        let rough = bends
            .columns(UNKNOWNS, bends.ncols() - UNKNOWNS)
            .into_owned();
        let rough = factors(length, degree).apply_to_rows(&rough).norm_squared();
        [all, rough]
    }

    #[test]
    fn second_derivatives_have_unit_variance_and_mostly_not_as_quadrics() {
        for place in [[0.0, 0.0], [0.2, -0.1], [0.5, 0.7]] {
            let [all, rough] = bends(0.7, 18, place);
            assert_relative_eq!(all, 1.0, epsilon = 1e-3);
            assert!((0.5..1.5).contains(&rough), "{rough}");
            // If the correlation length is long, the process is nearly a quadric. Its second derivatives still have the
            // variance 1 everywhere, but the part that is not a quadric has the small variance `rough`.
            let [all, rough] = bends(4.0, 12, place);
            assert_relative_eq!(all, 1.0, epsilon = 1e-3);
            assert!(rough < 0.2, "{rough}");
        }
    }
}
