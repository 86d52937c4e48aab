//! One study: a folder that `palpate run` has filled.

use crate::records::Records;
use crate::{ReportError, Table, file};
use std::path::{Path, PathBuf};

/// One line of `failures.csv`: how many trials of a cell failed, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// The cell.
    pub cell: u64,
    /// Kebab-case name of the error.
    pub kind: String,
    /// Number of trials that failed so.
    pub count: u64,
    /// Number of the first trial that failed so, counted from 0.
    pub first_trial: u64,
}

/// A study's tables and the config behind them.
#[derive(Debug, Clone)]
pub struct Study {
    dir: PathBuf,
    config: toml::Table,
    config_text: String,
    cells: Table,
    failures: Vec<Failure>,
    claims: Vec<u32>,
}

impl Study {
    /// Reads `cells.csv`, `failures.csv` and `run.toml` in `dir`.
    ///
    /// ```
    /// use palpate_report::Study;
    ///
    /// let dir = tempfile::tempdir()?;
    /// let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text);
    /// write("run.toml", "name = \"ball\"\n[scene.probe]\nradius = 20.0\n")?;
    /// write("failures.csv", "cell,kind,count,first_trial\n0,slipped,3,7\n")?;
    /// let statistics = "truth,trials,failures,mean,std,bias,rms_error,mean_abs_error,relative_rms_error,\
    ///     relative_mean_abs_error,q05,q50,q95,mean_reported_std,coverage95";
    /// let row = format!("0,curvature,1/mm,0.2,9,3,0.25{}", ",".repeat(11));
    /// write("cells.csv", &format!("cell,quantity,unit,{statistics}\n{row}\n"))?;
    ///
    /// let study = Study::load(dir.path())?;
    /// assert_eq!(study.number(0, "scene.probe.radius"), Some(20.0));
    /// assert_eq!((study.failures()[0].kind.as_str(), study.failures()[0].count), ("slipped", 3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A file is absent or malformed; see [`ReportError`].
    pub fn load(dir: impl AsRef<Path>) -> Result<Self, ReportError> {
        let dir = dir.as_ref().to_owned();
        let path = dir.join("run.toml");
        let config_text = file::read(&path)?;
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
        let claims = match config.get("claims") {
            None => Vec::new(),
            Some(value) => value
                .as_array()
                .and_then(|list| {
                    list.iter()
                        .map(|n| n.as_integer().and_then(|n| u32::try_from(n).ok()))
                        .collect()
                })
                .ok_or_else(|| {
                    bad(
                        "claims",
                        format!("must be a list of claim numbers, is {value}"),
                    )
                })?,
        };
        let cells = Table::read(&dir.join("cells.csv"))?;
        let failures = read_failures(&dir.join("failures.csv"))?;
        Ok(Self {
            dir,
            config,
            config_text,
            cells,
            failures,
            claims,
        })
    }

    /// The folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The study's name.
    pub fn name(&self) -> &str {
        self.word("name")
    }

    /// The question it answers; its name if it has no title.
    pub fn title(&self) -> &str {
        match self.word("title") {
            "" => self.name(),
            title => title,
        }
    }

    /// Publication or other origin of the question; may be empty.
    pub fn source(&self) -> &str {
        self.word("source")
    }

    /// Numbers of the published claims that this study tests.
    pub fn claims(&self) -> &[u32] {
        &self.claims
    }

    /// The resolved config, as written.
    pub fn config_text(&self) -> &str {
        &self.config_text
    }

    /// The resolved config.
    pub fn config(&self) -> &toml::Table {
        &self.config
    }

    /// `cells.csv`.
    pub fn cells(&self) -> &Table {
        &self.cells
    }

    /// `failures.csv`.
    pub fn failures(&self) -> &[Failure] {
        &self.failures
    }

    /// The value at a dotted path of the config, e.g. `scene.probe.radius`.
    pub fn setting(&self, path: &str) -> Option<&toml::Value> {
        let mut segments = path.split('.');
        let first = self.config.get(segments.next()?)?;
        segments.try_fold(first, |value, segment| value.as_table()?.get(segment))
    }

    /// Number at a dotted `path` of the config in the cell of `row`: the entry of the table's column if the path is
    /// swept, else the config's. `None` if there is no finite number.
    pub fn number(&self, row: usize, path: &str) -> Option<f64> {
        match self.cells.axis(path) {
            Some(axis) => axis.number(row),
            None => number(self.setting(path)?),
        }
    }

    /// Text at a dotted `path` of the config in the cell of `row`: the entry of the table's column if the path is
    /// swept, else the config's. `None` if there is no text.
    pub fn text(&self, row: usize, path: &str) -> Option<&str> {
        match self.cells.axis(path) {
            Some(axis) => Some(axis.text(row)),
            None => self.setting(path)?.as_str(),
        }
    }

    pub(crate) fn run_toml(&self) -> PathBuf {
        self.dir.join("run.toml")
    }

    fn word(&self, key: &str) -> &str {
        self.config
            .get(key)
            .and_then(toml::Value::as_str)
            .unwrap_or_default()
    }
}

/// A TOML number of either kind, if it is finite.
pub(crate) fn number(value: &toml::Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|n| n as f64))
        .filter(|n| n.is_finite())
}

fn read_failures(path: &Path) -> Result<Vec<Failure>, ReportError> {
    let columns = ["cell", "kind", "count", "first_trial"];
    let Records {
        header,
        rows,
        lines,
    } = Records::read(path, &columns)?;
    let place = columns.map(|name| header.iter().position(|column| column == name).unwrap_or(0));
    let count = |row: usize, at: usize| {
        rows[row][place[at]]
            .parse()
            .map_err(|_| ReportError::BadCell {
                path: path.to_owned(),
                line: lines[row],
                column: columns[at].to_owned(),
                value: rows[row][place[at]].clone(),
                expected: "a whole number",
            })
    };
    (0..rows.len())
        .map(|row| {
            Ok(Failure {
                cell: count(row, 0)?,
                kind: rows[row][place[1]].clone(),
                count: count(row, 2)?,
                first_trial: count(row, 3)?,
            })
        })
        .collect()
}
