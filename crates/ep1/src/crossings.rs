//! The crossings of pad edges in a roll.

use nalgebra::{Matrix2, Vector2, Vector3};
use palpate_statistics::normal_tail;

use crate::{PadCell, RollSample, SeriesNoise};

/// Number of points of the integral over the place of a crossing.
const GRID: usize = 33;
/// Samples further than this number of standard deviations from a crossing do not change its estimate.
const REACH: f64 = 7.0;
/// Smallest standard deviation of a crossing, rad. A smaller value may be a rounding error.
const MIN_STD: f64 = 1e-9;

/// Successive samples with the same active pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) first: usize,
    pub(crate) last: usize,
    /// Centre of the pad.
    pub(crate) centre: Vector2<f64>,
}

/// A crossing of the edge `normal · place = offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) normal: Vector2<f64>,
    pub(crate) offset: f64,
    /// Distance between the edges of both pads; 0 if the pads are neighbours.
    pub(crate) gap: f64,
    /// Rotation vector of the probe at the crossing.
    pub(crate) rotation: Vector3<f64>,
    /// Standard deviation of the rotation in the direction that moves the contact across the edge, rad.
    pub(crate) std: f64,
}

/// The runs of a roll. If the active pad changes back to the pad before, the samples between both changes are omitted,
/// because a pad that alternates with its neighbour does not locate the contact. Places are divided by `radius`.
pub(crate) fn runs(radius: f64, samples: &[RollSample]) -> Vec<Run> {
    let mut all: Vec<Run> = Vec::new();
    let mut place = Vector2::repeat(f64::NAN);
    for (index, sample) in samples.iter().enumerate() {
        if sample.place == place {
            continue;
        }
        if let Some(run) = all.last_mut() {
            run.last = index - 1;
        }
        place = sample.place;
        all.push(Run {
            first: index,
            last: samples.len() - 1,
            centre: place / radius,
        });
    }
    let mut kept = Vec::with_capacity(all.len());
    let mut at = 0;
    while at < all.len() {
        kept.push(all[at]);
        let mut end = at;
        while end + 2 < all.len() && all[end + 2].centre == all[end].centre {
            end += 1;
        }
        at = end + 1;
    }
    kept
}

/// The drive (−Δθ_y, Δθ_x) of a rotation vector.
pub(crate) fn drive(rotation: &Vector3<f64>) -> Vector2<f64> {
    Vector2::new(-rotation.y, rotation.x)
}

/// The crossings between successive runs. Distances are in radii of the probe. `mobility` determines the direction of
/// the drive that moves the contact across an edge.
pub(crate) fn crossings(
    samples: &[RollSample],
    runs: &[Run],
    pitch: f64,
    cell: &PadCell,
    noise: &SeriesNoise,
    mobility: &Matrix2<f64>,
) -> Vec<Crossing> {
    let mut all = Vec::new();
    for pair in runs.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        let between = after.centre - before.centre;
        let pairs = cell.edges() / 2;
        let furthest = cell.normals().take(pairs);
        let furthest = furthest
            .map(|normal| normal.dot(&between).abs())
            .fold(0.0, f64::max);
        for normal in cell.normals() {
            let distance = normal.dot(&between);
            // On squares, the contact crosses each edge between the columns and rows of both pads. On hexagons, only
            // the edge across the largest distance is surely crossed.
            let is_crossed = match pairs {
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
            let across = (mobility * normal).normalize();
            let (rotation, std) = threshold(samples, &before, &after, noise, &across);
            all.push(Crossing {
                normal,
                offset: 0.5 * (edges[0] + edges[1]),
                gap: (edges[1] - edges[0]).max(0.0),
                rotation,
                std: std.max(MIN_STD),
            });
        }
    }
    all
}

/// The rotation at the change between two runs, and its standard deviation in the direction `across` of the drive. The
/// likelihood is the product of the probabilities that the true rotation of each sample is on the side of its pad.
fn threshold(
    samples: &[RollSample],
    before: &Run,
    after: &Run,
    noise: &SeriesNoise,
    across: &Vector2<f64>,
) -> (Vector3<f64>, f64) {
    let drive_across = |sample: usize| drive(&samples[sample].rotation).dot(across);
    let [low, high] = [samples[before.last].rotation, samples[after.first].rotation];
    let middle = (low + high) * 0.5;
    let width = drive_across(after.first) - drive_across(before.last);
    let std_at = |rotation: &Vector3<f64>| {
        libm::hypot(
            noise.rotation_std_rad,
            noise.relative_sample_std * rotation.norm(),
        )
    };
    let std = std_at(&middle);
    if std < 1e-3 * width.abs() || std == 0.0 {
        return (middle, width.abs() / 12.0_f64.sqrt());
    }
    let count = (after.last - before.first).max(1) as f64;
    let speed = (drive_across(after.last) - drive_across(before.first)) / count;
    let reach = REACH * std / speed.abs().max(1e-300);
    let reach = reach.min(count) as usize + 2;
    let below = before.first.max(before.last.saturating_sub(reach))..=before.last;
    let above = after.first..=after.last.min(after.first + reach);
    let mut mean = Vector3::zeros();
    let mut total = 0.0;
    let mut sides = Vec::with_capacity(2 * reach + 2);
    for (sample, side) in below
        .map(|sample| (sample, 1.0))
        .chain(above.map(|sample| (sample, -1.0)))
    {
        let rotation = samples[sample].rotation;
        mean += rotation;
        total += 1.0;
        sides.push((
            drive_across(sample),
            side / std_at(&rotation).max(0.1 * std),
        ));
    }
    mean /= total;
    let half = 4.0 * std + (speed * (after.first - before.last) as f64).abs();
    let centre = drive(&middle).dot(across);
    // Sum the likelihood twice: around the change of pads, then around the first result.
    let mut found = (centre, half);
    for _ in 0..2 {
        found = moments(&sides, found.0, half).unwrap_or((centre, half));
    }
    let (threshold, std) = found;
    let by = across * (threshold - drive(&mean).dot(across));
    (mean + Vector3::new(by.y, -by.x, 0.0), std)
}

/// Mean and standard deviation of the threshold between samples. Each sample has a place and a side, divided by its
/// standard deviation.
fn moments(sides: &[(f64, f64)], centre: f64, half: f64) -> Option<(f64, f64)> {
    let place = |point: usize| centre + half * (2.0 * point as f64 / (GRID - 1) as f64 - 1.0);
    let mut logs = [0.0; GRID];
    for (point, log) in logs.iter_mut().enumerate() {
        let at = place(point);
        let mut product = 1.0;
        for (sample, side) in sides {
            let score = (sample - at) * side;
            if score > -REACH {
                product *= normal_tail(score);
                if product < 1e-200 {
                    *log += libm::log(product.max(1e-320));
                    product = 1.0;
                }
            }
        }
        *log += libm::log(product);
    }
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
    for (point, log) in logs.iter().enumerate() {
        let weight = libm::exp(log - most);
        let at = place(point) - centre;
        sum += weight;
        first += weight * at;
        second += weight * at * at;
    }
    let mean = first / sum;
    let variance = second / sum - mean * mean;
    (variance > 0.0).then(|| (centre + mean, variance.sqrt()))
}

/// For each edge of each run, the sample that is furthest towards this edge. Of several runs with the same edge, only
/// the furthest sample is returned. The results are the index of the edge, its offset and the sample.
pub(crate) fn edge_samples(
    samples: &[RollSample],
    runs: &[Run],
    pitch: f64,
    cell: &PadCell,
    mobility: &Matrix2<f64>,
) -> Vec<(usize, f64, usize)> {
    let mut all: Vec<(usize, f64, usize, f64)> = Vec::new();
    let pairs = cell.edges() / 2;
    for (edge, normal) in cell.normals().take(pairs).enumerate() {
        let across = mobility * normal;
        let axis = Vector3::new(across.y, -across.x, 0.0);
        for run in runs {
            let (mut least, mut most) =
                ((run.first, f64::INFINITY), (run.first, f64::NEG_INFINITY));
            for (index, sample) in samples[run.first..=run.last].iter().enumerate() {
                let along = axis.dot(&sample.rotation);
                if along > most.1 {
                    most = (run.first + index, along);
                }
                if along < least.1 {
                    least = (run.first + index, along);
                }
            }
            let centre = normal.dot(&run.centre);
            for (edge, offset, (sample, reach)) in [
                (edge, centre + 0.5 * pitch, most),
                (edge + pairs, 0.5 * pitch - centre, (least.0, -least.1)),
            ] {
                let same = |one: &&mut (usize, f64, usize, f64)| {
                    one.0 == edge && (one.1 - offset).abs() < 1e-6 * pitch
                };
                match all.iter_mut().find(same) {
                    Some(one) if one.3 >= reach => {}
                    Some(one) => *one = (edge, offset, sample, reach),
                    None => all.push((edge, offset, sample, reach)),
                }
            }
        }
    }
    all.sort_unstable_by_key(|one| one.2);
    all.into_iter()
        .map(|(edge, offset, sample, _)| (edge, offset, sample))
        .collect()
}
