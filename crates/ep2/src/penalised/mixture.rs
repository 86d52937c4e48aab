//! Uncertainty of a surface that the contacts leave, over all lengths and amplitudes of its roughness.

use std::f64::consts::LN_2;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector2};

use super::process;
use super::product::{add_symmetric, product};
use super::series::SeriesEquations;
use super::tridiagonal::{Factors, Tridiagonal};
use crate::chebyshev::count;
use crate::square::Square;
use crate::square_quadric::{UNKNOWNS, bend};
use crate::{Ep2Error, Posterior};

/// The longest length of roughness, in half sides of the square: beyond, a cubic is left.
const LONGEST: f64 = 3.0;
/// The shortest length that a series follows, times its degree.
const SHORTEST: f64 = 6.0;
/// Largest factor between neighbouring lengths.
const NEIGHBOURS: f64 = 3.0;
/// The length that is most probable before the contacts are seen, and the power of it with which the probability falls
/// to either side.
const EXPECTED_LENGTH: f64 = 1.75;
const LENGTH_POWER: f64 = 2.0;
/// The most probable amplitude, relative to the second derivatives of the quadric, and the power of it.
const EXPECTED_AMPLITUDE: f64 = 0.75;
const AMPLITUDE_POWER: f64 = 4.0;
/// Amplitudes to either side of the expected one, and how far apart their logarithms are.
const STEPS: i32 = 6;
const STEP: f64 = 0.5;
/// Power of the likelihood of an amplitude and a length. A surface is no draw of such a process: its roughness differs
/// from place to place and by direction, so that the contacts tell less of it than they would of a draw.
const EVIDENCE: f64 = 0.5;
/// Logarithm of the smallest probability that counts, relative to the largest.
const NEGLIGIBLE: f64 = -7.0;
/// How much more the equations may tell than the prior of the expected amplitude: beyond, they are rounding.
const TOLD: f64 = 1e11;

/// Equations of a series around a quadric, and what goes with them.
pub(super) struct Given<'a> {
    pub(super) equations: &'a SeriesEquations,
    pub(super) degree: usize,
    /// Number of observations.
    pub(super) observations: usize,
    /// Whether the variances are known, not only their ratio.
    pub(super) is_known: bool,
    pub(super) square: Square,
    /// The quadric as a series.
    pub(super) quadric: [f64; UNKNOWNS],
}

/// The equations of the rough products where the quadrics are those that fit best beside them.
struct Rest {
    gram: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
    /// Number of equations that the quadrics leave.
    degrees: f64,
    is_known: bool,
    expected_amplitude: f64,
}

/// The rough part of the surface as a process of one length.
struct Process {
    log_length: f64,
    /// The rough products of the modes, one in each column, in which the equations are tridiagonal.
    modes: DMatrix<f64>,
    told: Tridiagonal,
    right: Vec<f64>,
}

/// A process of one amplitude.
struct Candidate {
    square_amplitude: f64,
    /// Factors of 1 + amplitude² × what is told.
    factors: Factors,
    /// Mean factors of the modes.
    mean: Vec<f64>,
    /// Factor of the assumed variances that explains the residuals; 1 where they are known.
    scale: f64,
    log_probability: f64,
}

/// The posterior of the surface.
///
/// The surface is a quadric, of which nothing is known beforehand, plus a process of which the length and the amplitude
/// are not known either: the posterior is the mixture of those of all lengths and amplitudes, each with its
/// probability.
///
/// # Errors
/// [`Ep2Error::OutOfRange`] where the equations do not determine the quadric.
pub(super) fn posterior(given: &Given) -> Result<Posterior, Ep2Error> {
    let Parted {
        quadrics,
        replaced,
        start,
        rest,
    } = Parted::of(given)?;
    let mixed = rest.blurred()?.mixed(given.degree);

    let carried = product(&replaced, &mixed.covariance);
    let mut low = quadrics.inverse() * mixed.scale;
    add_symmetric(&mut low, &carried, &replaced);
    let size = count(given.degree);
    let covariance = DMatrix::from_fn(size, size, |row, column| {
        match (row.checked_sub(UNKNOWNS), column.checked_sub(UNKNOWNS)) {
            (None, None) => low[(row, column)],
            (None, Some(column)) => -carried[(row, column)],
            (Some(row), None) => -carried[(column, row)],
            (Some(row), Some(column)) => mixed.covariance[(row, column)],
        }
    });
    let change = start - replaced * &mixed.mean;
    let quadric = given
        .quadric
        .iter()
        .zip(&change)
        .map(|(one, other)| one + other);
    let mean: Vec<f64> = quadric.chain(mixed.mean.iter().copied()).collect();
    let is_finite = covariance
        .iter()
        .chain(&mean)
        .all(|number| number.is_finite());
    if is_finite {
        Ok(Posterior::new(
            given.square,
            given.degree,
            &mean,
            &covariance,
        ))
    } else {
        Err(Ep2Error::OutOfRange)
    }
}

/// The equations, parted into those of the quadrics and of the rest.
struct Parted {
    quadrics: Cholesky<f64, Dyn>,
    /// How much of each quadric a rough product takes the place of.
    replaced: DMatrix<f64>,
    /// The quadrics without rough products.
    start: DVector<f64>,
    rest: Rest,
}

impl Parted {
    fn of(given: &Given<'_>) -> Result<Self, Ep2Error> {
        let (gram, right) = (&given.equations.gram, &given.equations.right);
        let rough = count(given.degree) - UNKNOWNS;
        let part = |row: usize, column: usize, rows: usize, columns: usize| {
            gram.view((row, column), (rows, columns)).into_owned()
        };
        let quadrics = part(0, 0, UNKNOWNS, UNKNOWNS);
        let quadrics = quadrics.cholesky().ok_or(Ep2Error::OutOfRange)?;
        let cross = part(0, UNKNOWNS, UNKNOWNS, rough);
        let own = right.rows(0, UNKNOWNS).into_owned();
        let replaced = quadrics.solve(&cross);
        let start = quadrics.solve(&own);
        let mut left = part(UNKNOWNS, UNKNOWNS, rough, rough);
        add_symmetric(&mut left, &-cross.transpose(), &replaced.transpose());
        let rest = Rest {
            right: right.rows(UNKNOWNS, rough) - cross.tr_mul(&start),
            square: given.equations.square - own.dot(&start),
            gram: left,
            degrees: given.observations as f64 - UNKNOWNS as f64,
            is_known: given.is_known,
            expected_amplitude: EXPECTED_AMPLITUDE * bend(&given.quadric),
        };
        Ok(Self {
            quadrics,
            replaced,
            start,
            rest,
        })
    }
}

/// Processes of each length, most probable first, with their probabilities; the square amplitude of
/// each is the mean there. A process is its coefficients behind the quadrics, a column for each independent factor of unit
/// variance.
///
/// # Errors
/// Errors of [`posterior`].
pub(super) fn likely(given: &Given<'_>) -> Result<Vec<(f64, DMatrix<f64>)>, Ep2Error> {
    let Parted { start, rest, .. } = Parted::of(given)?;
    let quadric = std::array::from_fn(|place| given.quadric[place] + start[place]);
    let rest = Rest {
        expected_amplitude: EXPECTED_AMPLITUDE * bend(&quadric),
        ..rest
    };
    let rest = rest.blurred()?;
    let of_length = |length| {
        let candidates = Process::of(length, given.degree, &rest).candidates(&rest);
        (length, candidates)
    };
    let all: Vec<(f64, Vec<Candidate>)> = lengths(given.degree).map(of_length).collect();
    let probabilities = all.iter().flat_map(|(_, candidates)| candidates);
    let most = probabilities
        .map(|one| one.log_probability)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut likely: Vec<(f64, f64, f64)> = Vec::new();
    for (length, candidates) in &all {
        let shares = candidates.iter().map(|one| {
            let share = libm::exp(one.log_probability - most);
            Vector2::new(share, share * one.square_amplitude)
        });
        let sums: Vector2<f64> = shares.sum();
        if sums.x > 0.0 {
            likely.push((sums.x, *length, sums.y / sums.x));
        }
    }
    likely.sort_by(|(one, ..), (other, ..)| other.total_cmp(one));
    let total: f64 = likely.iter().map(|(share, ..)| share).sum();
    let processes = likely.into_iter().map(|(share, length, square)| {
        let process = process::factors(length, given.degree).matrix();
        (share / total, process * square.sqrt())
    });
    Ok(processes.collect())
}

/// Mean and covariance of the rough products, and mean scale, over all candidates.
struct Mixed {
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    scale: f64,
}

impl Rest {
    /// Rest with variances that are large enough for the equations to tell no more than their rounding allows.
    fn blurred(self) -> Result<Self, Ep2Error> {
        let amplitude = self.expected_amplitude;
        let told = self.gram.trace() * amplitude * amplitude;
        let per_factor = 1.0 / (told / TOLD).max(1.0);
        let rest = Self {
            gram: self.gram * per_factor,
            right: self.right * per_factor,
            square: (self.square * per_factor).max(f64::MIN_POSITIVE),
            ..self
        };
        let numbers = rest.gram.iter().chain(&rest.right);
        let is_finite = numbers
            .chain([&rest.square, &told])
            .all(|number| number.is_finite());
        if is_finite {
            Ok(rest)
        } else {
            Err(Ep2Error::OutOfRange)
        }
    }

    fn mixed(&self, degree: usize) -> Mixed {
        let processes: Vec<Process> = lengths(degree)
            .map(|length| Process::of(length, degree, self))
            .collect();
        let candidates: Vec<Vec<Candidate>> = processes
            .iter()
            .map(|process| process.candidates(self))
            .collect();
        let of_all = |candidates: &[Candidate]| {
            let probabilities = candidates.iter().map(|one| one.log_probability);
            probabilities.fold(f64::NEG_INFINITY, f64::max)
        };
        let most = candidates
            .iter()
            .map(|some| of_all(some))
            .fold(f64::NEG_INFINITY, f64::max);
        let weight = |one: &Candidate| libm::exp(one.log_probability - most);
        let total: f64 = candidates.iter().flatten().map(weight).sum();

        let rough = self.right.len();
        let mut means = Vec::new();
        let mut covariance = DMatrix::zeros(rough, rough);
        let mut scale = 0.0;
        for (process, candidates) in processes.iter().zip(&candidates) {
            let likely: Vec<(f64, &Candidate)> = candidates
                .iter()
                .filter(|one| one.log_probability - most > NEGLIGIBLE)
                .map(|one| (weight(one) / total, one))
                .collect();
            if likely.is_empty() {
                continue;
            }
            scale += likely
                .iter()
                .map(|(share, one)| share * one.scale)
                .sum::<f64>();
            let (share, mean, spread) = process.mixed(&likely);
            means.push((share, &process.modes * DVector::from_vec(mean)));
            add_symmetric(
                &mut covariance,
                &product(&process.modes, &spread),
                &process.modes,
            );
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
        Mixed {
            mean,
            covariance,
            scale,
        }
    }
}

/// Lengths from the longest to the shortest that a series of a degree follows.
fn lengths(degree: usize) -> impl Iterator<Item = f64> {
    let whole = libm::log(LONGEST * degree as f64 / SHORTEST);
    let steps = (whole / libm::log(NEIGHBOURS) - 1e-9).ceil().max(1.0);
    (0..=steps as usize).map(move |step| LONGEST * libm::exp(-whole * step as f64 / steps))
}

impl Process {
    fn of(length: f64, degree: usize, rest: &Rest) -> Self {
        let factors = process::factors(length, degree);
        let half = factors.of_rows(&rest.gram);
        let (told, turn) = Tridiagonal::of(factors.of_rows(&half.transpose()));
        let modes = factors.transposed().of_rows(&turn.transpose()).transpose();
        let right = modes.tr_mul(&rest.right);
        Self {
            log_length: libm::log(length / EXPECTED_LENGTH),
            modes,
            told,
            right: right.as_slice().to_vec(),
        }
    }

    fn candidates(&self, rest: &Rest) -> Vec<Candidate> {
        let log_ratios = (-STEPS..=STEPS).map(|step| f64::from(step) * STEP);
        log_ratios
            .map(|log_ratio| self.candidate(log_ratio, rest))
            .collect()
    }

    fn candidate(&self, log_ratio: f64, rest: &Rest) -> Candidate {
        let amplitude = rest.expected_amplitude * libm::exp(log_ratio);
        let square_amplitude = amplitude * amplitude;
        let factors = self.told.factors(square_amplitude);
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
            // The likelihood of the best scale, and the mean of those that are possible.
            (
                rest.degrees * libm::log(square),
                square / (rest.degrees - 2.0).max(1.0),
            )
        };
        Candidate {
            square_amplitude,
            log_probability: -0.5 * EVIDENCE * (misfit + factors.log_determinant())
                - log_cosh(AMPLITUDE_POWER * log_ratio)
                - log_cosh(LENGTH_POWER * self.log_length),
            factors,
            mean,
            scale,
        }
    }

    /// Share, mean and spread of the modes' factors over candidates with their shares; the spread is as large
    /// as the share.
    fn mixed(&self, likely: &[(f64, &Candidate)]) -> (f64, Vec<f64>, DMatrix<f64>) {
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

/// Logarithm of the hyperbolic cosine.
fn log_cosh(x: f64) -> f64 {
    x.abs() + libm::log1p(libm::exp(-2.0 * x.abs())) - LN_2
}
