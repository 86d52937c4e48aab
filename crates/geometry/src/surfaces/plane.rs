//! The horizontal plane.

use nalgebra::{Matrix3, Point3, Vector3};

use crate::error::is_within_reach;
use crate::{ChartJet, CurvatureForm, LevelSet, Parameters, Surface, SurfaceError};

/// The plane z = 0, with the solid below. The chart is `(u, v, 0)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plane;

impl Surface for Plane {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        let at = at.unless_out_of_reach()?;
        Ok(ChartJet {
            point: Point3::new(at.u, at.v, 0.0),
            du: Vector3::x(),
            dv: Vector3::y(),
            duu: Vector3::zeros(),
            duv: Vector3::zeros(),
            dvv: Vector3::zeros(),
        })
    }

    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        self.contact_at(point.x, point.y)?;
        Ok(LevelSet {
            normal: Vector3::z(),
            second_form: Matrix3::zeros(),
        })
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        Parameters::new(point.x, point.y)
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        if is_within_reach(point.x, point.y) && point.z.is_finite() {
            Ok(Point3::new(point.x, point.y, 0.0))
        } else {
            Err(SurfaceError::no_closest_point(point))
        }
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        if is_within_reach(x, y) {
            Ok(Point3::new(x, y, 0.0))
        } else {
            Err(SurfaceError::OffDomain { x, y })
        }
    }

    fn constant_curvature(&self) -> Option<CurvatureForm> {
        Some(CurvatureForm::isotropic(0.0))
    }
}
