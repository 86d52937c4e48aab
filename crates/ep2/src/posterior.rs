//! The posterior distribution of a surface, which follows from the contacts and a prior.

use nalgebra::DMatrix;

use crate::chebyshev::{count, derivative, place, products, values};
use crate::curvature::{DERIVATIVES, JetCovariance};
use crate::matrix::SparseMap;
use crate::spline::{Jet, Lanes};
use crate::square_quadric::Square;

/// Number of pairs of the derivatives p, q, r, s, t (slopes and second derivatives of the surface), including the pair
/// of each derivative with itself.
const PAIRS: usize = DERIVATIVES * (DERIVATIVES + 1) / 2;

/// The posterior distribution of the surface: mean and covariance of the slopes and second derivatives, as polynomials
/// over the rectangle of the patch.
///
/// The fitted spline may differ from the posterior mean. Therefore the error of an estimate has two parts: a random
/// error with the posterior covariance, and the difference between the estimate and the posterior mean.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Posterior {
    square: Square,
    degree: usize,
    /// Coefficients of the posterior mean of each derivative, in the order of [`products`].
    means: Vec<[f64; DERIVATIVES]>,
    /// Coefficients of the covariances between the derivatives, one series per pair of derivatives. The degree of these
    /// series is twice the degree of the surface. The products T_i(a) T_j(b) are grouped by i.
    covariances: Vec<[f64; PAIRS]>,
    /// Factor by which the variances and covariances of the errors are multiplied.
    widening: f64,
}

/// Values of the Chebyshev polynomials in u, from degree 0 on, at several places.
pub(crate) type Series = Vec<Lanes>;

impl Posterior {
    /// The posterior of a surface that is a series of [`products`] over the square. `mean` and `covariance` are the
    /// mean and the covariance of the coefficients of the series.
    pub(crate) fn new(
        square: Square,
        degree: usize,
        mean: &[f64],
        covariance: &DMatrix<f64>,
    ) -> Self {
        let maps = Maps::of(&square, degree);
        let mean = DMatrix::from_row_slice(1, mean.len(), mean);
        let mut means = vec![[0.0; DERIVATIVES]; count(degree)];
        for (derivative, coefficients) in maps.all(&mean, 0).iter().enumerate() {
            for (means, coefficient) in means.iter_mut().zip(coefficients) {
                means[derivative] = *coefficient;
            }
        }
        let mut pairs = Vec::with_capacity(PAIRS);
        for (one, half) in maps.all(covariance, 0).iter().enumerate() {
            let both = maps.all(&half.transpose(), one);
            pairs.extend(both.iter().map(|both| covariance_series(both, degree)));
        }
        let of_pairs = |index: usize| std::array::from_fn(|pair| pairs[pair][index]);
        let side = 2 * degree + 1;
        let covariances = (0..side * side).map(of_pairs).collect();
        Self {
            square,
            degree,
            means,
            covariances,
            widening: 1.0,
        }
    }

    /// Multiplies the variances and covariances of the errors by `factor`.
    pub(crate) fn widen(&mut self, factor: f64) {
        self.widening *= factor;
    }

    pub(crate) fn series(&self, u: Lanes) -> Series {
        let ([u0, _], [half, _]) = (self.square.centre(), self.square.half());
        values((u - u0) * (1.0 / half), 2 * self.degree).collect()
    }

    pub(crate) fn line(&self, v: f64) -> PosteriorLine {
        let ([_, v0], [_, half]) = (self.square.centre(), self.square.half());
        let v: Vec<f64> = values((v - v0) / half, 2 * self.degree).collect();
        let mut means = vec![[0.0; DERIVATIVES]; self.degree + 1];
        for (coefficients, [i, j]) in self.means.iter().zip(products(self.degree)) {
            add(&mut means[i], coefficients, v[j]);
        }
        let side = v.len();
        let rows = self.covariances.chunks_exact(side).enumerate();
        let covariances = rows.map(|(i, row)| {
            let mut sums = [0.0; PAIRS];
            for (coefficients, v) in row[..side - i].iter().zip(&v) {
                add(&mut sums, coefficients, *v);
            }
            sums
        });
        PosteriorLine {
            means,
            covariances: covariances.collect(),
            widening: self.widening,
        }
    }
}

/// The linear maps from the coefficients of a Chebyshev series to the coefficients of its derivatives.
struct Maps {
    slopes: [SparseMap; 2],
    /// Maps from the coefficients of a first derivative to the coefficients of its derivatives with respect to u and v.
    bends: [SparseMap; 2],
}

impl Maps {
    fn of(square: &Square, degree: usize) -> Self {
        let [half_u, half_v] = square.half();
        let of = |degree: usize| {
            [(0, half_u), (1, half_v)].map(|(axis, half)| derivative(degree, axis).in_unit(half))
        };
        Self {
            slopes: of(degree),
            bends: of(degree.saturating_sub(1)),
        }
    }

    /// Coefficients of the derivatives (p, q, r, s, t) of several series. The derivatives before the index `first` are
    /// omitted. Each row of `series` is one series.
    fn all(&self, series: &DMatrix<f64>, first: usize) -> Vec<DMatrix<f64>> {
        let by_v = self.slopes[1].apply_to_rows(series);
        let last = self.bends[1].apply_to_rows(&by_v);
        if first == DERIVATIVES - 1 {
            return vec![last];
        }
        let by_u = self.slopes[0].apply_to_rows(series);
        let [by_uu, by_uv] = self.bends.each_ref().map(|bend| bend.apply_to_rows(&by_u));
        let mut all = vec![by_u, by_v, by_uu, by_uv, last];
        all.drain(..first);
        all
    }
}

/// The covariance of two derivatives at a place, as a series of products T_i(a) T_j(b) that are grouped by i. Its
/// degree is twice the degree of the derivatives. It is computed from the covariance between the coefficients of the
/// two series, because a product of Chebyshev polynomials is a sum of Chebyshev polynomials.
fn covariance_series(covariance: &DMatrix<f64>, degree: usize) -> Vec<f64> {
    let side = 2 * degree + 1;
    let mut series = vec![0.0; side * side];
    let mut sums = vec![0.0; side];
    let (rows, columns) = covariance.shape();
    for i in 0..=degree {
        for k in 0..=degree {
            sums.fill(0.0);
            for l in 0..=degree - k {
                let column = place([k, l]);
                if column >= columns {
                    break;
                }
                let entries = &covariance.as_slice()[column * rows..(column + 1) * rows];
                let mut row = place([i, 0]);
                for j in 0..=degree - i {
                    let Some(entry) = entries.get(row) else { break };
                    sums[j + l] += 0.25 * entry;
                    sums[j.abs_diff(l)] += 0.25 * entry;
                    row += i + j + 2;
                }
            }
            for order in [i + k, i.abs_diff(k)] {
                let series = &mut series[order * side..(order + 1) * side];
                series
                    .iter_mut()
                    .zip(&sums)
                    .for_each(|(series, sum)| *series += sum);
            }
        }
    }
    series
}

#[inline(always)]
fn add<const N: usize>(sums: &mut [f64; N], coefficients: &[f64; N], factor: f64) {
    for (sum, coefficient) in sums.iter_mut().zip(coefficients) {
        *sum += factor * coefficient;
    }
}

/// The posterior distribution of the surface along a line of constant v, as series in u.
pub(crate) struct PosteriorLine {
    means: Vec<[f64; DERIVATIVES]>,
    covariances: Vec<[f64; PAIRS]>,
    widening: f64,
}

impl PosteriorLine {
    /// Variances and covariances of the errors of the estimated derivatives (p, q, r, s, t) = (∂u, ∂v, ∂u², ∂u∂v, ∂v²)
    /// at places on the line. They include the differences between the estimates and the posterior means. `jet`
    /// contains the estimates, and `series` the values of the polynomials in u at these places.
    #[inline(always)]
    pub(crate) fn errors(&self, series: &Series, jet: &Jet<Lanes>) -> JetCovariance {
        let mut distance = [jet.u, jet.v, jet.uu, jet.uv, jet.vv];
        for (means, value) in self.means.iter().zip(series) {
            for (distance, mean) in distance.iter_mut().zip(means) {
                *distance -= *value * *mean;
            }
        }
        let mut spread = [Lanes::ZERO; PAIRS];
        for (covariances, value) in self.covariances.iter().zip(series) {
            for (spread, covariance) in spread.iter_mut().zip(covariances) {
                *spread += *value * *covariance;
            }
        }
        let widening = Lanes::splat(self.widening);
        let mut errors = JetCovariance::default();
        let mut pair = 0;
        for one in 0..DERIVATIVES {
            for other in one..DERIVATIVES {
                let both = (spread[pair] + distance[one] * distance[other]) * widening;
                errors[one][other] = both;
                errors[other][one] = both;
                pair += 1;
            }
        }
        errors
    }
}
