//! Tables of a run, filled from its journal or from those of its shards.

use std::path::Path;

use anyhow::anyhow;
use palpate::config::Output;
use palpate::{ColumnType, Simulation, Study};

use crate::failure::Failure;
use crate::journal::{Item, Reader, Totals, TrialRows};
use crate::output::names::{
    CONFIG, FRAMES, JOURNAL, MARKERS, NEXT_CONFIG, READINGS, TRACE, WARNINGS,
};
use crate::output::table::{Table, is_table};
use crate::output::{
    self, Contents, Draft, Folder, Format, Guard, Single, StudyId, Written, folder_of,
};
use crate::trace;

/// All that a run of the study may write besides its config.
pub(crate) fn tables_of(study: &Study, format: Format) -> Vec<&'static str> {
    let [cells, failures, map] = format.tables();
    let mut names = vec![NEXT_CONFIG, cells, failures, WARNINGS];
    if study.config.outputs.contains(&Output::Trace) {
        names.extend([TRACE, READINGS, MARKERS]);
        names.extend(FRAMES);
    }
    if study.config.outputs.contains(&Output::Map) {
        names.push(map);
    }
    names
}

/// Table of trials: a file of its own.
pub(crate) struct TrialsOut {
    single: Single,
    format: Format,
}

impl TrialsOut {
    /// Table at the path that `--trials-out` names, of a run into `out`; refuses one in the place of another file of the
    /// run, and what cannot be written.
    pub(crate) fn new(
        path: &Path,
        default: Format,
        guard: Guard,
        out: &Path,
        study: &Study,
    ) -> Result<Self, Failure> {
        let format = Format::of_path(path, default);
        format.supported()?;
        refuse_own(path, out, study)?;
        let single = Single::new("--trials-out", path, guard)?;
        Ok(Self { single, format })
    }

    /// Refuses to replace a file that is no table of trials of palpate.
    pub(crate) fn refuse_other(&self, simulation: &Simulation<'_>) -> Result<(), Failure> {
        let [.., columns] = simulation.columns();
        let columns = columns.unwrap_or_default();
        let is_ours = |path: &Path| is_table(path, self.format, &columns);
        self.single.refuse_other(is_ours)
    }

    /// Prints what a command says besides: on standard error where the table goes to standard output.
    pub(crate) fn print(trials_out: Option<&Self>, text: &str) -> Result<(), Failure> {
        match trials_out {
            Some(trials) => trials.single.print(text),
            None => output::print(text),
        }
    }

    fn begin(&self, columns: Vec<ColumnType>, study: &StudyId) -> Result<Trials<'_>, Failure> {
        let (written, about) = (self.single.begin()?, study.about());
        let table = Table::new("the trials", written, self.format, columns.clone(), &about);
        Ok(Trials {
            of: self,
            table: table?,
            columns,
        })
    }
}

/// Table of trials that is being written.
struct Trials<'s> {
    of: &'s TrialsOut,
    table: Table<Written<'s>>,
    columns: Vec<ColumnType>,
}

impl Trials<'_> {
    fn end(self) -> Result<(), Failure> {
        let is_ours = |path: &Path| is_table(path, self.of.format, &self.columns);
        self.table.end()?.end(is_ours)
    }
}

/// Refuses a table of trials that would have the place of another file of the run.
fn refuse_own(path: &Path, out: &Path, study: &Study) -> Result<(), Failure> {
    let [own, dir] = [folder_of(path), out].map(|dir| {
        // The directory need not be there.
        let known = dir.canonicalize().or_else(|_| std::path::absolute(dir));
        known.unwrap_or_else(|_| dir.to_owned())
    });
    let name = path.file_name().and_then(std::ffi::OsStr::to_str);
    let is_own = name.is_some_and(|name| {
        let own = |format: &Format| tables_of(study, *format).contains(&name);
        name.starts_with(".palpate")
            || [CONFIG, JOURNAL].contains(&name)
            || Format::ALL.iter().any(own)
    });
    match is_own && own == dir {
        true => Err(Failure::usage(anyhow!(
            "--trials-out {}: the run writes another file of that name there; give another name",
            path.display()
        ))),
        false => Ok(()),
    }
}

/// Files of the pass of a cell, where the config asks for them.
pub(crate) fn traced(study: &Study, cell: usize) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
    if !study.config.outputs.contains(&Output::Trace) {
        return Ok(Vec::new());
    }
    let trace = palpate::trace(study, cell, None).map_err(trace::refused)?;
    trace::files(&trace)
}

/// Tables that are filled from journals.
pub(crate) struct Drafts<'s> {
    /// Tables with their names, in the order in which records have their rows.
    tables: [(&'static str, Option<Table<Draft>>); 3],
    trials: Option<Trials<'s>>,
    lacks: &'static str,
}

/// Tables with their names.
type Filled = Vec<(&'static str, Draft)>;

impl<'s> Drafts<'s> {
    /// Tables of a simulation, without rows; that of trials is a file of its own.
    pub(crate) fn new(
        folder: &Folder,
        simulation: &Simulation<'_>,
        format: Format,
        trials_out: Option<&'s TrialsOut>,
        study: &StudyId,
    ) -> Result<Self, Failure> {
        let [of_cells, of_failures, of_maps, of_trials] = simulation.columns();
        let table = |name: &'static str, columns: Option<Vec<ColumnType>>| {
            let Some(columns) = columns else {
                return Ok((name, None));
            };
            let draft = folder.draft(name)?;
            let table = Table::new(name, draft, format, columns, &study.about())?;
            Ok::<_, Failure>((name, Some(table)))
        };
        let trials = trials_out.zip(of_trials);
        let trials = trials.map(|(trials, columns)| trials.begin(columns, study));
        let [cells, failures, map] = format.tables();
        Ok(Self {
            tables: [
                table(cells, of_cells)?,
                table(failures, of_failures)?,
                table(map, of_maps)?,
            ],
            trials: trials.transpose()?,
            lacks: simulation.lacks(),
        })
    }

    /// Tables with the rows of journals that share the cells of a simulation.
    pub(crate) fn fill(mut self, readers: Vec<Reader>) -> Result<(Filled, Totals), Failure> {
        let mut failed: Vec<String> = Vec::new();
        let mut totals = Totals::default();
        merge(readers, &mut |item| {
            let trials = self.trials.as_mut();
            let record = match item {
                Item::Trials(TrialRows { rows, .. }) => {
                    return trials.map_or(Ok(()), |trials| trials.table.write(&rows));
                }
                Item::Cell(record) => record,
            };
            if let Some(trials) = trials {
                trials.table.write(&record.rows[3])?;
            }
            totals.add(&record);
            for ((_, table), rows) in self.tables.iter_mut().zip(&record.rows) {
                if let Some(table) = table {
                    table.write(rows)?;
                }
            }
            if let Some(kind) = &record.map_failed {
                failed.push(format!("{} ({kind})", record.cell));
            }
            Ok(())
        })?;
        if let ([.., (map, Some(_))], false) = (&self.tables, failed.is_empty()) {
            let (lacks, cells) = (self.lacks, failed.join(", "));
            eprintln!("warning: {map} lacks {lacks} whose trial 0 failed: {cells}");
        }
        if let Some(trials) = self.trials {
            trials.end()?;
        }
        let mut files = Vec::new();
        for (name, table) in self.tables {
            if let Some(table) = table {
                files.push((name, table.end()?));
            }
        }
        Ok((files, totals))
    }
}

/// Passes the records of all journals to `take`, in the order of the cells.
fn merge(
    readers: Vec<Reader>,
    take: &mut dyn FnMut(Item) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let head = |mut reader: Reader| {
        let first = reader.item();
        (reader, first)
    };
    let mut heads: Vec<(Reader, Option<Item>)> = readers.into_iter().map(head).collect();
    let cell = |item: &Item| match item {
        Item::Trials(trials) => trials.cell,
        Item::Cell(record) => record.cell,
    };
    loop {
        let present = heads.iter_mut().filter(|(_, item)| item.is_some());
        let Some((reader, item)) = present.min_by_key(|(_, item)| item.as_ref().map(cell)) else {
            return Ok(());
        };
        if let Some(item) = std::mem::replace(item, reader.item()) {
            take(item)?;
        }
    }
}

/// Gives the tables of a run their names.
pub(crate) fn end(
    folder: &mut Folder,
    tables: Filled,
    traced: Vec<(&'static str, Vec<u8>)>,
    config: &str,
    warnings: &[String],
    study: &StudyId,
) -> Result<(), Failure> {
    let told = warnings.join("\n") + "\n";
    let mut files: Vec<(&str, Contents<'_>)> = Vec::new();
    files.extend(
        tables
            .into_iter()
            .map(|(name, draft)| (name, Contents::Draft(draft))),
    );
    files.push((CONFIG, Contents::Bytes(config.as_bytes())));
    files.extend(
        traced
            .iter()
            .map(|(name, bytes)| (*name, Contents::Bytes(bytes))),
    );
    if !warnings.is_empty() {
        files.push((WARNINGS, Contents::Bytes(told.as_bytes())));
    }
    let written = folder.replace(files, study);
    let ended = folder.end();
    for line in written? {
        eprintln!("note: {line}");
    }
    ended
}
