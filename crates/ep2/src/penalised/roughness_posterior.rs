//! The posterior (mean and covariance) of a surface, averaged over correlation lengths and amplitudes of its roughness.

use std::f64::consts::LN_2;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector2};

use super::gaussian_process;
use super::series::SeriesEquations;
use super::tridiagonal::{Factors, Tridiagonal};
use crate::Ep2Error;
use crate::chebyshev::count;
use crate::matrix::{add_symmetric, product};
use crate::posterior::Posterior;
use crate::square_quadric::{Square, UNKNOWNS, rms_second_derivative};

/// Largest correlation length of the roughness, in units of half a side of the square. A process with a larger length
/// is nearly a cubic polynomial.
const MAX_LENGTH: f64 = 3.0;
/// Smallest correlation length (in units of half a side of the square) that a series can represent, multiplied by the
/// degree of the series.
const MIN_LENGTH_TIMES_DEGREE: f64 = 6.0;
/// The posterior is averaged over several correlation lengths. This constant is the largest ratio of two neighbouring
/// lengths.
const MAX_LENGTH_RATIO: f64 = 3.0;
const EXPECTED_LENGTH: f64 = 1.75;
/// Exponent p of the prior probability of a correlation length l. The probability is proportional to 1/cosh(p
/// ln(l/l₀)), where l₀ is the most probable length.
const LENGTH_POWER: f64 = 2.0;
/// Most probable amplitude of the roughness in the prior, relative to the second derivatives of the quadric. The
/// amplitude is the standard deviation of the second derivatives of the roughness.
const EXPECTED_AMPLITUDE: f64 = 0.75;
/// Most probable amplitude of the roughness in the prior, if the roughness is the deviation from an implicit quadric
/// such as an ellipsoid. It is relative to the second derivatives of the quadric. Deviations from an implicit quadric
/// are usually smaller than deviations from an ordinary quadric.
const EXPECTED_AMPLITUDE_ABOUT_IMPLICIT: f64 = 0.25;
/// Exponent p of the prior probability of an amplitude a. The probability is proportional to 1/cosh(p ln(a/a₀)), where
/// a₀ is the most probable amplitude.
const AMPLITUDE_POWER: f64 = 4.0;
/// The posterior is averaged over several amplitudes of the roughness. This constant is the number of amplitudes that
/// are smaller than the expected amplitude, and also the number of amplitudes that are larger.
const AMPLITUDE_STEPS: i32 = 6;
const LOG_AMPLITUDE_STEP: f64 = 0.5;
/// The likelihood of an amplitude and a correlation length is raised to this power. A power below 1 reduces the effect
/// of the likelihood. The reason is that the model assumes the same roughness at all places and in all directions. The
/// roughness of a real surface varies, so the contacts determine it less accurately than the model assumes.
const LIKELIHOOD_POWER: f64 = 0.5;
/// The average over the posteriors omits combinations of length and amplitude that are too improbable. Let p be the
/// probability of a combination, divided by the probability of the most probable combination. This constant is the
/// smallest accepted natural logarithm of p.
const MIN_LOG_PROBABILITY: f64 = -7.0;
/// Largest allowed ratio of the information from the contacts (the normal equations) to the information in the prior at
/// the expected amplitude. At a larger ratio, rounding errors would dominate.
const MAX_INFORMATION: f64 = 1e11;
/// Prior probability that the surface is an implicit quadric with little roughness, and not an ordinary quadric with
/// more roughness.
const IMPLICIT_PROBABILITY: f64 = 0.25;

/// Data from which the posterior is computed. The surface is a quadric plus a series of Chebyshev polynomials, and
/// `equations` are the normal equations for the coefficients of the series.
pub(super) struct SeriesProblem<'a> {
    pub(super) equations: &'a SeriesEquations,
    pub(super) degree: usize,
    pub(super) observations: usize,
    /// Whether the variances of the contacts' errors are stated. If not, only the ratio of the variance of heights to
    /// the variance of slopes is used.
    pub(super) is_known: bool,
    pub(super) square: Square,
    pub(super) quadric: [f64; UNKNOWNS],
    /// The coefficient m as an additional unknown, if the surface is an implicit quadric z = Q(a, b) + m z²/2 plus a
    /// series; otherwise `None`.
    pub(super) square_term: Option<SquareTerm>,
}

/// The coefficient m of an implicit quadric z = Q + m z²/2, as an additional unknown of the series.
pub(super) struct SquareTerm {
    /// Derivative of the surface with respect to m, as coefficients of all products of Chebyshev polynomials except
    /// those that form quadrics.
    pub(super) derivative: DVector<f64>,
    /// Standard deviation of the prior of m.
    pub(super) std: f64,
    /// Mean of the prior of m, minus the m of the implicit quadric.
    pub(super) shift: f64,
    /// The implicit quadric, as coefficients of all products of Chebyshev polynomials.
    pub(super) surface: DVector<f64>,
}

impl SeriesProblem<'_> {
    /// The amplitude of the roughness that is most probable in the prior.
    fn expected_amplitude(&self, quadric: &[f64; UNKNOWNS]) -> f64 {
        let ratio = match self.square_term {
            Some(_) => EXPECTED_AMPLITUDE_ABOUT_IMPLICIT,
            None => EXPECTED_AMPLITUDE,
        };
        ratio * rms_second_derivative(quadric)
    }
}

/// Normal equations for the coefficients of the roughness, after the coefficients of the quadric have been eliminated.
/// The roughness is a sum of all products of Chebyshev polynomials, except those that form quadrics.
struct Rest {
    gram: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
    degrees: f64,
    is_known: bool,
    expected_amplitude: f64,
}

struct Process {
    log_length: f64,
    /// Modes of the Gaussian process that describes the roughness, one per column. Each mode is a sum of products of
    /// Chebyshev polynomials. In the basis of the modes, the matrix of the normal equations is tridiagonal.
    modes: DMatrix<f64>,
    information: Tridiagonal,
    right: Vec<f64>,
}

/// A Gaussian process with one correlation length and one amplitude, as one term of the average over the posteriors.
struct Candidate {
    square_amplitude: f64,
    /// Triangular factors of the matrix 1 + amplitude² × information. The information of the contacts is expressed in
    /// the basis of the modes.
    factors: Factors,
    /// Posterior means of the coefficients of the modes. The roughness is the sum of the modes, each multiplied by its
    /// coefficient.
    mean: Vec<f64>,
    /// Factor by which the assumed variances must be multiplied to explain the residuals; 1 if the variances are
    /// stated.
    scale: f64,
    log_probability: f64,
}

/// Mean and covariance of the coefficients of a surface, given the contacts.
struct Distribution {
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Logarithm of the probability of the contacts, up to a constant that is the same for all problems with the same
    /// contacts.
    log_evidence: f64,
}

/// The posterior of the surface, that is, its mean and covariance given the contacts. It is the average of the
/// posteriors of all `problems`, weighted by their probabilities, and describes the surface of the first problem. If
/// this surface is an implicit quadric plus a series, the posterior is that of the series.
///
/// In each problem, the surface is a quadric with a flat prior plus a Gaussian process of unknown correlation length
/// and amplitude. The posterior is the average of the posteriors for all lengths and amplitudes.
///
/// # Errors
/// [`Ep2Error::OutOfRange`] if the equations do not determine the quadric.
pub(super) fn posterior(problems: &[SeriesProblem]) -> Result<Posterior, Ep2Error> {
    let first = &problems[0];
    let size = count(first.degree);
    let surface = |problem: &SeriesProblem| match &problem.square_term {
        None => DVector::zeros(size),
        Some(term) => term.surface.clone(),
    };
    let mut all = vec![Distribution::new(first)?];
    for problem in &problems[1..] {
        let Ok(mut other) = Distribution::new(problem) else {
            continue;
        };
        other.mean += surface(problem) - surface(first);
        all.push(other);
    }
    let largest = all.iter().map(|one| one.log_evidence);
    let largest = largest.fold(f64::NEG_INFINITY, f64::max);
    let weight = |one: &Distribution| libm::exp(one.log_evidence - largest);
    let total: f64 = all.iter().map(weight).sum();
    let mut mean = DVector::zeros(size);
    for one in &all {
        mean.axpy(weight(one) / total, &one.mean, 1.0);
    }
    let mut covariance = DMatrix::zeros(size, size);
    for one in &all {
        let distance = &one.mean - &mean;
        covariance += &one.covariance * (weight(one) / total);
        covariance.ger(weight(one) / total, &distance, &distance, 1.0);
    }
    let mut numbers = covariance.iter().chain(&mean);
    match numbers.all(|number| number.is_finite()) {
        true => Ok(Posterior::new(
            first.square,
            first.degree,
            mean.as_slice(),
            &covariance,
        )),
        false => Err(Ep2Error::OutOfRange),
    }
}

impl Distribution {
    fn new(problem: &SeriesProblem) -> Result<Self, Ep2Error> {
        let Eliminated {
            quadrics,
            replaced,
            start,
            rest,
        } = Eliminated::new(problem)?;
        let mixture = rest.limited()?.mixture(problem.degree)?;

        let of_term = problem.square_term.as_ref();
        let (prior, std) = match of_term {
            Some(term) => (IMPLICIT_PROBABILITY, term.std),
            None => (1.0 - IMPLICIT_PROBABILITY, 1.0),
        };
        let of_quadric = -0.5 * quadrics.ln_determinant() - libm::log(std);
        let log_evidence = mixture.log_evidence + LIKELIHOOD_POWER * of_quadric + libm::log(prior);

        let carried = product(&replaced, &mixture.covariance);
        let mut low = quadrics.inverse() * mixture.scale;
        add_symmetric(&mut low, &carried, &replaced);
        let (fixed, rough) = replaced.shape();
        let mut covariance = DMatrix::from_fn(fixed + rough, fixed + rough, |row, column| {
            match (row.checked_sub(fixed), column.checked_sub(fixed)) {
                (None, None) => low[(row, column)],
                (None, Some(column)) => -carried[(row, column)],
                (Some(row), None) => -carried[(column, row)],
                (Some(row), Some(column)) => mixture.covariance[(row, column)],
            }
        });
        let change = start - replaced * &mixture.mean;
        let mut mean = DVector::zeros(UNKNOWNS + rough);
        mean.rows_mut(0, UNKNOWNS)
            .copy_from(&change.rows(0, UNKNOWNS));
        mean.rows_mut(UNKNOWNS, rough).copy_from(&mixture.mean);
        match of_term {
            None => {
                let quadric = problem.quadric.iter().zip(mean.iter_mut());
                quadric.for_each(|(quadric, mean)| *mean += quadric);
            }
            Some(term) => {
                // The surface is the implicit quadric z = Q + m z²/2 plus a series. The posterior contains only the
                // coefficients of Q and of the series. Therefore convert a change of m to the change of the series that
                // it causes: `term.derivative` per unit of m.
                let of_square = covariance.column(UNKNOWNS).remove_row(UNKNOWNS);
                let variance = covariance[(UNKNOWNS, UNKNOWNS)];
                let derivative = DVector::from_fn(UNKNOWNS + rough, |row, _| {
                    row.checked_sub(UNKNOWNS)
                        .map_or(0.0, |row| term.derivative[row])
                });
                covariance = covariance.remove_row(UNKNOWNS).remove_column(UNKNOWNS);
                covariance.ger(1.0, &derivative, &of_square, 1.0);
                covariance.ger(1.0, &of_square, &derivative, 1.0);
                covariance.ger(variance, &derivative, &derivative, 1.0);
                let mut products = mean.rows_mut(UNKNOWNS, rough);
                products.axpy(change[UNKNOWNS], &term.derivative, 1.0);
            }
        }
        Ok(Self {
            mean,
            covariance,
            log_evidence,
        })
    }
}

/// The normal equations after the unknowns of the quadric have been eliminated. The unknowns of the quadric are
/// `start` − `replaced` · c, where c contains the coefficients of the roughness. `rest` contains the equations for c.
struct Eliminated {
    quadrics: Cholesky<f64, Dyn>,
    /// For each product of Chebyshev polynomials in the roughness, the coefficients of the quadric that fits this
    /// product best.
    replaced: DMatrix<f64>,
    /// Coefficients of the quadric that fits the contacts best if the surface has no roughness.
    start: DVector<f64>,
    rest: Rest,
}

impl Eliminated {
    fn new(problem: &SeriesProblem<'_>) -> Result<Self, Ep2Error> {
        let (gram, right) = (&problem.equations.gram, &problem.equations.right);
        let rough = count(problem.degree) - UNKNOWNS;
        let part = |row: usize, column: usize, rows: usize, columns: usize| {
            gram.view((row, column), (rows, columns)).into_owned()
        };
        let mut quadrics = part(0, 0, UNKNOWNS, UNKNOWNS);
        let mut cross = part(0, UNKNOWNS, UNKNOWNS, rough);
        let mut own = right.rows(0, UNKNOWNS).into_owned();
        let mut square_sum = problem.equations.square;
        if let Some(term) = &problem.square_term {
            let products = gram.columns(UNKNOWNS, rough) * &term.derivative;
            let rest = products.rows(UNKNOWNS, rough);
            let per_prior = (term.std * term.std).recip();
            let square = rest.dot(&term.derivative) + per_prior;
            quadrics = quadrics.resize(UNKNOWNS + 1, UNKNOWNS + 1, square);
            for place in 0..UNKNOWNS {
                quadrics[(place, UNKNOWNS)] = products[place];
                quadrics[(UNKNOWNS, place)] = products[place];
            }
            cross = cross.insert_row(UNKNOWNS, 0.0);
            cross.row_mut(UNKNOWNS).tr_copy_from(&rest);
            let value = right.rows(UNKNOWNS, rough).dot(&term.derivative);
            let value = value + term.shift * per_prior;
            square_sum += term.shift * term.shift * per_prior;
            own = own.insert_row(UNKNOWNS, value);
        }
        let quadrics = quadrics.cholesky().ok_or(Ep2Error::OutOfRange)?;
        let replaced = quadrics.solve(&cross);
        let start = quadrics.solve(&own);
        let mut left = part(UNKNOWNS, UNKNOWNS, rough, rough);
        add_symmetric(&mut left, &-cross.transpose(), &replaced.transpose());
        let rest = Rest {
            right: right.rows(UNKNOWNS, rough) - cross.tr_mul(&start),
            square: square_sum - own.dot(&start),
            gram: left,
            degrees: problem.observations as f64 - UNKNOWNS as f64,
            is_known: problem.is_known,
            expected_amplitude: problem.expected_amplitude(&problem.quadric),
        };
        Ok(Self {
            quadrics,
            replaced,
            start,
            rest,
        })
    }
}

/// The Gaussian process with the most probable correlation length. Its squared amplitude is the mean of the squared
/// amplitudes at this length, weighted by their probabilities.
///
/// Returns a matrix that maps independent factors of unit variance (columns) to coefficients (rows). The rows are all
/// products of polynomials except those of the quadrics.
///
/// # Errors
/// Errors of [`posterior`].
pub(super) fn likeliest_process(problem: &SeriesProblem<'_>) -> Result<DMatrix<f64>, Ep2Error> {
    let Eliminated { start, rest, .. } = Eliminated::new(problem)?;
    let quadric = std::array::from_fn(|place| problem.quadric[place] + start[place]);
    let rest = Rest {
        expected_amplitude: problem.expected_amplitude(&quadric),
        ..rest
    };
    let rest = rest.limited()?;
    let of_length = |length| {
        let candidates = Process::new(length, problem.degree, &rest).candidates(&rest);
        (length, candidates)
    };
    let all: Vec<(f64, Vec<Candidate>)> = lengths(problem.degree).map(of_length).collect();
    let most = max_log_probability(all.iter().flat_map(|(_, candidates)| candidates));
    let sums = all.iter().map(|(length, candidates)| {
        let shares = candidates.iter().map(|one| {
            let share = libm::exp(one.log_probability - most);
            Vector2::new(share, share * one.square_amplitude)
        });
        (*length, shares.sum::<Vector2<f64>>())
    });
    let likeliest = sums.max_by(|(_, one), (_, other)| one.x.total_cmp(&other.x));
    let (length, sum) = likeliest.ok_or(Ep2Error::OutOfRange)?;
    let mut process =
        gaussian_process::factors(length, problem.degree).matrix() * (sum.y / sum.x).sqrt();
    if let Some(term) = &problem.square_term {
        process = process.insert_column(0, 0.0);
        process.set_column(0, &(&term.derivative * term.std));
    }
    Ok(process)
}

fn max_log_probability<'a>(candidates: impl Iterator<Item = &'a Candidate>) -> f64 {
    candidates.fold(f64::NEG_INFINITY, |most, one| most.max(one.log_probability))
}

/// Averages over all correlation lengths and amplitudes of the roughness. Three values are averaged: the mean and the
/// covariance of the coefficients of the roughness, and the factor by which the assumed variances are multiplied.
struct Mixture {
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    scale: f64,
    /// Logarithm of the sum of the probabilities of all lengths and amplitudes.
    log_evidence: f64,
}

impl Rest {
    /// Returns these equations. If the ratio of their information to the prior's information exceeds
    /// [`MAX_INFORMATION`], the variances of the contacts are increased until the ratio equals this limit.
    fn limited(self) -> Result<Self, Ep2Error> {
        let amplitude = self.expected_amplitude;
        let information = self.gram.trace() * amplitude * amplitude;
        let per_factor = 1.0 / (information / MAX_INFORMATION).max(1.0);
        let rest = Self {
            gram: self.gram * per_factor,
            right: self.right * per_factor,
            square: (self.square * per_factor).max(f64::MIN_POSITIVE),
            ..self
        };
        let numbers = rest.gram.iter().chain(&rest.right);
        let is_finite = numbers
            .chain([&rest.square, &information])
            .all(|number| number.is_finite());
        match is_finite {
            true => Ok(rest),
            false => Err(Ep2Error::OutOfRange),
        }
    }

    fn mixture(&self, degree: usize) -> Result<Mixture, Ep2Error> {
        let processes: Vec<Process> = lengths(degree)
            .map(|length| Process::new(length, degree, self))
            .collect();
        let candidates: Vec<Vec<Candidate>> = processes
            .iter()
            .map(|process| process.candidates(self))
            .collect();
        let most = max_log_probability(candidates.iter().flatten());
        let weight = |one: &Candidate| libm::exp(one.log_probability - most);
        let total: f64 = candidates.iter().flatten().map(weight).sum();

        let rough = self.right.len();
        let mut means = Vec::new();
        let mut covariance = DMatrix::zeros(rough, rough);
        let mut scale = 0.0;
        for (process, candidates) in processes.iter().zip(&candidates) {
            let likely: Vec<(f64, &Candidate)> = candidates
                .iter()
                .filter(|one| one.log_probability - most > MIN_LOG_PROBABILITY)
                .map(|one| (weight(one) / total, one))
                .collect();
            if likely.is_empty() {
                continue;
            }
            scale += likely
                .iter()
                .map(|(share, one)| share * one.scale)
                .sum::<f64>();
            let (share, mean, spread) = process.mixture(&likely);
            means.push((share, &process.modes * DVector::from_vec(mean)));
            add_symmetric(
                &mut covariance,
                &product(&process.modes, &spread),
                &process.modes,
            );
        }
        if means.is_empty() {
            return Err(Ep2Error::OutOfRange);
        }
        let shares: f64 = means.iter().map(|(share, _)| share).sum();
        let mut mean = DVector::zeros(rough);
        for (share, one) in &means {
            mean.axpy(share / shares, one, 1.0);
        }
        let distances: Vec<DVector<f64>> = means
            .iter()
            .map(|(share, one)| (one - &mean) * share.sqrt())
            .collect();
        let distances = DMatrix::from_columns(&distances);
        add_symmetric(&mut covariance, &distances, &distances);
        Ok(Mixture {
            mean,
            covariance,
            scale,
            log_evidence: most + libm::log(total),
        })
    }
}

/// Correlation lengths that are tried, from the largest to the smallest that a series of the degree `degree` can
/// represent.
fn lengths(degree: usize) -> impl Iterator<Item = f64> {
    let whole = libm::log(MAX_LENGTH * degree as f64 / MIN_LENGTH_TIMES_DEGREE);
    let steps = (whole / libm::log(MAX_LENGTH_RATIO) - 1e-9).ceil().max(1.0);
    (0..=steps as usize).map(move |step| MAX_LENGTH * libm::exp(-whole * step as f64 / steps))
}

impl Process {
    fn new(length: f64, degree: usize, rest: &Rest) -> Self {
        let factors = gaussian_process::factors(length, degree);
        let half = factors.apply_to_rows(&rest.gram);
        let (information, turn) = Tridiagonal::of(factors.apply_to_rows(&half.transpose()));
        let modes = factors
            .transposed()
            .apply_to_rows(&turn.transpose())
            .transpose();
        let right = modes.tr_mul(&rest.right);
        Self {
            log_length: libm::log(length / EXPECTED_LENGTH),
            modes,
            information,
            right: right.as_slice().to_vec(),
        }
    }

    fn candidates(&self, rest: &Rest) -> Vec<Candidate> {
        (-AMPLITUDE_STEPS..=AMPLITUDE_STEPS)
            .map(|step| self.candidate(f64::from(step) * LOG_AMPLITUDE_STEP, rest))
            .collect()
    }

    fn candidate(&self, log_ratio: f64, rest: &Rest) -> Candidate {
        let amplitude = rest.expected_amplitude * libm::exp(log_ratio);
        let square_amplitude = amplitude * amplitude;
        let factors = self.information.factors(square_amplitude);
        let mut mean: Vec<f64> = self
            .right
            .iter()
            .map(|right| square_amplitude * right)
            .collect();
        factors.solve(&mut mean);
        let explained: f64 = mean
            .iter()
            .zip(&self.right)
            .map(|(mean, right)| mean * right)
            .sum();
        let least = f64::EPSILON * f64::EPSILON * rest.square + f64::MIN_POSITIVE;
        let square = (rest.square - explained).max(least);
        let (misfit, scale) = if rest.is_known {
            (square, 1.0)
        } else {
            // If the noise is not stated, all variances have an unknown common factor. `misfit` is −2 ln(likelihood)
            // with the most probable factor, and `scale` is the posterior mean of the factor.
            (
                rest.degrees * libm::log(square),
                square / (rest.degrees - 2.0).max(1.0),
            )
        };
        Candidate {
            square_amplitude,
            log_probability: -0.5 * LIKELIHOOD_POWER * (misfit + factors.log_determinant())
                - log_cosh(AMPLITUDE_POWER * log_ratio)
                - log_cosh(LENGTH_POWER * self.log_length),
            factors,
            mean,
            scale,
        }
    }

    /// Averages over Gaussian processes with different amplitudes. `likely` contains these candidates, each with its
    /// probability. Returns three results: the sum of the probabilities, the mean of the random factors of the modes,
    /// and the covariance of these factors, multiplied by the sum of the probabilities.
    fn mixture(&self, likely: &[(f64, &Candidate)]) -> (f64, Vec<f64>, DMatrix<f64>) {
        let size = self.right.len();
        let total: f64 = likely.iter().map(|(share, _)| share).sum();
        let mut mean = vec![0.0; size];
        let mut spread = DMatrix::zeros(size, size);
        for (share, one) in likely {
            for (sum, part) in mean.iter_mut().zip(&one.mean) {
                *sum += share / total * part;
            }
            let factor = share * one.scale * one.square_amplitude;
            one.factors.add_inverse(&mut spread, factor);
        }
        let distances = DMatrix::from_fn(size, likely.len(), |row, column| {
            let (share, one) = likely[column];
            share.sqrt() * (one.mean[row] - mean[row])
        });
        add_symmetric(&mut spread, &distances, &distances);
        (total, mean, spread)
    }
}

fn log_cosh(x: f64) -> f64 {
    x.abs() + libm::log1p(libm::exp(-2.0 * x.abs())) - LN_2
}
