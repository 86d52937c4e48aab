//! Horizontal cylinders.

use nalgebra::{Matrix3, Point3, Vector3};
use palpate_statistics::BadSetting;

use crate::error::{SQUARABLE, checked_finite, checked_length, is_within_reach};
use crate::{ChartJet, CurvatureForm, LevelSet, Parameters, Surface, SurfaceError};

/// An infinite cylinder with a horizontal axis through the origin.
///
/// `d` is the unit vector along the axis, and `b = z × d`. The chart is `u d + r sin v b + r cos v z` with the radius
/// `r`; `u = v = 0` is a point of the top line. The metric is `M = diag(1, r)`, the curvature form `K = diag(0, 1/r)`
/// and the torsion form `T = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    radius: f64,
    axis: Vector3<f64>,
    across: Vector3<f64>,
}

impl Cylinder {
    /// A cylinder of `radius` whose axis has the angle `direction_rad` from +x towards +y.
    ///
    /// # Errors
    /// [`BadSetting`] unless the radius is between 1e-150 and 1e150 and the direction is finite.
    pub fn new(radius: f64, direction_rad: f64) -> Result<Self, BadSetting> {
        let radius = checked_length("radius", radius)?;
        let (sin, cos) = libm::sincos(checked_finite("direction", direction_rad)?);
        let axis = Vector3::new(cos, sin, 0.0);
        let across = Vector3::new(-sin, cos, 0.0);
        Ok(Self {
            radius,
            axis,
            across,
        })
    }

    /// Radius of the cylinder.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The unit vector along the axis of the cylinder.
    pub const fn axis(&self) -> Vector3<f64> {
        self.axis
    }

    fn radial(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.across * self.across.dot(&point.coords) + Vector3::z() * point.z
    }
}

impl Surface for Cylinder {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        let at = at.unless_out_of_reach()?;
        let (sin, cos) = libm::sincos(at.v);
        let radial = (self.across * sin + Vector3::z() * cos) * self.radius;
        Ok(ChartJet {
            point: Point3::from(self.axis * at.u + radial),
            du: self.axis,
            dv: (self.across * cos - Vector3::z() * sin) * self.radius,
            duu: Vector3::zeros(),
            duv: Vector3::zeros(),
            dvv: -radial,
        })
    }

    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        let hessian = Matrix3::identity() - self.axis * self.axis.transpose();
        LevelSet::new(self.radial(point), hessian).ok_or_else(|| SurfaceError::off_domain(point))
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        Parameters::new(
            self.axis.dot(&point.coords),
            libm::atan2(self.across.dot(&point.coords), point.z),
        )
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        let radial = self.radial(point);
        let (norm, farthest) = (radial.norm(), point.coords.norm());
        // If the point is on the axis, the computed direction to the surface is only a rounding error.
        let on_axis = norm <= f64::EPSILON * farthest;
        if on_axis || !SQUARABLE.contains(&norm) || !SQUARABLE.contains(&farthest) {
            return Err(SurfaceError::no_closest_point(point));
        }
        let along = self.axis * self.axis.dot(&point.coords);
        Ok(Point3::from(along + radial / norm * self.radius))
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        let across = self.across.dot(&Vector3::new(x, y, 0.0)).abs();
        if across <= self.radius && is_within_reach(x, y) {
            let z = ((self.radius - across) * (self.radius + across)).sqrt();
            Ok(Point3::new(x, y, z))
        } else {
            Err(SurfaceError::OffDomain { x, y })
        }
    }

    fn constant_curvature(&self) -> Option<CurvatureForm> {
        Some(CurvatureForm {
            k_uu: 0.0,
            k_uv: 0.0,
            k_vv: 1.0 / self.radius,
        })
    }
}
