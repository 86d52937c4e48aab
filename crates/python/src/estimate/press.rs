//! Estimates curvature from presses.

use palpate::config::{PressEstimatorConfig, setting};
use palpate::recorded::{self, PressOptions, PressRecording};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::batch::{batch, in_set};
use super::settings::{given, length_unit, like};
use crate::arrays::Numbers;
use crate::error;
use crate::json::to_python;
use crate::record::{Made, Record, record};
use crate::study::Study;

record!(
    PressEstimate,
    "Curvature of an object, from one press of a soft sphere with markers.\n\nFields: those that `palpate estimate press` prints: `relative_curvature`, `effective_radius`, `object_curvature`,\n`indentation`, `contact_radius` (each with `value`, `std`, `unit` and `interval95`; an end without a bound is NaN),\n`object_radius` (`value` None for a flat object, `convex95`, `concave95`), `principal` (by method elliptic:\n`curvature_max`, `curvature_min`, `axis_deg`, `axis_std_deg`, `semi_axes`), `verdict`, `regime`, `contact`,\n`contact_std`, `force`, `peak_pressure`, `baseline`, `gain`, `wrong_markers`, `noise`, `r_squared`, `contact_seen` (False if\nonly the stated indentation indicates a contact), and `warnings` (each with `code`, `text` and `numbers`)."
);

impl Made for recorded::PressReport {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self)
    }
}

#[doc = include_str!("press_signature.txt")]
/// Curvature of an object, from the displacements of the markers in a soft sphere that is pressed onto the object.
///
/// Parameters
/// ----------
/// positions : array, (n, 2) or (n,)
///     Positions of the markers along the skin at rest, in `length_unit`. The marker (x, y) is at the distance
///     sqrt(x² + y²) from the apex, in the direction (x, y). If the array has one number per marker, the markers are
///     in a row through the apex, and the number is the signed distance from the apex.
/// displacements : array, (n,) or (n, 3)
///     Inward displacement of each marker, in `length_unit`. The optional second and third columns are the
///     displacements along the skin: components along the x and y axes at the apex, parallel-transported along the
///     meridian to the marker.
/// sensor_radius : float
///     Radius of the skin, in `length_unit`; needed unless `like` states it.
/// depth : float, optional
///     Depth of the markers under the skin, in `length_unit`; 0 by default.
/// indentation : float, optional
///     Indentation, in `length_unit`, if another sensor measured it; by default it is fitted.
/// indentation_std : float, optional
///     Standard deviation of the indentation, in `length_unit`; by default 2 % of the indentation.
/// normal_std, tangential_std : float, optional
///     Standard deviations of the displacements inward and along the skin, in `length_unit`; by default estimated from
///     the residuals.
/// radial_scale : float, optional
///     Factor by which the positions are multiplied; 1 by default.
/// young : float, optional
///     Young's modulus of the soft body, force per length². The results `force` and `peak_pressure` need it.
/// length_unit : str, optional
///     Unit of all lengths: "m", "cm", "mm", "um" or "unit", which is the default.
/// like : Study, optional
///     Study of kind press. It supplies the sensor, the noise and the estimator, unless an argument states them.
/// cell : int
///     Number of the study's cell, from 0.
/// threads : int, optional
///     Number of threads that compute a batch; by default one per processor.
#[doc = include_str!("press_settings.txt")]
///
/// Returns
/// -------
/// PressEstimate
///     For displacements of shape (m, n) or (m, n, 3), the result is a Batch of m estimates.
///
/// Raises
/// ------
/// ArgumentError
///     If a shape is wrong, a number is not finite, or a setting is out of its range or has no effect on the method.
/// ReadingsError
///     If the displacements show no contact.
///
/// Source
/// ------
/// X. Lin, L. Willemet, A. Bailleul and M. Wiertlewski, Curvature sensing with a spherical tactile sensor using the
/// color-interference of a marker array, ICRA 2020; K. Johnson, Contact Mechanics, 1985, chapters 3 and 4.
#[pyfunction]
#[pyo3(signature = (positions, displacements, *, length_unit=None, like=None, cell=0, threads=None, **settings),
    text_signature = None)]
#[allow(clippy::too_many_arguments)]
pub(crate) fn estimate_press<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    displacements: &Bound<'py, PyAny>,
    length_unit: Option<&str>,
    like: Option<Bound<'py, Study>>,
    cell: usize,
    threads: Option<usize>,
    settings: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let unit = self::length_unit(length_unit)?;
    let given = given(
        settings.as_ref(),
        [setting::<PressOptions>, setting::<PressEstimatorConfig>],
    )?;
    let base = self::like(like.as_ref(), cell, unit, palpate::press_options)?;
    let positions = Numbers::of("positions", positions)?;
    let places: Vec<[f64; 2]> = match positions.shape() {
        [_] => positions.flat().iter().map(|place| [*place, 0.0]).collect(),
        [_, 2] => positions.rows::<2>().to_vec(),
        found => return Err(error::shape("positions", "(n, 2) or (n,)", found)),
    };
    let displacements = Numbers::of("displacements", displacements)?;
    let markers = places.len();
    let (sets, with_tangential) = match *displacements.shape() {
        [_] => (None, false),
        [_, 3] if markers != 3 => (None, true),
        [first, second] if first == markers && second == 3 => (None, true),
        [sets, of_set] if of_set == markers => (Some(sets), false),
        [sets, of_set, 3] if of_set == markers => (Some(sets), true),
        _ => {
            let wanted =
                format!("({markers},), ({markers}, 3), (m, {markers}) or (m, {markers}, 3)");
            return Err(error::shape(
                "displacements",
                &wanted,
                displacements.shape(),
            ));
        }
    };
    let options = PressOptions::with_settings(base, &given, unit, with_tangential);
    let options = options.map_err(error::setting)?;
    let readings = |set: usize| {
        let flat = displacements.flat();
        let of_set = match sets {
            None => flat,
            Some(sets) => &flat[set * (flat.len() / sets)..][..flat.len() / sets],
        };
        if !with_tangential {
            return PressRecording::new(&places, of_set, None, unit);
        }
        let (rows, _) = of_set.as_chunks::<3>();
        let normal: Vec<f64> = rows.iter().map(|[normal, _, _]| *normal).collect();
        let along: Vec<[f64; 2]> = rows.iter().map(|[_, x, y]| [*x, *y]).collect();
        PressRecording::new(&places, &normal, Some(&along), unit)
    };
    let Some(sets) = sets else {
        let readings = readings(0).map_err(error::recorded)?;
        let object = py.detach(|| recorded::estimate_press(&readings, &options));
        return PressEstimate::of(py, Record::new(object.map_err(error::recorded)?));
    };
    let in_set = |set, error| in_set(set, &["displacements"], error);
    let all = (0..sets).map(|set| readings(set).map_err(|error| in_set(set, error)));
    let all: Vec<PressRecording> = all.collect::<Result<_, _>>().map_err(error::recorded)?;
    let estimate = move |readings| recorded::estimate_press(&readings, &options);
    batch(py, all, threads, estimate, PressEstimate::of)
}
