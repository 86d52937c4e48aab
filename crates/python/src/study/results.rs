//! Results of a study.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use palpate::config::{self, LengthUnit};
use palpate::report::{Study as Scored, claims_table, figures, score};
use palpate::{Files, ReportError, Warning, figure, resolved, result_columns, warning_files};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::runs::Found;
use super::trace::Trace;
use crate::error;
use crate::figure::Figure;
use crate::record::records;
use crate::table::{csv_of, table, table_of};

const CONFIG: &str = "run.toml";
const CELLS: &str = "cells.csv";
const FAILURES: &str = "failures.csv";
const MAP: &str = "map.csv";
const WARNINGS: [&str; 2] = ["warnings.txt", "warnings.json"];
/// Files of a pass.
const PASS: [&str; 3] = ["trace.csv", "readings.csv", "markers.csv"];

/// Results of a study that was run.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Results {
    of: Arc<palpate::Study>,
    /// Texts of the files that the command line writes, by their names.
    files: BTreeMap<String, String>,
    /// Study as it was run.
    #[pyo3(get)]
    study: Py<PyAny>,
    /// Table of one row per cell and quantity: swept values, truth, mean, bias, errors, quantiles.
    #[pyo3(get)]
    cells: Py<PyAny>,
    /// Table of the trials that gave no number, by cell and kind.
    #[pyo3(get)]
    failures: Py<PyAny>,
    /// Table of the maps, or profiles, of trial 0 of each cell; None unless the config's `outputs` ask for it.
    #[pyo3(get)]
    map: Option<Py<PyAny>>,
    /// Table of all trials, a row per observation or failure; None unless the run was asked for it.
    #[pyo3(get)]
    trials_out: Option<Py<PyAny>>,
    /// Warnings of cells in which the theory or the estimator does not hold, each with `code`, `text` and `numbers`.
    #[pyo3(get)]
    warnings: Py<PyAny>,
}

/// Error of tables and figures.
fn refused(error: ReportError) -> PyErr {
    error::RunError::new_err(error.to_string())
}

impl Results {
    /// Results of a study that was run.
    pub(super) fn of(py: Python<'_>, study: Arc<palpate::Study>, found: Found) -> PyResult<Self> {
        let Found { ran, trace } = found;
        let mut files = BTreeMap::from([
            (CONFIG.to_owned(), resolved(&study)),
            (CELLS.to_owned(), ran.cells.to_csv()),
            (FAILURES.to_owned(), ran.failures.to_csv()),
        ]);
        files.extend(ran.map.map(|map| (MAP.to_owned(), map.to_csv())));
        let warnings = warning_files(&ran.warnings).into_iter();
        files.extend(warnings.map(|(name, text)| (name.to_owned(), text)));
        if let Some(trace) = trace {
            let markers = trace.camera.map(|seen| seen.markers);
            let tables = [Some(trace.contacts), Some(trace.readings), markers];
            let tables = PASS.into_iter().zip(tables);
            files.extend(
                tables.filter_map(|(name, table)| Some((name.to_owned(), table?.to_csv()))),
            );
        }
        Self::of_files(py, files, ran.trials)
    }

    /// Results whose files have these texts.
    fn of_files(
        py: Python<'_>,
        files: BTreeMap<String, String>,
        trials: Option<String>,
    ) -> PyResult<Self> {
        let text = |name: &str| {
            let missing = || error::RunError::new_err(format!("there is no {name}"));
            files.get(name).cloned().ok_or_else(missing)
        };
        let of = config::parse(CONFIG, &text(CONFIG)?).map_err(error::config)?;
        // By its name in Python: a study makes results, so that its file is not one to import here.
        let named = PyDict::new(py);
        named.set_item("name", CONFIG)?;
        let study = py.import("palpate")?.getattr("Study")?;
        let study = study.call((text(CONFIG)?,), Some(&named))?;
        let unit = of.config.length_unit;
        let columns = result_columns(&of);
        let table = |csv: &String| table(py, csv, &columns, unit);
        let warnings = files.get(WARNINGS[1]).map_or("[]", String::as_str);
        let warnings: Vec<Warning> = serde_json::from_str(warnings)
            .map_err(|error| error::RunError::new_err(format!("{}: {error}", WARNINGS[1])))?;
        Ok(Self {
            of: Arc::new(of),
            study: study.unbind(),
            cells: table(&text(CELLS)?)?,
            failures: table(&text(FAILURES)?)?,
            map: files.get(MAP).map(table).transpose()?,
            trials_out: trials.as_ref().map(table).transpose()?,
            warnings: records(py, &warnings)?,
            files,
        })
    }

    /// Files that the command line writes, in memory.
    pub(crate) fn in_memory(&self) -> Files {
        Files::in_memory(self.files.clone())
    }
}

#[pymethods]
impl Results {
    /// Results in a directory that `palpate run` wrote, as CSV. Raises RunError for a file that is missing or no table,
    /// ConfigError for a config that is none.
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

    /// Figures of all plots that the config asks for, as `palpate plot` draws them; where it has none, the error over the
    /// first swept field. Raises RunError.
    #[getter]
    fn figures(&self, py: Python<'_>) -> PyResult<Vec<Figure>> {
        let files = self.in_memory();
        let drawn = py.detach(|| figures(&Scored::read(files)?));
        Ok(drawn
            .map_err(refused)?
            .into_iter()
            .map(Figure::from)
            .collect())
    }

    /// Table of how the papers' claims score that the config names: the `claims.csv` of `palpate report`. Raises RunError.
    #[getter]
    fn claims(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let study = Scored::read(self.in_memory()).map_err(refused)?;
        table_of(py, &claims_table(&score(&[study])), LengthUnit::Unit)
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
        let files = self.in_memory();
        let drawn = py.detach(|| figure(&plot, files));
        Ok(drawn.map_err(refused)?.into())
    }

    /// Follows one pass of a cell, as `Study.trace`.
    #[pyo3(signature = (cell=0, trial=None))]
    fn trace(&self, py: Python<'_>, cell: usize, trial: Option<u64>) -> PyResult<Trace> {
        Trace::of(py, Arc::clone(&self.of), cell, trial)
    }

    /// Texts of the files that `palpate run` writes, by their names, byte for byte; frames that a pass renders are those of
    /// `trace`.
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
        let trials = own.trials_out.as_ref();
        let trials = trials.map(|trials| csv_of(slf.py(), trials)).transpose()?;
        let restored = slf.get_type().getattr("_restored")?;
        Ok((restored, (own.files.clone(), trials)))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.files == other.files
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let cells = self.of.cell_count();
        let rows = self.cells.getattr(py, "height")?;
        let name = &self.of.config.name;
        Ok(format!("<Results of {name:?}: {cells} cells, {rows} rows>"))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("palpate._show")?
            .call_method1("results", (slf,))
    }
}
