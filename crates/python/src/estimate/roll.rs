//! Estimates curvature from rolls.

use std::sync::{Mutex, PoisonError};

use palpate::config::{LengthUnit, RollEstimatorConfig, setting};
use palpate::recorded::{self, RollOptions, RollRecording, RollSettings};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::batch::{batch, in_set};
use super::settings::{given, length_unit, like};
use crate::arrays::{Numbers, array};
use crate::error;
use crate::json::to_python;
use crate::record::{Alone, Made, Record, record};
use crate::study::Study;

record!(
    RollEstimate,
    "Curvature of an object at a point, from small rolls.\n\nFields: those that `palpate estimate roll` prints, for example `normal_curvature_u`, `normal_curvature_v`,\n`gaussian_curvature`, `mean_curvature` (each with `value`, `std` or None, `interval95` and `unit`),\n`principal_curvature_min`, `principal_curvature_max`, `principal_direction_max_deg` (from +u towards +v),\n`single_direction` (None, or the curvature along rolls of a single direction, then the others are open),\n`residual_rms`, `std_from`, `class_`, `class_probabilities`, `thresholds`, `unresolved_probes`, `left_out` (rolls with row or probe and a reason),\n`p_value`, for time series `terms` and `bounds`, and `warnings`\n(each with `code`, `text` and `numbers`); and `covariance`, (3, 3), of the normal\ncurvatures along u and v and the twist k_uv, 1/length², NaN if the noise is unknown.",
    p_value,
    normal_curvature_u,
    normal_curvature_v,
    gaussian_curvature,
    mean_curvature
);

impl Made for recorded::RollEstimate {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self)
    }

    fn alone(&self, name: &str) -> Option<Alone> {
        if name == "p_value" {
            return Some(Alone::Number(self.p_value()));
        }
        let values = self.values();
        Some(Alone::Value(match name {
            "normal_curvature_u" => values.normal_curvature_u,
            "normal_curvature_v" => values.normal_curvature_v,
            "gaussian_curvature" => values.gaussian_curvature,
            "mean_curvature" => values.mean_curvature,
            "arc_length" => values.arc_length,
            "principal_curvature_min" => values.principal_curvature_min,
            "principal_curvature_max" => values.principal_curvature_max,
            "residual_rms" => values.residual_rms,
            "principal_direction_max_deg" => {
                return Some(Alone::Number(values.principal_direction_max_deg));
            }
            _ => return None,
        }))
    }

    fn others(&self) -> &'static [&'static str] {
        &["covariance"]
    }

    fn other<'py>(&self, py: Python<'py>, _: &str) -> PyResult<Bound<'py, PyAny>> {
        let covariance = self.covariance().unwrap_or([[f64::NAN; 3]; 3]);
        array(py, covariance.as_flattened().to_vec(), &[3, 3])
    }
}

/// Curvature of an object at a point, from small rolls of a spherical probe on the object.
///
/// Parameters
/// ----------
/// rotations : array, (n, 2) or (n, 3)
///     Rotation vector of each roll, rad; at least two rolls are needed. The components are about the axes u and v of
///     the first contact, and optionally about the normal, which does not move the contact. If the contact moves to
///     +u, the rotation about v is negative.
/// shifts : array, (n, 2)
///     Displacement of the contact point on the probe in each roll, along u and v, measured along a great circle, in
///     `length_unit`. With `times`, the position of the contact at each sample, or the centre of the active pad if
///     `pitch` is stated.
/// times : array, (n,), optional
///     Times of samples, s. With `times`, each row is one sample of a roll, with the rotation since the start of its
///     roll. A new roll starts where the time does not increase.
/// probe_radius : float
///     Radius of the probe, in `length_unit`; needed unless `like` states it.
/// pitch : float, optional
///     Pitch of the pads that read the shifts, in `length_unit`. It determines the standard deviations of the shifts
///     and, if the contact did not move in a roll, the upper bound of the object's radius.
/// shift_std : float, optional
///     Standard deviation of each component of a shift, in `length_unit`, for a sensor without pads.
/// rotation_std_rad : float, optional
///     Standard deviation of each component of a rotation, rad, from 0 to pi. Samples of a time series have independent
///     errors.
/// relative_rotation_std : float, optional
///     Standard deviation of each component of a rotation, divided by this component, from 0 to 1.
/// pad_layout : str, optional
///     Arrangement of the pads, for time series: "square", which is the default, or "hexagonal".
/// start : array, (2,), optional
///     Contact point at the start of every time series, in the coordinates of the pads and in `length_unit`; unknown by
///     default.
/// method : str, optional
///     "least-squares", the default, which uses only the start and the end of each roll; or a method for time series:
///     "pad-edge", "trajectory" or "auto".
/// length_unit : str, optional
///     Unit of all lengths: "m", "cm", "mm", "um" or "unit", which is the default.
/// like : Study, optional
///     Study of kind roll. It supplies the probe, the noise and the estimator, unless an argument states them.
/// cell : int
///     Number of the study's cell, from 0.
/// threads : int, optional
///     Number of threads that compute a batch; by default one per processor.
///
/// Returns
/// -------
/// RollEstimate
///     For arrays of shape (m, n, 2), the result is a Batch of m estimates. If one of the arrays has the shape (n, 2),
///     all m sets share it.
///     If no noise is stated, the standard deviations are estimated from the residuals.
///
/// Raises
/// ------
/// ArgumentError
///     If an array has a wrong shape or a number that is not finite, or if a setting is out of its range.
/// ReadingsError
///     If the readings do not determine the curvature: for example, all rotations have one direction, a contact did not
///     move or moved against the roll, or a shift is longer than half the circumference of the probe.
///
/// Source
/// ------
/// M. Charlebois, K. Gupta and S. Payandeh, Curvature Based Shape Estimation Using Tactile Sensing, ICRA 1996,
/// equations 2 to 4; D. Montana, The Kinematics of Contact and Grasp, 1988.
///
/// Examples
/// --------
/// >>> # A probe of radius 10 turns by 0.3 on a ball of radius 20. Its contact moves by 2.
/// >>> estimate = palpate.estimate_roll([[0, -0.3], [0.3, 0]], [[2, 0], [0, 2]], probe_radius=10)
/// >>> round(estimate.mean_curvature.value, 12)
/// 0.05
#[pyfunction]
#[pyo3(signature = (rotations, shifts, *, times=None, length_unit=None, like=None, cell=0, threads=None, **settings),
    text_signature = "(rotations, shifts, *, probe_radius=None, pitch=None, shift_std=None, rotation_std_rad=None, \
    relative_rotation_std=None, pad_layout=None, start=None, times=None, method=None, length_unit=None, like=None, cell=0, threads=None)")]
#[allow(clippy::too_many_arguments)]
pub(crate) fn estimate_roll<'py>(
    py: Python<'py>,
    rotations: &Bound<'py, PyAny>,
    shifts: &Bound<'py, PyAny>,
    times: Option<&Bound<'py, PyAny>>,
    length_unit: Option<&str>,
    like: Option<Bound<'py, Study>>,
    cell: usize,
    threads: Option<usize>,
    settings: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let unit = self::length_unit(length_unit)?;
    let options = options(py, settings, unit, (like, cell))?;
    let rotations = Numbers::of("rotations", rotations)?;
    let shifts = Numbers::of("shifts", shifts)?;
    let (turned, columns) = rotations.sets(&[2, 3], "(n, 2), (n, 3), (m, n, 2) or (m, n, 3)")?;
    let (moved, _) = shifts.sets(&[2], "(n, 2) or (m, n, 2)")?;
    if let Some(times) = times {
        let times = Numbers::of("times", times)?;
        if turned.or(moved).is_some() || times.shape().len() != 1 {
            return Err(error::shape(
                "times",
                "(n,), with rotations (n, 2)",
                times.shape(),
            ));
        }
        let has_pads = options.series.pads.is_some();
        let (times, places) = (times.flat(), shifts.set(0));
        let readings = match columns {
            2 => RollRecording::of_series(times, rotations.set::<2>(0), places, has_pads, unit),
            _ => RollRecording::of_series(times, rotations.set::<3>(0), places, has_pads, unit),
        };
        let estimate = readings.and_then(|readings| recorded::estimate_roll(readings, &options));
        return RollEstimate::of(py, Record::new(estimate.map_err(error::recorded)?));
    }
    let readings = |set: usize| match columns {
        2 => RollRecording::new(rotations.set::<2>(set), shifts.set(set), unit),
        _ => RollRecording::new(rotations.set::<3>(set), shifts.set(set), unit),
    };
    let Some(sets) = turned.or(moved) else {
        let estimate = readings(0).and_then(|readings| recorded::estimate_roll(readings, &options));
        let estimate = estimate.map_err(error::recorded)?;
        return RollEstimate::of(py, Record::new(estimate));
    };
    if moved.is_some_and(|moved| moved != sets) {
        let wanted = format!("(n, 2) or ({sets}, n, 2) as in `rotations`,");
        return Err(error::shape("shifts", &wanted, shifts.shape()));
    }
    let with_sets = [("rotations", turned), ("shifts", moved)];
    let with_sets = with_sets.map(|(name, sets)| sets.map_or("", |_| name));
    let all = (0..sets).map(|set| readings(set).map_err(|error| in_set(set, &with_sets, error)));
    let all = all.collect::<Result<_, _>>().map_err(error::recorded)?;
    let estimate = move |readings| recorded::estimate_roll(readings, &options);
    batch(py, all, threads, estimate, RollEstimate::of)
}

type Call = (Py<PyDict>, Option<LengthUnit>, RollOptions);

/// Settings and parsed options of the last call without the argument `like`. A loop over readings calls with the same
/// settings, and parsing settings takes longer than an estimate, so the options are used again.
static LAST: Mutex<Option<Call>> = Mutex::new(None);

fn options<'py>(
    py: Python<'py>,
    settings: Option<Bound<'py, PyDict>>,
    unit: Option<LengthUnit>,
    (like, cell): (Option<Bound<'py, Study>>, usize),
) -> PyResult<RollOptions> {
    let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    let settings = settings.unwrap_or_else(|| PyDict::new(py));
    // Release the lock before the comparison, because the comparison may run Python code that needs the lock.
    let known = last()
        .as_ref()
        .map(|(settings, unit, options)| (settings.clone_ref(py), *unit, options.clone()));
    if let Some((known, of_unit, options)) = known.filter(|_| like.is_none())
        && of_unit == unit
        && settings.eq(known).unwrap_or(false)
    {
        return Ok(options);
    }
    let tables = [setting::<RollSettings>, setting::<RollEstimatorConfig>];
    let given = given(Some(&settings), tables)?;
    let base = self::like(like.as_ref(), cell, unit, palpate::roll_options)?;
    let options = RollOptions::with_settings(base, &given, unit).map_err(error::setting)?;
    if like.is_none() {
        // Drop the previous settings only after the lock is released, because dropping them may run Python code.
        let _previous = last().replace((settings.unbind(), unit, options.clone()));
    }
    Ok(options)
}
