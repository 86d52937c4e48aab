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
use palpate_geometry::{CurvatureForm, Surface, TangentForm};

use crate::bodies::Bodies;
use crate::error::RollFault;
use crate::form::Form;
use crate::integrator::System;
use crate::{Contact, Motion};

/// Components: x and y of the contact on the object and of `x₁`, the body-from-contact quaternion
/// `w, i, j, k`, then z of `x₁` and of the contact, arc length, and a spare one: pairs are cheaper.
const STATE: usize = 12;
/// Number of components that the derivative reads in general.
pub(crate) const OF_SPACE: usize = 10;
/// Number of components that it reads on a graph, where nothing depends on the height.
pub(crate) const OF_GRAPHS: usize = 9;

pub(crate) struct ChartFree<'a, S, const READ: usize> {
    object: &'a S,
    probe_curvature: f64,
    drive: Vector2<f64>,
    sliding: Vector2<f64>,
    spin: f64,
    inverse_length: f64,
}

impl<'a, S: Surface, const READ: usize> ChartFree<'a, S, READ> {
    /// The system and its state at `from`.
    pub(crate) fn new(
        bodies: &Bodies<'a, S>,
        from: &Contact,
        motion: &Motion,
    ) -> (Self, [f64; STATE]) {
        let form = Self {
            object: bodies.object,
            probe_curvature: 1.0 / bodies.probe.radius(),
            drive: motion.drive_on_object(bodies.probe.radius()),
            sliding: motion.sliding,
            spin: motion.angular_velocity.z,
            inverse_length: 1.0 / bodies.length_scale,
        };
        let (q, x) = (&from.on_object, &from.x_axis);
        let f = from.body_from_contact.quaternion();
        let s = from.arc_length;
        (
            form,
            [q.x, q.y, x.x, x.y, f.w, f.i, f.j, f.k, x.z, q.z, s, 0.0],
        )
    }
}

impl<S: Surface, const READ: usize> Form<STATE> for ChartFree<'_, S, READ> {
    fn contact(&self, state: &[f64; STATE]) -> Result<Contact, RollFault> {
        let [qx, qy, xx, xy, w, i, j, k, xz, qz, arc_length, _] = *state;
        let on_object = Point3::new(qx, qy, qz);
        let normal = self.object.level_set(&on_object)?.normal;
        let x = Vector3::new(xx, xy, xz);
        Ok(Contact {
            on_object,
            normal,
            x_axis: (x - normal * normal.dot(&x)).normalize(),
            body_from_contact: UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)),
            arc_length,
        })
    }

    fn place(&self, state: &[f64; STATE]) -> Option<Point3<f64>> {
        Some(Point3::new(state[0], state[1], state[9]))
    }
}

/// The contact's velocity on the object in the tangent basis `(x, y)` of `object`, driven by
/// `(K₁ + K₂) c = drive` (in orthonormal axes).
///
/// With `W = |∇F|` the equations read, multiplied through by `W` along `x` and by `W²` along `y`:
///
/// ```text
/// [ W/R₁ + F_xx        F_xy     ] [c_x]   [ W  drive_x ]
/// [     F_xy      W³/R₁ + F_yy  ] [c_y] = [ W² drive_y ]
/// ```
#[inline]
pub(crate) fn contact_velocity(
    probe_curvature: f64,
    object: &TangentForm,
    drive: &Vector2<f64>,
) -> Result<Vector2<f64>, RollFault> {
    let (w, ww) = (object.steepness, object.steepness_squared);
    let a11 = probe_curvature * w + object.xx;
    let a22 = probe_curvature * ww * w + object.yy;
    let a12 = object.xy;
    let determinant = a11 * a22 - a12 * a12;
    // Positive definite, with room for the rounding of the sums.
    let floor = 4.0 * f64::EPSILON * probe_curvature * w * (a11 * ww + a22);
    if !(a11 > 0.0 && determinant > floor) {
        return Err(not_positive(probe_curvature, *object, determinant));
    }
    let (g1, g2) = (w * drive.x, ww * drive.y);
    Ok(Vector2::new(
        (a22 * g1 - a12 * g2) / determinant,
        (a11 * g2 - a12 * g1) / determinant,
    ))
}

/// The velocities of the contact on object and probe in the contact frame.
pub(crate) fn contact_velocities(
    radius: f64,
    object: &CurvatureForm,
    motion: &Motion,
) -> Result<(Vector2<f64>, Vector2<f64>), RollFault> {
    let form = TangentForm::of_unit_normal(Vector3::z(), *object);
    let on_object = contact_velocity(1.0 / radius, &form, &motion.drive_on_object(radius))?;
    Ok((on_object, on_object - motion.sliding))
}

#[cold]
fn not_positive(probe_curvature: f64, object: TangentForm, determinant: f64) -> RollFault {
    let relative_curvature = probe_curvature + object.curvature().principal().k_min;
    if determinant.is_finite() && relative_curvature.is_finite() {
        RollFault::Conforming { relative_curvature }
    } else {
        RollFault::NotFinite
    }
}

impl<S: Surface, const READ: usize> System<STATE> for ChartFree<'_, S, READ> {
    const READ: usize = READ;

    #[inline]
    fn derivative(&self, state: &[f64; STATE], rate: &mut [f64; STATE]) -> Result<(), RollFault> {
        let [qx, qy, xx, xy, w, i, j, k, xz, qz, _, _] = *state;
        let x = Vector3::new(xx, xy, xz);
        let object = self.object.tangent_form(&Point3::new(qx, qy, qz), &x)?;
        let y = x.cross(&object.gradient);
        let c = contact_velocity(self.probe_curvature, &object, &self.drive)?;
        let velocity = x * c.x + y * c.y;
        // ẋ along the gradient keeps x tangent.
        let per_square = 1.0 / object.steepness_squared;
        let x_dot = y * (self.spin * object.steepness * per_square)
            - object.gradient * (object.xx * per_square * c.x + object.xy * per_square * c.y);
        // Half the angular velocity of the contact frame in the body.
        let half = 0.5 * self.probe_curvature;
        let p = (
            c.x - self.sliding.x,
            c.y * object.steepness - self.sliding.y,
        );
        let (h1, h2) = (-half * p.1, half * p.0);
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
            (p.0 * p.0 + p.1 * p.1).sqrt(),
            0.0,
        ];
        Ok(())
    }

    #[inline]
    fn error_weights(&self) -> [f64; STATE] {
        let l = self.inverse_length;
        [l, l, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 1.0, l, l, 0.0]
    }
}
