//! The knots of both variables, and the order of the coefficients while a problem is solved.

use super::jumps::{self, Jumps};
use super::triangle::{Block, Triangle};
use crate::{Knots, TensorSpline};

/// Knots along u and along v.
///
/// Coefficients are ordered by the B-spline of the slow variable first, which is the one that
/// makes the band of the equations narrower.
pub(super) struct Mesh {
    pub(super) knots: [Knots; 2],
    /// 0 where u is the slow variable, 1 where v is.
    slow: usize,
}

impl Mesh {
    /// No interior knots.
    pub(super) fn new(degrees: [usize; 2], domain: [[f64; 2]; 2]) -> Self {
        let knots = [0, 1].map(|axis| {
            let [start, end] = domain[axis];
            Knots::new(degrees[axis], start, end, &[])
        });
        let mut mesh = Self { knots, slow: 0 };
        mesh.narrow();
        mesh
    }

    /// The slow variable.
    pub(super) const fn slow(&self) -> usize {
        self.slow
    }

    /// The fast variable.
    pub(super) const fn fast(&self) -> usize {
        1 - self.slow
    }

    /// Number of coefficients.
    pub(super) fn coefficients(&self) -> usize {
        self.knots[0].functions() * self.knots[1].functions()
    }

    /// Number of coefficients from the first to the last that a place depends on.
    pub(super) fn band(&self) -> usize {
        self.knots[self.slow].degree() * self.fast_functions() + self.fast_degree() + 1
    }

    /// Index of the coefficient of two B-splines.
    #[inline]
    pub(super) fn index(&self, slow: usize, fast: usize) -> usize {
        slow * self.fast_functions() + fast
    }

    /// Adds an interior knot and chooses the slow variable anew.
    pub(super) fn insert(&mut self, axis: usize, knot: f64) {
        let old = &self.knots[axis];
        let mut interior = old.interior().to_vec();
        interior.insert(interior.partition_point(|&other| other < knot), knot);
        let (start, end) = old.domain();
        self.knots[axis] = Knots::new(old.degree(), start, end, &interior);
        self.narrow();
    }

    /// Exchanges the variables where that makes the band narrower.
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

    /// The spline of coefficients in this order.
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

/// Equations that say that the highest derivatives, in either direction, do not jump.
pub(super) struct Roughness {
    slow: Vec<Jumps>,
    fast: Vec<Jumps>,
    /// B-splines of the slow and the fast variable that a knot cuts.
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
            slow: jumps::of(slow),
            fast: jumps::of(fast),
            cut: [slow.degree() + 2, fast.degree() + 2],
            fast_functions: fast.functions(),
            band,
        }
    }

    /// The triangle of the given equations together with these ones, divided by `parameter`.
    pub(super) fn join(&self, equations: &Triangle, parameter: f64) -> Triangle {
        let order = equations.order();
        let mut joined = Triangle::new(order, self.band);
        let mut block = Block::new(self.band, 3);
        for start in 0..order {
            let (slow, fast) = (start / self.fast_functions, start % self.fast_functions);
            block.push_row(equations.row(start), equations.right(start));
            let (of_fast, of_slow) = (self.fast.get(fast), self.slow.get(slow));
            push(&mut block, of_fast, self.cut[1], 1, parameter);
            push(
                &mut block,
                of_slow,
                self.cut[0],
                self.fast_functions,
                parameter,
            );
            joined.absorb(start, &mut block);
        }
        joined
    }
}

/// One equation: jumps of `cut` B-splines whose coefficients stand `stride` apart.
fn push(block: &mut Block, jumps: Option<&Jumps>, cut: usize, stride: usize, parameter: f64) {
    if let Some(jumps) = jumps {
        let row = block.push(0.0);
        for (place, jump) in jumps[..cut].iter().enumerate() {
            block.set(row, place * stride, jump / parameter);
        }
    }
}
