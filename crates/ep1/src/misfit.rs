//! Tests whether the readings contradict the model: goodness of fit of all rolls, and single rolls that contradict the
//! other rolls.
//!
//! The residual of a roll is `Δp − B g`. `Δp` is the shift, `B` the mobility of the contact (its travel per radian),
//! and `g` the rotation vector of the probe, turned by 90°. The covariance of the residual is `σ_p² I + σ_g² B Bᵀ`,
//! where σ_p and σ_g are the standard deviations of shifts and rotations. A weighted least-squares fit removes the part
//! of the residuals that a change of `B` explains. Then the sum of the squared residuals, divided by their variances,
//! follows a chi-squared distribution. On pads, all probes share the rounding error of the first contact. The fit also
//! estimates this error. Its prior variance is that of a uniform distribution over a pad.

use nalgebra::{DMatrix, DVector, Matrix2, SMatrix, SVector, Vector2};
use palpate_statistics::{Explained, GoodnessOfFit, LEFT, Misfit, StatedQuantity};

use crate::{Estimate, ProbeReading, ReadingNoise};

/// Number of fitted entries of the mobility `B` (contact travel per radian), which is a symmetric 2×2 matrix.
const MOBILITY_ENTRIES: usize = 3;
/// Number of fitted parameters: three entries of the mobility `B` (contact travel per radian), and two components of
/// the position error of the first contact. On pads, this error is the same for all probes.
const UNKNOWNS: usize = 5;
/// Smallest standard deviation of the noise that is estimated from residuals, divided by the length of the longest
/// shift. Smaller residuals may be rounding errors.
const MIN_NOISE: f64 = 1e-3;
/// A diagonal entry of a Cholesky factor counts as zero below this value, because it may be only a rounding error. The
/// readings then do not determine a parameter, or a residual has no noise in some direction.
const SINGULAR: f64 = 1e-10;
/// Significance level of a poor fit. The level must not be much smaller: four probes have only five degrees of freedom,
/// so at a level of 0.005 the test would often miss noise of three times the stated standard deviation.
const POOR_FIT_LEVEL: f64 = 0.02;
/// Significance level of the test for residuals that are too small for the stated noise.
const SMALL_RESIDUALS_LEVEL: f64 = 3e-5;
/// The stated standard deviation of the shifts is reported as too large only if it exceeds the root-mean-square
/// residual by more than this factor.
const MIN_NOISE_RATIO: f64 = 4.0;

type Unknowns = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type Slopes = SMatrix<f64, 2, UNKNOWNS>;

impl Estimate {
    /// Goodness of fit of this estimate to its readings; `None` if no noise is stated. For pads, the p-value tends to
    /// be too large, because the errors of pads are not independent. The computing time is proportional to the number
    /// of probes.
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

    /// Ways in which the readings contradict the model. If no noise is stated, only an outlier can be found.
    ///
    /// A wrong gain of all shifts or all rotations, or a wrong radius of the probe, causes no misfit. The reason is
    /// that another curvature of the object would change the readings in the same way.
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
            // If no noise is stated, the test compares residuals only with each other. The size of the noise does not
            // affect this comparison, so use any value.
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

/// Reports a stated shift noise that is far larger than the residuals. Readings of pads are not tested, because the
/// errors of all pads may be equal or zero.
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

/// A weighted least-squares fit to the readings, linearised at an estimate.
struct Refit<'r> {
    noise: ReadingNoise,
    estimate: &'r Estimate,
    readings: &'r [ProbeReading],
    /// Units in which the derivatives of the residuals are computed. The first unit is the longest rotation. The second
    /// unit is the smallest standard deviation of a residual, divided by the probe's radius.
    units: [f64; 2],
    covariance: Unknowns,
    /// Change of the fitted parameters that minimises chi-squared.
    change: SVector<f64, UNKNOWNS>,
    chi_squared: f64,
    freedom: usize,
}

impl<'r> Refit<'r> {
    /// Fits the parameters. `None` if the readings and their noise do not determine the parameters.
    fn new(
        noise: ReadingNoise,
        estimate: &'r Estimate,
        readings: &'r [ProbeReading],
    ) -> Option<Self> {
        let turned = readings.iter().map(|reading| reading.rotation.norm());
        let size = |reading| noise_sizes(&noise, estimate, reading);
        let sizes = readings.iter().map(|one| size(one)[0].max(size(one)[1]));
        let sizes = sizes.filter(|size| *size > 0.0);
        let least = sizes.fold(f64::INFINITY, f64::min);
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
        // Pads report the centre of the active pad instead of the contact. At the first contact, this rounding error is
        // uniformly distributed over one pad. Without pads, it is zero.
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
            // The sum overflows if residuals are extremely large multiples of their standard deviations. Chi-squared is
            // then infinite.
            false => f64::INFINITY,
        };
        Some(refit)
    }

    fn goodness(&self) -> GoodnessOfFit {
        GoodnessOfFit::new(self.chi_squared, self.freedom)
    }

    /// For each probe: its index, its residual, and the derivatives of the residual with respect to the fitted
    /// parameters. The residual and its derivatives are divided by the standard deviation of the residual. Probes
    /// without noise in some direction, such as a probe that did not rotate, are omitted.
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

    /// The roll that contradicts the other rolls most; `None` if no contradiction is significant. Its residual is
    /// compared with the stated noise, if this noise explains the other rolls. Otherwise the residual is compared with
    /// the residuals of the other rolls.
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
            let is_known = is_noise_stated && !others.is_poor();
            let estimated = (!is_known).then_some((self.chi_squared, self.freedom));
            (probe, explained.p_value(estimated))
        }))
    }
}

/// Standard deviations of a residual, divided by the probe's radius: first the part that is due to the noise of the
/// shift, then the part that is due to the noise of the rotation. The second part is computed for the direction with
/// the largest mobility (contact travel per radian).
fn noise_sizes(noise: &ReadingNoise, estimate: &Estimate, reading: &ProbeReading) -> [f64; 2] {
    let turned = reading.rotation.norm();
    let rotation_std = libm::hypot(noise.relative_rotation_std * turned, noise.rotation_std_rad);
    let largest = estimate.mobility.amax() * estimate.probe_curvature;
    [
        noise.shift_std * estimate.probe_curvature,
        rotation_std * largest,
    ]
}
