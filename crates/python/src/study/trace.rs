//! Single passes.

use std::sync::Arc;

use image::RgbImage;
use palpate::{Files, press_figures, trace};
use pyo3::prelude::*;

use super::runs::of_trace;
use crate::error;
use crate::figure::Figure;
use crate::table::{csv_of, table_of};
use crate::watch::watched_alone;

/// One pass of a cell, written down.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Trace {
    /// Words for what was followed.
    #[pyo3(get)]
    what: String,
    /// Truth: contacts, or markers.
    #[pyo3(get)]
    contacts: Py<PyAny>,
    /// Readings of the sensor, in the form that `palpate estimate` accepts.
    #[pyo3(get)]
    readings: Py<PyAny>,
    /// How a camera sees each marker; None without one.
    #[pyo3(get)]
    markers: Option<Py<PyAny>>,
    /// Frame at rest that a camera rendered, (h, w, 3) of uint8; None without one.
    #[pyo3(get)]
    rest: Option<Py<PyAny>>,
    /// Frame pressed.
    #[pyo3(get)]
    pressed: Option<Py<PyAny>>,
}

impl Trace {
    pub(super) fn of(
        py: Python<'_>,
        study: Arc<palpate::Study>,
        cell: usize,
        trial: Option<u64>,
    ) -> PyResult<Self> {
        let unit = study.config.length_unit;
        let traced = watched_alone(py, None, move |_| trace(&study, cell, trial))?;
        let traced = traced.map_err(of_trace)?;
        let table = |rows| table_of(py, &rows, unit);
        let (mut markers, mut frames) = (None, None);
        if let Some(seen) = traced.camera {
            markers = Some(table(seen.markers)?);
            frames = seen.frames;
        }
        let [rest, pressed] = match frames {
            Some(frames) => frames.map(Some),
            None => [None, None],
        };
        let pixels = |frame: Option<RgbImage>| frame.map(|one| crate::pixels::pixels(py, one));
        Ok(Self {
            what: traced.what,
            contacts: table(traced.contacts)?,
            readings: table(traced.readings)?,
            markers,
            rest: pixels(rest).transpose()?,
            pressed: pixels(pressed).transpose()?,
        })
    }
}

#[pymethods]
impl Trace {
    /// Figures of a press that a camera saw: displacements along the skin, and their profile. Raises RunError where there is
    /// no camera.
    #[getter]
    fn figures(&self, py: Python<'_>) -> PyResult<Vec<Figure>> {
        if self.markers.is_none() {
            let message = "only a press that a camera sees has figures";
            return Err(error::RunError::new_err(message));
        }
        let files = Files::in_memory([
            ("trace.csv", csv_of(py, &self.contacts)?),
            ("readings.csv", csv_of(py, &self.readings)?),
        ]);
        let drawn = press_figures(&files);
        let drawn = drawn.map_err(|error| error::RunError::new_err(error.to_string()))?;
        Ok(drawn.into_iter().map(Figure::from).collect())
    }

    #[staticmethod]
    fn _restored(
        what: String,
        contacts: Py<PyAny>,
        readings: Py<PyAny>,
        markers: Option<Py<PyAny>>,
        rest: Option<Py<PyAny>>,
        pressed: Option<Py<PyAny>>,
    ) -> Self {
        Self {
            what,
            contacts,
            readings,
            markers,
            rest,
            pressed,
        }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let shared = |frame: &Option<Py<PyAny>>| frame.as_ref().map(|frame| frame.clone_ref(py));
        let state = (
            own.what.clone(),
            own.contacts.clone_ref(py),
            own.readings.clone_ref(py),
            own.markers.as_ref().map(|markers| markers.clone_ref(py)),
            shared(&own.rest),
            shared(&own.pressed),
        );
        let restored = slf.get_type().getattr("_restored")?;
        Ok((restored, state.into_pyobject(py)?.into_any()))
    }

    fn __repr__(&self) -> String {
        format!("<Trace of {}>", self.what)
    }
}
