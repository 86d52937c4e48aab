//! A surface at a pose in the world.

use nalgebra::{Isometry3, Point3};

use crate::error::is_within_reach;
use crate::{
    ChartGeometry, ChartJet, CurvatureForm, GaussFrame, InvalidShape, LevelSet, Meridian,
    Parameters, Surface, SurfaceError,
};

/// A surface at a pose. Its curvature does not change.
///
/// The arguments x and y of `contact_at` are in the surface's own frame.
///
/// ```
/// use nalgebra::{Isometry3, Point3};
/// use palpate_geometry::{PlacedSurface, Surface, surfaces::Sphere};
///
/// let sphere = PlacedSurface::new(Sphere::new(3.0)?, Isometry3::translation(10.0, 0.0, 0.0))?;
/// let closest = sphere.closest_point(&Point3::new(20.0, 0.0, 0.0))?;
/// assert!((closest - Point3::new(13.0, 0.0, 0.0)).norm() < 1e-14);
/// assert!(sphere.is_homogeneous());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PlacedSurface<S> {
    surface: S,
    world_from_surface: Isometry3<f64>,
}

impl<S> PlacedSurface<S> {
    /// `surface` with its frame at the pose `world_from_surface`.
    ///
    /// # Errors
    /// [`InvalidShape`] if the pose is not finite, or if its translation exceeds 1e150.
    pub fn new(surface: S, world_from_surface: Isometry3<f64>) -> Result<Self, InvalidShape> {
        let rotation = world_from_surface.rotation.coords;
        let moves = world_from_surface.translation.vector;
        let components = moves.iter().chain(rotation.iter());
        if let Some(&value) = { components }.find(|value| !is_within_reach(**value, 0.0)) {
            let expected = "finite, moving by at most 1e150";
            InvalidShape::unless(false, "pose", value, expected)?;
        }
        Ok(Self {
            surface,
            world_from_surface,
        })
    }
}

impl<S: Surface> Surface for PlacedSurface<S> {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        let pose = &self.world_from_surface;
        let jet = self.surface.chart(at)?;
        Ok(ChartJet {
            point: pose * jet.point,
            du: pose * jet.du,
            dv: pose * jet.dv,
            duu: pose * jet.duu,
            duv: pose * jet.duv,
            dvv: pose * jet.dvv,
        })
    }

    fn chart_geometry(&self, at: Parameters) -> Result<ChartGeometry, SurfaceError> {
        let pose = &self.world_from_surface;
        let geometry = self.surface.chart_geometry(at)?;
        Ok(ChartGeometry {
            point: pose * geometry.point,
            frame: GaussFrame {
                x: pose * geometry.frame.x,
                y: pose * geometry.frame.y,
                normal: pose * geometry.frame.normal,
            },
            ..geometry
        })
    }

    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        let pose = &self.world_from_surface;
        let level_set = self
            .surface
            .level_set(&pose.inverse_transform_point(point))?;
        let rotation = pose.rotation.to_rotation_matrix();
        Ok(LevelSet {
            normal: pose * level_set.normal,
            second_form: rotation * level_set.second_form * rotation.transpose(),
        })
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        let local = self.world_from_surface.inverse_transform_point(point);
        self.surface.parameters(&local)
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        let local = self.world_from_surface.inverse_transform_point(point);
        Ok(self.world_from_surface * self.surface.closest_point(&local)?)
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        Ok(self.world_from_surface * self.surface.contact_at(x, y)?)
    }

    fn default_contact(&self) -> (f64, f64) {
        self.surface.default_contact()
    }

    fn meridian(&self, apex: &Point3<f64>) -> Option<Meridian> {
        let local = self.world_from_surface.inverse_transform_point(apex);
        self.surface.meridian(&local)
    }

    fn constant_curvature(&self) -> Option<CurvatureForm> {
        self.surface.constant_curvature()
    }
}
