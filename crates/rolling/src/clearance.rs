//! Distance between a rolling probe and the parts of the object that it does not touch.
//!
//! A hill beside the path may reach into the probe although nothing at the contact tells of it. The relief of the object is
//! sampled once along a path; from its places nearest to the probe's centre, descent finds the closest points.

use nalgebra::{Point3, Vector2};
use palpate_geometry::{Shape, Surface};

use crate::{Contact, Motion, RollError, RollFault, Roller};

/// Sampled places across a radius of the probe. What is narrower than their distance may pass unseen.
const PER_RADIUS: f64 = 48.0;
/// Overlap that is none, as a share of the probe's radius.
const TOLERANCE: f64 = 5e-7;
/// Distance from the contact within which a closest point is the contact itself, as a share of the radius.
const CONTACT: f64 = 1e-4;
/// Longest way of the centre between two samples of a path, and the shortest that is cut, as shares of the radius.
const LONGEST: f64 = 0.25;
const SHORTEST: f64 = 1e-3;

/// The relief under a path of the probe.
#[derive(Clone, Debug)]
pub struct Terrain {
    least: [i64; 2],
    columns: usize,
    heights: Vec<f64>,
    spacing: f64,
}

/// A place on the path: the time, the probe's centre, and its distance from the nearest part of the object that it does not
/// touch, at most the reach.
#[derive(Clone, Copy, Debug)]
struct Sample {
    time_s: f64,
    centre: Point3<f64>,
    clearance: f64,
}

impl Terrain {
    /// The relief of an object within `reach` of a path of centres.
    fn along(object: &Shape, centres: &[Point3<f64>], reach: f64, spacing: f64) -> Self {
        let ends = |axis: usize| {
            let along = centres.iter().map(move |centre| centre[axis]);
            let least = along.clone().fold(f64::INFINITY, f64::min);
            let most = along.fold(f64::NEG_INFINITY, f64::max);
            [(least - reach) / spacing, (most + reach) / spacing]
        };
        let ([x_least, x_most], [y_least, y_most]) = (ends(0), ends(1));
        let (x, y) = (
            x_least.floor() as i64..=x_most.ceil() as i64,
            y_least.floor() as i64..=y_most.ceil() as i64,
        );
        let height = |at: Vector2<f64>| {
            object
                .contact_at(at.x, at.y)
                .map_or(f64::NAN, |point| point.z)
        };
        let places = y.clone().flat_map(|row| {
            x.clone()
                .map(move |column| Vector2::new(column as f64, row as f64))
        });
        Self {
            least: [*x.start(), *y.start()],
            columns: x.clone().count(),
            heights: places.map(|place| height(place * spacing)).collect(),
            spacing,
        }
    }

    /// Square of the distance from `centre` of the place in a column and a row, counted from the first.
    fn square(&self, centre: &Point3<f64>, column: i64, row: i64) -> Option<f64> {
        let inside = 0 <= column && column < self.columns as i64 && row >= 0;
        let height = self
            .heights
            .get((row as usize).checked_mul(self.columns)? + column as usize);
        let place = self.place(column, row);
        let up = height.filter(|height| inside && height.is_finite())? - centre.z;
        Some((place - centre.xy().coords).norm_squared() + up * up)
    }

    fn place(&self, column: i64, row: i64) -> Vector2<f64> {
        let [x, y] = [column + self.least[0], row + self.least[1]];
        Vector2::new(x as f64, y as f64) * self.spacing
    }

    /// Places within `reach` of `centre` that are nearer than all their neighbours.
    fn nearest(&self, centre: &Point3<f64>, reach: f64) -> Vec<Vector2<f64>> {
        let range = |axis: usize| {
            let first = |end: f64| ((centre[axis] + end) / self.spacing) as i64 - self.least[axis];
            first(-reach)..=first(reach)
        };
        let mut nearest = Vec::new();
        for row in range(1) {
            for column in range(0) {
                let Some(square) = self.square(centre, column, row) else {
                    continue;
                };
                let around = (-1..=1).flat_map(|down| (-1..=1).map(move |right| (right, down)));
                let mut squares = around
                    .filter_map(|(right, down)| self.square(centre, column + right, row + down));
                if square <= (reach * reach) && squares.all(|other| square <= other) {
                    nearest.push(self.place(column, row));
                }
            }
        }
        nearest
    }
}

/// Distance from the probe's centre as far as which the object is looked at.
fn reach(radius: f64, margin: f64) -> f64 {
    radius * (1.0 + LONGEST) + margin
}

impl Roller {
    /// Whether a roll must be [checked](Roller::clearance) for parts of the object that reach into the probe.
    pub fn may_touch_twice(&self) -> bool {
        self.object().may_touch_twice(self.probe().radius())
    }

    /// The relief along a roll by `motions`, as far from the probe as `margin` (length).
    ///
    /// # Errors
    /// [`RollError`] where the roll ends early.
    pub fn terrain(&self, motions: &[Motion], margin: f64) -> Result<Terrain, RollError> {
        let radius = self.probe().radius();
        let samples = 8;
        let duration_s: f64 = motions.iter().map(|motion| motion.duration_s).sum();
        let centres = (0..=samples).map(|sample| {
            let time_s = duration_s * f64::from(sample) / f64::from(samples);
            self.centre(motions, time_s).map(|(_, centre)| centre)
        });
        let centres: Vec<_> = centres.collect::<Result<_, _>>()?;
        // Rolls of trials stray by the margin, and paths bend between the samples.
        let reach = 1.05 * (reach(radius, margin) + margin);
        Ok(Terrain::along(
            self.object(),
            &centres,
            reach,
            radius / PER_RADIUS,
        ))
    }

    /// Smallest distance, length, between the probe and the parts of the object that it does not touch during a roll by
    /// `motions`, at most `margin`.
    ///
    /// # Errors
    /// [`RollError`] where the roll ends early, with [`RollFault::Overlapping`] where the object reaches into the probe by
    /// more than a millionth of its radius.
    pub fn clearance(
        &self,
        motions: &[Motion],
        terrain: &Terrain,
        margin: f64,
    ) -> Result<f64, RollError> {
        let duration_s: f64 = motions.iter().map(|motion| motion.duration_s).sum();
        let mut before = self.sample(motions, 0.0, terrain, margin)?;
        let mut least = before.clearance;
        // The samples ahead, the next one last.
        let mut ahead = vec![self.sample(motions, duration_s, terrain, margin)?];
        while let Some(after) = ahead.last().copied() {
            let way = (after.centre - before.centre).norm() / self.probe().radius();
            let nearer = before.clearance.min(after.clearance) / self.probe().radius();
            // The distance changes by no more than the centre moves.
            if way > LONGEST || (way > SHORTEST && nearer < way) {
                let middle = 0.5 * (before.time_s + after.time_s);
                ahead.push(self.sample(motions, middle, terrain, margin)?);
                continue;
            }
            least = least.min(after.clearance);
            before = after;
            ahead.pop();
        }
        Ok(least)
    }

    fn sample(
        &self,
        motions: &[Motion],
        time_s: f64,
        terrain: &Terrain,
        margin: f64,
    ) -> Result<Sample, RollError> {
        let (contact, centre) = self.centre(motions, time_s)?;
        let radius = self.probe().radius();
        let reach = reach(radius, margin);
        let mut clearance = reach - radius;
        for start in terrain.nearest(&centre, reach) {
            // On a ridge between two closest points the place itself will do.
            let Ok(closest) = self
                .object()
                .closest_point_from(&centre, start)
                .or_else(|_| self.object().contact_at(start.x, start.y))
            else {
                continue;
            };
            if (closest - contact.on_object).norm() < CONTACT * radius {
                continue;
            }
            let distance = (closest - centre).norm() - radius;
            if distance < -TOLERANCE * radius {
                let fault = RollFault::Overlapping { depth: -distance };
                return Err(RollError::new(fault, time_s, closest));
            }
            clearance = clearance.min(distance);
        }
        Ok(Sample {
            time_s,
            centre,
            clearance,
        })
    }

    /// The contact after some of the motions, and the probe's centre.
    fn centre(&self, motions: &[Motion], time_s: f64) -> Result<(Contact, Point3<f64>), RollError> {
        let mut left = time_s;
        let mut until = Vec::with_capacity(motions.len());
        for motion in motions {
            let duration_s = motion.duration_s.min(left);
            until.push(Motion {
                duration_s,
                ..*motion
            });
            left -= duration_s;
        }
        let contact = self.roll(&until)?;
        let centre = contact.on_object + contact.normal * self.probe().radius();
        Ok((contact, centre))
    }
}
