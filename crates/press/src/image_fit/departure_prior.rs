//! Prior of a sensor's departures from another source than the frame at rest.

use nalgebra::{DMatrix, DVector};

use crate::PressError;

/// Prior of some common departures, from another frame of the same sensor or from the frame at rest itself. The fit then uses
/// no information on them from the frame at rest, so that no frame counts twice. The frame still determines the other
/// departures and the misalignments, conditional on these.
#[derive(Clone, Debug, PartialEq)]
pub struct DeparturePrior {
    /// Numbers of the departures, in ascending order; none of them is exact.
    pub numbers: Vec<usize>,
    /// Covariance of the departures, in the order of their numbers and in their units.
    pub covariance: DMatrix<f64>,
}

/// The prior in the form of the equations of a frame at rest.
pub(super) struct FreePrior {
    /// Indices of the departures among the free ones.
    places: Vec<usize>,
    /// Inverse of their covariance, in their standard deviations.
    precision: DMatrix<f64>,
}

impl DeparturePrior {
    /// The prior among the departures that are not exact, from the standard deviations of all.
    pub(super) fn of_free(&self, stds: &[f64]) -> Result<FreePrior, PressError> {
        let Self {
            numbers,
            covariance,
        } = self;
        let is_free = |number: &usize| stds.get(*number).is_some_and(|std| *std > 0.0);
        let place = |number: &usize| is_free(number).then(|| (0..*number).filter(is_free).count());
        let places: Option<Vec<usize>> = numbers.iter().map(place).collect();
        let places = places.filter(|_| numbers.is_sorted_by(|one, next| one < next));
        let count = numbers.len();
        let unless = |is_good: bool, value: usize, expected: &'static str| {
            PressError::unless_good("departure_prior", value as f64, is_good, expected)
        };
        let expected = "numbers of departures that are not exact, in ascending order";
        unless(places.is_some(), count, expected)?;
        let is_square = covariance.shape() == (count, count);
        let expected = "as many rows and columns as departures";
        unless(is_square, covariance.nrows(), expected)?;
        let scaled = DMatrix::from_fn(count, count, |row, column| {
            covariance[(row, column)] / (stds[numbers[row]] * stds[numbers[column]])
        });
        let is_symmetric = (&scaled - scaled.transpose()).amax() <= 1e-9 * scaled.amax();
        let precision = scaled.cholesky().map(|factor| factor.inverse());
        let precision =
            precision.filter(|all| is_symmetric && all.iter().all(|entry| entry.is_finite()));
        let expected = "departures whose covariance is symmetric and positive definite";
        unless(precision.is_some(), count, expected)?;
        Ok(FreePrior {
            places: places.unwrap_or_default(),
            precision: precision.unwrap_or_default(),
        })
    }
}

impl FreePrior {
    /// Replaces the information of a frame on the departures of the prior by the prior. With the departures C of the prior and
    /// the others D, the conditional distribution of D given C does not change; the marginal distribution of C becomes the
    /// prior. `None` if the equations do not determine D.
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
