//! A prior of sensor deviations (differences between the sensor's parameters and their nominal values) that comes from
//! another frame or from an earlier fit.

use nalgebra::{DMatrix, DVector};

use crate::PressError;

/// A prior of some sensor deviations, which are differences between the sensor's parameters and their nominal values.
/// It comes from another frame of the same sensor, or from an earlier fit of the frame at rest itself. The prior
/// replaces the information that the frame at rest contains on these sensor deviations, so that no frame is used twice.
/// The frame at rest still determines the remaining sensor deviations and the misalignments.
#[derive(Clone, Debug, PartialEq)]
pub struct DeparturePrior {
    /// Indices (in [`SensorState::common`](crate::SensorState::common)) of the sensor deviations of this prior, in
    /// ascending order. The standard deviations of these sensor deviations must not be 0.
    pub numbers: Vec<usize>,
    /// Covariance of the sensor deviations of this prior, in the order of `numbers` and in the units of the deviations.
    pub covariance: DMatrix<f64>,
}

/// A [`DeparturePrior`] in the form that a fit of the frame at rest needs. It refers to the list of the uncertain
/// sensor deviations. Each sensor deviation is in units of its stated standard deviation.
pub(super) struct FreePrior {
    /// For each sensor deviation of the prior, its position in the list of all uncertain sensor deviations.
    places: Vec<usize>,
    /// Inverse of the covariance matrix of the prior's sensor deviations, where each sensor deviation is divided by its
    /// stated standard deviation.
    precision: DMatrix<f64>,
}

impl DeparturePrior {
    /// Converts the prior to the form that the equations of a fit need. `stds` contains the prior standard deviations
    /// of all sensor parameters. The value 0 means that a sensor parameter is exact; a prior of an exact parameter is
    /// an error.
    pub(super) fn of_free(&self, stds: &[f64]) -> Result<FreePrior, PressError> {
        let (numbers, covariance) = (&self.numbers, &self.covariance);
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
    /// Inserts the prior into the equations of a frame. The prior replaces the information of the frame on the sensor
    /// deviations to which the prior applies. Let C be the sensor deviations in the prior, and D the other sensor
    /// deviations. The conditional distribution of D given C does not change, and the marginal distribution of C
    /// becomes the prior. The result is `None` if the equations do not determine D.
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
