//! Tests whether contacts contradict a fitted surface: goodness of fit of all contacts, and single contacts that
//! contradict the other contacts.
//!
//! The surface is modelled as a quadric plus a Gaussian process (a random smooth surface) with a given covariance. The
//! errors of the contacts' heights and slopes are computed to first order from the errors of positions and normals. The
//! equations for heights and slopes are split into independent modes. In the modes in which the noise has a larger
//! variance than the process, the sum of squared residuals has a chi-squared distribution for any surface.

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector3};
use palpate_statistics::{Explained, GoodnessOfFit, LEFT, Misfit, SIGNIFICANCE_LEVEL, ratio_tail};

use crate::chebyshev::{count, products, values};
use crate::patch::Sample;
use crate::spline::Jet;
use crate::square_quadric::{Square, SquareQuadric, UNKNOWNS};
use crate::{Ep2Error, Fit, Noise, NoiseEstimate, Patch};

/// Number of observations of a contact: its height and its two slopes.
const OBSERVATIONS: usize = 3;
/// Smallest number of contacts for which estimated noise can be distinguished from outliers.
const MIN_CONTACTS: usize = 10;
/// Largest number of contacts that are tested. If there are more contacts, an evenly spaced selection of them is fitted
/// and tested.
pub(crate) const MAX_CONTACTS: usize = 2000;
/// The contacts are tested only if the estimated standard deviation of their positions is at least this value, in the
/// patch's unit. A smaller estimate may be due to rounding errors, or to the approximation error of the series that
/// describes the surface.
const MIN_POSITION_STD: f64 = 5e-4;
/// A Gaussian process predicts the surface at a contact that was not used in the fit. The prediction has a variance,
/// which is multiplied by this value as a safety factor.
const MAX_VARIANCE_RATIO: f64 = 4.0;
/// The estimated variance of normals includes the effect of position errors, which is subtracted. At least this share
/// of the estimated variance remains, as the variance of the normals' own errors.
const MIN_NORMAL_SHARE: f64 = 0.1;

/// Goodness of fit and misfits of the contacts of a patch. If there are more than 2,000 contacts, an evenly spaced
/// selection of them is tested.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MisfitTest {
    /// Goodness of fit of the contacts; `None` if the noise is not stated.
    pub goodness: Option<GoodnessOfFit>,
    /// Ways in which the contacts contradict the fitted model. The list is empty if the noise is estimated from fewer
    /// than 10 contacts.
    ///
    /// A wrong radius of round tips, or a common gain of all positions, causes no misfit, because the readings then fit
    /// another surface.
    pub misfits: Vec<Misfit>,
}

/// A Gaussian process that is added to a quadric. The process is a series of Chebyshev polynomials with random
/// coefficients. It is stored as a matrix that maps independent random factors of variance 1 (columns) to the
/// coefficients (rows). Polynomials that form quadrics are left out.
pub(crate) type Process = DMatrix<f64>;

pub(crate) struct Model<'a> {
    pub(crate) patch: &'a Patch,
    /// Every `step`-th contact of the log is tested.
    pub(crate) step: usize,
    pub(crate) square: Square,
    pub(crate) fit: &'a Fit,
    /// A quadric near the fitted surface. The tests use the contacts' deviations from this quadric instead of their
    /// heights, because the deviations have smaller rounding errors.
    pub(crate) quadric: &'a SquareQuadric,
    /// Noise of the contacts that the caller of the fit stated.
    pub(crate) noise: &'a Noise,
    /// Noise of the tested contacts, stated or estimated.
    pub(crate) found: NoiseEstimate,
    pub(crate) degree: usize,
}

#[derive(Clone, Copy)]
struct Variances {
    position: f64,
    normal: f64,
}

/// Observations of a contact (height and slopes), transformed such that their errors are independent and have variance
/// 1.
struct Weighted {
    /// Deviations of the observed height and slopes from the quadric.
    values: DVector<f64>,
    /// Derivatives of the height and the slopes of the fitted surface with respect to its parameters: the coefficients
    /// of the quadric, and the random factors of the Gaussian process.
    slopes: DMatrix<f64>,
}

impl Model<'_> {
    /// Goodness of fit and misfits of the contacts, for a surface that is the sum of a quadric and the Gaussian process
    /// `process`.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] if numbers are beyond the range of doubles.
    pub(crate) fn misfit(&self, process: &Process) -> Result<MisfitTest, Ep2Error> {
        let Some(variances) = self.variances(0.0) else {
            return Ok(MisfitTest::default());
        };
        let (contacts, refit) = self.refit(variances, process)?;
        let is_stated = self.noise.is_complete_for(self.patch);
        let poor_fit = is_stated.then(|| Misfit::poor_fit(refit.goodness, SIGNIFICANCE_LEVEL));
        let numbers = (0..).step_by(self.step);
        let p_values = contacts
            .iter()
            .map(|contact| refit.p_value(contact, is_stated));
        let outlier = Misfit::outlier(numbers.zip(p_values));
        Ok(MisfitTest {
            goodness: is_stated.then_some(refit.goodness),
            misfits: poor_fit.flatten().into_iter().chain(outlier).collect(),
        })
    }

    /// For each contact in `others`, whether it contradicts the patch. These contacts are not part of the patch. A
    /// contact contradicts the patch if the p-value of its residuals is below `least`. A contact that is `None` is too
    /// steep for the patch, so it always contradicts the patch.
    ///
    /// # Errors
    /// Errors of [`Model::misfit`].
    pub(crate) fn contradicting(
        &self,
        process: &Process,
        others: &[Option<Sample>],
        least: f64,
    ) -> Result<Vec<bool>, Ep2Error> {
        let variances = self.variances(MIN_POSITION_STD);
        let variances = variances.ok_or(Ep2Error::OutOfRange)?;
        let (_, refit) = self.refit(variances, process)?;
        let contradicts = |other: &Option<Sample>| {
            let contact = self.weighted(other.as_ref()?, variances, process)?;
            let residual = &contact.values - &contact.slopes * &refit.factors;
            let rows = residual.len();
            let spread = &contact.slopes * &refit.covariance * contact.slopes.transpose();
            let spread = DMatrix::identity(rows, rows) + spread * MAX_VARIANCE_RATIO;
            let explained = Explained::by(&vec![1.0; rows], &spread, &residual, 0.0);
            let (square, freedom) = (refit.chi_squared, refit.freedom);
            Some(ratio_tail(explained.fall, explained.freedom, square, freedom) < least)
        };
        let all = others.iter();
        Ok(all
            .map(|other| contradicts(other).unwrap_or(true))
            .collect())
    }

    fn refit(
        &self,
        variances: Variances,
        process: &Process,
    ) -> Result<(Vec<Weighted>, Refit), Ep2Error> {
        let samples = self.patch.samples.iter();
        let contacts = samples.map(|sample| self.weighted(sample, variances, process));
        let contacts: Vec<Weighted> = contacts
            .collect::<Option<_>>()
            .ok_or(Ep2Error::OutOfRange)?;
        let refit = Refit::new(&contacts).ok_or(Ep2Error::OutOfRange)?;
        Ok((contacts, refit))
    }

    /// Variances of the contacts' errors. If the standard deviation of the positions is estimated, it is at least
    /// `least`. `None` if the estimated noise is as small as rounding errors, or was estimated from too few contacts.
    fn variances(&self, least: f64) -> Option<Variances> {
        let noise = self.found;
        let square = |std: f64| std * std;
        let stated = self.noise.normal_std_rad.map(square);
        let position = self.noise.position_std.unwrap_or(noise.position_std);
        let position = (position / self.fit.frame.scale()).max(least);
        let is_estimated = position >= MIN_POSITION_STD && self.patch.samples.len() >= MIN_CONTACTS;
        if !(self.noise.is_complete_for(self.patch) || is_estimated) {
            return None;
        }
        let position = square(position);
        let found = noise.normal_std_rad.map_or(0.0, square);
        // `found` is the estimated variance of the normals, which includes the effect of position errors. Subtract this
        // effect.
        let samples = self.patch.samples.iter();
        let jets = samples.map(|sample| self.jet(sample));
        let bend = |jet: Jet| 0.5 * (jet.uu * jet.uu + 2.0 * jet.uv * jet.uv + jet.vv * jet.vv);
        let bending = jets.map(bend).sum::<f64>() / self.patch.samples.len() as f64;
        Some(Variances {
            position,
            normal: stated.unwrap_or((found - bending * position).max(MIN_NORMAL_SHARE * found)),
        })
    }

    fn jet(&self, sample: &Sample) -> Jet {
        self.fit.jet(sample.u, sample.v)
    }

    fn weighted(
        &self,
        sample: &Sample,
        variances: Variances,
        process: &Process,
    ) -> Option<Weighted> {
        let root = self.root(sample, variances)?;
        let rows = root.nrows();
        let [height, p, q] = self.quadric.at(&self.square, sample);
        let [along_u, along_v] = sample.slopes.unwrap_or_default();
        let deviations = [sample.w - height, along_u - p, along_v - q];
        let series = series(self.square, self.degree, sample);
        let mut slopes = DMatrix::zeros(rows, UNKNOWNS + process.ncols());
        let quadrics = series.view((0, 0), (rows, UNKNOWNS));
        slopes.columns_mut(0, UNKNOWNS).copy_from(&quadrics);
        if process.ncols() > 0 {
            let rough = series.view((0, UNKNOWNS), (rows, process.nrows()));
            slopes
                .columns_mut(UNKNOWNS, process.ncols())
                .copy_from(&(rough * process));
        }
        Some(Weighted {
            values: root
                .solve_lower_triangular(&DVector::from_column_slice(&deviations[..rows]))?,
            slopes: root.solve_lower_triangular(&slopes)?,
        })
    }

    /// Cholesky factor of the covariance of a contact's height and slopes. It is not diagonal, because a position error
    /// affects height and slopes.
    fn root(&self, sample: &Sample, variances: Variances) -> Option<DMatrix<f64>> {
        let jet = self.jet(sample);
        let (p, q) = (jet.u, jet.v);
        let moved = Matrix3::from_rows(&[
            Vector3::new(-p, -q, 1.0).transpose(),
            Vector3::new(-jet.uu, -jet.uv, 0.0).transpose(),
            Vector3::new(-jet.uv, -jet.vv, 0.0).transpose(),
        ]);
        let mut covariance = moved * moved.transpose() * variances.position;
        let steepness = 1.0 + p * p + q * q;
        let tilted = Matrix2::new(1.0 + p * p, p * q, p * q, 1.0 + q * q);
        let mut of_slopes = covariance.fixed_view_mut::<2, 2>(1, 1);
        of_slopes += tilted * (steepness * variances.normal);
        covariance /= sample.weight;
        let rows = if sample.slopes.is_some() {
            OBSERVATIONS
        } else {
            1
        };
        let covariance = DMatrix::from_fn(rows, rows, |row, column| covariance[(row, column)]);
        Some(covariance.cholesky()?.l())
    }
}

struct Refit {
    covariance: DMatrix<f64>,
    factors: DVector<f64>,
    goodness: GoodnessOfFit,
    /// Sum of the squared residuals of all contacts after the fit of quadric and process. `freedom` is the number of
    /// degrees of freedom of a fit without the process.
    chi_squared: f64,
    freedom: usize,
}

impl Refit {
    /// Fits the coefficients of the quadric and the random factors of the process to the contacts. `None` if the
    /// contacts do not determine the quadric, or if numbers are beyond the range of doubles.
    fn new(contacts: &[Weighted]) -> Option<Self> {
        let size = contacts.first()?.slopes.ncols();
        let mut information = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        let (mut square, mut equations) = (0.0, 0);
        for contact in contacts {
            information.gemm_tr(1.0, &contact.slopes, &contact.slopes, 1.0);
            right.gemv_tr(1.0, &contact.slopes, &contact.values, 1.0);
            square += contact.values.norm_squared();
            equations += contact.values.len();
        }
        if !(square + right.sum() + information.sum()).is_finite() {
            return None;
        }
        let rough = size - UNKNOWNS;
        let quadrics = information.view((0, 0), (UNKNOWNS, UNKNOWNS)).into_owned();
        let quadrics = quadrics.cholesky()?;
        let cross = information
            .view((0, UNKNOWNS), (UNKNOWNS, rough))
            .into_owned();
        let own = right.rows(0, UNKNOWNS).into_owned();
        let start = quadrics.solve(&own);
        let rest = information.view((UNKNOWNS, UNKNOWNS), (rough, rough))
            - cross.tr_mul(&quadrics.solve(&cross));
        let rest_right = right.rows(UNKNOWNS, rough) - cross.tr_mul(&start);
        let square = (square - own.dot(&start)).max(0.0);
        let freedom = equations.saturating_sub(UNKNOWNS);
        let (mut noisy, mut chi_squared, mut outweighing) = (square, square, 0);
        // Without a Gaussian process, the model has no roughness, so no modes of the roughness are examined.
        let eigen = (rough > 0).then(|| rest.symmetric_eigen());
        let modes = eigen.iter().flat_map(|eigen| {
            let vectors = eigen.eigenvectors.column_iter();
            eigen.eigenvalues.iter().zip(vectors)
        });
        for (&weight, mode) in modes {
            let along = mode.dot(&rest_right);
            let explained = along * along / (1.0 + weight.max(0.0));
            chi_squared -= explained;
            // In this mode, the variance of the surface's roughness is larger than the variance of the noise. The mode
            // mainly describes the surface, so do not test it.
            if weight >= 1.0 {
                noisy -= along * along / weight;
                outweighing += 1;
            } else {
                noisy -= explained;
            }
        }
        for factor in UNKNOWNS..size {
            information[(factor, factor)] += 1.0;
        }
        let root = information.cholesky()?;
        Some(Self {
            factors: root.solve(&right),
            covariance: root.inverse(),
            goodness: GoodnessOfFit::new(noisy.max(0.0), freedom.saturating_sub(outweighing)),
            chi_squared: chi_squared.max(0.0),
            freedom,
        })
    }

    /// P-value of a contact's residuals. The residuals are compared with the stated noise if this noise explains the
    /// other contacts. Otherwise they are compared with the residuals of the other contacts.
    fn p_value(&self, contact: &Weighted, is_noise_stated: bool) -> f64 {
        let rows = contact.values.len();
        let residual = &contact.values - &contact.slopes * &self.factors;
        let left = DMatrix::identity(rows, rows)
            - &contact.slopes * &self.covariance * contact.slopes.transpose();
        let explained = Explained::by(&vec![1.0; rows], &left, &residual, LEFT);
        let others = GoodnessOfFit::new(
            (self.goodness.chi_squared - explained.fall).max(0.0),
            self.goodness.freedom.saturating_sub(explained.freedom),
        );
        let is_known = is_noise_stated && !others.is_poor();
        let estimated = (!is_known).then_some((self.chi_squared, self.freedom));
        explained.p_value(estimated)
    }
}

/// Matrix of the products of Chebyshev polynomials at a contact. Each column belongs to one product. The rows contain
/// the products and their slopes along u and v.
fn series(square: Square, degree: usize, sample: &Sample) -> DMatrix<f64> {
    let [a, b] = square.place([sample.u, sample.v]);
    let [half_u, half_v] = square.half();
    let both = |x: f64| -> Vec<[f64; 2]> {
        let all: Vec<f64> = values(x, degree).collect();
        let mut slopes = vec![0.0; degree + 1];
        for order in 1..=degree {
            // The derivatives of Chebyshev polynomials follow from T_1' = 1 and T_n' = 2 T_(n−1) + 2x T_(n−1)' −
            // T_(n−2)'.
            slopes[order] = match order {
                1 => 1.0,
                _ => 2.0 * all[order - 1] + 2.0 * x * slopes[order - 1] - slopes[order - 2],
            };
        }
        all.into_iter()
            .zip(slopes)
            .map(|(value, slope)| [value, slope])
            .collect()
    };
    let (along_a, along_b) = (both(a), both(b));
    let mut rows = DMatrix::zeros(OBSERVATIONS, count(degree));
    for (column, [i, j]) in products(degree).enumerate() {
        let ([of_a, slope_a], [of_b, slope_b]) = (along_a[i], along_b[j]);
        rows[(0, column)] = of_a * of_b;
        rows[(1, column)] = slope_a * of_b / half_u;
        rows[(2, column)] = of_a * slope_b / half_v;
    }
    rows
}
