//! Ends of rolls of the unit sphere in closed form. `palpate-rolling` computes most of them in another way, so this is
//! an independent check.

use nalgebra::{Point3, Vector3};

/// Contact at the end of a roll.
pub struct End {
    /// Its place on the object.
    pub on_object: Point3<f64>,
    /// Its place on the probe.
    pub on_probe: Point3<f64>,
    /// Length of its path on either.
    pub path: f64,
}

impl End {
    /// End of a roll by `angle_rad` from the top of a ball about the origin, in this direction. On a ball of radius R the
    /// contact moves by s = θ/(1 + 1/R), along great circles of both.
    pub fn on_ball(radius: f64, direction: f64, angle_rad: f64) -> Self {
        let path = angle_rad / (1.0 + radius.recip());
        let (sine, cosine) = libm::sincos(path / radius);
        Self::new(direction, path, [radius * sine, radius * cosine])
    }

    /// End of a roll by `angle_rad` from the apex of z = −c r²: the probe has turned by θ = α + s, where α is the slope's
    /// angle and s the length of the parabola.
    pub fn on_paraboloid(c: f64, direction: f64, angle_rad: f64) -> Self {
        let length = |r: f64| {
            let slope = 2.0 * c * r;
            0.5 * r * libm::hypot(slope, 1.0) + libm::asinh(slope) / (4.0 * c)
        };
        let turned = |r: f64| libm::atan(2.0 * c * r) + length(r);
        let (mut low, mut high) = (0.0, angle_rad);
        while let middle = 0.5 * (low + high)
            && low < middle
            && middle < high
        {
            if turned(middle) < angle_rad {
                low = middle;
            } else {
                high = middle;
            }
        }
        Self::new(direction, length(low), [low, -c * low * low])
    }

    /// End of a roll in the plane of a meridian. `path` is its length; the last contact on the object has this distance
    /// from the axis and this height.
    fn new(direction: f64, path: f64, [distance, height]: [f64; 2]) -> Self {
        let ahead = Vector3::new(libm::cos(direction), libm::sin(direction), 0.0);
        let (sine, cosine) = libm::sincos(path);
        Self {
            on_object: Point3::from(ahead * distance + Vector3::z() * height),
            on_probe: Point3::from(ahead * sine - Vector3::z() * cosine),
            path,
        }
    }
}
