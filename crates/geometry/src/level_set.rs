//! Normal and curvature of a surface from a level set, without a chart.

use nalgebra::{Matrix3, Vector3};

use crate::CurvatureForm;
use crate::error::SQUARABLE;

/// Normal and curvature of the level set of a function `F` through a point. `F` increases towards the outside of the
/// solid.
///
/// On the tangent plane the shape operator is `Hess F / |∇F|`. It does not depend on a chart, so it has no poles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelSet {
    /// Unit normal `∇F/|∇F|`, out of the solid.
    pub normal: Vector3<f64>,
    /// Hessian of the function F divided by the length of its gradient, `Hess F / |∇F|` (1/length). It is symmetric.
    /// Only its components along the tangent plane have a meaning.
    pub second_form: Matrix3<f64>,
}

impl LevelSet {
    /// The level set of a function `F` through a point, from the gradient and Hessian of `F` there.
    ///
    /// Returns `None` if no normal can be computed: the gradient vanishes, its square overflows or underflows, or a
    /// number is not finite.
    #[inline]
    pub(crate) fn new(gradient: Vector3<f64>, hessian: Matrix3<f64>) -> Option<Self> {
        let norm = gradient.norm();
        let inverse = 1.0 / norm;
        let level_set = Self {
            normal: gradient * inverse,
            second_form: hessian * inverse,
        };
        // Check only the sum of all components, because it is not finite if a component is not finite. In rare cases, a
        // sum of finite components overflows. The result is then `None` although a normal exists; this is harmless.
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
}

/// Normal and second fundamental form of the level set of a function `F`, in a basis with a given tangent. To save
/// divisions and square roots, the normal and the second tangent are not scaled to length 1.
///
/// The basis of the tangent plane is a unit tangent `x` and `y = x × ∇F`, whose length is `|∇F|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentForm {
    /// Gradient `∇F` of the level-set function, which points out of the solid.
    pub gradient: Vector3<f64>,
    /// Length `|∇F|` of the gradient of the level-set function.
    pub steepness: f64,
    /// Square `|∇F|²` of the length of the gradient.
    pub steepness_squared: f64,
    /// Component `xᵀ (Hess F) x` of the Hessian along the tangent x.
    pub xx: f64,
    /// Mixed component `xᵀ (Hess F) y` of the Hessian.
    pub xy: f64,
    /// Component `yᵀ (Hess F) y` of the Hessian along the tangent y.
    pub yy: f64,
}

impl TangentForm {
    /// The tangent form with the unit normal `normal` as gradient. `curvature` is the curvature form in the basis
    /// `(x, x × normal)`.
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

    pub(crate) fn normal(&self) -> Vector3<f64> {
        self.gradient / self.steepness
    }

    /// The curvature form in the orthonormal basis `(x, x × normal)` (1/length).
    pub fn curvature(&self) -> CurvatureForm {
        CurvatureForm {
            k_uu: self.xx / self.steepness,
            k_uv: self.xy / self.steepness_squared,
            k_vv: self.yy / self.steepness_squared / self.steepness,
        }
    }
}
