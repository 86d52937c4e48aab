//! Errors of measured surface normals.

use nalgebra::{Vector2, Vector3};

use crate::sphere_map::moved_along;
use crate::{InvalidSensor, Stream};

/// Error of a measured normal: a tilt by independent Gaussian angles along two perpendicular tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalError {
    std_rad: f64,
}

impl NormalError {
    /// A tilt whose standard deviation along each tangent is `std_rad`.
    ///
    /// # Errors
    /// [`InvalidSensor`] unless the standard deviation is from 0 to π.
    pub fn new(std_rad: f64) -> Result<Self, InvalidSensor> {
        let holds = (0.0..=std::f64::consts::PI).contains(&std_rad);
        InvalidSensor::unless(holds, "std_rad", std_rad, "from 0 to π")?;
        Ok(Self { std_rad })
    }

    /// Whether the error is random. If it is not, readings are exact and draw no random numbers.
    pub fn is_random(&self) -> bool {
        self.std_rad > 0.0
    }

    /// The measured unit normal for a true unit `normal`. The two tilts are a displacement along a great circle
    /// (exponential map), so tilts of any size are valid. Draws two random numbers.
    #[inline]
    pub fn read(&self, stream: &mut Stream, normal: &Vector3<f64>) -> Vector3<f64> {
        if !self.is_random() {
            return *normal;
        }
        let tilt = Vector2::new(stream.standard_normal(), stream.standard_normal());
        moved_along(normal, &(tilt * self.std_rad)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Channel;
    use approx::assert_relative_eq;

    fn normals() -> [Vector3<f64>; 5] {
        [
            Vector3::z(),
            -Vector3::z(),
            Vector3::y(),
            Vector3::x(),
            Vector3::new(0.36, -0.48, 0.8),
        ]
    }

    #[test]
    fn tilts_have_the_stated_size_and_no_direction() {
        let sensor = NormalError::new(0.05).unwrap();
        for normal in normals() {
            let mut stream = Stream::new(12, 0, Channel::Normal);
            let count = 40_000;
            let (mut sum, mut square, mut tilts) =
                (Vector3::zeros(), nalgebra::Matrix3::zeros(), 0.0);
            for _ in 0..count {
                let read = sensor.read(&mut stream, &normal);
                assert!((read.norm() - 1.0).abs() < 1e-15);
                let across = read - normal * normal.dot(&read);
                sum += across;
                square += across * across.transpose();
                tilts += libm::atan2(normal.cross(&read).norm(), normal.dot(&read)).powi(2);
            }
            let count = f64::from(count);
            assert!(sum.norm() / count < 0.05 * 3.0 / count.sqrt() * 1.5);
            assert_relative_eq!(
                (tilts / count).sqrt(),
                0.05 * 2.0_f64.sqrt(),
                max_relative = 0.02
            );
            // For a small standard deviation σ of the tilt, the normal n has the covariance σ² (I − n nᵀ). Terms of
            // higher order in σ are neglected.
            let expected = nalgebra::Matrix3::identity() - normal * normal.transpose();
            assert!((square / count / 0.0025 - expected).amax() < 0.03);
        }
    }

    #[test]
    fn tilts_beyond_a_half_turn_stay_unit_vectors() {
        let sensor = NormalError::new(3.0).unwrap();
        let mut stream = Stream::new(12, 1, Channel::Normal);
        let mut mean = Vector3::zeros();
        for _ in 0..10_000 {
            let read = sensor.read(&mut stream, &Vector3::x());
            assert!((read.norm() - 1.0).abs() < 1e-15);
            mean += read / 1e4;
        }
        // The tilt angle has a Rayleigh distribution with σ = 3. The mean of its cosine is 1 − √2 σ D(σ/√2), with
        // Dawson's integral D.
        let expected = Vector3::x() * -0.1795;
        assert!((mean - expected).norm() < 0.03, "{mean}");
    }

    #[test]
    fn without_an_error_nothing_is_drawn() {
        let sensor = NormalError::new(0.0).unwrap();
        assert!(!sensor.is_random());
        let mut stream = Stream::new(12, 0, Channel::Normal);
        for normal in normals() {
            assert_eq!(sensor.read(&mut stream, &normal), normal);
        }
        let untouched = Stream::new(12, 0, Channel::Normal).symmetric_uniform();
        assert_eq!(stream.symmetric_uniform(), untouched);
    }

    #[test]
    fn impossible_deviations_are_refused() {
        for std_rad in [-0.1, 4.0, f64::NAN, f64::INFINITY] {
            assert_eq!(NormalError::new(std_rad).unwrap_err().setting, "std_rad");
        }
    }
}
