//! Estimates of curvature from time series of rolls.

use nalgebra::{Matrix2, Matrix3, Vector3};
use palpate_geometry::{CurvatureForm, ShapeClass, ShapeThresholds};
use palpate_statistics::{GoodnessOfFit, NORMAL_95, student_half_width};

use crate::feasible_set::normal_nodes;
use crate::pad_edge::PadEdgeSet;
use crate::symmetric::{inverse_slopes, is_rolling, matrix};
use crate::{Estimate, Measured};

/// A curvature of the object at the common start of the rolls, in the axes of the pads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Normal curvature in a direction.
    Normal {
        /// Angle (rad) of the direction, measured from u towards v.
        angle_rad: f64,
    },
    /// Gaussian curvature.
    Gaussian,
    /// Mean curvature.
    Mean,
    /// Smallest principal curvature.
    PrincipalMin,
    /// Largest principal curvature.
    PrincipalMax,
}

/// Reasons why the fit does not use a roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exclusion {
    /// The roll has fewer than two samples.
    TooFewSamples,
    /// The probe did not rotate.
    NoRotation,
    /// The contact did not leave its first pad, so the roll only bounds the curvature.
    NoCrossing,
    /// The roll contradicts the other rolls.
    Inconsistent,
}

/// Whether and how a fit used one roll.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RollReport {
    /// P-value: probability that by chance alone the roll would contradict the other rolls at least as much. `None` if
    /// the roll cannot be tested.
    pub p_value: Option<f64>,
    /// Why the fit does not use the roll; `None` if the fit uses the roll.
    pub left_out: Option<Exclusion>,
}

/// The distribution of an estimate's errors.
#[derive(Clone, Debug)]
pub(crate) enum Uncertainty {
    /// The errors of the mobility (contact travel per radian) are normally distributed.
    NormalMobility,
    /// The errors of the curvature form are normally distributed.
    NormalForm,
    /// The noise was estimated from residuals with this number of degrees of freedom. The errors have Student's t
    /// distribution.
    Student(usize),
    /// If the readings are exact, the true mobility (contact travel per radian) lies in this set. The flag states whether
    /// the crossings of pad edges may have noise. Then the errors of the mobility are normally distributed.
    Set(Box<PadEdgeSet>, bool),
}

/// An estimate of the object's curvature from time series of rolls.
#[derive(Clone, Debug)]
pub struct SeriesEstimate {
    /// The object's curvature form (1/length) at the common start of the rolls, in the axes of the pads.
    pub curvature: CurvatureForm,
    /// Covariance (1/length²) of the entries `k_uu`, `k_vv` and `k_uv` of the curvature form, to first order. If the
    /// readings have noise, it is the inverse of the Fisher information, so that the roots of its diagonal are the
    /// Cramér–Rao bounds.
    pub covariance: [[f64; 3]; 3],
    /// Number of terms of a polynomial that describes the curvature along a path. It is 1 if the readings show no change
    /// of the curvature.
    pub terms: usize,
    /// One report for each roll.
    pub rolls: Vec<RollReport>,
    /// Goodness of fit; `None` if no noise is stated.
    pub goodness: Option<GoodnessOfFit>,
    /// P-value of a change of the curvature along the rolls, if the method assumes that the curvature is constant, but
    /// the readings show that it changes. The estimate is then wrong.
    pub change: Option<f64>,
    /// Whether the object may be a paraboloid on which a constant curvature would be wrong by many standard errors.
    pub may_change: bool,
    radius: f64,
    pub(crate) arc_length: f64,
    uncertainty: Uncertainty,
}

impl SeriesEstimate {
    /// The estimate whose curvature form is `(relative − 1) / radius`. `relative` is the sum of the curvature forms of
    /// probe and object, times the radius of the probe. `covariance` is the covariance of the entries uu, uv, vv of
    /// `relative`.
    pub(crate) fn new(
        radius: f64,
        relative: &Matrix2<f64>,
        covariance: Matrix3<f64>,
        terms: usize,
        (rolls, goodness): (Vec<RollReport>, Option<GoodnessOfFit>),
        arc_length: f64,
        uncertainty: Uncertainty,
    ) -> Self {
        const ORDER: [usize; 3] = [0, 2, 1];
        let scale = 1.0 / radius;
        Self {
            curvature: form_of(relative, radius),
            covariance: ORDER.map(|row| ORDER.map(|at| covariance[(row, at)] * scale * scale)),
            terms,
            rolls,
            goodness,
            change: None,
            may_change: false,
            radius,
            arc_length,
            uncertainty,
        }
    }

    /// The estimate of a fit to the starts and ends of rolls. `covariance` is the covariance (1/length²) of the entries
    /// `k_uu`, `k_vv` and `k_uv` of the curvature form. `freedom` is the number of degrees of freedom of the residuals
    /// from which the noise was estimated; `None` if the noise is stated.
    pub fn of_ends(estimate: &Estimate, covariance: [[f64; 3]; 3], freedom: Option<usize>) -> Self {
        Self {
            curvature: estimate.curvature,
            covariance,
            terms: 1,
            rolls: Vec::new(),
            goodness: None,
            change: None,
            may_change: false,
            radius: 1.0 / estimate.probe_curvature,
            arc_length: estimate.arc_length,
            uncertainty: freedom.map_or(Uncertainty::NormalMobility, Uncertainty::Student),
        }
    }

    /// The weighted mean of estimates. Its covariance includes the differences between the estimates. All other parts
    /// are those of the first estimate. `None` if there are no estimates.
    pub(crate) fn mean<'e>(
        weighted: impl Iterator<Item = (f64, &'e Self)> + Clone,
    ) -> Option<Self> {
        let total: f64 = weighted.clone().map(|(weight, _)| weight).sum();
        let shares = weighted.clone().map(|(weight, one)| (weight / total, one));
        let parts = shares.clone().map(|(share, one)| one.entries() * share);
        let mean: Vector3<f64> = parts.sum();
        let squares = shares.map(|(share, one)| {
            let apart = one.entries() - mean;
            (Matrix3::from(one.covariance) + apart * apart.transpose()) * share
        });
        let covariance: Matrix3<f64> = squares.sum();
        let [k_uu, k_vv, k_uv] = mean.into();
        Some(Self {
            curvature: CurvatureForm { k_uu, k_uv, k_vv },
            covariance: covariance.into(),
            ..weighted.clone().next()?.1.clone()
        })
    }

    /// The entries `k_uu`, `k_vv` and `k_uv` of the curvature form.
    pub(crate) fn entries(&self) -> Vector3<f64> {
        let CurvatureForm { k_uu, k_uv, k_vv } = self.curvature;
        Vector3::new(k_uu, k_vv, k_uv)
    }

    /// Adds the covariance `apart apartᵀ` of one more error to the covariance of the entries `k_uu`, `k_vv` and `k_uv`
    /// of the curvature form. `apart` contains the size of this error in each entry.
    pub(crate) fn widen(&mut self, apart: Vector3<f64>) {
        self.covariance = (Matrix3::from(self.covariance) + apart * apart.transpose()).into();
    }

    /// States that the crossings of pad edges may have noise.
    pub(crate) fn ignore_bounds(&mut self) {
        if let Uncertainty::Set(_, is_noisy) = &mut self.uncertainty {
            *is_noisy = true;
        }
    }

    /// The estimate without intervals, as [`LeastSquares`](crate::LeastSquares) returns it.
    pub fn estimate(&self) -> Estimate {
        let form = self.curvature;
        let measured = |value: f64, gradient: [f64; 3]| Measured {
            value,
            std: Some(self.std(gradient)),
        };
        Estimate {
            curvature: form,
            normal_curvature_u: measured(form.k_uu, [1.0, 0.0, 0.0]),
            normal_curvature_v: measured(form.k_vv, [0.0, 1.0, 0.0]),
            gaussian_curvature: measured(
                form.gaussian_curvature(),
                [form.k_vv, form.k_uu, -2.0 * form.k_uv],
            ),
            mean_curvature: measured(form.mean_curvature(), [0.5, 0.5, 0.0]),
            arc_length: self.arc_length,
            probe_curvature: 1.0 / self.radius,
            mobility: self.mobility(),
        }
    }

    /// The 95 % interval of a quantity, or its range if the rolls [cross few edges](Self::has_few_crossings). An end is
    /// `None` if the interval is unbounded on this side.
    pub fn interval95(&self, quantity: Quantity) -> [Option<f64>; 2] {
        let form = self.curvature;
        let interval = match quantity {
            Quantity::Normal { angle_rad } => {
                let (sin, cos) = libm::sincos(angle_rad);
                let std = self.std([cos * cos, sin * sin, 2.0 * sin * cos]);
                self.around(form.normal_curvature(angle_rad), std)
            }
            Quantity::Mean => self.around(form.mean_curvature(), self.std([0.5, 0.5, 0.0])),
            Quantity::PrincipalMin => {
                let [std, ..] = form.principal_stds(&self.covariance);
                self.around(form.principal().k_min, std)
            }
            Quantity::PrincipalMax => {
                let [_, std, _] = form.principal_stds(&self.covariance);
                self.around(form.principal().k_max, std)
            }
            Quantity::Gaussian => self.gaussian_interval(),
        };
        let is_noisy = matches!(&self.uncertainty, Uncertainty::Set(_, true));
        let Some(bounds) = self.range(quantity).filter(|_| !is_noisy) else {
            return interval;
        };
        if self.has_few_crossings() {
            return bounds;
        }
        let [low, high] = [0, 1].map(|end| interval[end].or(bounds[end]));
        [
            low.map(|low| low.max(bounds[0].unwrap_or(low))),
            high.map(|high| high.min(bounds[1].unwrap_or(high))),
        ]
    }

    /// Whether the rolls cross very few edges of pads. Then only the intervals of [`bounds`](Self::bounds) are
    /// meaningful, and the estimate is the middle of a wide range.
    pub fn has_few_crossings(&self) -> bool {
        matches!(&self.uncertainty, Uncertainty::Set(set, false) if set.has_few_crossings())
    }

    /// The range of a quantity over all curvatures that agree with the readings, if the rotations and the pads are
    /// exact. An end of the range is `None` if the range is unbounded on this side. The whole result is `None` if the
    /// rotations or the places have noise, or if a roll was left out because it contradicts the others: then the other
    /// rolls may also be wrong.
    pub fn bounds(&self, quantity: Quantity) -> Option<[Option<f64>; 2]> {
        let is_out = |roll: &RollReport| roll.left_out == Some(Exclusion::Inconsistent);
        self.range(quantity)
            .filter(|_| !self.rolls.iter().any(is_out))
    }

    fn range(&self, quantity: Quantity) -> Option<[Option<f64>; 2]> {
        let Uncertainty::Set(set, _) = &self.uncertainty else {
            return None;
        };
        let flat = 1.0 / self.radius;
        let scale = match quantity {
            Quantity::Gaussian => flat * flat,
            _ => flat,
        };
        if !matches!(quantity, Quantity::PrincipalMin | Quantity::PrincipalMax) {
            return Some(set.ends(quantity).map(|end| Some(end? * scale)));
        }
        let ends = set.principal_ends()[usize::from(quantity == Quantity::PrincipalMax)];
        Some(ends.map(|end| end.is_finite().then_some(end * scale)))
    }

    /// The probability of each shape class, in the order of [`ShapeClass::ALL`].
    pub fn class_probabilities(&self, thresholds: &ShapeThresholds) -> [f64; 8] {
        let mut probabilities = [0.0; 8];
        let (mut count, radius) = (0.0, self.radius);
        for relative in self.draws().flatten() {
            let form = form_of(&relative, radius);
            let (gaussian, mean) = (form.gaussian_curvature(), form.mean_curvature());
            let class = match (gaussian * radius * radius).is_finite() && mean.is_finite() {
                true => thresholds.classify(gaussian, mean),
                false => ShapeClass::Peak,
            };
            probabilities[class as usize] += 1.0;
            count += 1.0;
        }
        probabilities.map(|sum| sum / f64::max(count, 1.0))
    }

    fn relative(&self) -> Matrix2<f64> {
        Matrix2::identity() + self.curvature.matrix() * self.radius
    }

    /// Mobility: the distance that the contact moves per radian of rotation.
    fn mobility(&self) -> Matrix2<f64> {
        self.relative().try_inverse().unwrap_or_default() * self.radius
    }

    /// Standard error of a quantity. `gradient` contains the derivatives of the quantity with respect to the curvatures
    /// uu, vv and uv.
    fn std(&self, gradient: [f64; 3]) -> f64 {
        let along = self.covariance.map(|row| dot(&row, &gradient));
        dot(&along, &gradient).max(0.0).sqrt()
    }

    /// Half-width of a 95 % interval, in standard errors.
    fn half_width(&self) -> f64 {
        match self.uncertainty {
            Uncertainty::Student(freedom) => student_half_width(0.95, freedom),
            _ => NORMAL_95,
        }
    }

    const fn is_form_normal(&self) -> bool {
        matches!(self.uncertainty, Uncertainty::NormalForm)
    }

    /// The interval of a curvature. If the errors of the mobility (contact travel per radian) are normally distributed,
    /// the interval of the mobility is computed first, and its ends are converted to curvatures. If the mobility's
    /// interval includes 0, the curvature has no upper end.
    fn around(&self, curvature: f64, std: f64) -> [Option<f64>; 2] {
        let half = self.half_width() * std;
        let flat = 1.0 / self.radius;
        let relative = curvature + flat;
        if !half.is_finite() {
            return [None, None];
        }
        if self.is_form_normal() {
            return [Some((curvature - half).max(-flat)), Some(curvature + half)];
        }
        let share = half / relative;
        let upper = (share < 1.0).then(|| relative / (1.0 - share) - flat);
        [Some(relative / (1.0 + share) - flat), upper]
    }

    /// Draws sums of the curvature forms of probe and object from the distribution of the estimate, in units of the
    /// probe's curvature. A draw is `None` if a contact with the drawn mobility (travel per radian) would not roll.
    fn draws(&self) -> impl Iterator<Item = Option<Matrix2<f64>>> {
        const ORDER: [usize; 3] = [0, 2, 1];
        let scale = self.radius * self.radius;
        let of_form = Matrix3::from_fn(|row, at| self.covariance[ORDER[row]][ORDER[at]] * scale);
        let relative = self.relative();
        let mobility = relative.try_inverse().unwrap_or_default();
        let is_form_normal = self.is_form_normal();
        let (centre, covariance) = match is_form_normal {
            true => (relative, of_form),
            false => {
                let slopes = inverse_slopes(&mobility);
                (mobility, slopes * of_form * slopes.transpose())
            }
        };
        let floor = Matrix3::identity() * (1e-30 + 1e-14 * covariance.trace());
        let root = (covariance + floor).cholesky().map(|root| root.unpack());
        let root = root.unwrap_or_default() * (self.half_width() / NORMAL_95).min(1e3);
        normal_nodes().iter().map(move |node| {
            let drawn = centre + matrix(&(root * node.node));
            match is_form_normal {
                true => Some(drawn),
                false => drawn.try_inverse().filter(is_rolling),
            }
        })
    }

    fn gaussian_interval(&self) -> [Option<f64>; 2] {
        if !self.half_width().is_finite() {
            return [None, None];
        }
        let value = |relative: Option<Matrix2<f64>>| {
            let form = relative.map(|relative| form_of(&relative, self.radius));
            form.map_or(f64::INFINITY, |form| form.gaussian_curvature())
        };
        let mut all: Vec<f64> = self.draws().map(value).collect();
        all.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| all[(share * (all.len() - 1) as f64).round() as usize];
        let mean = self.curvature.mean_curvature();
        let [low, high] = self.around(mean, self.std([0.5, 0.5, 0.0]));
        let is_flat = low.is_none_or(|low| low <= 0.0) && high.is_none_or(|high| high >= 0.0);
        // If the object may be flat, the interval of the Gaussian curvature must include 0. The quantiles of the
        // posterior draws may exclude 0, because the product of two small principal curvatures is seldom exactly 0.
        // Therefore extend the interval to 0.
        let largest = if is_flat { 0.0 } else { f64::INFINITY };
        [at(0.025).min(largest), at(0.975)].map(|end| end.is_finite().then_some(end))
    }
}

/// The curvature form `(relative − 1) / radius`.
fn form_of(relative: &Matrix2<f64>, radius: f64) -> CurvatureForm {
    let scale = 1.0 / radius;
    CurvatureForm {
        k_uu: (relative[(0, 0)] - 1.0) * scale,
        k_uv: relative[(0, 1)] * scale,
        k_vv: (relative[(1, 1)] - 1.0) * scale,
    }
}

fn dot(one: &[f64; 3], other: &[f64; 3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}
