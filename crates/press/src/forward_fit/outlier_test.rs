//! Tests for an outlier, which is a marker whose readings contradict the readings of all other markers.

use nalgebra::{DMatrix, DVector};
use palpate_statistics::{Explained, LEFT};

use super::problem::{Problem, WRONG};
use crate::PressError;
use crate::least_squares::{EXACTLY, LeastSquares};
use crate::misfit::Noise;
use crate::unknowns::{CURVATURE, Square, State, Sums, Unknowns};

/// Smallest ratio of an estimated noise to the largest displacement for which outliers and patterns in the residuals
/// are tested. A smaller noise may consist only of rounding errors of the readings.
const ROUNDING: f64 = 1e-3;
/// The tests for outliers and for patterns in the residuals need at least this number of degrees of freedom.
const MIN_FREEDOM: usize = 8;

/// Smallest share of the noise variance of a reading that must remain in its residual. If the share is smaller, the fit
/// follows the noise of this marker, so the marker is compared with a fit without it.
const MIN_RESIDUAL_SHARE: f64 = 0.1;

impl Problem<'_> {
    /// The noise that is used by the tests for outliers and for patterns in the residuals. The result is `None` (no
    /// tests) in three cases: a fit of the Gaussian approximation, hardly more equations than fit parameters, or an
    /// estimated noise that may be only rounding.
    pub(super) fn noise(&self, sums: &Sums) -> Option<Noise> {
        let freedom = self.freedom();
        let largest = self.reading.normal.iter();
        let largest = largest.fold(0.0, |most: f64, one| most.max(one.abs()));
        let is_rounding = !self.knows_noise() && self.normal_std <= ROUNDING * largest;
        if freedom < MIN_FREEDOM || is_rounding || self.fit.body.is_approximate() {
            return None;
        }
        let found = Noise::Found {
            chi_squared: sums.chi_squared,
            freedom,
        };
        Some(self.goodness(sums).map_or(found, Noise::stated_or_found))
    }

    /// The marker whose readings contradict the readings of the other markers most, and the p-value of this
    /// contradiction. Only markers that noticeably influence the estimated curvature are tested. The p-value is
    /// corrected for the number of tested markers.
    pub(super) fn slipped(
        &self,
        state: &State,
        covariance: &Square,
        noise: &Noise,
    ) -> Result<(usize, f64), PressError> {
        let contact = self.contact(state)?;
        let components = self.components();
        let slopes = self.slopes(state)?;
        let variance = covariance[(CURVATURE, CURVATURE)];
        let chance = |(marker, slopes): (usize, [Unknowns; 3])| {
            let slopes = slopes.map(|slopes| self.of_sought(&slopes));
            let by = slopes.map(|slopes| covariance * slopes);
            let moves: f64 = by.iter().map(|by| by[CURVATURE] * by[CURVATURE]).sum();
            // Even an error at the outlier threshold would change the curvature by less than its standard error. The
            // fit rejects markers with larger errors, so this marker is not tested.
            if WRONG * WRONG * moves < variance {
                return None;
            }
            let left = DMatrix::from_fn(components, components, |one, other| {
                f64::from(u8::from(one == other)) - slopes[one].dot(&by[other])
            });
            let residuals = self.residuals_at(&contact, state, marker);
            let residuals = DVector::from_column_slice(&residuals[..components]);
            let mut explained = Explained::by(&[1.0; 3][..components], &left, &residuals, LEFT);
            if left.diagonal().min() < MIN_RESIDUAL_SHARE
                && let Ok(all) = self.sums(state)
            {
                let without = self.without(marker, state);
                let chi_squared = without.map_or(f64::INFINITY, |(_, _, sums)| sums.chi_squared);
                explained = Explained {
                    fall: explained.fall.max(all.chi_squared - chi_squared),
                    freedom: components,
                };
            }
            Some((marker, noise.chance(explained)))
        };
        let counting = self.counting().zip(slopes);
        Ok(least_likely(counting.filter_map(chance)))
    }

    /// The fit without one marker, started from the fit parameters `state` of the fit with all markers. The result is
    /// `None` if the other markers do not determine the press.
    pub(super) fn without(&self, marker: usize, state: &State) -> Option<(Self, State, Sums)> {
        let mut others = self.clone();
        others.kept[marker] = false;
        others.determined().ok()?;
        let (state, sums) = others.minimum(*state, EXACTLY, None).ok()?;
        Some((others, state, sums))
    }

    /// A copy of `slopes`, the derivatives with respect to all fit parameters. In the copy, the derivatives with
    /// respect to parameters that are not fitted are 0.
    pub(super) fn of_sought(&self, slopes: &Unknowns) -> Unknowns {
        Unknowns::from_fn(|unknown, _| match self.fitted.sought[unknown] {
            true => slopes[unknown],
            false => 0.0,
        })
    }
}

/// Finds the marker with the smallest p-value, that is, the marker that is most likely an outlier. Each item of
/// `chances` is the index of a marker and its p-value. Returns the index of the found marker, and its p-value
/// multiplied by the number of markers (Bonferroni; at most 1). Without markers, the result is (0, 1).
fn least_likely(chances: impl Iterator<Item = (usize, f64)>) -> (usize, f64) {
    let (mut most, mut least, mut count) = (0, 1.0, 0.0_f64);
    for (one, chance) in chances {
        count += 1.0;
        if chance < least {
            (most, least) = (one, chance);
        }
    }
    (most, (least * count.max(1.0)).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::least_likely;

    #[test]
    fn the_least_likely_of_many_is_likely() {
        assert_eq!(least_likely((0..200).map(|one| (one, 0.01))), (0, 1.0));
        assert_eq!(least_likely([(3, 0.5), (7, 0.01)].into_iter()), (7, 0.02));
        assert_eq!(least_likely(std::iter::empty()), (0, 1.0));
    }
}
