//! Rolling on planes, spheres, dishes and cylinders, in closed form.
//!
//! There the shape operator is constant in a parallel-transported basis, so that a steady motion
//! without spin moves the contact along a geodesic of the object and a great circle of the probe,
//! both at constant speed. The contact frame on the object moves by a screw.

use nalgebra::{Matrix2, UnitQuaternion, Vector2, Vector3};
use palpate_geometry::{CurvatureForm, Surface, TangentForm};

use crate::chart_free::{contact_velocities, contact_velocity};
use crate::error::RollFault;
use crate::{Contact, Motion};

/// The contact after `motion` (without spin) from `from`, on a homogeneous surface.
pub(crate) fn advance<S: Surface>(
    surface: &S,
    radius: f64,
    from: &Contact,
    motion: &Motion,
) -> Result<Contact, RollFault> {
    let (_, object) = surface.curvature_along(&from.on_object, &from.x_axis)?;
    let y_axis = from.y_axis();
    let (along, path) = contact_velocities(radius, &object, &motion.in_unit_time())?;
    let displacement = from.x_axis * along.x + y_axis * along.y;
    let normal_turn = object.matrix() * along;
    let turn = from
        .normal
        .cross(&(from.x_axis * normal_turn.x + y_axis * normal_turn.y));
    let rotation = UnitQuaternion::from_scaled_axis(turn);
    Ok(Contact {
        on_object: from.on_object + screw_translation(&displacement, &turn),
        normal: rotation * from.normal,
        x_axis: rotation * from.x_axis,
        body_from_contact: roll_on_probe(from, path, radius),
        arc_length: from.arc_length + path.norm(),
    })
}

/// The probe's contact frame in its body after the contact has run along a great circle by `path`
/// (components in that frame).
pub(crate) fn roll_on_probe(
    from: &Contact,
    path: Vector2<f64>,
    radius: f64,
) -> UnitQuaternion<f64> {
    let turn = Vector3::new(-path.y, path.x, 0.0) / radius;
    from.body_from_contact * UnitQuaternion::from_scaled_axis(turn)
}

/// Where a point gets that starts with velocity `displacement` (per unit time) while the velocity
/// turns at the constant rate `turn`, after unit time.
fn screw_translation(displacement: &Vector3<f64>, turn: &Vector3<f64>) -> Vector3<f64> {
    let angle = turn.norm();
    if angle == 0.0 {
        return *displacement;
    }
    let axis = turn / angle;
    let along = axis * axis.dot(displacement);
    let across = displacement - along;
    let half = (0.5 * angle).sin();
    along + across * (angle.sin() / angle) + axis.cross(&across) * (2.0 * half * half / angle)
}

/// The velocity of the contact on the probe per `[−ω_y, ω_x]`: `(K₁ + K̃₂)⁻¹`.
pub(crate) fn mobility(radius: f64, object: &CurvatureForm) -> Result<Matrix2<f64>, RollFault> {
    let form = TangentForm::of_unit_normal(Vector3::z(), *object);
    let column = |drive: Vector2<f64>| contact_velocity(1.0 / radius, &form, &drive);
    Ok(Matrix2::from_columns(&[
        column(Vector2::x())?,
        column(Vector2::y())?,
    ]))
}
