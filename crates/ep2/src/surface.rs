//! The fitted surface: its curvature anywhere, with its uncertainty.

use nalgebra::{DMatrix, Point3, Vector3};

use crate::curvature::{JetCovariance, form_and_basis};
use crate::knots::MAX_DEGREE;
use crate::spline::Local;
use crate::{Curvature, Ep2Error, Fit, Jet};

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

/// The surface along a line of constant v: what is the same for all its places.
struct Line {
    /// Per B-spline in u, the sums over those in v of coefficient times value, first and second
    /// derivative. `first` is the first B-spline that they are kept of.
    first: usize,
    heights: Vec<[f64; 3]>,
    /// Per B-spline in u and so many after it (`0..=degree`), the covariances of these sums.
    covariances: Vec<[[[f64; 3]; 3]; MAX_DEGREE + 1]>,
}

impl Fit {
    /// Gaussian and mean curvature where the line through `world` along the patch's normal meets
    /// the surface.
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
    /// As [`Fit::curvature_at`].
    pub fn curvatures(&self, side: usize) -> Result<Vec<Curvature>, Ep2Error> {
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
    /// As [`Fit::point_at`].
    pub fn map(&self, side: usize) -> Result<Vec<MapPoint>, Ep2Error> {
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
        Ok(MapPoint {
            position: self.frame.point_in_world(&Vector3::new(u, v, jet.w)),
            normal: in_world(along.cross(&across)),
            curvature,
            k_min: principal.k_min / self.frame.scale(),
            k_max: principal.k_max / self.frame.scale(),
            direction_of_min: in_world(across * cos - along * sin),
            direction_of_max: in_world(along * cos + across * sin),
            shape_index: form.shape_index(),
        })
    }

    /// The surface along the line of constant `v`, for some of the B-splines in u.
    fn line(&self, v: f64, functions: std::ops::Range<usize>) -> Line {
        let spline = &self.spline;
        let local = Local::of(&spline.v, v);
        let width = spline.v.functions();
        let support = spline.v.degree() + 1;
        let start = |function: usize| function * width + local.first;
        let heights = functions
            .clone()
            .map(|function| {
                let row = &spline.coefficients[start(function)..start(function) + support];
                local.jets.map(|basis| dot(row, &basis))
            })
            .collect();
        let covariances = self
            .covariance
            .as_ref()
            .map_or_else(Vec::new, |covariance| {
                functions
                    .clone()
                    .map(|function| {
                        let mut band = [[[0.0; 3]; 3]; MAX_DEGREE + 1];
                        let after = (functions.end - function).min(spline.u.degree() + 1);
                        for (offset, entry) in band[..after].iter_mut().enumerate() {
                            let (row, column) = (start(function), start(function + offset));
                            *entry = contracted(covariance, row, column, support, &local);
                        }
                        band
                    })
                    .collect()
            });
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
        let mut jet = Jet::default();
        let support = fit.spline.u.degree() + 1;
        let heights = &self.heights[u.first - self.first..][..support];
        for (place, [w, dv, dvv]) in heights.iter().enumerate() {
            let [value, first, second] = u.jets.map(|basis| basis[place]);
            jet.w += value * w;
            jet.u += first * w;
            jet.v += value * dv;
            jet.uu += second * w;
            jet.uv += first * dv;
            jet.vv += value * dvv;
        }
        jet
    }

    /// Covariance of slopes and second derivatives.
    #[inline]
    fn covariance(&self, u: &Local, fit: &Fit) -> Option<JetCovariance> {
        if self.covariances.is_empty() {
            return None;
        }
        // Orders in u and in v of the derivatives p, q, r, s, t.
        const ORDERS: [(usize, usize); 5] = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
        let support = fit.spline.u.degree() + 1;
        let bands = &self.covariances[u.first - self.first..][..support];
        let mut result = JetCovariance::zeros();
        for (row, band) in bands.iter().enumerate() {
            for (offset, entry) in band[..support - row].iter().enumerate() {
                let column = row + offset;
                for (one, &(order_u, order_v)) in ORDERS.iter().enumerate() {
                    for (other, &(other_u, other_v)) in ORDERS.iter().enumerate().skip(one) {
                        let here = u.jets[order_u][row] * u.jets[other_u][column];
                        let mut sum = here * entry[order_v][other_v];
                        if offset > 0 {
                            let there = u.jets[order_u][column] * u.jets[other_u][row];
                            sum += there * entry[other_v][order_v];
                        }
                        result[(one, other)] += sum;
                    }
                }
            }
        }
        result.fill_lower_triangle_with_upper_triangle();
        Some(result)
    }
}

/// Σ_jj' b⁽ᵐ⁾_j C[row + j, column + j'] b⁽ⁿ⁾_j' for derivatives of the orders m and n.
#[inline]
fn contracted(
    covariance: &DMatrix<f64>,
    row: usize,
    column: usize,
    support: usize,
    local: &Local,
) -> [[f64; 3]; 3] {
    let mut result = [[0.0; 3]; 3];
    for place in 0..support {
        // Columns are contiguous, and the covariance is symmetric.
        let entries = &covariance.column(row + place).data.into_slice()[column..column + support];
        let sums = local.jets.map(|basis| dot(entries, &basis));
        for (result, basis) in result.iter_mut().zip(&local.jets) {
            for (result, sum) in result.iter_mut().zip(sums) {
                *result += basis[place] * sum;
            }
        }
    }
    result
}

#[inline]
fn dot(row: &[f64], basis: &[f64]) -> f64 {
    row.iter().zip(basis).map(|(one, other)| one * other).sum()
}

/// From rows of constant v to rows of constant u.
fn transposed<T: Copy>(by_v: &[T], side: usize) -> Vec<T> {
    (0..side * side)
        .map(|index| by_v[index % side * side + index / side])
        .collect()
}
