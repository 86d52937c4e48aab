//! Small symmetric matrices.

use nalgebra::{Matrix2, Matrix3};

use crate::Number;

/// A symmetric 2×2 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Symmetric<N> {
    pub(crate) uu: N,
    pub(crate) uv: N,
    pub(crate) vv: N,
}

impl<N: Number> Symmetric<N> {
    #[inline(always)]
    pub(crate) fn determinant(&self) -> N {
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
    pub(crate) fn dot(&self, v: &[N; 3]) -> N {
        self.uu * v[0] + self.vv * v[1] + self.uv * v[2]
    }

    /// Adds `weight` times `other`.
    pub(crate) fn add(&mut self, other: &Self, weight: N) {
        self.uu += weight * other.uu;
        self.uv += weight * other.uv;
        self.vv += weight * other.vv;
    }
}

impl Symmetric<f64> {
    pub(crate) fn matrix(&self) -> Matrix2<f64> {
        Matrix2::new(self.uu, self.uv, self.uv, self.vv)
    }
}

/// A symmetric 3×3 matrix: its diagonal, and the entries (1,2), (1,3), (2,3).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Symmetric3<N = f64> {
    diagonal: [N; 3],
    beside: [N; 3],
}

impl Symmetric3 {
    pub(crate) fn of(matrix: &Matrix3<f64>) -> Self {
        let mean = |(i, j)| 0.5 * (matrix[(i, j)] + matrix[(j, i)]);
        Self {
            diagonal: [(0, 0), (1, 1), (2, 2)].map(mean),
            beside: [(0, 1), (0, 2), (1, 2)].map(mean),
        }
    }

    /// This matrix, in every lane.
    #[inline(always)]
    pub(crate) fn spread<N: Number>(&self) -> Symmetric3<N> {
        Symmetric3 {
            diagonal: self.diagonal.map(N::of),
            beside: self.beside.map(N::of),
        }
    }

    /// This plus the `parts`, weighted by `uu`, `vv`, `uv`.
    #[inline(always)]
    pub(crate) fn plus<N: Number>(
        &self,
        parts: &[Self; 3],
        weights: &Symmetric<N>,
    ) -> Symmetric3<N> {
        let own = self.spread::<N>();
        let [uu, vv, uv] = parts.each_ref().map(Self::spread::<N>);
        let sum = |own: [N; 3], uu: [N; 3], vv: [N; 3], uv: [N; 3]| {
            let entry =
                |i: usize| own[i] + uu[i] * weights.uu + vv[i] * weights.vv + uv[i] * weights.uv;
            [entry(0), entry(1), entry(2)]
        };
        Symmetric3 {
            diagonal: sum(own.diagonal, uu.diagonal, vv.diagonal, uv.diagonal),
            beside: sum(own.beside, uu.beside, vv.beside, uv.beside),
        }
    }
}

impl<N: Number> Symmetric3<N> {
    /// This matrix times the vector `(uu, vv, uv)`.
    #[inline(always)]
    pub(crate) fn times(&self, v: &[N; 3]) -> Symmetric<N> {
        let (d, b) = (&self.diagonal, &self.beside);
        Symmetric {
            uu: d[0] * v[0] + b[0] * v[1] + b[1] * v[2],
            vv: b[0] * v[0] + d[1] * v[1] + b[2] * v[2],
            uv: b[1] * v[0] + b[2] * v[1] + d[2] * v[2],
        }
    }
}
