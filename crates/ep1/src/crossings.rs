//! The crossings of pad edges in a roll.

use nalgebra::{Matrix2, Matrix3x4, Matrix4, RowVector4, Vector2, Vector3, Vector4};

use crate::rolled_path::drive_of;
use crate::{PadCell, RollSample, SeriesNoise};

/// A parabola is fitted to the measured rotations near a change of the active pad, to average their noise. This constant
/// determines the length of the parabola. It is the rotation over half of the parabola, divided by the standard
/// deviation of a measured rotation.
const REACH: f64 = 20.0;
/// Largest number of samples in half of the parabola that is fitted to the measured rotations near a change of the
/// active pad.
const MOST_REACH: usize = 10_000;
/// The parabola is shortened if a term with the fourth power of time improves the fit significantly, because the probe
/// stops or turns near the crossing. This constant is the largest accepted decrease of chi-squared.
const MAX_FOURTH: f64 = 12.0;
/// The rotation at a crossing of a pad edge is uncertain, because the active pad changes between two samples. The
/// uncertain range is the rotation between these samples, projected onto the direction that moves the contact across
/// the edge. This constant is the smallest assumed width of the range, relative to the whole rotation between the
/// samples.
const MIN_WIDTH: f64 = 0.05;
/// Two crossings of one edge count as one crossing if their rotations are almost equal. The largest difference is the
/// sum of the ranges in which the pad changes, plus this multiple of the difference's standard deviation.
const NEAR: f64 = 4.0;
/// Number of earlier crossings with which a crossing is compared.
const MAX_COMPARED: usize = 200;
/// Smallest standard deviation (rad) of the rotation at a crossing. A smaller value may be a rounding error.
const MIN_STD: f64 = 1e-9;

/// A contact has turned back only if its rotation halfway is larger than this value (rad per length) times the largest
/// distance of alternating pads. For smaller rotations, the pads only alternate.
const MIN_RETURN: f64 = 0.07;
/// The successive samples on one pad are divided into this number of intervals. Only the samples at the ends of the
/// intervals bound the contact's position. The other samples would hardly improve the bounds, because the contact moves
/// steadily.
const PROBED: usize = 4;

/// The path of the contact is nearly parallel to an edge if it moves across the edge by at most this share of its
/// length.
const NEARLY_PARALLEL: f64 = 0.1;

/// A run: successive samples of a roll with the same active pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) first: usize,
    pub(crate) last: usize,
    /// Centre of the pad that is active in these samples.
    pub(crate) centre: Vector2<f64>,
}

/// A crossing: the contact moves over a pad edge. The edge lies on the line `normal · place = offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) normal: Vector2<f64>,
    pub(crate) offset: f64,
    /// Distance between the facing edges of the pads before and after the crossing, but at most the pitch; 0 if the
    /// pads are neighbours. A dead pad can cause such a gap.
    pub(crate) gap: f64,
    /// Rotation vector of the probe, from the start of the roll to the crossing.
    pub(crate) rotation: Vector3<f64>,
    /// Variance (rad²) of the rotation due to noise, and due to alternating pads if there are any.
    pub(crate) variance: f64,
    /// Drive (rotation vector, turned by 90°) from the last sample before the crossing to the next sample on another pad.
    pub(crate) change: Vector2<f64>,
    /// Index of the last sample before the crossing.
    pub(crate) sample: usize,
}

impl Crossing {
    /// Width of the range of `across · drive` in which the active pad changes. `change` is the change of the drive between
    /// the samples before and after. The unit is rad if `across` is a unit vector.
    pub(crate) fn width(across: &Vector2<f64>, change: &Vector2<f64>) -> f64 {
        // If the path is nearly parallel to the edge, `change` has nearly no component across the edge. Then the
        // uncertain direction of the path limits the accuracy of the crossing, so the width has a lower limit.
        libm::hypot(
            across.dot(change),
            MIN_WIDTH * across.norm() * change.norm(),
        )
    }
}

/// A run consists of successive samples on one pad. While the contact moves over an edge, the pads beside it may be
/// active alternately, and then the active pad does not locate the contact. So if a pad becomes active again soon, the
/// runs before its last run are removed, except if the contact has turned back. The centres of alternating pads are less
/// than `reach` apart.
pub(crate) fn without_chatter(samples: &[RollSample], all: &[Run], reach: f64) -> Vec<Run> {
    let mut kept = Vec::with_capacity(all.len());
    let mut at = 0;
    while let Some(run) = all.get(at) {
        kept.push(*run);
        let is_near = |other: &&Run| (other.centre - run.centre).norm() < reach;
        let near = all[at + 1..].iter().take_while(is_near).zip(at + 1..);
        let (mut again, mut longest) = (at, run.last - run.first);
        for (other, place) in near.filter(|(other, _)| other.centre == run.centre) {
            let [from, to] = [all[again].last, other.first];
            let turn = |part: usize| {
                let turn = samples[from + part * (to - from) / 4].rotation - samples[from].rotation;
                drive_of(&turn).norm()
            };
            let turns_back = turn(2) > (2.0 * turn(4)).max(MIN_RETURN * reach);
            longest = longest.max(other.last - other.first);
            if turns_back || (place > again + 2 && to - from > longest) {
                break;
            }
            again = place;
        }
        let is_next = |other: &Run| {
            let next = all.get(again + 1);
            next.is_some_and(|next| other.centre == next.centre)
        };
        // If the contact then leaves the alternating pads, also keep the last run on the first pad.
        let leaves = again == at || all[at..again].iter().any(is_next);
        at = if leaves { again + 1 } else { again };
    }
    kept
}

/// The crossings of pad edges between successive runs. A run consists of successive samples on one pad. Distances are
/// in radii of the probe.
pub(crate) fn crossings(
    samples: &[RollSample],
    runs: &[Run],
    pitch: f64,
    cell: &PadCell,
    noise: &SeriesNoise,
) -> Vec<Crossing> {
    let mut all = Vec::new();
    for pair in runs.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        let between = after.centre - before.centre;
        let distances = cell.normals().map(|normal| normal.dot(&between));
        let furthest = distances.fold(0.0, f64::max);
        for normal in cell.normals() {
            let distance = normal.dot(&between);
            // If two square pads lie in different columns, the contact must cross an edge between columns; if they lie
            // in different rows, it must also cross an edge between rows. Between hexagonal pads, it must cross only
            // the edge along whose normal their centres are farthest apart (two edges, if both distances are equal).
            let is_crossed = match cell.pairs() {
                2 => distance > 0.5 * pitch,
                _ => distance > furthest - 1e-6 * pitch && distance > 0.5 * pitch,
            };
            if !is_crossed {
                continue;
            }
            let edges = [
                normal.dot(&before.centre) + 0.5 * pitch,
                normal.dot(&after.centre) - 0.5 * pitch,
            ];
            let (rotation, variance, change) = rotation_at_change(samples, &before, &after, noise);
            let width = Crossing::width(&normal, &change);
            let offset = 0.5 * (edges[0] + edges[1]);
            let spread = (2.0 * variance).sqrt() * NEAR;
            let is_repeated = |one: &Crossing| {
                let sign = one.normal.dot(&normal);
                let is_same = sign.abs() > 0.9 && (one.offset - sign * offset).abs() < 1e-6 * pitch;
                let widths = width + Crossing::width(&one.normal, &one.change);
                is_same && (one.rotation - rotation).norm() < widths + spread
            };
            // If the contact crosses an edge again at the same place, the samples around both crossings may have equal
            // rotations. Then both crossings have the same error, and the second one adds no information. So only the
            // first crossing counts.
            if all.iter().rev().take(MAX_COMPARED).any(is_repeated) {
                continue;
            }
            all.push(Crossing {
                normal,
                offset,
                gap: (edges[1] - edges[0]).clamp(0.0, pitch),
                rotation,
                variance: variance.max(MIN_STD * MIN_STD),
                change,
                sample: before.last,
            });
        }
    }
    all
}

/// The rotation vector at the change from the pad of the run `before` to the pad of the run `after`. A run consists of
/// successive samples on one pad. The second result is the variance (rad²) of the rotation due to noise, and the third
/// the drive (rotation vector, turned by 90°) from the last sample before the change to the first sample after it.
///
/// The active pad changes between two samples, so the time of the change is uncertain by one sampling interval. A
/// parabola is fitted to the measured rotations near the change, to average their noise. The result is the value of the
/// parabola at the change. A straight line would be biased while the probe starts or stops. Both halves of the parabola
/// have the same number of samples, unless a run is too short. The half in which the probe rotates faster determines
/// this number, so that the parabola includes little of a rest before or after the roll.
fn rotation_at_change(
    samples: &[RollSample],
    before: &Run,
    after: &Run,
    noise: &SeriesNoise,
) -> (Vector3<f64>, f64, Vector2<f64>) {
    let [low, high] = [samples[before.last], samples[after.first]];
    let middle = (low.rotation + high.rotation) * 0.5;
    let std = libm::hypot(
        noise.rotation_std_rad,
        noise.relative_sample_std * drive_of(&middle).norm(),
    );
    let [mut rotation, mut change] = [middle, high.rotation - low.rotation];
    let mut variance = 0.0;
    if std > 0.0 {
        let far = |one: &RollSample| (one.rotation - middle).norm() > REACH * std;
        let [old, new] = [
            &samples[before.first..=before.last],
            &samples[after.first..=after.last],
        ];
        let shorter = 2 * old.len().min(new.len());
        let reach = match (old.iter().rev().position(far), new.iter().position(far)) {
            (Some(one), Some(other)) => one.min(other),
            (one, other) => one.or(other).unwrap_or(shorter),
        };
        let mut reach = reach.min(MOST_REACH) + 2;
        let middle_s = 0.5 * (low.time_s + high.time_s);
        loop {
            let from = before.first.max(before.last.saturating_sub(reach));
            let near = &samples[from..=after.last.min(after.first + reach)];
            let last = near[near.len() - 1];
            let unit_s = last.time_s - near[0].time_s;
            // The bend of the parabola has a normal prior. Its standard deviation is the length of the rotation along
            // the parabola.
            let bend = (last.rotation - near[0].rotation).norm_squared() / (std * std);
            let prior = bend.max(1.0).recip();
            let mut information = Matrix4::from_diagonal(&Vector4::new(0.0, 0.0, prior, 0.0));
            let mut sums = Matrix3x4::zeros();
            for one in near {
                let time = (one.time_s - middle_s) / unit_s;
                let square = time * time;
                let powers = RowVector4::new(1.0, time, square, square * square);
                information += powers.tr_mul(&powers);
                sums += one.rotation * powers;
            }
            let fourth = information.try_inverse().map_or(0.0, |inverse| {
                let fourth = (sums * inverse.column(3)).norm_squared();
                fourth / (inverse[(3, 3)] * std * std)
            });
            let shorter = near.len() / 4;
            if fourth > MAX_FOURTH && near.len() > 8 && shorter < reach {
                reach = shorter;
                continue;
            }
            let parabola = information.fixed_view::<3, 3>(0, 0).into_owned();
            if let Some(inverse) = parabola.try_inverse()
                && inverse[(0, 0)] > 0.0
            {
                let fitted = sums.fixed_columns::<3>(0) * inverse;
                rotation = fitted.column(0).into();
                change = fitted.column(1) * ((high.time_s - low.time_s) / unit_s);
                variance = std * std * inverse[(0, 0)];
            }
            break;
        }
    }
    (rotation, variance, drive_of(&change))
}

/// Selects samples that bound the position of the contact. A run is a series of successive samples on one pad. For each
/// run and each edge of its pad, selects the sample whose contact is nearest to this edge. The run is divided into
/// [`PROBED`] intervals, and only the samples at their ends are compared. If several runs have the same edge, only one
/// sample is returned for this edge. Each result consists of the index of the edge, the offset of the edge and the
/// index of the sample.
pub(crate) fn edge_samples(
    samples: &[RollSample],
    runs: &[Run],
    pitch: f64,
    cell: &PadCell,
    mobility: &Matrix2<f64>,
) -> Vec<(usize, f64, usize)> {
    let mut all: Vec<(usize, f64, usize, f64)> = Vec::with_capacity(4 * runs.len());
    let turned = samples.last().map_or(Vector3::zeros(), |one| one.rotation);
    for (edge, normal) in cell.normals().enumerate() {
        let across = mobility * normal;
        let axis = Vector3::new(across.y, -across.x, 0.0);
        let tilt = Vector3::new(across.x, across.y, 0.0) * NEARLY_PARALLEL;
        // If the path is nearly parallel to the edge, the contact nearest to the edge may be at either end of a run,
        // because the direction of the path is not known exactly. So tilt the edge slightly to both sides, and select
        // the nearest sample for each tilt.
        let is_parallel = axis.dot(&turned).abs() <= tilt.dot(&turned).abs();
        for tilt in [tilt, -tilt].iter().take(1 + usize::from(is_parallel)) {
            let axis = if is_parallel { axis + tilt } else { axis };
            let from = all.len();
            for run in runs {
                let offset = normal.dot(&run.centre) + 0.5 * pitch;
                let mut furthest = (run.first, f64::NEG_INFINITY);
                let length = run.last - run.first;
                let intervals = length.clamp(1, PROBED);
                for probed in 0..=intervals {
                    let sample = run.first + probed * length / intervals;
                    let along = axis.dot(&samples[sample].rotation);
                    if along > furthest.1 {
                        furthest = (sample, along);
                    }
                }
                let is_same =
                    |one: &&mut (usize, f64, usize, f64)| (one.1 - offset).abs() < 1e-6 * pitch;
                match all[from..].iter_mut().find(is_same) {
                    Some(one) if one.3 >= furthest.1 => {}
                    Some(one) => *one = (edge, offset, furthest.0, furthest.1),
                    None => all.push((edge, offset, furthest.0, furthest.1)),
                }
            }
        }
    }
    all.sort_unstable_by_key(|one| one.2);
    all.into_iter()
        .map(|(edge, offset, sample, _)| (edge, offset, sample))
        .collect()
}
