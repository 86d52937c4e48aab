//! Models that find the contact of a gliding fingertip.

use nalgebra::Vector2;
use palpate_geometry::{Shape, Surface};
use palpate_statistics::BadSetting;
use thiserror::Error;

use super::search::ACCEPTED_MISS;
use super::touch::{Fingertip, Foot, GlideError};
use crate::Model;

/// A model that finds the contact of a fingertip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TouchModel {
    /// The model "closed form" if it is valid for the tip and the object, otherwise Newton's method with this
    /// tolerance.
    Auto {
        /// Largest error of the contact's position, relative to the tip's radius, from [`Model::SMALLEST_TOLERANCE`] to
        /// 0.1.
        tolerance: f64,
    },
    /// Exact formulas for the contact point. They exist for point tips, and for round tips on planes, spheres, dishes
    /// and cylinders; other tips and objects are rejected.
    ClosedForm,
    /// Newton's method on the offset surface of a round tip.
    Newton {
        /// Largest error of the contact's position, as in [`TouchModel::Auto`].
        tolerance: f64,
    },
}

impl Default for TouchModel {
    fn default() -> Self {
        Self::Auto {
            tolerance: Self::DEFAULT_TOLERANCE,
        }
    }
}

impl TouchModel {
    /// Default tolerance for the error of a contact, relative to the tip's radius.
    pub(crate) const DEFAULT_TOLERANCE: f64 = 1e-12;
}

/// A glide that cannot be set up.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum InvalidTouch {
    /// The fingertip has an invalid radius.
    #[error("{0}")]
    Tip(#[from] BadSetting),
    /// The model that the user has set cannot compute the contacts of this fingertip with this object.
    #[error("the model `{rung}` cannot compute this: {reason}")]
    Unsupported {
        /// Name of the model that the user has set.
        rung: &'static str,
        /// Reason why the model cannot compute the contacts, as text.
        reason: String,
    },
    /// The stated tolerance is out of its range.
    #[error("{0}")]
    Tolerance(BadSetting),
}

/// A model that finds contacts, prepared for one fingertip and one object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TouchRung {
    /// The model of a point tip. The contact is the point of the object vertically below the tip.
    Point,
    Offset(Offset),
    Newton {
        radius: f64,
        tolerance: f64,
    },
}

impl TouchRung {
    pub(super) fn cheapest(object: &Shape, fingertip: Fingertip, tolerance: f64) -> Self {
        match fingertip {
            Fingertip::Point => Self::Point,
            Fingertip::Sphere { radius } => {
                let newton = Self::Newton { radius, tolerance };
                Offset::of(object, radius).map_or(newton, Self::Offset)
            }
        }
    }

    pub(super) fn new(
        model: TouchModel,
        object: &Shape,
        fingertip: Fingertip,
    ) -> Result<Self, InvalidTouch> {
        let unsupported = |rung, reason| Err(InvalidTouch::Unsupported { rung, reason });
        let tolerance = match model {
            TouchModel::Auto { tolerance } | TouchModel::Newton { tolerance } => tolerance,
            TouchModel::ClosedForm => TouchModel::DEFAULT_TOLERANCE,
        };
        Model::checked(tolerance).map_err(InvalidTouch::Tolerance)?;
        match (
            model,
            fingertip,
            Self::cheapest(object, fingertip, tolerance),
        ) {
            (TouchModel::ClosedForm, _, Self::Newton { .. }) => {
                let reason = format!("a round tip on a {} has no closed form", object.name());
                unsupported("closed form", reason)
            }
            (TouchModel::Newton { .. }, Fingertip::Point, _) => unsupported(
                "Newton",
                "a point tip touches the surface straight below itself, so the contact has a closed form"
                    .to_owned(),
            ),
            (TouchModel::Newton { .. }, Fingertip::Sphere { radius }, _) => {
                Ok(Self::Newton { radius, tolerance })
            }
            (TouchModel::Auto { .. } | TouchModel::ClosedForm, _, cheapest) => Ok(cheapest),
        }
    }
}

/// The surface on which the centre of a round tip moves. For planes, spheres, dishes and cylinders, it is a surface of
/// the same type as the object.
///
/// The tip's centre lies on a sphere or cylinder of radius `R + r`, or in a dish of radius `R − r`. Here R is the
/// radius of the object and r the radius of the tip. The contact is on the line from the tip's centre to the object's
/// centre or, at a right angle, to its axis. In the xy plane, the distance of the contact from this centre or axis is
/// the distance of the tip's centre times R/(R + r) or, in a dish, times R/(R − r).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offset {
    kind: Kind,
    pub(super) tip_radius: f64,
    /// Radius of the object (length). For a plane, `radius` and `offset_radius` are 1, so their ratio is 1.
    radius: f64,
    /// Radius of the offset surface (length); 1 for a plane.
    offset_radius: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Plane,
    Round,
    /// Offset surface of a cylinder, with the direction of its axis.
    Cylinder(Vector2<f64>),
}

impl Offset {
    /// The offset surface of `object` for a tip of `tip_radius`; `None` if the offset surface is not of the same type
    /// as the object.
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

    /// The contact of a tip whose centre is above `centre`.
    pub(super) fn contact(&self, object: &Shape, centre: Vector2<f64>) -> Result<Foot, GlideError> {
        // A tip fits into a dish only if the dish has the larger radius. So `offset_radius`, the radius of the dish
        // minus the radius of the tip, must be larger than rounding errors.
        if self.offset_radius <= ACCEPTED_MISS * self.radius {
            return Err(GlideError::two_contacts(self.tip_radius, &centre));
        }
        let base = match self.kind {
            Kind::Plane => centre,
            Kind::Round => Vector2::zeros(),
            Kind::Cylinder(axis) => axis * axis.dot(&centre),
        };
        let out = centre - base;
        if self.kind != Kind::Plane && out.norm() >= self.offset_radius {
            return Err(GlideError::contact_lost(self.tip_radius, &centre));
        }
        let at = base + out * (self.radius / self.offset_radius);
        let foot = Foot::at(object, object.contact_at(at.x, at.y)?)?;
        if foot.normal.z <= 0.0 {
            return Err(GlideError::contact_lost(self.tip_radius, &centre));
        }
        let miss = (foot.tip_centre(self.tip_radius).xy().coords - centre).norm();
        let lengths = centre.norm() + at.norm() + self.tip_radius;
        if miss <= ACCEPTED_MISS * lengths {
            Ok(foot)
        } else {
            Err(GlideError::no_convergence(self.tip_radius, &centre, miss))
        }
    }
}
