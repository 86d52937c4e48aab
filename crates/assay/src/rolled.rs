//! Closed forms of the contact at the end of rolls of the unit sphere. `palpate-rolling` computes most of these
//! contacts in another way, so this is an independent check.

use nalgebra::{Point3, Vector3};

/// Contact at the end of a roll.
pub struct End {
    /// Contact point on the object.
    pub on_object: Point3<f64>,
    /// Contact point on the probe.
    pub on_probe: Point3<f64>,
    /// Length of the contact's path, equal on object and probe.
    pub path: f64,
}

impl End {
    /// End of a roll by `angle_rad` = θ in this direction, from the top of a ball centred at the origin. On a ball of
    /// radius R the contact moves by s = θ/(1 + 1/R), along great circles of ball and probe.
    pub fn on_ball(radius: f64, direction: f64, angle_rad: f64) -> Self {
        let path = angle_rad / (1.0 + radius.recip());
        let (sine, cosine) = libm::sincos(path / radius);
        Self::new(direction, path, [radius * sine, radius * cosine])
    }

    /// End of a roll by `angle_rad` = θ from the apex of z = −c r², where θ = α + s, α is the angle of the slope at
    /// the end, and s the length of the parabola up to it.
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

    /// End of a roll in the plane of a meridian. `path` is the length of the contact's path. `distance` (from the
    /// axis) and `height` locate the last contact point on the object.
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
