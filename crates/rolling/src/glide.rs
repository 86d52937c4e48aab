//! A fingertip that glides over an object. The contact is computed from the position of the finger.
//!
//! A finger is lowered vertically until it touches the object. A point tip touches on its own vertical line. A
//! spherical tip of radius `r` touches when its centre lies on the offset surface of the object. The contact `q` with
//! the outward normal `n` satisfies
//!
//! ```text
//! q + r n(q) = tip's centre.
//! ```
//!
//! Unless the object is level at the contact, the contact is beside the vertical line through the tip's centre.

mod search;
mod touch;
mod touch_model;

use nalgebra::Vector2;
use palpate_geometry::{Shape, Sphere, Surface, SurfaceError};
use palpate_statistics::BadSetting;

use crate::Choice;
use crate::ladder::CLOSED_FORM_ERROR;
use search::Search;
use touch::Foot;
use touch_model::TouchRung;

pub use touch::{Fingertip, GlideError, Touch};
pub use touch_model::{InvalidTouch, TouchModel};

/// Largest allowed distance of a fingertip from the origin. The square of a larger distance may overflow.
const MAX_DISTANCE: f64 = 1e150;

/// An object and a fingertip that touches it.
///
/// ```
/// use palpate_geometry::{Shape, Sphere};
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
    /// A glider with the default model, [`TouchModel::default`]. [`Glider::on`] changes the model.
    ///
    /// # Errors
    /// [`BadSetting`] unless the radius of a spherical tip is finite and positive, and its square neither overflows
    /// nor underflows.
    pub fn new(object: Shape, fingertip: Fingertip) -> Result<Self, BadSetting> {
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

    /// A glider with the same fingertip and object, but with `model`.
    ///
    /// # Errors
    /// [`InvalidTouch`] if the tolerance is out of range, or if the model cannot compute contacts of this fingertip
    /// with this object.
    pub fn on(&self, model: TouchModel) -> Result<Self, InvalidTouch> {
        let rung = TouchRung::new(model, &self.object, self.fingertip)?;
        Ok(Self {
            object: self.object.clone(),
            fingertip: self.fingertip,
            rung,
        })
    }

    /// The model that finds contacts, and the reason for its choice.
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

    /// The object over which the fingertip glides.
    pub const fn object(&self) -> &Shape {
        &self.object
    }

    /// The contact of a tip that is lowered vertically with its centre above `(x, y)`. The result is the first contact
    /// on the way down. It is on the same side of the object as the point of [`Surface::contact_at`].
    ///
    /// On planes, spheres, dishes and cylinders, the contact is computed by exact formulas. On other objects, Newton's
    /// method finds it, starting below the tip. On ellipsoids and tori, the tip fits at only one contact.
    ///
    /// On graphs, sixteen places under the tip are checked, about half a radius apart. The tip may touch elsewhere if
    /// the object extends into the tip at one of these places, or if the tip does not fit there. In this case, the
    /// heights under the tip are sampled on a grid with a spacing of a twelfth of the radius. Newton's method then
    /// starts from every local maximum of the tip's height, and the highest contact is returned. If the graph's second
    /// derivatives are below `1/radius`, this is always the first contact. Otherwise, the search may miss a narrow
    /// ridge between the places.
    ///
    /// # Errors
    /// [`GlideError`] if the tip has no contact, or if the search fails.
    pub fn touch(&self, x: f64, y: f64) -> Result<Touch, GlideError> {
        let is_near = (0.0..=MAX_DISTANCE).contains(&(x.abs() + y.abs()));
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
                    rugged: matches!(
                        self.object,
                        Shape::Paraboloid(_) | Shape::Saddle(_) | Shape::HeightField(_)
                    ),
                    centre,
                };
                search.contact()?.touch(radius)
            }
        }
    }
}
