//! The interface that all surfaces implement.

use nalgebra::{Point3, Vector2, Vector3};

use crate::{
    ChartGeometry, ChartJet, CurvatureForm, LevelSet, Meridian, Parameters, SurfaceError,
    TangentForm,
};

/// The boundary of a solid. It is smooth, and its normal points out of the solid.
///
/// Points are in the surface's own frame. Graph surfaces lie at z = f(x, y) with the solid below;
/// closed surfaces are centred on the origin; a dish is the inside of a sphere.
///
/// For well-conditioned shapes and points, the relative errors of results are at most 1e-14. Errors of curvature forms
/// are relative to the larger principal curvature, and errors of torsions to the torsion. Errors of heights and points
/// are relative to the object's size. Errors are larger in four cases: for heights near a rim, where `R² − x²` cancels;
/// for a Gaussian curvature far below the square of the mean curvature; for the closest point from inside a hollow; and
/// at places whose coordinates are large compared with the details of the surface.
///
/// ```
/// use nalgebra::Vector3;
/// use palpate_geometry::{Sphere, Surface};
///
/// let sphere = Sphere::new(3.0)?;
/// let top = sphere.contact_at(0.0, 0.0)?;
/// let (normal, form) = sphere.curvature_along(&top, &Vector3::x())?;
/// assert!((normal - Vector3::z()).norm() < 1e-15);
/// assert!((form.k_uu - 1.0 / 3.0).abs() < 1e-15);
/// assert!((form.gaussian_curvature() - 1.0 / 9.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Surface {
    /// Whether the surface is a graph z = f(x, y). On a graph, x and y determine one point.
    const IS_GRAPH: bool = false;

    /// The point of the chart with the parameters `at`, and its derivatives.
    ///
    /// # Errors
    /// [`SurfaceError::OffDomain`] where the surface is not defined; [`SurfaceError::ChartSingular`] if the parameters
    /// are not finite, or if they are beyond a pole of the chart.
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError>;

    /// Normal and curvature at a point on (or very near) the surface, without a chart.
    ///
    /// # Errors
    /// [`SurfaceError::OffDomain`] where the surface is not defined or has no normal.
    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError>;

    /// Normal and second fundamental form at a point on the surface. `x` must be a unit tangent. The result is
    /// meaningless if the point is not on the surface. Integrators call this function at every stage, so a surface
    /// overrides it if it can compute the result without the complete level set.
    ///
    /// # Errors
    /// Errors of [`Surface::level_set`].
    #[inline]
    fn tangent_form(
        &self,
        point: &Point3<f64>,
        x: &Vector3<f64>,
    ) -> Result<TangentForm, SurfaceError> {
        let level_set = self.level_set(point)?;
        let y = x.cross(&level_set.normal);
        let curvature = level_set.curvature(x, &y);
        Ok(TangentForm::of_unit_normal(level_set.normal, curvature))
    }

    /// Unit normal `n` at a point on the surface, and the curvature form in the tangent basis `(x, x × n)`. `x` must be
    /// a unit tangent.
    ///
    /// # Errors
    /// Errors of [`Surface::level_set`].
    fn curvature_along(
        &self,
        point: &Point3<f64>,
        x: &Vector3<f64>,
    ) -> Result<(Vector3<f64>, CurvatureForm), SurfaceError> {
        let form = self.tangent_form(point, x)?;
        let (normal, curvature) = (form.normal(), form.curvature());
        let CurvatureForm { k_uu, k_uv, k_vv } = curvature;
        if (normal.sum() + k_uu + k_uv + k_vv).is_finite() {
            Ok((normal, curvature))
        } else {
            Err(SurfaceError::off_domain(point))
        }
    }

    /// The chart parameters of a point on (or very near) the surface, so that `chart` maps them to the point. The
    /// parameters are meaningless if the point is not finite.
    fn parameters(&self, point: &Point3<f64>) -> Parameters;

    /// The point of the surface closest to `point`.
    ///
    /// On a graph surface, an iteration (a descent) minimises the distance. It starts at the surface point with the
    /// same x and y as `point`. It finds the closest point if this point is unique and its distance from `point` is
    /// smaller than the radius of curvature there.
    ///
    /// # Errors
    /// [`SurfaceError::NoClosestPoint`] where several points are equally close, or if `point` is not finite;
    /// [`SurfaceError::OffDomain`] where the graph has no point at which the descent can start.
    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError>;

    /// On a graph, the point at which the iteration of [`Surface::closest_point`] ends if it begins at the x and y of
    /// `_start`. This point may differ from the result of [`Surface::closest_point`]. On other surfaces, the result of
    /// [`Surface::closest_point`].
    ///
    /// # Errors
    /// Errors of [`Surface::closest_point`].
    fn closest_point_from(
        &self,
        point: &Point3<f64>,
        _start: Vector2<f64>,
    ) -> Result<Point3<f64>, SurfaceError> {
        self.closest_point(point)
    }

    /// Whether a ball of `radius` that touches the solid from outside may penetrate it at another place. The ball must
    /// fit at the contact point: if the solid is concave there, its radius of curvature must exceed the radius of the
    /// ball.
    fn may_touch_twice(&self, _radius: f64) -> bool {
        false
    }

    /// The point at `(x, y)` that a probe touches from outside of the solid. On a graph, there is only one point. On a
    /// closed surface, it is the point on the upper half. On a dish, it is the point on the lower half of the sphere,
    /// because the probe touches the sphere from inside.
    ///
    /// # Errors
    /// [`SurfaceError::OffDomain`] if the surface has no point at `(x, y)`, or if `x` or `y` is not finite.
    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError>;

    /// Default `(x, y)` of the contact with which a simulation starts, in the surface's frame: the origin of the frame,
    /// or the top of the object.
    fn default_contact(&self) -> (f64, f64) {
        (0.0, 0.0)
    }

    /// Gauss frame and fundamental forms of the chart at the parameters `at`.
    ///
    /// # Errors
    /// Errors of [`Surface::chart`], and [`SurfaceError::ChartSingular`] at a pole of the chart.
    fn chart_geometry(&self, at: Parameters) -> Result<ChartGeometry, SurfaceError> {
        self.chart(at)?.geometry(at)
    }

    /// The section of the surface in the plane through the apex that contains the normal and `_direction`, a unit
    /// tangent at the apex. `None` if the surface is not symmetric about this plane, or if no variant of [`Meridian`]
    /// describes the section.
    fn meridian(&self, _apex: &Point3<f64>, _direction: &Vector3<f64>) -> Option<Meridian> {
        None
    }

    /// Whether the shape operator is constant along every geodesic in a parallel-transported basis. This is true for
    /// planes, spheres and cylinders; on these surfaces, a probe rolls along geodesics.
    fn is_homogeneous(&self) -> bool {
        self.constant_curvature().is_some()
    }

    /// The curvature form in a basis of principal directions, if it is the same at all points, as on planes, spheres
    /// and cylinders. Unlike the curvature at a point, it has no rounding error from the coordinates of the point.
    fn constant_curvature(&self) -> Option<CurvatureForm> {
        None
    }
}
