//! Fundamental forms of a surface from the derivatives of its chart.
//!
//! The Gauss frame has the axes `x = f_u/|f_u|`, `y` perpendicular to `x` in the tangent plane, and `z = x × y = n`.
//! Indices u and v denote derivatives with respect to the chart's parameters. With `E = [x y]`, `J = [f_u f_v]`, `N =
//! [n_u n_v]`, `X = [x_u x_v]`, the forms are (Montana 1988; also valid for charts that are not orthogonal):
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
    /// First parameter of the chart.
    pub u: f64,
    /// Second parameter of the chart.
    pub v: f64,
}

impl Parameters {
    /// The parameters `(u, v)`.
    pub const fn new(u: f64, v: f64) -> Self {
        Self { u, v }
    }

    /// Checks that the latitude `u` is between the poles of a chart, `u = ±π/2`. Beyond the poles, the chart would
    /// cover the surface a second time, and the normal of the chart would point inwards.
    pub(crate) fn unless_beyond_pole(self) -> Result<Self, SurfaceError> {
        let Self { u, v } = self;
        if u.abs() <= FRAC_PI_2 && is_within_reach(u, v) {
            Ok(self)
        } else {
            Err(SurfaceError::ChartSingular { u, v })
        }
    }

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
    /// The point `f(u, v)` of the surface.
    pub point: Point3<f64>,
    /// First derivative `∂f/∂u` of the point.
    pub du: Vector3<f64>,
    /// First derivative `∂f/∂v` of the point.
    pub dv: Vector3<f64>,
    /// Second derivative `∂²f/∂u²` of the point.
    pub duu: Vector3<f64>,
    /// Mixed derivative `∂²f/∂u∂v` of the point.
    pub duv: Vector3<f64>,
    /// Second derivative `∂²f/∂v²` of the point.
    pub dvv: Vector3<f64>,
}

/// Gauss frame, metric, curvature form and torsion form at one point of a chart. The Gauss frame is orthonormal and
/// right-handed; it consists of two tangents and the outward normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartGeometry {
    /// The point of the surface.
    pub point: Point3<f64>,
    /// Unit tangent along `∂f/∂u`, the x axis of the Gauss frame.
    pub x_axis: Vector3<f64>,
    /// Unit tangent `normal × x_axis`, the y axis of the Gauss frame.
    pub y_axis: Vector3<f64>,
    /// Unit normal, out of the solid.
    pub normal: Vector3<f64>,
    /// The metric `M`: maps changes of the parameters to tangent components in the Gauss frame. It is upper triangular.
    pub metric: Matrix2<f64>,
    /// The curvature form `K` (1/length) in the Gauss frame. It is positive where the solid is convex.
    pub curvature: CurvatureForm,
    /// The torsion form `T`: rotation of the Gauss frame about its normal per unit length along `x` and along `y`
    /// (1/length).
    pub torsion: RowVector2<f64>,
}

impl ChartJet {
    /// Gauss frame and fundamental forms of the chart at this point.
    ///
    /// # Errors
    /// [`SurfaceError::ChartSingular`] where the tangents vanish or are parallel, or where a result is not finite. This
    /// happens at a pole of the chart, where the surface itself may be regular.
    pub(crate) fn geometry(&self, at: Parameters) -> Result<ChartGeometry, SurfaceError> {
        let singular = SurfaceError::ChartSingular { u: at.u, v: at.v };
        let m11 = self.du.norm();
        let x = self.du / m11;
        let m12 = x.dot(&self.dv);
        // The cross product is accurate for nearly parallel tangents. Gram–Schmidt orthogonalisation would lose digits.
        let across = x.cross(&self.dv);
        let m22 = across.norm();
        let normal = across / m22;
        let y = normal.cross(&x);

        // The chart is singular if the distance to a pole is below the resolution of u, or if the angle between the
        // tangents is below the rounding error.
        let at_pole = m22 <= 4.0 * f64::EPSILON * at.u.abs() * self.duv.norm();
        let parallel = m22 <= 4.0 * f64::EPSILON * m12.abs();
        if at_pole || parallel || !SQUARABLE.contains(&m11) || !SQUARABLE.contains(&m22) {
            return Err(singular);
        }

        // The curvature form is K = −M⁻ᵀ II M⁻¹. Here M is the metric, and II is the second fundamental form. The
        // components of II are n·f_uu, n·f_uv and n·f_vv, with the unit normal n and the chart f.
        let (l, m, n) = (
            normal.dot(&self.duu),
            normal.dot(&self.duv),
            normal.dot(&self.dvv),
        );
        let shear = m12 / m11;
        let k_uu = -l / (m11 * m11);
        let k_uv = -(m - l * shear) / (m11 * m22);
        let k_vv = -(n - 2.0 * m * shear + l * shear * shear) / (m22 * m22);

        // The torsion form T is the rotation of the axis x towards the axis y per unit length along each tangent. With
        // the chart f, the derivatives of this rotation are y·f_uu/|f_u| with respect to u and y·f_uv/|f_u| with
        // respect to v. The inverse of the metric M converts them to rotations per unit length.
        let (t_u, t_v) = (y.dot(&self.duu) / m11, y.dot(&self.duv) / m11);
        let torsion = RowVector2::new(t_u / m11, (t_v - t_u * shear) / m22);

        let geometry = ChartGeometry {
            point: self.point,
            x_axis: x,
            y_axis: y,
            normal,
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
