//! Random surfaces in closed form.

use nalgebra::{Point3, Vector3};
use palpate_sensing::Channel;

use super::Draws;

/// One of this many surfaces is a ball.
const BALL_EVERY: u64 = 5;
/// Largest coefficient of a quadric, per finger distance.
const MAX_COEFFICIENT: f64 = 0.12;
/// Smallest and largest radius of a ball, in finger distances.
const RADII: [f64; 2] = [3.0, 20.0];
/// Smallest and largest wave number.
const WAVE_NUMBERS: [f64; 2] = [0.4, 1.6];
/// Smallest and largest second derivative of a wave.
const SECOND_DERIVATIVES: [f64; 2] = [0.02, 0.25];

/// A random surface z(x, y), lengths in finger distances.
#[derive(Clone, Debug)]
pub(super) enum Surface {
    /// z = √(R² − x² − y²) − R.
    Ball { radius: f64 },
    /// z = a x² + b x y + c y² + Σ A sin(k·x + φ).
    Waves { quadric: [f64; 3], waves: [Wave; 2] },
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Wave {
    amplitude: f64,
    number: [f64; 2],
    phase: f64,
}

/// A place of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) point: Point3<f64>,
    /// Unit normal, upwards.
    pub(super) normal: Vector3<f64>,
    /// Gaussian and mean curvature, convex positive.
    pub(super) curvatures: [f64; 2],
}

impl Surface {
    /// The surface with this number.
    pub(super) fn random(seed: u64, index: u64) -> Self {
        let mut draws = Draws::new(seed, index, Channel::Misalignment);
        if index % BALL_EVERY == BALL_EVERY - 1 {
            return Self::Ball {
                radius: draws.log_between(RADII),
            };
        }
        let quadric = std::array::from_fn(|_| draws.between([-MAX_COEFFICIENT, MAX_COEFFICIENT]));
        let waves = std::array::from_fn(|_| {
            let number = draws.between(WAVE_NUMBERS);
            let direction = draws.between([0.0, std::f64::consts::TAU]);
            Wave {
                amplitude: draws.between(SECOND_DERIVATIVES) / (number * number),
                number: [number * libm::cos(direction), number * libm::sin(direction)],
                phase: draws.between([0.0, std::f64::consts::TAU]),
            }
        });
        Self::Waves { quadric, waves }
    }

    pub(super) const fn kind(&self) -> &'static str {
        match self {
            Self::Ball { .. } => "ball",
            Self::Waves { .. } => "quadric and waves",
        }
    }

    pub(super) fn at(&self, x: f64, y: f64) -> Place {
        match self {
            Self::Ball { radius } => {
                let height = (radius * radius - x * x - y * y).sqrt();
                Place {
                    point: Point3::new(x, y, height - radius),
                    normal: Vector3::new(x, y, height) / *radius,
                    curvatures: [1.0 / (radius * radius), 1.0 / radius],
                }
            }
            Self::Waves { quadric, waves } => point_on_waves(x, y, quadric, waves),
        }
    }
}

fn point_on_waves(x: f64, y: f64, [a, b, c]: &[f64; 3], waves: &[Wave]) -> Place {
    let mut z = a * x * x + b * x * y + c * y * y;
    let (mut p, mut q) = (2.0 * a * x + b * y, b * x + 2.0 * c * y);
    let (mut r, mut s, mut t) = (2.0 * a, *b, 2.0 * c);
    for wave in waves {
        let [k, l] = wave.number;
        let (sin, cos) = libm::sincos(k * x + l * y + wave.phase);
        let (sin, cos) = (wave.amplitude * sin, wave.amplitude * cos);
        z += sin;
        p += k * cos;
        q += l * cos;
        r -= k * k * sin;
        s -= k * l * sin;
        t -= l * l * sin;
    }
    let square = 1.0 + p * p + q * q;
    let twice = (1.0 + q * q) * r - 2.0 * p * q * s + (1.0 + p * p) * t;
    Place {
        point: Point3::new(x, y, z),
        normal: Vector3::new(-p, -q, 1.0) / square.sqrt(),
        curvatures: [
            (r * t - s * s) / (square * square),
            -0.5 * twice / (square * square.sqrt()),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curvatures_are_those_of_the_heights() {
        let step = 1e-4;
        for index in 0..10 {
            let surface = Surface::random(3, index);
            let z = |x: f64, y: f64| surface.at(x, y).point.z;
            let (x, y) = (0.4, -0.7);
            let p = (z(x + step, y) - z(x - step, y)) / (2.0 * step);
            let q = (z(x, y + step) - z(x, y - step)) / (2.0 * step);
            let square = 1.0 + p * p + q * q;
            let second = |u: f64, v: f64| {
                (z(x + u, y + v) - 2.0 * z(x, y) + z(x - u, y - v)) / (step * step)
            };
            let (r, t) = (second(step, 0.0), second(0.0, step));
            let s = 0.5 * (second(step, step) - r - t);
            let place = surface.at(x, y);
            let normal = Vector3::new(-p, -q, 1.0) / square.sqrt();
            assert!((place.normal - normal).norm() < 1e-7);
            let gaussian = (r * t - s * s) / (square * square);
            let twice = (1.0 + q * q) * r - 2.0 * p * q * s + (1.0 + p * p) * t;
            let mean = -0.5 * twice / (square * square.sqrt());
            assert!((place.curvatures[0] - gaussian).abs() < 1e-6);
            assert!((place.curvatures[1] - mean).abs() < 1e-6);
        }
    }
}
