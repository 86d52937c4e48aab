//! A penalised spline, fitted to heights and slopes. Its smoothing weight is selected from the data.

mod equations;
mod gaussian_process;
mod roughness_posterior;
mod series;
mod spectrum;
mod tridiagonal;
mod weight;

pub use weight::Criterion;

use nalgebra::{DMatrix, DVector};

use crate::chebyshev::{approximated, count};
use crate::gross_outliers::OUTLIER_PROBABILITY;
use crate::knots::Knots;
use crate::misfit::{MAX_CONTACTS, Model};
use crate::noise::{Noise, Variances};
use crate::posterior::Posterior;
use crate::spline::TensorSpline;
use crate::square_quadric::{Square, SquareQuadric, SquareTermPrior, UNKNOWNS};
use crate::{Ep2Error, Fit, Method, MisfitTest, NoiseEstimate, Patch, Sample};
use equations::{DEGREE, Equations, roughness_penalty};
use roughness_posterior::{SeriesProblem, SquareTerm, likeliest_process};
use series::SeriesEquations;
use spectrum::Spectrum;
use weight::Search;

/// Largest number of knot intervals per side. With more intervals, computations with the dense matrices of the
/// coefficients would take seconds.
const MAX_INTERVALS: usize = 24;
/// If the number of knot intervals is chosen automatically, it is at most this number per side.
const MAX_DEFAULT_INTERVALS: usize = 12;
/// Largest number of spline coefficients per equation, if the number of knot intervals is chosen automatically.
const MAX_COEFFICIENTS_PER_EQUATION: f64 = 0.3;
/// Largest accepted ratio of the effective degrees of freedom to the number of coefficients. At a larger ratio, the
/// contacts are so exact that the approximation error of the spline is not negligible. Then the number of knot
/// intervals is doubled, if it was chosen automatically.
const MAX_UNKNOWN_SHARE: f64 = 0.6;
/// The posterior is computed with a Chebyshev series instead of the spline. The series has more coefficients than the
/// spline, by at least this number. Therefore it can represent shapes that the spline cannot.
const EXTRA_COEFFICIENTS: usize = 5;

/// Two models describe the surface: a spline alone, and an implicit quadric plus a spline. If their deviances (−2 ln of
/// the likelihood) differ by more than this value, the posterior is that of the more probable model; otherwise it is the
/// weighted mean of both.
const DECISIVE_DEVIANCE: f64 = 28.0;

/// Largest number of effective degrees of freedom of a spline that is added to an implicit quadric. A larger number
/// means that the surface is not close to an implicit quadric; an example is a torus.
const MAX_IMPLICIT_UNKNOWNS: f64 = 12.0;

/// One bicubic tensor-product spline with a penalty on its third derivatives. It is fitted by weighted least squares to
/// the heights and, if there are normals, to both slopes.
///
/// For a quadric, the penalty is 0. The weight of the penalty is selected by a [`Criterion`].
///
/// The standard errors are computed for a series of higher degree than the spline: a quadric plus a Gaussian process
/// whose correlation length and amplitude are unknown. Therefore, they include the approximation error of the spline
/// and the bias of the smoothing.
///
/// The computing time is proportional to the number of contacts and to the sixth power of the number of intervals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Penalised {
    /// Number of knot intervals along each side, 1 to 24. With `None`, it is the largest number that is suitable for
    /// the contacts and their fingers.
    pub intervals: Option<usize>,
    /// Criterion by which the smoothing weight is selected.
    pub criterion: Criterion,
    /// Stated standard deviations of the contacts' errors. A standard deviation that is not stated is estimated from
    /// the contacts.
    pub noise: Noise,
}

/// The surface from which a fitted spline describes the deviation, and the data from which the posterior distribution
/// of the fitted surface is computed.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    square: Square,
    quadric: SquareQuadric,
    /// Prior of the coefficient m if the spline is added to an implicit quadric z = Q + m z²/2; `None` if the spline
    /// alone describes the surface.
    square_term: Option<SquareTermPrior>,
    intervals: [usize; 2],
    variances: Variances,
    is_known: bool,
    noise: Option<NoiseEstimate>,
    /// The other quadric and the prior of its m, unless it is far less probable than the chosen quadric.
    other: Option<(SquareQuadric, Option<SquareTermPrior>)>,
}

/// Smallest component of the normal in the middle of a patch along the normal of the patch: the cosine of 60 degrees.
const MIN_NORMAL: f64 = 0.5;

impl Method for Penalised {
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        let (fit, basis) = self.estimated(patch)?;
        let posterior = basis.posterior(patch)?;
        let basis = Some(Box::new(basis));
        Ok(Fit {
            posterior,
            basis,
            ..fit
        })
    }

    fn misfit(&self, patch: &Patch, fit: Option<&Fit>) -> Result<MisfitTest, Ep2Error> {
        let test = |model: &Model, process: &DMatrix<f64>| model.misfit(process);
        Ok(self.tested(patch, fit, test)?.unwrap_or_default())
    }
}

impl Penalised {
    /// Fits the same surface as [`Method::fit`], but without standard errors, which saves computing time.
    ///
    /// # Errors
    /// Errors of [`Method::fit`].
    pub fn estimate(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        Ok(self.estimated(patch)?.0)
    }

    /// For each contact in `others`, whether it contradicts the patch. These contacts are not part of the patch. A
    /// contact that is `None` is too steep for the patch, so it contradicts the patch. If the noise is unknown, no
    /// contact contradicts the patch.
    pub(crate) fn contradicting(
        &self,
        patch: &Patch,
        others: &[Option<Sample>],
    ) -> Result<Vec<bool>, Ep2Error> {
        let test = |model: &Model, process: &DMatrix<f64>| {
            model.contradicting(process, others, OUTLIER_PROBABILITY)
        };
        let tested = self.tested(patch, None, test)?;
        Ok(tested.unwrap_or_else(|| vec![false; others.len()]))
    }

    /// Computes the fitted model and the most probable Gaussian process of the surface's roughness, and passes both to
    /// `test`. Returns the result of `test`; `None` if the noise is unknown. `fit` is the fit to this patch, if it was
    /// already computed.
    fn tested<T>(
        &self,
        patch: &Patch,
        fit: Option<&Fit>,
        test: impl FnOnce(&Model, &DMatrix<f64>) -> Result<T, Ep2Error>,
    ) -> Result<Option<T>, Ep2Error> {
        let (patch, step) = patch.thinned(MAX_CONTACTS);
        let patch = &*patch;
        let fit = fit.filter(|_| step == 1);
        let known = fit.and_then(|fit| Some((fit.clone(), (**fit.basis.as_ref()?).clone())));
        let (fit, basis) = known.map_or_else(|| self.estimated(patch), Ok)?;
        let Some(found) = basis.noise else {
            return Ok(None);
        };
        let model = Model {
            patch,
            step,
            square: basis.square,
            fit: &fit,
            quadric: &basis.quadric,
            noise: &self.noise,
            found,
            degree: basis.degree(),
        };
        let equations = basis.equations(patch);
        let process = likeliest_process(&basis.problem(&equations, patch))?;
        test(&model, &process).map(Some)
    }

    fn estimated(&self, patch: &Patch) -> Result<(Fit, Basis), Ep2Error> {
        self.criterion.check()?;
        let mut intervals = self.intervals(patch)?;
        loop {
            let estimated = self.estimated_with(intervals, patch)?;
            let share = estimated.0.effective_unknowns / coefficients(intervals) as f64;
            let is_too_coarse = self.intervals.is_none() && share > MAX_UNKNOWN_SHARE;
            match finer(intervals, patch) {
                Some(finer) if is_too_coarse => intervals = finer,
                _ if self.is_too_steep(&estimated.0, patch) => {
                    let criterion = Criterion::Reml;
                    return Self { criterion, ..*self }.estimated(patch);
                }
                _ => return Ok(estimated),
            }
        }
    }

    /// Whether the surface is too steep in the middle of the patch. Without normals, generalised cross-validation may
    /// choose nearly no smoothing for heights on few strokes, between which the surface then rises steeply. Restricted
    /// maximum likelihood does not have this error.
    fn is_too_steep(&self, fit: &Fit, patch: &Patch) -> bool {
        let normal = || Some(patch.frame.direction(&fit.centre().ok()?.normal).z);
        let has_heights_only = !patch.has_normals() && self.criterion != Criterion::Reml;
        has_heights_only && normal().is_none_or(|normal| normal < MIN_NORMAL)
    }

    fn estimated_with(
        &self,
        intervals: [usize; 2],
        patch: &Patch,
    ) -> Result<(Fit, Basis), Ep2Error> {
        let known = self.noise.in_patch(&patch.frame)?;
        let square = Square::of(patch);
        let mut quadric = SquareQuadric::of(patch, &square, &known)?;
        let knots = intervals.map(|count| Knots::uniform(DEGREE, -1.0, 1.0, count));
        let equations = Equations::around(&quadric, patch, &square, &knots, true);
        let roughness = roughness_penalty(&knots);
        let bending = quadric.mean_square_curvature(&square);
        let expected = weight::log_weight_of_sphere(bending);
        let mut variances = quadric.variances;
        let is_known = known.is_complete_for(patch);
        let mut spectrum = Spectrum::of(&equations, &roughness, &variances)?;
        let mut has_noise = quadric.noise.is_some();
        if patch.has_normals() && !is_known {
            // Estimate the ratio of the variances of heights and slopes from a preliminary fit, because the quadric may
            // not follow the surface.
            let rough = Search::new(&spectrum, self.criterion, is_known, expected).best();
            let filters = spectrum.filters(rough.log_weight);
            let residuals = equations.residuals(&spectrum.coefficients(&filters));
            let unknowns = equations.effective_unknowns(&spectrum.inverse(&filters), &variances);
            has_noise = variances.update(&known, bending, patch, &residuals, &unknowns);
            spectrum = Spectrum::of(&equations, &roughness, &variances)?;
        }
        let mut search = Search::new(&spectrum, self.criterion, is_known, expected);
        let implicit = quadric.clone().with_square_term(patch, &square, &known);
        let (mut square_term, mut other) = (None, None);
        let of_implicit;
        if let Some((implicit, prior)) = implicit {
            let equations = Equations::around(&implicit, patch, &square, &knots, false);
            of_implicit = spectrum.clone().with_right_side(&equations, &variances);
            let about = Search::new(&of_implicit, self.criterion, is_known, expected);
            let deviance = about.least_deviance() + implicit.square_term_deviance;
            let gain = search.least_deviance() - deviance;
            if gain > 0.0 && about.best().effective_unknowns < MAX_IMPLICIT_UNKNOWNS {
                search = about;
                let ordinary = std::mem::replace(&mut quadric, implicit);
                square_term = Some(prior);
                other = (gain < DECISIVE_DEVIANCE).then_some((ordinary, None));
            } else if gain > -DECISIVE_DEVIANCE {
                other = Some((implicit, Some(prior)));
            }
        }
        let mut choice = search.best();
        choice.scale = choice.scale.max(variances.min_scale());
        let spectrum = search.spectrum;
        let mut coefficients = spectrum.coefficients(&spectrum.filters(choice.log_weight));
        if square_term.is_none() {
            let of_quadric = quadric.spline_coefficients(&knots[0], &knots[1]);
            coefficients += DVector::from_vec(of_quadric);
        }
        if !coefficients.iter().all(|one| one.is_finite()) {
            return Err(Ep2Error::OutOfRange);
        }
        variances.heights *= choice.scale;
        variances.slopes *= choice.scale;
        let noise = has_noise.then(|| variances.estimate(patch, &known));
        let fit = Fit {
            frame: patch.frame,
            domain: patch.domain,
            spline: TensorSpline {
                u: square.knots(0, &knots[0]),
                v: square.knots(1, &knots[1]),
                coefficients: coefficients.data.into(),
            },
            mean: square_term.map(|_| (quadric.clone(), square)),
            posterior: None,
            basis: None,
            noise,
            effective_unknowns: choice.effective_unknowns,
            status: None,
        };
        let basis = Basis {
            square,
            quadric,
            square_term,
            intervals,
            variances,
            is_known,
            noise,
            other,
        };
        Ok((fit, basis))
    }

    fn intervals(&self, patch: &Patch) -> Result<[usize; 2], Ep2Error> {
        let Some(intervals) = self.intervals else {
            return Ok(default_intervals(patch));
        };
        let is_good = (1..=MAX_INTERVALS).contains(&intervals);
        Ep2Error::unless_good("intervals", intervals as f64, is_good, "1 to 24")?;
        Ok([intervals; 2])
    }
}

impl Basis {
    fn posterior(&self, patch: &Patch) -> Result<Option<Posterior>, Ep2Error> {
        if self.noise.is_none() {
            return Ok(None);
        }
        let with = |(quadric, square_term)| Self {
            quadric,
            square_term,
            ..self.clone()
        };
        let other = self.other.clone().map(with);
        let bases = || std::iter::once(self).chain(&other);
        let equations: Vec<_> = bases().map(|basis| basis.equations(patch)).collect();
        let problems = bases().zip(&equations);
        let problems: Vec<_> = problems
            .map(|(basis, equations)| basis.problem(equations, patch))
            .collect();
        roughness_posterior::posterior(&problems).map(Some)
    }

    fn degree(&self) -> usize {
        let least = coefficients(self.intervals) + EXTRA_COEFFICIENTS;
        (0..).find(|&degree| count(degree) >= least).unwrap_or(0)
    }

    fn equations(&self, patch: &Patch) -> SeriesEquations {
        let (quadric, square) = (&self.quadric, &self.square);
        SeriesEquations::around(quadric, patch, square, &self.variances, self.degree())
    }

    fn problem<'a>(&self, equations: &'a SeriesEquations, patch: &Patch) -> SeriesProblem<'a> {
        SeriesProblem {
            equations,
            degree: self.degree(),
            observations: patch.equations(),
            is_known: self.is_known,
            square: self.square,
            quadric: self.quadric.series(),
            square_term: self.square_term.map(|prior| {
                let of_series = |value: &dyn Fn(f64, f64) -> f64| {
                    DVector::from_vec(approximated(self.degree(), value))
                };
                let derivative = of_series(&|a, b| self.quadric.by_square_term(a, b));
                SquareTerm {
                    derivative: derivative
                        .rows(UNKNOWNS, derivative.len() - UNKNOWNS)
                        .into(),
                    std: prior.std,
                    shift: prior.mean - self.quadric.square_term,
                    surface: of_series(&|a, b| self.quadric.value_and_slopes(a, b)[0]),
                }
            }),
        }
    }
}

/// Automatic numbers of knot intervals along u and along v. They are as large as the limit on the coefficients per
/// equation allows, and usually equal. Across the fingers' travel, there are at most as many intervals as gaps between
/// fingers. The contacts would not determine more intervals, because the contacts of one finger are nearly on a line.
fn default_intervals(patch: &Patch) -> [usize; 2] {
    let gaps = match patch.fingers {
        1 => MAX_DEFAULT_INTERVALS,
        fingers => fingers - 1,
    };
    let most = MAX_COEFFICIENTS_PER_EQUATION * patch.equations() as f64;
    (1..=MAX_DEFAULT_INTERVALS)
        .rev()
        .map(|along| [along, along.min(gaps)])
        .find(|&intervals| coefficients(intervals) as f64 <= most)
        .unwrap_or([1, 1])
}

/// Twice the numbers of knot intervals; `None` if these numbers would be too large or if there are not enough contacts.
fn finer(intervals: [usize; 2], patch: &Patch) -> Option<[usize; 2]> {
    let finer = intervals.map(|count| 2 * count);
    let fits = finer.iter().all(|&count| count <= MAX_DEFAULT_INTERVALS);
    (fits && coefficients(finer) <= patch.equations()).then_some(finer)
}

fn coefficients([along, across]: [usize; 2]) -> usize {
    (along + DEGREE) * (across + DEGREE)
}
