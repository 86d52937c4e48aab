//! Small symmetric matrices.

use nalgebra::{Matrix2, Matrix3, SMatrix, Vector3};

/// The rotation vectors of the probes count as parallel if the ratio of their spread across their main axis to their
/// spread along this axis is below this value.
pub(crate) const SMALLEST_SPREAD: f64 = 1e-6;

/// A symmetric 2×2 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Symmetric {
    pub(crate) uu: f64,
    pub(crate) uv: f64,
    pub(crate) vv: f64,
}

impl Symmetric {
    #[inline(always)]
    pub(crate) fn determinant(&self) -> f64 {
        self.uu * self.vv - self.uv * self.uv
    }

    /// The smaller eigenvalue of this matrix.
    pub(crate) fn least(&self) -> f64 {
        let half = 0.5 * (self.uu - self.vv);
        0.5 * (self.uu + self.vv) - libm::hypot(half, self.uv)
    }

    /// The product of this matrix with itself.
    #[inline(always)]
    pub(crate) fn square(&self) -> Self {
        Self {
            uu: self.uu * self.uu + self.uv * self.uv,
            vv: self.uv * self.uv + self.vv * self.vv,
            uv: self.uv * (self.uu + self.vv),
        }
    }

    /// Returns `uu * v[0] + vv * v[1] + uv * v[2]`, where `uu`, `vv` and `uv` are the entries of the matrix.
    #[inline(always)]
    pub(crate) fn dot(&self, v: &[f64; 3]) -> f64 {
        self.uu * v[0] + self.vv * v[1] + self.uv * v[2]
    }

    /// Returns the vector `own + self.uu * uu + self.vv * vv + self.uv * uv`.
    #[inline(always)]
    fn sum(&self, own: &[f64; 3], uu: &[f64; 3], vv: &[f64; 3], uv: &[f64; 3]) -> [f64; 3] {
        [
            own[0] + uu[0] * self.uu + vv[0] * self.vv + uv[0] * self.uv,
            own[1] + uu[1] * self.uu + vv[1] * self.vv + uv[1] * self.uv,
            own[2] + uu[2] * self.uu + vv[2] * self.vv + uv[2] * self.uv,
        ]
    }

    /// Adds the matrix `other`, multiplied by `weight`, to this matrix.
    pub(crate) fn add(&mut self, other: &Self, weight: f64) {
        self.uu += weight * other.uu;
        self.uv += weight * other.uv;
        self.vv += weight * other.vv;
    }

    pub(crate) fn matrix(&self) -> Matrix2<f64> {
        Matrix2::new(self.uu, self.uv, self.uv, self.vv)
    }
}

/// A symmetric 3×3 matrix, stored as its diagonal and the entries (1,2), (1,3), (2,3).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Symmetric3 {
    diagonal: [f64; 3],
    beside: [f64; 3],
}

impl Symmetric3 {
    pub(crate) fn of(matrix: &Matrix3<f64>) -> Self {
        let mean = |(i, j)| 0.5 * (matrix[(i, j)] + matrix[(j, i)]);
        Self {
            diagonal: [(0, 0), (1, 1), (2, 2)].map(mean),
            beside: [(0, 1), (0, 2), (1, 2)].map(mean),
        }
    }

    /// Returns the matrix `self + weights.uu * uu + weights.vv * vv + weights.uv * uv`.
    #[inline(always)]
    pub(crate) fn plus(&self, [uu, vv, uv]: &[Self; 3], weights: &Symmetric) -> Self {
        Self {
            diagonal: weights.sum(&self.diagonal, &uu.diagonal, &vv.diagonal, &uv.diagonal),
            beside: weights.sum(&self.beside, &uu.beside, &vv.beside, &uv.beside),
        }
    }

    /// This matrix, with `by` added to each diagonal entry.
    #[inline(always)]
    pub(crate) fn with_diagonal(self, by: f64) -> Self {
        let [d1, d2, d3] = self.diagonal;
        Self {
            diagonal: [d1 + by, d2 + by, d3 + by],
            ..self
        }
    }

    #[inline(always)]
    pub(crate) fn rows(&self) -> [[f64; 3]; 3] {
        let ([d1, d2, d3], [b1, b2, b3]) = (self.diagonal, self.beside);
        [[d1, b1, b2], [b1, d2, b3], [b2, b3, d3]]
    }

    /// The product of this matrix and the vector `v`, whose components are the entries `uu`, `vv`, `uv` of a matrix.
    #[inline(always)]
    pub(crate) fn times(&self, v: &[f64; 3]) -> Symmetric {
        let (d, b) = (&self.diagonal, &self.beside);
        Symmetric {
            uu: d[0] * v[0] + b[0] * v[1] + b[1] * v[2],
            vv: b[0] * v[0] + d[1] * v[1] + b[2] * v[2],
            uv: b[1] * v[0] + b[2] * v[1] + d[2] * v[2],
        }
    }
}

/// Whether a contact with this mobility (travel per radian) rolls, that is, whether the matrix is positive definite.
/// The matrix may also be the inverse of a mobility.
pub(crate) fn is_rolling(mobility: &Matrix2<f64>) -> bool {
    mobility.determinant() > 0.0 && mobility.trace() > 0.0
}

/// The symmetric matrix with the entries uu, uv, vv.
pub(crate) fn matrix(entries: &Vector3<f64>) -> Matrix2<f64> {
    Matrix2::new(entries.x, entries.y, entries.y, entries.z)
}

/// Derivatives of the entries uu, uv, vv of the inverse of a mobility (contact travel per radian) with respect to the
/// entries of the mobility. `relative` is this inverse.
pub(crate) fn inverse_slopes(relative: &Matrix2<f64>) -> Matrix3<f64> {
    let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|unit| {
        let change = -(relative * matrix(&unit) * relative);
        Vector3::new(change[(0, 0)], change[(0, 1)], change[(1, 1)])
    });
    Matrix3::from_columns(&columns)
}

/// Largest standard deviation of the entries of a mobility (contact travel per radian), relative to the smallest
/// mobility in any direction.
pub(crate) fn largest_spread(mobility: &Matrix2<f64>, covariance: &Matrix3<f64>) -> f64 {
    let half = 0.5 * (mobility[(0, 0)] - mobility[(1, 1)]);
    let least = 0.5 * mobility.trace() - libm::hypot(half, mobility[(0, 1)]);
    let largest = covariance.diagonal().max().max(0.0).sqrt();
    match least > 0.0 {
        true => largest / least,
        false => f64::INFINITY,
    }
}

/// Inverse of a matrix of normal equations, scaled by its diagonal. `None` if the matrix is singular within rounding
/// errors.
pub(crate) fn inverse_of<const N: usize>(
    information: &SMatrix<f64, N, N>,
) -> Option<SMatrix<f64, N, N>> {
    let scale = information.diagonal().map(|entry| 1.0 / entry.sqrt());
    let scaled = SMatrix::<f64, N, N>::from_fn(|row, column| {
        information[(row, column)] * scale[row] * scale[column]
    });
    let root = scaled.cholesky()?;
    if root.l_dirty().diagonal().min() < 1e-6 {
        return None;
    }
    let inverse = root.inverse();
    Some(SMatrix::from_fn(|row, column| {
        inverse[(row, column)] * scale[row] * scale[column]
    }))
}
