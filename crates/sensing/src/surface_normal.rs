//! Errors of measured surface normals.

use nalgebra::{Vector2, Vector3};
use palpate_statistics::BadSetting;

use crate::Stream;
use crate::sphere_map::moved_along;

/// Error of a measured normal: a tilt by independent Gaussian angles along two perpendicular tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalError {
    std_rad: f64,
}

impl NormalError {
    /// A tilt whose standard deviation along each tangent is `std_rad`.
    ///
    /// # Errors
    /// [`BadSetting`] unless the standard deviation is from 0 to π.
    pub fn new(std_rad: f64) -> Result<Self, BadSetting<String>> {
        let holds = (0.0..=std::f64::consts::PI).contains(&std_rad);
        BadSetting::unless(holds, "std_rad", std_rad, "from 0 to π")?;
        Ok(Self { std_rad })
    }

    /// Whether the error is random, that is, its standard deviation is not 0. Without an error, readings are exact, and
    /// no random numbers are drawn.
    pub fn is_random(&self) -> bool {
        self.std_rad > 0.0
    }

    /// The measured unit normal for the true unit normal `normal`. The two tilt angles are the components of a
    /// displacement along a great circle (exponential map), so tilts by any angle are possible. Draws two random
    /// numbers.
    #[inline]
    pub fn read(&self, stream: &mut Stream, normal: &Vector3<f64>) -> Vector3<f64> {
        if !self.is_random() {
            return *normal;
        }
        let tilt = Vector2::new(stream.standard_normal(), stream.standard_normal());
        moved_along(normal, &(tilt * self.std_rad)).normalize()
    }
}
