//! Tables of a run, filled from its journal or from those of its shards.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, anyhow};
use palpate::config::Output;
use palpate::{Partial, Simulation, Study};

use crate::failure::Failure;
use crate::journal::{CellRecord, Item, Reader, Totals};
use crate::output::names::{
    CELLS, CONFIG, FAILURES, FRAMES, JOURNAL, MAP, MARKERS, NEXT_CONFIG, READINGS, TRACE, WARNINGS,
};
use crate::output::{Contents, Draft, Folder, Single, StudyId, Written, folder_of};
use crate::trace;

/// All that a run of the study may write besides its config.
pub(crate) fn tables_of(study: &Study) -> Vec<&'static str> {
    let mut names = vec![NEXT_CONFIG, CELLS, FAILURES, WARNINGS];
    if study.config.outputs.contains(&Output::Trace) {
        names.extend([TRACE, READINGS, MARKERS]);
        names.extend(FRAMES);
    }
    if study.config.outputs.contains(&Output::Map) {
        names.push(MAP);
    }
    names
}

/// Refuses a table of trials that would have the place of another file of the run.
pub(crate) fn refuse_own(path: &Path, out: &Path, study: &Study) -> Result<(), Failure> {
    let [own, dir] = [folder_of(path), out].map(|dir| {
        // The directory need not be there.
        let known = dir.canonicalize().or_else(|_| std::path::absolute(dir));
        known.unwrap_or_else(|_| dir.to_owned())
    });
    let name = path.file_name().and_then(std::ffi::OsStr::to_str);
    let is_own = name.is_some_and(|name| {
        let others = [CONFIG, JOURNAL];
        name.starts_with(".palpate") || others.contains(&name) || tables_of(study).contains(&name)
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
    drafts: [Option<Draft>; 3],
    /// Table of trials.
    trials: Option<Written<'s>>,
    lacks: &'static str,
}

/// Tables with their names.
type Filled = Vec<(&'static str, Draft)>;

/// Names of the tables, in the order in which records have their rows.
const TABLES: [&str; 3] = [CELLS, FAILURES, MAP];

impl<'s> Drafts<'s> {
    /// Tables of a simulation, with their headers; that of trials is a file of its own.
    pub(crate) fn new(
        folder: &Folder,
        simulation: &Simulation<'_>,
        trials_out: Option<&'s Single>,
    ) -> Result<Self, Failure> {
        let mut drafts = [None, None, None];
        let [.., of_trials] = simulation.headers();
        let mut trials = trials_out.map(Single::begin).transpose()?;
        if let (Some(trials), Some(header)) = (&mut trials, of_trials) {
            trials.write(&header)?;
        }
        for ((draft, header), name) in drafts.iter_mut().zip(simulation.headers()).zip(TABLES) {
            if let Some(header) = header {
                let mut file = folder.draft(name)?;
                put(&mut file, name, &header)?;
                *draft = Some(file);
            }
        }
        Ok(Self {
            drafts,
            trials,
            lacks: simulation.lacks(),
        })
    }

    /// Tables with the rows of journals that share the cells of a simulation.
    pub(crate) fn fill(
        mut self,
        simulation: &Simulation<'_>,
        readers: Vec<Reader>,
        is_shared: bool,
    ) -> Result<(Filled, Totals), Failure> {
        let mut failed: Vec<String> = Vec::new();
        let mut totals = Totals::default();
        merge(simulation, readers, is_shared, &mut |merged| {
            let trials = self.trials.as_mut();
            let record = match merged {
                Merged::Trials(rows) => {
                    return trials.map_or(Ok(()), |trials| trials.write(rows));
                }
                Merged::Cell(record) => record,
            };
            if let Some(trials) = trials {
                trials.write(&record.rows[3])?;
            }
            totals.add(record);
            let rows = self.drafts.iter_mut().zip(&record.rows).zip(TABLES);
            for ((draft, rows), name) in rows {
                if let Some(draft) = draft {
                    put(draft, name, rows)?;
                }
            }
            if let Some(kind) = &record.map_failed {
                failed.push(format!("{} ({kind})", record.cell));
            }
            Ok(())
        })?;
        if !failed.is_empty() && self.drafts[2].is_some() {
            let (lacks, cells) = (self.lacks, failed.join(", "));
            eprintln!("warning: map.csv lacks {lacks} whose trial 0 failed: {cells}");
        }
        if let Some(trials) = self.trials {
            trials.end()?;
        }
        let files = TABLES.into_iter().zip(self.drafts);
        let files = files.filter_map(|(name, draft)| Some((name, draft?)));
        Ok((files.collect(), totals))
    }
}

fn put(draft: &mut Draft, name: &str, text: &str) -> Result<(), Failure> {
    let written = draft.write_all(text.as_bytes());
    written
        .with_context(|| format!("cannot write {name}; the same command tries again"))
        .map_err(Failure::work)
}

/// Piece of what journals have together, in the order of the cells.
enum Merged<'r> {
    /// Rows of trials of the cell that follows.
    Trials(&'r str),
    Cell(&'r CellRecord),
}

/// Hands over the cells of journals in the order of their numbers; heavy cells are put together from their superblocks.
fn merge(
    simulation: &Simulation<'_>,
    readers: Vec<Reader>,
    is_shared: bool,
    take: &mut dyn FnMut(Merged<'_>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let next = |reader: &mut Reader| loop {
        match reader.item()? {
            // A whole run has the cell itself after them.
            Item::Superblock(_) if !is_shared => {}
            item => return Some(item),
        }
    };
    let mut heads: Vec<(Reader, Option<Item>)> = Vec::new();
    for mut reader in readers {
        let first = next(&mut reader);
        heads.push((reader, first));
    }
    let place = |item: &Item| match item {
        Item::Trials(trials) => (trials.cell, trials.superblock),
        Item::Cell(record) => (record.cell, 0),
        Item::Superblock(superblock) => (superblock.cell, superblock.superblock),
    };
    let mut open = Partial::default();
    loop {
        let present = heads.iter_mut().filter(|(_, item)| item.is_some());
        let Some((reader, item)) = present.min_by_key(|(_, item)| item.as_ref().map(place)) else {
            return Ok(());
        };
        let Some(item) = std::mem::replace(item, next(reader)) else {
            return Ok(());
        };
        match item {
            Item::Trials(trials) => take(Merged::Trials(&trials.rows))?,
            Item::Cell(record) => take(Merged::Cell(&record))?,
            Item::Superblock(superblock) => {
                open.merge(superblock.partial);
                if superblock.superblock + 1 == superblock.of {
                    let cell = superblock.cell as usize;
                    let finished = simulation.finished(cell, std::mem::take(&mut open));
                    let rows = simulation.rows(&finished.map_err(Failure::usage)?);
                    take(Merged::Cell(&CellRecord::new(cell, false, rows)))?;
                }
            }
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
