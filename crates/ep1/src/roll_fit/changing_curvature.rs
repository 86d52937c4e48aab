//! Tests whether the curvature changes along the rolls.

use nalgebra::{Matrix2, SMatrix, SVector};

use super::{FitNoise, RollData, RollFit, SeriesFit, inverse_of};

/// Second derivative of the curvature k along a parabola at its apex, divided by k³.
const APEX: f64 = -3.0;
/// The readings exclude a change of the curvature that differs from the estimated change by more than this number of
/// standard errors.
const MAX_DEVIATION: f64 = 2.0;

/// How a possible change of the curvature along the rolls affects a fit of a constant curvature.
#[derive(Clone, Debug)]
pub(crate) struct Changed {
    /// The decreases of chi-squared if the curvature changes, each with the number of additional coefficients. The
    /// three kinds of change are any linear change, any linear and quadratic change, and the change along a paraboloid
    /// from its apex. A kind that the readings do not determine is left out.
    pub(crate) falls: Vec<(f64, usize)>,
    /// Error of the fit, in standard errors, if the object is a paraboloid and the rolls start at its apex. It is 0 if
    /// the readings exclude this object.
    pub(crate) of_paraboloid: f64,
}

impl SeriesFit<3> {
    /// The effect of a change of the curvature along the rolls, to first order.
    pub(crate) fn changed(&self, rolls: &[RollData], noise: &FitNoise) -> Changed {
        let mut shape = self.shape;
        shape.terms = 3;
        let mut information = SMatrix::<f64, 12, 12>::zeros();
        let (mut gradient, mut path) = (SVector::<f64, 12>::zeros(), Vec::new());
        for (roll, fitted) in rolls.iter().zip(&self.rolls) {
            let mut state = RollFit::new(roll);
            (state.start, state.error, state.ratio) = (fitted.start, fitted.error, fitted.ratio);
            let covariance = SMatrix::zeros();
            if let Some(()) = state.linearise(roll, noise, &shape, &covariance, &mut path) {
                information += state.information;
                gradient += state.gradient;
            }
        }
        // The second derivative of the curvature at the apex of a paraboloid is proportional to the symmetric part of
        // the product of k and k², where k is the curvature form.
        let form = shape.relative() - Matrix2::identity();
        let [[a, b], [_, c]]: [[f64; 2]; 2] = form.into();
        let [[d, e], [_, f]]: [[f64; 2]; 2] = (form * form).into();
        let bend = [
            a * d,
            0.5 * (a * e + b * d),
            (a * f + c * d + 4.0 * b * e) / 6.0,
            0.5 * (b * f + c * e),
            c * f,
        ];
        let mut apex = SMatrix::<f64, 12, 4>::identity();
        apex.set_column(
            3,
            &SVector::from_fn(|row, _| if row < 7 { 0.0 } else { bend[row - 7] }),
        );
        let constant = fall(&information, &gradient, &SMatrix::<f64, 12, 3>::identity());
        let linear = fall(&information, &gradient, &SMatrix::<f64, 12, 7>::identity());
        let any = fall(&information, &gradient, &SMatrix::<f64, 12, 12>::identity());
        let falls = [
            (linear, 4),
            (any, 9),
            (fall(&information, &gradient, &apex), 1),
        ];
        let fell = |(fall, more): (Option<f64>, usize)| Some((fall? - constant?, more));
        // The information about the coefficient of `bend` that remains if the curvature form is unknown.
        let (own, along) = (apex.tr_mul(&(information * apex)), apex.tr_mul(&gradient));
        let form = own.fixed_view::<3, 3>(0, 0).into_owned();
        let response = inverse_of(&form).unwrap_or_default() * own.fixed_view::<3, 1>(0, 3);
        let rest = own[(3, 3)] - response.dot(&own.fixed_view::<3, 1>(0, 3));
        let slope = along[3] - response.dot(&along.fixed_rows::<3>(0));
        let is_possible = (slope - APEX * rest).powi(2) <= MAX_DEVIATION * MAX_DEVIATION * rest;
        let error = APEX.abs() * response.dot(&(form * response)).sqrt();
        Changed {
            falls: falls.into_iter().filter_map(fell).collect(),
            of_paraboloid: if is_possible { error } else { 0.0 },
        }
    }
}

/// The decrease of chi-squared in a linear fit whose unknowns are the coefficients of the columns of `basis`. `None` if
/// the readings do not determine them.
fn fall<const N: usize>(
    information: &SMatrix<f64, 12, 12>,
    gradient: &SVector<f64, 12>,
    basis: &SMatrix<f64, 12, N>,
) -> Option<f64> {
    let along = basis.tr_mul(gradient);
    let inverse = inverse_of(&basis.tr_mul(&(information * basis)))?;
    Some(along.dot(&(inverse * along)))
}
