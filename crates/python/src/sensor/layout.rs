//! Defines the layout of the markers along a skin.

use palpate::config::infinite_length::json_number;
use palpate::{CutPattern, config, marker_places};
use pyo3::prelude::*;
use serde_json::json;

use crate::arrays::array;
use crate::error;
use crate::json::{from_python, to_python};
use crate::record::{Made, Record, record};
use crate::study::Study;
use crate::table::table_of;

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

record!(
    Pattern,
    "Flat pattern for cutting a skin.\n\nFields: `gores`, `markers`, `greatest_fold_strain` and `rms_fold_strain`; `svg`, the drawing in millimetres; `dxf`,\nthe drawing with the layers CUT, FOLD, MAGENTA and YELLOW; `strain`, a Table of the strain of folding over the half of\na gore, from its middle meridian; `strain_by_gores`, a Table of the largest strain and the rms strain for 3 to 12\ngores."
);

struct Cut(CutPattern, palpate::config::LengthUnit);

impl Made for Cut {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Self(cut, _) = self;
        let fields = json!({
            "gores": cut.gores,
            "markers": cut.markers,
            "greatest_fold_strain": cut.fold_strain.greatest,
            "rms_fold_strain": cut.fold_strain.rms,
        });
        to_python(py, &fields)
    }

    fn others(&self) -> &'static [&'static str] {
        &["svg", "dxf", "strain", "strain_by_gores"]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Self(cut, unit) = self;
        match name {
            "svg" => Ok(cut.svg.as_str().into_pyobject(py)?.into_any()),
            "dxf" => Ok(cut.dxf.as_str().into_pyobject(py)?.into_any()),
            "strain" => table_of(py, &cut.strain, *unit),
            _ => table_of(py, &cut.strain_by_gores, *unit),
        }
    }
}

pub(crate) fn pattern_of<'py>(
    py: Python<'py>,
    study: &palpate::Study,
) -> PyResult<Bound<'py, PyAny>> {
    let cut = CutPattern::of(study).map_err(error::config)?;
    Pattern::of(py, Record::new(Cut(cut, study.config.length_unit)))
}
