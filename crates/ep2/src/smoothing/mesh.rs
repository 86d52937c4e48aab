//! The knots of a tensor-product spline along both axes. The module also computes the order of the coefficients, the
//! jumps of derivatives at the knots, and the next knot to add.

use super::observations::IntervalSums;
use super::triangle::{Block, Triangle};
use crate::knots::{Knots, MAX_DEGREE};
use crate::spline::TensorSpline;

/// Largest allowed ratio of the lengths of the two parts into which a new knot divides an interval.
const MAX_PART_RATIO: f64 = 10.0;

/// The jumps of a derivative at a knot, for the `degree + 2` B-splines whose support contains the knot. The remaining
/// entries of the array are 0.
type Jumps = [f64; MAX_DEGREE + 2];

/// Knots along u and along v.
///
/// A coefficient belongs to a B-spline along u and a B-spline along v. The coefficients are sorted by the B-spline
/// along one axis, the slow axis, and then by the B-spline along the other axis. The slow axis is chosen such that the
/// band of the equations is narrow.
pub(super) struct Mesh {
    pub(super) knots: [Knots; 2],
    /// The slow axis: 0 for u, 1 for v.
    slow: usize,
}

impl Mesh {
    pub(super) fn new(degrees: [usize; 2], domain: [[f64; 2]; 2]) -> Self {
        let knots = [0, 1].map(|axis| {
            let [start, end] = domain[axis];
            Knots::new(degrees[axis], start, end, &[])
        });
        let mut mesh = Self { knots, slow: 0 };
        mesh.narrow();
        mesh
    }

    pub(super) const fn slow(&self) -> usize {
        self.slow
    }

    pub(super) const fn fast(&self) -> usize {
        1 - self.slow
    }

    pub(super) fn coefficients(&self) -> usize {
        self.knots[0].functions() * self.knots[1].functions()
    }

    /// Width of the band of the equations: the height at a place depends only on coefficients whose indices are within
    /// a range of this width.
    pub(super) fn band(&self) -> usize {
        self.knots[self.slow].degree() * self.fast_functions() + self.fast_degree() + 1
    }

    /// Index of a coefficient. `slow` and `fast` are the indices of its B-splines along the slow and the fast axis.
    #[inline]
    pub(super) fn index(&self, slow: usize, fast: usize) -> usize {
        slow * self.fast_functions() + fast
    }

    pub(super) fn insert(&mut self, axis: usize, knot: f64) {
        let old = &self.knots[axis];
        let mut interior = old.interior().to_vec();
        interior.insert(interior.partition_point(|&other| other < knot), knot);
        let (start, end) = old.domain();
        self.knots[axis] = Knots::new(old.degree(), start, end, &interior);
        self.narrow();
    }

    /// Exchanges the slow and the fast axis if this makes the band of the equations narrower.
    fn narrow(&mut self) {
        let band = self.band();
        self.slow = self.fast();
        if self.band() >= band {
            self.slow = self.fast();
        }
    }

    fn fast_functions(&self) -> usize {
        self.knots[self.fast()].functions()
    }

    fn fast_degree(&self) -> usize {
        self.knots[self.fast()].degree()
    }

    pub(super) fn spline(self, coefficients: Vec<f64>) -> TensorSpline {
        let [u_functions, v_functions] = [0, 1].map(|axis| self.knots[axis].functions());
        let coefficients = if self.slow == 0 {
            coefficients
        } else {
            let pairs = (0..u_functions).flat_map(|u| (0..v_functions).map(move |v| (u, v)));
            pairs
                .map(|(u, v)| coefficients[v * u_functions + u])
                .collect()
        };
        let [u, v] = self.knots;
        TensorSpline { u, v, coefficients }
    }
}

/// The equations that require a spline to be smooth: along both axes, the jumps of the highest derivative at the knots
/// are 0.
pub(super) struct Roughness {
    slow: Vec<Jumps>,
    fast: Vec<Jumps>,
    /// Number of B-splines whose support contains the same knot: first along the slow axis of the mesh, then along the
    /// fast axis.
    cut: [usize; 2],
    fast_functions: usize,
    band: usize,
}

impl Roughness {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let (slow, fast) = (&mesh.knots[mesh.slow()], &mesh.knots[mesh.fast()]);
        let band = if slow.interior().is_empty() {
            mesh.band()
        } else {
            (slow.degree() + 1) * fast.functions() + 1
        };
        Self {
            slow: derivative_jumps(slow),
            fast: derivative_jumps(fast),
            cut: [slow.degree() + 2, fast.degree() + 2],
            fast_functions: fast.functions(),
            band,
        }
    }

    /// Adds the smoothness equations, each divided by `parameter`, to `equations`. Returns the triangular form of all
    /// equations.
    pub(super) fn join(&self, equations: &Triangle, parameter: f64) -> Triangle {
        let order = equations.order();
        let mut joined = Triangle::new(order, self.band);
        let mut block = Block::new(self.band, 3);
        for start in 0..order {
            let (slow, fast) = (start / self.fast_functions, start % self.fast_functions);
            block.push_row(equations.row(start), equations.right(start));
            let width = self.fast_functions;
            push(&mut block, self.fast.get(fast), self.cut[1], 1, parameter);
            push(
                &mut block,
                self.slow.get(slow),
                self.cut[0],
                width,
                parameter,
            );
            joined.absorb(start, &mut block);
        }
        joined
    }
}

/// Adds one equation that requires a jump of a derivative to be 0. It has `cut` coefficients. The indices of successive
/// coefficients differ by `stride`.
fn push(block: &mut Block, jumps: Option<&Jumps>, cut: usize, stride: usize, parameter: f64) {
    if let Some(jumps) = jumps {
        let row = block.push(0.0);
        for (place, jump) in jumps[..cut].iter().enumerate() {
            block.set(row, place * stride, jump / parameter);
        }
    }
}

/// For each interior knot, the jumps of the B-splines' derivatives of order `degree` at this knot. The first of these
/// B-splines has the same index as the knot.
///
/// A B-spline is a divided difference of a truncated power. Therefore the jump of the derivative at a knot `t` is a
/// fixed multiple of `(t_last − t_first) / Π (t − t_other)`. Here `t_first` and `t_last` are the ends of the B-spline's
/// support, and the product is over all knots of the B-spline except `t`. Lengths are divided by the mean interval, so
/// the jumps have no unit.
fn derivative_jumps(knots: &Knots) -> Vec<Jumps> {
    let degree = knots.degree();
    let (start, end) = knots.domain();
    let intervals = knots.interior().len() + 1;
    let mean_interval = (end - start) / intervals as f64;
    let all = knots.as_slice();
    let jumps_at = |interior: usize| {
        let place = interior + degree + 1;
        let mut jumps = [0.0; MAX_DEGREE + 2];
        for (offset, jump) in jumps[..degree + 2].iter_mut().enumerate() {
            let first = interior + offset;
            let own = &all[first..=first + degree + 1];
            let product: f64 = (first..)
                .zip(own)
                .filter(|(index, _)| *index != place)
                .map(|(_, other)| (all[place] - other) / mean_interval)
                .product();
            *jump = (own[degree + 1] - own[0]) / mean_interval / product;
        }
        jumps
    };
    (0..intervals - 1).map(jumps_at).collect()
}

/// The axis and the position of the next knot; `None` if no knot can be added.
///
/// The knot divides an interval along u or along v: the interval with the largest sum of squared residuals. The knot is
/// at the centroid of these squared residuals. Intervals that would be divided too unevenly are skipped. Axes that
/// already have `most_knots` interior knots are skipped too.
pub(super) fn next_knot(
    mesh: &Mesh,
    sums: &[Vec<IntervalSums>; 2],
    most_knots: [usize; 2],
) -> Option<(usize, f64)> {
    let mut best: Option<(f64, usize, f64)> = None;
    for axis in [mesh.slow(), mesh.fast()] {
        let knots = &mesh.knots[axis];
        let interior = knots.interior();
        if interior.len() >= most_knots[axis] {
            continue;
        }
        let (start, end) = knots.domain();
        let below = std::iter::once(start).chain(interior.iter().copied());
        let above = interior.iter().copied().chain(std::iter::once(end));
        for ((below, above), interval) in below.zip(above).zip(&sums[axis]) {
            if interval.squares <= best.map_or(0.0, |(largest, ..)| largest) {
                continue;
            }
            let centroid = interval.moments / interval.squares;
            if splits(below, centroid, above) {
                best = Some((interval.squares, axis, centroid));
            }
        }
    }
    best.map(|(_, axis, centroid)| (axis, centroid))
}

fn splits(below: f64, knot: f64, above: f64) -> bool {
    let (left, right) = (knot - below, above - knot);
    left > 0.0 && right > 0.0 && left <= MAX_PART_RATIO * right && right <= MAX_PART_RATIO * left
}
