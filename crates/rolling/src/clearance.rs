//! Clearance: the distance between a rolling probe and the parts of the object beside the contact.
//!
//! The curvatures at the contact point do not show whether a hill beside the contact extends into the probe. To detect
//! this, the heights of the object are sampled once along a path of the probe. Searches from the samples nearest to the
//! probe then find the closest points of the object.

use std::collections::HashMap;

use nalgebra::{Point3, Vector2};
use palpate_geometry::{Shape, Surface};

use crate::{Contact, Motion, RollError, RollFault, Roller};

/// Number of height samples per probe radius. The search for overlaps may miss parts of the object that are narrower
/// than the distance between height samples.
const PER_RADIUS: f64 = 48.0;
/// Number of height samples along a side of a square tile of `Terrain`.
const TILE: i64 = 32;
/// Largest accepted overlap of probe and object, relative to the probe's radius.
const TOLERANCE: f64 = 5e-7;
/// A closest point of the object counts as the contact itself if its distance from the contact, in probe radii, is
/// below this value.
const CONTACT: f64 = 1e-4;
/// Largest distance, in probe radii, that the probe's centre moves between two successive samples of the clearance. If
/// it moves farther, another sample between the two is computed.
const LONGEST: f64 = 0.25;
/// Smallest distance, in probe radii, between samples of the clearance. If the probe's centre moves less than this
/// between two samples, no further sample is computed between them.
const SHORTEST: f64 = 1e-3;
/// If the slope between two neighbouring height samples is larger than this number, there is a wall between them.
const STEEP: f64 = 2.0;
/// Number of bisections with which a wall between two neighbouring height samples is located.
const HALVINGS: usize = 40;

/// Heights of the object below a path of the probe, sampled on a square lattice. The samples are stored in square
/// tiles.
#[derive(Clone, Debug)]
pub struct Terrain {
    tiles: HashMap<[i64; 2], Vec<f64>>,
    spacing: f64,
}

/// One instant of a roll: its time, the distance that the probe's centre has travelled (in probe radii), and the
/// clearance. The clearance (length) is the distance between the probe and the nearest part of the object beside the
/// contact. Parts that are far from the probe are not examined.
#[derive(Clone, Copy, Debug)]
struct Sample {
    time_s: f64,
    way: f64,
    clearance: f64,
}

/// A place of the object where a search for a closest point starts.
#[derive(Clone, Copy, Debug)]
struct Start {
    place: Vector2<f64>,
    /// Whether the place lies on a steep wall. A search that starts on a wall may end at a point beside the wall.
    /// Therefore, the distance of the start itself from the probe is tested too.
    is_on_wall: bool,
}

impl Terrain {
    /// Samples the heights of the object in all tiles within the distance `reach` of a place, and stores these tiles.
    fn add(&mut self, object: &Shape, place: &Vector2<f64>, reach: f64) {
        let spacing = self.spacing;
        let ends = |along: f64| {
            let tile = |end: f64| ((along + end) / (spacing * TILE as f64)).floor() as i64;
            tile(-reach)..=tile(reach)
        };
        for column in ends(place.x) {
            for row in ends(place.y) {
                let height = |index: i64| {
                    let x = (column * TILE + index % TILE) as f64 * spacing;
                    let y = (row * TILE + index / TILE) as f64 * spacing;
                    object.contact_at(x, y).map_or(f64::NAN, |point| point.z)
                };
                let heights = || (0..TILE * TILE).map(height).collect();
                self.tiles.entry([column, row]).or_insert_with(heights);
            }
        }
    }

    fn place(&self, column: i64, row: i64) -> Vector2<f64> {
        Vector2::new(column as f64, row as f64) * self.spacing
    }

    /// The height of the object at a point of the sampling lattice; NaN outside the sampled tiles and outside the
    /// object.
    fn height(&self, column: i64, row: i64) -> f64 {
        let index = row.rem_euclid(TILE) * TILE + column.rem_euclid(TILE);
        let tile = self
            .tiles
            .get(&[column.div_euclid(TILE), row.div_euclid(TILE)]);
        tile.map_or(f64::NAN, |heights| heights[index as usize])
    }

    /// Places at which searches for the object's closest points to the probe start. They are within `reach` of the
    /// probe's centre `centre`. There are two kinds: height samples that are nearer to the centre than all their
    /// neighbours, and points on walls between two neighbouring samples.
    fn starts(&self, object: &Shape, centre: &Point3<f64>, reach: f64) -> Vec<Start> {
        let range = |axis: usize| {
            let end = |end: f64| ((centre[axis] + end) / self.spacing) as i64;
            end(-reach)..=end(reach)
        };
        let (columns, rows) = (range(0), range(1));
        let places = rows.flat_map(|row| columns.clone().map(move |column| [column, row]));
        let places: Vec<[i64; 2]> = places.collect();
        let heights: Vec<f64> = places
            .iter()
            .map(|[column, row]| self.height(*column, *row))
            .collect();
        let square = |(&[column, row], height): (&[i64; 2], &f64)| {
            let up = height - centre.z;
            (self.place(column, row) - centre.xy().coords).norm_squared() + up * up
        };
        let squares: Vec<f64> = places.iter().zip(&heights).map(square).collect();
        let side = columns.count();
        let mut starts = Vec::new();
        for (index, &[column, row]) in places.iter().enumerate() {
            let (height, square) = (heights[index], squares[index]);
            // `beside` is the index of a neighbouring sample. At the edge of the sampled window, this index may belong
            // to a sample of another row. Such a wrong index has no effect, because samples at the edge are too far
            // from the probe's centre to be used.
            let beside =
                |right: i64, down: i64| (index as i64 + right + down * side as i64) as usize;
            let mut around = (-1..=1).flat_map(|down| (-1..=1).map(move |right| (right, down)));
            let is_nearer = |(right, down): (i64, i64)| {
                // A neighbour that was not sampled counts as farther from the probe's centre than this sample.
                squares
                    .get(beside(right, down))
                    .is_none_or(|other| other.is_nan() || *other >= square)
            };
            let place = self.place(column, row);
            if square <= reach * reach && around.all(is_nearer) {
                starts.push(Start {
                    place,
                    is_on_wall: false,
                });
            }
            let aside = (place - centre.xy().coords).norm_squared();
            for (right, down) in [(1, 0), (0, 1)] {
                let next = heights
                    .get(beside(right, down))
                    .copied()
                    .unwrap_or(f64::NAN);
                if (next - height).abs() > STEEP * self.spacing {
                    let level = centre.z.clamp(height.min(next), height.max(next));
                    let up = level - centre.z;
                    if aside + up * up > reach * reach {
                        continue;
                    }
                    let ends = [place, self.place(column + right, row + down)];
                    let wall = crossing(object, ends, level, next > height);
                    starts.extend(wall.map(|place| Start {
                        place,
                        is_on_wall: true,
                    }));
                }
            }
        }
        starts
    }
}

/// The place between two lattice points at which the height of the object crosses `level`. `rises` states whether the
/// height increases from the first point to the second.
fn crossing(
    object: &Shape,
    [mut low, mut high]: [Vector2<f64>; 2],
    level: f64,
    rises: bool,
) -> Option<Vector2<f64>> {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let height = object.contact_at(middle.x, middle.y).ok()?.z;
        match (height < level) == rises {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(low)
}

fn reach(radius: f64, margin: f64) -> f64 {
    radius * (1.0 + LONGEST) + margin
}

impl Roller {
    /// Heights of the object below and beside a roll by `motions`. The sampled area is wide enough for all rolls whose
    /// distance from this roll is at most `margin` (length). `None` if no part of the object can extend into the probe,
    /// so that [`Roller::clearance`] need not check the roll.
    ///
    /// # Errors
    /// [`RollError`] if the roll ends early.
    pub fn terrain(&self, motions: &[Motion], margin: f64) -> Result<Option<Terrain>, RollError> {
        let radius = self.probe().radius();
        if !self.object().may_touch_twice(radius) {
            return Ok(None);
        }
        let mut terrain = Terrain {
            tiles: HashMap::new(),
            spacing: radius / PER_RADIUS,
        };
        let samples = (way(motions, f64::INFINITY) / LONGEST)
            .ceil()
            .clamp(1.0, 1e4) as u32;
        let duration_s: f64 = motions.iter().map(|motion| motion.duration_s).sum();
        for sample in 0..=samples {
            let (_, centre) =
                self.centre(motions, duration_s * f64::from(sample) / f64::from(samples))?;
            let reach = reach(radius, margin) + margin + LONGEST * radius;
            terrain.add(self.object(), &centre.xy().coords, reach);
        }
        Ok(Some(terrain))
    }

    /// Smallest distance (length) during a roll by `motions` between the probe and the parts of the object beside the
    /// contact. Only parts within a distance of `margin` plus a quarter of the probe's radius are tested, so the result
    /// is at most this distance.
    ///
    /// # Errors
    /// [`RollError`] if the roll ends early. The fault is [`RollFault::Overlapping`] if the object extends into the
    /// probe by more than 5e-7 of the probe's radius.
    pub fn clearance(
        &self,
        motions: &[Motion],
        terrain: &Terrain,
        margin: f64,
    ) -> Result<f64, RollError> {
        let radius = self.probe().radius();
        let duration_s: f64 = motions.iter().map(|motion| motion.duration_s).sum();
        let mut before = self.sample(motions, 0.0, terrain, margin)?;
        let mut least = before.clearance;
        // `ahead` is a stack of samples of the roll that are later than `before`. Its last element is the next sample
        // in time.
        let mut ahead = vec![self.sample(motions, duration_s, terrain, margin)?];
        while let Some(after) = ahead.last().copied() {
            let way = after.way - before.way;
            let nearer = before.clearance.min(after.clearance) / radius;
            // Between two samples, the clearance changes by at most the distance that the probe's centre moves. So if
            // the clearance at both samples is larger than this distance, no samples are needed between them.
            let is_cut = way > LONGEST || (way > SHORTEST && nearer < way);
            let middle = 0.5 * (before.time_s + after.time_s);
            if is_cut && before.time_s < middle && middle < after.time_s {
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
        let mut deepest = contact.on_object;
        for start in terrain.starts(self.object(), &centre, reach) {
            let Start { place, is_on_wall } = start;
            let descended = self.object().closest_point_from(&centre, place);
            // Also test the start point of the search if it is on a wall, or if the search finds no closest point, for
            // example because two points are equally close.
            let itself = (is_on_wall || descended.is_err())
                .then(|| self.object().contact_at(place.x, place.y));
            for closest in descended.into_iter().chain(itself.into_iter().flatten()) {
                let distance = (closest - centre).norm() - radius;
                let is_contact = (closest - contact.on_object).norm() < CONTACT * radius;
                if distance < clearance && !is_contact {
                    (clearance, deepest) = (distance, closest);
                }
            }
        }
        if clearance < -TOLERANCE * radius {
            return Err(RollError::new(
                RollFault::Overlapping { depth: -clearance },
                time_s,
                deepest,
            ));
        }
        Ok(Sample {
            time_s,
            way: way(motions, time_s),
            clearance,
        })
    }

    /// The contact and the centre of the probe at `time_s`. The contact is projected onto the object's surface, because
    /// integration errors may have moved it off the surface.
    fn centre(&self, motions: &[Motion], time_s: f64) -> Result<(Contact, Point3<f64>), RollError> {
        let mut contact = self.roll(&until(motions, time_s))?;
        let Point3 { coords } = contact.on_object;
        let fault = |error| RollError::new(RollFault::Surface(error), time_s, contact.on_object);
        let on_object = self
            .object()
            .contact_at(coords.x, coords.y)
            .map_err(fault)?;
        let normal = self.object().level_set(&on_object).map_err(fault)?.normal;
        (contact.on_object, contact.normal) = (on_object, normal);
        Ok((contact, on_object + normal * self.probe().radius()))
    }
}

/// The motions from the start to the time `time_s`. A motion that is not complete at this time is shortened, and later
/// motions have the duration 0.
fn until(motions: &[Motion], time_s: f64) -> Vec<Motion> {
    let mut left = time_s;
    let cut = motions.iter().map(|motion| {
        let duration_s = motion.duration_s.min(left);
        left -= duration_s;
        motion.lasting(duration_s)
    });
    cut.collect()
}

/// Distance that the probe's centre travels from the start to the time `time_s`, in radii of the probe. A spin does not
/// move the centre.
fn way(motions: &[Motion], time_s: f64) -> f64 {
    until(motions, time_s)
        .iter()
        .map(|motion| motion.rotation().norm())
        .sum()
}
