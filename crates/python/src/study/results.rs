//! Results of a study.

use std::sync::Arc;

use palpate::config;
use palpate::{Files, Ran, Table as Rows, figure, resolved};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::trace::Trace;
use crate::error;
use crate::figure::Figure;
use crate::table::Table;

/// Results of a study that was run.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Results {
    of: Arc<palpate::Study>,
    /// Study as it was run.
    #[pyo3(get)]
    study: Py<PyAny>,
    /// Table of one row per cell and quantity: swept values, truth, mean, bias, errors, quantiles.
    #[pyo3(get)]
    cells: Py<Table>,
    /// Table of the trials that gave no number, by cell and kind.
    #[pyo3(get)]
    failures: Py<Table>,
    /// Table of the maps, or profiles, of trial 0 of each cell; None unless the config's `outputs` ask for it.
    #[pyo3(get)]
    map: Option<Py<Table>>,
    /// Lines that warn of cells in which the theory or the estimator does not hold.
    #[pyo3(get)]
    warnings: Vec<String>,
}

impl Results {
    /// Results of a study, which `shown` is as Python has it.
    pub(super) fn of(
        py: Python<'_>,
        study: Arc<palpate::Study>,
        shown: Py<PyAny>,
        ran: Ran,
        warnings: Vec<String>,
    ) -> PyResult<Self> {
        let unit = study.config.length_unit;
        let table = |rows: Rows| Py::new(py, Table::new(py, rows, unit)?);
        Ok(Self {
            of: study,
            study: shown,
            cells: table(ran.cells)?,
            failures: table(ran.failures)?,
            map: ran.map.map(|map| table(map.table)).transpose()?,
            warnings,
        })
    }

    /// Texts of the files that the command line writes, by their names.
    fn texts(&self) -> Vec<(&'static str, String)> {
        let mut texts = vec![
            ("run.toml", resolved(&self.of)),
            ("cells.csv", self.cells.get().rows().to_csv()),
            ("failures.csv", self.failures.get().rows().to_csv()),
        ];
        if let Some(map) = &self.map {
            texts.push(("map.csv", map.get().rows().to_csv()));
        }
        texts
    }
}

#[pymethods]
impl Results {
    /// Names of the plots that the config asks for.
    #[getter]
    fn plots(&self) -> PyResult<Vec<String>> {
        let plots = self.of.config.plot.iter().enumerate();
        let name = |(place, plot): (usize, &config::PlotConfig)| {
            let name = plot.name.clone();
            name.unwrap_or_else(|| format!("plot-{}", place + 1))
        };
        Ok(plots.map(name).collect())
    }

    /// Draws a plot: that of this name in the config, by default its first, or one of these keys of a `[[plot]]`:
    /// `results.plot(x="scene.sensor.pitch", y="relative_rms_error", quantity="radius")`.
    ///
    /// Returns a Figure, which a notebook shows. Raises ConfigError, RunError.
    #[pyo3(signature = (name=None, **keys))]
    fn plot(
        &self,
        py: Python<'_>,
        name: Option<String>,
        keys: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Figure> {
        let plot = match keys.filter(|keys| !keys.is_empty()) {
            Some(keys) => {
                let mut plot = crate::json::from_python(&keys)?;
                if let Some(name) = name {
                    plot["name"] = name.into();
                }
                let text = config::of_json("plot", &serde_json::json!({ "plot": [plot] }));
                let text = text.map_err(error::config)?;
                let plots = config::plots("plot", &text).map_err(error::config)?;
                plots.into_iter().next()
            }
            None => {
                let names = self.plots()?;
                let place = match &name {
                    None => Some(0),
                    Some(name) => names.iter().position(|one| one == name),
                };
                let all = &self.of.config.plot;
                let plot = place.and_then(|place| Some((all.get(place)?, names.get(place)?)));
                let Some((plot, own)) = plot else {
                    let wanted = name.unwrap_or_else(|| "the first".to_owned());
                    let message = format!("no plot {wanted}; the config has {names:?}");
                    return Err(error::argument("name", &[], None, message));
                };
                Some(config::PlotConfig {
                    name: Some(own.clone()),
                    ..plot.clone()
                })
            }
        };
        let Some(plot) = plot else {
            return Err(error::RunError::new_err("there is no plot"));
        };
        let texts = self.texts();
        let drawn = py.detach(|| figure(&plot, Files::in_memory(texts)));
        let drawn = drawn.map_err(|error| error::RunError::new_err(error.to_string()))?;
        Ok(drawn.into())
    }

    /// Follows one pass of a cell, as `Study.trace`.
    #[pyo3(signature = (cell=0, trial=None))]
    fn trace(&self, py: Python<'_>, cell: usize, trial: Option<u64>) -> PyResult<Trace> {
        Trace::of(py, Arc::clone(&self.of), cell, trial)
    }

    /// Texts of the files that `palpate run` writes, by their names, byte for byte.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for (name, text) in self.texts() {
            files.set_item(name, text)?;
        }
        Ok(files)
    }

    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        study: Py<PyAny>,
        cells: Py<Table>,
        failures: Py<Table>,
        map: Option<Py<Table>>,
        warnings: Vec<String>,
    ) -> PyResult<Self> {
        let text: String = study.getattr(py, "toml")?.extract(py)?;
        let of = config::parse("run.toml", &text).map_err(error::config)?;
        Ok(Self {
            of: Arc::new(of),
            study,
            cells,
            failures,
            map,
            warnings,
        })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let state = (
            own.study.clone_ref(py),
            own.cells.clone_ref(py),
            own.failures.clone_ref(py),
            own.map.as_ref().map(|map| map.clone_ref(py)),
            own.warnings.clone(),
        );
        let restored = slf.get_type().getattr("_restored")?;
        Ok((restored, state.into_pyobject(py)?.into_any()))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.texts() == other.texts()
    }

    fn __repr__(&self) -> String {
        let cells = self.of.cell_count();
        let rows = self.cells.get().rows().rows.len();
        let name = &self.of.config.name;
        format!("<Results of {name:?}: {cells} cells, {rows} rows>")
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("palpate._show")?
            .call_method1("results", (slf,))
    }
}
