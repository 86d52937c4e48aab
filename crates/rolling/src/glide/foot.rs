//! A place of the object that may be the contact.

use nalgebra::{Point3, Vector2, Vector3};
use palpate_geometry::{CurvatureForm, Surface, SurfaceError};

use super::touch::{GlideError, Touch};

/// A point of the object with its normal, and its curvature along the level line and up the slope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) point: Point3<f64>,
    pub(super) normal: Vector3<f64>,
    /// Unit vector up the slope as seen from above; +y on level ground.
    uphill: Vector2<f64>,
    curvature: CurvatureForm,
}

impl Foot {
    pub(super) fn at<S: Surface>(object: &S, point: Point3<f64>) -> Result<Self, SurfaceError> {
        let level_set = object.level_set(&point)?;
        let normal = level_set.normal;
        let lean = normal.xy().norm();
        let uphill = if lean > 0.0 {
            -normal.xy() / lean
        } else {
            Vector2::y()
        };
        let along = Vector3::new(uphill.y, -uphill.x, 0.0);
        let up = Vector3::new(uphill.x * normal.z, uphill.y * normal.z, lean);
        Ok(Self {
            point,
            normal,
            uphill,
            curvature: level_set.curvature(&along, &up),
        })
    }

    /// The centre of a tip of `radius` that touches here.
    pub(super) fn tip_centre(&self, radius: f64) -> Point3<f64> {
        self.point + self.normal * radius
    }

    /// The smaller eigenvalue of `I + r S`: 0 where the object is as hollow as a tip of `radius` is
    /// round, below 0 where it is hollower.
    pub(super) fn clearance(&self, radius: f64) -> f64 {
        1.0 + radius * self.curvature.principal().k_min
    }

    /// Displacement of the contact, as seen from above, that carries the tip's centre by `miss`:
    /// the inverse of `P (I + r S) P⁻¹`, with `P` the view from above. `None` where that is
    /// singular.
    pub(super) fn step(&self, radius: f64, miss: &Vector2<f64>) -> Option<Vector2<f64>> {
        let along = Vector2::new(self.uphill.y, -self.uphill.x);
        let (aside, ahead) = (along.dot(miss), self.uphill.dot(miss));
        let CurvatureForm { k_uu, k_uv, k_vv } = self.curvature;
        let (level, twist, steep) = (1.0 + radius * k_uu, radius * k_uv, 1.0 + radius * k_vv);
        // The view from above shortens lengths up the slope by n_z.
        let lengthened = if twist == 0.0 {
            0.0
        } else {
            twist / self.normal.z
        };
        let determinant = level * steep - twist * twist;
        let step = along * ((steep * aside - lengthened * ahead) / determinant)
            + self.uphill * ((level * ahead - twist * self.normal.z * aside) / determinant);
        step.sum().is_finite().then_some(step)
    }

    /// The touch of a tip of `radius` here.
    pub(super) fn touch(&self, radius: f64) -> Result<Touch, GlideError> {
        let tip_centre = self.tip_centre(radius);
        let CurvatureForm { k_uu, k_uv, k_vv } = self.curvature;
        if !(tip_centre.coords.sum() + k_uu + k_uv + k_vv).is_finite() {
            let Point3 { coords } = self.point;
            let (x, y) = (coords.x, coords.y);
            return Err(SurfaceError::OffDomain { x, y }.into());
        }
        Ok(Touch {
            point: self.point,
            normal: self.normal,
            tip_centre,
            curvature: self.curvature,
        })
    }
}
