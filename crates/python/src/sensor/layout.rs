//! Defines the layout of the markers along a skin.

use palpate::config::infinite_length::json_number;
use palpate::{CutPattern, config, marker_places};
use pyo3::prelude::*;
use serde_json::json;

use super::cut::pattern_of;
use crate::arrays::array;
use crate::error;
use crate::json::from_python;
use crate::study::Study;

/// Layout of the markers along the skin of a spherical sensor.
///
/// Parameters
/// ----------
/// radius : float
///     Radius of the skin, in `length_unit`.
/// layout : str or dict
///     "published" for the 77 markers of the 2020 paper; or a dictionary of kind "gores", "lattice", "grid", "line" or
///     "radius", with the keys of `scene.probe.layout` in a study.
/// marker_depth : float
///     Depth of the markers under the skin, in `length_unit`.
/// discs : dict, optional
///     `magenta_diameter`, `yellow_diameter`, `separation` and `misalignment` of the two discs of each marker, in
///     `length_unit`.
/// length_unit : str
///     Unit of all lengths. A cutting pattern needs a metric unit.
///
/// Raises
/// ------
/// ConfigError
///     If the settings do not describe a valid sensor.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Layout {
    study: Py<Study>,
}

#[pymethods]
impl Layout {
    #[new]
    #[pyo3(signature = (radius, layout=None, *, marker_depth=0.0, discs=None, length_unit="mm"))]
    fn new(
        py: Python<'_>,
        radius: f64,
        layout: Option<Bound<'_, PyAny>>,
        marker_depth: f64,
        discs: Option<Bound<'_, PyAny>>,
        length_unit: &str,
    ) -> PyResult<Self> {
        let json = |value: Option<Bound<'_, PyAny>>| {
            value.map_or(Ok(json!(null)), |one| from_python(&one))
        };
        let study = json!({
            "name": "layout",
            "length_unit": length_unit,
            "scene": {
                "kind": "fingertip",
                "probe": {
                    "kind": "marker-sphere",
                    "radius": json_number(radius),
                    "marker_depth": marker_depth,
                    "layout": json(layout)?,
                    "discs": json(discs)?,
                },
            },
        });
        let text = config::of_json("layout", &study).map_err(error::config)?;
        Self::of(Py::new(py, Study::of("layout".to_owned(), text)?)?)
    }

    /// Layout of the markers in the first cell of a study.
    #[staticmethod]
    fn of(study: Py<Study>) -> PyResult<Self> {
        marker_places(study.get().study()).map_err(error::config)?;
        Ok(Self { study })
    }

    /// Positions of the markers along the skin, shape (n, 2), as `estimate_press` accepts them.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let places = marker_places(self.study.get().study()).map_err(error::config)?;
        let markers = places.len();
        array(py, places.into_flattened(), &[markers, 2])
    }

    /// Flat pattern for cutting the skin, as a Pattern. Raises ConfigError if the layout has no gores, the markers have
    /// no discs, or the length unit is not metric.
    fn pattern<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pattern_of(py, self.study.get().study())
    }

    fn __len__(&self) -> PyResult<usize> {
        Ok(marker_places(self.study.get().study())
            .map_err(error::config)?
            .len())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Py<Study>,))> {
        let restored = slf.get_type().getattr("of")?;
        Ok((restored, (slf.get().study.clone_ref(slf.py()),)))
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!("<Layout of {} markers>", self.__len__()?))
    }
}

/// Flat pattern for cutting a sensor's skin, as SVG text in millimetres. `study.pattern()` also returns DXF text and the
/// strains.
///
/// Parameters
/// ----------
/// sensor : Study or Layout
///     Study of a press or a fingertip, or a Layout. It must have gores and discs.
///
/// Raises
/// ------
/// ConfigError
///     If the sensor has no gores or no discs.
#[pyfunction]
pub(crate) fn pattern(py: Python<'_>, sensor: &Bound<'_, PyAny>) -> PyResult<String> {
    let study = match sensor.cast::<Layout>() {
        Ok(layout) => layout.get().study.clone_ref(py),
        Err(_) => sensor.extract::<Py<Study>>()?,
    };
    let cut = CutPattern::of(study.get().study()).map_err(error::config)?;
    Ok(cut.svg)
}
