//! Motions of the probe that a user commands.

use nalgebra::{Vector2, Vector3};

/// A motion of the probe relative to the object. It is steady, that is, constant in the probe's contact frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Angular velocity `(ω_x, ω_y, ω_z)` (rad/s) in the probe's contact frame. `ω_z` is the spin about the contact
    /// normal.
    pub angular_velocity: Vector3<f64>,
    /// Sliding velocity `(v_x, v_y)` (length/s) of the probe in its contact frame.
    pub sliding: Vector2<f64>,
    /// Duration (s) of the motion.
    pub duration_s: f64,
}

impl Motion {
    /// Rolling with the angular speed `rate_rad_per_s`. On an isotropic object, the contact first moves in the
    /// direction with the angle `direction_rad`. The angle is measured from the object's +x (projected onto the tangent
    /// plane) towards `n × x`, where n is the object's normal.
    ///
    /// The rotation axis is the cross product of the object's normal and this direction. Directions that are multiples
    /// of a quarter turn are exact, up to a thousand quarter turns.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use palpate_rolling::Motion;
    ///
    /// // Half a radian per second for two seconds, towards +x.
    /// let motion = Motion::rolling(0.0, 0.5, 2.0);
    /// assert_eq!(motion.rotation(), Vector2::new(0.0, -1.0));
    /// ```
    pub fn rolling(direction_rad: f64, rate_rad_per_s: f64, duration_s: f64) -> Self {
        let (sin, cos) = sin_cos_exact(direction_rad);
        Self {
            // The second axis of the contact frame is y₁ = −n × x₁, where n is the object's normal. Therefore both
            // components have a negative sign.
            angular_velocity: Vector3::new(-sin, -cos, 0.0) * rate_rad_per_s,
            sliding: Vector2::zeros(),
            duration_s,
        }
    }

    /// The rotation `(Δθ_x, Δθ_y)` of the probe during the whole motion (rad).
    pub fn rotation(&self) -> Vector2<f64> {
        self.angular_velocity.xy() * self.duration_s
    }

    /// The part `[−ω_y, ω_x]` (rad/s) of the angular velocity, which moves the contact over the probe.
    pub(crate) fn drive(&self) -> Vector2<f64> {
        Vector2::new(-self.angular_velocity.y, self.angular_velocity.x)
    }

    /// The angular velocity (rad/s) that moves the contact over the object, for a probe of `radius`: the part `[−ω_y,
    /// ω_x]` of the angular velocity, plus the sliding velocity divided by the radius.
    pub(crate) fn drive_on_object(&self, radius: f64) -> Vector2<f64> {
        self.drive() + self.sliding / radius
    }

    /// The same rotation and sliding distance as a motion of 1 s. The squares of its rates do not overflow, even if the
    /// original rate and duration are extreme.
    pub(crate) fn in_unit_time(&self) -> Self {
        Self {
            angular_velocity: self.angular_velocity * self.duration_s,
            sliding: self.sliding * self.duration_s,
            duration_s: 1.0,
        }
    }

    /// The same motion with another duration.
    pub(crate) fn lasting(&self, duration_s: f64) -> Self {
        Self {
            duration_s,
            ..*self
        }
    }

    pub(crate) fn spins(&self) -> bool {
        self.angular_velocity.z != 0.0
    }

    pub(crate) fn slides(&self) -> bool {
        self.sliding != Vector2::zeros()
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.angular_velocity.iter().all(|w| w.is_finite())
            && self.sliding.iter().all(|v| v.is_finite())
            && self.duration_s.is_finite()
    }
}

/// Sine and cosine of an angle, exact at multiples of a quarter turn, so that a roll along an axis does not deviate
/// from the axis.
fn sin_cos_exact(angle_rad: f64) -> (f64, f64) {
    /// Only angles below this number of quarter turns are recognised as multiples of a quarter turn. The rounding error
    /// of such an angle is below 1e-12 quarter turns.
    const COUNTABLE: f64 = 1000.0;
    let quarters = angle_rad / std::f64::consts::FRAC_PI_2;
    let (sin, cos) = libm::sincos(angle_rad);
    let off = (quarters - quarters.round()).abs();
    if off < 1e-15 * quarters.abs().max(1.0) && quarters.abs() < COUNTABLE {
        (sin.round(), cos.round())
    } else {
        (sin, cos)
    }
}

#[cfg(test)]
mod tests {
    use super::Motion;

    #[test]
    fn a_direction_of_many_turns_is_a_direction() {
        for direction in [0.3, 1e6, 1e15, 1e20, 1e300] {
            let rate = Motion::rolling(direction, 2.0, 1.0).rotation().norm();
            assert!((rate - 2.0).abs() < 1e-15, "{direction:e}: {rate}");
        }
        let quarter = Motion::rolling(900.0 * std::f64::consts::FRAC_PI_2, 2.0, 1.0);
        assert_eq!(quarter.rotation().x, 0.0);
    }
}
