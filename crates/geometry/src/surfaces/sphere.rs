//! Spheres, touched from outside, and dishes, touched from inside.

use nalgebra::{Matrix3, Point3, Vector3};
use palpate_statistics::BadSetting;

use crate::error::{SQUARABLE, checked_length};
use crate::{ChartJet, CurvatureForm, LevelSet, Parameters, Surface, SurfaceError, TangentForm};

/// A sphere about the origin.
///
/// Chart `(R sin u, R cos u sin v, R cos u cos v)` with |u| ≤ π/2: `u = v = 0` is the top, where the Gauss frame equals
/// the axes. The poles of the chart lie on the x axis. The metric is `M = diag(R, R cos u)`, the curvature form
/// `K = I/R` and the torsion form `T = [0, −tan(u)/R]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    radius: f64,
}

/// The inside of a sphere about the origin. A probe touches its lower half. The curvature is negative.
///
/// Chart `(R sin u, R cos u sin v, −R cos u cos v)` with |u| ≤ π/2: `u = v = 0` is the bottom, where
/// the Gauss frame equals the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dish {
    radius: f64,
}

impl Sphere {
    /// A sphere of `radius`.
    ///
    /// # Errors
    /// [`BadSetting`] unless the radius is between 1e-150 and 1e150.
    pub fn new(radius: f64) -> Result<Self, BadSetting> {
        let radius = checked_length("radius", radius)?;
        Ok(Self { radius })
    }

    /// Radius of the sphere.
    pub const fn radius(&self) -> f64 {
        self.radius
    }
}

impl Dish {
    /// A dish of `radius`.
    ///
    /// # Errors
    /// [`BadSetting`] unless the radius is between 1e-150 and 1e150.
    pub fn new(radius: f64) -> Result<Self, BadSetting> {
        let radius = checked_length("radius", radius)?;
        Ok(Self { radius })
    }

    /// Radius of the dish.
    pub const fn radius(&self) -> f64 {
        self.radius
    }
}

fn spherical_chart(radius: f64, side: f64, at: Parameters) -> Result<ChartJet, SurfaceError> {
    let at = at.unless_beyond_pole()?;
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

fn spherical_parameters(point: &Point3<f64>, side: f64) -> Parameters {
    let height = side * point.z;
    Parameters::new(
        libm::atan2(point.x, libm::hypot(point.y, height)),
        libm::atan2(point.y, height),
    )
}

/// The level set of the distance from the origin, at `point`. `side` is 1 if the level-set function increases outwards,
/// and −1 if it increases inwards.
#[inline]
fn spherical_level_set(point: &Point3<f64>, side: f64) -> Result<LevelSet, SurfaceError> {
    LevelSet::new(point.coords * side, Matrix3::identity() * side)
        .ok_or_else(|| SurfaceError::off_domain(point))
}

/// Normal and curvature at a point on the sphere. The unit normal is the point times the curvature, so it is computed
/// without a square root.
#[inline]
fn spherical_form(point: &Point3<f64>, curvature: f64) -> Result<TangentForm, SurfaceError> {
    let normal = point.coords * curvature;
    if normal.sum().is_finite() {
        let curvature = CurvatureForm::isotropic(curvature);
        Ok(TangentForm::of_unit_normal(normal, curvature))
    } else {
        Err(SurfaceError::off_domain(point))
    }
}

fn radial_projection(radius: f64, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
    let norm = point.coords.norm();
    if SQUARABLE.contains(&norm) {
        Ok(Point3::from(point.coords / norm * radius))
    } else {
        Err(SurfaceError::no_closest_point(point))
    }
}

fn height_over(radius: f64, x: f64, y: f64) -> Result<f64, SurfaceError> {
    let rim = libm::hypot(x, y);
    if rim <= radius {
        Ok(((radius - rim) * (radius + rim)).sqrt())
    } else {
        Err(SurfaceError::OffDomain { x, y })
    }
}

impl Surface for Sphere {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        spherical_chart(self.radius, 1.0, at)
    }

    #[inline]
    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        spherical_level_set(point, 1.0)
    }

    #[inline]
    fn tangent_form(
        &self,
        point: &Point3<f64>,
        _x: &Vector3<f64>,
    ) -> Result<TangentForm, SurfaceError> {
        spherical_form(point, 1.0 / self.radius)
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        spherical_parameters(point, 1.0)
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        radial_projection(self.radius, point)
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        Ok(Point3::new(x, y, height_over(self.radius, x, y)?))
    }

    fn constant_curvature(&self) -> Option<CurvatureForm> {
        Some(CurvatureForm::isotropic(1.0 / self.radius))
    }
}

impl Surface for Dish {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        spherical_chart(self.radius, -1.0, at)
    }

    #[inline]
    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        spherical_level_set(point, -1.0)
    }

    #[inline]
    fn tangent_form(
        &self,
        point: &Point3<f64>,
        _x: &Vector3<f64>,
    ) -> Result<TangentForm, SurfaceError> {
        spherical_form(point, -1.0 / self.radius)
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        spherical_parameters(point, -1.0)
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        radial_projection(self.radius, point)
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        Ok(Point3::new(x, y, -height_over(self.radius, x, y)?))
    }

    fn constant_curvature(&self) -> Option<CurvatureForm> {
        Some(CurvatureForm::isotropic(-1.0 / self.radius))
    }
}
