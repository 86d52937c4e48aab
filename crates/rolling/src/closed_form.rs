//! Rolling on planes, spheres, dishes and cylinders by exact formulas (the model "closed form").
//!
//! On these objects, the components of the shape operator are constant in a parallel-transported basis. Therefore a
//! steady motion without spin moves the contact at constant speed along a geodesic of the object and along a great
//! circle of the probe. The contact frame on the object moves like a screw, that is, with constant rates of rotation
//! and translation.

use nalgebra::{Matrix2, UnitQuaternion, Vector2, Vector3};
use palpate_geometry::{CurvatureForm, TangentForm};

use crate::contact_equations::contact_velocity;
use crate::error::RollFault;
use crate::{Contact, Motion};

#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosedForm {
    /// The matrix `(K₁ + K̃₂)⁻¹`, with the curvature forms of probe and object in the contact frame. This matrix maps
    /// the angular velocity `[−ω_y, ω_x]` to the velocity of the contact on the probe.
    pub(crate) mobility: Matrix2<f64>,
    /// The object's curvature form `K̃₂` in the probe's contact frame.
    object: Matrix2<f64>,
}

impl ClosedForm {
    pub(crate) fn new(radius: f64, object: &CurvatureForm) -> Result<Self, RollFault> {
        let form = TangentForm::of_unit_normal(Vector3::z(), *object);
        let column = |drive: Vector2<f64>| contact_velocity(1.0 / radius, &form, &drive);
        Ok(Self {
            mobility: Matrix2::from_columns(&[column(Vector2::x())?, column(Vector2::y())?]),
            object: object.matrix(),
        })
    }

    /// The contact at the end of `motion`, which starts at the contact `from`. The motion must have no spin.
    #[inline]
    pub(crate) fn advance(&self, radius: f64, from: &Contact, motion: &Motion) -> Contact {
        let motion = motion.in_unit_time();
        let along = self.mobility * motion.drive_on_object(radius);
        let path = along - motion.sliding;
        let y_axis = from.y_axis();
        let displacement = from.x_axis * along.x + y_axis * along.y;
        let tilt = self.object * along;
        // `tilt` contains two components of the rate of change of the object's normal: along the axes x and y of the
        // contact frame. The frame rotates with the angular velocity `turn` = normal × (x tilt.x + y tilt.y). The z
        // axis of the frame points into the object, so the normal is −z, and the product is x tilt.y − y tilt.x.
        let turn = from.x_axis * tilt.y - y_axis * tilt.x;
        let screw = Screw::new(turn);
        Contact {
            on_object: from.on_object + screw.translation(&displacement),
            normal: screw.rotated(&from.normal),
            x_axis: screw.rotated(&from.x_axis),
            body_from_contact: roll_on_probe(from, path, radius),
            arc_length: from.arc_length + path.norm(),
        }
    }
}

/// Orientation of the probe's contact frame in its body frame, after the contact has moved along a great circle by
/// `path`. The components of `path` are in the probe's contact frame at the contact `from`.
pub(crate) fn roll_on_probe(
    from: &Contact,
    path: Vector2<f64>,
    radius: f64,
) -> UnitQuaternion<f64> {
    let turn = Vector3::new(-path.y, path.x, 0.0) / radius;
    from.body_from_contact * UnitQuaternion::from_scaled_axis(turn)
}

/// A rotation at a constant rate during one unit of time. `Screw` also computes the displacement of a point whose
/// velocity vector rotates at the same rate.
struct Screw {
    axis: Vector3<f64>,
    /// Four functions of the angle of rotation θ: sin θ, 1 − cos θ, sin θ/θ and (1 − cos θ)/θ.
    numbers: [f64; 4],
}

impl Screw {
    fn new(turn: Vector3<f64>) -> Self {
        let angle = turn.norm();
        if angle == 0.0 {
            return Self {
                axis: Vector3::zeros(),
                numbers: [0.0, 0.0, 1.0, 0.0],
            };
        }
        let (half_sine, half_cosine) = libm::sincos(0.5 * angle);
        let (sine, versine) = (2.0 * half_sine * half_cosine, 2.0 * half_sine * half_sine);
        let per_angle = 1.0 / angle;
        Self {
            axis: turn * per_angle,
            numbers: [sine, versine, sine * per_angle, versine * per_angle],
        }
    }

    fn rotated(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        let [sine, versine, ..] = self.numbers;
        let across = self.axis.cross(vector);
        vector + across * sine + self.axis.cross(&across) * versine
    }

    /// Displacement, during one unit of time, of a point whose velocity vector is `displacement` at the start and turns
    /// with this rotation.
    fn translation(&self, displacement: &Vector3<f64>) -> Vector3<f64> {
        let [.., sine, versine] = self.numbers;
        let along = self.axis * self.axis.dot(displacement);
        let across = displacement - along;
        along + across * sine + self.axis.cross(&across) * versine
    }
}
