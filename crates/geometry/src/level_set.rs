//! Normal and curvature from a level set: the form without a chart.

use nalgebra::{Matrix3, Vector3};

use crate::CurvatureForm;
use crate::error::SQUARABLE;

/// Normal and curvature of the level set of a function `F` through a point. `F` grows out of the solid.
///
/// On the tangent plane the shape operator is `Hess F / |∇F|`. It does not depend on a chart, so it has no poles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelSet {
    /// Unit normal `∇F/|∇F|`, out of the solid.
    pub normal: Vector3<f64>,
    /// `Hess F / |∇F|`, symmetric, 1/length. Only its tangential part has a meaning.
    pub second_form: Matrix3<f64>,
}

impl LevelSet {
    /// The level set of a function `F` through a point, from the gradient and Hessian of `F` there.
    ///
    /// Returns `None` where no normal can be computed: if the gradient vanishes or overflows when squared, or if a
    /// number is not finite.
    #[inline]
    pub(crate) fn new(gradient: Vector3<f64>, hessian: Matrix3<f64>) -> Option<Self> {
        let norm = gradient.norm();
        let inverse = 1.0 / norm;
        let level_set = Self {
            normal: gradient * inverse,
            second_form: hessian * inverse,
        };
        // If a term is not finite, the sum is not finite. A sum of finite terms overflows so rarely that the false
        // `None` is harmless.
        let sum = level_set.normal.sum() + level_set.second_form.sum();
        (SQUARABLE.contains(&norm) && sum.is_finite()).then_some(level_set)
    }

    /// The curvature form in the tangent basis `(x, y)`, which must be orthonormal.
    #[inline]
    pub fn curvature(&self, x: &Vector3<f64>, y: &Vector3<f64>) -> CurvatureForm {
        let (along_x, along_y) = (self.second_form * x, self.second_form * y);
        CurvatureForm {
            k_uu: x.dot(&along_x),
            k_uv: y.dot(&along_x),
            k_vv: y.dot(&along_y),
        }
    }

    /// The shape operator as a linear map of space: `dn = S dq` for tangent `dq`, zero along the
    /// normal. Units 1/length.
    pub fn shape_operator(&self) -> Matrix3<f64> {
        // I − n nᵀ, without the cancellation on its diagonal.
        let across = self.normal.cross_matrix();
        let tangential = across.transpose() * across;
        tangential * self.second_form * tangential
    }
}

/// Normal and second form of a level set `F` along one tangent. Normal and basis are not normalised, which saves
/// divisions and roots.
///
/// The basis of the tangent plane is a unit tangent `x` and `y = x × ∇F`, whose length is `|∇F|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentForm {
    /// `∇F`, out of the solid.
    pub gradient: Vector3<f64>,
    /// `|∇F|`.
    pub steepness: f64,
    /// `|∇F|²`.
    pub steepness_squared: f64,
    /// `xᵀ (Hess F) x`.
    pub xx: f64,
    /// `xᵀ (Hess F) y`.
    pub xy: f64,
    /// `yᵀ (Hess F) y`.
    pub yy: f64,
}

impl TangentForm {
    /// The tangent form from a unit normal and the curvature form in the basis `(x, x × normal)`.
    #[inline]
    pub const fn of_unit_normal(normal: Vector3<f64>, curvature: CurvatureForm) -> Self {
        Self {
            gradient: normal,
            steepness: 1.0,
            steepness_squared: 1.0,
            xx: curvature.k_uu,
            xy: curvature.k_uv,
            yy: curvature.k_vv,
        }
    }

    /// Unit normal, out of the solid.
    pub(crate) fn normal(&self) -> Vector3<f64> {
        self.gradient / self.steepness
    }

    /// The curvature form in the orthonormal basis `(x, x × normal)`, 1/length.
    pub fn curvature(&self) -> CurvatureForm {
        CurvatureForm {
            k_uu: self.xx / self.steepness,
            k_uv: self.xy / self.steepness_squared,
            k_vv: self.yy / self.steepness_squared / self.steepness,
        }
    }
}
