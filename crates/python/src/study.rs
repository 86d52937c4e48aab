//! Defines studies: their configs, plans and runs.

mod results;
mod runs;
mod trace;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use palpate::config;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::error;
use crate::json::{from_python, to_python};
use crate::record::Record;
use crate::sensor;

pub(crate) use results::Results;
pub(crate) use runs::runner;
pub(crate) use trace::Trace;

/// Study of a simulated scene, with sweeps of the scene's fields and plots of the results.
///
/// Parameters
/// ----------
/// source : str, dict or path
///     Config as TOML text, as a dictionary with the same keys, or as the path of a file. `palpate.schema()` describes
///     every key, with its unit and its default.
/// name : str, optional
///     Name of the config in messages, if `source` is not a path; "study" by default.
///
/// Raises
/// ------
/// ConfigError
///     If a field is missing, unknown or out of its range. The attribute `path` of the error names the field.
///
/// Examples
/// --------
/// >>> study = palpate.Study({
/// ...     "name": "a-ball", "length_unit": "mm", "trials": 100,
/// ...     "scene": palpate.scene(
/// ...         "roll", probe=palpate.surface("sphere", radius=10.0), object=palpate.surface("sphere", radius=30.0),
/// ...         motion={"rate_rad_per_s": 0.1, "duration_s": 1.0},
/// ...         sensor={"kind": "pads", "pitch": 0.5}),
/// ... })
/// >>> study.with_(**{"scene.sensor.pitch": 0.2}).run().cells["mean"].shape
/// (5,)
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Study {
    study: Arc<palpate::Study>,
    file: String,
    text: String,
}

impl Study {
    pub(crate) fn of(file: String, text: String) -> PyResult<Self> {
        let study = config::parse(&file, &text).map_err(error::config)?;
        let study = Arc::new(study);
        Ok(Self { study, file, text })
    }

    pub(crate) fn study(&self) -> &palpate::Study {
        &self.study
    }

    /// Copy of the study with another number of trials and another seed; `None` keeps the value of the study.
    pub(crate) fn with(&self, trials: Option<u64>, seed: Option<u64>) -> PyResult<palpate::Study> {
        let mut study = palpate::Study::clone(&self.study);
        study
            .override_numbers(seed, trials)
            .map_err(error::config)?;
        Ok(study)
    }

    /// Checks that the study has cells with these numbers. Returns the numbers in ascending order and without
    /// duplicates.
    fn cells(&self, numbers: Vec<usize>) -> PyResult<Vec<usize>> {
        let count = self.study.cell_count();
        if let Some(place) = numbers.iter().position(|&number| number >= count) {
            let (number, last) = (numbers[place], count - 1);
            let message = format!("cells[{place}]: is {number}; the study has cells 0 to {last}");
            let value = Some(number as f64);
            return Err(error::argument("cells", &[place], value, message));
        }
        let ascending: BTreeSet<usize> = numbers.into_iter().collect();
        Ok(ascending.into_iter().collect())
    }

    pub(crate) fn shared(&self) -> Arc<palpate::Study> {
        Arc::clone(&self.study)
    }
}

/// Collects pairs of path and value from a dictionary and from keyword arguments.
fn fields(
    fields: Option<&Bound<'_, PyDict>>,
    more: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<(String, serde_json::Value)>> {
    let all = fields
        .into_iter()
        .chain(more)
        .flat_map(|fields| fields.iter());
    all.map(|(path, value)| Ok((path.extract()?, from_python(&value)?)))
        .collect()
}

#[pymethods]
impl Study {
    #[new]
    #[pyo3(signature = (source, *, name=None))]
    fn new(source: &Bound<'_, PyAny>, name: Option<String>) -> PyResult<Self> {
        let file = name.unwrap_or_else(|| "study".to_owned());
        if let Ok(text) = source.cast::<PyString>() {
            return Self::of(file, text.to_cow()?.into_owned());
        }
        if source.is_instance_of::<PyDict>() {
            let text = config::of_json(&file, &from_python(source)?).map_err(error::config)?;
            return Self::of(file, text);
        }
        let path: PathBuf = source.extract().map_err(|_| {
            let message = "source must be a text, a dictionary or the path of a file";
            PyTypeError::new_err(message)
        })?;
        let study = config::load(&path).map_err(error::config)?;
        Ok(Self {
            file: path.display().to_string(),
            text: study.text().to_owned(),
            study: Arc::new(study),
        })
    }

    /// Name of the study.
    #[getter]
    fn name(&self) -> &str {
        &self.study.config.name
    }

    /// The question that the study answers. It may be empty.
    #[getter]
    fn title(&self) -> &str {
        &self.study.config.title
    }

    /// Unit of all lengths in the study.
    #[getter]
    fn length_unit(&self) -> &'static str {
        self.study.config.length_unit.as_str()
    }

    /// Number of cells of the study. A cell is one combination of the swept values.
    #[getter]
    fn cell_count(&self) -> usize {
        self.study.cell_count()
    }

    /// Number of trials of all cells together. A run may do fewer trials, because a cell without random numbers runs
    /// only one trial.
    #[getter]
    fn trials(&self) -> u64 {
        self.study.trials()
    }

    /// Seed of all random numbers of the study.
    #[getter]
    fn seed(&self) -> u64 {
        self.study.config.seed
    }

    /// The config as TOML text, as it was given. Defaults are not included.
    #[getter]
    fn toml(&self) -> &str {
        &self.text
    }

    /// The config with all defaults as TOML text, as `palpate run` writes it to `run.toml`.
    #[getter]
    fn resolved(&self) -> String {
        palpate::resolved(&self.study)
    }

    /// Config with all defaults as a dictionary.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        crate::json::to_python(py, &self.study.config)
    }

    /// Swept values of a cell, as a dictionary from paths to values.
    fn cell<'py>(&self, py: Python<'py>, number: usize) -> PyResult<Bound<'py, PyDict>> {
        let cell = self.study.cell(number).map_err(error::config)?;
        let values = PyDict::new(py);
        for (path, text) in self.study.paths.iter().zip(&cell.coordinates) {
            // The coordinates of a cell are stored as text, so parse the values.
            let value = serde_json::from_str(text);
            let value = value.unwrap_or_else(|_| serde_json::Value::String(text.clone()));
            values.set_item(path, to_python(py, &value)?)?;
        }
        Ok(values)
    }

    /// Copy of the study with some fields changed. Each field is given by its path:
    /// `study.with_(**{"scene.sensor.pitch": 0.2}, trials=100)`.
    ///
    /// The value None removes a field. Raises ConfigError.
    #[pyo3(signature = (fields=None, /, **more))]
    fn with_(
        &self,
        fields: Option<Bound<'_, PyDict>>,
        more: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let fields = self::fields(fields.as_ref(), more.as_ref())?;
        let text = config::with_fields(&self.file, &self.text, &fields);
        Self::of(self.file.clone(), text.map_err(error::config)?)
    }

    /// Copy of the study that also sweeps these fields. Each field is given by its path, with a list of values:
    /// `study.sweep(**{"scene.sensor.pitch": [0.1, 0.2, 0.5]})`. The cells are all combinations of the values of all
    /// swept fields. Raises ConfigError.
    #[pyo3(signature = (axes=None, /, **more))]
    fn sweep(
        &self,
        axes: Option<Bound<'_, PyDict>>,
        more: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let axes = self::fields(axes.as_ref(), more.as_ref())?;
        let text = config::with_axes(&self.file, &self.text, &axes);
        Self::of(self.file.clone(), text.map_err(error::config)?)
    }

    /// Forecasts a run: its cells, its trials, the models that it needs, and its approximate run time.
    ///
    /// Returns a Record. `cells`, `checked`, `set_up` and `single` are numbers of cells: of all cells, of checked
    /// cells, of cells whose models were set up, and of cells that run only one trial. `trials` is the number of trials
    /// of all cells. `seconds` is the estimated run time with `threads` threads. `groups` lists groups of cells that
    /// need the same models. A group has the number of its `cells`, its `needs` (models with reasons), and its `rungs`
    /// (models that can compute the true values, with their errors and computing times in s). `intervals` lists
    /// coverages of 95 % intervals that were measured in similar random scenes, each with the number of `cells` to
    /// which it applies. A coverage has the name of the `family` of scenes, `beyond` (numbers outside the family's
    /// ranges), the number of `scenes`, `coverage95`, `lowest` (the lowest coverage in one scene) and `holds` (whether
    /// `coverage95` is between 0.92 and 0.98). If no coverage was measured, it has the reason `not_tested` instead.
    ///
    /// The function `progress` is called with the number of cells that were checked since its last call. Raises
    /// ConfigError.
    #[pyo3(signature = (*, threads=None, progress=None))]
    fn check<'py>(
        &self,
        py: Python<'py>,
        threads: Option<usize>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let check = runs::check(py, self.shared(), threads, progress.as_ref())?;
        Record::of(py, &check)
    }

    /// Copy of the study with a number of trials and a model that are chosen for a time budget (s), a target error, or
    /// both. The target error is the largest allowed relative standard error of the rms error of any quantity. Raises
    /// ConfigError, RunError.
    #[pyo3(signature = (*, budget=None, target_error=None, threads=None))]
    fn plan(
        &self,
        py: Python<'_>,
        budget: Option<f64>,
        target_error: Option<f64>,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let text = runs::plan(py, self.shared(), budget, target_error, threads)?;
        Self::of(self.file.clone(), text)
    }

    /// Runs all trials, without the interpreter's lock.
    ///
    /// Parameters
    /// ----------
    /// trials, seed : int, optional
    ///     Number of trials per cell, and seed. They replace the numbers in the study.
    /// threads : int, optional
    ///     Number of threads; by default one per processor. The results do not depend on this number.
    /// cells : sequence of int, optional
    ///     Numbers of the cells to run; by default all. The rows of the tables keep these numbers.
    /// trials_out : bool
    ///     Whether the results contain a table of all trials, as `palpate run --trials-out` writes it.
    /// progress : callable, optional
    ///     Function that is called from time to time with the number of trials done since its last call, for example
    ///     `tqdm(total=…).update`.
    ///
    /// Returns
    /// -------
    /// Results
    ///     The tables have the same bytes as the tables that `palpate run` writes. Ctrl-C stops the run within 0.1 s.
    ///
    /// Raises
    /// ------
    /// ArgumentError
    ///     If the study does not have a cell with a number in `cells`.
    /// ConfigError
    ///     If a cell does not describe a valid scene.
    #[pyo3(signature = (*, trials=None, seed=None, threads=None, cells=None, trials_out=false, progress=None))]
    #[allow(clippy::too_many_arguments)]
    fn run(
        &self,
        py: Python<'_>,
        trials: Option<u64>,
        seed: Option<u64>,
        threads: Option<usize>,
        cells: Option<Vec<usize>>,
        trials_out: bool,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Results> {
        let study = Arc::new(self.with(trials, seed)?);
        let cells = cells.map(|cells| self.cells(cells)).transpose()?;
        let part = (Arc::clone(&study), cells);
        let found = runs::run(py, part, trials_out, threads, progress.as_ref())?;
        Results::of(py, &study, found)
    }

    /// Traces one trial of a cell, and returns a Trace. `trial` is the number of a trial, which is repeated with its
    /// noise. By default, a trial without noise is traced.
    ///
    /// Raises ConfigError if the study does not have the cell, and RunError if the trial ends early.
    #[pyo3(signature = (cell=0, trial=None))]
    fn trace<'py>(
        &self,
        py: Python<'py>,
        cell: usize,
        trial: Option<u64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        trace::follow(py, self.shared(), cell, trial)
    }

    /// Flat pattern for cutting the sensor's skin, as a Pattern. Raises ConfigError if the sensor has no pattern.
    fn pattern<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        sensor::pattern_of(py, &self.study)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.resolved() == other.resolved()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let own = slf.get();
        let restored = slf.get_type().getattr("_restored")?;
        Ok((restored, (own.file.clone(), own.text.clone())))
    }

    #[staticmethod]
    fn _restored(file: String, text: String) -> PyResult<Self> {
        Self::of(file, text)
    }

    fn __repr__(&self) -> String {
        let (cells, trials) = (self.study.cell_count(), self.study.trials());
        let name = &self.study.config.name;
        let kind = self.study.config.scene.kind();
        format!("<Study {name:?}: a {kind}, {cells} cells, {trials} trials>")
    }
}
