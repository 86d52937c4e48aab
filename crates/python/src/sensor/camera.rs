//! Calibrates the camera of a sensor from a frame at rest.

use palpate::recorded::{self, CameraEstimate, RecordedFile};
use pyo3::prelude::*;

use crate::error;
use crate::json::to_python;
use crate::record::records;
use crate::sensor::frame;
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
        let camera = CameraEstimate::try_from(&file).map_err(error::recorded)?;
        Ok(Self { camera })
    }

    /// Text that describes the camera.
    #[getter]
    fn summary(&self) -> String {
        self.camera.summary()
    }

    /// Warnings, each with `code`, `text` and `numbers`.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        records(py, &self.camera.warnings)
    }

    /// Unit of all lengths of the camera.
    #[getter]
    fn length_unit(&self) -> &'static str {
        self.camera.length_unit.as_str()
    }

    /// The camera as TOML text. `palpate sensor track --method image --calibration` reads this text from a file.
    fn to_toml(&self) -> String {
        self.camera.to_toml()
    }

    /// The camera as a dictionary.
    ///
    /// `place` (position), `turn_deg` (rotation) and `px_per_rad` (scale) have the standard deviations `place_std`,
    /// `turn_std_deg` and `px_per_rad_std`. `covariance` is the 9 x 9 covariance matrix of the centre (px), the
    /// relative scale, the position and the rotation (rad). `residuals_px` has one number per marker of the layout. The
    /// other keys are `centre_px`, `residual_px`, `reduced_chi_squared` and `warnings`.
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
///     Frame at rest, with the colours red, green and blue.
/// study : Study
///     Study of a press that a camera reads. It states the layout, the discs, the frame's size and the nominal camera.
///     The position of the true camera may differ by a tenth of the sensor's radius, and its rotation by 5 degrees.
/// cell : int
///     Number of the study's cell, from 0.
/// srgb : bool
///     Whether the pixels are encoded by sRGB, as in images of most cameras. If false, pixel values are proportional to
///     the light.
///
/// Returns
/// -------
/// CameraCalibration
///     Lengths are in the study's unit.
///
/// Raises
/// ------
/// ArgumentError
///     If `rest` does not have the shape (h, w, 3).
/// ReadingsError
///     If the study has no camera; if the frame has another size or other colours than the study states, does not show
///     the markers of the layout, or is saturated or under-exposed.
///
/// Source
/// ------
/// Least-squares fit to the centroid, hue and size of the markers, as in `palpate sensor calibrate --rest`.
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
