//! Ring tori about a vertical axis.

use nalgebra::{Matrix3, Point3, Vector3};
use palpate_statistics::BadSetting;

use crate::error::{SQUARABLE, checked_length};
use crate::{ChartJet, LevelSet, Parameters, Surface, SurfaceError};

/// A ring torus about the z axis.
///
/// With the major radius R, the minor radius r and `ρ = R + r sin u`, the chart is `(ρ cos v, ρ sin v, r cos u)`.
/// `u = 0` is the top circle, and `u` increases outwards. The metric is `M = diag(r, ρ)`, and the curvature form is
/// `K = diag(1/r, sin(u)/ρ)`.
///
/// ```
/// use std::f64::consts::FRAC_PI_2;
/// use palpate_geometry::{Parameters, Surface, Torus};
///
/// let torus = Torus::new(3.0, 1.0)?;
/// // The Gaussian curvature is 1/(r (R + r)) on the outer equator and −1/(r (R − r)) on the inner one.
/// let outside = torus.chart_geometry(Parameters::new(FRAC_PI_2, 0.0))?.curvature;
/// let inside = torus.chart_geometry(Parameters::new(-FRAC_PI_2, 0.0))?.curvature;
/// assert!((outside.gaussian_curvature() - 0.25).abs() < 1e-14);
/// assert!((inside.gaussian_curvature() + 0.5).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    major_radius: f64,
    minor_radius: f64,
}

impl Torus {
    /// A torus whose tube of `minor_radius` is centred on a circle of `major_radius`.
    ///
    /// # Errors
    /// [`BadSetting`] unless both are between 1e-150 and 1e150 and `minor_radius < major_radius`, so that the tube
    /// does not intersect itself.
    pub fn new(major_radius: f64, minor_radius: f64) -> Result<Self, BadSetting> {
        checked_length("major_radius", major_radius)?;
        checked_length("minor_radius", minor_radius)?;
        let fits = minor_radius < major_radius;
        BadSetting::unless(fits, "minor_radius", minor_radius, "below major_radius")?;
        Ok(Self {
            major_radius,
            minor_radius,
        })
    }
}

impl Surface for Torus {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        let at = at.unless_out_of_reach()?;
        let (sin_u, cos_u) = libm::sincos(at.u);
        let (sin_v, cos_v) = libm::sincos(at.v);
        let (out, around) = (
            Vector3::new(cos_v, sin_v, 0.0),
            Vector3::new(-sin_v, cos_v, 0.0),
        );
        let r = self.minor_radius;
        let rho = self.major_radius + r * sin_u;
        Ok(ChartJet {
            point: Point3::from(out * rho + Vector3::z() * (r * cos_u)),
            du: (out * cos_u - Vector3::z() * sin_u) * r,
            dv: around * rho,
            duu: (-out * sin_u - Vector3::z() * cos_u) * r,
            duv: around * (r * cos_u),
            dvv: -out * rho,
        })
    }

    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        let off_domain = SurfaceError::off_domain(point);
        let rho = libm::hypot(point.x, point.y);
        if rho == 0.0 {
            return Err(off_domain);
        }
        // The level set belongs to the function F = ((ρ − R)² + z²)/2, where ρ is the distance from the z axis and R
        // the major radius.
        let (cos, sin) = (point.x / rho, point.y / rho);
        let beyond = rho - self.major_radius;
        let gradient = Vector3::new(beyond * cos, beyond * sin, point.z);
        let ring = beyond / rho;
        let hessian = Matrix3::new(
            cos * cos + ring * sin * sin,
            (1.0 - ring) * cos * sin,
            0.0,
            (1.0 - ring) * cos * sin,
            sin * sin + ring * cos * cos,
            0.0,
            0.0,
            0.0,
            1.0,
        );
        LevelSet::new(gradient, hessian).ok_or(off_domain)
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        let beyond = libm::hypot(point.x, point.y) - self.major_radius;
        Parameters::new(libm::atan2(beyond, point.z), libm::atan2(point.y, point.x))
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        let rho = libm::hypot(point.x, point.y);
        let out = Vector3::new(point.x / rho, point.y / rho, 0.0);
        let centre = out * self.major_radius;
        let radial = point.coords - centre;
        let norm = radial.norm();
        // If the point is on the circle of the tube's centres, the computed direction to the surface is only a rounding
        // error.
        let on_core = norm <= f64::EPSILON * self.major_radius;
        if on_core || rho == 0.0 || !SQUARABLE.contains(&norm) {
            return Err(SurfaceError::no_closest_point(point));
        }
        Ok(Point3::from(centre + radial / norm * self.minor_radius))
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        let beyond = (libm::hypot(x, y) - self.major_radius).abs();
        if beyond <= self.minor_radius {
            let z = ((self.minor_radius - beyond) * (self.minor_radius + beyond)).sqrt();
            Ok(Point3::new(x, y, z))
        } else {
            Err(SurfaceError::OffDomain { x, y })
        }
    }

    fn default_contact(&self) -> (f64, f64) {
        (self.major_radius, 0.0)
    }
}
