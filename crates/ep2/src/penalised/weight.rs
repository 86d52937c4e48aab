//! The choice of the smoothing weight.

use std::f64::consts::LN_2;

use super::spectrum::Spectrum;
use crate::Ep2Error;
use crate::spline::{LANES, Lanes};
use crate::square_quadric::UNKNOWNS;

/// Places at which the criterion is looked at, in equal steps of the logarithm of the weight; a multiple of [`LANES`].
const NODES: usize = 80;
/// The smallest weight looked at, relative to the smallest at which a mode is half kept.
const LEAST: f64 = 1e-2;
/// The largest, relative to the largest at which a mode is half kept: beyond, only the quadric is
/// left.
const MOST: f64 = 1e3;
/// Bound on a product below which its power of two is counted apart.
const SMALL: f64 = 1.0 / (1u64 << 60) as f64;
const SMALL_HALVINGS: f64 = 60.0;
/// Modes whose half weight is below this share of the largest do not widen the search.
const FAINT: f64 = 1e-8;
/// The search ends so far beyond the expected weight, or never farther than so far beyond the largest
/// at which a mode is half kept, both in logarithms.
const BEYOND_EXPECTED: f64 = 5.0;
const FARTHEST: f64 = 16.0;

/// A criterion by which the smoothing weight is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// Generalised cross validation in which each unknown taken up counts `gamma` times (Kim and
    /// Gu, 2004, advise 1.4), which seldom smooths too little.
    RobustGcv {
        /// Number of times that each unknown counts, at least 1.
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

/// A smoothing weight, and what follows from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    /// Logarithm of the weight.
    pub(super) log_weight: f64,
    /// Factor of the assumed variances that explains the residuals; 1 where they are known.
    pub(super) scale: f64,
    pub(super) effective_unknowns: f64,
}

/// Sums over the modes at a smoothing weight λ. The prime is a derivative by ln λ.
#[derive(Clone, Copy, Debug)]
struct Sums<T = f64> {
    /// Weighted sum of squared residuals.
    residual: T,
    residual_prime: T,
    /// Sum of squared residuals plus λ times the penalty.
    penalised: T,
    penalised_prime: T,
    /// Trace of the map from observations to fit.
    unknowns: T,
    unknowns_prime: T,
    /// ln det⁺(λP) − ln det(A + λP), and its derivative.
    log_determinants: T,
    log_determinants_prime: T,
}

impl Sums<Lanes> {
    /// Sums at weights side by side, from their logarithms.
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
        // One logarithm of a product of which powers of two are counted apart after every four factors, lest it vanish.
        let (mut product, mut halvings) = (Lanes::ONE, Lanes::ZERO);
        let modes = spectrum.fidelity.iter().zip(&spectrum.roughness);
        for (mode, ((fidelity, roughness), right)) in modes.zip(&spectrum.right).enumerate() {
            let penalty = weight * *roughness;
            let kept = Lanes::ONE / (penalty + *fidelity);
            let (fitted, smoothed) = (kept * *fidelity, penalty * kept);
            let square = kept * (right * right);
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
        // Rounding may leave a negative rest where everything is fitted.
        let rest = Lanes::splat(f64::EPSILON * f64::EPSILON * spectrum.square + f64::MIN_POSITIVE);
        sums.residual = sums.residual.max(rest);
        sums.penalised = sums.penalised.max(rest);
        sums.apart()
    }

    fn apart(self) -> [Sums; LANES] {
        let lane = |lane: usize, lanes: Lanes| lanes.to_array()[lane];
        std::array::from_fn(|place| Sums {
            residual: lane(place, self.residual),
            residual_prime: lane(place, self.residual_prime),
            penalised: lane(place, self.penalised),
            penalised_prime: lane(place, self.penalised_prime),
            unknowns: lane(place, self.unknowns),
            unknowns_prime: lane(place, self.unknowns_prime),
            log_determinants: lane(place, self.log_determinants),
            log_determinants_prime: lane(place, self.log_determinants_prime),
        })
    }
}

impl Sums {
    fn alone(spectrum: &Spectrum, log_weight: f64) -> Self {
        Sums::at(spectrum, [log_weight; LANES])[0]
    }
}

/// The smoothing weights of one data set, looked at in equal steps of their logarithm.
pub(super) struct Search<'a> {
    spectrum: &'a Spectrum,
    criterion: Criterion,
    /// Whether the variances are known, not only their ratio.
    is_known: bool,
    /// Logarithms of the weights.
    places: Vec<f64>,
    sums: Vec<Sums>,
}

impl<'a> Search<'a> {
    /// The weights that are to be looked at where one of about `expected`, in logarithms, would be no surprise.
    pub(super) fn new(
        spectrum: &'a Spectrum,
        criterion: Criterion,
        is_known: bool,
        expected: f64,
    ) -> Self {
        let (low, largest) = range(spectrum);
        let expected = expected.min(largest + FARTHEST);
        let high = (largest + libm::log(MOST)).max(expected + BEYOND_EXPECTED);
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

    /// The weight that the criterion likes best.
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
        let chosen = Sums::alone(self.spectrum, log_weight);
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

    /// −2 ln(likelihood) with the quadric integrated out; that of the best scale unless it is
    /// known.
    fn deviance(&self, sums: &Sums) -> f64 {
        let degrees = self.spectrum.equations - UNKNOWNS as f64;
        let misfit = if self.is_known {
            sums.penalised
        } else {
            degrees * libm::log(sums.penalised)
        };
        misfit - sums.log_determinants
    }

    /// Score that the chosen weight makes smallest; infinite where too many unknowns would be taken up.
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

    /// Its derivative by the logarithm of the weight.
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

    /// The root of the slope between two places where it rises through zero (by false position
    /// with Illinois' halving).
    fn root(&self, low: f64, high: f64) -> f64 {
        let slope = |place: f64| self.slope(&Sums::alone(self.spectrum, place));
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

/// Logarithm of the weight that goes with the roughness of a sphere, for a mean square of the curvature in units of the
/// square.
///
/// The penalty of a sphere of curvature κ over the square is 32 κ⁶: the amplitude λ^(−1/2) of its third derivatives is
/// ¾ κ³.
pub(super) fn of_a_sphere(square_curvature: f64) -> f64 {
    -2.0 * libm::log(0.75_f64) - 3.0 * libm::log(square_curvature)
}

/// Logarithms of the smallest weight to look at, and of the largest at which a mode is half kept.
fn range(spectrum: &Spectrum) -> (f64, f64) {
    let halves = || {
        let modes = spectrum.fidelity.iter().zip(&spectrum.roughness);
        modes
            .skip(UNKNOWNS)
            .filter(|(fidelity, roughness)| **fidelity > 0.0 && **roughness > 0.0)
            .map(|(fidelity, roughness)| fidelity / roughness)
    };
    let largest = halves().fold(f64::MIN_POSITIVE, f64::max);
    let smallest = halves().fold(largest, f64::min).max(FAINT * largest);
    (libm::log(LEAST * smallest), libm::log(largest))
}
