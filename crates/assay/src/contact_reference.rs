//! Closed-form solutions for contacts: the contact at the end of a roll of the unit sphere, and the contact of a round
//! fingertip.
//!
//! `palpate-rolling` computes most of these contacts by other methods, so the closed-form solutions are an independent
//! check. If a tip of radius r touches from above at the point p with outward normal n, the centre of the tip is p + r
//! n. All such centres form the offset surface. Some of the solutions contain one unknown number, which is found by
//! bisection or by fixed-point iteration.

use nalgebra::{Point3, Vector3};

/// The contact at the end of a roll.
pub struct RollEnd {
    /// Contact point on the object.
    pub on_object: Point3<f64>,
    /// Contact point on the probe.
    pub on_probe: Point3<f64>,
    /// Length of the contact's path, which is equal on the object and on the probe.
    pub path: f64,
}

impl RollEnd {
    /// The contact after rolling by the angle θ = `angle_rad` in this direction. The roll starts at the top of a ball
    /// that is centred at the origin. On a ball of radius R, the contact moves by s = θ/(1 + 1/R) along a great circle
    /// of the ball and a great circle of the probe.
    pub fn on_ball(radius: f64, direction: f64, angle_rad: f64) -> Self {
        let path = angle_rad / (1.0 + radius.recip());
        let (sine, cosine) = libm::sincos(path / radius);
        Self::new(direction, path, [radius * sine, radius * cosine])
    }

    /// The contact after rolling by the angle θ = `angle_rad`, starting at the apex of z = −c r². At the end, θ = α +
    /// s, because the probe has radius 1. Here α is the slope angle of the parabola, and s its arc length from the
    /// apex.
    pub fn on_paraboloid(c: f64, direction: f64, angle_rad: f64) -> Self {
        let length = |r: f64| {
            let slope = 2.0 * c * r;
            0.5 * r * libm::hypot(slope, 1.0) + libm::asinh(slope) / (4.0 * c)
        };
        let turned = |r: f64| libm::atan(2.0 * c * r) + length(r);
        let r = bisected(0.0, angle_rad, |r| turned(r) < angle_rad);
        Self::new(direction, length(r), [r, -c * r * r])
    }

    /// The end of a roll within a plane that contains the object's axis of symmetry. `path` is the length of the
    /// contact's path. The roll ends at a contact point with the distance `distance` from this axis and the height
    /// `height`.
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

/// Contact point of a spherical tip (radius `tip`) on a ball (radius `ball`) that is centred at the origin. `centre`
/// has the x and y coordinates of the tip's centre.
pub fn tip_on_ball(ball: f64, tip: f64, centre: [f64; 2]) -> [f64; 3] {
    let [x, y] = centre.map(|part| part * ball / (ball + tip));
    [x, y, (ball * ball - x * x - y * y).sqrt()]
}

/// Contact point of a tip of radius r on z = k x² + l y². Where the object is concave, the tip must be more curved than
/// the object. If the contact is at (x, y), the tip's centre is at (x (1 − 2kr/s), y (1 − 2lr/s)). Here s is the square
/// root of 1 + 4 (k²x² + l²y²). The unknown s is found by bisection.
pub fn tip_on_quadric([k, l]: [f64; 2], tip: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let at = |s: f64| [x / (1.0 - 2.0 * k * tip / s), y / (1.0 - 2.0 * l * tip / s)];
    let square = |[x, y]: [f64; 2]| 1.0 + 4.0 * ((k * x).powi(2) + (l * y).powi(2));
    // `most` is an upper bound of the unknown s = √(1 + 4 (k²x² + l²y²)). It is the value of s at a point (x, y) that
    // is farther from the z axis than the contact. On a concave object, this point is the result of the equations for s
    // = 1. On a convex object, it is the centre of the tip.
    let most = square(at(1.0)).max(square([x, y])).sqrt();
    let [x, y] = at(bisected(1.0, 1.0 + most, |s| s * s < square(at(s))));
    [x, y, k * x * x + l * y * y]
}

/// Contact point of a tip of radius r on an ellipsoid with the semi-axes a, b and c. If the contact is at (x, y, z),
/// the x coordinate of the tip's centre is x (1 + r/(g a²)) with g = |(x/a², y/b², z/c²)|. For the other coordinates, b
/// or c replaces a. The unknown g is found by bisection. NaN if the tip misses the ellipsoid.
pub fn tip_on_ellipsoid(semi_axes: [f64; 3], tip: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let squares = semi_axes.map(|axis| axis * axis);
    let at = |g: f64| {
        let shrunk = |part: f64, square: f64| part / (1.0 + tip / (g * square));
        let [x, y] = [shrunk(x, squares[0]), shrunk(y, squares[1])];
        let height = 1.0 - x * x / squares[0] - y * y / squares[1];
        // A larger value of the unknown g moves the contact away from the z axis. If g is too large, no point of the
        // ellipsoid has these x and y, and the result is `None`.
        (height >= 0.0).then(|| [x, y, (height * squares[2]).sqrt()])
    };
    let is_less = |g: f64| {
        at(g).is_some_and(|point| {
            let parts = [0, 1, 2].map(|axis| point[axis] / squares[axis]);
            g * g < parts.iter().map(|part| part * part).sum()
        })
    };
    // The unknown g of the equations lies between the reciprocals of the longest and the shortest semi-axis.
    let longest = semi_axes.into_iter().fold(0.0, f64::max);
    let shortest = semi_axes.into_iter().fold(f64::INFINITY, f64::min);
    let g = bisected(0.5 / longest, 2.0 / shortest, is_less);
    at(g).unwrap_or([f64::NAN; 3])
}

/// Contact point of a tip of radius r on z = a sin(x/l) cos(y/l). The surface must be less curved than the tip
/// everywhere. The point p is found by the iteration `p = centre − r n(p)`, where n(p) is the surface's normal. The
/// iteration starts with p = centre.
pub fn tip_on_waves([a, l]: [f64; 2], tip: f64, centre: [f64; 2]) -> [f64; 3] {
    let mut contact = centre;
    for _ in 0..100 {
        let [(sin_x, cos_x), (sin_y, cos_y)] = contact.map(|part| libm::sincos(part / l));
        let slope = [a / l * cos_x * cos_y, -a / l * sin_x * sin_y];
        let steep = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        contact = [0, 1].map(|axis| centre[axis] + tip * slope[axis] / steep);
    }
    let [x, y] = contact;
    [x, y, a * libm::sin(x / l) * libm::cos(y / l)]
}

/// The largest number for which `holds` returns true, found by bisection to the last bit. `holds` must return true for
/// all smaller numbers and false for all larger ones.
fn bisected(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    while let middle = 0.5 * (low + high)
        && low < middle
        && middle < high
    {
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
