//! Calibrates the camera of a sensor from a frame at rest.

use palpate::recorded::{self, CameraEstimate, RecordedFile, parse_camera};
use pyo3::prelude::*;

use crate::error;
use crate::json::to_python;
use crate::pixels::frame;
use crate::record::records;
use crate::study::Study;

/// Camera of a sensor: its position, rotation and scale, with their covariance.
///
/// `CameraCalibration(toml)` reads the text that `palpate sensor calibrate --rest` writes.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct CameraCalibration {
    pub(super) camera: CameraEstimate,
}

#[pymethods]
impl CameraCalibration {
    #[new]
    fn new(toml: String) -> PyResult<Self> {
        let file = RecordedFile::new("calibration", toml.into_bytes());
        let camera = parse_camera(&file).map_err(error::recorded)?;
        Ok(Self { camera })
    }

    /// Description of the camera in words.
    #[getter]
    fn summary(&self) -> String {
        self.camera.summary()
    }

    /// Warnings, each with `code`, `text` and `numbers`.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        records(py, &self.camera.warnings)
    }

    /// Unit of the camera's lengths.
    #[getter]
    fn length_unit(&self) -> &'static str {
        self.camera.length_unit.as_str()
    }

    /// The camera as TOML, which `palpate sensor track --method image --calibration` reads.
    fn to_toml(&self) -> String {
        self.camera.to_toml()
    }

    /// Dictionary of the camera: `place`, `turn_deg` and `px_per_rad` with `place_std`, `turn_std_deg` and
    /// `px_per_rad_std`, `centre_px`, `covariance` (9 x 9: of the centre, px; of px per rad, as a share; of the
    /// position; of the rotation, rad), `residuals_px` of the layout's markers, `residual_px`, `reduced_chi_squared`
    /// and `warnings`.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.camera)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.camera == other.camera
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyAny>, (String,)) {
        (slf.get_type().into_any(), (slf.get().to_toml(),))
    }

    fn __repr__(&self) -> String {
        self.summary()
    }
}

/// Estimates the camera of a sensor from one frame at rest.
///
/// Parameters
/// ----------
/// rest : array of uint8, (h, w, 3)
///     Frame at rest, red, green and blue.
/// study : Study
///     Study of a press before a camera. It states the layout, the discs, the frame's size and the nominal camera. The true
///     camera may differ by a tenth of the sensor's radius and 5 degrees.
/// cell : int
///     Number of the study's cell, from 0.
/// srgb : bool
///     Whether the pixels are encoded by the curve of sRGB, as most cameras write them, instead of linear in the light.
///
/// Returns
/// -------
/// CameraCalibration
///     Lengths are in the study's unit.
///
/// Raises
/// ------
/// ArgumentError
///     For a frame of another shape.
/// ReadingsError
///     For a study without a camera; for a frame of another size, without the layout's markers, in other colours, saturated
///     or under-exposed, or in contradiction to the layout.
///
/// Source
/// ------
/// Least squares of centroid, hue and size of the markers, as `palpate sensor calibrate --rest`.
#[pyfunction]
#[pyo3(signature = (rest, study, *, cell=0, srgb=false))]
pub(crate) fn calibrate_camera(
    py: Python<'_>,
    rest: &Bound<'_, PyAny>,
    study: &Bound<'_, Study>,
    cell: usize,
    srgb: bool,
) -> PyResult<CameraCalibration> {
    let rest = frame("rest", rest, srgb)?;
    let cell = study.get().study().cell(cell).map_err(error::config)?;
    let camera = py.detach(|| recorded::calibrate_camera(&rest, &cell.config));
    Ok(CameraCalibration {
        camera: camera.map_err(error::recorded)?,
    })
}
