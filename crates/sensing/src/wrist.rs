//! A force and torque sensor in the wrist, which infers the contact point on the fingertip.

use nalgebra::{Vector2, Vector3};
use palpate_statistics::BadSetting;

use crate::sphere_map::moved_along;
use crate::{Stream, direction_at, displacement_between};

/// A wrist sensor that infers the contact point with an isotropic error on the fingertip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrist {
    std: f64,
    radius: f64,
}

impl Wrist {
    /// A sensor on a fingertip of `radius`. `std` (length) is the standard deviation of the inferred contact point
    /// along each tangent direction.
    ///
    /// # Errors
    /// [`BadSetting`] unless `0 < radius <= 1e300`, and `std` is at least 0 and at most 1e150 radii.
    pub fn new(std: f64, radius: f64) -> Result<Self, BadSetting<String>> {
        let holds = std >= 0.0 && std.is_finite();
        BadSetting::unless(holds, "std", std, "finite and at least 0")?;
        // The limit ensures that half the circumference of the fingertip is a finite length.
        let holds = radius > 0.0 && radius <= 1e300;
        BadSetting::unless(holds, "radius", radius, "above 0 and at most 1e300")?;
        let holds = std / radius <= 1e150;
        BadSetting::unless(holds, "std", std, "at most 1e150 times the probe's radius")?;
        Ok(Self { std, radius })
    }

    /// Standard deviation (length), along each tangent direction, of the displacement between two inferred contact
    /// points. It is √2 times the standard deviation of a single point, because the errors of both points are
    /// independent.
    pub fn shift_std(&self) -> f64 {
        std::f64::consts::SQRT_2 * self.std
    }

    /// The contact point that the sensor infers at one instant of a roll, as a displacement (length) from the first
    /// contact. The standard deviation of each component is the argument `std` of [`Wrist::new`].
    pub fn contact(&self, stream: &mut Stream, displacement: &Vector2<f64>) -> Vector2<f64> {
        let error = Vector2::new(stream.standard_normal(), stream.standard_normal());
        let contact = direction_at(&(displacement / self.radius));
        let inferred = moved_along(&contact, &(error * (self.std / self.radius)));
        displacement_between(&Vector3::z(), &inferred) * self.radius
    }

    /// The displacement (length) that the sensor infers for a true `displacement` (length, finite) from the first
    /// contact. Even for large errors, the result is at most half the circumference of the fingertip. Without noise,
    /// the error of the result is at most 1e-15 of the radius.
    pub fn read(&self, stream: &mut Stream, displacement: &Vector2<f64>) -> Vector2<f64> {
        let error = self.std / self.radius;
        let mut infer = |contact: Vector3<f64>| {
            let tangential = Vector2::new(stream.standard_normal(), stream.standard_normal());
            moved_along(&contact, &(tangential * error))
        };
        let first = infer(Vector3::z());
        let last = infer(direction_at(&(displacement / self.radius)));
        displacement_between(&first, &last) * self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Channel;
    use approx::assert_relative_eq;

    #[test]
    fn errors_have_the_stated_size_and_no_direction() {
        let wrist = Wrist::new(0.02, 1.0).unwrap();
        let displacement = Vector2::new(0.3, -0.2);
        let count = 40_000;
        let (mut mean, mut square) = (Vector2::zeros(), Vector2::zeros());
        for trial in 0..count {
            let mut stream = Stream::new(5, trial, Channel::WristContact);
            let error = wrist.read(&mut stream, &displacement) - displacement;
            mean += error / count as f64;
            square += error.component_mul(&error) / count as f64;
        }
        let bound = 4.0 * wrist.shift_std() / (count as f64).sqrt();
        assert!(mean.amax() < bound, "{mean}");
        for axis in 0..2 {
            assert_relative_eq!(square[axis].sqrt(), wrist.shift_std(), max_relative = 0.02);
        }
    }

    #[test]
    fn a_perfect_wrist_is_exact() {
        let wrist = Wrist::new(0.0, 2.0).unwrap();
        let mut stream = Stream::new(5, 0, Channel::WristContact);
        let displacement = Vector2::new(0.3, -0.2);
        let read = wrist.read(&mut stream, &displacement);
        assert!((read - displacement).norm() < 1e-15);
    }
}
