//! The set of curvatures that agree with the exact rotations and the active pads of all rolls.

use std::sync::OnceLock;

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};

use crate::crossings::{Run, edge_samples};
use crate::feasible_set::{EdgeRow, OPEN, Programs, RollRows, distribution, furthest_change};
use crate::roll_fit::{STEP, moved, slopes_at};
use crate::rolled_path::{LocalShape, RollRotations, StartFrame};
use crate::symmetric::{is_rolling, largest_spread, matrix};
use crate::{PadCell, Quantity, RollSample, RollSeries};

/// The bounds are linearised repeatedly to find an extreme value over the set of possible mobilities (contact travels
/// per radian). This constant is the largest number of linearisations for one extreme value.
const PASSES: usize = 8;
/// The bounds are linearised repeatedly to find an extreme value over the set of possible mobilities (contact travels
/// per radian). The value has converged if its last change is less than this fraction of its distance from the mean. An
/// estimate of the next change is then added to the value.
const CONVERGED: f64 = 0.03;
/// If one linearisation changes the extreme value over the set of possible mobilities by more than this fraction of its
/// distance from the mean, the boundary of the set counts as curved. The linearisations may then alternate between
/// corners of the set, or converge to a corner that is not the furthest, so the largest of the values that they find is
/// used.
const CURVED: f64 = 0.3;
/// Number of directions in which the bounds of principal curvatures are computed.
const DIRECTIONS: usize = 12;
/// The set of possible mobilities (contact travels per radian) is assumed to be bounded if the standard deviation of
/// the mobility, divided by the mobility, is at most this value.
const MAX_SPREAD: f64 = 0.03;
/// The distribution of the mobility (contact travel per radian) counts as normal if all possible mobilities are close
/// to the mean. This constant is the largest accepted deviation from the mean, relative to the mean.
const MAX_DEVIATION: f64 = 0.06;
/// First guess of the standard deviation of the mobility (contact travel per radian), relative to the half-width of the
/// set of possible mobilities.
const STD_OF_HALF_WIDTH: f64 = 0.4;
/// The bounds are linearised repeatedly at the middle of the set of possible mobilities (contact travels per radian).
/// This constant is the largest number of these linearisations.
const CENTRES: usize = 5;
/// If a contact with a changed mobility (contact travel per radian) could not roll, the change is halved, at most this
/// number of times.
const MAX_HALVINGS: usize = 60;
/// Largest error of a computed path of the contact (in radii of the probe), divided by the mean rotation between two
/// samples (rad). The error arises because the path bends between two computed points.
const PATH_ERROR: f64 = 2e-3;

/// A roll whose active pads bound the position of the contact.
#[derive(Clone, Debug)]
pub(crate) struct BoundedRoll {
    pub(crate) is_start_known: bool,
    /// Exponent of the roll's probability: 1/n if n rolls change pads at the same samples. They share the errors of these
    /// changes, so together they count as one roll.
    pub(crate) share: f64,
    /// Contact point at the start of the roll, or a first guess of it, in radii of the probe.
    pub(crate) start: Vector2<f64>,
    /// Derivatives of the start with respect to the entries uu, uv, vv of the mobility (contact travel per radian).
    pub(crate) response: Matrix2x3<f64>,
    /// For each bound: the index of the pad's edge, the edge's offset in radii of the probe, and the index of the
    /// bound's rotation in `rotations`.
    edges: Vec<(usize, f64, usize)>,
    rotations: RollRotations,
}

impl BoundedRoll {
    /// Bounds of the contact's positions in a roll, for an object whose shape is close to `shape`. The edges of all pads
    /// are moved outward by `width`, in radii of the probe.
    pub(crate) fn new(
        series: &RollSeries,
        runs: &[Run],
        radius: f64,
        cell: &PadCell,
        shape: &LocalShape,
        width: f64,
    ) -> Option<Self> {
        let samples = &series.samples;
        let mobility = shape.relative().try_inverse()?;
        let mut edges = edge_samples(samples, runs, cell.pitch / radius, cell, &mobility);
        let turned = series.farthest()?.rotation;
        let length = length(samples);
        // The contact's path is computed at the sample of each bound. If the path bends, it is also computed at samples
        // in between, to limit the path's error.
        let uneven = libm::hypot(mobility[(0, 0)] - mobility[(1, 1)], 2.0 * mobility[(0, 1)]);
        let bend = (uneven + turned.z.abs()) * length + 8.0 * sagitta(samples, &turned);
        let square = length * length * bend / 12.0;
        let largest = PATH_ERROR * length / samples.len() as f64;
        let nodes = (square / largest.max(f64::MIN_POSITIVE)).sqrt();
        let step = (samples.len() / (nodes as usize + 1)).max(1);
        let mut rotations = Vec::with_capacity(edges.len());
        let mut last = 0;
        for edge in &mut edges {
            rotations.extend(
                (last + step..edge.2)
                    .step_by(step)
                    .map(|at| samples[at].rotation),
            );
            // Bounds that come from the same sample share one element of `rotations`.
            if rotations.is_empty() || edge.2 != last {
                last = edge.2;
                rotations.push(samples[last].rotation);
            }
            edge.2 = rotations.len() - 1;
        }
        // Move each edge of a pad outward by `width` and by the estimated error of the computed path of the contact.
        let count = rotations.len() as f64;
        for edge in &mut edges {
            edge.1 += square / (count * count) + width;
        }
        Some(Self {
            is_start_known: series.start.is_some(),
            share: 1.0,
            start: series.start.unwrap_or(samples[0].place) / radius,
            response: Matrix2x3::zeros(),
            edges,
            rotations: RollRotations::new(rotations, series.has_spin),
        })
    }
}

/// Estimates how far the rotation vectors of the samples deviate from a straight line: the largest distance of a few of
/// them from the line through zero and the rotation vector `end`.
fn sagitta(samples: &[RollSample], end: &Vector3<f64>) -> f64 {
    let middle = |part: usize| samples[part * samples.len() / 8].rotation;
    let apart = |part| middle(part).cross(end).norm() / end.norm().max(f64::MIN_POSITIVE);
    (1..8).map(apart).fold(0.0, f64::max)
}

/// Length (rad) of the path of the rotation vectors, measured between a few samples.
fn length(samples: &[RollSample]) -> f64 {
    let some = |part: usize| samples[part * (samples.len() - 1) / 8].rotation;
    (0..8)
        .map(|part| (some(part + 1) - some(part)).norm())
        .sum()
}

/// The set of mobilities (contact travels per radian) that agree with exact readings, and the distribution of the
/// mobility in this set. Mobilities are stored as differences from a centre.
#[derive(Clone, Debug)]
pub(crate) struct PadEdgeSet {
    cell: PadCell,
    rolls: Vec<BoundedRoll>,
    shape: LocalShape,
    /// The mobility (contact travel per radian) at the centre of the set, in radii of the probe.
    centre: Matrix2<f64>,
    /// The bounds of the mobility, linearised at the centre of the set.
    rows: Vec<RollRows>,
    /// Mean of the mobility (contact travel per radian) over the set, minus the mobility at the centre: the entries uu,
    /// uv, vv of this difference.
    mean: Vector3<f64>,
    pub(crate) covariance: Matrix3<f64>,
    deviations: OnceLock<Option<[f64; 2]>>,
    principal: OnceLock<[[f64; 2]; 2]>,
}

impl PadEdgeSet {
    /// Computes the set from bounds that are linearised first at `shape` and at the starts of the rolls. `covariance`
    /// is a first guess of the covariance of the mobility (contact travel per radian). `None` if the set is empty.
    pub(crate) fn new(
        cell: &PadCell,
        rolls: Vec<BoundedRoll>,
        shape: LocalShape,
        mut covariance: Option<Matrix3<f64>>,
    ) -> Option<Self> {
        let mut set = Self {
            cell: *cell,
            rolls,
            centre: shape.relative().try_inverse()?,
            shape,
            rows: Vec::new(),
            mean: Vector3::zeros(),
            covariance: Matrix3::zeros(),
            deviations: OnceLock::new(),
            principal: OnceLock::new(),
        };
        let mut starts: Vec<_> = set.rolls.iter().map(|roll| roll.start).collect();
        for pass in 0..=CENTRES {
            set.rows = set.linearised(&set.shape, &starts)?;
            if let Some(covariance) = covariance
                && set.distribute(Vector3::zeros(), covariance).is_some()
            {
                break;
            }
            let (change, half_widths, moved) = middle(&set.rows)?;
            let stds = half_widths * STD_OF_HALF_WIDTH;
            let guess = Matrix3::from_diagonal(&stds.component_mul(&stds));
            (set.mean, set.covariance) = (change, guess);
            covariance = Some(guess);
            let is_open = half_widths.max() > 0.9 * OPEN;
            if is_open || pass > 0 {
                if !is_open {
                    set.distribute(change, guess);
                }
                break;
            }
            // If the set of possible mobilities is wide, its middle may be a mobility with which the contact does not
            // roll. Then `rolling` shortens the step from the old centre to the middle.
            let centre = set.centre + matrix(&set.rolling(change));
            (set.shape, set.centre) = (LocalShape::of_mobility(&centre)?, centre);
            set.mean = Vector3::zeros();
            for (start, moved) in starts.iter_mut().zip(moved) {
                *start += moved;
            }
        }
        set.mean = set.rolling(set.mean);
        for (roll, start) in set.rolls.iter_mut().zip(starts) {
            roll.start = start;
        }
        Some(set)
    }

    /// The change of the mobility (contact travel per radian), halved until the contact can roll with the changed
    /// mobility.
    fn rolling(&self, change: Vector3<f64>) -> Vector3<f64> {
        let changes = std::iter::successors(Some(change), |change| Some(change * 0.5));
        let mut rolling = changes
            .take(MAX_HALVINGS)
            .filter(|change| is_rolling(&(self.centre + matrix(change))));
        rolling.next().unwrap_or_default()
    }

    /// Computes the mean and the covariance of the mobility (contact travel per radian) over the set, with the
    /// linearised bounds. `centre` and `guess` are first guesses of the mean and the covariance.
    fn distribute(&mut self, centre: Vector3<f64>, guess: Matrix3<f64>) -> Option<()> {
        let responses: Vec<_> = self.rolls.iter().map(|roll| roll.response).collect();
        let is_possible = |change: &Vector3<f64>| is_rolling(&(self.centre + matrix(change)));
        let found = distribution(
            &self.rows,
            &responses,
            &self.cell,
            is_possible,
            centre,
            guess,
        )?;
        (self.mean, self.covariance) = found;
        Some(())
    }

    /// Whether the set of possible mobilities (contact travels per radian) is open, that is, whether the readings do
    /// not limit the mobility in some direction.
    pub(crate) fn is_open(&self) -> bool {
        let direction = Vector3::new(1.0, 0.0, 1.0);
        let end = furthest_change(&self.rows, &direction, &mut Programs::default());
        end.is_none_or(|(change, _)| change.amax() > 0.9 * OPEN)
    }

    /// Whether, in some direction, the contact moves against the roll for every mobility (contact travel per radian) of
    /// the set.
    pub(crate) fn is_reversed(&self) -> bool {
        let mut programs = Programs::default();
        (0..4).any(|at| {
            let (sin, cos) = libm::sincos(std::f64::consts::FRAC_PI_4 * f64::from(at));
            let along = Vector2::new(cos, sin);
            let direction = entries(&(along * along.transpose()));
            let end = furthest_change(&self.rows, &direction, &mut programs);
            end.is_some_and(|(change, _)| {
                direction.dot(&change) <= -along.dot(&(self.centre * along))
            })
        })
    }

    /// Whether the standard deviation of the mobility (contact travel per radian) is so large that the set of possible
    /// mobilities may be unbounded.
    pub(crate) fn is_wide(&self) -> bool {
        largest_spread(&self.mobility(), &self.covariance) > MAX_SPREAD
    }

    /// Whether so few pad edges are crossed that the distribution of the curvature is not normal.
    pub(crate) fn has_few_crossings(&self) -> bool {
        let largest = |[low, high]: [f64; 2]| high.max(-low);
        self.deviations()
            .is_none_or(|ends| largest(ends) > MAX_DEVIATION)
    }

    /// Mean mobility (contact travel per radian), in radii of the probe.
    pub(crate) fn mobility(&self) -> Matrix2<f64> {
        self.centre + matrix(&self.mean)
    }

    /// The bounds of all rolls, linearised at the shape `shape` and at the starts `starts`. `None` if a contact on this
    /// shape cannot follow the measured rotations.
    fn linearised(&self, shape: &LocalShape, starts: &[Vector2<f64>]) -> Option<Vec<RollRows>> {
        let normals: Vec<_> = self.cell.normals().collect();
        let mut path = Vec::new();
        let mut all = Vec::with_capacity(self.rolls.len());
        for (roll, start) in self.rolls.iter().zip(starts) {
            roll.rotations.path(shape, &Vector2::zeros(), &mut path)?;
            let frame = StartFrame::new(start);
            let changed = |unknown: usize| {
                let step = STEP * Vector3::ith(unknown, 1.0);
                let (shape, mut path) = (moved(shape, &step)?.0, Vec::new());
                roll.rotations.path(&shape, &Vector2::zeros(), &mut path)?;
                Some(path)
            };
            let unknowns = 0..if roll.rotations.is_spun() { 3 } else { 0 };
            let nearby: Vec<_> = unknowns.map(changed).collect::<Option<_>>()?;
            let row = |&(edge, offset, at): &(usize, f64, usize)| {
                let place = frame.place(&path[at]);
                let by_drive = place.by_path * path[at].mobility;
                let mut slopes = slopes_at::<3>(shape, &path[at].x, &place.by_path, &by_drive);
                for (unknown, path) in nearby.iter().enumerate() {
                    let change = frame.place(&path[at]).place - place.place;
                    slopes.set_column(unknown, &(change / STEP));
                }
                let normal = normals[edge];
                EdgeRow {
                    edge,
                    form: slopes.tr_mul(&normal),
                    normal: place.by_start.tr_mul(&normal),
                    slack: offset - normal.dot(&place.place),
                }
            };
            all.push(RollRows {
                rows: roll.edges.iter().map(row).collect(),
                is_start_known: roll.is_start_known,
                share: roll.share,
            });
        }
        Some(all)
    }

    /// Largest value of `direction · β` over the set of possible mobilities (contact travels per radian), where β is a
    /// mobility of the set minus the mobility at the centre of the set. Each step linearises the bounds at the last
    /// maximum and maximises again, until the value changes by less than [`CONVERGED`]. Then the expected next change
    /// is added. `None` if the set is unbounded in this direction.
    fn furthest(&self, direction: &Vector3<f64>, programs: &mut Programs) -> Option<f64> {
        let mean = direction.dot(&self.mean);
        let (mut change, mut moved) = furthest_change(&self.rows, direction, programs)?;
        let mut starts: Vec<_> = self.rolls.iter().map(|roll| roll.start).collect();
        let (mut largest, mut is_curved) = (direction.dot(&change), false);
        for _ in 0..PASSES {
            if change.amax() > 0.9 * OPEN {
                return None;
            }
            for (start, moved) in starts.iter_mut().zip(&moved) {
                *start += moved;
            }
            let mobility = self.centre + matrix(&change);
            let shape = LocalShape::of_mobility(&mobility).filter(|_| is_rolling(&mobility))?;
            let rows = self.linearised(&shape, &starts)?;
            let step;
            // The bounds differ slightly, so begin at the corner at which the previous program ended.
            let mut near = Programs::default();
            near.starts.clone_from(&programs.starts);
            (step, moved) = furthest_change(&rows, direction, &mut near)?;
            let last = direction.dot(&change);
            change += step;
            let found = direction.dot(&change);
            let (distance, apart) = ((found - mean).abs(), (found - last).abs());
            // This pass changed the maximum by `apart`. The next pass is expected to change it by `apart` times the ratio
            // of `apart` to the maximum's distance from the mean. Add this expected change.
            let next = found.max(last) + apart * (apart / distance).min(1.0);
            largest = largest.max(next);
            is_curved |= apart > CURVED * distance;
            if apart < CONVERGED * distance + 1e-13 {
                return Some(if is_curved { largest } else { next });
            }
        }
        Some(largest)
    }

    /// Bounds of the smallest and the largest eigenvalue of A δ over the set of possible mobilities. Mobility is the
    /// contact's travel per radian. δ is a mobility of the set minus the mean mobility, and A is the inverse of the
    /// mean mobility. `None` if the set is unbounded.
    pub(crate) fn deviations(&self) -> Option<[f64; 2]> {
        *self.deviations.get_or_init(|| {
            let root = self.mobility().try_inverse()?.cholesky()?.unpack();
            let [along, across] = [root.column(0), root.column(1)];
            let mut programs = Programs::default();
            let mut ends = |product: Matrix2<f64>| {
                let direction = entries(&(product + product.transpose())) * 0.5;
                let mut end = |sign: f64| {
                    let end = self.furthest(&(direction * sign), &mut programs)?;
                    Some((end - sign * direction.dot(&self.mean)).max(0.0))
                };
                Some([end(-1.0)?, end(1.0)?])
            };
            let first = ends(along * along.transpose())?;
            let second = ends(across * across.transpose())?;
            let [low, high] = ends(along * across.transpose())?;
            let mixed = low.max(high);
            Some([
                -first[0].max(second[0]) - mixed,
                first[1].max(second[1]) + mixed,
            ])
        })
    }

    /// The smallest and the largest value of a curvature over the set of possible mobilities, in units of the probe's
    /// curvature. An end is `None` if the curvature has no bound there. `quantity` must not be a principal curvature.
    ///
    /// The curvature is a linear function of the mobility (contact travel per radian) plus a remainder. The
    /// [deviations](Self::deviations) of the mobility from its mean limit this remainder.
    pub(crate) fn ends(&self, quantity: Quantity) -> [Option<f64>; 2] {
        self.ends_by(quantity, &mut Programs::default())
    }

    fn ends_by(&self, quantity: Quantity, programs: &mut Programs) -> [Option<f64>; 2] {
        let Some(relative) = self.mobility().try_inverse() else {
            return [None; 2];
        };
        let square = relative * relative;
        let (trace, determinant) = (relative.trace(), relative.determinant());
        let deviations = self.deviations().filter(|ends| ends[0] > -1.0);
        // The inverse of the mobility (contact travel per radian), and the determinant of this inverse, are linear
        // functions of the mobility plus a remainder. Compute upper bounds of both remainders. They are convex
        // functions of the deviation of the mobility from its mean, so each is largest at an end of the range of
        // deviations.
        let inverse = deviations.map(|ends| ends.map(|e| e * e / (1.0 + e)));
        let inverse = inverse.map_or(f64::INFINITY, |[low, high]| low.max(high));
        let product =
            |one: f64, other: f64| 1.0 / ((1.0 + one) * (1.0 + other)) - 1.0 + one + other;
        let product = deviations.map(|[low, high]| {
            product(low, low)
                .max(product(low, high))
                .max(product(high, high))
        });
        let (value, slopes, remainder, least) = match quantity {
            Quantity::Normal { angle_rad } => {
                let (sin, cos) = libm::sincos(angle_rad);
                let direction = Vector2::new(cos, sin);
                let across = relative * direction;
                let value = direction.dot(&across);
                let slopes = -across * across.transpose();
                (value - 1.0, slopes, [0.0, inverse * value], -1.0)
            }
            Quantity::Gaussian => (
                determinant - trace + 1.0,
                square - relative * determinant,
                [
                    -inverse * trace,
                    product.unwrap_or(f64::INFINITY) * determinant,
                ],
                f64::NEG_INFINITY,
            ),
            _ => (
                0.5 * trace - 1.0,
                -square * 0.5,
                [0.0, 0.5 * inverse * trace],
                -1.0,
            ),
        };
        let direction = entries(&slopes);
        let mut end = |sign: f64| {
            let end = self.furthest(&(direction * sign), programs);
            end.map_or(f64::INFINITY, |end| end - sign * direction.dot(&self.mean))
        };
        let [low, high] = [-end(-1.0), end(1.0)];
        let low = (value + low.min(0.0) + remainder[0]).max(least);
        let high = value + high.max(0.0) + remainder[1];
        [low, high].map(|end| end.is_finite().then_some(end))
    }

    /// The smallest and the largest value of each principal curvature over the set of possible mobilities, in units of
    /// the probe's curvature. The first pair belongs to the smaller principal curvature. An end is infinite if the
    /// curvature has no bound.
    pub(crate) fn principal_ends(&self) -> [[f64; 2]; 2] {
        *self.principal.get_or_init(|| {
            let form = self.mobility().try_inverse().unwrap_or_default() - Matrix2::identity();
            let first = 0.5 * libm::atan2(2.0 * form[(0, 1)], form[(0, 0)] - form[(1, 1)]);
            let step = std::f64::consts::PI / DIRECTIONS as f64;
            let mut programs = Programs::default();
            // For each direction: the normal curvature at the mean mobility (contact travel per radian), and the
            // smallest and the largest difference of the normal curvature from this value over all possible mobilities.
            // The directions include the principal directions of the curvature at the mean mobility.
            let all: Vec<[f64; 3]> = (0..DIRECTIONS)
                .map(|at| {
                    let angle_rad = first + step * at as f64;
                    let (sin, cos) = libm::sincos(angle_rad);
                    let direction = Vector2::new(cos, sin);
                    let own = direction.dot(&(form * direction));
                    let [low, high] = self.ends_by(Quantity::Normal { angle_rad }, &mut programs);
                    let [low, high] = [low.unwrap_or(-1.0), high.unwrap_or(f64::INFINITY)];
                    [own, low - own, high - own]
                })
                .collect();
            // Take one mobility. In the direction θ, its normal curvature minus that of the mean mobility is m + r
            // cos(2(θ − φ)), where m is the mean over all directions. Between two neighbouring directions of the grid,
            // this difference exceeds the larger of its values at these two directions by at most `excess` × (larger
            // value − m).
            let excess = 1.0 / libm::cos(step) - 1.0;
            let mean =
                [1, 2].map(|end| all.iter().map(|one| one[end]).sum::<f64>() / DIRECTIONS as f64);
            let mut outer = [f64::INFINITY, f64::NEG_INFINITY];
            let mut inner = outer;
            for (at, one) in all.iter().enumerate() {
                let next = &all[(at + 1) % DIRECTIONS];
                let [low, high] = [one[1].min(next[1]), one[2].max(next[2])];
                let low = one[0].min(next[0]) + low - excess * (mean[1] - low);
                let high = one[0].max(next[0]) + high + excess * (high - mean[0]);
                outer = [outer[0].min(low), outer[1].max(high)];
                inner = [inner[0].min(one[0] + one[2]), inner[1].max(one[0] + one[1])];
            }
            [[outer[0].max(-1.0), inner[0]], [inner[1], outer[1]]]
        })
    }
}

/// Gradient of `tr(slopes · δ)` with respect to the entries uu, uv, vv of the symmetric matrix δ.
fn entries(slopes: &Matrix2<f64>) -> Vector3<f64> {
    Vector3::new(slopes[(0, 0)], 2.0 * slopes[(0, 1)], slopes[(1, 1)])
}

/// The middle of the set of possible changes of the mobility (contact travel per radian). The first part is the mean of
/// the extreme changes along the axes uu, uv, vv. The second part contains the half-widths of the set along these axes,
/// and the third part the mean change of each roll's start.
type Middle = (Vector3<f64>, Vector3<f64>, Vec<Vector2<f64>>);

/// Computes the middle of the set of possible changes of the mobility (contact travel per radian). `None` if the set is
/// empty.
fn middle(rows: &[RollRows]) -> Option<Middle> {
    let (mut mean, mut half_widths) = (Vector3::zeros(), Vector3::zeros());
    let mut starts = vec![Vector2::zeros(); rows.len()];
    let mut programs = Programs::default();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut direction = Vector3::zeros();
            direction[axis] = sign;
            let (point, moved) = furthest_change(rows, &direction, &mut programs)?;
            mean += point / 6.0;
            half_widths[axis] += 0.5 * sign * point[axis];
            starts
                .iter_mut()
                .zip(moved)
                .for_each(|(start, moved)| *start += moved / 6.0);
        }
    }
    Some((mean, half_widths.map(|width: f64| width.max(1e-12)), starts))
}
