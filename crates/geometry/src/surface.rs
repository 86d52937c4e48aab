//! The interface of all surfaces.

use nalgebra::{Point3, Vector2, Vector3};

use crate::{
    ChartGeometry, ChartJet, CurvatureForm, LevelSet, Meridian, Parameters, SurfaceError,
    TangentForm,
};

/// The boundary of a solid: smooth, with its normal out of the solid.
///
/// Points are in the surface's own frame. Graph surfaces lie at z = f(x, y) with the solid below;
/// closed surfaces are centred on the origin; a dish is the inside of a sphere.
///
/// For well-conditioned numbers, errors are at most 1e-14: of forms relative to the larger principal curvature there,
/// of torsions relative to the torsion, of normals, and of heights and points relative to the object's size. Errors are
/// larger for heights near a rim (where `R² − x²` cancels), for a Gaussian curvature far below H², for the closest
/// point from inside a hollow, and at a place that its coordinates barely resolve.
///
/// ```
/// use nalgebra::Vector3;
/// use palpate_geometry::{Surface, surfaces::Sphere};
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
    /// Whether the surface is a graph z = f(x, y), so that x and y determine a point on it.
    const IS_GRAPH: bool = false;

    /// The chart's point and derivatives at `at`.
    ///
    /// # Errors
    /// [`SurfaceError::OffDomain`] where the surface is not defined;
    /// [`SurfaceError::ChartSingular`] where the chart does not reach: parameters that are not
    /// finite, or beyond a pole.
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError>;

    /// Normal and curvature at a point on (or very near) the surface, without a chart.
    ///
    /// # Errors
    /// [`SurfaceError::OffDomain`] where the surface is not defined or has no normal.
    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError>;

    /// Normal and second form along `x`, which must be a unit tangent, at a point on the surface. The result is
    /// meaningless off the surface. Integrators call this function at every stage, so a surface overrides it if it can
    /// avoid the whole level set.
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

    /// Unit normal `n`, and the curvature form in the tangent basis `(x, x × n)`, at a point on the
    /// surface; `x` must be a unit tangent.
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
            Err(SurfaceError::OffDomain {
                x: point.x,
                y: point.y,
            })
        }
    }

    /// The chart parameters of a point on (or very near) the surface: `chart` maps them to the point. They are
    /// meaningless if the point is not finite.
    fn parameters(&self, point: &Point3<f64>) -> Parameters;

    /// The point of the surface closest to `point`.
    ///
    /// Graph surfaces descend from the vertical projection. The result is the closest point wherever the closest point
    /// is unique within the radius of curvature.
    ///
    /// # Errors
    /// [`SurfaceError::NoClosestPoint`] where several points are equally close, or if `point` is not finite;
    /// [`SurfaceError::OffDomain`] where a graph's descent cannot start.
    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError>;

    /// On a graph, the point that descent from this `(x, y)` reaches, which may differ from [`Surface::closest_point`].
    /// On other surfaces, the same point as [`Surface::closest_point`].
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

    /// Whether a ball of `radius` that touches the solid from outside may penetrate it elsewhere, even if the ball fits
    /// at the contact (is more convex than the solid is concave there).
    fn may_touch_twice(&self, _radius: f64) -> bool {
        false
    }

    /// The point at `(x, y)` that a probe touches from outside of the solid: on the graph, on the upper half of a
    /// closed surface, on the lower half of a dish.
    ///
    /// # Errors
    /// [`SurfaceError::OffDomain`] if the surface has no point at `(x, y)`, or if `x` or `y` is not finite.
    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError>;

    /// Default position of the first contact, `(x, y)` in the surface's frame: the origin or the top.
    fn default_contact(&self) -> (f64, f64) {
        (0.0, 0.0)
    }

    /// Frame and forms of the chart at `at`.
    ///
    /// # Errors
    /// Errors of [`Surface::chart`], and [`SurfaceError::ChartSingular`] at a pole of the chart.
    fn chart_geometry(&self, at: Parameters) -> Result<ChartGeometry, SurfaceError> {
        self.chart(at)?.geometry(at)
    }

    /// The section of the surface through the given apex in the plane of `_direction` (a unit tangent there), if the
    /// surface is symmetric about that plane and [`Meridian`] has the section's form.
    fn meridian(&self, _apex: &Point3<f64>, _direction: &Vector3<f64>) -> Option<Meridian> {
        None
    }

    /// Whether the shape operator is constant along every geodesic in a parallel-transported basis: true for planes,
    /// spheres and cylinders. A probe then rolls along geodesics.
    fn is_homogeneous(&self) -> bool {
        self.constant_curvature().is_some()
    }

    /// The curvature form, in a basis of principal directions, if it is the same at all points: on planes, spheres and
    /// cylinders. It is exact, because it is not computed from a point.
    fn constant_curvature(&self) -> Option<CurvatureForm> {
        None
    }
}
