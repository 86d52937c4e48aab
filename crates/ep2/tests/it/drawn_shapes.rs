//! Contacts with noise on random shapes at random positions.

use std::f64::consts::PI;

use nalgebra::{Point3, Rotation3, Vector3};
use palpate_ep2::Contact;
use palpate_sensing::{Channel, Stream};

pub(super) struct Random(Stream);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(Stream::new(seed, 0, Channel::Position))
    }

    pub(super) fn uniform(&mut self) -> f64 {
        0.5 + 0.5 * self.0.symmetric_uniform()
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// A number between `low` and `high` whose logarithm is uniformly distributed.
    pub(super) fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.uniform())
    }

    pub(super) fn normal(&mut self) -> f64 {
        self.0.standard_normal()
    }

    pub(super) fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.normal(), self.normal(), self.normal())
    }

    pub(super) fn rotation(&mut self) -> Rotation3<f64> {
        let axis = self.vector().normalize();
        Rotation3::new(axis * self.between(0.0, PI))
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Surface {
    Plane,
    Sphere(f64),
    Cylinder(f64),
    /// The saddle w = −(u² − r v²)/2R with the values R and r.
    Saddle(f64, f64),
    /// Outer side of a torus, with two radii: the radius of the tube, and the radius of the circle on which the centre
    /// of the tube lies.
    Torus(f64, f64),
    /// The wave w = a sin(2π u / l + phase): amplitude a, wavelength l and phase.
    Wave(f64, f64, f64),
}

impl Surface {
    pub(super) fn at(&self, u: f64, v: f64) -> (Vector3<f64>, Vector3<f64>) {
        let graph =
            |w: f64, p: f64, q: f64| (Vector3::new(u, v, w), Vector3::new(-p, -q, 1.0).normalize());
        match *self {
            Self::Plane => graph(0.0, 0.0, 0.0),
            Self::Sphere(radius) => {
                let distance = u.hypot(v);
                let angle = distance / radius;
                let (sin, cos) = (libm::sin(angle), libm::cos(angle));
                let [x, y] = if distance > 0.0 {
                    [u / distance, v / distance]
                } else {
                    [0.0; 2]
                };
                let normal = Vector3::new(sin * x, sin * y, cos);
                (normal * radius - Vector3::z() * radius, normal)
            }
            Self::Cylinder(radius) => {
                let normal = Vector3::new(0.0, libm::sin(v / radius), libm::cos(v / radius));
                (
                    normal * radius - Vector3::z() * radius + Vector3::x() * u,
                    normal,
                )
            }
            Self::Saddle(radius, ratio) => graph(
                -(u * u - ratio * v * v) / (2.0 * radius),
                -u / radius,
                ratio * v / radius,
            ),
            Self::Torus(tube, ring) => {
                let (turn, bend) = (u / (ring + tube), v / tube);
                let out = Vector3::new(libm::sin(turn), 0.0, libm::cos(turn));
                let normal = out * libm::cos(bend) + Vector3::y() * libm::sin(bend);
                (
                    out * ring + normal * tube - Vector3::z() * (ring + tube),
                    normal,
                )
            }
            Self::Wave(height, length, phase) => {
                let turn = 2.0 * PI * u / length + phase;
                let slope = 2.0 * PI * height / length * libm::cos(turn);
                graph(height * libm::sin(turn), slope, 0.0)
            }
        }
    }

    pub(super) fn disc(
        &self,
        random: &mut Random,
        radius: f64,
        count: usize,
    ) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let mut all = Vec::with_capacity(count);
        while all.len() < count {
            let (u, v) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
            if u * u + v * v <= 1.0 {
                all.push(self.at(u * radius, v * radius));
            }
        }
        all
    }

    /// Contacts of `fingers` strokes along u, in a square with the half-width `half` around the pole. Each stroke has
    /// `each` contacts.
    pub(super) fn strokes(
        &self,
        half: f64,
        fingers: usize,
        each: usize,
    ) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let place = |index: usize, count: usize| match count {
            1 => 0.0,
            _ => half * (2.0 * index as f64 / (count - 1) as f64 - 1.0),
        };
        (0..fingers * each)
            .map(|index| self.at(place(index % each, each), place(index / each, fingers)))
            .collect()
    }
}

/// Adds Gaussian noise to the contacts. The returned contacts have normals only if `normal_std` is stated. Successive
/// groups of `each` contacts belong to different fingers; if `each` is 0, one finger has all contacts.
pub(super) fn noisy(
    random: &mut Random,
    exact: &[(Vector3<f64>, Vector3<f64>)],
    each: usize,
    position_std: f64,
    normal_std: Option<f64>,
) -> Vec<Contact> {
    exact
        .iter()
        .enumerate()
        .map(|(index, (place, normal))| {
            let position = Point3::from(place + random.vector() * position_std);
            let turned = normal_std.map(|std| {
                let tilt = random.vector() * std;
                (normal + tilt - normal * normal.dot(&tilt)).normalize()
            });
            Contact::new(index.checked_div(each).unwrap_or(0), position, turned)
        })
        .collect()
}

/// The contacts after a random rotation and a random displacement of the size `shift`.
pub(super) fn placed(random: &mut Random, contacts: &[Contact], shift: f64) -> Vec<Contact> {
    let (rotation, shift) = (random.rotation(), random.vector() * shift);
    contacts
        .iter()
        .map(|contact| Contact {
            position: rotation * contact.position + shift,
            normal: contact.normal.map(|normal| rotation * normal),
            ..*contact
        })
        .collect()
}

pub(super) fn inside(contacts: &[Contact]) -> Vec<Contact> {
    contacts
        .iter()
        .map(|contact| Contact {
            normal: contact.normal.map(|normal| -normal),
            ..*contact
        })
        .collect()
}

/// Noisy contacts with normals on a ball of radius 25, from three strokes. Each stroke has `each` contacts.
pub(crate) fn ball_log(random: &mut Random, each: usize) -> Vec<Contact> {
    let exact = Surface::Sphere(25.0).strokes(10.0, 3, each);
    noisy(random, &exact, each, 0.05, Some(0.01))
}
