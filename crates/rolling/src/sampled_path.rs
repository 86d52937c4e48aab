//! The path of the contact on the probe at many instants of one roll. Contacts are computed only at a few instants
//! (nodes), and the path between the nodes is interpolated.

use std::f64::consts::PI;

use nalgebra::{SVector, UnitQuaternion, Vector2, Vector3};

use crate::ladder::Rung;
use crate::{Contact, Motion, RollError, Roller};

/// Largest accepted error of the interpolated path, relative to the probe's radius.
const RELATIVE_TOLERANCE: f64 = 1e-12;
/// Smallest number of intervals between the nodes of a motion. Nodes are the instants at which contacts are computed.
const MIN_INTERVALS: usize = 4;
const MAX_INTERVALS: usize = 128;

/// Displacement of the contact and rotation of the probe at one instant of a roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Great-circle displacement of the contact on the probe, from its first contact (logarithm map).
    pub displacement: Vector2<f64>,
    /// Rotation vector of the probe since the start of the roll, in the probe's first contact frame (rad). Its
    /// direction is the axis, and its length is the angle, of the finite rotation.
    pub rotation: Vector3<f64>,
}

/// The five components of displacement and rotation vector of a [`PathPoint`], as one vector.
type Numbers = SVector<f64, 5>;

/// The contacts of one motion at the Chebyshev nodes of its duration T. With n intervals, the nodes are `t_j = T (1 −
/// cos(π j/n))/2`.
#[derive(Default)]
struct Nodes {
    instants: Vec<f64>,
    contacts: Vec<Contact>,
    points: Vec<Numbers>,
}

impl Roller {
    /// The contact on the probe and the rotation of the probe at the instants `times_s`, while the probe makes all
    /// `motions` in sequence. The instants must not decrease; after the end of the motions, the probe rests.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use palpate_geometry::{Shape, Sphere};
    /// use palpate_rolling::{Model, Motion, Roller, Rolls};
    ///
    /// // A probe of radius 1 rolls with 0.1 rad/s along x on a ball of radius 3.
    /// let rolls = [vec![Motion::rolling(0.0, 0.1, 1.0)]];
    /// let (probe, ball) = (Sphere::new(1.0)?, Shape::Sphere(Sphere::new(3.0)?));
    /// let roller = Roller::new(probe, ball, (0.0, 0.0), Model::ClosedForm, Rolls::exact(&rolls))?;
    /// let path = roller.path(&rolls[0], &[0.0, 0.5, 1.0])?;
    /// assert!((path[1].displacement - Vector2::new(0.0375, 0.0)).norm() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Errors of [`Roller::roll`].
    pub fn path(&self, motions: &[Motion], times_s: &[f64]) -> Result<Vec<PathPoint>, RollError> {
        let mut path = Vec::with_capacity(times_s.len());
        let mut times = times_s.iter().copied().peekable();
        let (mut contact, mut elapsed) = (*self.first_contact(), 0.0);
        for motion in motions {
            let is_last = |time: &f64| *time > elapsed + motion.duration_s;
            let within = std::iter::from_fn(|| times.next_if(|time| !is_last(time)));
            let within: Vec<f64> = within.map(|time| time - elapsed).collect();
            let late = |error: RollError| RollError {
                time_s: error.time_s + elapsed,
                ..error
            };
            if contact == *self.first_contact() && motions.len() == 1 && self.is_quick(motion) {
                for &duration_s in &within {
                    let cut = motion.lasting(duration_s);
                    let (at, _) = self.advance(&contact, &cut)?;
                    path.push(PathPoint::of(self.numbers(&at)));
                }
                contact = self.roll(&[*motion])?;
            } else {
                let nodes = self.nodes(&contact, motion).map_err(late)?;
                for &time_s in &within {
                    let numbers = self.between(&nodes, motion, time_s).map_err(late)?;
                    path.push(PathPoint::of(numbers));
                }
                contact = nodes.contacts.last().copied().unwrap_or(contact);
            }
            elapsed += motion.duration_s.max(0.0);
        }
        path.resize(times_s.len(), PathPoint::of(self.numbers(&contact)));
        Ok(path)
    }

    fn numbers(&self, contact: &Contact) -> Numbers {
        let first = self.first_contact();
        let shift = contact
            .shift_from(first, self.probe().radius())
            .displacement;
        // At the first contact, the body axes of the probe are parallel to the axes of the object.
        let rotation = first.object_from_probe().inverse() * contact.object_from_probe();
        // Convert the matrix to a quaternion, because a quaternion stores all digits of a small angle. Computed from
        // the trace of the matrix, a small angle would lose digits.
        let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
        let turned = first.body_from_contact.inverse() * rotation.scaled_axis();
        Numbers::from([shift.x, shift.y, turned.x, turned.y, turned.z])
    }

    /// Whether exact formulas return the contact at any instant of the motion, so that no interpolation is needed.
    fn is_quick(&self, motion: &Motion) -> bool {
        let is_plain = !motion.spins() && !motion.slides();
        is_plain
            && match self.rung() {
                Rung::ClosedForm(_) => true,
                Rung::Meridian(rung) => rung.section(motion).is_some(),
                Rung::Integrated(_) => false,
            }
    }

    /// The contacts at the nodes of a motion that starts at the contact `from`. The number of intervals is doubled
    /// until the interpolation error is within the tolerance or the largest number is reached.
    fn nodes(&self, from: &Contact, motion: &Motion) -> Result<Nodes, RollError> {
        let duration_s = motion.duration_s.max(0.0);
        let mut nodes = Nodes::default();
        nodes.push(0.0, *from, self.numbers(from));
        for node in 1..=MIN_INTERVALS {
            let contact = nodes.contacts[node - 1];
            let end = duration_s * fraction(node, MIN_INTERVALS);
            let next = self.over(&contact, motion, [nodes.instants[node - 1], end])?;
            nodes.push(end, next, self.numbers(&next));
        }
        let tolerance = RELATIVE_TOLERANCE * self.probe().radius();
        loop {
            let intervals = 2 * (nodes.contacts.len() - 1);
            let mut finer = Nodes::default();
            let mut error: f64 = 0.0;
            for node in 0..=intervals {
                let (before, place) = (nodes.contacts[node / 2], nodes.points[node / 2]);
                if node % 2 == 0 {
                    finer.push(nodes.instants[node / 2], before, place);
                    continue;
                }
                let end = duration_s * fraction(node, intervals);
                let next = self.over(&before, motion, [nodes.instants[node / 2], end])?;
                let point = self.numbers(&next);
                error = error.max((nodes.interpolated(end) - point).norm());
                finer.push(end, next, point);
            }
            nodes = finer;
            if error <= tolerance || intervals >= MAX_INTERVALS {
                return Ok(nodes);
            }
        }
    }

    /// The contact at the end of a part of `motion`, from the time `start` to the time `end` (s). `from` is the contact
    /// at `start`.
    fn over(
        &self,
        from: &Contact,
        motion: &Motion,
        [start, end]: [f64; 2],
    ) -> Result<Contact, RollError> {
        let part = motion.lasting(end - start);
        let advanced = self.advance(from, &part).map(|(contact, _)| contact);
        advanced.map_err(|error| RollError {
            time_s: error.time_s + start,
            ..error
        })
    }

    fn between(&self, nodes: &Nodes, motion: &Motion, time_s: f64) -> Result<Numbers, RollError> {
        if nodes.contacts.len() <= MAX_INTERVALS {
            return Ok(nodes.interpolated(time_s));
        }
        // The path has too much detail for an interpolation. Instead, compute the roll from the previous node to this
        // instant.
        let later = nodes.instants.partition_point(|instant| *instant <= time_s);
        let node = later.saturating_sub(1);
        let contact = self.over(
            &nodes.contacts[node],
            motion,
            [nodes.instants[node], time_s],
        )?;
        Ok(self.numbers(&contact))
    }
}

/// The instant of the Chebyshev node with the index `node`, as a fraction of the motion's duration.
fn fraction(node: usize, intervals: usize) -> f64 {
    let sine = libm::sin(0.5 * PI * node as f64 / intervals as f64);
    sine * sine
}

impl PathPoint {
    fn of(numbers: Numbers) -> Self {
        let [u, v, x, y, z] = numbers.into();
        Self {
            displacement: Vector2::new(u, v),
            rotation: Vector3::new(x, y, z),
        }
    }
}

impl Nodes {
    fn push(&mut self, instant: f64, contact: Contact, point: Numbers) {
        self.instants.push(instant);
        self.contacts.push(contact);
        self.points.push(point);
    }

    /// Interpolates displacement and rotation by the barycentric formula. The weights of Chebyshev nodes alternate in
    /// sign; the weights of the first and the last node are half as large as the others.
    fn interpolated(&self, time_s: f64) -> Numbers {
        let last = self.instants.len() - 1;
        let (mut sum, mut weights) = (Numbers::zeros(), 0.0);
        for (node, (instant, point)) in self.instants.iter().zip(&self.points).enumerate() {
            let difference = time_s - instant;
            if difference == 0.0 {
                return *point;
            }
            let end = if node == 0 || node == last { 0.5 } else { 1.0 };
            let sign = if node % 2 == 0 { 1.0 } else { -1.0 };
            let weight = sign * end / difference;
            weights += weight;
            sum += point * weight;
        }
        sum / weights
    }
}

#[cfg(test)]
mod tests {
    use crate::{Chart, Model, Motion, Roller, Rolls};
    use palpate_geometry::{Ellipsoid, Shape, Sphere};

    #[test]
    fn a_path_is_that_of_separate_rolls() {
        let motion = |direction: f64, duration_s| Motion::rolling(direction, 0.5, duration_s);
        let object = Shape::Ellipsoid(Ellipsoid::new([3.0, 2.0, 1.5]).unwrap());
        for (start, motions) in [
            ((0.0, 0.0), vec![motion(0.0, 1.0)]),
            ((0.4, 0.3), vec![motion(0.7, 1.0)]),
            ((0.4, 0.3), vec![motion(0.7, 0.3), motion(0.5, 0.7)]),
        ] {
            let rolls = [motions.clone()];
            let model = Model::Auto {
                tolerance: 1e-12,
                chart: Chart::Free,
            };
            let probe = Sphere::new(1.0).unwrap();
            let roller =
                Roller::new(probe, object.clone(), start, model, Rolls::exact(&rolls)).unwrap();
            let times: Vec<f64> = (0..=40).map(|sample| 0.03 * f64::from(sample)).collect();
            let path = roller.path(&motions, &times).unwrap();
            for (time, place) in times.iter().zip(&path) {
                let mut left = *time;
                let cut = motions.iter().map(|motion| {
                    let duration_s = motion.duration_s.min(left);
                    left -= duration_s;
                    motion.lasting(duration_s)
                });
                let cut: Vec<Motion> = cut.collect();
                let expected = roller.shift(&cut).unwrap().displacement;
                let error = (place.displacement - expected).norm();
                assert!(error < 1e-10, "{time}: {place:?} {expected}");
                let rolled: nalgebra::Vector2<f64> = cut.iter().map(Motion::rotation).sum();
                // The axis of the rotation turns with the contact frame, so the rotation vector differs slightly from
                // the sum of the motions' rotations.
                let error = (place.rotation.xy() - rolled).norm();
                assert!(error < 0.05 * rolled.norm() + 1e-12, "{place:?} {rolled}");
            }
        }
    }
}
