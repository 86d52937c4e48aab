//! Computes the displacement of each marker that remains after subtracting the fitted press.

use nalgebra::{Matrix3, Vector3};

use super::image_problem::Problem;
use super::view::{NUMBERS, Seen};
use super::{ImageFit, Rest};
use crate::least_squares::solve;
use crate::unknowns::State;
use crate::{Estimated, MarkerDisplacement, Measured, PressError, PressEstimate};

impl ImageFit {
    /// For each marker, its actual displacement minus the displacement that the estimated press causes. The difference
    /// is estimated by least squares from the image of this marker alone. It is assumed to be the same for both discs
    /// of the marker. The result is `None` for a marker that is not visible in both frames, and for a marker whose
    /// image does not determine all components of the difference.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] and [`PressError::NotFinite`] for invalid settings and readings;
    /// [`PressError::OutOfRange`] if the press is impossible.
    pub fn beyond(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        press: &PressEstimate,
    ) -> Result<Vec<Option<MarkerDisplacement>>, PressError> {
        let Estimated { value, std, .. } = press.indentation;
        self.check(rest, seen, Some(Measured { value, std }))?;
        let mut problem = Problem::new(self, rest, seen, None)?;
        let state = State::new(
            press.most_likely_curvature,
            self.markers.skin().place(press.contact),
            press.indentation.value,
            [0.0; 2],
        );
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
