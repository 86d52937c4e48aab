//! Misfit of rolls: goodness of fit, and rolls that contradict the others.
//!
//! The residuals `Δp − B g` have the covariance `σ_p² I + σ_g² B Bᵀ`, from the noise of shifts and rotations. Weighted least
//! squares remove the part that a change of `B` explains, so the sum of squares follows a chi-squared distribution. Over pads,
//! all probes share the rounding of the first contact, which is fitted too, as uniform over a pad.

use nalgebra::{DMatrix, DVector, Matrix2, SMatrix, SVector, Vector2};
use palpate_statistics::{Explained, GoodnessOfFit, LEFT, Misfit, StatedQuantity};

use crate::{Estimate, ProbeReading, ReadingNoise};

/// Number of entries of `B`, and the same with the common shift of all probes over pads.
const MOBILITY_ENTRIES: usize = 3;
const UNKNOWNS: usize = 5;
/// Smallest estimated noise, relative to the longest shift, that is not a rounding error.
const MIN_NOISE: f64 = 1e-3;
/// Smallest share of an unknown or of noise in a direction that is not a rounding error.
const SINGULAR: f64 = 1e-10;
/// Significance level of a poor fit. At 0.005, four probes, which leave five degrees of freedom, would often miss a noise three
/// times the stated one.
const POOR_FIT_LEVEL: f64 = 0.02;
/// Significance level at which residuals are too small for the stated noise, and smallest ratio of both that is reported.
const SMALL_RESIDUALS_LEVEL: f64 = 3e-5;
const MIN_NOISE_RATIO: f64 = 4.0;

type Unknowns = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type Slopes = SMatrix<f64, 2, UNKNOWNS>;

impl Estimate {
    /// Goodness of fit of this estimate to its readings; `None` if no noise is stated. For pads the p-value is
    /// rather too large, because their errors are not independent. Takes time in proportion to the number of probes.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use palpate_ep1::{LeastSquares, Misfit, ProbeReading, ReadingNoise};
    ///
    /// // Eight probes of radius 2 on a plane. The stated noise of the shifts is 0.01, and one shift is wrong by 0.1.
    /// let readings: Vec<ProbeReading> = (0..8)
    ///     .map(|probe| {
    ///         let (sine, cosine) = libm::sincos(f64::from(probe) * std::f64::consts::FRAC_PI_4);
    ///         let wrong = if probe == 5 { 0.1 } else { 0.0 };
    ///         ProbeReading {
    ///             rotation: Vector2::new(0.1 * sine, -0.1 * cosine),
    ///             shift: Vector2::new(0.2 * cosine + wrong, 0.2 * sine),
    ///         }
    ///     })
    ///     .collect();
    /// let noise = ReadingNoise { shift_std: 0.01, ..ReadingNoise::default() };
    /// let estimate = LeastSquares::of(2.0, noise, &readings)?;
    /// let goodness = estimate.goodness(noise, &readings).ok_or("noise is stated")?;
    /// assert!(goodness.freedom == 13 && goodness.p_value < 1e-8);
    /// let misfits = estimate.misfits(noise, &readings);
    /// assert!(misfits.iter().any(|misfit| matches!(misfit, Misfit::Outlier { reading: 5, .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn goodness(
        &self,
        noise: ReadingNoise,
        readings: &[ProbeReading],
    ) -> Option<GoodnessOfFit> {
        let is_stated = noise.is_stated();
        is_stated.then(|| Refit::new(noise, self, readings).map(|refit| refit.goodness()))?
    }

    /// Ways in which the readings contradict the model. Without a stated noise, only an outlier can be found.
    ///
    /// A wrong gain of all shifts or rotations, or a wrong radius of the probe, causes no misfit: no reading distinguishes it
    /// from another curvature.
    pub fn misfits(&self, noise: ReadingNoise, readings: &[ProbeReading]) -> Vec<Misfit> {
        let (residual, _) = self.residual(readings);
        let longest = readings.iter().map(|reading| reading.shift.norm());
        let longest = longest.fold(0.0, f64::max);
        let is_stated = noise.is_stated();
        if !is_stated && residual <= MIN_NOISE * longest {
            return Vec::new();
        }
        let tested = match is_stated {
            true => noise,
            // Residuals are then compared with each other, so that any size will do.
            false => ReadingNoise {
                shift_std: residual,
                ..noise
            },
        };
        let Some(refit) = Refit::new(tested, self, readings) else {
            return Vec::new();
        };
        let goodness = is_stated.then(|| refit.goodness());
        let poor_fit = goodness.and_then(|goodness| Misfit::poor_fit(goodness, POOR_FIT_LEVEL));
        let small = goodness.and_then(|goodness| small_residuals(&noise, residual, goodness));
        let all = [poor_fit, refit.outlier(is_stated), small];
        all.into_iter().flatten().collect()
    }
}

/// Reports a stated noise of shifts that is far larger than the residuals. Pads are not tested: their errors may all be equal
/// or zero.
fn small_residuals(noise: &ReadingNoise, residual: f64, goodness: GoodnessOfFit) -> Option<Misfit> {
    let stated = noise.shift_std;
    let p_value = 1.0 - goodness.p_value;
    let is_tested = goodness.freedom > 0 && noise.shift_resolution == 0.0;
    let is_small = p_value < SMALL_RESIDUALS_LEVEL && MIN_NOISE_RATIO * residual < stated;
    (is_tested && is_small).then_some(Misfit::Stated {
        quantity: StatedQuantity::Noise,
        stated,
        estimated: residual,
        p_value,
    })
}

/// Weighted least squares around an estimate.
struct Refit<'r> {
    noise: ReadingNoise,
    estimate: &'r Estimate,
    readings: &'r [ProbeReading],
    /// Longest rotation, and smallest noise of a residual over the radius: units of the slopes.
    units: [f64; 2],
    covariance: Unknowns,
    /// Change of the unknowns that makes chi-squared smallest.
    change: SVector<f64, UNKNOWNS>,
    chi_squared: f64,
    freedom: usize,
}

impl<'r> Refit<'r> {
    /// `None` if the readings with noise do not determine the unknowns.
    fn new(
        noise: ReadingNoise,
        estimate: &'r Estimate,
        readings: &'r [ProbeReading],
    ) -> Option<Self> {
        let turned = readings.iter().map(|reading| reading.rotation.norm());
        let sizes = readings
            .iter()
            .map(|reading| noise_sizes(&noise, estimate, reading));
        let sizes = sizes.map(|[of_shift, of_rotation]| of_shift.max(of_rotation));
        let least = sizes
            .filter(|size| *size > 0.0)
            .fold(f64::INFINITY, f64::min);
        let mut refit = Self {
            noise,
            estimate,
            readings,
            units: [turned.fold(0.0, f64::max), least],
            covariance: Unknowns::zeros(),
            change: SVector::zeros(),
            chi_squared: 0.0,
            freedom: 0,
        };
        // The rounding of the first contact is uniform over a pad. Without pads there is none.
        let start = noise.shift_resolution * estimate.probe_curvature / (12.0_f64.sqrt() * least);
        let per_start = start.max(SINGULAR).powi(-2);
        let mut information = Unknowns::zeros();
        for common in MOBILITY_ENTRIES..UNKNOWNS {
            information[(common, common)] = per_start;
        }
        let mut gradient = SVector::<f64, UNKNOWNS>::zeros();
        let (mut square, mut probes) = (0.0, 0_usize);
        for (_, residual, slopes) in refit.weighted() {
            information += slopes.tr_mul(&slopes);
            gradient += slopes.tr_mul(&residual);
            square += residual.norm_squared();
            probes += 1;
        }
        let root = information.cholesky()?;
        if root.l_dirty().diagonal().min() < SINGULAR {
            return None;
        }
        refit.covariance = root.inverse();
        refit.change = refit.covariance * gradient;
        refit.freedom = (2 * probes).saturating_sub(MOBILITY_ENTRIES);
        let chi_squared: f64 = square - gradient.dot(&refit.change);
        refit.chi_squared = match chi_squared.is_finite() {
            true => chi_squared.max(0.0),
            // Residuals of this many standard deviations overflow.
            false => f64::INFINITY,
        };
        Some(refit)
    }

    fn goodness(&self) -> GoodnessOfFit {
        GoodnessOfFit::new(self.chi_squared, self.freedom)
    }

    /// Residuals and slopes in standard deviations, with the numbers of their probes. Probes without noise in some direction,
    /// for example one that did not turn, are left out.
    fn weighted(&self) -> impl Iterator<Item = (usize, Vector2<f64>, Slopes)> {
        let [turned, least] = self.units;
        let mobility = self.estimate.mobility * self.estimate.probe_curvature;
        let shape = mobility / mobility.amax();
        let product = shape * shape.transpose();
        let weighted = move |(probe, reading): (usize, &ProbeReading)| {
            let sizes = noise_sizes(&self.noise, self.estimate, reading);
            let size = sizes[0].max(sizes[1]);
            let [of_shift, of_rotation] = sizes.map(|part| (part / size) * (part / size));
            let covariance = Matrix2::identity() * of_shift + product * of_rotation;
            let root = covariance.cholesky()?.unpack();
            let drive = Vector2::new(-reading.rotation.y, reading.rotation.x);
            let residual = reading.shift * self.estimate.probe_curvature - mobility * drive;
            let [g, h] = (drive / turned).into();
            let slopes = Slopes::new(g, 0.0, h, 1.0, 0.0, 0.0, h, g, 0.0, 1.0) * (least / size);
            let residual = root.solve_lower_triangular(&(residual / size))?;
            let slopes = root.solve_lower_triangular(&slopes)?;
            let is_noisy = root[(0, 0)].min(root[(1, 1)]) > SINGULAR;
            (is_noisy && (least / size).is_finite()).then_some((probe, residual, slopes))
        };
        self.readings.iter().enumerate().filter_map(weighted)
    }

    /// The roll that contradicts the others. Its residual is compared with the stated noise if that explains the other rolls,
    /// otherwise with their residuals.
    fn outlier(&self, is_noise_stated: bool) -> Option<Misfit> {
        if !self.chi_squared.is_finite() {
            return None;
        }
        Misfit::outlier(self.weighted().map(|(probe, residual, slopes)| {
            let residual = residual - slopes * self.change;
            let left = Matrix2::identity() - slopes * self.covariance * slopes.transpose();
            let left = DMatrix::from_column_slice(2, 2, left.as_slice());
            let residual = DVector::from_column_slice(residual.as_slice());
            let explained = Explained::by(&[1.0; 2], &left, &residual, LEFT);
            let others = GoodnessOfFit::new(
                (self.chi_squared - explained.fall).max(0.0),
                self.freedom.saturating_sub(explained.freedom),
            );
            let p_value = match is_noise_stated && !others.is_poor() {
                true => explained.p_value(),
                false => explained.p_value_beside(self.chi_squared, self.freedom),
            };
            (probe, p_value)
        }))
    }
}

/// Standard deviations over the radius that the noise of a shift and of a rotation cause in a residual, the second in the
/// direction in which `B` is largest.
fn noise_sizes(noise: &ReadingNoise, estimate: &Estimate, reading: &ProbeReading) -> [f64; 2] {
    let turned = reading.rotation.norm();
    let rotation_std = libm::hypot(noise.relative_rotation_std * turned, noise.rotation_std_rad);
    let largest = estimate.mobility.amax() * estimate.probe_curvature;
    [
        noise.shift_std * estimate.probe_curvature,
        rotation_std * largest,
    ]
}
