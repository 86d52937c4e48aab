//! The set of curvatures that agree with exact rotations and pads.

use nalgebra::{Matrix2, Matrix3, Vector3};

use crate::crossings::{Run, edge_samples};
use crate::feasible_set::{EdgeRow, FeasibleSet, OPEN, RollRows, distribution};
use crate::roll_fit::{RollData, RollFit, SeriesFit};
use crate::rolled_path::{LocalShape, RollRotations, StartFrame};
use crate::{PadCell, RollSeries};

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
    let mobility = fit.shape.relative().try_inverse()?;
    let mut rows = Vec::with_capacity(bounded.len());
    for ((bounded, data), roll) in bounded.iter().zip(data).zip(&fit.rolls) {
        let linearised = Linearised {
            bounded,
            is_start_known: data.is_start_known,
            roll,
            pitch,
            cell,
            shape: &fit.shape,
        };
        rows.push(linearised.rows(&mobility)?);
    }
    let set = FeasibleSet::of_rolls(rows.iter());
    let (middle, half_widths) = set.middle()?;
    // The distribution is narrower than the set, and its correlations are those of the fit.
    let scale = half_widths.zip_map(&fit.covariance.diagonal(), |half_width, variance| {
        STD_OF_HALF_WIDTH * half_width / variance.sqrt()
    });
    let scale = Matrix3::from_diagonal(&scale);
    let guess = scale * fit.covariance * scale;
    let (mean, covariance) = distribution(&rows, middle, guess).unwrap_or((middle, guess));
    Some(PadEdgeSet {
        centre: Vector3::new(mobility[(0, 0)], mobility[(0, 1)], mobility[(1, 1)]),
        set,
        mean,
        covariance,
    })
}

/// A roll near a shape and a start.
struct Linearised<'r> {
    bounded: &'r BoundedRoll<'r>,
    is_start_known: bool,
    roll: &'r RollFit<3>,
    pitch: f64,
    cell: &'r PadCell,
    shape: &'r LocalShape,
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
        let frame = StartFrame::new(&self.roll.start);
        let response = self.roll.start_response();
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
            });
            couplings.push(coupling);
        }
        if !is_start_known {
            // The start is not quite determined by the mobility. Its coupling to the rows widens them by the remaining
            // range.
            let least = |edge: usize| {
                let of_edge = rows.iter().filter(|row| row.edge == edge);
                of_edge.map(|row| row.slack).fold(OPEN, f64::min)
            };
            let slacks: Vec<_> = (0..normals.len()).map(least).collect();
            let range = match normals.len() {
                4 => [0, 1].map(|edge| slacks[edge].abs().max(slacks[edge + 2].abs())),
                _ => {
                    [slacks
                        .iter()
                        .fold(0.0, |most: f64, slack| most.max(slack.abs()))
                        * 1.2; 2]
                }
            };
            for (row, coupling) in rows.iter_mut().zip(&couplings) {
                row.slack += coupling.x.abs() * range[0] + coupling.y.abs() * range[1];
            }
        }
        rows.sort_by_key(|row| row.edge);
        Some(RollRows {
            rows,
            is_start_known,
            edges: normals.len(),
        })
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
