//! Small symmetric matrices.

use std::ops::{Add, Mul, Sub};

use nalgebra::{Matrix2, Matrix3};

use crate::Lanes;
use crate::moments::first;

/// A symmetric 2×2 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Symmetric<T> {
    pub(crate) uu: T,
    pub(crate) uv: T,
    pub(crate) vv: T,
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>> Symmetric<T> {
    #[inline(always)]
    pub(crate) fn determinant(&self) -> T {
        self.uu * self.vv - self.uv * self.uv
    }

    /// The square of this matrix.
    #[inline(always)]
    pub(crate) fn square(&self) -> Self {
        Self {
            uu: self.uu * self.uu + self.uv * self.uv,
            vv: self.uv * self.uv + self.vv * self.vv,
            uv: self.uv * (self.uu + self.vv),
        }
    }

    /// Product of its entries `(uu, vv, uv)` with a vector.
    #[inline(always)]
    pub(crate) fn dot(&self, v: &[T; 3]) -> T {
        self.uu * v[0] + self.vv * v[1] + self.uv * v[2]
    }

    /// Adds `weight` times `other`.
    pub(crate) fn add(&mut self, other: &Self, weight: T) {
        self.uu = self.uu + weight * other.uu;
        self.uv = self.uv + weight * other.uv;
        self.vv = self.vv + weight * other.vv;
    }
}

impl Symmetric<f64> {
    pub(crate) fn matrix(&self) -> Matrix2<f64> {
        Matrix2::new(self.uu, self.uv, self.uv, self.vv)
    }
}

impl Symmetric<Lanes> {
    /// The matrix of the first set of readings.
    #[inline]
    pub(crate) fn first(&self) -> Symmetric<f64> {
        let [uu, uv, vv] = [self.uu, self.uv, self.vv].map(first);
        Symmetric { uu, uv, vv }
    }
}

/// A symmetric 3×3 matrix: its diagonal, and the entries (1,2), (1,3), (2,3).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Symmetric3 {
    diagonal: [Lanes; 3],
    beside: [Lanes; 3],
}

impl Symmetric3 {
    /// The same matrix in every lane.
    pub(crate) fn of(matrix: &Matrix3<f64>) -> Self {
        let mean = |(i, j)| Lanes::splat(0.5 * (matrix[(i, j)] + matrix[(j, i)]));
        Self {
            diagonal: [(0, 0), (1, 1), (2, 2)].map(mean),
            beside: [(0, 1), (0, 2), (1, 2)].map(mean),
        }
    }

    /// This matrix times the vector `(uu, vv, uv)`.
    #[inline(always)]
    pub(crate) fn times(&self, v: &[Lanes; 3]) -> Symmetric<Lanes> {
        let (d, b) = (&self.diagonal, &self.beside);
        Symmetric {
            uu: d[0] * v[0] + b[0] * v[1] + b[1] * v[2],
            vv: b[0] * v[0] + d[1] * v[1] + b[2] * v[2],
            uv: b[1] * v[0] + b[2] * v[1] + d[2] * v[2],
        }
    }

    /// This plus the `parts`, weighted by `uu`, `vv`, `uv`.
    #[inline(always)]
    pub(crate) fn plus(&self, parts: &[Self; 3], weights: &Symmetric<Lanes>) -> Self {
        let [uu, vv, uv] = parts;
        let sum = |own: &[Lanes; 3], part: fn(&Self) -> &[Lanes; 3]| {
            std::array::from_fn(|i| {
                own[i]
                    + part(uu)[i] * weights.uu
                    + part(vv)[i] * weights.vv
                    + part(uv)[i] * weights.uv
            })
        };
        Self {
            diagonal: sum(&self.diagonal, |part| &part.diagonal),
            beside: sum(&self.beside, |part| &part.beside),
        }
    }
}
