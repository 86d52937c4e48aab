//! Polynomials over the square [−1, 1]², as series of products T_i(a) T_j(b) of Chebyshev polynomials. The total degree
//! i + j is limited.

use std::f64::consts::PI;
use std::ops::{Mul, Sub};

use crate::matrix::SparseMap;

pub(crate) const fn count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// The indices (i, j) of the products T_i(a) T_j(b) up to a total degree, sorted by i + j. Therefore the coefficients
/// of a series of lower degree come first in a series of higher degree.
pub(crate) fn products(degree: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..=degree).flat_map(|sum| (0..=sum).map(move |j| [sum - j, j]))
}

/// Index of T_i(a) T_j(b) in the list that [`products`] returns.
#[inline]
pub(crate) const fn place([i, j]: [usize; 2]) -> usize {
    count(i + j) - i - 1
}

pub(crate) fn values<T>(x: T, degree: usize) -> impl Iterator<Item = T>
where
    T: Copy + From<f64> + Sub<Output = T> + Mul<Output = T>,
{
    let mut next = [T::from(1.0), x];
    (0..=degree).map(move |_| {
        let [this, after] = next;
        next = [after, T::from(2.0) * x * after - this];
        this
    })
}

/// Coefficients of the series that approximates a function over the square, computed by Gauss–Chebyshev quadrature.
pub(crate) fn approximated(degree: usize, value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let nodes = degree + 2;
    let place = |node: usize| libm::cos((node as f64 + 0.5) * PI / nodes as f64);
    let polynomials: Vec<Vec<f64>> = (0..nodes)
        .map(|node| values(place(node), degree).collect())
        .collect();
    let mut coefficients = vec![0.0; count(degree)];
    for (one, along_a) in polynomials.iter().enumerate() {
        for (other, along_b) in polynomials.iter().enumerate() {
            let value = value(place(one), place(other)) / (nodes * nodes) as f64;
            for (sum, [i, j]) in coefficients.iter_mut().zip(products(degree)) {
                let norm = [1.0, 2.0][usize::from(i > 0)] * [1.0, 2.0][usize::from(j > 0)];
                *sum += norm * value * along_a[i] * along_b[j];
            }
        }
    }
    coefficients
}

/// The linear map from the coefficients of a series to the coefficients of its derivative along an axis. The degree of
/// the derivative is lower by one, except that a constant has a derivative of degree 0.
pub(crate) fn derivative(degree: usize, axis: usize) -> SparseMap {
    let mut entries = Vec::new();
    for (at, product) in products(degree).enumerate() {
        let order = product[axis];
        // The derivative of a Chebyshev polynomial is T_n' = 2n (T_(n−1) + T_(n−3) + …), where T_0 is multiplied by ½.
        for lower in (0..order).rev().step_by(2) {
            let share = if lower == 0 { 1.0 } else { 2.0 };
            let mut part = product;
            part[axis] = lower;
            entries.push((at, place(part), share * order as f64));
        }
    }
    SparseMap::new(count(degree), count(degree.saturating_sub(1)), entries)
}
