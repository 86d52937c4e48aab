//! The set of curvatures that agree with exact rotations and pads.

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};

use crate::crossings::{Run, edge_samples};
use crate::feasible_set::{EdgeRow, FeasibleSet, OPEN, RollRows, distribution};
use crate::roll_fit::{RollData, SeriesFit};
use crate::rolled_path::{LocalShape, RollRotations, StartFrame};
use crate::{PadCell, RollSeries};

/// Largest number of linearisations.
const PASSES: usize = 3;
/// First guess of the largest change of the mobility in the set, in standard deviations of the fit.
const RANGE: f64 = 3.0;
/// If the set is wider than this multiple of the guess, or if it is empty, it is linearised again with a larger change.
const WIDER: f64 = 2.0;
/// Standard deviation of the first guess of the distribution, relative to the half-width of the set.
const STD_OF_HALF_WIDTH: f64 = 0.4;

/// A set of mobilities, relative to a centre, with its distribution.
#[derive(Clone, Debug)]
pub(crate) struct PadEdgeSet {
    /// Entries uu, uv, vv of the mobility at the centre, in radii of the probe.
    pub(crate) centre: Vector3<f64>,
    pub(crate) set: FeasibleSet,
    /// Mean change of the mobility over the set, and its covariance.
    pub(crate) mean: Vector3<f64>,
    pub(crate) covariance: Matrix3<f64>,
    /// Half-widths of the set along the entries of the mobility.
    pub(crate) half_widths: Vector3<f64>,
}

/// A roll whose pads bound the contact.
pub(crate) struct BoundedRoll<'r> {
    pub(crate) series: &'r RollSeries,
    pub(crate) runs: Vec<Run>,
}

/// The set of mobilities around the fit of crossings. `pitch` is in radii of the probe. `None` if the set is empty.
pub(crate) fn pad_edge_set(
    bounded: &[&BoundedRoll<'_>],
    data: &[RollData],
    fit: &SeriesFit<3>,
    pitch: f64,
    cell: &PadCell,
) -> Option<PadEdgeSet> {
    let mut shape = fit.shape;
    let mut starts: Vec<_> = fit.rolls.iter().map(|roll| roll.start).collect();
    let mut mobility_range = RANGE * fit.covariance.diagonal().max().sqrt();
    for pass in 1..=PASSES {
        let mobility = shape.relative().try_inverse()?;
        let mut rows = Vec::with_capacity(bounded.len());
        for (at, bounded) in bounded.iter().enumerate() {
            let linearised = Linearised {
                bounded,
                is_start_known: data[at].is_start_known,
                start: starts[at],
                response: fit.rolls[at].start_response(),
                pitch,
                cell,
                shape: &shape,
                mobility_range,
            };
            rows.push(linearised.rows(&mobility)?);
        }
        let set = FeasibleSet::of_rolls(rows.iter());
        let Some((middle, half_widths)) = set.middle() else {
            mobility_range *= WIDER;
            continue;
        };
        // First guess of the distribution: its standard deviations are a fixed share of the half-widths of the set, and
        // its correlations are those of the fit.
        let scale = half_widths.zip_map(&fit.covariance.diagonal(), |half_width, variance| {
            STD_OF_HALF_WIDTH * half_width / variance.sqrt()
        });
        let scale = Matrix3::from_diagonal(&scale);
        let guess = scale * fit.covariance * scale;
        let (mean, covariance) = distribution(&rows, middle, guess).unwrap_or((middle, guess));
        let centre = Vector3::new(mobility[(0, 0)], mobility[(0, 1)], mobility[(1, 1)]);
        let is_covered = (half_widths + middle.abs()).amax() <= WIDER * mobility_range;
        if is_covered || pass == PASSES {
            return Some(PadEdgeSet {
                centre,
                set,
                mean,
                covariance,
                half_widths,
            });
        }
        let moved = centre + mean;
        let moved = Matrix2::new(moved.x, moved.y, moved.y, moved.z);
        if moved.determinant() > 0.0 && moved.trace() > 0.0 {
            shape = LocalShape::of_mobility(&moved)?;
            for (start, roll) in starts.iter_mut().zip(&fit.rolls) {
                *start += roll.start_response() * mean;
            }
        }
        mobility_range = half_widths.amax();
    }
    None
}

/// A roll near a shape and a start.
struct Linearised<'r> {
    bounded: &'r BoundedRoll<'r>,
    is_start_known: bool,
    start: Vector2<f64>,
    /// Change of the start with the mobility.
    response: Matrix2x3<f64>,
    pitch: f64,
    cell: &'r PadCell,
    shape: &'r LocalShape,
    /// Largest change of the mobility in the set.
    mobility_range: f64,
}

impl Linearised<'_> {
    /// The rows of the roll.
    fn rows(&self, mobility: &Matrix2<f64>) -> Option<RollRows> {
        let samples = &self.bounded.series.samples;
        let edges = edge_samples(samples, &self.bounded.runs, self.pitch, self.cell, mobility);
        let rotations = edges.iter().map(|edge| samples[edge.2].rotation);
        let rotations = RollRotations::new(rotations.collect(), true);
        let mut path = Vec::new();
        rotations.path(self.shape, &Default::default(), &mut path)?;
        let normals: Vec<_> = self.cell.normals().collect();
        let relative = self.shape.relative();
        let frame = StartFrame::new(&self.start);
        let response = self.response;
        let is_start_known = self.is_start_known;
        let mut rows = Vec::with_capacity(edges.len() + normals.len());
        let mut couplings = Vec::with_capacity(edges.len());
        for ((edge, offset, _), at) in edges.iter().zip(&path) {
            let normal = normals[*edge];
            let place = frame.place(at);
            let drive = relative * at.x;
            let by_path = place.by_path.tr_mul(&normal);
            let mut form = Vector3::new(
                by_path.x * drive.x,
                by_path.x * drive.y + by_path.y * drive.x,
                by_path.y * drive.y,
            );
            let coupling = place.by_start.tr_mul(&normal) - normal;
            if !is_start_known {
                form += response.tr_mul(&coupling);
            }
            rows.push(EdgeRow {
                edge: *edge,
                form,
                slack: offset - normal.dot(&place.place),
                omitted: 0.0,
            });
            couplings.push(coupling);
        }
        let range = match is_start_known {
            true => [0.0; 2],
            false => self.start_range(&rows),
        };
        // Each row is linear in the start and in the mobility, so the products and squares of their changes are
        // missing. Widen the row by an upper bound of the missing terms. At other mobilities of the set, the range of
        // the start is wider.
        let drives = path.iter().map(|at| (relative * at.x).norm());
        let longest = match is_start_known {
            true => 0.0,
            false => self.mobility_range * drives.fold(0.0, f64::max),
        };
        let start_range = range[0].max(range[1]) + longest;
        let offset = self.start.norm();
        for ((row, coupling), at) in rows.iter_mut().zip(&couplings).zip(&path) {
            let path_range = self.mobility_range * (relative * at.x).norm();
            let length = at.x.norm();
            row.omitted = 0.5 * length * start_range * start_range
                + 0.5 * (length + offset) * start_range * path_range
                + 0.5 * (length + offset) * path_range * path_range
                // The mobility also turns the contact frame, which bends the path.
                + length * length * path_range / 12.0;
            if !is_start_known {
                let [along_u, along_v] = [coupling.x.abs(), coupling.y.abs()];
                row.omitted += (along_u + along_v) * longest;
                row.slack += along_u * range[0] + along_v * range[1];
            }
            row.slack += row.omitted;
        }
        rows.sort_by_key(|row| row.edge);
        Some(RollRows {
            rows,
            is_start_known,
            edges: normals.len(),
        })
    }
}

impl Linearised<'_> {
    /// Largest distances of the start from its estimate along u and v.
    fn start_range(&self, rows: &[EdgeRow]) -> [f64; 2] {
        let least = |edge: usize| {
            let of_edge = rows.iter().filter(|row| row.edge == edge);
            of_edge.map(|row| row.slack).fold(OPEN, f64::min).abs()
        };
        let edges = self.cell.edges();
        match edges {
            4 => [least(0).max(least(2)), least(1).max(least(3))],
            _ => [1.2 * (0..edges).map(least).fold(0.0, f64::max); 2],
        }
    }
}

impl FeasibleSet {
    /// The mean of the points of the set that are furthest along the axes, and the half-widths along the axes. `None` if
    /// the set is empty.
    fn middle(&self) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let (mut sum, mut half_widths) = (Vector3::zeros(), Vector3::zeros());
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let mut direction = Vector3::zeros();
                direction[axis] = sign;
                let point = self.furthest(&direction)?;
                sum += point;
                half_widths[axis] += 0.5 * sign * point[axis];
            }
        }
        Some((sum / 6.0, half_widths.map(|width: f64| width.max(1e-12))))
    }
}
