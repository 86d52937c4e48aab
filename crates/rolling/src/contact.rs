//! The state of a rolling contact.

use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector2, Vector3};
use palpate_geometry::{Surface, SurfaceError};

/// A contact: its positions on both bodies, and the contact frame in which the components of a steady motion are
/// constant.
///
/// ```
/// use nalgebra::Point3;
/// use palpate_geometry::{Shape, Sphere};
/// use palpate_rolling::{Model, Motion, Roller, Rolls};
///
/// // A probe of radius 1 rests with its lowest point on a ball of radius 2.
/// let (probe, ball) = (Sphere::new(1.0)?, Shape::Sphere(Sphere::new(2.0)?));
/// let rolls = [vec![Motion::rolling(0.0, 0.1, 1.0)]];
/// let roller = Roller::new(probe, ball, (0.0, 0.0), Model::ClosedForm, Rolls::exact(&rolls))?;
/// let contact = roller.first_contact();
/// assert_eq!(contact.on_object, Point3::new(0.0, 0.0, 2.0));
/// assert!((contact.on_probe(1.0) - Point3::new(0.0, 0.0, -1.0)).norm() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The contact point on the object, in the object's frame.
    pub on_object: Point3<f64>,
    /// The object's unit normal at the contact point, out of the object.
    pub normal: Vector3<f64>,
    /// `x₁`, the first axis of the probe's contact frame, in the object's frame.
    pub x_axis: Vector3<f64>,
    /// The probe's contact frame `(x₁, y₁, z₁)` in the probe's body frame; `z₁` points from the probe's centre to the
    /// contact.
    pub body_from_contact: UnitQuaternion<f64>,
    /// Length of the path that the contact has moved on the probe since the start of the roll.
    pub arc_length: f64,
}

/// A displacement of the contact on the probe, measured from the contact point at the start of the roll.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// Great-circle displacement (logarithm map) in the probe's first contact frame `(x₁, y₁)`.
    pub displacement: Vector2<f64>,
    /// Length of the contact's path on the probe. It exceeds the length of the displacement if the path is curved.
    pub arc_length: f64,
}

impl Contact {
    /// The contact at the start of a roll, on `surface` at `(x, y)`, as in [`Surface::contact_at`].
    ///
    /// # Errors
    /// Errors of [`Surface::contact_at`].
    pub(crate) fn first<S: Surface>(surface: &S, x: f64, y: f64) -> Result<Self, SurfaceError> {
        let on_object = surface.contact_at(x, y)?;
        let normal = surface.level_set(&on_object)?.normal;
        // The first axis of the contact frame is +x, projected onto the tangent plane. On a wall whose normal is along
        // x, +y is projected instead.
        let along = [Vector3::x(), Vector3::y()]
            .into_iter()
            .map(|axis| axis - normal * normal.dot(&axis))
            .find(|projected| projected.norm() > 1e-6)
            .ok_or(SurfaceError::OffDomain { x, y })?;
        let x_axis = along.normalize();
        Ok(Self {
            on_object,
            normal,
            x_axis,
            body_from_contact: frame_quaternion(&x_axis, &normal),
            arc_length: 0.0,
        })
    }

    pub(crate) fn y_axis(&self) -> Vector3<f64> {
        self.x_axis.cross(&self.normal)
    }

    /// The contact point on a probe of `radius`, in the probe's body frame (centred on the probe).
    pub fn on_probe(&self, radius: f64) -> Point3<f64> {
        Point3::from(self.probe_direction() * radius)
    }

    pub(crate) fn probe_direction(&self) -> Vector3<f64> {
        self.body_from_contact * Vector3::z()
    }

    /// The probe's orientation relative to the object.
    pub fn object_from_probe(&self) -> Rotation3<f64> {
        let object_from_contact = frame_quaternion(&self.x_axis, &self.normal);
        (object_from_contact * self.body_from_contact.inverse()).to_rotation_matrix()
    }

    pub(crate) fn is_finite(&self) -> bool {
        // Check only the sum of all components, because it is not finite if a component is not finite. A sum of finite
        // components overflows only for extreme sizes.
        let vectors = self.on_object.coords + self.normal + self.x_axis;
        let turn = self.body_from_contact.coords.sum();
        (vectors.sum() + turn + self.arc_length).is_finite()
    }

    /// The displacement on a probe of `radius` from `first` to this contact, along the shortest great circle, as a
    /// sensor measures it. If the contact has moved by more than half a turn, this displacement leads the other way
    /// around the probe.
    pub fn shift_from(&self, first: &Self, radius: f64) -> Shift {
        let in_first_frame = first.body_from_contact.inverse() * self.probe_direction();
        Shift {
            displacement: logarithm(&in_first_frame) * radius,
            arc_length: self.arc_length,
        }
    }
}

/// The unit quaternion of the frame with axes `x`, `x × normal`, `−normal`.
pub(crate) fn frame_quaternion(x: &Vector3<f64>, normal: &Vector3<f64>) -> UnitQuaternion<f64> {
    let axes = Matrix3::from_columns(&[*x, x.cross(normal), -normal]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}

/// Logarithm map on the unit sphere at +z. The result is a vector in the (x, y) plane. It points from +z towards the
/// point `direction`, and its length is the angle between this point and +z. At −z, the direction is undefined, and the
/// result is along +x.
fn logarithm(direction: &Vector3<f64>) -> Vector2<f64> {
    let across = direction.xy();
    let sine = across.norm();
    if sine == 0.0 {
        return if direction.z >= 0.0 {
            Vector2::zeros()
        } else {
            Vector2::x() * std::f64::consts::PI
        };
    }
    across * (libm::atan2(sine, direction.z) / sine)
}

impl Shift {
    /// The shift (displacement on the probe) of a contact that has moved by `path` (length) along a great circle. The
    /// probe has the radius `radius`.
    ///
    /// ```
    /// use std::f64::consts::PI;
    /// use nalgebra::Vector2;
    /// use palpate_rolling::Shift;
    ///
    /// // Three quarters of a turn equal a quarter turn in the opposite direction.
    /// let shift = Shift::along_great_circle(Vector2::new(1.5 * PI, 0.0), 1.0);
    /// assert!((shift.displacement.x + 0.5 * PI).abs() < 1e-14);
    /// assert_eq!(shift.arc_length, 1.5 * PI);
    /// ```
    #[inline]
    pub fn along_great_circle(path: Vector2<f64>, radius: f64) -> Self {
        let arc_length = path.norm();
        let half_turn = std::f64::consts::PI * radius;
        let displacement = if arc_length <= half_turn {
            path
        } else {
            let angle = (arc_length + half_turn).rem_euclid(2.0 * half_turn) - half_turn;
            path * (angle / arc_length)
        };
        Self {
            displacement,
            arc_length,
        }
    }
}
