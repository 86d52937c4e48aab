//! Fundamental forms of a surface from the derivatives of its chart.
//!
//! With the Gauss frame `x = f_u/|f_u|`, `y` perpendicular to it in the tangent plane and
//! `z = x × y = n`, and with `E = [x y]`, `J = [f_u f_v]`, `N = [n_u n_v]`, `X = [x_u x_v]`
//! (Montana 1988, stated for charts that need not be orthogonal):
//!
//! ```text
//! metric     M = Eᵀ J          upper triangular, diagonal for an orthogonal chart
//! curvature  K = Eᵀ N M⁻¹      symmetric
//! torsion    T = yᵀ X M⁻¹
//! ```

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix2, Point3, RowVector2, Vector3};

use crate::error::{SQUARABLE, is_within_reach};
use crate::{CurvatureForm, SurfaceError};

/// The two parameters of a chart, in the chart's own units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// First parameter.
    pub u: f64,
    /// Second parameter.
    pub v: f64,
}

impl Parameters {
    /// The parameters `(u, v)`.
    pub const fn new(u: f64, v: f64) -> Self {
        Self { u, v }
    }

    /// Checks that latitude `u` lies between the poles of a chart, `u = ±π/2`. Beyond the poles the chart would cover
    /// the surface a second time, with its normal inwards.
    pub(crate) fn unless_beyond_pole(self) -> Result<Self, SurfaceError> {
        let Self { u, v } = self;
        if u.abs() <= FRAC_PI_2 && is_within_reach(u, v) {
            Ok(self)
        } else {
            Err(SurfaceError::ChartSingular { u, v })
        }
    }

    /// Rejects parameters that are not finite or exceed 1e150.
    pub(crate) fn unless_out_of_reach(self) -> Result<Self, SurfaceError> {
        let Self { u, v } = self;
        if is_within_reach(u, v) {
            Ok(self)
        } else {
            Err(SurfaceError::ChartSingular { u, v })
        }
    }
}

/// A point of a chart with its first and second derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartJet {
    /// `f(u, v)`.
    pub point: Point3<f64>,
    /// `∂f/∂u`.
    pub du: Vector3<f64>,
    /// `∂f/∂v`.
    pub dv: Vector3<f64>,
    /// `∂²f/∂u²`.
    pub duu: Vector3<f64>,
    /// `∂²f/∂u∂v`.
    pub duv: Vector3<f64>,
    /// `∂²f/∂v²`.
    pub dvv: Vector3<f64>,
}

/// The orthonormal, right-handed Gauss frame of a chart: two tangents and the outward normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussFrame {
    /// Unit tangent along `∂f/∂u`.
    pub x: Vector3<f64>,
    /// Unit tangent `n × x`.
    pub y: Vector3<f64>,
    /// Unit normal, out of the solid.
    pub normal: Vector3<f64>,
}

/// Gauss frame, metric, curvature form and torsion form at one point of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartGeometry {
    /// The point.
    pub point: Point3<f64>,
    /// Its Gauss frame.
    pub frame: GaussFrame,
    /// `M`: tangent components in the Gauss frame per change of the parameters. Upper triangular.
    pub metric: Matrix2<f64>,
    /// `K`: the curvature form in the Gauss frame, 1/length, convex positive.
    pub curvature: CurvatureForm,
    /// `T`: turn of the Gauss frame about its normal per length along `x` and along `y`, 1/length.
    pub torsion: RowVector2<f64>,
}

impl ChartJet {
    /// Frame and forms at this point.
    ///
    /// # Errors
    /// [`SurfaceError::ChartSingular`] where the tangents vanish or are parallel (at a pole of the chart, not
    /// necessarily of the surface), or where a result is not finite.
    pub(crate) fn geometry(&self, at: Parameters) -> Result<ChartGeometry, SurfaceError> {
        let singular = SurfaceError::ChartSingular { u: at.u, v: at.v };
        let m11 = self.du.norm();
        let x = self.du / m11;
        let m12 = x.dot(&self.dv);
        // The cross product keeps digits that Gram–Schmidt loses if the tangents are nearly parallel.
        let across = x.cross(&self.dv);
        let m22 = across.norm();
        let normal = across / m22;
        let y = normal.cross(&x);

        // Two cases are singular: the place is nearer to a pole than u resolves, or rounding hides the angle of the
        // tangents.
        let at_pole = m22 <= 4.0 * f64::EPSILON * at.u.abs() * self.duv.norm();
        let parallel = m22 <= 4.0 * f64::EPSILON * m12.abs();
        if at_pole || parallel || !SQUARABLE.contains(&m11) || !SQUARABLE.contains(&m22) {
            return Err(singular);
        }

        // K = −M⁻ᵀ II M⁻¹ with II the second form n·f_ij.
        let (l, m, n) = (
            normal.dot(&self.duu),
            normal.dot(&self.duv),
            normal.dot(&self.dvv),
        );
        let shear = m12 / m11;
        let k_uu = -l / (m11 * m11);
        let k_uv = -(m - l * shear) / (m11 * m22);
        let k_vv = -(n - 2.0 * m * shear + l * shear * shear) / (m22 * m22);

        // yᵀ x_u = y·f_uu/|f_u| and likewise for v; then times M⁻¹.
        let (t_u, t_v) = (y.dot(&self.duu) / m11, y.dot(&self.duv) / m11);
        let torsion = RowVector2::new(t_u / m11, (t_v - t_u * shear) / m22);

        let geometry = ChartGeometry {
            point: self.point,
            frame: GaussFrame { x, y, normal },
            metric: Matrix2::new(m11, m12, 0.0, m22),
            curvature: CurvatureForm { k_uu, k_uv, k_vv },
            torsion,
        };
        let finite = [m11, m12, m22, k_uu, k_uv, k_vv, torsion[0], torsion[1]]
            .iter()
            .all(|value| value.is_finite());
        if finite { Ok(geometry) } else { Err(singular) }
    }
}
