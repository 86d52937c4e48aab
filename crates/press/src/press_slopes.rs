//! Slopes of a marker's displacement by what determines a press.
//!
//! u = C F(a, r) with C D(a) = δ, so ∂u/∂δ = F_a/D' and ∂u/∂ln C = C F − δ F_a/D'.

use crate::markers::Sight;
use crate::{Contact, Field};

/// Slopes by, in this order: the logarithm of the relative curvature; steps of the contact's place along the axes there;
/// indentation.
pub(crate) type Slopes = [f64; 4];

/// A contact of this indentation, with the slope of its radius.
pub(crate) struct PressSlopes {
    pub(crate) curvature: f64,
    pub(crate) indentation: f64,
    /// Derivative of the radius by D.
    pub(crate) per_d: f64,
}

impl PressSlopes {
    /// A contact whose D has this slope by its radius.
    pub(crate) fn new(contact: &Contact<'_>, slope: f64) -> Self {
        Self {
            curvature: contact.relative_curvature,
            indentation: contact.indentation,
            per_d: slope.recip(),
        }
    }

    fn by_log(&self, value: f64, per_a: f64) -> f64 {
        self.curvature * value - self.indentation * per_a * self.per_d
    }

    /// Slopes of the inward displacement, times a gain.
    #[inline(always)]
    pub(crate) fn normal(&self, field: &Field, sight: &Sight, gain: f64) -> Slopes {
        // A step of the contact towards the marker brings it nearer.
        let nearer = -self.curvature * field.normal_per_r;
        [
            gain * self.by_log(field.normal, field.normal_per_a),
            gain * nearer * sight.bearing.x,
            gain * nearer * sight.bearing.y,
            gain * (field.normal_per_a * self.per_d),
        ]
    }

    /// Slopes of the displacements along the skin.
    #[inline(always)]
    pub(crate) fn tangential(&self, field: &Field, sight: &Sight) -> [Slopes; 2] {
        let nearer = -self.curvature * field.radial_per_r;
        // A step across turns the view from the marker.
        let turn = if sight.reach > 1e-6 * sight.distance && sight.distance > 0.0 {
            -self.curvature * field.radial / sight.reach
        } else {
            -self.curvature * field.radial_per_r
        };
        let (bearing, outward) = (sight.bearing, sight.outward);
        let across = [-outward.y, outward.x];
        [0, 1].map(|axis| {
            let onward = outward[axis];
            [
                onward * self.by_log(field.radial, field.radial_per_a),
                nearer * bearing.x * onward - turn * bearing.y * across[axis],
                nearer * bearing.y * onward + turn * bearing.x * across[axis],
                onward * (field.radial_per_a * self.per_d),
            ]
        })
    }
}
