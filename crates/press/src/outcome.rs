//! Computes the reported estimate of a press from its best fit, or the error for readings without a detected contact.

use nalgebra::Vector3;
use palpate_statistics::chi_squared_tail;

use crate::least_squares::LeastSquares;
use crate::unknowns::{ACROSS, ALONG, CURVATURE, INDENTATION, Square, State, Sums};
use crate::{Estimated, GoodnessOfFit, PressError, PressEstimate, Verdict};

/// Maximum number of fits of one press. Whenever the search for the 95 % interval finds a better fit, the estimate is
/// computed again from the better fit.
const MAX_FITS: usize = 4;

/// Calls `conclude`, which computes the estimate from a fit. If `conclude` returns a better fit instead of an estimate,
/// this function calls it again with the better fit.
///
/// # Errors
/// Errors of `conclude`, and [`PressError::Undetermined`] if `conclude` returns a better fit again and again.
pub(crate) fn until_best<F>(
    mut fit: F,
    mut conclude: impl FnMut(F) -> Result<Result<PressEstimate, F>, PressError>,
) -> Result<PressEstimate, PressError> {
    for _ in 0..MAX_FITS {
        match conclude(fit)? {
            Ok(estimate) => return Ok(estimate),
            Err(better) => fit = better,
        }
    }
    Err(PressError::Undetermined {
        what: "the sum of squared residuals has no clear minimum",
    })
}

/// The fields of [`PressEstimate`] that fits of displacements compute differently from fits of images.
pub(crate) struct OfReadings {
    pub(crate) relative_curvature: Estimated,
    pub(crate) baseline: Option<Estimated>,
    pub(crate) gain: Option<Estimated>,
    pub(crate) wrong_markers: Vec<usize>,
    pub(crate) normal_std: f64,
    pub(crate) tangential_std: Option<f64>,
    pub(crate) r_squared: f64,
    pub(crate) goodness: Option<GoodnessOfFit>,
}

/// The reported estimate, computed from the minimum of chi-squared. `half_width` is the half-width of a 95 % interval
/// in standard errors.
pub(crate) fn outcome<P: LeastSquares>(
    problem: &P,
    (state, sums): (&State, &Sums),
    covariance: &Square,
    half_width: f64,
    readings: OfReadings,
) -> Result<PressEstimate, PressError> {
    let contact = problem.contact(state)?;
    let stds = Stds::new(problem, state, covariance)?;
    let (skin, _) = problem.press();
    let around = |value: f64, std: f64| Estimated::normal(value, std, half_width).positive();
    let relative_curvature = readings.relative_curvature;
    Ok(PressEstimate {
        sensor_curvature: skin.curvature(),
        relative_curvature,
        most_likely_curvature: contact.relative_curvature,
        principal: None,
        indentation: around(state.indentation, stds.indentation),
        contact_radius: around(contact.radius, stds.contact_radius),
        contact: skin.chart(state.place.direction.as_ref()),
        contact_std: stds.contact,
        baseline: readings.baseline,
        gain: readings.gain,
        wrong_markers: readings.wrong_markers,
        normal_std: readings.normal_std,
        tangential_std: readings.tangential_std,
        r_squared: readings.r_squared,
        reduced_chi_squared: sums.chi_squared / problem.freedom().max(1) as f64,
        goodness: readings.goodness,
        is_detected: true,
        only_marker: None,
        verdict: Verdict::of(relative_curvature.interval, skin.curvature()),
    })
}

pub(crate) struct Stds {
    pub(crate) log_curvature: f64,
    pub(crate) indentation: f64,
    pub(crate) contact_radius: f64,
    pub(crate) contact: [f64; 2],
}

impl Stds {
    /// The standard errors of the estimated quantities, computed from the covariance of the fit parameters. A parameter
    /// that is not fitted has the standard error 0.
    pub(crate) fn new<P: LeastSquares>(
        problem: &P,
        state: &State,
        covariance: &Square,
    ) -> Result<Self, PressError> {
        let sought = &problem.fitted().sought;
        let variance = |one: usize, other: usize| match sought[one] && sought[other] {
            true => covariance[(one, other)],
            false => 0.0,
        };
        let (skin, body) = problem.press();
        let contact = problem.contact(state)?;
        let [_, slope] = body.indentation_of(contact.radius)?;
        // The indentation is δ = C D(a), where C is the relative curvature, a the contact's radius, and D a function of
        // the soft body. Therefore C D' da = dδ − δ d ln C. `of_radius` is the variance of the right side.
        let indentation = state.indentation;
        let of_radius = variance(INDENTATION, INDENTATION)
            - 2.0 * indentation * variance(INDENTATION, CURVATURE)
            + indentation * indentation * variance(CURVATURE, CURVATURE);
        let share = 1.0 / (contact.relative_curvature * slope);
        // If all markers lie on a great circle, the axes of the fitted place point along and across this circle.
        // Convert the standard errors to the axes of the skin.
        let axes = skin.place_at(state.place.direction.as_ref());
        let along = |axis: &Vector3<f64>| {
            let (x, y) = (axis.dot(&state.place.x_axis), axis.dot(&state.place.y_axis));
            let squared = x * x * variance(ALONG, ALONG)
                + 2.0 * x * y * variance(ALONG, ACROSS)
                + y * y * variance(ACROSS, ACROSS);
            squared.max(0.0).sqrt()
        };
        Ok(Self {
            log_curvature: variance(CURVATURE, CURVATURE).sqrt(),
            indentation: variance(INDENTATION, INDENTATION).sqrt(),
            contact_radius: share * of_radius.max(0.0).sqrt(),
            contact: [along(&axes.x_axis), along(&axes.y_axis)],
        })
    }
}

/// Significance level of the test whether the markers moved.
const SIGNIFICANCE_LEVEL: f64 = 1e-6;

/// Returns the error for a press without a detected contact: the fitted contact decreases chi-squared by `improvement`,
/// which is less than `needed`. The error is [`PressError::OtherBody`] if the markers moved significantly, otherwise
/// [`PressError::NoContact`]. `squares` contains one value per marker: chi-squared of the hypothesis that the marker
/// did not move. Each value is a sum over `each` readings. The marker that moved most is ignored in this test, because
/// it may be an outlier.
pub(crate) fn no_contact(
    (improvement, needed): (f64, f64),
    squares: impl Iterator<Item = f64>,
    each: usize,
) -> PressError {
    let mut squares: Vec<f64> = squares.collect();
    squares.sort_by(|one, other| other.total_cmp(one));
    let others = squares.get(1..).unwrap_or_default();
    let (chi_squared, freedom) = (others.iter().sum(), each * others.len());
    let second = others.first().copied().unwrap_or(0.0);
    // `two` is the p-value of the marker that moved second most. It is multiplied by the number of markers, because
    // this marker was chosen among all markers.
    let two = squares.len().max(1) as f64 * chi_squared_tail(second, each);
    match chi_squared_tail(chi_squared, freedom).min(two * two) < SIGNIFICANCE_LEVEL {
        true => PressError::OtherBody {
            chi_squared,
            freedom,
        },
        false => PressError::NoContact {
            improvement,
            needed,
        },
    }
}
