//! Writes the tables of a run. Their rows come from the journal of the run, or from the journals of its shards.

use std::path::Path;

use anyhow::anyhow;
use palpate::config::Output;
use palpate::{Column, Simulation, Study, Warning, warning_files};

use crate::failure::Failure;
use crate::journal::{JournalItem, Reader, Totals, TrialRows};
use crate::output::names::{
    CONFIG, FRAMES, JOURNAL, MARKERS, NEXT_CONFIG, READINGS, TRACE, WARNINGS,
};
use crate::output::table_writer::{TableWriter, is_table};
use crate::output::{
    self, Contents, Draft, Format, Guard, LockedDir, OutputFile, OutputWriter, StudyId, folder_of,
};
use crate::results::{trace_failure, trace_files};

/// Names of the files that a run of the study may write, except its config and its journal.
pub(crate) fn output_names(study: &Study, format: Format) -> Vec<&'static str> {
    let [cells, failures, map] = format.tables();
    let mut names = vec![NEXT_CONFIG, cells, failures];
    names.extend(WARNINGS);
    if study.config.outputs.contains(&Output::Trace) {
        names.extend([TRACE, READINGS, MARKERS]);
        names.extend(FRAMES);
    }
    if study.config.outputs.contains(&Output::Map) {
        names.push(map);
    }
    names
}

pub(crate) struct TrialsOut {
    file: OutputFile,
    format: Format,
}

impl TrialsOut {
    /// Output file at the path of `--trials-out`, for a run that writes its other files into the directory `out`.
    /// Rejects a path that cannot be written, and the path of another output file of the run.
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
        let file = OutputFile::new("--trials-out", path, guard)?;
        Ok(Self { file, format })
    }

    /// Rejects an existing file that is not a table of trials written by palpate.
    pub(crate) fn refuse_other(&self, simulation: &Simulation<'_>) -> Result<(), Failure> {
        let [.., columns] = simulation.columns();
        let columns = columns.unwrap_or_default();
        let is_ours = |path: &Path| is_table(path, self.format, &columns);
        self.file.refuse_other(is_ours)
    }

    /// Prints a message to stdout, or to stderr if the table of trials goes to stdout.
    pub(crate) fn print(trials_out: Option<&Self>, text: &str) -> Result<(), Failure> {
        trials_out.map_or_else(|| output::print(text), |trials| trials.file.print(text))
    }

    fn begin(&self, columns: Vec<Column>, study: &StudyId) -> Result<TrialsTable<'_>, Failure> {
        let (writer, about) = (self.file.begin()?, study.about());
        let table = TableWriter::new("the trials", writer, self.format, columns.clone(), &about);
        Ok(TrialsTable {
            output: self,
            table: table?,
            columns,
        })
    }
}

struct TrialsTable<'s> {
    output: &'s TrialsOut,
    table: TableWriter<OutputWriter<'s>>,
    columns: Vec<Column>,
}

impl TrialsTable<'_> {
    fn end(self) -> Result<(), Failure> {
        let is_ours = |path: &Path| is_table(path, self.output.format, &self.columns);
        self.table.end()?.end(is_ours)
    }
}

/// Rejects a path of `--trials-out` at which the run writes another file.
fn refuse_own(path: &Path, out: &Path, study: &Study) -> Result<(), Failure> {
    let [own, dir] = [folder_of(path), out].map(|dir| {
        // If the directory does not exist, its path cannot be canonicalised, so use its absolute path.
        let known = dir.canonicalize().or_else(|_| std::path::absolute(dir));
        known.unwrap_or_else(|_| dir.to_owned())
    });
    let name = path.file_name().and_then(std::ffi::OsStr::to_str);
    let is_own = name.is_some_and(|name| {
        let own = |format: &Format| output_names(study, *format).contains(&name);
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

/// Names and contents of a cell's trace files; empty if the config does not request a trace.
pub(crate) fn requested_trace(
    study: &Study,
    cell: usize,
) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
    if !study.config.outputs.contains(&Output::Trace) {
        return Ok(Vec::new());
    }
    let trace = palpate::trace(study, cell, None).map_err(trace_failure)?;
    trace_files(&trace)
}

pub(crate) struct Drafts<'s> {
    /// Name and writer of each table: cells, failures and map. A journal record contains rows in the same order.
    tables: [(&'static str, Option<TableWriter<Draft>>); 3],
    trials: Option<TrialsTable<'s>>,
}

type Tables = Vec<(&'static str, Draft)>;

impl<'s> Drafts<'s> {
    /// Starts the tables of a simulation. The table of trials is separate from the other tables, because it may be in
    /// another directory.
    pub(crate) fn new(
        folder: &LockedDir,
        simulation: &Simulation<'_>,
        format: Format,
        trials_out: Option<&'s TrialsOut>,
        study: &StudyId,
    ) -> Result<Self, Failure> {
        let [of_cells, of_failures, of_maps, of_trials] = simulation.columns();
        let table = |name: &'static str, columns: Option<Vec<Column>>| {
            let Some(columns) = columns else {
                return Ok((name, None));
            };
            let draft = folder.draft(name)?;
            let table = TableWriter::new(name, draft, format, columns, &study.about())?;
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
        })
    }

    /// Copies the rows of all journals into the tables, in the order of the cells.
    pub(crate) fn fill(mut self, readers: Vec<Reader>) -> Result<(Tables, Totals), Failure> {
        let mut totals = Totals::default();
        merge_records(readers, &mut |item| {
            let trials = self.trials.as_mut();
            let record = match item {
                JournalItem::Trials(TrialRows { rows, .. }) => {
                    return trials.map_or(Ok(()), |trials| trials.table.write(&rows));
                }
                JournalItem::Cell(record) => record,
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
            Ok(())
        })?;
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

/// Reads the records of all journals, and passes them to `take` in the order of the cells.
fn merge_records(
    readers: Vec<Reader>,
    take: &mut dyn FnMut(JournalItem) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let head = |mut reader: Reader| {
        let first = reader.item();
        (reader, first)
    };
    let mut heads: Vec<(Reader, Option<JournalItem>)> = readers.into_iter().map(head).collect();
    let cell = |item: &JournalItem| match item {
        JournalItem::Trials(trials) => trials.cell,
        JournalItem::Cell(record) => record.cell,
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

/// Gives the tables of a run their final names, and writes the run's config, trace and warnings.
pub(crate) fn write_results(
    folder: &mut LockedDir,
    tables: Tables,
    trace: Vec<(&'static str, Vec<u8>)>,
    config: &str,
    warnings: &[Warning],
    study: &StudyId,
) -> Result<(), Failure> {
    let warnings = warning_files(warnings);
    let mut files: Vec<(&str, Contents<'_>)> = Vec::new();
    files.extend(
        tables
            .into_iter()
            .map(|(name, draft)| (name, Contents::Draft(draft))),
    );
    files.push((CONFIG, Contents::Bytes(config.as_bytes())));
    files.extend(
        trace
            .iter()
            .map(|(name, bytes)| (*name, Contents::Bytes(bytes))),
    );
    let warnings = warnings.iter();
    files.extend(warnings.map(|(name, text)| (*name, Contents::Bytes(text.as_bytes()))));
    let written = folder.replace(files, study);
    let ended = folder.end();
    for line in written? {
        output::print_note(format_args!("note: {line}"));
    }
    ended
}
