//! A fingertip, its contact, and the reasons why there may be none.

use nalgebra::{Point3, Vector2, Vector3};
use palpate_geometry::{CurvatureForm, Surface, SurfaceError};
use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// The shape of a fingertip that glides over an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fingertip {
    /// A point.
    Point,
    /// A sphere.
    Sphere {
        /// Its radius.
        radius: f64,
    },
}

/// A contact of a fingertip, in the object's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The contact.
    pub point: Point3<f64>,
    /// The object's unit normal there, out of the object.
    pub normal: Vector3<f64>,
    /// The centre of the tip, `point + radius · normal`; for a point, the contact itself.
    pub tip_centre: Point3<f64>,
    /// The object's curvature there, in an orthonormal tangent basis: along the level line and up the slope,
    /// right-handed with the normal. Where the object is level, these are x and y.
    pub curvature: CurvatureForm,
}

/// Reasons why a finger has no contact to report.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum GlideError {
    /// The contact would be where the object is not defined; for a point, also beside a closed object.
    #[error("the finger left the object: {0}")]
    #[strum(transparent)]
    Surface(#[from] SurfaceError),
    /// The tip passes beside the object: the offset surface does not extend there, or only where the object's normal is
    /// horizontal.
    #[error(
        "a tip of radius {radius} at x = {x}, y = {y} passes beside the object",
        radius = Number(*radius), x = Number(*x), y = Number(*y)
    )]
    ContactLost {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
    },
    /// The tip touches at two places at once, or at a continuum of places: in a dish, valley or hole that is as tight
    /// as the tip or tighter.
    #[error(
        "a tip of radius {radius} at x = {x}, y = {y} touches at more than one place",
        radius = Number(*radius), x = Number(*x), y = Number(*y)
    )]
    TwoContacts {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
    },
    /// The search for the contact did not converge: lengths differ too much for double precision, or the object is too
    /// rough for the tip.
    #[error(
        "no contact found for a tip of radius {radius} at x = {x}, y = {y}: off by {miss}",
        radius = Number(*radius), x = Number(*x), y = Number(*y), miss = Number(*miss)
    )]
    NoConvergence {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
        /// Horizontal distance by which the best contact misses.
        miss: f64,
    },
}

impl GlideError {
    pub(super) fn two_contacts(radius: f64, centre: &Vector2<f64>) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::TwoContacts { x, y, radius }
    }

    pub(super) fn no_convergence(radius: f64, centre: &Vector2<f64>, miss: f64) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::NoConvergence { x, y, radius, miss }
    }

    pub(super) fn contact_lost(radius: f64, centre: &Vector2<f64>) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::ContactLost { x, y, radius }
    }

    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}

/// A point of the object with its normal, and its curvature along the level line and up the slope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) point: Point3<f64>,
    pub(super) normal: Vector3<f64>,
    /// Unit vector up the slope, seen from above; +y where the object is level.
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

    /// The smaller eigenvalue of `I + r S`: 0 if the object's concave curvature is 1/radius, below 0 if it is sharper.
    pub(super) fn clearance(&self, radius: f64) -> f64 {
        1.0 + radius * self.curvature.principal().k_min
    }

    /// Displacement of the contact, seen from above, that moves the tip's centre by `miss`. It is the inverse of
    /// `P (I + r S) P⁻¹`, where `P` is the projection from above. `None` if that is singular.
    pub(super) fn step(&self, radius: f64, miss: &Vector2<f64>) -> Option<Vector2<f64>> {
        let along = Vector2::new(self.uphill.y, -self.uphill.x);
        let (aside, ahead) = (along.dot(miss), self.uphill.dot(miss));
        let CurvatureForm { k_uu, k_uv, k_vv } = self.curvature;
        let (level, twist, steep) = (1.0 + radius * k_uu, radius * k_uv, 1.0 + radius * k_vv);
        // The projection from above shortens lengths up the slope by n_z.
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
