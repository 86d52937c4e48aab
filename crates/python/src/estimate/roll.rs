//! Estimates from rolls.

use numpy::PyArrayMethods;
use palpate::config::{RollEstimatorConfig, setting};
use palpate::recorded::{
    self, RecordedError, RollOptions, RollRecording, RollSets, RollSettings, SetRow,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayon::prelude::*;

use super::batch::{place, words};
use super::like::like;
use super::settings::{given, length_unit};
use crate::arrays::{Numbers, array};
use crate::error;
use crate::json::to_python;
use crate::record::{Made, Record, record};
use crate::study::Study;
use crate::watch::{Watch, pool, watched};

record!(
    RollEstimate,
    "Curvature of an object at a point, from small rolls.\n\nFields: what `palpate estimate roll` prints, among them `normal_curvature_u`, `normal_curvature_v`,\n`gaussian_curvature`, `mean_curvature` (each with `value`, `std` or None, and `unit`),\n`principal_curvature_min`, `principal_curvature_max`, `principal_direction_max_deg` (from +u towards +v),\n`residual_rms`, `std_from`, `unresolved_probes`, `p_value` and `warnings`\n(each with `code`, `text` and `numbers`); and `covariance`, (3, 3), of the normal\ncurvatures along u and v and the twist k_uv, 1/length², NaN where nothing tells the noise."
);

impl Made for recorded::RollEstimate {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.report())
    }

    fn others(&self) -> &'static [&'static str] {
        &["covariance"]
    }

    fn other<'py>(&self, py: Python<'py>, _: &str) -> PyResult<Bound<'py, PyAny>> {
        let covariance = self.covariance().unwrap_or([[f64::NAN; 3]; 3]);
        array(py, covariance.as_flattened().to_vec(), &[3, 3])
    }
}

/// Curvature of an object at a point, from small rolls of a spherical probe over it.
///
/// Parameters
/// ----------
/// rotations : array, (n, 2) or (n, 3)
///     Rotation of each of n >= 2 probes summed in its first contact frame, about u and v (and the normal,
///     which moves no contact), rad. A contact that moves to +u has a negative rotation about v.
/// shifts : array, (n, 2)
///     Displacement of each contact on the probe along u and v, as of a great circle, length.
/// probe_radius : float
///     Radius of the probe, length; needed unless `like` tells it.
/// pitch : float, optional
///     Pitch of the pads that read the shifts, length: tells standard deviations, and the greatest radius of an
///     object on which a contact did not move.
/// shift_std : float, optional
///     Standard deviation of each component of a shift, of a sensor without pads, length.
/// rotation_std_rad : float, optional
///     Standard deviation of each component of a rotation, rad, from 0 to pi.
/// relative_rotation_std : float, optional
///     Standard deviation of each component of a rotation, as a fraction of it, from 0 to 1.
/// method : str, optional
///     "least-squares", the only one.
/// length_unit : str, optional
///     Unit of all lengths: "m", "cm", "mm", "um" or "unit", which is the default.
/// like : Study, optional
///     Study of kind roll whose probe, noise and estimator stand for what is not given.
/// cell : int
///     Number of the study's cell, from 0.
/// threads : int, optional
///     Threads that a batch is worked on by; by default one per processor.
///
/// Returns
/// -------
/// RollEstimate
///     Of a batch, arrays (m, n, 2) of which one may be (n, 2) and then counts for all m sets, a RollBatch.
///     Without noise that is stated, standard deviations follow from the residuals.
///
/// Raises
/// ------
/// ArgumentError
///     For a shape, a number that is not finite, or a setting out of its range.
/// ReadingsError
///     Where the readings tell no curvature: rotations in one direction, contacts that did not move or moved
///     against the roll, shifts of more than half way round the probe.
///
/// Source
/// ------
/// M. Charlebois, K. Gupta and S. Payandeh, Curvature Based Shape Estimation Using Tactile Sensing, ICRA 1996,
/// equations 2 to 4; D. Montana, The Kinematics of Contact and Grasp, 1988.
///
/// Examples
/// --------
/// >>> # A probe of radius 10 that is turned by 0.3 on a ball of radius 20 rolls over 2.
/// >>> estimate = palpate.estimate_roll([[0, -0.3], [0.3, 0]], [[2, 0], [0, 2]], probe_radius=10)
/// >>> round(estimate.mean_curvature.value, 12)
/// 0.05
#[pyfunction]
#[pyo3(signature = (rotations, shifts, *, length_unit=None, like=None, cell=0, threads=None, **settings),
    text_signature = "(rotations, shifts, *, probe_radius=None, pitch=None, shift_std=None, rotation_std_rad=None, \
    relative_rotation_std=None, method=None, length_unit=None, like=None, cell=0, threads=None)")]
#[allow(clippy::too_many_arguments)]
pub(crate) fn estimate_roll<'py>(
    py: Python<'py>,
    rotations: &Bound<'py, PyAny>,
    shifts: &Bound<'py, PyAny>,
    length_unit: Option<&str>,
    like: Option<Bound<'py, Study>>,
    cell: usize,
    threads: Option<usize>,
    settings: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let unit = self::length_unit(length_unit)?;
    let given = given(
        settings.as_ref(),
        [setting::<RollSettings>, setting::<RollEstimatorConfig>],
    )?;
    let base = self::like(like.as_ref(), cell, unit, palpate::study_options::roll)?;
    let options = RollOptions::with_settings(base, &given, unit).map_err(error::setting)?;
    let rotations = Numbers::of("rotations", rotations)?;
    let shifts = Numbers::of("shifts", shifts)?;
    let axes = [&rotations, &shifts].map(|numbers| numbers.shape().len());
    if axes == [2, 2] {
        shifts.columns(2, &[2], "(n, 2)")?;
        let readings = match rotations.columns(2, &[2, 3], "(n, 2) or (n, 3)")? {
            2 => RollRecording::new(rotations.rows::<2>(), shifts.rows(), unit),
            _ => RollRecording::new(rotations.rows::<3>(), shifts.rows(), unit),
        };
        let estimate = readings.and_then(|readings| recorded::estimate_roll(&readings, &options));
        return RollEstimate::of(py, estimate.map_err(error::recorded)?);
    }
    let batch = batch(py, &rotations, &shifts, &options, threads)?;
    Ok(Bound::new(py, batch)?.into_any())
}

/// Curvatures of many sets of rolls, in their order.
///
/// `normal_curvature_u`, `normal_curvature_v`, `gaussian_curvature`, `mean_curvature`, `arc_length` and `residual_rms`
/// have arrays `value` and, but for the last two, `std` of one number per set, NaN where there is none; `twist`,
/// `principal_curvature_min`, `principal_curvature_max` and `principal_direction_max_deg` are such arrays. `errors` says by
/// the numbers of the sets why there is no estimate.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct RollBatch {
    /// A row per set.
    rows: Py<PyAny>,
    errors: Vec<(usize, String)>,
    unit: &'static str,
}

/// Number of columns of a row.
const COLUMNS: usize = size_of::<SetRow>() / size_of::<f64>();

fn batch<'py>(
    py: Python<'py>,
    rotations: &Numbers<'py>,
    shifts: &Numbers<'py>,
    options: &RollOptions,
    threads: Option<usize>,
) -> PyResult<RollBatch> {
    let sized = |numbers: &Numbers<'_>, columns: &[usize], wanted| {
        let axes = numbers.shape().len().clamp(2, 3);
        let last = numbers.columns(axes, columns, wanted)?;
        let all = numbers.shape();
        Ok::<_, PyErr>(
            (all.len() == 3)
                .then_some(all[0])
                .map_or((None, all[axes - 2], last), |sets| {
                    (Some(sets), all[axes - 2], last)
                }),
        )
    };
    let (sets, probes, columns) = sized(rotations, &[2, 3], "(m, n, 2), (m, n, 3) or (n, 2)")?;
    let (of_shifts, of_probes, _) = sized(shifts, &[2], "(m, n, 2) or (n, 2)")?;
    let sets = sets.or(of_shifts).unwrap_or_default();
    if of_probes != probes || of_shifts.is_some_and(|others| others != sets) {
        let wanted = format!("({sets}, {probes}, 2) or ({probes}, 2), as rotations have it,");
        return Err(error::shape("shifts", &wanted, shifts.shape()));
    }
    let about_tangents: Vec<[f64; 2]>;
    let turned = match columns {
        2 => rotations.rows::<2>(),
        _ => {
            about_tangents = rotations
                .rows::<3>()
                .iter()
                .map(|[x, y, _]| [*x, *y])
                .collect();
            &about_tangents
        }
    };
    let sets = RollSets::new(sets, probes, turned, shifts.rows()).map_err(error::recorded)?;
    let (numbers, untold) = if sets.len() <= CHUNK && threads.is_none() || threads == Some(1) {
        in_turn(py, &sets, options)?
    } else {
        let pool = pool(threads)?;
        let mut rows = vec![[0.0; COLUMNS]; sets.len()];
        let all = watched(py, |watch| {
            pool.install(|| in_chunks(&sets, options, &mut rows, watch))
        })?;
        all.map_err(error::recorded)?;
        let untold = untold(0, &rows).collect();
        (rows.into_flattened(), untold)
    };
    let why = |set: usize| {
        let readings = sets.readings(set);
        let error = readings.and_then(|readings| recorded::estimate_roll(&readings, options));
        Some((set, error::text(&error.err()?)))
    };
    let errors = untold.into_iter().filter_map(why).collect();
    Ok(RollBatch {
        rows: array(py, numbers, &[sets.len(), COLUMNS])?.unbind(),
        errors,
        unit: options.length_unit.unwrap_or_default().as_str(),
    })
}

/// Sets that are estimated between two looks whether to go on.
const CHUNK: usize = 4096;

/// Sets whose rows stay in the nearest caches until they are put where they belong.
const BLOCK: usize = 64;

/// Sets from `first` on whose rows tell no curvature.
fn untold(first: usize, rows: &[SetRow]) -> impl Iterator<Item = usize> {
    let places = rows.iter().enumerate();
    places.filter_map(move |(place, row)| row[0].is_nan().then_some(first + place))
}

/// Rows of all sets, one after the other, and the sets whose rows tell no curvature.
fn in_turn(
    py: Python<'_>,
    sets: &RollSets<'_>,
    options: &RollOptions,
) -> PyResult<(Vec<f64>, Vec<usize>)> {
    let mut numbers = Vec::with_capacity(sets.len() * COLUMNS);
    let mut without = Vec::new();
    let mut block = [[0.0; COLUMNS]; BLOCK];
    for chunk in (0..sets.len()).step_by(CHUNK) {
        let end = sets.len().min(chunk + CHUNK);
        let estimated = py.detach(|| {
            (chunk..end).step_by(BLOCK).try_for_each(|first| {
                let rows = &mut block[..BLOCK.min(end - first)];
                sets.estimate(options, first, rows)?;
                without.extend(untold(first, rows));
                numbers.extend_from_slice(rows.as_flattened());
                Ok(())
            })
        });
        estimated.map_err(error::recorded)?;
        py.check_signals()?;
    }
    Ok((numbers, without))
}

fn in_chunks(
    sets: &RollSets<'_>,
    options: &RollOptions,
    rows: &mut [SetRow],
    watch: &Watch,
) -> Result<(), RecordedError> {
    let chunks = rows.par_chunks_mut(CHUNK).enumerate();
    let errors: Vec<(usize, RecordedError)> = chunks
        .filter(|_| !watch.is_cancelled())
        .filter_map(|(chunk, rows)| {
            let estimated = sets.estimate(options, chunk * CHUNK, rows);
            Some((chunk, estimated.err()?))
        })
        .collect();
    // The first in the order of the sets.
    let first = errors.into_iter().min_by_key(|(chunk, _)| *chunk);
    first.map_or(Ok(()), |(_, error)| Err(error))
}

impl RollBatch {
    fn column<'py>(&self, py: Python<'py>, column: usize) -> PyResult<Bound<'py, PyAny>> {
        self.rows
            .bind(py)
            .get_item((pyo3::types::PySlice::full(py), column))
    }

    fn value<'py>(
        &self,
        py: Python<'py>,
        value: usize,
        std: Option<usize>,
        unit: String,
    ) -> PyResult<Bound<'py, PyAny>> {
        let fields = PyDict::new(py);
        fields.set_item("value", self.column(py, value)?)?;
        match std {
            Some(std) => fields.set_item("std", self.column(py, std)?)?,
            None => fields.set_item("std", py.None())?,
        }
        fields.set_item("unit", unit)?;
        Ok(Bound::new(py, Record::restored(fields, None))?.into_any())
    }

    fn principal<'py>(&self, py: Python<'py>, place: usize) -> PyResult<Bound<'py, PyAny>> {
        let rows = self.rows.bind(py).cast::<numpy::PyArray2<f64>>()?;
        let rows = rows.readonly();
        let (rows, _) = rows.as_slice()?.as_chunks::<COLUMNS>();
        let principal = rows.iter().map(|row| match row[0].is_nan() {
            true => f64::NAN,
            false => RollSets::principal(row)[place],
        });
        Ok(numpy::PyArray1::from_vec(py, principal.collect()).into_any())
    }
}

#[pymethods]
impl RollBatch {
    #[getter]
    fn normal_curvature_u<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.value(py, 0, Some(5), format!("1/{}", self.unit))
    }

    #[getter]
    fn normal_curvature_v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.value(py, 1, Some(6), format!("1/{}", self.unit))
    }

    #[getter]
    fn twist<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 2)
    }

    #[getter]
    fn gaussian_curvature<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.value(py, 3, Some(7), format!("1/{}^2", self.unit))
    }

    #[getter]
    fn mean_curvature<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.value(py, 4, Some(8), format!("1/{}", self.unit))
    }

    #[getter]
    fn arc_length<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.value(py, 9, None, self.unit.to_owned())
    }

    #[getter]
    fn residual_rms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.value(py, 10, None, self.unit.to_owned())
    }

    #[getter]
    fn principal_curvature_min<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.principal(py, 0)
    }

    #[getter]
    fn principal_curvature_max<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.principal(py, 1)
    }

    #[getter]
    fn principal_direction_max_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.principal(py, 2)
    }

    /// Why estimates are missing, by the numbers of their sets.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let errors = PyDict::new(py);
        for (set, message) in &self.errors {
            errors.set_item(set, message)?;
        }
        Ok(errors)
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.rows.bind(py).len()
    }

    /// Columns of numbers by their names, as arrays of one number per set.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let names = [
            "normal_curvature_u",
            "normal_curvature_v",
            "twist",
            "gaussian_curvature",
            "mean_curvature",
            "normal_curvature_u_std",
            "normal_curvature_v_std",
            "gaussian_curvature_std",
            "mean_curvature_std",
            "arc_length",
            "residual_rms",
        ];
        for (column, name) in names.into_iter().enumerate() {
            dict.set_item(name, self.column(py, column)?)?;
        }
        let principal = [
            "principal_curvature_min",
            "principal_curvature_max",
            "principal_direction_max_deg",
        ];
        for (place, name) in principal.into_iter().enumerate() {
            dict.set_item(name, self.principal(py, place)?)?;
        }
        Ok(dict)
    }

    #[staticmethod]
    fn _restored(rows: Py<PyAny>, errors: Vec<(usize, String)>, unit: &str) -> PyResult<Self> {
        let unit = length_unit(Some(unit))?.unwrap_or_default();
        Ok(Self {
            rows,
            errors,
            unit: unit.as_str(),
        })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let errors = PyList::new(py, own.errors.iter().cloned())?;
        let restored = slf.get_type().getattr("_restored")?;
        let state = (own.rows.bind(py).clone(), errors, own.unit);
        Ok((restored, state.into_pyobject(py)?.into_any()))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(words("RollBatch", self.__len__(py)?, self.errors.len()))
    }

    fn __getitem__(&self, py: Python<'_>, index: isize) -> PyResult<Py<PyAny>> {
        let place = place(index, self.__len__(py)?)?;
        if let Some((_, message)) = self.errors.iter().find(|(set, _)| *set == place) {
            return Err(error::ReadingsError::new_err(message.clone()));
        }
        let fields = PyDict::new(py);
        for (name, column) in self.to_dict(py)?.iter() {
            fields.set_item(name, column.get_item(place)?.extract::<f64>()?)?;
        }
        Ok(Bound::new(py, Record::restored(fields, None))?
            .into_any()
            .unbind())
    }
}
