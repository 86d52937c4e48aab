//! The fitted surface: its curvature anywhere, with its uncertainty.

use std::ops::Range;

use nalgebra::{DMatrix, Point3, Vector3};

use crate::curvature::{JetCovariance, form_and_basis};
use crate::knots::{Basis, MAX_DEGREE};
use crate::spline::Local;
use crate::{Curvature, Ep2Error, Fit, Jet, TensorSpline};

/// A map may have at most this many places along each side.
pub const MOST_PLACES: usize = 2048;

/// A place on the fitted surface, in the frame of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPoint {
    /// The place.
    pub position: Point3<f64>,
    /// The unit normal, out of the object.
    pub normal: Vector3<f64>,
    /// Gaussian and mean curvature.
    pub curvature: Curvature,
    /// Smallest normal curvature, 1/length, convex positive.
    pub k_min: f64,
    /// Largest normal curvature, 1/length.
    pub k_max: f64,
    /// Unit tangent along `k_min`, of either sign; any at an umbilic.
    pub direction_of_min: Vector3<f64>,
    /// Unit tangent along `k_max`, of either sign; any at an umbilic.
    pub direction_of_max: Vector3<f64>,
    /// In [−1, 1]: +1 for a convex cap, −1 for a cup; `None` where the surface is flat.
    pub shape_index: Option<f64>,
}

impl MapPoint {
    /// Whether all of its numbers are.
    pub(crate) fn is_finite(&self) -> bool {
        let directions = [self.normal, self.direction_of_min, self.direction_of_max];
        let mut numbers = directions.iter().flatten().chain(self.position.iter());
        numbers.all(|number| number.is_finite())
            && self.curvature.is_finite()
            && self.k_min.is_finite()
            && self.k_max.is_finite()
    }
}

/// The surface along a line of constant v: what is the same for all its places.
struct Line {
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

fn few_enough(side: usize) -> Result<(), Ep2Error> {
    let is_good = side <= MOST_PLACES;
    Ep2Error::unless_good("grid", side as f64, is_good, "at most 2048")
}

impl Fit {
    /// Gaussian and mean curvature where the line through `world` along the patch's normal meets
    /// the surface. Of contacts without error on a paraboloid, whose apex it is, a quadric and a penalised spline err by at
    /// most 1e-11 of the sharper curvature.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] where the curvature leaves the range of doubles.
    pub fn curvature_at(&self, world: &Point3<f64>) -> Result<Curvature, Ep2Error> {
        let place = self.frame.point(world);
        let u = Local::of(&self.spline.u, place.x);
        let line = self.line(place.y, u.first..u.first + self.spline.u.degree() + 1);
        self.curvature(&line.jet(&u, self), line.covariance(&u, self).as_ref())
    }

    /// The surface at a place of the patch, in the patch's coordinates.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] where the surface leaves the range of doubles.
    pub fn point_at(&self, u: f64, v: f64) -> Result<MapPoint, Ep2Error> {
        let local = Local::of(&self.spline.u, u);
        let line = self.line(v, local.first..local.first + self.spline.u.degree() + 1);
        self.map_point([u, v], &local, &line)
    }

    /// The surface where lines through points along the patch's normal meet it.
    ///
    /// # Errors
    /// As [`Fit::point_at`].
    pub fn points_at(&self, world: &[Point3<f64>]) -> Result<Vec<MapPoint>, Ep2Error> {
        world
            .iter()
            .map(|point| {
                let place = self.frame.point(point);
                self.point_at(place.x, place.y)
            })
            .collect()
    }

    /// The middle of the patch.
    ///
    /// # Errors
    /// As [`Fit::point_at`].
    pub fn centre(&self) -> Result<MapPoint, Ep2Error> {
        let [u, v] = self.domain.map(|[low, high]| 0.5 * low + 0.5 * high);
        self.point_at(u, v)
    }

    /// Gaussian and mean curvature on a grid of `side` × `side` places that spans the contacts, u
    /// slowest.
    ///
    /// # Errors
    /// As [`Fit::curvature_at`]; [`Ep2Error::BadSetting`] for more than [`MOST_PLACES`] along a side.
    pub fn curvatures(&self, side: usize) -> Result<Vec<Curvature>, Ep2Error> {
        few_enough(side)?;
        let mut result = Vec::with_capacity(side * side);
        self.for_each_on_grid(side, |_, local, line| {
            let covariance = line.covariance(local, self);
            result.push(self.curvature(&line.jet(local, self), covariance.as_ref())?);
            Ok(())
        })?;
        Ok(transposed(&result, side))
    }

    /// The surface on a grid of `side` × `side` places that spans the contacts, u slowest.
    ///
    /// # Errors
    /// As [`Fit::point_at`]; [`Ep2Error::BadSetting`] for more than [`MOST_PLACES`] along a side.
    pub fn map(&self, side: usize) -> Result<Vec<MapPoint>, Ep2Error> {
        few_enough(side)?;
        let mut result = Vec::with_capacity(side * side);
        self.for_each_on_grid(side, |place, local, line| {
            result.push(self.map_point(place, local, line)?);
            Ok(())
        })?;
        Ok(transposed(&result, side))
    }

    fn for_each_on_grid(
        &self,
        side: usize,
        mut visit: impl FnMut([f64; 2], &Local, &Line) -> Result<(), Ep2Error>,
    ) -> Result<(), Ep2Error> {
        let place = |[low, high]: [f64; 2], index: usize| {
            let share = if side == 1 {
                0.5
            } else {
                index as f64 / (side - 1) as f64
            };
            low + (high - low) * share
        };
        let [range_u, range_v] = self.domain;
        let columns: Vec<(f64, Local)> = (0..side)
            .map(|index| place(range_u, index))
            .map(|u| (u, Local::of(&self.spline.u, u)))
            .collect();
        for row in 0..side {
            let v = place(range_v, row);
            let line = self.line(v, 0..self.spline.u.functions());
            for (u, local) in &columns {
                visit([*u, v], local, &line)?;
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn curvature(
        &self,
        jet: &Jet,
        covariance: Option<&JetCovariance>,
    ) -> Result<Curvature, Ep2Error> {
        let curvature = Curvature::of_graph(jet, covariance, self.frame.scale());
        if curvature.is_finite() {
            Ok(curvature)
        } else {
            Err(Ep2Error::OutOfRange)
        }
    }

    fn map_point(
        &self,
        [u, v]: [f64; 2],
        local: &Local,
        line: &Line,
    ) -> Result<MapPoint, Ep2Error> {
        let jet = line.jet(local, self);
        let curvature = self.curvature(&jet, line.covariance(local, self).as_ref())?;
        let (form, [along, across]) = form_and_basis(&jet);
        let principal = form.principal();
        let (sin, cos) = principal.angle_of_max_rad.sin_cos();
        let in_world = |direction: Vector3<f64>| self.frame.direction_in_world(&direction);
        let point = MapPoint {
            position: self.frame.point_in_world(&Vector3::new(u, v, jet.w)),
            normal: in_world(along.cross(&across)),
            curvature,
            k_min: principal.k_min / self.frame.scale(),
            k_max: principal.k_max / self.frame.scale(),
            direction_of_min: in_world(across * cos - along * sin),
            direction_of_max: in_world(along * cos + across * sin),
            shape_index: form.shape_index(),
        };
        if point.is_finite() {
            Ok(point)
        } else {
            Err(Ep2Error::OutOfRange)
        }
    }

    /// The surface along the line of constant `v`, for some of the B-splines in u.
    fn line(&self, v: f64, functions: Range<usize>) -> Line {
        let spline = &self.spline;
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
        let covariances = match &self.covariance {
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
        Line {
            first: functions.start,
            heights,
            covariances,
        }
    }
}

impl Line {
    #[inline]
    fn jet(&self, u: &Local, fit: &Fit) -> Jet {
        let start = u.first - self.first;
        Jet::of_sums(u, &self.heights[start..=start + fit.spline.u.degree()])
    }

    /// Covariance of slopes and second derivatives.
    #[inline]
    fn covariance(&self, u: &Local, fit: &Fit) -> Option<JetCovariance> {
        let sums = self.covariances.get(u.first - self.first)?;
        Some(match fit.spline.u.degree() {
            2 => sums.along::<3>(&u.jets),
            3 => sums.along::<4>(&u.jets),
            _ => sums.along::<{ MAX_DEGREE + 1 }>(&u.jets),
        })
    }
}

impl SumCovariances {
    /// For splines with `SUPPORT` B-splines along both sides.
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
    #[inline]
    fn along<const SUPPORT: usize>(&self, [value, slope, bend]: &[Basis; 3]) -> JetCovariance {
        let times = |matrix: &Square, right: &Basis| {
            let mut result = [0.0; SUPPORT];
            for (sum, row) in result.iter_mut().zip(matrix) {
                *sum = dot(&row[..SUPPORT], &right[..SUPPORT]);
            }
            result
        };
        let between = |left: &Basis, right: &[f64; SUPPORT]| dot(&left[..SUPPORT], right);
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
        JetCovariance::new(
            pp, pq, pr, ps, pt, //
            pq, qq, qr, qs, qt, //
            pr, qr, rr, rs, rt, //
            ps, qs, rs, ss, st, //
            pt, qt, rt, st, tt,
        )
    }
}

#[inline(always)]
fn dot(row: &[f64], basis: &[f64]) -> f64 {
    row.iter().zip(basis).map(|(one, other)| one * other).sum()
}

/// From rows of constant v to rows of constant u.
fn transposed<T: Copy>(by_v: &[T], side: usize) -> Vec<T> {
    (0..side * side)
        .map(|index| by_v[index % side * side + index / side])
        .collect()
}
