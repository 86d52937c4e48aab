//! A study, read from the files that `palpate run` wrote.

use crate::records::Records;
use crate::{Files, ReportError, Table};
use palpate_study::config::{self, PlotConfig};
use std::path::{Path, PathBuf};

/// A row of `failures.csv`: the failed trials of one cell that failed in the same way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Failure {
    pub(crate) cell: u64,
    /// Name of the kind of failure, such as `not-rolling`.
    pub(crate) kind: String,
    pub(crate) count: u64,
    /// Number of the first trial that failed in this way, counted from 0.
    pub(crate) first_trial: u64,
}

/// The tables of a study and its config.
#[derive(Debug, Clone)]
pub struct Study {
    files: Files,
    config: toml::Table,
    config_text: String,
    cells: Table,
    failures: Vec<Failure>,
    claims: Vec<u32>,
}

impl Study {
    /// Reads a study from `cells.csv`, `failures.csv` and `run.toml` among `files`.
    ///
    /// ```
    /// use palpate_report::{Files, Study};
    ///
    /// let dir = tempfile::tempdir()?;
    /// let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text);
    /// write("run.toml", "name = \"ball\"\n[scene.probe]\nradius = 20.0\n")?;
    /// write("failures.csv", "cell,kind,count,first_trial\n0,slipped,3,7\n")?;
    /// let statistics = "truth,trials,failures,mean,std,bias,rms_error,rms_error_std,mean_abs_error,relative_rms_error,\
    ///     relative_mean_abs_error,q05,q50,q95,mean_reported_std,coverage50,coverage80,coverage95";
    /// let row = format!("0,curvature,1/mm,0.2,9,3,0.25{}", ",".repeat(14));
    /// write("cells.csv", &format!("cell,quantity,unit,{statistics}\n{row}\n"))?;
    ///
    /// let study = Study::read(Files::in_folder(dir.path()))?;
    /// assert_eq!((study.name(), study.dir()), ("ball", dir.path()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ReportError`] if a file is missing or malformed.
    pub fn read(files: Files) -> Result<Self, ReportError> {
        let path = files.path("run.toml");
        let config_text = files.read("run.toml")?;
        let config: toml::Table = config_text.parse().map_err(|source| ReportError::Toml {
            path: path.clone(),
            source: Box::new(source),
        })?;
        let bad = |key: &str, problem: String| ReportError::BadKey {
            path: path.clone(),
            key: key.to_owned(),
            problem,
        };
        for key in ["name", "title", "source"] {
            if let Some(value) = config.get(key)
                && !value.is_str()
            {
                return Err(bad(key, format!("must be a string, is {value}")));
            }
        }
        if !config.contains_key("name") {
            return Err(bad("name", "is missing".to_owned()));
        }
        let number = |value: &toml::Value| u32::try_from(value.as_integer()?).ok();
        let list = |value: &toml::Value| -> Option<Vec<u32>> {
            value.as_array()?.iter().map(number).collect()
        };
        let claims = config.get("claims").map_or(Ok(Vec::new()), |value| {
            let problem = || format!("must be a list of claim numbers, is {value}");
            list(value).ok_or_else(|| bad("claims", problem()))
        })?;
        let cells = Table::read(&files)?;
        let failures = read_failures(&files)?;
        Ok(Self {
            files,
            config,
            config_text,
            cells,
            failures,
            claims,
        })
    }

    /// Folder of the study; an empty path if the study is in memory.
    pub fn dir(&self) -> &Path {
        self.files.folder()
    }

    pub(crate) fn files(&self) -> &Files {
        &self.files
    }

    pub(crate) fn plots(&self) -> Result<Vec<PlotConfig>, ReportError> {
        let file = self.run_toml().display().to_string();
        Ok(config::plots(&file, &self.config_text)?)
    }

    /// The study's name.
    pub fn name(&self) -> &str {
        self.word("name")
    }

    /// The question that the study answers; the study's name if it states no question.
    pub(crate) fn title(&self) -> &str {
        match self.word("title") {
            "" => self.name(),
            title => title,
        }
    }

    pub(crate) fn source(&self) -> &str {
        self.word("source")
    }

    pub(crate) fn claims(&self) -> &[u32] {
        &self.claims
    }

    /// Text of `run.toml`: the config with all defaults.
    pub(crate) fn config_text(&self) -> &str {
        &self.config_text
    }

    pub(crate) fn cells(&self) -> &Table {
        &self.cells
    }

    pub(crate) fn failures(&self) -> &[Failure] {
        &self.failures
    }

    pub(crate) fn setting(&self, path: &str) -> Option<&toml::Value> {
        let mut segments = path.split('.');
        let first = self.config.get(segments.next()?)?;
        segments.try_fold(first, |value, segment| value.as_table()?.get(segment))
    }

    /// Number in the config field at `path`, for the table row `row`. If the study sweeps the field, or a part of the
    /// scene that contains the field, this is the swept value; otherwise, it is the value in the config. `None` if the
    /// value is not a finite number.
    pub(crate) fn number(&self, row: usize, path: &str) -> Option<f64> {
        match self.cells.axis(path) {
            Some(axis) => axis.number(row),
            None => number(self.value(row, path)?),
        }
    }

    /// Text in the config field at `path`, for the table row `row`. If the study sweeps the field, or a part of the
    /// scene that contains the field, this is the swept value; otherwise, it is the value in the config. `None` if the
    /// value is not a text.
    pub(crate) fn text(&self, row: usize, path: &str) -> Option<&str> {
        match self.cells.axis(path) {
            Some(axis) => Some(axis.text(row)),
            None => self.value(row, path)?.as_str(),
        }
    }

    /// Value of a field of the config that has no column of its own in `cells.csv`. If a sweep sets a part of the scene
    /// that contains the field, the value comes from this part; otherwise from the config. `None` if the field has no
    /// value.
    fn value(&self, row: usize, path: &str) -> Option<&toml::Value> {
        let mut dots = path.match_indices('.').rev();
        let swept = dots.find_map(|(dot, _)| Some((dot, self.cells.axis(&path[..dot])?)));
        let Some((dot, axis)) = swept else {
            return self.setting(path);
        };
        let mut keys = path[dot + 1..].split('.');
        let first = self
            .labelled(&path[..dot], axis.text(row))?
            .get(keys.next()?)?;
        keys.try_fold(first, |value, key| value.as_table()?.get(key))
    }

    /// Searches the TOML tables that the study sweeps at `path`, and returns the table with the label `label`; `None`
    /// if there is none. If a table has no label, its `kind` is used as its label.
    fn labelled(&self, path: &str, label: &str) -> Option<&toml::Table> {
        let sweeps = self.config.get("sweep")?.as_array()?.iter();
        let mut tables = sweeps
            .flat_map(|sweep| swept_values(sweep, path))
            .filter_map(toml::Value::as_table);
        tables.find(|table| {
            let name = table.get("label").or_else(|| table.get("kind"));
            name.and_then(toml::Value::as_str) == Some(label)
        })
    }

    pub(crate) fn run_toml(&self) -> PathBuf {
        self.files.path("run.toml")
    }

    fn word(&self, key: &str) -> &str {
        self.config
            .get(key)
            .and_then(toml::Value::as_str)
            .unwrap_or_default()
    }
}

/// Values of the field at `path` in `sweep`, which is one sweep of the study. A sweep varies one field, or several
/// fields together. The list is empty if this sweep does not vary the field at `path`.
fn swept_values<'a>(sweep: &'a toml::Value, path: &str) -> Vec<&'a toml::Value> {
    let values = || sweep.get("values")?.as_array();
    let values = values().map_or(&[][..], Vec::as_slice).iter();
    let is_it = |name: &toml::Value| name.as_str() == Some(path);
    if sweep.get("path").is_some_and(is_it) {
        return values.collect();
    }
    let paths = || sweep.get("paths")?.as_array();
    let place = paths().and_then(|paths| paths.iter().position(is_it));
    let of_place = |value: &'a toml::Value| value.as_array()?.get(place?);
    values.filter_map(of_place).collect()
}

pub(crate) fn number(value: &toml::Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|n| n as f64))
        .filter(|n| n.is_finite())
}

fn read_failures(files: &Files) -> Result<Vec<Failure>, ReportError> {
    let columns = ["cell", "kind", "count", "first_trial"];
    let table = Records::read_in_order(files, "failures.csv", &columns, columns.len())?;
    let count = |row: usize, column: usize| table.parsed(row, column, "a whole number");
    let failure = |row: usize| {
        Ok(Failure {
            cell: count(row, 0)?,
            kind: table.text(row, 1).to_owned(),
            count: count(row, 2)?,
            first_trial: count(row, 3)?,
        })
    };
    (0..table.rows()).map(failure).collect()
}
