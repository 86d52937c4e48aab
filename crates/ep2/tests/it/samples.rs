//! Contacts on surfaces whose points, normals and curvatures are given by formulas.

use nalgebra::{Point3, Vector3};
use palpate_ep2::Contact;
use palpate_sensing::{Channel, Stream};

/// A point of a surface, its outward normal (of any length), its Gaussian and its mean curvature.
pub(crate) type Truth = (Point3<f64>, Vector3<f64>, f64, f64);

/// A surface given as a graph, with formulas for its point, normal and curvatures at each (x, y).
pub(crate) struct Surface {
    pub(crate) name: &'static str,
    pub(crate) at: fn(f64, f64) -> Truth,
}

/// A random surface: a quadric plus two waves.
pub(crate) struct Waves {
    quadric: [f64; 3],
    /// For each wave, its amplitude, its wave numbers along x and y, and its phase.
    waves: [[f64; 4]; 2],
}

impl Waves {
    /// A random surface. The second derivatives of the quadric are at most 0.24; the waves have wave numbers of 0.4 to
    /// 1.6 and second derivatives of 0.02 to 0.25.
    pub(crate) fn random(index: u64) -> Self {
        let mut stream = Stream::new(29, index, Channel::Misalignment);
        let mut between =
            |low: f64, high: f64| low + 0.5 * (high - low) * (1.0 + stream.symmetric_uniform());
        Self {
            quadric: std::array::from_fn(|_| between(-0.12, 0.12)),
            waves: std::array::from_fn(|_| {
                let (number, turn) = (between(0.4, 1.6), between(0.0, std::f64::consts::TAU));
                [
                    between(0.02, 0.25) / (number * number),
                    number * libm::cos(turn),
                    number * libm::sin(turn),
                    between(0.0, std::f64::consts::TAU),
                ]
            }),
        }
    }

    pub(crate) fn at(&self, x: f64, y: f64) -> Truth {
        let [a, b, c] = self.quadric;
        let mut jet = [
            a * x * x + b * x * y + c * y * y,
            2.0 * a * x + b * y,
            b * x + 2.0 * c * y,
            2.0 * a,
            b,
            2.0 * c,
        ];
        for [size, k, l, phase] in self.waves {
            let (sin, cos) = libm::sincos(k * x + l * y + phase);
            let parts = [
                sin,
                k * cos,
                l * cos,
                -k * k * sin,
                -k * l * sin,
                -l * l * sin,
            ];
            jet.iter_mut()
                .zip(parts)
                .for_each(|(sum, part)| *sum += size * part);
        }
        graph(x, y, jet)
    }
}

/// Curvature of a graph, from its slopes p, q and its second derivatives r, s, t.
fn graph(x: f64, y: f64, jet: [f64; 6]) -> Truth {
    let [z, p, q, r, s, t] = jet;
    let d = 1.0 + p * p + q * q;
    let gaussian = (r * t - s * s) / (d * d);
    let trace = (1.0 + q * q) * r - 2.0 * p * q * s + (1.0 + p * p) * t;
    let mean = -trace / (2.0 * libm::pow(d, 1.5));
    (
        Point3::new(x, y, z),
        Vector3::new(-p, -q, 1.0),
        gaussian,
        mean,
    )
}

/// A cylinder of radius 5. Its curved direction forms the angle `turn` with the x axis.
fn cylinder(x: f64, y: f64, turn: f64) -> Truth {
    let across = x * libm::cos(turn) + y * libm::sin(turn);
    let height = (25.0 - across * across).sqrt();
    let normal = Vector3::new(across * libm::cos(turn), across * libm::sin(turn), height);
    (Point3::new(x, y, height - 5.0), normal, 0.0, 0.1)
}

/// The four surfaces on which Charlebois, Gupta and Payandeh (1996) test their second estimator, EP2.
pub(crate) const QUADRIC_LIKE: [Surface; 4] = [
    Surface {
        name: "sphere",
        at: |x, y| {
            let height = (25.0 - x * x - y * y).sqrt();
            let normal = Vector3::new(x, y, height);
            (Point3::new(x, y, height - 5.0), normal, 0.04, 0.2)
        },
    },
    Surface {
        name: "cylinder",
        at: |x, y| cylinder(x, y, 0.0),
    },
    Surface {
        name: "turned cylinder",
        at: |x, y| cylinder(x, y, std::f64::consts::FRAC_PI_4),
    },
    Surface {
        name: "saddle",
        at: |x, y| {
            graph(
                x,
                y,
                [0.1 * (x * x - y * y), 0.2 * x, -0.2 * y, 0.2, 0.0, -0.2],
            )
        },
    },
];

/// The top of a torus with the radii 3 and 2, which is not a quadric.
pub(crate) const TORUS: Surface = Surface {
    name: "torus",
    at: |x, y| {
        let (x, centre) = (x + 3.0, 3.0);
        let from_axis = libm::hypot(x, y);
        let out = from_axis - centre;
        let height = (4.0 - out * out).sqrt();
        let normal = Vector3::new(out * x / from_axis, out * y / from_axis, height);
        let around = out / (2.0 * from_axis);
        let point = Point3::new(x - centre, y, height);
        (point, normal, 0.5 * around, 0.5 * (0.5 + around))
    },
};

#[derive(Clone, Copy)]
pub(crate) struct Sweep {
    pub(crate) fingers: usize,
    pub(crate) contacts_per_finger: usize,
    pub(crate) position_std: f64,
    pub(crate) normal_std_rad: f64,
}

impl Sweep {
    /// Three fingers with ten contacts each. The normals at the contacts have errors of 2 degrees.
    pub(crate) const fn paper(position_std: f64) -> Self {
        Self {
            fingers: 3,
            contacts_per_finger: 10,
            position_std,
            normal_std_rad: 2.0 * std::f64::consts::PI / 180.0,
        }
    }

    pub(crate) fn contacts(&self, surface: &Surface, trial: u64) -> Vec<Contact> {
        self.contacts_on(surface.at, trial)
    }

    pub(crate) fn contacts_on(
        &self,
        surface: impl Fn(f64, f64) -> Truth,
        trial: u64,
    ) -> Vec<Contact> {
        let mut position = Stream::new(1996, trial, Channel::Position);
        let mut tilt = Stream::new(1996, trial, Channel::Normal);
        let spread = |index: usize, count: usize| 3.0 * index as f64 / (count - 1) as f64 - 1.5;
        let mut contacts = Vec::new();
        for finger in 0..self.fingers {
            for step in 0..self.contacts_per_finger {
                let x = spread(step, self.contacts_per_finger);
                let y = spread(finger, self.fingers);
                let (point, normal, ..) = surface(x, y);
                let error = Vector3::from_fn(|_, _| self.position_std * position.standard_normal());
                let normal = normal.normalize();
                let along = normal.cross(&Vector3::y()).normalize();
                let across = normal.cross(&along);
                let mut turn = || self.normal_std_rad * tilt.standard_normal();
                let sensed = normal + along * turn() + across * turn();
                contacts.push(Contact::new(finger, point + error, Some(sensed)));
            }
        }
        contacts
    }
}

pub(crate) fn grid(side: usize) -> impl Iterator<Item = (f64, f64)> {
    let place = move |index: usize| 2.0 * index as f64 / (side - 1) as f64 - 1.0;
    (0..side * side).map(move |index| (place(index / side), place(index % side)))
}
