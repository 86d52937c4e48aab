//! Traces single trials.

use std::sync::Arc;

use palpate::config::LengthUnit;
use palpate::{Files, press_figures, trace};
use pyo3::prelude::*;
use pyo3::types::PyList;
use serde_json::json;

use super::runs::of_trace;
use crate::error;
use crate::figure::Figure;
use crate::json::to_python;
use crate::record::{Made, Record, record};
use crate::sensor::pixels;
use crate::table::table_of;
use crate::watch::watched;

record!(
    Trace,
    "Data of one trial of a cell.\n\nFields: `what`, the trial in words; `contacts`, a Table of the true contacts, or of the true displacements of the\nmarkers; `readings`, a Table of the sensor's readings, as `palpate estimate` accepts them. For a press with a camera\nalso `markers`, a Table of the images of the markers, `rest` and `pressed`, the frames, (h, w, 3) of uint8, and\n`figures`, a list of Figures of the displacements along the skin and of their profile; None, or an empty list,\notherwise."
);

struct Pass(palpate::Trace, LengthUnit);

impl Made for Pass {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &json!({ "what": self.0.what }))
    }

    fn others(&self) -> &'static [&'static str] {
        &[
            "contacts", "readings", "markers", "rest", "pressed", "figures",
        ]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Self(trace, unit) = self;
        let table = |rows| table_of(py, rows, *unit);
        let frames = trace
            .camera
            .as_ref()
            .and_then(|camera| camera.frames.as_ref());
        let frame = |place: usize| frames.map(|frames| pixels(py, frames[place].clone()));
        let found = match name {
            "contacts" => Some(table(&trace.contacts)),
            "readings" => Some(table(&trace.readings)),
            "markers" => trace.camera.as_ref().map(|camera| table(&camera.markers)),
            "rest" => frame(0),
            "pressed" => frame(1),
            _ => Some(self.figures(py)),
        };
        found.unwrap_or_else(|| Ok(py.None().into_bound(py)))
    }
}

impl Pass {
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Self(trace, _) = self;
        if trace.camera.is_none() {
            return Ok(PyList::empty(py).into_any());
        }
        let tables = [
            ("trace.csv", &trace.contacts),
            ("readings.csv", &trace.readings),
        ];
        let files = Files::in_memory(tables.map(|(name, table)| (name, table.to_csv())));
        let figures = press_figures(&files);
        let figures = figures.map_err(error::run)?;
        Ok(PyList::new(py, figures.into_iter().map(Figure::from))?.into_any())
    }
}

pub(super) fn follow<'py>(
    py: Python<'py>,
    study: Arc<palpate::Study>,
    cell: usize,
    trial: Option<u64>,
) -> PyResult<Bound<'py, PyAny>> {
    let unit = study.config.length_unit;
    let traced = watched(py, None, move |_| trace(&study, cell, trial))?;
    Trace::of(py, Record::new(Pass(traced.map_err(of_trace)?, unit)))
}
