//! Smoothing splines for the heights of scattered points, with knots where the data require them.
//!
//! The method is by Dierckx (An algorithm for surface-fitting with spline functions, IMA J. Numer. Anal. 1, 1981; Curve
//! and Surface Fitting with Splines, 1993, chapter 5) and is implemented in FITPACK. Among all splines whose sum of
//! squared weighted residuals is at most `s`, it searches a smooth one with few knots:
//!
//! 1. Compute the least-squares spline for the current knots, initially without interior knots. As long as its sum of
//!    squared residuals exceeds `s`, add a knot in the interval along u or v that contributes most to the sum. The knot
//!    is at the centroid of the squared residuals in this interval.
//! 2. Add equations that require the jumps of the highest derivative at the knots to be 0. Their weight is `1/p`.
//!    Search the parameter `p` for which the sum of squared residuals equals `s` within a relative error of 1e-3.
//!
//! If the points do not determine all coefficients, the solution with the smallest norm is used.

mod mesh;
mod minimum_norm;
mod observations;
mod parameter;
mod triangle;

pub(crate) use observations::WeightedPoint;

use strum::IntoStaticStr;

use crate::Ep2Error;
use crate::error::LARGEST;
use crate::knots::MAX_DEGREE;
use crate::spline::TensorSpline;
use mesh::{Mesh, Roughness, next_knot};
use observations::Observations;
use triangle::Triangle;

/// The least-squares equations are solved with a triangular matrix. A diagonal entry of this matrix counts as zero if
/// its square, divided by the square of the largest diagonal entry, is below this value.
const RANK_TOLERANCE: f64 = 1e-16;
/// Residuals count as rounding errors if the ratio of the residuals to the heights of the points is below this value.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SmoothingSpline {
    /// Degrees of the spline in u and in v, from 1 to [`MAX_DEGREE`].
    pub(crate) degrees: [usize; 2],
    /// Required sum of squared weighted residuals, called `s` in the description of this module; at least 0.
    pub(crate) smoothing: f64,
    /// Largest numbers of interior knots along u and along v.
    pub(crate) most_knots: [usize; 2],
    /// Largest accepted difference between the sum of squared residuals and `smoothing`, relative to `smoothing`.
    pub(crate) tolerance: f64,
}

impl SmoothingSpline {
    /// Settings with the same degree in both directions, with as many knots as the points allow, and with the tolerance
    /// of `surfit` in SciPy.
    pub(crate) const fn new(degree: usize, smoothing: f64) -> Self {
        Self {
            degrees: [degree; 2],
            smoothing,
            most_knots: [usize::MAX; 2],
            tolerance: 1e-3,
        }
    }
}

/// Result of the fit of a smoothing spline: whether the sum of squared residuals equals the required sum and, if not,
/// why.
#[derive(Clone, Copy, Debug, Eq, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum Status {
    /// The polynomial without interior knots reaches the required sum of squared residuals.
    Polynomial,
    /// The spline passes through all points: all residuals are rounding errors.
    Interpolating,
    /// The sum of squared residuals equals the required sum within the tolerance.
    Smoothing,
    /// The sum of squared residuals is larger than the required sum, but no further knot can be added. The reason is
    /// one of these: there are more coefficients than points, the largest number of knots is reached, or no interval
    /// may be split. The result is the least-squares spline for the last knots.
    KnotsExhausted,
    /// The search for the smoothing parameter `p` did not reach the required sum of squared residuals.
    Unsettled,
}

impl Status {
    pub(crate) const fn is_met(self) -> bool {
        !matches!(self, Self::KnotsExhausted | Self::Unsettled)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Smoothed {
    pub(crate) spline: TensorSpline,
    pub(crate) residual_sum: f64,
    pub(crate) status: Status,
    /// Number of independent combinations of the coefficients that the points determine. The undetermined combinations
    /// are chosen such that the norm of the coefficients is smallest.
    pub(crate) rank: usize,
    /// Effective degrees of freedom of the spline: the trace of the linear map from the heights to the fitted values.
    pub(crate) effective_unknowns: f64,
}

struct Solution {
    coefficients: Vec<f64>,
    residual_sum: f64,
    rank: usize,
    effective_unknowns: f64,
}

impl SmoothingSpline {
    /// Fits a spline to at least `(degrees[0] + 1)(degrees[1] + 1)` points.
    ///
    /// The points may not determine the polynomial, for example if they are on few lines. This is not an error; see
    /// [`Smoothed::rank`].
    ///
    /// # Errors
    /// [`Ep2Error`]: `bad-setting`, `too-few-contacts`, `not-finite`, `bad-weight`, `coincident` or `collinear` if the
    /// points do not span a rectangle, `out-of-range`.
    pub(crate) fn fit(&self, points: &[WeightedPoint]) -> Result<Smoothed, Ep2Error> {
        self.check_settings()?;
        self.check_points(points)?;
        let domain = Self::domain(points)?;
        let mut mesh = Mesh::new(self.degrees, domain);
        let mut observations = Observations::new(points, &mesh);
        let unit = observations.residual_unit();
        let smoothing = self.smoothing / unit / unit;
        let (status, solution) = self.approach(&mut mesh, &mut observations, smoothing);
        let spline = mesh.spline(observations.in_heights(solution.coefficients));
        let residual_sum = solution.residual_sum * unit * unit;
        let numbers = spline.coefficients.iter().chain([&residual_sum]);
        if numbers.copied().all(f64::is_finite) {
            Ok(Smoothed {
                spline,
                residual_sum,
                status,
                rank: solution.rank,
                effective_unknowns: solution.effective_unknowns,
            })
        } else {
            Err(Ep2Error::OutOfRange)
        }
    }

    /// Adds knots until the sum of squared residuals of the least-squares spline is at most the required sum. If the
    /// sum is then smaller than required, returns a smoother spline with the same knots, whose sum equals the required
    /// sum.
    fn approach(
        &self,
        mesh: &mut Mesh,
        observations: &mut Observations<'_>,
        smoothing: f64,
    ) -> (Status, Solution) {
        let rounding = ROUNDING * ROUNDING * observations.height_sum();
        let tolerance = self.tolerance * smoothing;
        let mut polynomial_sum = None;
        loop {
            let triangle = observations.triangle(mesh);
            let solution = self.least_squares(&triangle, mesh, observations);
            let is_polynomial = polynomial_sum.is_none();
            let polynomial_sum = *polynomial_sum.get_or_insert(solution.residual_sum);
            let excess = solution.residual_sum - smoothing;
            if solution.residual_sum <= rounding && smoothing <= rounding {
                return (Status::Interpolating, solution);
            }
            if is_polynomial && excess <= tolerance {
                return (Status::Polynomial, solution);
            }
            if excess.abs() <= tolerance {
                return (Status::Smoothing, solution);
            }
            if excess < 0.0 {
                let bounds = [polynomial_sum - smoothing, excess];
                let balanced = self.balance(&triangle, mesh, observations, smoothing, bounds);
                return balanced.unwrap_or((Status::Unsettled, solution));
            }
            let next = if mesh.coefficients() > observations.len() {
                None
            } else {
                let sums = observations.interval_sums(mesh, &solution.coefficients);
                next_knot(mesh, &sums, self.most_knots)
            };
            let Some((axis, knot)) = next else {
                return (Status::KnotsExhausted, solution);
            };
            mesh.insert(axis, knot);
            observations.refresh(mesh, axis);
        }
    }

    /// The spline whose residual sum is `smoothing`. It is smoother than the least-squares spline but follows the
    /// points more closely than the polynomial without interior knots. `bounds` contains two differences: the residual
    /// sum of the polynomial minus `smoothing`, and the residual sum of the least-squares spline minus `smoothing`.
    /// `None` if no smoothing parameter could be tried.
    fn balance(
        &self,
        triangle: &Triangle,
        mesh: &Mesh,
        observations: &Observations<'_>,
        smoothing: f64,
        bounds: [f64; 2],
    ) -> Option<(Status, Solution)> {
        let roughness = Roughness::of(mesh);
        let first = triangle.order() as f64 / triangle.diagonal().sum::<f64>();
        let tolerance = self.tolerance * smoothing;
        let mut last = None;
        let is_met = parameter::search(bounds[0], bounds[1], first, tolerance, |parameter| {
            let joined = roughness.join(triangle, parameter);
            let (coefficients, rank) = self.solve(&joined);
            let residual_sum = observations.residual_sum(mesh, &coefficients);
            last = Some((joined, coefficients, residual_sum, rank));
            residual_sum - smoothing
        });
        let (joined, coefficients, residual_sum, rank) = last?;
        let solution = Solution {
            effective_unknowns: if rank == joined.order() {
                triangle.share_of(&joined)
            } else {
                rank as f64
            },
            coefficients,
            residual_sum,
            rank,
        };
        let status = if is_met {
            Status::Smoothing
        } else {
            Status::Unsettled
        };
        Some((status, solution))
    }

    fn least_squares(
        &self,
        triangle: &Triangle,
        mesh: &Mesh,
        observations: &Observations<'_>,
    ) -> Solution {
        let (coefficients, rank) = self.solve(triangle);
        let residual_sum = if rank == triangle.order() {
            triangle.residual_sum
        } else {
            observations.residual_sum(mesh, &coefficients)
        };
        Solution {
            coefficients,
            residual_sum,
            rank,
            effective_unknowns: rank as f64,
        }
    }

    /// The coefficients that solve the equations, and the rank of the equations. If there are several solutions, the
    /// function returns the solution with the smallest norm.
    fn solve(&self, triangle: &Triangle) -> (Vec<f64>, usize) {
        let largest = triangle.diagonal().fold(0.0, f64::max);
        let floor = RANK_TOLERANCE.sqrt() * largest;
        if triangle.diagonal().all(|entry| entry > floor) {
            (triangle.solve(), triangle.order())
        } else {
            minimum_norm::solve(triangle, floor)
        }
    }

    fn check_settings(&self) -> Result<(), Ep2Error> {
        for degree in self.degrees {
            let is_good = (1..=MAX_DEGREE).contains(&degree);
            Ep2Error::unless_good("degree", degree as f64, is_good, "between 1 and 5")?;
        }
        let smoothing = self.smoothing;
        Ep2Error::unless_good("smoothing", smoothing, smoothing >= 0.0, ">= 0")
    }

    fn check_points(&self, points: &[WeightedPoint]) -> Result<(), Ep2Error> {
        for (contact, point) in points.iter().enumerate() {
            let largest = point.u.abs() + point.v.abs() + point.w.abs();
            if !(largest <= LARGEST && point.weight <= LARGEST) {
                return Err(Ep2Error::NotFinite { contact });
            }
            let weight = point.weight;
            if weight <= 0.0 {
                return Err(Ep2Error::BadWeight { contact, weight });
            }
        }
        let needed = (self.degrees[0] + 1) * (self.degrees[1] + 1);
        if points.len() < needed {
            return Err(Ep2Error::TooFewContacts {
                contacts: points.len(),
                equations: points.len(),
                needed,
            });
        }
        Ok(())
    }

    /// The rectangle that contains the points and over which the knots extend.
    fn domain(points: &[WeightedPoint]) -> Result<[[f64; 2]; 2], Ep2Error> {
        let range = |place: fn(&WeightedPoint) -> f64| {
            let places = points.iter().map(place);
            places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
                [low.min(place), high.max(place)]
            })
        };
        let spanned = [range(|point| point.u), range(|point| point.v)];
        let contacts = points.len();
        let widths = spanned.map(|[low, high]| high - low);
        if widths == [0.0; 2] {
            let extent = 0.0;
            return Err(Ep2Error::Coincident { contacts, extent });
        }
        if widths.contains(&0.0) {
            let spread = 0.0;
            return Err(Ep2Error::Collinear { contacts, spread });
        }
        let is_in_range = |width: &f64| (1.0 / LARGEST..=LARGEST).contains(width);
        match widths.iter().all(is_in_range) {
            true => Ok(spanned),
            false => Err(Ep2Error::OutOfRange),
        }
    }
}
