//! Fingertips, their contacts, and the reasons for a missing contact.

use nalgebra::{Point3, Vector2, Vector3};
use palpate_geometry::{CurvatureForm, Surface, SurfaceError};
use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// The shape of a fingertip that glides over an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fingertip {
    /// A fingertip that is a point.
    Point,
    /// A fingertip that is a sphere.
    Sphere {
        /// Radius of the sphere.
        radius: f64,
    },
}

/// A contact of a fingertip, in the object's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Contact point on the object.
    pub point: Point3<f64>,
    /// The object's unit normal at the contact, out of the object.
    pub normal: Vector3<f64>,
    /// The centre of the tip, `point + radius · normal`; for a point tip, the contact itself.
    pub tip_centre: Point3<f64>,
    /// The object's curvature at the contact, in an orthonormal tangent basis. The first axis of the basis is along the
    /// level line, the second axis up the slope. With the normal, the axes form a right-handed frame. Where the object
    /// is level, this basis is x and y.
    pub curvature: CurvatureForm,
}

/// Reasons why a finger has no contact with the object.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum GlideError {
    /// The object is not defined at the place of the contact. A point tip beside a closed object also gives this error.
    #[error("the finger left the object: {0}")]
    #[strum(transparent)]
    Surface(#[from] SurfaceError),
    /// The tip passes beside the object. At this x and y, the tip's centre cannot lie on the offset surface, because
    /// this surface does not exist there or its normal is horizontal.
    #[error(
        "a tip of radius {radius} at x = {x}, y = {y} passes beside the object",
        radius = Number(*radius), x = Number(*x), y = Number(*y)
    )]
    ContactLost {
        /// x coordinate of the tip's centre.
        x: f64,
        /// y coordinate of the tip's centre.
        y: f64,
        /// The tip's radius.
        radius: f64,
    },
    /// The tip touches at two places at once, or along a curve or an area. The object is a dish, valley or hole that is
    /// as narrow as the tip or narrower.
    #[error(
        "a tip of radius {radius} at x = {x}, y = {y} touches at more than one place",
        radius = Number(*radius), x = Number(*x), y = Number(*y)
    )]
    TwoContacts {
        /// x coordinate of the tip's centre.
        x: f64,
        /// y coordinate of the tip's centre.
        y: f64,
        /// The tip's radius.
        radius: f64,
    },
    /// The search for the contact did not converge. Either the lengths of the tip and the object differ too much for
    /// double precision, or the object is too rough for the tip.
    #[error(
        "no contact found for a tip of radius {radius} at x = {x}, y = {y}: off by {miss}",
        radius = Number(*radius), x = Number(*x), y = Number(*y), miss = Number(*miss)
    )]
    NoConvergence {
        /// x coordinate of the tip's centre.
        x: f64,
        /// y coordinate of the tip's centre.
        y: f64,
        /// The tip's radius.
        radius: f64,
        /// Horizontal distance between the tip's centre and the centre of a tip at the best contact that was found.
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
}

/// A point of the object with its normal, and with its curvature along the level line and up the slope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) point: Point3<f64>,
    pub(super) normal: Vector3<f64>,
    /// Horizontal unit vector up the slope; +y where the object is level.
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

    pub(super) fn tip_centre(&self, radius: f64) -> Point3<f64> {
        self.point + self.normal * radius
    }

    /// The smaller eigenvalue of `I + r S`, where r is the tip's radius and S the object's shape operator. It is 0 if
    /// the object has a hollow with the radius of the tip, and negative if the hollow has a smaller radius.
    pub(super) fn clearance(&self, radius: f64) -> f64 {
        1.0 + radius * self.curvature.principal().k_min
    }

    /// Horizontal displacement of the contact that moves the tip's centre horizontally by `miss`. It is the matrix `P
    /// (I + r S)⁻¹ P⁻¹` times `miss`. Here `P` is the projection from the tangent plane onto the xy plane, r the radius
    /// of the tip and S the shape operator of the object. `None` if `I + r S` is singular.
    pub(super) fn step(&self, radius: f64, miss: &Vector2<f64>) -> Option<Vector2<f64>> {
        let along = Vector2::new(self.uphill.y, -self.uphill.x);
        let (aside, ahead) = (along.dot(miss), self.uphill.dot(miss));
        let CurvatureForm { k_uu, k_uv, k_vv } = self.curvature;
        let (level, twist, steep) = (1.0 + radius * k_uu, radius * k_uv, 1.0 + radius * k_vv);
        // In the projection onto the xy plane, lengths up the slope are shorter by the factor n_z, the vertical
        // component of the normal. Divide by n_z to get the lengths on the slope.
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
