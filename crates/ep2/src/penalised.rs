//! One penalised spline through heights and slopes, with a smoothing weight from the data.

mod equations;
mod mixture;
mod process;
mod product;
mod roughness;
mod series;
mod spectrum;
mod tridiagonal;
mod weight;

pub use weight::Criterion;

use crate::agreement::{Apart, Model};
use crate::chebyshev::count;
use crate::noise::{Noise, Variances};
use crate::square::Square;
use crate::square_quadric::SquareQuadric;
use crate::{Agreement, Ep2Error, Fit, Knots, Method, Patch, Posterior, TensorSpline};
use equations::{DEGREE, Equations};
use mixture::Given;
use series::SeriesEquations;
use spectrum::Spectrum;
use weight::Search;

/// Largest number of intervals per side: beyond, the dense algebra of the coefficients takes seconds.
const MOST_INTERVALS: usize = 24;
/// Largest number of intervals per side unless one is given.
const MOST_BY_DEFAULT: usize = 12;
/// Unless told otherwise, a spline has at most so many coefficients per equation.
const BEARABLE: f64 = 0.3;
/// Unless told otherwise, a spline of which the fit takes up more than this share of the
/// coefficients gets more intervals: the contacts are exact enough to show what it cannot follow.
const CROWDED: f64 = 0.6;
/// The series that the posterior is of has at least so many more coefficients than the spline, so that it follows what
/// the spline does not.
const MORE_COEFFICIENTS: usize = 5;

/// One bicubic tensor-product spline, fitted by weighted least squares to the heights and, where
/// there are normals, to both slopes, with a penalty on its third derivatives.
///
/// Quadrics cost no penalty. The weight of the penalty is chosen by a [`Criterion`].
///
/// The stated [`Posterior`] is not that of the spline, but of a series of higher degree: a quadric plus a Gaussian
/// process of unknown length and amplitude. So it knows of what the spline cannot follow, and of how far smoothing has
/// moved it.
///
/// The cost grows linearly with the contacts, and with the sixth power of the intervals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Penalised {
    /// Intervals of the spline along each side, 1 to 24; `None` takes as many as the contacts
    /// and their fingers bear.
    pub intervals: Option<usize>,
    /// Criterion by which the smoothing weight is chosen.
    pub criterion: Criterion,
    /// Known standard deviations of the contacts' errors.
    pub noise: Noise,
}

/// The chosen spline, and what its posterior needs.
struct Estimated {
    fit: Fit,
    square: Square,
    quadric: SquareQuadric,
    intervals: [usize; 2],
    /// Variances of the contacts.
    variances: Variances,
    /// Whether they were known.
    is_known: bool,
    /// Whether they are known or found.
    told: bool,
}

impl Method for Penalised {
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        let estimated = self.estimated(patch)?;
        let posterior = estimated.posterior(patch)?;
        Ok(Fit {
            posterior,
            ..estimated.fit
        })
    }

    fn agreement(&self, patch: &Patch) -> Result<Agreement, Ep2Error> {
        let estimated = self.estimated(patch)?;
        if !estimated.told {
            return Ok(Agreement::default());
        }
        let degree = estimated.degree();
        let model = Model {
            patch,
            square: estimated.square,
            fit: &estimated.fit,
            quadric: &estimated.quadric,
            told: &self.noise,
            degree,
        };
        let equations = estimated.equations(patch);
        let processes = estimated.with(&equations, patch, mixture::likely)?;
        model.agreement(&processes, |apart| {
            let Estimated {
                quadric,
                square,
                variances,
                ..
            } = &estimated;
            let (patch, equations) = match apart {
                Apart::Finger(finger) => {
                    let apart = equations.apart(quadric, patch, square, variances, degree, finger);
                    (patch.clone(), apart)
                }
                Apart::Normals => {
                    let positions = patch.of_positions();
                    let equations =
                        SeriesEquations::around(quadric, &positions, square, variances, degree);
                    (positions, equations)
                }
            };
            estimated.with(&equations, &patch, mixture::likely)
        })
    }
}

impl Penalised {
    /// The surface through the contacts of a patch, without its uncertainty: the same as that of [`Method::fit`], at
    /// less cost.
    ///
    /// # Errors
    /// Errors of [`Method::fit`].
    pub fn estimate(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        Ok(self.estimated(patch)?.fit)
    }

    fn estimated(&self, patch: &Patch) -> Result<Estimated, Ep2Error> {
        self.criterion.check()?;
        let mut intervals = self.intervals(patch)?;
        loop {
            let estimated = self.estimated_with(intervals, patch)?;
            let taken = estimated.fit.effective_unknowns / coefficients(intervals) as f64;
            match finer(intervals, patch) {
                Some(finer) if self.intervals.is_none() && taken > CROWDED => intervals = finer,
                _ => return Ok(estimated),
            }
        }
    }

    fn estimated_with(&self, intervals: [usize; 2], patch: &Patch) -> Result<Estimated, Ep2Error> {
        let known = self.noise.in_patch(&patch.frame)?;
        let square = Square::of(patch);
        let quadric = SquareQuadric::of(patch, &square, &known)?;
        let knots = intervals.map(|count| Knots::uniform(DEGREE, -1.0, 1.0, count));
        let equations = Equations::around(&quadric, patch, &square, &knots);
        let roughness = roughness::of(&knots);

        let expected = weight::of_a_sphere(quadric.bending(&square));

        let mut variances = quadric.variances;
        let is_known = known.is_all_of(patch);
        let mut spectrum = Spectrum::of(&equations, &roughness, &variances)?;
        let mut told = quadric.tells_noise();
        if patch.has_normals() && !is_known {
            // The variances of heights and slopes are compared at a fit that follows the surface.
            let rough = Search::new(&spectrum, self.criterion, is_known, expected).best();
            let kept = spectrum.kept(rough.log_weight);
            let residuals = equations.residuals(&spectrum.coefficients(&kept));
            let taken = equations.taken(&spectrum.inverse(&kept), &variances);
            let bending = quadric.bending(&square);
            told = variances.update(&known, bending, patch, &residuals, &taken);
            spectrum = Spectrum::of(&equations, &roughness, &variances)?;
        }
        let search = Search::new(&spectrum, self.criterion, is_known, expected);
        let mut choice = search.best();
        choice.scale = choice.scale.max(variances.least_scale());
        let deviation = spectrum.coefficients(&spectrum.kept(choice.log_weight));
        let coefficients: Vec<f64> = quadric
            .spline_coefficients(&knots[0], &knots[1])
            .iter()
            .zip(&deviation)
            .map(|(quadric, deviation)| quadric + deviation)
            .collect();
        if !coefficients
            .iter()
            .all(|coefficient| coefficient.is_finite())
        {
            return Err(Ep2Error::OutOfRange);
        }
        variances.heights *= choice.scale;
        variances.slopes *= choice.scale;
        let fit = Fit {
            frame: patch.frame,
            domain: patch.domain,
            spline: TensorSpline {
                u: square.knots(0, &knots[0]),
                v: square.knots(1, &knots[1]),
                coefficients,
            },
            posterior: None,
            noise: told.then(|| variances.estimate(patch)),
            effective_unknowns: choice.effective_unknowns,
            status: None,
        };
        Ok(Estimated {
            fit,
            square,
            quadric,
            intervals,
            variances,
            is_known,
            told,
        })
    }

    /// Intervals along u and along v.
    fn intervals(&self, patch: &Patch) -> Result<[usize; 2], Ep2Error> {
        let Some(intervals) = self.intervals else {
            return Ok(bearable_intervals(patch));
        };
        let is_good = (1..=MOST_INTERVALS).contains(&intervals);
        Ep2Error::unless_good("intervals", intervals as f64, is_good, "1 to 24")?;
        Ok([intervals; 2])
    }
}

impl Estimated {
    /// Uncertainty of the surface that the contacts leave; `None` where they do not tell their noise.
    fn posterior(&self, patch: &Patch) -> Result<Option<Posterior>, Ep2Error> {
        if !self.told {
            return Ok(None);
        }
        let equations = self.equations(patch);
        self.with(&equations, patch, mixture::posterior).map(Some)
    }

    /// Degree of the series that the posterior is of.
    fn degree(&self) -> usize {
        let least = coefficients(self.intervals) + MORE_COEFFICIENTS;
        (0..).find(|&degree| count(degree) >= least).unwrap_or(0)
    }

    /// Equations of the series that the posterior is of.
    fn equations(&self, patch: &Patch) -> SeriesEquations {
        let (quadric, square) = (&self.quadric, &self.square);
        SeriesEquations::around(quadric, patch, square, &self.variances, self.degree())
    }

    /// An answer that is asked of equations.
    fn with<T>(
        &self,
        equations: &SeriesEquations,
        patch: &Patch,
        ask: impl FnOnce(&Given<'_>) -> Result<T, Ep2Error>,
    ) -> Result<T, Ep2Error> {
        ask(&Given {
            equations,
            degree: self.degree(),
            observations: patch.equations(),
            is_known: self.is_known,
            square: self.square,
            quadric: self.quadric.series(),
        })
    }
}

/// Largest numbers of intervals along u and v, equal if they may be, that the contacts bear: a limited
/// number of coefficients per equation, and across the travel no more intervals than gaps between
/// fingers, since the contacts of a finger lie about one line.
fn bearable_intervals(patch: &Patch) -> [usize; 2] {
    let gaps = match patch.fingers {
        1 => MOST_BY_DEFAULT,
        fingers => fingers - 1,
    };
    let most = BEARABLE * patch.equations() as f64;
    (1..=MOST_BY_DEFAULT)
        .rev()
        .map(|along| [along, along.min(gaps)])
        .find(|&intervals| coefficients(intervals) as f64 <= most)
        .unwrap_or([1, 1])
}

/// Twice as many intervals, if there are contacts for them.
fn finer(intervals: [usize; 2], patch: &Patch) -> Option<[usize; 2]> {
    let finer = intervals.map(|count| 2 * count);
    let fits = finer.iter().all(|&count| count <= MOST_BY_DEFAULT);
    (fits && coefficients(finer) <= patch.equations()).then_some(finer)
}

/// Coefficients of a spline with so many intervals along both sides.
fn coefficients([along, across]: [usize; 2]) -> usize {
    (along + DEGREE) * (across + DEGREE)
}
