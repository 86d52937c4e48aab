//! Time series of readings of rolls: rotations of the probe, and active pads or contact points.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::SeriesError;
use crate::crossings::{Run, without_chatter};
use crate::roll_fit::Observation;
use crate::rolled_path::drive_of;

/// Largest number of contact points of a roll that a fit uses. If a roll has more contact points, they are divided into
/// this number of groups, and the fit uses the mean of each group.
const GROUPS: usize = 12;
/// If the probe spins, the path of the contact bends, so the samples are divided into more groups. This constant is the
/// spin per additional group (rad).
const SPIN_OF_GROUP: f64 = 0.02;
/// Spin that requires as many groups as a unit of area between the path of the drive (rotation vector, turned by 90°) and
/// its chords. This area is the angle by which the contact frame turns along the path.
const SPIN_PER_AREA: f64 = 5.0;
/// Number of samples among which the sample with the largest rotation is searched.
const COMPARED: usize = 64;
/// The rolls count as reversed if a ratio is below this value. The numerator is the sum of the contacts' travels along
/// the directions of the rolls, and the denominator is the sum of the magnitudes of these travels. The ratio is near 1
/// for sound rolls, −1 for reversed rolls, and 0 for noise.
const REVERSED: f64 = -0.8;

/// The centres of two neighbouring pads are less than this multiple of the pitch apart.
const NEIGHBOURS: f64 = 1.5;

/// One sample of a roll: time, rotation of the probe, and place of the contact or pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollSample {
    /// Time (s) since the start of the roll.
    pub time_s: f64,
    /// Rotation vector of the probe since the start of the roll (rad). Its direction is the axis of the finite
    /// rotation, and its length is the angle. Its components are along the axes at the contact point where the roll
    /// starts. These axes are the axes at the origin of the pads' coordinates, parallel-transported along the great
    /// circle to the start.
    pub rotation: Vector3<f64>,
    /// Centre (length) of the active pad, or the contact point. The coordinates are those of the probe's exponential
    /// map at the origin of the pads: the distance from the origin along a great circle, in the direction in which the
    /// circle leaves the origin.
    pub place: Vector2<f64>,
}

/// The samples of one roll.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RollSeries {
    /// Contact point at the start of the roll, in the coordinates of [`RollSample::place`]; `None` if it is unknown.
    pub start: Option<Vector2<f64>>,
    /// Whether the rotations about the contact normal were measured. If not, the fit ignores the third component of
    /// [`RollSample::rotation`] and assumes that the probe rolls without spin.
    pub has_spin: bool,
    /// The samples, in the order of their times.
    pub samples: Vec<RollSample>,
}

impl RollSeries {
    /// The sample with the largest rotation among about 64 evenly spaced samples. It is the last sample, unless
    /// the roll returns towards its start.
    pub fn farthest(&self) -> Option<&RollSample> {
        let step = self.samples.len().div_ceil(COMPARED).max(1);
        let size = |one: &RollSample| drive_of(&one.rotation).norm_squared();
        let order = |one: &&RollSample, other: &&RollSample| size(other).total_cmp(&size(one));
        self.samples.iter().rev().step_by(step).min_by(order)
    }

    /// Measure of the bend of the contact's path (rad): the measured rotation about the contact normal, plus the area
    /// between the path of the drive and its chords.
    pub(crate) fn bend(&self) -> f64 {
        let last = self.farthest().filter(|_| self.has_spin);
        let spin = last.map_or(0.0, |last| last.rotation.z.abs());
        let step = self.samples.len().div_ceil(COMPARED).max(1);
        let drives = self.samples.iter().step_by(step);
        let drives: Vec<_> = drives.map(|one| drive_of(&one.rotation)).collect();
        let mean = |some: &[Vector2<f64>]| some.iter().sum::<Vector2<f64>>() / some.len() as f64;
        let means: Vec<_> = drives.chunks(COMPARED / 8).map(mean).collect();
        let area = means
            .windows(2)
            .map(|pair| pair[0].perp(&pair[1]).abs() / 2.0);
        spin + SPIN_PER_AREA * area.sum::<f64>()
    }
}

/// The area that belongs to one pad, relative to the centre of the pad: a convex polygon that is symmetric about the
/// centre.
///
/// ```
/// use nalgebra::Vector2;
/// use palpate_ep1::PadCell;
///
/// let cell = PadCell { pitch: 1.0, is_hexagonal: true };
/// assert!(cell.contains(&Vector2::new(0.49, 0.0)) && !cell.contains(&Vector2::new(0.51, 0.0)));
/// assert!(cell.contains(&Vector2::new(0.0, 0.57)) && !cell.contains(&Vector2::new(0.0, 0.58)));
/// assert!((cell.chord(&Vector2::new(0.0, 1.0)) - 2.0 / 3.0_f64.sqrt()).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PadCell {
    /// Distance between neighbouring pads.
    pub pitch: f64,
    /// Whether the pad is a hexagon, whose neighbours form rows along u, instead of a square with edges along u and v.
    pub is_hexagonal: bool,
}

impl PadCell {
    /// Whether the pad contains `place`, which is relative to the centre of the pad.
    pub fn contains(&self, place: &Vector2<f64>) -> bool {
        let half = 0.5 * self.pitch;
        self.normals().all(|normal| normal.dot(place) <= half)
    }

    /// Largest distance that a contact can move in `direction` without leaving the pad. `direction` is a unit vector.
    pub fn chord(&self, direction: &Vector2<f64>) -> f64 {
        let across = self.normals().map(|normal| normal.dot(direction));
        self.pitch / across.fold(0.0, f64::max)
    }

    /// Number of pairs of opposite edges.
    pub(crate) const fn pairs(&self) -> usize {
        if self.is_hexagonal { 3 } else { 2 }
    }

    /// Unit normals of the edges, in the order of their angles. Each edge is half a pitch away from the centre of the
    /// pad.
    pub(crate) fn normals(&self) -> impl Iterator<Item = Vector2<f64>> + use<> {
        let half_root = 0.5 * 3.0_f64.sqrt();
        let all = match self.is_hexagonal {
            false => [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]],
            true => [[1.0, 0.0], [0.5, half_root], [-0.5, half_root]],
        };
        let pairs = self.pairs();
        (0..2 * pairs).map(move |edge| {
            let sign = if edge < pairs { 1.0 } else { -1.0 };
            Vector2::from(all[edge % pairs]) * sign
        })
    }
}

/// Meaning of the places in the samples: centres of pads or contact points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Places {
    /// The places are the centres of active pads, each with this area.
    Pads(PadCell),
    /// The places are contact points.
    Contacts {
        /// Standard deviation (length) of each coordinate of a contact point. If this and all other stated noise is 0,
        /// the method estimates the standard deviation from the residuals.
        std: f64,
    },
}

/// Noise of the measured rotations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeriesNoise {
    /// Standard deviation of the error of each component of the rotation in each sample (rad). The errors of all
    /// samples are independent.
    pub rotation_std_rad: f64,
    /// Standard deviation of the part of the rotation's error that all samples of a roll share, divided by the magnitude
    /// of the rotation without its component about the contact normal. It is drawn once for each roll and component.
    pub relative_rotation_std: f64,
    /// Standard deviation of the error of each component of the rotation in each sample, divided by the magnitude of
    /// the rotation without its component about the contact normal.
    pub relative_sample_std: f64,
}

impl SeriesNoise {
    /// Whether the rotations have no noise.
    pub(crate) fn is_exact(&self) -> bool {
        *self == Self::default()
    }
}

/// Methods that estimate the curvature from time series of rolls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeriesMethod {
    /// Assumes that the curvature is constant along the rolls. At each sample, the active pad bounds the position of
    /// the contact.
    PadEdge,
    /// Estimates how the curvature changes along the rolls.
    Trajectory,
}

/// Checks the numbers in the readings and their noise, which must be valid for every method. Returns the runs of each
/// roll. A run is a series of successive samples on one pad, with the centre of the pad in radii of the probe. A roll
/// with contact points has no runs.
///
/// # Errors
/// [`SeriesError`] for a radius, pitch or noise out of range, samples that are not finite, and times that do not
/// increase.
pub(crate) fn check(
    radius: f64,
    places: &Places,
    noise: &SeriesNoise,
    rolls: &[RollSeries],
) -> Result<Vec<Vec<Run>>, SeriesError> {
    let is_size = |size: f64| (0.0..f64::INFINITY).contains(&size);
    let is_place_sound = match places {
        Places::Pads(cell) => cell.pitch > 1e-9 * radius && cell.pitch <= radius,
        Places::Contacts { std } => is_size(*std) && *std <= radius,
    };
    let sizes = [
        noise.rotation_std_rad,
        noise.relative_rotation_std,
        noise.relative_sample_std,
    ];
    let are_sizes = sizes.iter().all(|&size| is_size(size) && size < 1.0);
    let is_radius = (1e-50..1e50).contains(&radius);
    if !(is_radius && is_place_sound && are_sizes) {
        return Err(SeriesError::OutOfRange);
    }
    let pitch = match places {
        Places::Pads(cell) => Some(cell.pitch / radius),
        Places::Contacts { .. } => None,
    };
    let mut all = Vec::with_capacity(rolls.len());
    for (roll, series) in rolls.iter().enumerate() {
        let start = series.start.unwrap_or_default();
        if !is_on_probe(radius, &start) {
            return Err(SeriesError::OffProbe { roll, sample: 0 });
        }
        let mut runs: Vec<Run> = Vec::new();
        let samples = &series.samples;
        let mut sample = 0;
        while let Some(reading) = samples.get(sample) {
            let sum = reading.time_s + reading.rotation.sum() + reading.place.sum();
            if !sum.is_finite() {
                return Err(SeriesError::NotFinite { roll, sample });
            }
            let before = sample.checked_sub(1).map(|before| samples[before]);
            if let Some(before) = before.filter(|before| reading.time_s <= before.time_s) {
                return Err(SeriesError::TimeOrder {
                    roll,
                    sample,
                    time_s: reading.time_s,
                    last_s: before.time_s,
                });
            }
            if !is_on_probe(radius, &reading.place) {
                return Err(SeriesError::OffProbe { roll, sample });
            }
            // Most samples have finite numbers, a later time than the sample before, and the same pad. Skip the slower
            // checks for these samples. Two fast tests find them: the bits of the pad's centre are equal, and the sum
            // of the numbers is finite.
            let is_plain = |pair: &[RollSample]| {
                let [before, one] = [&pair[0], &pair[1]];
                let moved = |axis: usize| before.place[axis].to_bits() ^ one.place[axis].to_bits();
                let sum = one.time_s + one.rotation.sum();
                (moved(0) | moved(1) == 0) & (one.time_s > before.time_s) & (sum.abs() < f64::MAX)
            };
            let mut pairs = samples[sample..].windows(2);
            let next = pairs.position(|pair| !is_plain(pair));
            let next = next.map_or(samples.len(), |plain| sample + plain + 1);
            if pitch.is_some() {
                match runs.last_mut() {
                    Some(run) if samples[run.last].place == reading.place => run.last = next - 1,
                    _ => runs.push(Run {
                        first: sample,
                        last: next - 1,
                        centre: reading.place / radius,
                    }),
                }
            }
            sample = next;
        }
        all.push(without_chatter(
            samples,
            &runs,
            NEIGHBOURS * pitch.unwrap_or_default(),
        ));
    }
    Ok(all)
}

/// Whether `place` is a point of the probe, that is, less than half a turn from the origin of the coordinates.
fn is_on_probe(radius: f64, place: &Vector2<f64>) -> bool {
    place.norm_squared() < (std::f64::consts::PI * radius).powi(2)
}

/// Averages the rotations and contact points over groups of successive samples. The number of groups is the angle
/// `spin` (rad) by which the probe spins, divided by [`SPIN_OF_GROUP`], plus [`GROUPS`] if the samples have contact
/// points (`has_contacts`; samples with pads have none). Each result contains the index of the group's middle sample,
/// the mean rotation, and the mean contact point with the number of samples (`None` for pads).
pub(crate) fn groups(
    samples: &[RollSample],
    scale: f64,
    has_contacts: bool,
    spin: f64,
) -> Vec<(f64, Vector3<f64>, Option<Observation>)> {
    let count = (spin / SPIN_OF_GROUP) as usize + if has_contacts { GROUPS } else { 0 };
    let count = count.min(samples.len());
    let mean = |group| {
        let [from, to] = [group, group + 1].map(|edge| edge * samples.len() / count);
        let share = 1.0 / (to - from) as f64;
        let (mut rotation, mut place) = (Vector3::zeros(), Vector2::zeros());
        for sample in &samples[from..to] {
            rotation += sample.rotation * share;
            place += sample.place * share;
        }
        let contact = Observation::Contact(place * scale, (to - from) as f64);
        let middle = 0.5 * (from + to - 1) as f64;
        (middle, rotation, has_contacts.then_some(contact))
    };
    (0..count).map(mean).collect()
}

/// Whether the contacts moved against the direction of the rolls, for example because the rotations have the wrong
/// sign.
pub(crate) fn are_reversed(rolls: &[RollSeries]) -> bool {
    let (mut along, mut travel) = (0.0, 0.0);
    for (roll, last) in rolls
        .iter()
        .filter_map(|roll| Some((roll, roll.farthest()?)))
    {
        let (moved, drive) = (last.place - roll.samples[0].place, drive_of(&last.rotation));
        along += moved.dot(&drive) / drive.norm().max(f64::MIN_POSITIVE);
        travel += moved.norm();
    }
    along < REVERSED * travel
}

/// The error for rolls that do not determine the curvature. It contains the direction in which the rolls are shortest.
pub(crate) fn undetermined(rolls: &[RollSeries]) -> SeriesError {
    let ends = rolls.iter().filter_map(RollSeries::farthest);
    let gram: Matrix2<f64> = ends
        .map(|last| drive_of(&last.rotation) * drive_of(&last.rotation).transpose())
        .sum();
    let direction_rad = 0.5 * libm::atan2(-2.0 * gram[(0, 1)], gram[(1, 1)] - gram[(0, 0)]);
    SeriesError::Undetermined { direction_rad }
}
