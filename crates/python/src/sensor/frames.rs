//! Frames of a camera sensor.

use palpate::config::{PressEstimatorConfig, setting};
use palpate::recorded::{PressOptions, TrackedPress, difference_image, overlay, track_frames};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::reader::reader;
use crate::error;
use crate::estimate::{PressEstimate, given};
use crate::json::to_python;
use crate::pixels::{frame, pixels};
use crate::record::{Made, Record, records};
use crate::study::Study;
use crate::table::table_of;

impl Made for TrackedPress {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self)
    }
}

/// Markers of two frames of a camera sensor, and with a calibration what they tell.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Tracked {
    /// Table of one row per marker: place and hue at rest, how they changed, and its fate.
    #[pyo3(get)]
    markers: Py<PyAny>,
    /// How many markers had which fate: `at_rest`, `tracked`, `lost`, `merged`, `split`, `new`, `cut_at_rest`.
    #[pyo3(get)]
    fates: Py<PyAny>,
    /// Warnings about the frames, each with `code`, `text` and `numbers`; `estimate` has them too.
    #[pyo3(get)]
    warnings: Py<PyAny>,
    /// Pressed frame with each marker's fate drawn on it, (h, w, 3) of uint8.
    #[pyo3(get)]
    overlay: Py<PyAny>,
    /// Signed difference of the frames, (h, w, 3) of uint8: magenta where green light was lost, green where gained.
    #[pyo3(get)]
    difference: Py<PyAny>,
    /// Table of the displacements of the markers that were tracked; None without a calibration or `method="image"`.
    #[pyo3(get)]
    readings: Option<Py<PyAny>>,
    /// Displacements on a grid between the markers; None without a calibration or `method="image"`.
    #[pyo3(get)]
    field: Option<Py<PyAny>>,
    /// The PressEstimate from them; None without a calibration or `method="image"`.
    #[pyo3(get)]
    estimate: Option<Py<PyAny>>,
}

#[pymethods]
impl Tracked {
    #[staticmethod]
    #[allow(clippy::too_many_arguments)]
    fn _restored(
        markers: Py<PyAny>,
        fates: Py<PyAny>,
        warnings: Py<PyAny>,
        overlay: Py<PyAny>,
        difference: Py<PyAny>,
        readings: Option<Py<PyAny>>,
        field: Option<Py<PyAny>>,
        estimate: Option<Py<PyAny>>,
    ) -> Self {
        Self {
            markers,
            fates,
            warnings,
            overlay,
            difference,
            readings,
            field,
            estimate,
        }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let table = |table: &Option<Py<PyAny>>| table.as_ref().map(|table| table.clone_ref(py));
        let state = (
            own.markers.clone_ref(py),
            own.fates.clone_ref(py),
            own.warnings.clone_ref(py),
            own.overlay.clone_ref(py),
            own.difference.clone_ref(py),
            table(&own.readings),
            table(&own.field),
            own.estimate.as_ref().map(|estimate| estimate.clone_ref(py)),
        );
        let restored = slf.get_type().getattr("_restored")?;
        Ok((restored, state.into_pyobject(py)?.into_any()))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let fates = self.fates.bind(py);
        let count = |name: &str| fates.getattr(name)?.extract::<usize>();
        let (tracked, at_rest) = (count("tracked")?, count("at_rest")?);
        let estimate = match &self.estimate {
            Some(estimate) => format!("\n{}", estimate.bind(py).repr()?),
            None => String::new(),
        };
        Ok(format!(
            "<Tracked: {tracked} of {at_rest} markers>{estimate}"
        ))
    }
}

/// Finds the markers of a frame at rest in a pressed one, and with a calibration or by `method="image"` estimates what
/// pressed them.
///
/// Parameters
/// ----------
/// rest, pressed : array of uint8, (h, w, 3)
///     Frames of one size, red, green and blue. The camera looks at the apex from the sensor's centre, through a fisheye
///     with r = f angle, columns along x, rows against y.
/// calibration : Calibration or CameraCalibration, optional
///     Its unit is that of all lengths here. A Calibration needs `sensor_radius` and `depth`, or `like`. A CameraCalibration
///     is of `method="image"`: that camera, with its covariance, is taken instead of the study's.
/// px_per_rad : float, optional
///     Focal length of the fisheye; else the calibration's px per length times the markers' distance from the centre.
/// grid : int
///     Points along each side of the field's grid, from 1 to 1000.
/// filter : float
///     Standard deviation of a Gaussian that the field is smoothed with, length along the skin.
/// like, cell
///     As of `estimate_press`.
/// **settings
///     All others of `estimate_press` but `radial_scale`, `length_unit` and `threads`. `method="image"` fits what the camera
///     sees, centroid, hue and size of each marker, by the errors that the frames show: `like` states layout, discs, body,
///     camera and noise.
///
/// Returns
/// -------
/// Tracked
///
/// Raises
/// ------
/// ArgumentError
///     For frames of another shape, and settings that cannot be.
/// ReadingsError
///     For frames of different sizes, without markers or of different sensors, and where displacements tell no press; of
///     `method="image"` also for frames of another layout or camera than stated, in other colours, saturated or
///     under-exposed.
///
/// Source
/// ------
/// X. Lin et al., ICRA 2020.
#[pyfunction]
#[pyo3(signature = (rest, pressed, *, calibration=None, px_per_rad=None, grid=30, filter=0.0, like=None, cell=0,
    **settings))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn track(
    py: Python<'_>,
    rest: &Bound<'_, PyAny>,
    pressed: &Bound<'_, PyAny>,
    calibration: Option<Bound<'_, PyAny>>,
    px_per_rad: Option<f64>,
    grid: usize,
    filter: f64,
    like: Option<Bound<'_, Study>>,
    cell: usize,
    settings: Option<Bound<'_, PyDict>>,
) -> PyResult<Tracked> {
    let frames = [frame("rest", rest)?, frame("pressed", pressed)?];
    let given = given(
        settings.as_ref(),
        [setting::<PressOptions>, setting::<PressEstimatorConfig>],
    )?;
    if given.contains_key("radial_scale") {
        let message = "radial_scale is of use only to estimate_press";
        return Err(error::argument("radial_scale", &[], None, message));
    }
    if !(1..=1000).contains(&grid) {
        let message = format!("grid is {grid}; it must be a whole number from 1 to 1000");
        return Err(error::argument("grid", &[], Some(grid as f64), message));
    }
    let reader = reader(
        calibration.as_ref(),
        px_per_rad,
        (like.as_ref(), cell),
        &given,
    )?;
    if reader.is_none()
        && let Some(name) = settings.iter().flat_map(|all| all.keys()).next()
    {
        let message = format!("{name} is of use only with calibration");
        return Err(error::argument(&name.to_string(), &[], None, message));
    }
    let [rest, pressed] = &frames;
    let seen = py.detach(|| {
        let tracked = track_frames(rest, pressed)?;
        tracked.of_one_sensor()?;
        let pictures = [
            overlay(&pressed.image, &tracked),
            difference_image(rest, pressed)?,
        ];
        let estimated = match reader {
            Some(reader) => {
                let read = reader.read([rest, pressed], &tracked, (grid, filter), None)?;
                Some((read.estimate?, read.readings, read.field, read.unit))
            }
            None => None,
        };
        Ok((tracked, pictures, estimated))
    });
    let (tracked, [drawn, difference], estimated) = seen.map_err(error::recorded)?;
    let mut made = Tracked {
        markers: table_of(py, &tracked.table(), Default::default())?,
        fates: Py::new(py, Record::of(py, &tracked.fates())?)?.into_any(),
        warnings: records(py, &tracked.warnings())?,
        overlay: pixels(py, drawn)?,
        difference: pixels(py, difference)?,
        readings: None,
        field: None,
        estimate: None,
    };
    if let Some((estimate, readings, field, unit)) = estimated {
        made.readings = Some(table_of(py, &readings, unit)?);
        made.field = Some(table_of(py, &field, unit)?);
        made.estimate = Some(PressEstimate::of(py, estimate)?.unbind());
    }
    Ok(made)
}
