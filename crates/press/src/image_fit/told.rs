//! Departures of a sensor that something else than the frame at rest tells.

use nalgebra::{DMatrix, DVector};

use super::settings::ImageFit;
use super::view::View;
use crate::PressError;

/// Common departures that another frame of the same sensor told, or the very frame at rest: that frame is then taken to
/// tell no more of them, so that what it says is not counted twice. Other departures and misalignments follow from it as
/// they do where these are known.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Numbers of the departures, in ascending order; none of them is exact.
    pub numbers: Vec<usize>,
    /// Covariance of the departures, in the order of their numbers and in their units.
    pub covariance: DMatrix<f64>,
}

/// Departures that are told, as the equations of a frame at rest take them.
pub(super) struct Known {
    /// Places of the departures among those that are free.
    places: Vec<usize>,
    /// Inverse of their covariance, in their standard deviations.
    precision: DMatrix<f64>,
}

impl<V: View> ImageFit<V> {
    /// Departures that are told, if any are.
    pub(super) fn known(&self) -> Result<Option<Known>, PressError> {
        let Some(Told {
            numbers,
            covariance,
        }) = &self.told
        else {
            return Ok(None);
        };
        let refused = |value: f64, expected: &'static str| {
            PressError::unless_good("told", value, false, expected).map(|_| None)
        };
        let free = self.free();
        let place = |number: &usize| free.binary_search(number).ok();
        let places: Option<Vec<usize>> = numbers.iter().map(place).collect();
        let is_ascending = numbers.is_sorted_by(|one, next| one < next);
        let count = numbers.len();
        let Some(places) = places.filter(|_| is_ascending) else {
            let expected = "numbers of departures that are not exact, in ascending order";
            return refused(count as f64, expected);
        };
        if covariance.shape() != (count, count) {
            let expected = "as many rows and columns as departures";
            return refused(covariance.nrows() as f64, expected);
        }
        let scaled = DMatrix::from_fn(count, count, |row, column| {
            let stds = self.common_stds[numbers[row]] * self.common_stds[numbers[column]];
            covariance[(row, column)] / stds
        });
        let is_symmetric = (&scaled - scaled.transpose()).amax() <= 1e-9 * scaled.amax();
        let precision = scaled.cholesky().map(|factor| factor.inverse());
        let precision = precision.filter(|all| all.iter().all(|entry| entry.is_finite()));
        match precision.filter(|_| is_symmetric) {
            Some(precision) => Ok(Some(Known { places, precision })),
            None => refused(
                count as f64,
                "departures whose covariance is symmetric and positive definite",
            ),
        }
    }
}

impl Known {
    /// Takes what a frame says of the departures that are told out of its equations, and puts what is told in its place.
    /// With C and D the told and the other departures: what the frame says of D for each C stays as it is, and C alone has
    /// the information that is told. `None` where the equations do not determine D.
    pub(super) fn cut(
        &self,
        common: &DVector<f64>,
        information: &mut DMatrix<f64>,
        right: &mut DVector<f64>,
    ) -> Option<()> {
        let Self { places, precision } = self;
        let others: Vec<usize> = (0..common.len())
            .filter(|place| !places.contains(place))
            .collect();
        let mut square = precision.clone();
        let mut vector = -precision * common.select_rows(places);
        if !others.is_empty() {
            let across = information.select_rows(places).select_columns(&others);
            let among = information.select_rows(&others).select_columns(&others);
            let factor = among.cholesky()?;
            square += &across * factor.solve(&across.transpose());
            vector += &across * factor.solve(&right.select_rows(&others));
        }
        for (row, &at) in places.iter().enumerate() {
            right[at] = vector[row];
            for (column, &beside) in places.iter().enumerate() {
                information[(at, beside)] = square[(row, column)];
            }
        }
        Some(())
    }
}
