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

use nalgebra::{Point3, Vector2, Vector3};
use palpate_geometry::surfaces::Sphere;
use palpate_geometry::{CurvatureForm, InvalidShape, Shape, Surface, SurfaceError};
use palpate_number::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

use foot::Foot;
use model::TouchRung;
use search::Search;

pub use model::{InvalidTouch, TouchModel};

/// Largest distance from the origin whose square is still a number.
const FARTHEST: f64 = 1e150;

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

/// Reasons for which a finger held at a place has no contact to report.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum GlideError {
    /// The contact would lie where the object is not defined; for a point, also beside a closed
    /// object.
    #[error("the finger left the object: {0}")]
    #[strum(transparent)]
    Surface(#[from] SurfaceError),
    /// The tip passes beside the object: the offset surface does not reach there, or only where the
    /// object's normal is horizontal.
    #[error("a tip of radius {radius} at x = {x}, y = {y} passes beside the object", radius = Number(*radius), x = Number(*x), y = Number(*y))]
    ContactLost {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
    },
    /// The tip rests on two places at once, or on a continuum of them: a dish, valley or hole
    /// that is as tight as the tip or tighter.
    #[error("a tip of radius {radius} at x = {x}, y = {y} touches at more than one place", radius = Number(*radius), x = Number(*x), y = Number(*y))]
    TwoContacts {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
    },
    /// The search for the contact came to no end: lengths too far apart for double precision, or an
    /// object too rough for the tip.
    #[error("no contact found for a tip of radius {radius} at x = {x}, y = {y}: off by {miss}", radius = Number(*radius), x = Number(*x), y = Number(*y), miss = Number(*miss))]
    NoConvergence {
        /// Coordinate x at which the tip's centre is held.
        x: f64,
        /// Coordinate y at which the tip's centre is held.
        y: f64,
        /// The tip's radius.
        radius: f64,
        /// Horizontal distance by which the best contact found misses.
        miss: f64,
    },
}

impl GlideError {
    fn two(radius: f64, centre: &Vector2<f64>) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::TwoContacts { x, y, radius }
    }

    fn unsettled(radius: f64, centre: &Vector2<f64>, miss: f64) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::NoConvergence { x, y, radius, miss }
    }

    fn lost(radius: f64, centre: &Vector2<f64>) -> Self {
        let (x, y) = (centre.x, centre.y);
        Self::ContactLost { x, y, radius }
    }

    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}

/// A contact of a fingertip, in the object's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The contact.
    pub point: Point3<f64>,
    /// The object's unit normal there, out of the object.
    pub normal: Vector3<f64>,
    /// The centre of the tip, `point + radius · normal`; of a point, the contact itself.
    pub tip_centre: Point3<f64>,
    /// The object's curvature there, in the orthonormal tangent basis along the level line and up
    /// the slope, right-handed with the normal: x and y where the ground is level.
    pub curvature: CurvatureForm,
}

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
