//! Principal curvatures, their direction and the radius. Rolls and glides report these quantities only if the config
//! has `principal_curvatures`.

use crate::scene::Observer;
use palpate_geometry::{CurvatureForm, UNKNOWN_DIRECTION_STD};
use palpate_statistics::HALF_WIDTHS;
use palpate_study::Quantity;
use palpate_sweep::Observation;

/// Largest difference between equal principal curvatures that rounding errors cause, relative to the curvature with the
/// larger magnitude. If the difference is smaller, the point is an umbilic: every direction is principal.
const UMBILIC_TOLERANCE: f64 = 1e-9;

/// Curvatures at a point of the object, either true or estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PointCurvature {
    /// k_min, k_max and the mean curvature, 1/length, and the angle of the direction of k_min, rad. True angles are
    /// shifted by half turns, so that the angles of neighbouring points are near each other. A half turn does not
    /// change an axis.
    pub(crate) values: [f64; 4],
    /// Standard errors of the values; `None` for true values, and for an estimator without standard errors.
    pub(crate) stds: [Option<f64>; 4],
    /// Whether the estimator's own 50, 80 and 95 % intervals of k_min, k_max and the mean curvature contain the true
    /// value; `None` if the estimator states no intervals.
    pub(crate) interval_holds: [Option<[bool; 3]>; 3],
}

impl PointCurvature {
    /// Curvatures of `form`, with the angle from the first axis of the form to the direction of k_min. `stds` are the
    /// standard errors of k_min, k_max and the angle; `mean_std` is the standard error of the mean curvature.
    pub(crate) fn of(form: &CurvatureForm, stds: Option<[f64; 3]>, mean_std: Option<f64>) -> Self {
        let principal = form.principal();
        let axis_deg = half_turn(principal.angle_of_max_rad.to_degrees() + 90.0);
        let std = |place: usize| finite(stds?[place]);
        Self {
            values: [
                principal.k_min,
                principal.k_max,
                form.mean_curvature(),
                axis_deg.to_radians(),
            ],
            stds: [std(0), std(1), mean_std, std(2)],
            interval_holds: [None; 3],
        }
    }

    fn is_umbilic(&self) -> bool {
        let [min, max, ..] = self.values;
        max - min <= UMBILIC_TOLERANCE * min.abs().max(max.abs())
    }

    /// Compares an estimated value with its true value. `place` is the index of both in [`PointCurvature::values`].
    pub(crate) fn measured(&self, truth: &Self, place: usize) -> Observation {
        Observation {
            std: self.stds[place],
            interval_holds: self.interval_holds[place],
            ..Observation::plain(self.values[place], truth.values[place])
        }
    }

    /// Compares a quantity of this estimate with its true value; `None` if either value is undefined.
    pub(crate) fn outcome(&self, truth: &Self, quantity: Quantity) -> Option<Observation> {
        let outcome = match quantity {
            Quantity::PRINCIPAL_CURVATURE_MIN => self.measured(truth, 0),
            Quantity::PRINCIPAL_CURVATURE_MAX => self.measured(truth, 1),
            Quantity::OBJECT_RADIUS if truth.is_umbilic() => {
                let mean = self.measured(truth, 2);
                let error = (mean.estimate - mean.truth).abs();
                let holds = |std: f64| HALF_WIDTHS.map(|width| error <= width * std);
                let radius = mean.estimate.recip();
                // The radius is the inverse of the curvature, so the limits of its interval are the inverses of the
                // limits of the curvature's interval.
                Observation {
                    std: mean.std.and_then(|std| finite(std * radius * radius)),
                    interval_holds: mean.interval_holds.or_else(|| mean.std.map(holds)),
                    ..Observation::plain(radius, mean.truth.recip())
                }
            }
            Quantity::AXIS_DEG if !self.is_umbilic() && !truth.is_umbilic() => {
                let [axis, truth] = [self, truth].map(|one| one.values[3].to_degrees());
                // Angles that differ by half a turn describe the same axis. Of these angles, report the one nearest to
                // the true angle.
                Observation {
                    std: self.stds[3].map(f64::to_degrees),
                    ..Observation::plain(truth + half_turn(axis - truth), truth)
                }
            }
            Quantity::AXIS_UNDETERMINED => {
                let is_large = |std| std >= UNKNOWN_DIRECTION_STD;
                let is_undetermined = self.stds[3].map_or(self.is_umbilic(), is_large);
                let [share, truth] = [is_undetermined, truth.is_umbilic()].map(u8::from);
                Observation::plain(f64::from(share), f64::from(truth))
            }
            _ => return None,
        };
        Some(outcome).filter(|one| (one.estimate - one.truth).is_finite())
    }

    /// Calls `observe` with each quantity of the scene (`quantities`) that this estimate determines.
    pub(crate) fn report(&self, truth: &Self, quantities: &[Quantity], observe: Observer<'_>) {
        for (place, quantity) in quantities.iter().enumerate() {
            if let Some(outcome) = self.outcome(truth, *quantity) {
                observe(place, outcome);
            }
        }
    }
}

/// Shifts the angles of axes by half turns, so that they are within 90 degrees of their mean axis and can be averaged.
/// Without this shift, axes near +90 and −90 degrees would have a mean angle near 0.
pub(crate) fn align_axes<'a>(points: impl Iterator<Item = &'a mut PointCurvature>) {
    let mut points: Vec<_> = points.filter(|point| !point.is_umbilic()).collect();
    let doubled = points.iter().map(|point| 2.0 * point.values[3]);
    let sines: f64 = doubled.clone().map(libm::sin).sum();
    let mean = 0.5 * libm::atan2(sines, doubled.map(libm::cos).sum());
    for point in &mut points {
        let offset_deg = half_turn((point.values[3] - mean).to_degrees());
        point.values[3] = mean + offset_deg.to_radians();
    }
}

/// Moves the angle of an axis into the range from −90 to 90 degrees, by half turns, which do not change the axis.
pub(crate) fn half_turn(degrees: f64) -> f64 {
    degrees - 180.0 * (degrees / 180.0).round()
}

pub(crate) fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}
