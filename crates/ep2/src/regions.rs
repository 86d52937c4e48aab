//! Divides a map into connected regions of one shape class.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use palpate_geometry::{ShapeClass, ShapeThresholds};

use crate::{Ep2Error, MapPoint};

/// The coherence is the agreement of the directions of largest curvature in a region, from 0 (none) to 1 (parallel). A
/// region has a mean direction only if its coherence is at least this value.
const LEAST_COHERENCE: f64 = 0.1;

/// A map that is divided into regions of one shape class.
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    /// For each point of the map, the index of its region in `regions`.
    pub of_point: Vec<usize>,
    /// The regions, sorted by area, largest first.
    pub regions: Vec<Region>,
}

/// A connected part of a map, in which all points have the same shape class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Shape class of the region.
    pub class: ShapeClass,
    /// Number of points of the map in the region.
    pub points: usize,
    /// Area (length²) of the surface that the points of the region represent.
    pub area: f64,
    /// Average (1/length²) of the Gaussian curvature over the area of the region.
    pub gaussian_curvature: f64,
    /// Average (1/length) of the mean curvature over the area of the region.
    pub mean_curvature: f64,
    /// Unit vector of the mean direction of largest curvature, with an arbitrary sign. `None` if the points have no
    /// common direction, as on a sphere.
    pub direction_of_max: Option<Vector3<f64>>,
    /// Agreement of the points' directions of largest curvature, from 0 (none) to 1 (parallel).
    pub coherence: f64,
}

/// Divides a map of `side` × `side` points into regions. The neighbours of a point are the adjacent points in the same
/// row and in the same column.
///
/// # Errors
/// [`Ep2Error::BadSetting`] unless there are `side`² points; [`Ep2Error::OutOfRange`] if a number of a point is not
/// finite, or if a result computed from the points is not.
pub fn regions(
    side: usize,
    points: &[MapPoint],
    thresholds: &ShapeThresholds,
) -> Result<Regions, Ep2Error> {
    let is_good = side.checked_mul(side) == Some(points.len());
    let expected = "the square of the number of grid points per side";
    Ep2Error::unless_good("points", points.len() as f64, is_good, expected)?;
    if !points.iter().all(MapPoint::is_finite) {
        return Err(Ep2Error::OutOfRange);
    }
    let classes: Vec<ShapeClass> = points
        .iter()
        .map(|point| thresholds.classify(point.curvature.gaussian, point.curvature.mean))
        .collect();
    const NONE: usize = usize::MAX;
    let mut of_point = vec![NONE; points.len()];
    let mut members: Vec<Vec<usize>> = Vec::new();
    for start in 0..points.len() {
        if of_point[start] != NONE {
            continue;
        }
        let region = members.len();
        let mut found = vec![start];
        of_point[start] = region;
        let mut next = 0;
        while let Some(&point) = found.get(next) {
            next += 1;
            for neighbour in neighbours(point, side) {
                if of_point[neighbour] == NONE && classes[neighbour] == classes[start] {
                    of_point[neighbour] = region;
                    found.push(neighbour);
                }
            }
        }
        members.push(found);
    }
    let mut order: Vec<(usize, Region)> = members
        .iter()
        .map(|members| region(classes[members[0]], members, side, points))
        .enumerate()
        .collect();
    order.sort_by(|(_, one), (_, other)| other.area.total_cmp(&one.area));
    let mut place = vec![0; order.len()];
    for (new, (old, _)) in order.iter().enumerate() {
        place[*old] = new;
    }
    let regions: Vec<Region> = order.into_iter().map(|(_, region)| region).collect();
    let finite = |region: &Region| {
        (region.area + region.gaussian_curvature + region.mean_curvature).is_finite()
    };
    if !regions.iter().all(finite) {
        return Err(Ep2Error::OutOfRange);
    }
    Ok(Regions {
        of_point: of_point.into_iter().map(|old| place[old]).collect(),
        regions,
    })
}

fn neighbours(point: usize, side: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (point / side, point % side);
    let above = (row > 0).then(|| point - side);
    let below = (row + 1 < side).then(|| point + side);
    let left = (column > 0).then(|| point - 1);
    let right = (column + 1 < side).then(|| point + 1);
    [above, below, left, right].into_iter().flatten()
}

fn region(class: ShapeClass, members: &[usize], side: usize, points: &[MapPoint]) -> Region {
    // Areas are computed in units of the square of the longest span, so they do not overflow or underflow.
    let spans: Vec<[Vector3<f64>; 2]> = members
        .iter()
        .map(|&member| spans_of(member, side, points))
        .collect();
    let longest = spans
        .iter()
        .flatten()
        .map(Vector3::amax)
        .fold(0.0, f64::max);
    let areas: Vec<f64> = spans
        .iter()
        .map(|[along, across]| (along / longest).cross(&(across / longest)).norm())
        .collect();
    let area: f64 = areas.iter().sum();
    // If the total area that the points represent is 0, give all points the same weight.
    let share = |index: usize| {
        if area > 0.0 {
            areas[index] / area
        } else {
            1.0 / members.len() as f64
        }
    };
    let (mut gaussian, mut mean) = (0.0, 0.0);
    let (mut directions, mut anisotropy) = (Matrix3::zeros(), 0.0);
    let sharpest = members
        .iter()
        .map(|&member| points[member].k_max - points[member].k_min)
        .fold(f64::MIN_POSITIVE, f64::max);
    for (index, &member) in members.iter().enumerate() {
        let (point, share) = (&points[member], share(index));
        gaussian += share * point.curvature.gaussian;
        mean += share * point.curvature.mean;
        let weight = share * ((point.k_max - point.k_min) / sharpest);
        let [max, min] = [point.direction_of_max, point.direction_of_min];
        directions += (max * max.transpose() - min * min.transpose()) * weight;
        anisotropy += weight;
    }
    let eigen = SymmetricEigen::new(directions);
    let strongest = eigen.eigenvalues.imax();
    let coherence = if anisotropy > 0.0 {
        (eigen.eigenvalues[strongest] / anisotropy).clamp(0.0, 1.0)
    } else {
        0.0
    };
    Region {
        class,
        points: members.len(),
        area: if area > 0.0 {
            area * longest * longest
        } else {
            0.0
        },
        gaussian_curvature: gaussian,
        mean_curvature: mean,
        direction_of_max: (coherence >= LEAST_COHERENCE)
            .then(|| eigen.eigenvectors.column(strongest).into_owned()),
        coherence,
    }
}

/// Each point of the map represents a parallelogram that extends half-way to the neighbouring points. Returns the two
/// side vectors of the parallelogram.
fn spans_of(point: usize, side: usize, points: &[MapPoint]) -> [Vector3<f64>; 2] {
    let half_span = |place: usize, step: usize| {
        let start = point - step * usize::from(place > 0);
        let end = point + step * usize::from(place + 1 < side);
        (points[end].position - points[start].position) * 0.5
    };
    [half_span(point / side, side), half_span(point % side, 1)]
}
