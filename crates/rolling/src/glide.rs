//! A fingertip that glides over an object: where it touches, given where it is held.
//!
//! A finger is held in a vertical plane and lowered until it touches. A point touches on its own
//! vertical line. A spherical tip of radius `r` touches where its centre lies on the offset
//! surface, at a contact `q` with outward normal `n`,
//!
//! ```text
//! q + r n(q) = tip's centre,
//! ```
//!
//! which is beside the vertical line wherever the object slopes.

mod closed_form;
mod foot;
mod model;
mod relief;
mod search;
mod touch;

use nalgebra::Vector2;
use palpate_geometry::surfaces::Sphere;
use palpate_geometry::{InvalidShape, Shape, Surface, SurfaceError};

use crate::Choice;
use crate::rung::CLOSED_FORM_ERROR;
use foot::Foot;
use model::TouchRung;
use search::Search;

pub use model::{InvalidTouch, TouchModel};
pub use touch::{Fingertip, GlideError, Touch};

/// Largest distance from the origin whose square is still a number.
const FARTHEST: f64 = 1e150;

/// An object and a fingertip that touches it.
///
/// ```
/// use palpate_geometry::{Shape, surfaces::Sphere};
/// use palpate_rolling::{Fingertip, Glider};
///
/// // A tip of radius 1 beside the top of a ball of radius 3: its centre lies on a sphere of radius 4.
/// let ball = Shape::Sphere(Sphere::new(3.0)?);
/// let glider = Glider::new(ball, Fingertip::Sphere { radius: 1.0 })?;
/// let touch = glider.touch(2.0, 0.0)?;
/// assert!((touch.point.x - 1.5).abs() < 1e-13);
/// assert!((touch.tip_centre.z - 12.0_f64.sqrt()).abs() < 1e-13);
/// assert!((touch.curvature.mean_curvature() - 1.0 / 3.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Glider {
    object: Shape,
    fingertip: Fingertip,
    rung: TouchRung,
}

impl Glider {
    /// A glider whose contacts are found by the default model, [`TouchModel::default`]; [`Glider::on`] takes another.
    ///
    /// # Errors
    /// [`InvalidShape`] unless a sphere's radius is finite, positive and can be squared.
    pub fn new(object: Shape, fingertip: Fingertip) -> Result<Self, InvalidShape> {
        if let Fingertip::Sphere { radius } = fingertip {
            Sphere::new(radius)?;
        }
        let tolerance = TouchModel::DEFAULT_TOLERANCE;
        let rung = TouchRung::cheapest(&object, fingertip, tolerance);
        Ok(Self {
            object,
            fingertip,
            rung,
        })
    }

    /// A glider with this fingertip and object whose contacts are found by `model`.
    ///
    /// # Errors
    /// [`InvalidTouch`] where the tolerance is out of range, or the rung cannot do it.
    pub fn on(&self, model: TouchModel) -> Result<Self, InvalidTouch> {
        let rung = TouchRung::of(model, &self.object, self.fingertip)?;
        Ok(Self {
            object: self.object.clone(),
            fingertip: self.fingertip,
            rung,
        })
    }

    /// The way in which contacts are found, and the reason for it.
    pub fn choice(&self) -> Choice<TouchModel> {
        let name = self.object.name();
        let (rung, model, reason, bound) = match self.rung {
            TouchRung::Point => (
                "closed form: points".to_owned(),
                TouchModel::ClosedForm,
                "they touch straight below".to_owned(),
                CLOSED_FORM_ERROR,
            ),
            TouchRung::Offset(_) => (
                format!("closed form: a round tip on a {name}"),
                TouchModel::ClosedForm,
                "the offset surface is of the same kind".to_owned(),
                CLOSED_FORM_ERROR,
            ),
            TouchRung::Newton { tolerance, .. } => (
                format!("Newton's method on the offset surface, tolerance {tolerance:e}"),
                TouchModel::Newton { tolerance },
                format!("a round tip on a {name} has no closed form"),
                tolerance,
            ),
        };
        Choice {
            rung,
            model,
            reason,
            error_bound: Some(bound),
        }
    }

    /// The object.
    pub const fn object(&self) -> &Shape {
        &self.object
    }

    /// The fingertip.
    pub const fn fingertip(&self) -> Fingertip {
        self.fingertip
    }

    /// The contact of a finger whose tip has its centre on the vertical line through `(x, y)`:
    /// the first one that the tip meets on its way down, on the side of the object that
    /// [`Surface::contact_at`] touches.
    ///
    /// On planes, spheres, dishes and cylinders that contact has a closed form. Elsewhere it is found
    /// by Newton's method from the object beneath. On ellipsoids and tori it is the only one that
    /// fits. On graphs the object is asked at
    /// sixteen places across the tip, about half a radius apart; where one of them reaches into the
    /// tip or is too hollow for it, Newton's method starts from every top of a relief of the places
    /// under the tip, a twelfth of its radius apart, and the highest contact counts. It is the first
    /// for certain where the graph's second derivatives stay below `1/radius`; elsewhere a ridge
    /// may pass unseen that fits between those places.
    ///
    /// # Errors
    /// [`GlideError`].
    pub fn touch(&self, x: f64, y: f64) -> Result<Touch, GlideError> {
        let is_near = (0.0..=FARTHEST).contains(&(x.abs() + y.abs()));
        let centre = Vector2::new(x, y);
        match self.rung {
            TouchRung::Point => {
                let point = self.object.contact_at(x, y)?;
                Foot::at(&self.object, point)?.touch(0.0)
            }
            _ if !is_near => Err(SurfaceError::OffDomain { x, y }.into()),
            TouchRung::Offset(offset) => {
                let foot = offset.contact(&self.object, centre)?;
                foot.touch(offset.tip_radius)
            }
            TouchRung::Newton { radius, tolerance } => {
                let search = Search {
                    object: &self.object,
                    radius,
                    tolerance,
                    rugged: self.object.is_graph(),
                    centre,
                };
                search.contact()?.touch(radius)
            }
        }
    }
}
