//! Displacements of single markers, as their pictures tell them.

use std::ops::Range;

use nalgebra::{Matrix3, SMatrix, Vector3, Vector4};

use super::law::State;
use super::problem::Problem;
use super::rest::Rest;
use super::settings::ImageFit;
use super::view::{NUMBERS, Seen, View, difference};
use crate::definite::solve;
use crate::{Estimated, MarkerDisplacement, Measured, PressError, PressEstimate};

/// Step of a displacement by which slopes are found, in radii of the skin.
pub(super) const STEP: f64 = 1e-6;

impl<V: View> ImageFit<V> {
    /// Displacement of each marker beyond those of an estimated press, that its own picture tells: how its discs move against
    /// each other is the press's, and what both move beyond that is the picture's, by least squares. `None` for markers that
    /// are not seen in both frames, and where a picture does not tell all components.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] and [`PressError::NotFinite`] for what is given; [`PressError::OutOfRange`] where there is
    /// no such press.
    pub fn beyond(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        press: &PressEstimate,
    ) -> Result<Vec<Option<MarkerDisplacement>>, PressError> {
        let Estimated { value, std, .. } = press.indentation;
        self.check(rest, seen, Some(Measured { value, std }))?;
        let mut problem = Problem::new(self, rest, seen, None)?;
        let state = State {
            log_curvature: libm::log(press.most_likely_curvature),
            place: self.markers.skin().place(press.contact),
            indentation: press.indentation.value,
            shift: [0.0; 2],
        };
        problem.weigh(&state)?;
        let residuals = problem.own(&problem.residuals(&state)?)?;
        let moved = problem.displaced(&state)?;
        let slopes = problem.by_displacement(&moved, 0..2, STEP * self.markers.skin().radius())?;
        let mut beyond = vec![None; seen.len()];
        for ((at, &marker), slope) in problem.counting.iter().enumerate().zip(&slopes) {
            let residual = residuals.fixed_rows::<NUMBERS>(NUMBERS * at);
            let square: Matrix3<f64> = slope.transpose() * slope;
            let right: Vector3<f64> = slope.transpose() * residual;
            beyond[marker] = solve(&square, &right).map(|more| MarkerDisplacement {
                normal: more[0],
                tangential: [more[1], more[2]],
            });
        }
        Ok(beyond)
    }
}

impl<V: View> Problem<'_, V> {
    /// Slopes of the whitened pictures of the markers that count, by a displacement of these discs, all alike: inward and
    /// along the skin.
    pub(super) fn by_displacement(
        &self,
        moved: &[[MarkerDisplacement; 2]],
        discs: Range<usize>,
        step: f64,
    ) -> Result<Vec<SMatrix<f64, NUMBERS, 3>>, PressError> {
        let at = self.pictures(moved)?;
        let mut slopes = vec![SMatrix::<f64, NUMBERS, 3>::zeros(); self.counting.len()];
        for component in 0..3 {
            let mut beside = moved.to_vec();
            let those = beside.iter_mut().flat_map(|both| &mut both[discs.clone()]);
            for disc in those {
                match component {
                    0 => disc.normal += step,
                    _ => disc.tangential[component - 1] += step,
                }
            }
            let there = self.pictures(&beside)?;
            for ((slope, &marker), whiten) in
                slopes.iter_mut().zip(&self.counting).zip(&self.whiten)
            {
                let (Some(at), Some(there)) = (&at[marker], &there[marker]) else {
                    return Err(PressError::OutOfRange);
                };
                let column = whiten * Vector4::from(difference(there, at)) / step;
                slope.set_column(component, &column);
            }
        }
        Ok(slopes)
    }
}
