//! Spheres, touched from outside, and dishes, touched from inside.

use nalgebra::{Matrix3, Point3, Vector3};
use palpate_statistics::BadSetting;

use crate::error::{SQUARABLE, checked_length};
use crate::{ChartJet, CurvatureForm, LevelSet, Parameters, Surface, SurfaceError, TangentForm};

/// A sphere about the origin that is touched from one side: a [`Sphere`] if `SIDE` is 1, a [`Dish`] if it is −1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball<const SIDE: i8> {
    radius: f64,
}

/// A sphere about the origin.
///
/// Chart `(R sin u, R cos u sin v, R cos u cos v)` with |u| ≤ π/2: `u = v = 0` is the top, where the Gauss frame equals
/// the axes. The poles of the chart lie on the x axis. The metric is `M = diag(R, R cos u)`, the curvature form
/// `K = I/R` and the torsion form `T = [0, −tan(u)/R]`.
pub type Sphere = Ball<1>;

/// The inside of a sphere about the origin. A probe touches its lower half. The curvature is negative.
///
/// Chart `(R sin u, R cos u sin v, −R cos u cos v)` with |u| ≤ π/2: `u = v = 0` is the bottom, where
/// the Gauss frame equals the axes.
pub type Dish = Ball<-1>;

impl<const SIDE: i8> Ball<SIDE> {
    const SIDE_F64: f64 = SIDE as f64;

    /// A sphere or a dish of `radius`.
    ///
    /// # Errors
    /// [`BadSetting`] unless the radius is between 1e-150 and 1e150.
    pub fn new(radius: f64) -> Result<Self, BadSetting> {
        let radius = checked_length("radius", radius)?;
        Ok(Self { radius })
    }

    /// Radius of the sphere or the dish.
    pub const fn radius(&self) -> f64 {
        self.radius
    }
}

impl<const SIDE: i8> Surface for Ball<SIDE> {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        let at = at.unless_beyond_pole()?;
        let (radius, side) = (self.radius, Self::SIDE_F64);
        let (sin_u, cos_u) = libm::sincos(at.u);
        let (sin_v, cos_v) = libm::sincos(at.v);
        let around = Vector3::new(0.0, sin_v, side * cos_v);
        let around_dv = Vector3::new(0.0, cos_v, -side * sin_v);
        let outward = Vector3::x() * sin_u + around * cos_u;
        Ok(ChartJet {
            point: Point3::from(outward * radius),
            du: (Vector3::x() * cos_u - around * sin_u) * radius,
            dv: around_dv * (cos_u * radius),
            duu: -outward * radius,
            duv: around_dv * (-sin_u * radius),
            dvv: around * (-cos_u * radius),
        })
    }

    /// The level set of the distance from the origin. Its function increases inwards for a dish.
    #[inline]
    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        let side = Self::SIDE_F64;
        LevelSet::new(point.coords * side, Matrix3::identity() * side)
            .ok_or_else(|| SurfaceError::off_domain(point))
    }

    /// Normal and curvature at a point on the sphere. The unit normal is the point times the curvature, so it is
    /// computed without a square root.
    #[inline]
    fn tangent_form(
        &self,
        point: &Point3<f64>,
        _x: &Vector3<f64>,
    ) -> Result<TangentForm, SurfaceError> {
        let curvature = Self::SIDE_F64 / self.radius;
        let normal = point.coords * curvature;
        if normal.sum().is_finite() {
            let curvature = CurvatureForm::isotropic(curvature);
            Ok(TangentForm::of_unit_normal(normal, curvature))
        } else {
            Err(SurfaceError::off_domain(point))
        }
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        let height = Self::SIDE_F64 * point.z;
        Parameters::new(
            libm::atan2(point.x, libm::hypot(point.y, height)),
            libm::atan2(point.y, height),
        )
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        let norm = point.coords.norm();
        if SQUARABLE.contains(&norm) {
            Ok(Point3::from(point.coords / norm * self.radius))
        } else {
            Err(SurfaceError::no_closest_point(point))
        }
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        let rim = libm::hypot(x, y);
        if rim <= self.radius {
            let height = ((self.radius - rim) * (self.radius + rim)).sqrt();
            Ok(Point3::new(x, y, Self::SIDE_F64 * height))
        } else {
            Err(SurfaceError::OffDomain { x, y })
        }
    }

    fn constant_curvature(&self) -> Option<CurvatureForm> {
        Some(CurvatureForm::isotropic(Self::SIDE_F64 / self.radius))
    }
}
