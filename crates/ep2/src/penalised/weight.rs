//! Selects the smoothing weight λ of a penalised spline.

use std::f64::consts::LN_2;

use super::spectrum::Spectrum;
use crate::Ep2Error;
use crate::spline::{LANES, Lanes};
use crate::square_quadric::UNKNOWNS;

/// Number of smoothing weights at which the criterion is evaluated, equally spaced in their logarithm. It must be a
/// multiple of [`LANES`].
const NODES: usize = 80;
/// Lower end of the search for the smoothing weight, relative to the smallest weight that damps a mode by half. The
/// modes are independent combinations of the spline's coefficients.
const MIN_WEIGHT_RATIO: f64 = 1e-2;
/// Upper end of the search for the smoothing weight, relative to the largest weight that damps a mode by half. The
/// modes are independent combinations of the spline's coefficients. With larger weights, the fit would be nearly a
/// quadric.
const MAX_WEIGHT_RATIO: f64 = 1e3;
/// The logarithm of a product of many factors is computed. If the product falls below this value, it is divided by this
/// value to avoid underflow, and the logarithm is corrected afterwards.
const SMALL: f64 = 1.0 / (1u64 << 60) as f64;
const SMALL_HALVINGS: f64 = 60.0;
/// The half-damping weight of a mode is the smoothing weight that damps the mode by half. The range of the search
/// covers the half-damping weights of the modes. A mode is ignored for this range if the ratio of its half-damping
/// weight to the largest one is below this value.
const MIN_MODE_RATIO: f64 = 1e-8;
/// The search for the smoothing weight extends beyond the expected weight. The natural logarithm of the upper end
/// exceeds that of the expected weight by at least this value.
const EXPECTED_MARGIN: f64 = 5.0;
/// Upper limit of the expected smoothing weight: its natural logarithm minus the natural logarithm of the largest
/// weight that damps a mode by half. The modes are independent combinations of the spline's coefficients.
const MAX_EXPECTED: f64 = 16.0;

/// A criterion by which the smoothing weight of a penalised spline is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// Generalised cross validation in which the effective degrees of freedom are multiplied by `gamma`. With this
    /// factor, the criterion seldom smooths too little. Kim and Gu (2004) recommend 1.4.
    RobustGcv {
        /// Factor on the effective degrees of freedom, at least 1.
        gamma: f64,
    },
    /// Generalised cross validation (Craven and Wahba, 1979).
    Gcv,
    /// Restricted maximum likelihood (Patterson and Thompson, 1971).
    Reml,
}

impl Default for Criterion {
    fn default() -> Self {
        Self::RobustGcv { gamma: 1.4 }
    }
}

impl Criterion {
    pub(super) fn check(self) -> Result<(), Ep2Error> {
        let is_good = (1.0..=100.0).contains(&self.gamma());
        Ep2Error::unless_good("gamma", self.gamma(), is_good, "1 to 100")
    }

    fn gamma(self) -> f64 {
        match self {
            Self::RobustGcv { gamma } => gamma,
            Self::Gcv | Self::Reml => 1.0,
        }
    }
}

/// The selected smoothing weight, and the factor by which the assumed variances must be multiplied with this weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    pub(super) log_weight: f64,
    /// Factor by which the assumed variances must be multiplied to explain the residuals; 1 if the variances are
    /// stated.
    pub(super) scale: f64,
    pub(super) effective_unknowns: f64,
}

/// Sums over the modes at a smoothing weight λ. The suffix `_prime` denotes the derivative with respect to ln λ.
#[derive(Clone, Copy, Debug)]
struct Sums<T = f64> {
    /// Weighted sum of squared residuals of the fit with the smoothing weight λ.
    residual: T,
    residual_prime: T,
    /// Weighted sum of squared residuals plus λ times the penalty, with the smoothing weight λ.
    penalised: T,
    penalised_prime: T,
    /// Effective degrees of freedom: trace of the map from the observations to the fitted values.
    unknowns: T,
    unknowns_prime: T,
    /// The difference ln det⁺(λP) − ln det(A + λP), with the penalty matrix P and the matrix A of the normal equations.
    log_determinants: T,
    log_determinants_prime: T,
}

impl Sums<Lanes> {
    fn at(spectrum: &Spectrum, log_weights: [f64; LANES]) -> [Sums; LANES] {
        let weight = Lanes::from(log_weights.map(libm::exp));
        let square = Lanes::splat(spectrum.square);
        let mut sums = Self {
            residual: square,
            residual_prime: Lanes::ZERO,
            penalised: square,
            penalised_prime: Lanes::ZERO,
            unknowns: Lanes::ZERO,
            unknowns_prime: Lanes::ZERO,
            log_determinants: Lanes::ZERO,
            log_determinants_prime: Lanes::ZERO,
        };
        // Logarithms are slow, so compute only one logarithm: that of the product of all factors of the determinants.
        // After every four factors, the product is scaled up if it is close to 0.
        let (mut product, mut halvings) = (Lanes::ONE, Lanes::ZERO);
        let modes = spectrum.fidelity.iter().zip(&spectrum.roughness);
        for (mode, ((fidelity, roughness), right)) in modes.zip(&spectrum.right).enumerate() {
            let penalty = weight * *roughness;
            let filter = Lanes::ONE / (penalty + *fidelity);
            let (fitted, smoothed) = (filter * *fidelity, penalty * filter);
            let square = filter * (right * right);
            sums.residual -= square * (Lanes::splat(2.0) - fitted);
            sums.residual_prime += square * smoothed * smoothed;
            sums.penalised -= square;
            sums.penalised_prime += square * smoothed;
            sums.unknowns += fitted;
            sums.unknowns_prime -= fitted * smoothed;
            if mode >= UNKNOWNS {
                let is_rough = penalty.simd_gt(Lanes::ZERO);
                product *= is_rough.select(smoothed, Lanes::ONE);
                sums.log_determinants_prime += is_rough.select(fitted, Lanes::ZERO);
            }
            if mode % 4 == 3 {
                let is_small = |product: Lanes| {
                    product.simd_lt(Lanes::splat(SMALL)) & product.simd_gt(Lanes::ZERO)
                };
                while is_small(product).any() {
                    let is_small = is_small(product);
                    product = is_small.select(product * (1.0 / SMALL), product);
                    halvings += is_small.select(Lanes::splat(SMALL_HALVINGS), Lanes::ZERO);
                }
            }
        }
        sums.log_determinants = Lanes::from(product.to_array().map(libm::log)) - halvings * LN_2;
        sums.residual_prime *= Lanes::splat(2.0);
        // If the surface fits all readings exactly, rounding errors could make the sum of squared residuals zero or
        // negative. Therefore the sum is at least `rest`.
        let rest = Lanes::splat(f64::EPSILON * f64::EPSILON * spectrum.square + f64::MIN_POSITIVE);
        sums.residual = sums.residual.max(rest);
        sums.penalised = sums.penalised.max(rest);
        std::array::from_fn(|place| {
            let lane = |lanes: Lanes| lanes.to_array()[place];
            Sums {
                residual: lane(sums.residual),
                residual_prime: lane(sums.residual_prime),
                penalised: lane(sums.penalised),
                penalised_prime: lane(sums.penalised_prime),
                unknowns: lane(sums.unknowns),
                unknowns_prime: lane(sums.unknowns_prime),
                log_determinants: lane(sums.log_determinants),
                log_determinants_prime: lane(sums.log_determinants_prime),
            }
        })
    }
}

impl Sums {
    fn at_one(spectrum: &Spectrum, log_weight: f64) -> Self {
        Sums::at(spectrum, [log_weight; LANES])[0]
    }
}

pub(super) struct Search<'a> {
    pub(super) spectrum: &'a Spectrum,
    criterion: Criterion,
    /// Whether the variances of heights and slopes are stated. If they are not, only their ratio is used.
    is_known: bool,
    places: Vec<f64>,
    sums: Vec<Sums>,
}

impl<'a> Search<'a> {
    /// Computes the sums at smoothing weights around the expected weight. `expected` is the logarithm of the expected
    /// weight.
    pub(super) fn new(
        spectrum: &'a Spectrum,
        criterion: Criterion,
        is_known: bool,
        expected: f64,
    ) -> Self {
        let (low, largest) = range(spectrum);
        let expected = expected.min(largest + MAX_EXPECTED);
        let high = (largest + libm::log(MAX_WEIGHT_RATIO)).max(expected + EXPECTED_MARGIN);
        let step = (high - low) / (NODES - 1) as f64;
        let places: Vec<f64> = (0..NODES).map(|node| low + step * node as f64).collect();
        let sums = places
            .chunks_exact(LANES)
            .flat_map(|places| Sums::at(spectrum, std::array::from_fn(|lane| places[lane])))
            .collect();
        Self {
            spectrum,
            criterion,
            is_known,
            places,
            sums,
        }
    }

    pub(super) fn best(&self) -> Choice {
        let scores: Vec<f64> = self.sums.iter().map(|sums| self.score(sums)).collect();
        let best = (0..NODES)
            .rev()
            .min_by(|&one, &other| scores[one].total_cmp(&scores[other]))
            .unwrap_or(NODES - 1);
        let below = best.saturating_sub(1);
        let above = (best + 1).min(NODES - 1);
        let has_root = scores[below].is_finite()
            && self.slope(&self.sums[below]) < 0.0
            && self.slope(&self.sums[above]) > 0.0;
        let log_weight = if has_root {
            self.root(self.places[below], self.places[above])
        } else {
            self.places[best]
        };
        let chosen = Sums::at_one(self.spectrum, log_weight);
        let scale = if self.is_known {
            1.0
        } else {
            chosen.residual / (self.spectrum.equations - chosen.unknowns).max(1.0)
        };
        Choice {
            log_weight,
            scale,
            effective_unknowns: chosen.unknowns,
        }
    }

    pub(super) fn least_deviance(&self) -> f64 {
        let deviances = self.sums.iter().map(|sums| self.deviance(sums));
        deviances.fold(f64::INFINITY, f64::min)
    }

    /// −2 ln(likelihood) of a smoothing weight, where the likelihood is integrated over all quadrics. If the variances
    /// are not stated, the most probable variance factor is used.
    fn deviance(&self, sums: &Sums) -> f64 {
        let degrees = self.spectrum.equations - UNKNOWNS as f64;
        let misfit = if self.is_known {
            sums.penalised
        } else {
            degrees * libm::log(sums.penalised)
        };
        misfit - sums.log_determinants
    }

    /// Score of a smoothing weight by the criterion; the best weight has the smallest score. The score is infinite if
    /// the effective degrees of freedom are too large.
    fn score(&self, sums: &Sums) -> f64 {
        if let Criterion::Reml = self.criterion {
            return self.deviance(sums);
        }
        let left = self.spectrum.equations - self.criterion.gamma() * sums.unknowns;
        if left > 0.0 {
            libm::log(sums.residual) - 2.0 * libm::log(left)
        } else {
            f64::INFINITY
        }
    }

    fn slope(&self, sums: &Sums) -> f64 {
        if let Criterion::Reml = self.criterion {
            let degrees = self.spectrum.equations - UNKNOWNS as f64;
            let misfit = if self.is_known {
                sums.penalised_prime
            } else {
                degrees * sums.penalised_prime / sums.penalised
            };
            return misfit - sums.log_determinants_prime;
        }
        let gamma = self.criterion.gamma();
        let left = self.spectrum.equations - gamma * sums.unknowns;
        sums.residual_prime / sums.residual + 2.0 * gamma * sums.unknowns_prime / left
    }

    /// Logarithm of the smoothing weight at which the slope of the score is zero, by the Illinois variant of regula
    /// falsi. The slope must be negative at `low` and positive at `high`.
    fn root(&self, low: f64, high: f64) -> f64 {
        let slope = |place: f64| self.slope(&Sums::at_one(self.spectrum, place));
        let (mut ends, mut slopes) = ([low, high], [slope(low), slope(high)]);
        let mut last = 2;
        for _ in 0..100 {
            let [low, high] = ends;
            let place = (low * slopes[1] - high * slopes[0]) / (slopes[1] - slopes[0]);
            let here = slope(place);
            let side = usize::from(here > 0.0);
            if here == 0.0 || (place - ends[side]).abs() <= 1e-12 {
                return place;
            }
            (ends[side], slopes[side]) = (place, here);
            if side == last {
                slopes[1 - side] *= 0.5;
            }
            last = side;
        }
        0.5 * (ends[0] + ends[1])
    }
}

/// Logarithm of the smoothing weight λ that is expected for a sphere with the curvature κ: λ = 1/(¾ κ³)².
/// `square_curvature` is κ². Lengths are in units of half a side of the square that contains the patch.
///
/// The weight is 1/a², where a is the typical size of the third derivatives. To leading order, the third derivatives of
/// a sphere are proportional to κ³. The factor ¾ is an assumption.
pub(super) fn log_weight_of_sphere(square_curvature: f64) -> f64 {
    -2.0 * libm::log(0.75_f64) - 3.0 * libm::log(square_curvature)
}

/// The logarithms of two smoothing weights: of the lower end of the search, and of the largest weight that damps a mode
/// by half.
fn range(spectrum: &Spectrum) -> (f64, f64) {
    let halves = || {
        let modes = spectrum.fidelity.iter().zip(&spectrum.roughness);
        modes
            .skip(UNKNOWNS)
            .filter(|(fidelity, roughness)| **fidelity > 0.0 && **roughness > 0.0)
            .map(|(fidelity, roughness)| fidelity / roughness)
    };
    let largest = halves().fold(f64::MIN_POSITIVE, f64::max);
    let smallest = halves()
        .fold(largest, f64::min)
        .max(MIN_MODE_RATIO * largest);
    (libm::log(MIN_WEIGHT_RATIO * smallest), libm::log(largest))
}
