//! Tests of the least squares: do the readings contradict its model?
//!
//! The residuals `Δp − B g` have the covariance `σ_p² I + σ_g² B Bᵀ`, from the noise of shifts and rotations. Weighted least
//! squares remove the part that a change of `B` explains, so the sum of squares follows a chi-squared distribution. Rao's
//! score test computes how much it would fall if a pattern were fitted too.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, Matrix2, SMatrix, SVector, Vector2};
use palpate_statistics::{Explained, GoodnessOfFit, LEFT, doubted, least_likely};

use crate::{Doubt, Estimate, LeastSquares, ProbeReading, ReadingNoise};

/// Number of entries of `B`, and the same with the common part of all shifts, for pads that round the first contact.
const MOBILITY_ENTRIES: usize = 3;
const WITH_PADS: usize = 5;
/// Number of unknowns, including the patterns that do not change the curvature.
const UNKNOWNS: usize = WITH_PADS + EVEN;
/// Number of patterns. Their order is: common shift, squares, twist, third powers.
const PATTERNS: usize = 12;
/// Number of patterns that are equal for a roll and its reverse.
const EVEN: usize = 6;
const COMMON: Range<usize> = 0..2;
const SQUARES: Range<usize> = 2..6;
const TWIST: Range<usize> = 6..7;
const THIRD_POWERS: Range<usize> = 7..12;
/// Powers of the rotations in the patterns.
const DEGREES: [f64; PATTERNS] = [0.0, 0.0, 2.0, 2.0, 2.0, 2.0, 1.0, 3.0, 3.0, 3.0, 3.0, 3.0];
/// P-value of the remaining residuals above which they are noise.
const NOISE_P_VALUE: f64 = 0.1;
/// Significance level of a pattern if the stated noise is too small.
const PATTERN_LEVEL: f64 = 0.2;
/// Largest relative effect of squared rotations on a shift if an object's curvature varies, per angle by which its surface
/// turns along the roll.
const MAX_SQUARES: f64 = 0.5;
/// Relative effect of third powers of a rotation if the curvature varies, per square of that angle.
const THIRD_POWERS_OF_BEND: f64 = 1.0 / 16.0;
/// Smallest estimated noise, relative to the longest shift, that is not a rounding error.
const MIN_NOISE: f64 = 1e-3;
/// Smallest share of an unknown or of noise in a direction that is not a rounding error.
const SINGULAR: f64 = 1e-10;

type Unknowns = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type Slopes = SMatrix<f64, 2, UNKNOWNS>;
type Patterns = SMatrix<f64, 2, PATTERNS>;

/// Agreement of readings with the fit to them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Goodness of fit; `None` if no noise is stated. For pads the p-value is rather too large, because their errors are not
    /// independent.
    pub goodness: Option<GoodnessOfFit>,
    /// Ways in which the readings contradict the model; empty unless there are more equations than unknowns.
    pub doubts: Vec<Doubt>,
}

/// Reading of a probe in standard deviations of its noise.
struct Weighted {
    residual: Vector2<f64>,
    /// Square of the whole shift.
    signal: f64,
    /// Square of the angle that the object's surface turns by along the roll.
    bend: f64,
    slopes: Slopes,
    patterns: Patterns,
}

/// Sums over probes of products of patterns.
struct Products {
    /// Products of each with itself.
    squares: Vec<f64>,
    /// With each other, after the unknowns have taken of them what they can.
    left: DMatrix<f64>,
    by_slopes: DMatrix<f64>,
    by_residuals: DVector<f64>,
    /// Share of a pattern that must be left for it to be looked for.
    least: f64,
}

impl Products {
    fn explained(&self) -> Explained {
        Explained::by(&self.squares, &self.left, &self.by_residuals, self.least)
    }
}

/// A fit with all that its tests ask for.
struct Test {
    probes: Vec<(usize, Weighted)>,
    covariance: Unknowns,
    is_noise_told: bool,
    has_pads: bool,
    /// Mean square of the rotations' noise over that of the rotations.
    rotation_noise: f64,
    chi_squared: f64,
    freedom: usize,
    /// Whether patterns are judged by the stated noise: it explains the residuals.
    is_noise_trusted: bool,
}

impl LeastSquares {
    /// Goodness of fit of an estimate that this fit made of the readings, and the ways in which they contradict the model.
    /// Takes time in proportion to the number of probes.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use palpate_ep1::{LeastSquares, ProbeReading, ReadingNoise};
    ///
    /// // Four probes of radius 2 on a plane; the shifts are told to err by 0.01, and one errs by 0.1.
    /// let readings = [[0.0, -0.1], [0.1, 0.0], [0.0, 0.1], [-0.1, 0.0]].map(|[x, y]| ProbeReading {
    ///     rotation: Vector2::new(x, y),
    ///     shift: Vector2::new(-2.0 * y, 2.0 * x + if x > 0.0 { 0.1 } else { 0.0 }),
    /// });
    /// let noise = ReadingNoise { shift_std: 0.01, ..ReadingNoise::default() };
    /// let (fit, estimate) = LeastSquares::fitted(2.0, noise, &readings)?;
    /// let goodness = fit.agreement(&estimate, &readings).goodness.ok_or("noise is stated")?;
    /// assert!(goodness.freedom == 5 && goodness.p_value < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn agreement(&self, estimate: &Estimate, readings: &[ProbeReading]) -> Agreement {
        let test = Test::new(self, estimate, readings);
        test.map(|test| test.agreement()).unwrap_or_default()
    }
}

impl Test {
    /// The tests of a fit; `None` where nothing can be tested.
    fn new(fit: &LeastSquares, estimate: &Estimate, readings: &[ProbeReading]) -> Option<Self> {
        let noise = fit.noise();
        let is_noise_told = noise.is_stated();
        let has_pads = noise.shift_resolution > 0.0;
        let (residual, _) = estimate.residual(readings);
        let noise = match is_noise_told {
            true => noise,
            // Any size does where the noise is found.
            false => ReadingNoise {
                shift_std: residual,
                ..noise
            },
        };
        let longest =
            |part: fn(&ProbeReading) -> f64| readings.iter().map(part).fold(0.0, f64::max);
        let turned = longest(|reading| reading.rotation.norm());
        if !is_noise_told && residual <= MIN_NOISE * longest(|reading| reading.shift.norm()) {
            return None;
        }
        let sizes = readings
            .iter()
            .map(|reading| size(&noise, estimate, reading));
        let least = sizes
            .filter(|size| *size > 0.0)
            .fold(f64::INFINITY, f64::min);
        let weigh = |reading| Weighted::new(&noise, estimate, reading, [turned, least]);
        let weighted = readings.iter().map(weigh).enumerate();
        let mut probes: Vec<(usize, Weighted)> = weighted
            .filter_map(|(probe, weighted)| Some((probe, weighted?)))
            .collect();
        let mut normal = Unknowns::zeros();
        let mut along = SVector::<f64, UNKNOWNS>::zeros();
        for (_, weighted) in &mut probes {
            if !has_pads {
                weighted
                    .slopes
                    .fixed_columns_mut::<2>(MOBILITY_ENTRIES)
                    .fill(0.0);
            }
            normal += weighted.slopes.tr_mul(&weighted.slopes);
            along += weighted.slopes.tr_mul(&weighted.residual);
        }
        // What rounding of the first contact shifts all probes by is uniform over a pad.
        let start = noise.shift_resolution * estimate.probe_curvature / (12.0_f64.sqrt() * least);
        let per_start = if has_pads { start.powi(-2) } else { 0.0 };
        for common in MOBILITY_ENTRIES..WITH_PADS {
            normal[(common, common)] += per_start;
        }
        let covariance = inverse(normal)?;
        let change = covariance * along;
        for (_, weighted) in &mut probes {
            weighted.residual -= weighted.slopes * change;
        }
        let squares = probes
            .iter()
            .map(|(_, weighted)| weighted.residual.norm_squared());
        let square = |number: f64| number * number;
        let turns = readings
            .iter()
            .map(|reading| square(reading.rotation.norm() / turned));
        let mean = turns.sum::<f64>() / readings.len() as f64;
        let of_start = change.fixed_rows::<2>(MOBILITY_ENTRIES).norm_squared() * per_start;
        let chi_squared = squares.sum::<f64>() + of_start;
        let freedom = (2 * probes.len()).saturating_sub(MOBILITY_ENTRIES);
        let goodness = GoodnessOfFit::new(chi_squared, freedom);
        Some(Self {
            rotation_noise: square(noise.relative_rotation_std)
                + square(noise.rotation_std_rad / turned) / mean,
            chi_squared,
            freedom,
            probes,
            covariance,
            is_noise_told,
            has_pads,
            is_noise_trusted: is_noise_told && !goodness.is_doubted(),
        })
    }

    fn agreement(mut self) -> Agreement {
        let goodness = self.goodness();
        if self.freedom == 0 || !self.chi_squared.is_finite() {
            let large = self.large();
            let is_large = large.p_value() < Doubt::LEVEL;
            return Agreement {
                goodness,
                doubts: is_large.then_some(large).into_iter().collect(),
            };
        }
        let of_powers = self.of_squares().min(self.pattern(THIRD_POWERS));
        let (probe, slipped) = self.slipped();
        let doubts = [
            Doubt::CommonShift {
                p_value: self.pattern(COMMON),
            },
            Doubt::Twist {
                p_value: self.pattern(TWIST),
            },
            Doubt::VaryingCurvature {
                p_value: (2.0 * of_powers).min(1.0),
            },
            Doubt::SlippedProbe {
                probe,
                p_value: slipped,
            },
            self.large(),
        ];
        let by_all = self.pattern(0..PATTERNS);
        Agreement {
            goodness,
            doubts: doubted(&doubts, Doubt::p_value, 3, by_all),
        }
    }

    /// Goodness of fit of what was not put aside.
    fn goodness(&self) -> Option<GoodnessOfFit> {
        let goodness = GoodnessOfFit::new(self.chi_squared, self.freedom);
        self.is_noise_told.then_some(goodness)
    }

    fn large(&self) -> Doubt {
        Doubt::LargeResiduals {
            p_value: self.goodness().map_or(1.0, |goodness| goodness.p_value),
        }
    }

    /// Probability by chance of as much of the squares as the residuals have. Where the probes roll as far to as fro, those and
    /// a common shift change no curvature, and are put aside; they then count where they have consequences.
    fn of_squares(&mut self) -> f64 {
        let alone = self.pattern(SQUARES);
        let [common, even] = [COMMON, 0..EVEN].map(|range| self.products(range).explained());
        let (chi_squared, freedom) = (self.chi_squared, self.freedom);
        if !self.put_aside(even) {
            return alone;
        }
        // A common shift looks like squares of rolls that are as far in all directions.
        match self.is_consequential(even.fall - common.fall) {
            true if self.is_noise_told => even.p_value(),
            true => even.p_value_beside(chi_squared, freedom),
            false => 1.0,
        }
    }

    /// Takes patterns that are the same of a roll to and fro out of the residuals, where the probes roll as far to as fro, so
    /// that they change no curvature, and where they alone are large, but not larger than an object's curvature may vary. Tells
    /// whether that is so.
    fn put_aside(&mut self, explained: Explained) -> bool {
        let products = self.products(0..EVEN);
        let is_taken = |(place, square): (usize, &f64)| {
            square - products.left[(place, place)] > products.least * square
        };
        let left = GoodnessOfFit::new(
            (self.chi_squared - explained.fall).max(0.0),
            self.freedom.saturating_sub(explained.freedom),
        );
        // Where the others are too large as well, all are of one cause.
        let beside = explained.p_value_beside(self.chi_squared, self.freedom);
        let is_large = beside < PATTERN_LEVEL && left.p_value > NOISE_P_VALUE;
        let is_alone = !self.is_noise_told || is_large || beside < Doubt::LEVEL;
        let is_balanced = !products.squares.iter().enumerate().any(is_taken);
        let most = MAX_SQUARES * MAX_SQUARES * self.sum(|weighted| weighted.signal * weighted.bend);
        if self.has_pads || !is_balanced || !is_alone || explained.fall > most {
            return false;
        }
        let size = |place: usize| match products.squares[place] > 0.0 {
            true => products.squares[place].sqrt().recip(),
            false => 0.0,
        };
        let scaled = DMatrix::from_fn(EVEN, EVEN, |row, column| {
            products.left[(row, column)] * size(row) * size(column)
        });
        let eigen = scaled.symmetric_eigen();
        let mut directions = SMatrix::<f64, EVEN, EVEN>::zeros();
        for (index, &value) in eigen.eigenvalues.iter().enumerate() {
            if value > products.least {
                let column = eigen.eigenvectors.column(index) / value.sqrt();
                directions.set_column(
                    index,
                    &column.map_with_location(|row, _, entry| entry * size(row)),
                );
                self.covariance[(WITH_PADS + index, WITH_PADS + index)] = 1.0;
                self.freedom = self.freedom.saturating_sub(1);
            }
        }
        let taken = self.covariance * products.by_slopes;
        let mut along = SVector::<f64, EVEN>::zeros();
        for (_, weighted) in &mut self.probes {
            let own = weighted.patterns.fixed_columns::<EVEN>(0) - weighted.slopes * &taken;
            let own = own * directions;
            along += own.tr_mul(&weighted.residual);
            weighted
                .slopes
                .fixed_columns_mut::<EVEN>(WITH_PADS)
                .copy_from(&own);
        }
        for (_, weighted) in &mut self.probes {
            let own = weighted.slopes.fixed_columns::<EVEN>(WITH_PADS) * along;
            weighted.residual -= own;
        }
        self.chi_squared = (self.chi_squared - along.norm_squared()).max(0.0);
        // The stated noise explains the others.
        self.is_noise_trusted = self.is_noise_told;
        true
    }

    /// Whether squares of the rotations that explain this much make third powers likely that change the curvature by a standard
    /// deviation. Where the squares are the share ε of the shifts, third powers are about 2 ε² if the curvature changes evenly,
    /// and 16 ε² on an object that is touched anywhere within half its size from where it is symmetric: taken is half of
    /// that. Where it is touched near there, they follow from how far the roll goes round it.
    fn is_consequential(&self, squares: f64) -> bool {
        let signal = self.sum(|weighted| weighted.signal);
        let bent = self.sum(|weighted| weighted.signal * weighted.bend * weighted.bend);
        8.0 * squares >= signal.sqrt() || THIRD_POWERS_OF_BEND * bent.sqrt() >= 1.0
    }

    fn sum(&self, part: fn(&Weighted) -> f64) -> f64 {
        self.probes.iter().map(|(_, weighted)| part(weighted)).sum()
    }

    /// Probability by chance of as much of these patterns as the residuals have.
    fn pattern(&self, range: Range<usize>) -> f64 {
        self.chance(self.products(range).explained())
    }

    fn products(&self, range: Range<usize>) -> Products {
        let (first, count) = (range.start, range.len());
        let mut by_patterns = DMatrix::zeros(count, count);
        let mut by_slopes = DMatrix::zeros(UNKNOWNS, count);
        let mut by_residuals = DVector::zeros(count);
        for (_, weighted) in &self.probes {
            let patterns = weighted.patterns.columns(first, count);
            by_patterns += patterns.tr_mul(&patterns);
            by_slopes += weighted.slopes.tr_mul(&patterns);
            by_residuals += patterns.tr_mul(&weighted.residual);
        }
        // Patterns of powers of noisy rotations are noisy too, by as much as their powers, and go with the residuals.
        let noisy: f64 = DEGREES[range].iter().map(|degree| degree * degree).sum();
        Products {
            squares: by_patterns.diagonal().iter().copied().collect(),
            left: by_patterns - by_slopes.tr_mul(&(self.covariance * &by_slopes)),
            by_slopes,
            by_residuals,
            least: LEFT.max(2.0 * self.rotation_noise * noisy),
        }
    }

    fn chance(&self, explained: Explained) -> f64 {
        match self.is_noise_trusted {
            true => explained.p_value(),
            false => explained.p_value_beside(self.chi_squared, self.freedom),
        }
    }

    /// The probe that contradicts the others most, and the probability that chance makes one do as much.
    fn slipped(&self) -> (usize, f64) {
        least_likely(self.probes.iter().map(|(probe, weighted)| {
            let slopes = weighted.slopes;
            let left = Matrix2::identity() - slopes * self.covariance * slopes.transpose();
            let left = DMatrix::from_fn(2, 2, |row, column| left[(row, column)]);
            let residual = DVector::from_column_slice(weighted.residual.as_slice());
            let explained = Explained::by(&[1.0; 2], &left, &residual, LEFT);
            (*probe, self.chance(explained))
        }))
    }
}

/// Size of the noise of a residual over the radius: of shifts, or of rotations as they move the contact.
fn size(noise: &ReadingNoise, estimate: &Estimate, reading: &ProbeReading) -> f64 {
    let [of_shift, of_rotation] = sizes(noise, estimate, reading);
    of_shift.max(of_rotation)
}

/// Standard deviations over the radius that a shift's and a rotation's noise give to a residual, the second where `B` is
/// as large as its largest entry.
fn sizes(noise: &ReadingNoise, estimate: &Estimate, reading: &ProbeReading) -> [f64; 2] {
    let turned = reading.rotation.norm();
    let rotation_std = libm::hypot(noise.relative_rotation_std * turned, noise.rotation_std_rad);
    let largest = estimate.mobility().amax() * estimate.probe_curvature;
    [
        noise.shift_std * estimate.probe_curvature,
        rotation_std * largest,
    ]
}

impl Weighted {
    /// A reading in standard deviations, its slopes and patterns in units of the least noisy reading; `None` without noise
    /// in some direction, as of a probe that did not turn.
    fn new(
        noise: &ReadingNoise,
        estimate: &Estimate,
        reading: &ProbeReading,
        [turned, least]: [f64; 2],
    ) -> Option<Self> {
        let mobility = estimate.mobility() * estimate.probe_curvature;
        let shape = mobility / mobility.amax();
        let size = size(noise, estimate, reading);
        let [of_shift, of_rotation] = sizes(noise, estimate, reading).map(|part| part / size);
        let covariance = Matrix2::identity() * (of_shift * of_shift)
            + shape * shape.transpose() * (of_rotation * of_rotation);
        let root = covariance.cholesky()?.l();
        let is_told = root[(1, 1)] > SINGULAR && root[(0, 0)] > SINGULAR;
        let drive = Vector2::new(-reading.rotation.y, reading.rotation.x);
        let residual = reading.shift * estimate.probe_curvature - mobility * drive;
        let [g, h] = (drive / turned).into();
        let mut slopes = Slopes::zeros();
        slopes.set_column(0, &Vector2::new(g, 0.0));
        slopes.set_column(1, &Vector2::new(0.0, h));
        slopes.set_column(2, &Vector2::new(h, g));
        slopes.set_column(3, &Vector2::x());
        slopes.set_column(4, &Vector2::y());
        let moved = shape * Vector2::new(g, h);
        let patterns = patterns(&Vector2::new(g, h), &moved, &shape);
        let weight = least / size;
        let signal = root.solve_lower_triangular(&(mobility * drive / size))?;
        let weighted = Self {
            signal: signal.norm_squared(),
            bend: (estimate.curvature.matrix() * reading.shift).norm_squared(),
            residual: root.solve_lower_triangular(&(residual / size))?,
            slopes: root.solve_lower_triangular(&slopes)? * weight,
            patterns: root.solve_lower_triangular(&patterns)? * weight,
        };
        (is_told && weight.is_finite()).then_some(weighted)
    }
}

/// Shifts of each pattern, of a probe with the drive `g` that moves by about `s`.
///
/// Along a roll the curvature changes as the gradient of a cubic form does (Codazzi), to second order as that of a quartic
/// form; `B` makes a shift of it.
fn patterns(g: &Vector2<f64>, s: &Vector2<f64>, mobility: &Matrix2<f64>) -> Patterns {
    let mut patterns = Patterns::zeros();
    patterns.set_column(0, &Vector2::x());
    patterns.set_column(1, &Vector2::y());
    patterns.set_column(TWIST.start, &Vector2::new(-g.y, g.x));
    let power = |base: f64, exponent: usize| (0..exponent).fold(1.0, |power, _| power * base);
    for (degree, mut column) in [(3, SQUARES.start), (4, THIRD_POWERS.start)] {
        for of_v in 0..=degree {
            let of_u = degree - of_v;
            let slope = |along: usize, own: f64, across: usize, other: f64| match along {
                0 => 0.0,
                _ => along as f64 * power(own, along - 1) * power(other, across),
            };
            let gradient = Vector2::new(slope(of_u, s.x, of_v, s.y), slope(of_v, s.y, of_u, s.x));
            patterns.set_column(column, &(mobility * gradient));
            column += 1;
        }
    }
    patterns
}

/// Inverse of the information of unknowns, of which those that are not sought have none; `None` where it is singular.
fn inverse(mut information: Unknowns) -> Option<Unknowns> {
    let scale = SVector::<f64, UNKNOWNS>::from_fn(|unknown, _| {
        match information[(unknown, unknown)] > 0.0 {
            true => information[(unknown, unknown)].sqrt().recip(),
            false => 0.0,
        }
    });
    for row in 0..UNKNOWNS {
        for column in 0..UNKNOWNS {
            information[(row, column)] *= scale[row] * scale[column];
        }
        if scale[row] == 0.0 {
            information[(row, row)] = 1.0;
        }
    }
    if !information.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let root = information.cholesky()?;
    if root.l().diagonal().min() < SINGULAR {
        return None;
    }
    let inverse = root.inverse();
    Some(Unknowns::from_fn(|row, column| {
        inverse[(row, column)] * scale[row] * scale[column]
    }))
}
