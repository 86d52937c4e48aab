//! The fitted surface along a line: its jets and their covariance at many places.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::curvature::JetCovariance;
use crate::knots::{Basis, MAX_DEGREE};
use crate::spline::{Lanes, Local};
use crate::{Fit, Jet, TensorSpline};

/// The surface along a line of constant v: what is the same for all its places.
pub(crate) struct Line {
    /// The first B-spline in u that the line knows.
    first: usize,
    /// Per B-spline in u, the sums over those in v of coefficient times value, first and second
    /// derivative.
    heights: Vec<[f64; 3]>,
    /// Per interval in u, from that of `first`, the covariances of these sums.
    covariances: Vec<SumCovariances>,
}

/// Covariances between the sums over B-splines in v (see [`Line`]), for any two B-splines in u
/// that do not vanish on an interval. The names give the derivatives along v: `value_slope[i][j]`
/// is the covariance of the i-th sum of values with the j-th sum of slopes.
#[derive(Clone, Default)]
struct SumCovariances {
    value_value: Square,
    value_slope: Square,
    value_bend: Square,
    slope_slope: Square,
    slope_bend: Square,
    bend_bend: Square,
}

type Square = [Basis; MAX_DEGREE + 1];

impl Line {
    /// The surface along the line of constant `v`, for some of the B-splines in u.
    pub(crate) fn of(fit: &Fit, v: f64, functions: Range<usize>) -> Self {
        let spline = &fit.spline;
        let local = Local::of(&spline.v, v);
        let width = spline.v.functions();
        let support = spline.v.degree() + 1;
        let heights = functions
            .clone()
            .map(|function| {
                let start = function * width + local.first;
                let row = &spline.coefficients[start..start + support];
                local.jets.map(|basis| dot(row, &basis))
            })
            .collect();
        let covariances = match &fit.covariance {
            Some(covariance) => (functions.start..functions.end - spline.u.degree())
                .map(|first| match (spline.u.degree(), spline.v.degree()) {
                    // The usual ones, with loops of known lengths.
                    (2, 2) => SumCovariances::of::<3>(covariance, first, width, &local),
                    (3, 3) => SumCovariances::of::<4>(covariance, first, width, &local),
                    _ => SumCovariances::of_any(covariance, first, spline, &local),
                })
                .collect(),
            None => Vec::new(),
        };
        Self {
            first: functions.start,
            heights,
            covariances,
        }
    }

    /// Height and derivatives at places on the line.
    #[inline(always)]
    pub(crate) fn jet(&self, u: &Local<Lanes>, fit: &Fit) -> Jet<Lanes> {
        let start = u.first - self.first;
        Jet::of_sums(u, &self.heights[start..=start + fit.spline.u.degree()])
    }

    /// Covariance of slopes and second derivatives.
    #[inline(always)]
    pub(crate) fn covariance(&self, u: &Local<Lanes>, fit: &Fit) -> Option<JetCovariance> {
        let sums = self.covariances.get(u.first - self.first)?;
        Some(match fit.spline.u.degree() {
            2 => sums.along::<3>(&u.jets),
            3 => sums.along::<4>(&u.jets),
            _ => sums.along::<{ MAX_DEGREE + 1 }>(&u.jets),
        })
    }
}

impl SumCovariances {
    /// The sums for splines with `SUPPORT` B-splines along both sides.
    #[inline]
    fn of<const SUPPORT: usize>(
        covariance: &DMatrix<f64>,
        first: usize,
        width: usize,
        v: &Local,
    ) -> Self {
        Self::gathered(covariance, first, width, v, SUPPORT, SUPPORT)
    }

    #[inline(never)]
    fn of_any(covariance: &DMatrix<f64>, first: usize, spline: &TensorSpline, v: &Local) -> Self {
        let [support_u, support_v] = [&spline.u, &spline.v].map(|knots| knots.degree() + 1);
        Self::gathered(
            covariance,
            first,
            spline.v.functions(),
            v,
            support_u,
            support_v,
        )
    }

    #[inline(always)]
    fn gathered(
        covariance: &DMatrix<f64>,
        first: usize,
        width: usize,
        v: &Local,
        support_u: usize,
        support_v: usize,
    ) -> Self {
        let start = |place: usize| (first + place) * width + v.first;
        let rows = covariance.nrows();
        let mut sums = Self::default();
        for one in 0..support_u {
            for other in one..support_u {
                // [m][n]: covariance of the m-th derivative's sum for `one` with the n-th for `other`.
                let mut both = [[0.0; 3]; 3];
                for place in 0..support_v {
                    // Columns are contiguous, and the covariance is symmetric.
                    let column = (start(one) + place) * rows + start(other);
                    let entries = &covariance.as_slice()[column..column + support_v];
                    let inner = v.jets.map(|basis| dot(entries, &basis));
                    for (both, basis) in both.iter_mut().zip(&v.jets) {
                        for (sum, inner) in both.iter_mut().zip(inner) {
                            *sum += basis[place] * inner;
                        }
                    }
                }
                for (matrix, m, n) in [
                    (&mut sums.value_value, 0, 0),
                    (&mut sums.value_slope, 0, 1),
                    (&mut sums.value_bend, 0, 2),
                    (&mut sums.slope_slope, 1, 1),
                    (&mut sums.slope_bend, 1, 2),
                    (&mut sums.bend_bend, 2, 2),
                ] {
                    matrix[one][other] = both[m][n];
                    matrix[other][one] = both[n][m];
                }
            }
        }
        sums
    }

    /// Covariance of (p, q, r, s, t) = (∂u, ∂v, ∂u², ∂u∂v, ∂v²) where the B-splines in u have these
    /// values, first and second derivatives, `SUPPORT` of each.
    #[inline(always)] // else its inlining, 4 % of a map, changes with code elsewhere
    fn along<const SUPPORT: usize>(
        &self,
        [value, slope, bend]: &[[Lanes; MAX_DEGREE + 1]; 3],
    ) -> JetCovariance {
        let times = |matrix: &Square, right: &[Lanes; MAX_DEGREE + 1]| -> [Lanes; SUPPORT] {
            std::array::from_fn(|row| {
                (0..SUPPORT).fold(Lanes::ZERO, |sum, column| {
                    sum + right[column] * matrix[row][column]
                })
            })
        };
        let between = |left: &[Lanes; MAX_DEGREE + 1], right: &[Lanes; SUPPORT]| {
            (0..SUPPORT).fold(Lanes::ZERO, |sum, place| sum + left[place] * right[place])
        };
        let along_slope = times(&self.value_value, slope);
        let along_bend = times(&self.value_value, bend);
        let (pp, pr) = (between(slope, &along_slope), between(slope, &along_bend));
        let rr = between(bend, &along_bend);
        let along_value = times(&self.value_slope, value);
        let along_slope = times(&self.value_slope, slope);
        let (pq, ps) = (between(slope, &along_value), between(slope, &along_slope));
        let (qr, rs) = (between(bend, &along_value), between(bend, &along_slope));
        let along_value = times(&self.value_bend, value);
        let (pt, rt) = (between(slope, &along_value), between(bend, &along_value));
        let along_value = times(&self.slope_slope, value);
        let along_slope = times(&self.slope_slope, slope);
        let (qq, qs) = (between(value, &along_value), between(value, &along_slope));
        let ss = between(slope, &along_slope);
        let along_value = times(&self.slope_bend, value);
        let (qt, st) = (between(value, &along_value), between(slope, &along_value));
        let tt = between(value, &times(&self.bend_bend, value));
        [
            [pp, pq, pr, ps, pt],
            [pq, qq, qr, qs, qt],
            [pr, qr, rr, rs, rt],
            [ps, qs, rs, ss, st],
            [pt, qt, rt, st, tt],
        ]
    }
}

#[inline(always)]
fn dot(row: &[f64], basis: &[f64]) -> f64 {
    row.iter().zip(basis).map(|(one, other)| one * other).sum()
}
