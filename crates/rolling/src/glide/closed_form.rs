//! Round tips on planes, spheres, dishes and cylinders: the offset surface is of the same kind.
//!
//! The tip's centre lies on a sphere or cylinder of radius `R + r`, in a dish of `R − r`, and the
//! contact on the way from there to the object's centre or axis. Seen from above, the contact is at
//! `R/(R ± r)` of the way out to the tip's centre.

use nalgebra::Vector2;
use palpate_geometry::{Shape, Surface};

use super::foot::Foot;
use super::search::ACCEPTED_MISS;
use super::touch::GlideError;

/// The surface on which the centre of a round tip lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offset {
    kind: Kind,
    pub(super) tip_radius: f64,
    /// Radius of the object, length; 1 for a plane.
    radius: f64,
    /// Radius of the offset surface, length; 1 for a plane.
    offset_radius: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Plane,
    /// Offset of a sphere or dish, whose normals point away from or to a centre.
    Round,
    /// Offset of a cylinder, whose normals point away from an axis.
    Cylinder(Vector2<f64>),
}

impl Offset {
    /// The offset of `object` for a tip of `tip_radius`; `None` where that is of another kind.
    pub(super) fn of(object: &Shape, tip_radius: f64) -> Option<Self> {
        let (kind, radius, outwards) = match object {
            Shape::Plane(_) => (Kind::Plane, 1.0, 0.0),
            Shape::Sphere(sphere) => (Kind::Round, sphere.radius(), tip_radius),
            Shape::Dish(dish) => (Kind::Round, dish.radius(), -tip_radius),
            Shape::Cylinder(cylinder) => {
                let axis = cylinder.axis().xy();
                (Kind::Cylinder(axis), cylinder.radius(), tip_radius)
            }
            _ => return None,
        };
        Some(Self {
            kind,
            tip_radius,
            radius,
            offset_radius: radius + outwards,
        })
    }

    /// The contact of the tip held above `centre`.
    pub(super) fn contact(&self, object: &Shape, centre: Vector2<f64>) -> Result<Foot, GlideError> {
        // A dish as tight as the tip.
        if self.offset_radius <= ACCEPTED_MISS * self.radius {
            return Err(GlideError::two(self.tip_radius, &centre));
        }
        let kept = match self.kind {
            Kind::Plane => centre,
            Kind::Round => Vector2::zeros(),
            Kind::Cylinder(axis) => axis * axis.dot(&centre),
        };
        let out = centre - kept;
        if self.kind != Kind::Plane && out.norm() >= self.offset_radius {
            return Err(GlideError::lost(self.tip_radius, &centre));
        }
        let at = kept + out * (self.radius / self.offset_radius);
        let foot = Foot::at(object, object.contact_at(at.x, at.y)?)?;
        if foot.normal.z <= 0.0 {
            return Err(GlideError::lost(self.tip_radius, &centre));
        }
        let miss = (foot.tip_centre(self.tip_radius).xy().coords - centre).norm();
        let lengths = centre.norm() + at.norm() + self.tip_radius;
        if miss <= ACCEPTED_MISS * lengths {
            Ok(foot)
        } else {
            Err(GlideError::unsettled(self.tip_radius, &centre, miss))
        }
    }
}
