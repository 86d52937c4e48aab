//! Departures of a sensor that something else than the frame at rest tells.

use nalgebra::{DMatrix, DVector};

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

impl Told {
    /// These departures among those that are not exact, by the standard deviations of all.
    pub(super) fn known(&self, stds: &[f64]) -> Result<Known, PressError> {
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
            PressError::unless_good("told", value as f64, is_good, expected)
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
        Ok(Known {
            places: places.unwrap_or_default(),
            precision: precision.unwrap_or_default(),
        })
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
