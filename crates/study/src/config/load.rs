//! Reads a study from a file or a text, and validates its cells.

use super::error::{ConfigError, Fault, Source};
use super::grid::Grid;
use super::plot::PlotConfig;
use super::schema::SCHEMA;
use super::study::StudyConfig;
use super::sweep::{Axis, SweepConfig, SweptValue};
use super::tree::as_number;
use super::{plot, sample, schema, sweep, tree, validate};
use crate::bounded_read::read_limited;
use crate::readings::{check_names, columns_of};
use crate::table::ColumnType;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;
use std::io::ErrorKind;
use std::path::Path;
use toml::Value;

const MAX_MIB: u64 = 16;

/// A study, read from a valid config. In a study with many cells, only the cells in [`Study::sample`] were validated.
#[derive(Debug, Clone)]
pub struct Study {
    /// The config of the first cell with all defaults, together with the sweeps and plots of the study, as in
    /// `run.toml`. It defines the same cells as the original config.
    pub config: StudyConfig,
    /// The swept fields, in the order of the config.
    pub paths: Vec<String>,
    /// Names of the columns of the swept fields: their paths, with the unit appended if the field has a unit.
    pub columns: Vec<String>,
    pub(super) source: Source,
    pub(super) grid: Grid,
    /// Numbers of the cells that were validated, in ascending order. In a study of up to 10,000 cells, these are all
    /// cells. In a larger study, they are a sample.
    pub sample: Vec<usize>,
    /// Whether every swept value is a number, a word or a Boolean. If so, each value was validated when the study was
    /// read, and the cells are not validated again.
    has_plain_values: bool,
    /// Whether palpate wrote the config. The scene of a config that palpate wrote contains the first value of every
    /// swept field.
    is_resolved: bool,
}

/// A grid point of the study: one combination of the swept values.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// The swept values as the result tables show them, one text per column. A TOML table is shown as its label, a
    /// number in its shortest form.
    pub coordinates: Vec<String>,
    /// The config of the cell: the swept values are inserted, and the sweeps and plots are removed.
    pub config: StudyConfig,
}

/// Reads a study from a file.
///
/// # Errors
/// [`ConfigError`] if the file cannot be read, if it is not UTF-8, and for every error of [`parse`].
pub fn load(path: &Path) -> Result<Study, ConfigError> {
    let file = path.display().to_string();
    let bytes = read_limited(path, MAX_MIB).map_err(|error| {
        let message = match error.kind() {
            ErrorKind::NotFound => "no such file".to_string(),
            ErrorKind::IsADirectory => "is a directory, not a config".to_string(),
            _ => format!("cannot be read: {error}"),
        };
        ConfigError::of_file(&file, message)
    })?;
    match String::from_utf8(bytes) {
        Ok(text) => parse(&file, &text),
        Err(error) => {
            let valid = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..valid]
                .iter()
                .filter(|&&byte| byte == b'\n')
                .count()
                + 1;
            let byte = error.as_bytes()[valid];
            Err(ConfigError::of_file(
                &file,
                format!("is not UTF-8: byte 0x{byte:02x} in line {line}"),
            ))
        }
    }
}

/// Reads a study from a text. Error messages name `file` as the file of the text.
///
/// ```
/// use palpate_study::config::parse;
///
/// let text = r#"
///     name = "roll-on-a-ball"
///     length_unit = "cm"
///     scene.kind = "roll"
///     scene.probe = { kind = "sphere", radius = 1.0 }
///     scene.object = { kind = "sphere", radius = 4.0 }
///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
///     sweep = [{ path = "scene.object.radius", values = [2.0, 4.0] }]
/// "#;
/// let study = parse("study.toml", text)?;
/// assert_eq!(study.cell_count(), 2);
/// assert_eq!(study.cell(1)?.coordinates, ["4"]);
/// assert_eq!(study.columns, ["scene.object.radius_cm"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ConfigError`] for the first fault: a fault of syntax, keys, types, limits, sweeps or plots, or fields that
/// contradict each other in a cell of the study's [sample](Study::sample).
pub fn parse(file: &str, text: &str) -> Result<Study, ConfigError> {
    read(Source::new(file, text))
}

pub(super) fn read(source: Source) -> Result<Study, ConfigError> {
    let faulty = |fault| source.error(fault);
    let mut base = tree::parse(&source.text).map_err(faulty)?;
    if base.as_table().is_none_or(toml::Table::is_empty) {
        return Err(ConfigError::of_file(
            &source.file,
            "the config is empty; it needs a `name` and a table `[scene]`",
        ));
    }
    let sweep: (_, Vec<SweepConfig>) = section(&mut base, "sweep").map_err(faulty)?;
    let plots: (_, Vec<PlotConfig>) = section(&mut base, "plot").map_err(faulty)?;
    let version = tree::take(&mut base, "crate_version");
    let is_resolved = version.is_some();
    if let Some(version) = version {
        check_version(&version).map_err(|fault| faulty(fault.under("crate_version")))?;
    }
    let axes = sweep::axes(&sweep.1).map_err(faulty)?;
    check_stop(&base, &axes).map_err(faulty)?;
    let grid = Grid::new(base, axes);
    let sample = sample::sample(&grid);

    let Some((&number, others)) = sample.split_first() else {
        return Err(ConfigError::of_file(&source.file, "the study has no cell"));
    };
    let first = checked(&source, &grid, number)?;
    let has_plain_values = grid.has_plain_values();
    if has_plain_values || sample.len() < grid.cells() {
        check_values(&source, &grid)?;
    }
    for &number in others {
        cell_config(&source, &grid, number, has_plain_values)?;
    }
    plot::check(&plots.0, &plots.1, &grid, &first.outputs).map_err(faulty)?;
    check_columns(&first).map_err(faulty)?;

    let config = StudyConfig {
        trials: first
            .stop
            .as_ref()
            .map_or(first.trials, |stop| stop.max_trials),
        sweep: sweep.1,
        plot: plots.1,
        ..first
    };
    let paths: Vec<String> = grid.targets().map(|target| target.path.clone()).collect();
    let columns = paths
        .iter()
        .map(|path| schema::column(&SCHEMA, path, config.length_unit))
        .collect();
    Ok(Study {
        config,
        paths,
        columns,
        has_plain_values,
        source,
        grid,
        sample,
        is_resolved,
    })
}

/// Rejects a config of a later version of palpate, which may interpret it differently.
fn check_version(version: &Value) -> Result<(), Fault> {
    const OWN: &str = env!("CARGO_PKG_VERSION");
    let Some(text) = version.as_str() else {
        let found = tree::describe(version);
        return Err(Fault::new(format!("expected a string, found {found}")));
    };
    let numbers = |text: &str| {
        let release = text.split(['-', '+']).next().unwrap_or_default();
        let numbers = release.split('.').map(|number| number.parse::<u64>().ok());
        numbers
            .collect::<Option<Vec<u64>>>()
            .filter(|all| all.len() == 3)
    };
    let message = match numbers(text) {
        None => format!("{text:?} is not a version, which is written as {OWN:?}"),
        later if later > numbers(OWN) => format!(
            "the config is of version {text}, but this is {OWN}; a later version may interpret it \
             differently"
        ),
        Some(_) => return Ok(()),
    };
    Err(Fault::new(message))
}

/// Rejects an entry of `columns` for a column that the readings of the scene do not have.
fn check_columns(config: &StudyConfig) -> Result<(), Fault> {
    let columns = columns_of(config.scene.kind());
    check_names(&config.columns, &columns).map_err(|error| {
        Fault::new(error.message)
            .under(&error.path)
            .under("columns")
    })
}

/// Rejects a number of trials that contradicts the stopping rule (`stop`).
fn check_stop(base: &Value, axes: &[Axis]) -> Result<(), Fault> {
    let number = |path: &str| tree::at(base, path).and_then(as_number);
    if base.get("stop").is_none() {
        return Ok(());
    }
    let mut targets = axes.iter().flat_map(|axis| &axis.targets);
    if let Some(target) = targets.find(|target| target.path == "trials") {
        let message = "is swept, but `stop` decides the number of trials; keep only one of them";
        return Err(Fault {
            path: "trials".into(),
            ..target.fault(message.into())
        });
    }
    let most = number("stop.max_trials");
    if number("trials").is_some_and(|trials| most.is_some_and(|most| most != trials)) {
        let message =
            "differs from `stop.max_trials`, but `stop` decides the number of trials; remove it";
        return Err(Fault::new(message).under("trials"));
    }
    if let (Some(least), Some(most)) = (number("stop.min_trials"), most)
        && least > most
    {
        let message = format!("must be <= max_trials, which is {most}, is {least}");
        return Err(Fault::new(message).under("min_trials").under("stop"));
    }
    Ok(())
}

/// Validates the values of all sweep axes, row by row. If a row has an invalid value, the error states the cell that
/// combines this row with the first rows of all other axes.
fn check_values(source: &Source, grid: &Grid) -> Result<(), ConfigError> {
    let (first, _) = grid.tree(0);
    for (place, axis) in grid.axes.iter().enumerate() {
        let schemas: Option<Vec<&Json>> = axis
            .targets
            .iter()
            .map(|target| validate::at(&SCHEMA, &first, &target.path))
            .collect();
        let is_valid = |row: &[SweptValue]| {
            let mut fields = schemas.iter().flatten().zip(row);
            let valid = |(schema, value): (&&Json, &SweptValue)| {
                validate::validate(schema, &value.value).is_ok()
            };
            schemas.is_some() && fields.all(valid)
        };
        for index in 0..axis.len() {
            if !is_valid(&axis.row(index)) {
                let mut rows = vec![0; grid.axes.len()];
                rows[place] = index;
                checked(source, grid, grid.cell_of(&rows))?;
            }
        }
    }
    Ok(())
}

/// Reads only the plots of a study's config. Error messages name `file` as the file of the text.
///
/// ```
/// use palpate_study::config::{PlotKind, plots};
///
/// let found = plots("run.toml", "[[plot]]\nkind = \"contacts\"\n")?;
/// assert_eq!(found[0].kind, PlotKind::Contacts);
/// let error = plots("run.toml", "[[plot]]\nx = \"truth\"\n").expect_err("lines need y");
/// assert_eq!(error.path, "plot.0.y");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ConfigError`] for the first fault in the syntax of the text or in a plot. The columns of the tables are not
/// checked.
pub fn plots(file: &str, text: &str) -> Result<Vec<PlotConfig>, ConfigError> {
    let source = Source::new(file, text);
    let read = || {
        let mut base = tree::parse(&source.text)?;
        let (written, plots) = section(&mut base, "plot")?;
        plot::check_alone(&written, &plots)?;
        Ok(plots)
    };
    read().map_err(|fault| source.error(fault))
}

/// Removes the list of tables at the key `key` from a config. Returns the list as TOML and as parsed values. Both are
/// empty if the config has no such list.
fn section<T: DeserializeOwned>(base: &mut Value, key: &str) -> Result<(Value, Vec<T>), Fault> {
    let written = tree::take(base, key).unwrap_or_else(|| Value::Array(Vec::new()));
    let schema = &SCHEMA["properties"][key];
    validate::validate(schema, &written).map_err(|fault| fault.under(key))?;
    let read = deserialise(&written)?;
    Ok((written, read))
}

fn checked(source: &Source, grid: &Grid, cell: usize) -> Result<StudyConfig, ConfigError> {
    let (tree, fault) = grid.tree(cell);
    // If the config itself has an error, report it instead of a sweep path that does not exist. A misspelt key in the
    // config can cause both errors.
    let config = check(&tree).and_then(|config| fault.map_or(Ok(config), Err));
    config.map_err(|fault| {
        let fault = grid.in_text(cell, fault);
        // State the cell in the error only if the swept values of this cell cause the error. They cause it if the
        // config without the sweeps is valid or has another error.
        let alone = check(&grid.base);
        let of_cell = alone.as_ref() != Err(&fault) && !grid.axes.is_empty();
        let error = source.error(fault);
        if of_cell {
            error.in_cell(cell, &grid.describe(cell))
        } else {
            error
        }
    })
}

/// Validates the config tree of a cell, which has no sweeps and no plots, and converts it to a config.
fn check(tree: &Value) -> Result<StudyConfig, Fault> {
    validate::validate(&SCHEMA, tree)?;
    let config: StudyConfig = deserialise(tree)?;
    let rules = config.scene.check();
    rules.map_err(|(path, message)| Fault::new(message).under(path))?;
    Ok(config)
}

/// Config of a cell of the study (one combination of the swept values). If all swept values are plain
/// (`has_plain_values`), this function checks only the rules that involve several fields, because each value has
/// already been validated.
fn cell_config(
    source: &Source,
    grid: &Grid,
    number: usize,
    has_plain_values: bool,
) -> Result<StudyConfig, ConfigError> {
    let plain = match has_plain_values.then(|| grid.tree(number)) {
        Some((tree, None)) => StudyConfig::deserialize(tree).ok(),
        _ => None,
    };
    let plain = plain.filter(|config| config.scene.check().is_ok());
    plain.map_or_else(|| checked(source, grid, number), Ok)
}

/// Deserialises a validated tree. If this fails, a second attempt finds the path of the error. The first attempt does
/// not track the path, because tracking costs time.
fn deserialise<T: DeserializeOwned>(tree: &Value) -> Result<T, Fault> {
    T::deserialize(tree.clone()).or_else(|_| {
        serde_path_to_error::deserialize(tree.clone()).map_err(|error| Fault {
            path: error.path().to_string(),
            ..Fault::new(error.inner().to_string().trim_end())
        })
    })
}

impl Study {
    /// The study's title, or its name if it has no title.
    pub fn heading(&self) -> &str {
        match self.config.title.as_str() {
            "" => &self.config.name,
            title => title,
        }
    }

    pub(crate) fn file(&self) -> &str {
        &self.source.file
    }

    /// Config tree of the first cell. Swept fields whose path does not exist are missing in the tree.
    pub(super) fn first_tree(&self) -> Value {
        self.grid.tree(0).0
    }

    /// Number of cells of the study.
    pub fn cell_count(&self) -> usize {
        self.grid.cells()
    }

    /// Cell with this number, counted from 0. The first axis varies slowest. Each call computes the cell again.
    ///
    /// # Errors
    /// [`ConfigError`] if the study has no cell with this number, or if the cell is invalid. A cell in the
    /// [sample](Self::sample) is always valid.
    pub fn cell(&self, number: usize) -> Result<Cell, ConfigError> {
        let count = self.cell_count();
        if number >= count {
            let message = format!("there is no cell {number}: the study has {count}");
            return Err(ConfigError::of_file(&self.source.file, message));
        }
        let mut config = cell_config(&self.source, &self.grid, number, self.has_plain_values)?;
        let is_swept = |key: &str| self.paths.iter().any(|path| path == key);
        if !is_swept("seed") {
            config.seed = self.config.seed;
        }
        if !is_swept("trials") {
            config.trials = self.config.trials;
        }
        Ok(Cell {
            coordinates: self.grid.coordinates(number),
            config,
        })
    }

    /// Number of trials (repetitions with new random noise) that the config states for a cell of the study. This
    /// function is fast, because it does not compute the config of the cell.
    pub fn trials_of(&self, cell: usize) -> u64 {
        let swept = self.grid.axis("trials").and_then(|(axis, place)| {
            let faster = self.grid.axes.iter().rev();
            let faster = faster.take_while(|other| !std::ptr::eq(*other, axis));
            let row = cell / faster.map(Axis::len).product::<usize>() % axis.len();
            as_number(&axis.row(row)[place].value)
        });
        swept.map_or(self.config.trials, |trials| trials as u64)
    }

    /// Column type of a swept field. The values of the field in all cells (grid points of the study) have this type.
    /// `place` is the index of the field in [paths](Self::paths).
    ///
    /// ```
    /// use palpate_study::{ColumnType, config::parse};
    ///
    /// let text = r#"
    /// name = "balls"
    /// [scene]
    /// kind = "roll"
    /// probe = { kind = "sphere", radius = 1.0 }
    /// object = { kind = "sphere", radius = 3.0 }
    /// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
    /// [[sweep]]
    /// path = "scene.object.radius"
    /// values = [3, 4]
    /// [[sweep]]
    /// path = "seed"
    /// values = [1, 2]
    /// "#;
    /// let study = parse("balls.toml", text)?;
    /// assert_eq!(study.swept_kind(0), ColumnType::Number);
    /// assert_eq!(study.swept_kind(1), ColumnType::Whole);
    /// # Ok::<(), palpate_study::config::ConfigError>(())
    /// ```
    pub fn swept_kind(&self, place: usize) -> ColumnType {
        let path = self.paths.get(place).map_or("", String::as_str);
        let Some((axis, column)) = self.grid.axis(path) else {
            return ColumnType::Text;
        };
        let is_number = |row| as_number(&axis.row(row)[column].value).is_some();
        let keys: Vec<&str> = path.split('.').collect();
        if !axis.is_range() && !(0..axis.len()).all(is_number) {
            ColumnType::Text
        } else if schema::is_whole(&SCHEMA, &keys) {
            ColumnType::Whole
        } else {
            ColumnType::Number
        }
    }

    /// Selects some of the cells (combinations of the swept values) that pass `filters`, and returns their numbers. A
    /// filter consists of the path of a swept field and the texts of its allowed values. A selected cell differs from
    /// the cell of all first allowed rows in at most one sweep axis. If no row of an axis passes the filters, the
    /// filters are ignored for this axis.
    pub fn star(&self, filters: &[(&str, Vec<String>)]) -> Vec<usize> {
        let rows = |axis: &Axis| {
            let mut targets = axis.targets.iter();
            if !targets.any(|target| filters.iter().any(|(path, _)| *path == target.path)) {
                return sample::thinned(axis, 0..axis.len());
            }
            let fits = |index: &usize| {
                let row = axis.row(*index);
                let mut fields = axis.targets.iter().zip(row.iter());
                fields.all(|(target, value)| {
                    let of_field = |filter: &&(&str, Vec<String>)| filter.0 == target.path;
                    let mut wanted = filters.iter().filter(of_field);
                    wanted.all(|(_, texts)| texts.iter().any(|text| *text == value.text()))
                })
            };
            match sample::thinned(axis, (0..axis.len()).filter(fits)) {
                none if none.is_empty() => sample::thinned(axis, 0..axis.len()),
                rows => rows,
            }
        };
        let rows: Vec<Vec<usize>> = self.grid.axes.iter().map(rows).collect();
        sample::star(&self.grid, &rows)
    }

    /// Sum of the numbers of trials that the config states for all cells; at most the largest `u64`. A cell
    /// (combination of swept values) without random numbers runs only one trial, but counts with its stated number.
    pub fn trials(&self) -> u64 {
        let cells = self.cell_count() as u64;
        let Some((axis, place)) = self.grid.axis("trials") else {
            return self.config.trials.saturating_mul(cells);
        };
        let trials = (0..axis.len()).map(|index| as_number(&axis.row(index)[place].value));
        let sum = trials
            .flatten()
            .fold(0, |sum: u64, trials| sum.saturating_add(trials as u64));
        sum.saturating_mul(cells / axis.len() as u64)
    }

    /// All valid cells, in ascending order of their numbers. Each cell is computed when the iterator reaches it.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        (0..self.cell_count()).filter_map(|number| self.cell(number).ok())
    }

    /// Paths of the fields that the config states although a sweep sets them, each with a note that the sweep replaces
    /// the stated value. The list is empty for a config that palpate wrote.
    pub fn swept_over(&self) -> Vec<(String, String)> {
        const MOST_VALUES: usize = 8;
        let note = |(axis, place): (&Axis, usize), path: &str, written: &Value| {
            let target = &axis.targets[place];
            let line = self.source.line(path, false)?;
            let of_sweep = self.source.line(&target.location, target.is_key)?;
            let value = |row: usize| axis.row(row)[place].text().into_owned();
            let mut values: Vec<String> = Vec::new();
            for row in 0..axis.len() {
                let value = value(row);
                if !values.contains(&value) {
                    values.push(value);
                }
                if values.len() > MOST_VALUES {
                    values[MOST_VALUES] = "…".to_owned();
                    break;
                }
            }
            let values = values.join(", ");
            let text = match written {
                Value::Table(_) | Value::Array(_) => String::new(),
                _ => format!(" = {}", tree::text(written)),
            };
            let set = match target.path == path {
                true => "it",
                false => &target.path,
            };
            Some((
                path.to_owned(),
                format!(
                    "line {line}: {path}{text} is replaced by line {of_sweep}, which sets {set} to {values}"
                ),
            ))
        };
        let axes = self.grid.axes.iter();
        let targets = axes.flat_map(|axis| (0..axis.targets.len()).map(move |place| (axis, place)));
        let notes = targets.filter(|_| !self.is_resolved).flat_map(|field| {
            let (axis, place) = field;
            let swept = axis.targets[place].path.as_str();
            let own = tree::at(&self.grid.base, swept).map(|written| (swept, written));
            let others = self.grid.replaced.iter();
            let others = others.filter(move |other| other.by == swept);
            let others = others.map(|other| (other.path.as_str(), &other.value));
            let all = own.into_iter().chain(others);
            all.filter_map(move |(path, written)| note(field, path, written))
                .collect::<Vec<_>>()
        });
        notes.collect()
    }

    /// Text from which the study was read.
    pub fn text(&self) -> &str {
        &self.source.text
    }
}
