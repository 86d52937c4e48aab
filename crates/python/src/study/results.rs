//! Defines the results of a run.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use palpate::config::{self, LengthUnit};
use palpate::report::{Study as Scored, claims_table, figures, score};
use palpate::{Files, Ran, Warning, figure, resolved, result_columns, warning_files};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::Study;
use super::trace::follow;
use crate::error;
use crate::figure::Figure;
use crate::record::records;
use crate::table::{table, table_of};

const CONFIG: &str = "run.toml";
const CELLS: &str = "cells.csv";
const FAILURES: &str = "failures.csv";
const MAP: &str = "map.csv";
const WARNINGS: [&str; 2] = ["warnings.txt", "warnings.json"];
const PASS: [&str; 3] = ["trace.csv", "readings.csv", "markers.csv"];

/// Results of a run of a study.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Results {
    /// Contents of the files that the command line would write, by file name.
    files: BTreeMap<String, String>,
    /// The study that was run.
    #[pyo3(get)]
    study: Py<Study>,
    /// Table with one row per cell and quantity. Its columns are the swept values, the true value, and the mean, bias,
    /// errors and quantiles of the estimates.
    #[pyo3(get)]
    cells: Py<PyAny>,
    /// Table with the number of failed trials, by cell and kind of failure.
    #[pyo3(get)]
    failures: Py<PyAny>,
    /// Table with the map of trial 0 of each cell (for a press, the profile of the displacements). None unless
    /// `outputs` in the config requests maps.
    #[pyo3(get)]
    map: Option<Py<PyAny>>,
    /// Table of all trials, with one row per estimate or failure; None without `trials_out=True`.
    #[pyo3(get)]
    trials_out: Option<Py<PyAny>>,
    /// Warnings, for example that the contact model or the estimator is not valid in a cell. Each warning has `code`,
    /// `text` and `numbers`.
    #[pyo3(get)]
    warnings: Py<PyAny>,
}

impl Results {
    /// Converts the results of a run to Python objects. If the run traced a trial, also converts its trace.
    pub(super) fn of(
        py: Python<'_>,
        study: &palpate::Study,
        (ran, trace): (Ran, Option<palpate::Trace>),
    ) -> PyResult<Self> {
        let mut files = BTreeMap::from([
            (CONFIG.to_owned(), resolved(study)),
            (CELLS.to_owned(), ran.cells.to_csv()),
            (FAILURES.to_owned(), ran.failures.to_csv()),
        ]);
        files.extend(ran.map.map(|map| (MAP.to_owned(), map.to_csv())));
        let warnings = warning_files(&ran.warnings).into_iter();
        files.extend(warnings.map(|(name, text)| (name.to_owned(), text)));
        if let Some(trace) = trace {
            let markers = trace.camera.map(|camera| camera.markers);
            let tables = [Some(trace.contacts), Some(trace.readings), markers];
            let tables = PASS.into_iter().zip(tables);
            files.extend(
                tables.filter_map(|(name, table)| Some((name.to_owned(), table?.to_csv()))),
            );
        }
        Self::of_files(py, files, ran.trials)
    }

    fn of_files(
        py: Python<'_>,
        files: BTreeMap<String, String>,
        trials: Option<String>,
    ) -> PyResult<Self> {
        let text = |name: &str| {
            let missing = || error::RunError::new_err(format!("there is no {name}"));
            files.get(name).cloned().ok_or_else(missing)
        };
        let study = Study::of(CONFIG.to_owned(), text(CONFIG)?)?;
        let unit = study.study().config.length_unit;
        let columns = result_columns(study.study());
        let table = |csv: &String| Ok::<_, PyErr>(table(py, csv, &columns, unit)?.unbind());
        let warnings = files.get(WARNINGS[1]).map_or("[]", String::as_str);
        let warnings: Vec<Warning> = serde_json::from_str(warnings)
            .map_err(|error| error::RunError::new_err(format!("{}: {error}", WARNINGS[1])))?;
        Ok(Self {
            study: Py::new(py, study)?,
            cells: table(&text(CELLS)?)?,
            failures: table(&text(FAILURES)?)?,
            map: files.get(MAP).map(table).transpose()?,
            trials_out: trials.as_ref().map(table).transpose()?,
            warnings: records(py, &warnings)?,
            files,
        })
    }

    fn config(&self) -> &config::StudyConfig {
        &self.study.get().study().config
    }

    pub(crate) fn in_memory(&self) -> Files {
        Files::in_memory(self.files.clone())
    }
}

#[pymethods]
impl Results {
    /// Reads results from a directory into which `palpate run` has written CSV files. Raises RunError if a file is
    /// missing or is not a table, and ConfigError if the config is invalid.
    #[staticmethod]
    fn read(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let names = [CONFIG, CELLS, FAILURES, MAP].into_iter();
        let names = names.chain(WARNINGS).chain(PASS);
        let there = names.filter(|name| folder.join(name).is_file());
        let text = |name: &str| {
            let path = folder.join(name);
            let text = fs::read_to_string(&path);
            let text = text.map_err(|error| {
                error::RunError::new_err(format!("cannot read {}: {error}", path.display()))
            });
            Ok((name.to_owned(), text?))
        };
        let files = there.map(text).collect::<PyResult<_>>()?;
        let results = Self::of_files(py, files, None);
        results.map_err(|error| match error.is_instance_of::<error::RunError>(py) {
            true => error::RunError::new_err(format!("{}: {}", folder.display(), error.value(py))),
            false => error,
        })
    }

    /// Names of the plots in the config.
    #[getter]
    fn plots(&self) -> Vec<String> {
        let plots = self.config().plot.iter().enumerate();
        let name = |(place, plot): (usize, &config::PlotConfig)| {
            let name = plot.name.clone();
            name.unwrap_or_else(|| format!("plot-{}", place + 1))
        };
        plots.map(name).collect()
    }

    /// Figures of all plots in the config, as `palpate plot` draws them. Without plots in the config, one figure shows
    /// the error over the first swept field. Raises RunError.
    #[getter]
    fn figures(&self, py: Python<'_>) -> PyResult<Vec<Figure>> {
        let files = self.in_memory();
        let drawn = py.detach(|| figures(&Scored::read(files)?));
        let drawn = drawn.map_err(error::run)?;
        Ok(drawn.into_iter().map(Figure::from).collect())
    }

    /// Table with the scores of the claims that the config lists, as in the `claims.csv` of `palpate report`. Raises
    /// RunError.
    #[getter]
    fn claims<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let study = Scored::read(self.in_memory()).map_err(error::run)?;
        table_of(py, &claims_table(&score(&[study])), LengthUnit::Unit)
    }

    /// Draws a plot of the config: the plot with this name, by default the first plot. With keyword arguments, draws a
    /// new plot; they are the keys of a `[[plot]]` table: `results.plot(x="scene.sensor.pitch",
    /// y="relative_rms_error", quantity="radius")`.
    ///
    /// Returns a Figure. Raises ConfigError, RunError.
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
                if let Some(name) = &name {
                    plot["name"] = name.as_str().into();
                }
                let text = config::of_json("plot", &serde_json::json!({ "plot": [plot] }));
                let text = text.map_err(error::config)?;
                let plots = config::plots("plot", &text).map_err(error::config)?;
                plots.into_iter().next()
            }
            None => {
                let names = self.plots();
                let mut plots = names.iter().zip(&self.config().plot);
                let plot = plots.find(|(own, _)| name.as_ref().is_none_or(|name| name == *own));
                plot.map(|(own, plot)| config::PlotConfig {
                    name: Some(own.clone()),
                    ..plot.clone()
                })
            }
        };
        let Some(plot) = plot else {
            let wanted = name.unwrap_or_else(|| "the first".to_owned());
            let message = format!("no plot {wanted}; the config has {:?}", self.plots());
            return Err(error::argument("name", &[], None, message));
        };
        let files = self.in_memory();
        let drawn = py.detach(|| figure(&plot, files));
        Ok(drawn.map_err(error::run)?.into())
    }

    /// Traces one trial of a cell, with the same arguments as `Study.trace`.
    #[pyo3(signature = (cell=0, trial=None))]
    fn trace<'py>(
        &self,
        py: Python<'py>,
        cell: usize,
        trial: Option<u64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        follow(py, self.study.get().shared(), cell, trial)
    }

    /// Contents of the files that `palpate run` would write, by file name. The frames of a traced trial are not
    /// included; use `trace` for them.
    fn files(&self) -> BTreeMap<String, String> {
        self.files.clone()
    }

    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        files: BTreeMap<String, String>,
        trials: Option<String>,
    ) -> PyResult<Self> {
        Self::of_files(py, files, trials)
    }

    #[allow(clippy::type_complexity)]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(
        Bound<'py, PyAny>,
        (BTreeMap<String, String>, Option<String>),
    )> {
        let own = slf.get();
        let csv = |table: &Py<PyAny>| table.call_method0(slf.py(), "to_csv")?.extract(slf.py());
        let trials = own.trials_out.as_ref().map(csv).transpose()?;
        let restored = slf.get_type().getattr("_restored")?;
        Ok((restored, (own.files.clone(), trials)))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.files == other.files
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let cells = self.study.get().study().cell_count();
        let rows = self.cells.getattr(py, "height")?;
        let name = &self.config().name;
        Ok(format!("<Results of {name:?}: {cells} cells, {rows} rows>"))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("palpate._show")?
            .call_method1("results", (slf,))
    }
}
