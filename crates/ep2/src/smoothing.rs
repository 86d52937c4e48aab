//! Smoothing splines of scattered heights, with knots where the data ask for them.
//!
//! The method is Dierckx's (An algorithm for surface-fitting with spline functions, IMA J. Numer.
//! Anal. 1, 1981; Curve and Surface Fitting with Splines, 1993, chapter 5), known from FITPACK.
//! Of all splines whose sum of squared weighted residuals is at most `s` it seeks a smooth one on
//! few knots:
//!
//! 1. Least squares on the present knots, at first none. While the sum exceeds `s` a knot is added
//!    in the interval, along u or v, with the largest share of it, at the residuals' centroid.
//! 2. The equations are joined by `1/p` times the jumps of the highest derivative at the knots, and
//!    `p` is sought at which the sum is `s` within a thousandth.
//!
//! Where the points leave coefficients open, those of least norm are taken.

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

/// A diagonal entry of the triangularised equations whose square is at most this, relative to the largest, counts as zero.
const RANK_TOLERANCE: f64 = 1e-16;
/// Relative residuals of this size are rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The settings by which a smoothing spline is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SmoothingSpline {
    /// Degrees in u and v, 1 to [`MAX_DEGREE`].
    pub(crate) degrees: [usize; 2],
    /// The sum of squared weighted residuals that is aimed at, `s ≥ 0`.
    pub(crate) smoothing: f64,
    /// Largest numbers of interior knots along u and along v.
    pub(crate) most_knots: [usize; 2],
    /// Largest deviation of the sum from `smoothing`, relative to it.
    pub(crate) tolerance: f64,
}

impl SmoothingSpline {
    /// Settings with the same degree in both directions, as many knots as the points bear, and the
    /// tolerance of FITPACK's `surfit` in SciPy.
    pub(crate) const fn new(degree: usize, smoothing: f64) -> Self {
        Self {
            degrees: [degree; 2],
            smoothing,
            most_knots: [usize::MAX; 2],
            tolerance: 1e-3,
        }
    }
}

/// The way in which a fit ended: whether its sum of squared residuals is the one aimed at, and why not.
#[derive(Clone, Copy, Debug, Eq, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum Status {
    /// The polynomial without knots meets the sum.
    Polynomial,
    /// All residuals are rounding.
    Interpolating,
    /// The sum is met within the tolerance.
    Smoothing,
    /// The sum is exceeded: there are more coefficients than points, as many knots as are allowed, or
    /// no interval left that may be split. The spline is the least-squares one on these knots.
    KnotsExhausted,
    /// The parameter that balances the sum against the jumps was not found.
    Unsettled,
}

impl Status {
    /// Whether the sum was met.
    pub(crate) const fn is_met(self) -> bool {
        !matches!(self, Self::KnotsExhausted | Self::Unsettled)
    }

    /// The name used in files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// A smoothing spline.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Smoothed {
    /// The spline.
    pub(crate) spline: TensorSpline,
    /// Its sum of squared weighted residuals.
    pub(crate) residual_sum: f64,
    /// Whether that is what was aimed at.
    pub(crate) status: Status,
    /// Number of coefficients that the points determine; the others are chosen such that the norm is
    /// least.
    pub(crate) rank: usize,
    /// Effective number of unknowns that the spline has taken up: the trace of the map from heights to spline.
    pub(crate) effective_unknowns: f64,
}

/// Coefficients on some knots, in the order of the mesh.
struct Solution {
    coefficients: Vec<f64>,
    residual_sum: f64,
    rank: usize,
    effective_unknowns: f64,
}

impl SmoothingSpline {
    /// The spline of at least `(degrees[0] + 1)(degrees[1] + 1)` points.
    ///
    /// Points that leave the polynomial open, such as points on few lines, are no error: see
    /// [`Smoothed::rank`].
    ///
    /// # Errors
    /// [`Ep2Error`]: `bad-setting`, `too-few-contacts`, `not-finite`, `bad-weight`, `coincident`
    /// or `collinear` for points that span no rectangle, `out-of-range`.
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

    /// Adds knots until the least-squares spline meets the required residual sum, then returns the unused part of the sum.
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

    /// The spline whose sum of squares is `smoothing`, between the polynomial and the
    /// least-squares spline, which exceed it by `bounds`; `None` if not even one could be tried.
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

    /// The least-squares spline on the present knots.
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

    /// The coefficients, those of least norm if there are many, and the rank.
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

    /// The rectangle of the knots.
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
