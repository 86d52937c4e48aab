//! Pattern that a skin is cut from.

use palpate::CutPattern;
use pyo3::prelude::*;

use crate::error;
use crate::table::table_of;

/// Flat pattern that a skin is cut from.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Pattern {
    /// Drawing as SVG, in millimetres.
    #[pyo3(get)]
    svg: String,
    /// Drawing as DXF, with the layers CUT, FOLD, MAGENTA and YELLOW.
    #[pyo3(get)]
    dxf: String,
    /// Number of gores.
    #[pyo3(get)]
    gores: u32,
    /// Number of markers.
    #[pyo3(get)]
    markers: usize,
    /// Greatest strain of folding.
    #[pyo3(get)]
    greatest_fold_strain: f64,
    /// Root mean square of the strain of folding.
    #[pyo3(get)]
    rms_fold_strain: f64,
    /// Table of the strain of folding over the half of a gore, from its middle meridian.
    #[pyo3(get)]
    strain: Py<PyAny>,
    /// Table of its greatest value and its root mean square for 3 to 12 gores.
    #[pyo3(get)]
    strain_by_gores: Py<PyAny>,
}

#[pymethods]
impl Pattern {
    #[staticmethod]
    #[allow(clippy::too_many_arguments)]
    fn _restored(
        svg: String,
        dxf: String,
        gores: u32,
        markers: usize,
        greatest_fold_strain: f64,
        rms_fold_strain: f64,
        strain: Py<PyAny>,
        strain_by_gores: Py<PyAny>,
    ) -> Self {
        Self {
            svg,
            dxf,
            gores,
            markers,
            greatest_fold_strain,
            rms_fold_strain,
            strain,
            strain_by_gores,
        }
    }

    fn _repr_svg_(&self) -> &str {
        &self.svg
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let state = (
            own.svg.clone(),
            own.dxf.clone(),
            own.gores,
            own.markers,
            own.greatest_fold_strain,
            own.rms_fold_strain,
            own.strain.clone_ref(py),
            own.strain_by_gores.clone_ref(py),
        );
        let restored = slf.get_type().getattr("_restored")?;
        Ok((restored, state.into_pyobject(py)?.into_any()))
    }

    fn __repr__(&self) -> String {
        let percent = 100.0 * self.greatest_fold_strain;
        let (gores, markers) = (self.gores, self.markers);
        format!(
            "<Pattern of {gores} gores with {markers} markers, strained by at most {percent:.1} %>"
        )
    }
}

/// Pattern of the sensor of a study's first cell.
pub(crate) fn pattern_of<'py>(
    py: Python<'py>,
    study: &palpate::Study,
) -> PyResult<Bound<'py, PyAny>> {
    let cut = CutPattern::of(study).map_err(error::config)?;
    let unit = study.config.length_unit;
    let table = |rows| table_of(py, &rows, unit);
    let pattern = Pattern {
        svg: cut.svg,
        dxf: cut.dxf,
        gores: cut.gores,
        markers: cut.markers,
        greatest_fold_strain: cut.fold_strain.greatest(),
        rms_fold_strain: cut.fold_strain.rms(),
        strain: table(cut.strain)?,
        strain_by_gores: table(cut.strain_by_gores)?,
    };
    Ok(Bound::new(py, pattern)?.into_any())
}
