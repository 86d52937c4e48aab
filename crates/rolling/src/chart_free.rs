//! The chart-free form of the contact equations.
//!
//! With `n` the object's outward normal, `S₁ = I/R₁` and `S₂` the shape operators on the common
//! tangent plane, `ω` and `v` the motion of the probe:
//!
//! ```text
//! (S₁ + S₂) q̇ = ω × n + S₁ v          contact on the object
//! (S₁ + S₂) p  = ω × n − S₂ v          contact on the probe
//! ẋ₁ = ω_z y₁ − (x₁·ṅ) n               transported axis, turned by spin
//! ```
//!
//! The probe's contact frame in its body turns at `(−p_y, p_x, 0)/R₁`.

use nalgebra::{Point3, Quaternion, UnitQuaternion, Vector2, Vector3};
use palpate_geometry::{CurvatureForm, Surface};

use crate::error::RollFault;
use crate::integrator::System;
use crate::{Contact, Motion};

/// Components: contact on the object (3), `x₁` (3), body-from-contact quaternion `w, i, j, k` (4),
/// arc length.
pub(crate) const STATE: usize = 11;
pub(crate) const SPACE: usize = 10;
pub(crate) const GRAPH: usize = 9;

pub(crate) struct ChartFree<'a, S, const READ: usize> {
    surface: &'a S,
    probe_curvature: f64,
    motion: &'a Motion,
    inverse_length: f64,
}

impl<'a, S: Surface, const READ: usize> ChartFree<'a, S, READ> {
    /// `length` is the scale on which errors of position count.
    pub(crate) fn new(surface: &'a S, radius: f64, motion: &'a Motion, length: f64) -> Self {
        Self {
            surface,
            probe_curvature: 1.0 / radius,
            motion,
            inverse_length: 1.0 / length,
        }
    }

    pub(crate) fn state(contact: &Contact) -> [f64; STATE] {
        let q = &contact.on_object;
        let x = &contact.x_axis;
        let f = contact.body_from_contact.quaternion();
        let s = contact.arc_length;
        [q.x, q.y, x.x, x.y, f.w, f.i, f.j, f.k, x.z, q.z, s]
    }

    pub(crate) fn contact(&self, state: &[f64; STATE]) -> Result<Contact, RollFault> {
        let [qx, qy, xx, xy, w, i, j, k, xz, qz, arc_length] = *state;
        let on_object = Point3::new(qx, qy, qz);
        let normal = self.surface.level_set(&on_object)?.normal;
        let x = Vector3::new(xx, xy, xz);
        Ok(Contact {
            on_object,
            normal,
            x_axis: (x - normal * normal.dot(&x)).normalize(),
            body_from_contact: UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)),
            arc_length,
        })
    }
}

/// The velocities of the contact on object and probe in the contact frame, for a motion with
/// `drive = [−ω_y, ω_x]` and `sliding` velocity.
#[inline]
pub(crate) fn contact_velocities(
    probe_curvature: f64,
    object: &CurvatureForm,
    drive: &Vector2<f64>,
    sliding: &Vector2<f64>,
) -> Result<(Vector2<f64>, Vector2<f64>), RollFault> {
    let a11 = probe_curvature + object.k_uu;
    let a22 = probe_curvature + object.k_vv;
    let a12 = object.k_uv;
    let determinant = a11 * a22 - a12 * a12;
    // Positive definite, with room for the rounding of the sums.
    let largest = a11.max(a22);
    let floor = 4.0 * f64::EPSILON * (probe_curvature * largest);
    if !(a11 > 0.0 && determinant > floor) {
        return Err(not_positive(probe_curvature, object, determinant));
    }
    let g1 = drive.x + probe_curvature * sliding.x;
    let g2 = drive.y + probe_curvature * sliding.y;
    let inverse = 1.0 / determinant;
    let on_object = Vector2::new(
        (a22 * g1 - a12 * g2) * inverse,
        (a11 * g2 - a12 * g1) * inverse,
    );
    Ok((on_object, on_object - sliding))
}

#[cold]
fn not_positive(probe_curvature: f64, object: &CurvatureForm, determinant: f64) -> RollFault {
    let relative_curvature = probe_curvature + object.principal().k_min;
    if determinant.is_finite() {
        RollFault::Conforming { relative_curvature }
    } else {
        RollFault::NotFinite
    }
}

impl<S: Surface, const READ: usize> System<STATE> for ChartFree<'_, S, READ> {
    const READ: usize = READ;

    #[inline]
    fn derivative(&self, state: &[f64; STATE], rate: &mut [f64; STATE]) -> Result<(), RollFault> {
        let [qx, qy, xx, xy, w, i, j, k, xz, qz, _] = *state;
        let x = Vector3::new(xx, xy, xz);
        let (n, object) = self.surface.curvature_along(&Point3::new(qx, qy, qz), &x)?;
        let y = x.cross(&n);
        let (c, p) = contact_velocities(
            self.probe_curvature,
            &object,
            &self.motion.drive(),
            &self.motion.sliding,
        )?;
        let velocity = x * c.x + y * c.y;
        let turn = object.k_uu * c.x + object.k_uv * c.y;
        let x_dot = y * self.motion.angular_velocity.z - n * turn;
        // Half the angular velocity of the contact frame in the body.
        let (h1, h2) = (
            -0.5 * self.probe_curvature * p.y,
            0.5 * self.probe_curvature * p.x,
        );
        *rate = [
            velocity.x,
            velocity.y,
            x_dot.x,
            x_dot.y,
            -i * h1 - j * h2,
            w * h1 - k * h2,
            w * h2 + k * h1,
            i * h2 - j * h1,
            x_dot.z,
            velocity.z,
            p.norm(),
        ];
        Ok(())
    }

    #[inline]
    fn error_weights(&self) -> [f64; STATE] {
        let l = self.inverse_length;
        [l, l, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 1.0, l, l]
    }
}
