//! The chart-free contact equations.
//!
//! `n` is the object's outward normal. `S₁ = I/R₁` and `S₂` are the shape operators of probe and object on the common
//! tangent plane. `ω` is the angular velocity and `v` the sliding velocity of the probe. `q̇` and `p` are the
//! velocities of the contact on the object and on the probe, and `x₁` and `y₁` the axes of the contact frame. The
//! equations are:
//!
//! ```text
//! (S₁ + S₂) q̇ = ω × n + S₁ v          contact on the object
//! (S₁ + S₂) p  = ω × n − S₂ v          contact on the probe
//! ẋ₁ = ω_z y₁ − (x₁·ṅ) n               transported axis, turned by spin
//! ```
//!
//! In the probe's body frame, the contact frame rotates with the angular velocity `(−p_y, p_x, 0)/R₁`.

use nalgebra::{Point3, Quaternion, UnitQuaternion, Vector2, Vector3};
use palpate_geometry::Surface;

use crate::contact_equations::{ContactEquations, contact_velocity};
use crate::error::RollFault;
use crate::integrator::System;
use crate::roller::Bodies;
use crate::{Contact, Motion};

/// Number of state components: x and y of the contact on the object; x and y of the axis `x₁` of the contact frame; the
/// quaternion `w, i, j, k` from the contact frame to the probe's body frame; z of `x₁`; z of the contact; the arc
/// length; and an unused component (an even number of components is faster).
const STATE: usize = 12;
/// Number of leading state components on which the derivative of the state depends, if the object is a general surface.
pub(crate) const OF_SPACE: usize = 10;
/// Number of leading state components on which the derivative of the state depends, if the object is a graph z = f(x,
/// y). On a graph, the derivative does not depend on the contact's height, which is the next component.
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
    /// Returns the contact equations for `motion`, and their state at the start of the motion. The motion starts at the
    /// contact `from`.
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

impl<S: Surface, const READ: usize> ContactEquations<STATE> for ChartFree<'_, S, READ> {
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
        // `x_dot` is the time derivative of the axis x. The component of `x_dot` along the gradient of the object's
        // level-set function keeps x tangent to the object.
        let per_square = 1.0 / object.steepness_squared;
        let x_dot = y * (self.spin * object.steepness * per_square)
            - object.gradient * (object.xx * per_square * c.x + object.xy * per_square * c.y);
        // `h1` and `h2` are half of the angular velocity with which the contact frame rotates in the probe's body
        // frame.
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
