//! Errors of measured surface normals.

use std::f64::consts::PI;

use nalgebra::{Rotation3, Vector2, Vector3};
use palpate_statistics::BadSetting;

use crate::Stream;
use crate::sphere_map::moved_along;

/// Error of a measured normal: a constant rotation about the y axis, then a tilt by independent Gaussian angles along two
/// perpendicular tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalError {
    std_rad: f64,
    bias_rad: f64,
}

impl NormalError {
    /// A constant rotation by `bias_rad` about the y axis, which turns +z towards +x, then a tilt whose standard deviation
    /// along each tangent is `std_rad`.
    ///
    /// # Errors
    /// [`BadSetting`] unless the standard deviation is from 0 to π and the bias is from −π to π.
    pub fn new(std_rad: f64, bias_rad: f64) -> Result<Self, BadSetting<String>> {
        let holds = (0.0..=PI).contains(&std_rad);
        BadSetting::unless(holds, "std_rad", std_rad, "from 0 to π")?;
        BadSetting::unless(bias_rad.abs() <= PI, "bias_rad", bias_rad, "from −π to π")?;
        Ok(Self { std_rad, bias_rad })
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
        let normal = match self.bias_rad {
            0.0 => *normal,
            bias_rad => Rotation3::from_axis_angle(&Vector3::y_axis(), bias_rad) * normal,
        };
        if !self.is_random() {
            return normal;
        }
        let tilt = Vector2::new(stream.standard_normal(), stream.standard_normal());
        moved_along(&normal, &(tilt * self.std_rad)).normalize()
    }
}
