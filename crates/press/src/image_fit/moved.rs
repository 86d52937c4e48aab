//! Displacements of single markers, as their pictures tell them.

use nalgebra::{Matrix3, Vector3};

use super::law::State;
use super::problem::Problem;
use super::rest::Rest;
use super::settings::ImageFit;
use super::view::{NUMBERS, Seen, View};
use crate::definite::solve;
use crate::{Estimated, MarkerDisplacement, Measured, PressError, PressEstimate};

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
        let slopes = problem.by_displacements(&moved)?.displacements;
        let mut beyond = vec![None; seen.len()];
        for ((at, &marker), whiten) in problem.counting.iter().enumerate().zip(&problem.whiten) {
            let [magenta, yellow] = &slopes[marker];
            let slope = whiten * (magenta + yellow);
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
