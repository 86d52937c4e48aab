//! Rolling through the apex of a surface of revolution.
//!
//! The contact runs along a meridian of the object and a great circle of the probe. With α the
//! angle by which the object's normal has turned and s the arc length, the probe has turned by
//! `θ = α + s/R₁`, which is solved for the meridian's parameter.

mod ellipse;

use nalgebra::Vector2;
use palpate_geometry::Meridian;

use crate::closed_form::roll_on_probe;
use crate::error::RollFault;
use crate::{Contact, Motion, Shift};

/// Largest number of iterations of Newton's or Halley's method with bisection in between; 3 are usual.
const MOST_ITERATIONS: usize = 200;

#[derive(Clone, Copy, Debug)]
pub(crate) struct MeridianRung {
    meridian: Meridian,
    radius: f64,
}

impl MeridianRung {
    /// A probe of `radius`, which must fit at the apex.
    pub(crate) const fn new(meridian: Meridian, radius: f64) -> Self {
        Self { meridian, radius }
    }

    /// The parameter and the arc length at which the probe has turned by `theta > 0`.
    fn solve(&self, theta: f64) -> Result<(f64, f64), RollFault> {
        match self.meridian {
            Meridian::Paraboloid { c } => along_parabola(c, self.radius, theta),
            Meridian::Spheroid { a, c } => self.along_ellipse(a, c, theta),
        }
        .filter(|(t, arc)| t.is_finite() && arc.is_finite())
        .ok_or(RollFault::NotFinite)
    }

    /// Newton's method; θ grows with the parameter, for the relative curvature is positive.
    fn along_ellipse(&self, a: f64, c: f64, theta: f64) -> Option<(f64, f64)> {
        let apex = self.meridian.slope(0.0);
        let rate = apex.slope_per_parameter + apex.arc_per_parameter / self.radius;
        let mut root = Bracket::new(theta / rate);
        for _ in 0..MOST_ITERATIONS {
            let t = root.at;
            let arc = ellipse::arc_length(a, c, t);
            let point = self.meridian.slope(t);
            let excess = point.slope_rad + arc / self.radius - theta;
            let slope = point.slope_per_parameter + point.arc_per_parameter / self.radius;
            root.step(excess, excess / slope);
            // Quadratic convergence: the next correction is below rounding.
            if (root.at - t).abs() <= 1e-8 * t {
                return Some((root.at, arc + (root.at - t) * point.arc_per_parameter));
            }
        }
        None
    }

    pub(crate) fn shift(&self, motion: &Motion) -> Result<Shift, RollFault> {
        let turn = motion.drive() * motion.duration_s;
        let theta = turn.norm();
        if theta == 0.0 {
            return Ok(Shift::default());
        }
        let (_, arc) = self.solve(theta)?;
        Ok(Shift::along_great_circle(turn * (arc / theta), self.radius))
    }

    /// The contact after `motion` from the apex.
    pub(crate) fn advance(&self, apex: &Contact, motion: &Motion) -> Result<Contact, RollFault> {
        let turn = motion.drive() * motion.duration_s;
        let theta = turn.norm();
        if theta == 0.0 {
            return Ok(*apex);
        }
        let (t, arc) = self.solve(theta)?;
        let point = self.meridian.at(t);
        let direction: Vector2<f64> = turn / theta;
        let outward = apex.x_axis * direction.x + apex.y_axis() * direction.y;
        // The frame turns about the tangent across the meridian.
        let [sin, cos] = point.normal;
        let along = outward * (1.0 - cos) + apex.normal * sin;
        Ok(Contact {
            on_object: apex.on_object + outward * point.r + apex.normal * point.height,
            normal: apex.normal * cos + outward * sin,
            x_axis: apex.x_axis - along * direction.x,
            body_from_contact: roll_on_probe(apex, direction * arc, self.radius),
            arc_length: apex.arc_length + arc,
        })
    }
}

/// Parameter and arc length at which a probe on `z = −c r²` has turned by `theta > 0`.
///
/// With q = 2|c|r the slope, σ the sign of c and a = 1/(2|c|R₁),
///
/// ```text
/// θ = σ atan q + a S(q),     S(q) = (q √(1+q²) + asinh q)/2 = 2|c| s
/// ```
///
/// is solved by Halley's method from the first three terms of its series or, where these are no
/// guide, from its behaviour at infinity.
fn along_parabola(c: f64, radius: f64, theta: f64) -> Option<(f64, f64)> {
    let (sign, steepening) = (c.signum(), 2.0 * c.abs());
    let a = 1.0 / (steepening * radius);
    if !(a * a).is_finite() {
        let arc = theta * radius;
        return Some((arc, arc));
    }
    let mut root = Bracket::new(first_slope(sign, a, theta));
    for _ in 0..MOST_ITERATIONS {
        let q = root.at;
        let ww = 1.0 + q * q;
        let w = ww.sqrt();
        // asinh q, with the root at hand.
        let asinh = libm::log1p(q + q * q / (1.0 + w));
        let arc = 0.5 * (q * w + asinh);
        let excess = sign * libm::atan(q) + a * arc - theta;
        let slope = sign / ww + a * w;
        let bend = q * (a / w - 2.0 * sign / (ww * ww));
        let newton = excess / slope;
        root.step(excess, newton / (1.0 - 0.5 * newton * bend / slope));
        // Cubic convergence: the next correction is below rounding.
        let step = root.at - q;
        if step.abs() <= 3e-6 * q {
            let arc = arc + step * (w + 0.5 * step * q / w);
            return Some((root.at / steepening, arc / steepening));
        }
    }
    None
}

/// First guess of the slope at which the probe has turned by `theta`.
fn first_slope(sign: f64, a: f64, theta: f64) -> f64 {
    // θ = (a + σ) q + (a/6 − σ/3) q³ + (σ/5 − a/40) q⁵ + …, of which this is the inverse.
    let rate = a + sign;
    let linear = theta / rate;
    let square = linear * linear;
    let cubic = square * (a / 6.0 - sign / 3.0) / rate;
    if cubic.abs() < 0.1 {
        let quintic = square * square * (sign / 5.0 - a / 40.0) / rate;
        return linear * (1.0 - cubic + 3.0 * cubic * cubic - quintic);
    }
    // S(q) tends to q²/2, atan q to about 1.2 rad or more.
    let y = ((theta - 1.2 * sign) / a).max(linear.min(1.0));
    y / libm::hypot(0.5 * y, 1.0).sqrt()
}

/// The root of a growing function, once it lies between two places.
struct Bracket {
    low: f64,
    high: f64,
    at: f64,
}

impl Bracket {
    fn new(at: f64) -> Self {
        Self {
            low: 0.0,
            high: f64::INFINITY,
            at,
        }
    }

    /// Moves by `−step`, as far as the sign of `excess`, the function's value here, allows.
    fn step(&mut self, excess: f64, step: f64) {
        if excess > 0.0 {
            self.high = self.at;
        } else {
            self.low = self.at;
        }
        let next = self.at - step;
        self.at = if excess == 0.0 || (next > self.low && next < self.high) {
            next
        } else if self.high.is_finite() {
            0.5 * (self.low + self.high)
        } else {
            2.0 * self.at
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The larger of two relative errors: that of θ, relative to its terms, and that of the arc length.
    fn error(c: f64, theta: f64) -> f64 {
        let (r, arc) = along_parabola(c, 1.0, theta).unwrap();
        let slope = 2.0 * c * r;
        let alpha = libm::atan(slope);
        let closed = 0.5 * r * (libm::hypot(slope, 1.0) + libm::asinh(slope) / slope);
        let off = (alpha + arc - theta).abs() / (alpha.abs() + arc);
        off.max((arc / closed - 1.0).abs())
    }

    #[test]
    fn parabolas_from_flat_to_sharp_however_far() {
        for exponent in -12..=12 {
            for mantissa in [1.0, 2.3, 4.999] {
                let c = mantissa * 10.0_f64.powi(exponent);
                // A bowl fits while 1/R₁ + 2c > 0.
                for c in [c, -c].into_iter().filter(|c| 1.0 + 2.0 * c > 0.0) {
                    for theta in [
                        1e-12, 1e-6, 0.1, 0.5, 1.0, 1.5, 1.6, 2.0, 3.0, 6.0, 100.0, 1e9,
                    ] {
                        let off = error(c, theta);
                        assert!(off < 1e-14, "c = {c:e}, θ = {theta:e}: {off:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_parabola_without_curvature_is_a_plane() {
        for c in [0.0, -0.0, 1e-300, -1e-300] {
            assert_eq!(along_parabola(c, 2.0, 0.7), Some((1.4, 1.4)));
        }
    }

    #[test]
    fn a_bowl_that_hardly_fits() {
        // 1/R₁ + 2c → 0: θ = q³/2 to leading order, and the contact runs ahead of the probe.
        let (r, _) = along_parabola(-0.5, 1.0, 1e-9).unwrap();
        assert!((r / libm::cbrt(2e-9_f64) - 1.0).abs() < 1e-5, "{r}");
    }
}
