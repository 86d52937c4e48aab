//! Makes the flat pattern for cutting the skin of a sensor.

use palpate::CutPattern;
use pyo3::prelude::*;
use serde_json::json;

use crate::error;
use crate::json::to_python;
use crate::record::{Made, Record, record};
use crate::table::table_of;

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
