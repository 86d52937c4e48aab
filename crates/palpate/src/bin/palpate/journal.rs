//! Journal of a run: a file with the results of finished cells. With its journal, a killed run resumes at the next
//! cell. `palpate merge` combines the journals of shards.
//!
//! A journal consists of [`MAGIC`] and a sequence of frames. A frame contains the length of a record, its checksum
//! (CRC-32), and the record in the binary format of the crate `postcard`. A reader ignores the first incomplete or
//! damaged frame and everything after it.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};
use palpate::{CellRows, Warning, Warnings};
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::output::names::JOURNAL;

/// The first bytes of every journal. The last of these eight bytes is the version of the journal's format.
const MAGIC: &[u8; 8] = b"palpate\x05";
/// Rows of finished cells are collected in memory. They are written to the journal when they exceed this size (bytes).
const MAX_PENDING: usize = 1 << 18;
/// Longest time that collected rows wait before they are written to the journal. It is also the shortest time between
/// two synchronisations of the journal with the disk.
const INTERVAL: Duration = Duration::from_secs(1);
/// Largest accepted length of a record, bytes. A larger length means that the journal is damaged.
const MAX_RECORD: u32 = 1 << 30;

/// Header of a journal. It states which run the journal belongs to.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Header {
    pub(crate) version: String,
    /// Config of the run, as text of `run.toml`.
    pub(crate) config: String,
    pub(crate) request: RunRequest,
    /// Warnings of the planning, and warnings of the cells that were checked before the run.
    pub(crate) warnings: Warnings,
    /// Number of tasks of this run; if the run is a shard, number of tasks of this shard. Each cell is one task.
    pub(crate) tasks: u64,
    pub(crate) all_tasks: u64,
}

/// Arguments of a run. An interrupted run resumes only with the same arguments.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct RunRequest {
    /// Config with all defaults and overrides, before the budget or the target error changes the number of trials and
    /// the model.
    pub(crate) config: String,
    /// Text of the arguments that state the time budget and the target error.
    pub(crate) goal: String,
    pub(crate) every_nth_cell: u64,
    /// Number of this shard, and number of shards into which the study is divided; `None` for a run of the whole study.
    pub(crate) shard: Option<(u64, u64)>,
    pub(crate) trials_out: bool,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
enum Record {
    Header(Box<Header>),
    /// Finished cells, and the time (ms) since the previous `Cells` record.
    Cells(Vec<CellRecord>, u64),
    /// Rows that an unfinished cell adds to the table of trials.
    Trials(TrialRows),
    End,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct CellRecord {
    pub(crate) cell: u64,
    /// Rows of `cells.csv`, `failures.csv`, `map.csv` and the table of trials. Rows of trials are omitted here if an
    /// earlier `Trials` record contains them.
    pub(crate) rows: [String; 4],
    pub(crate) trials: u64,
    /// Each kind of failure of the cell, with the number of trials that failed in this way.
    pub(crate) kinds: Vec<(String, u64)>,
    /// Warnings of the cell that are not in the header of the journal.
    pub(crate) warnings: Vec<Warning>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct TrialRows {
    pub(crate) cell: u64,
    pub(crate) rows: String,
}

/// The next entry of a journal: a finished cell, or rows of the table of trials.
pub(crate) enum JournalItem {
    Trials(TrialRows),
    Cell(CellRecord),
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Totals {
    pub(crate) cells: u64,
    pub(crate) trials: u64,
    pub(crate) kinds: BTreeMap<String, u64>,
    pub(crate) has_success: bool,
}

/// Contents of a journal, without the rows of tables.
pub(crate) struct JournalState {
    pub(crate) header: Header,
    pub(crate) tasks: u64,
    pub(crate) is_ended: bool,
    pub(crate) totals: Totals,
    /// Warnings of the finished cells and of the header.
    pub(crate) warnings: Warnings,
    pub(crate) time: Duration,
    /// Length of the valid part at the beginning of the file, bytes.
    valid_bytes: u64,
    /// Whether damaged bytes follow the valid part, for example because the process was killed while it wrote.
    pub(crate) is_torn: bool,
}

impl JournalState {
    /// Whether the journal contains the results of a finished task, or may have contained some before it was damaged.
    pub(crate) fn may_have_results(&self) -> bool {
        self.tasks > 0 || self.is_torn
    }
}

impl Header {
    pub(crate) fn new(
        config: String,
        request: RunRequest,
        warnings: Warnings,
        [tasks, all_tasks]: [u64; 2],
    ) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            config,
            request,
            warnings,
            tasks,
            all_tasks,
        }
    }
}

impl Totals {
    pub(crate) fn add(&mut self, record: &CellRecord) {
        self.cells += 1;
        self.trials += record.trials;
        let mut failed = 0;
        for (kind, count) in &record.kinds {
            *self.kinds.entry(kind.clone()).or_default() += count;
            failed += count;
        }
        self.has_success |= failed < record.trials || record.trials == 0;
    }

    /// Text with each kind of failure and its number of trials.
    pub(crate) fn failures(&self) -> String {
        let kinds = self.kinds.iter();
        let kinds: Vec<String> = kinds
            .map(|(kind, count)| format!("{kind} {count}"))
            .collect();
        kinds.join(", ")
    }
}

impl CellRecord {
    pub(crate) fn new(rows: CellRows) -> Self {
        let kinds = rows.kinds.iter();
        Self {
            cell: rows.cell as u64,
            kinds: kinds
                .map(|kind| (kind.kind.to_owned(), kind.count))
                .collect(),
            trials: rows.trials,
            warnings: rows.warnings,
            rows: [rows.cells, rows.failures, rows.map, String::new()],
        }
    }
}

pub(crate) struct Journal {
    file: File,
    path: PathBuf,
    pending: Vec<CellRecord>,
    pending_bytes: usize,
    /// Buffer for the next frame of the journal. All frames use the same buffer, so that no memory is allocated for
    /// each frame.
    frame: Vec<u8>,
    written: Instant,
    /// Time at which the last synchronisation of the journal file with the disk started.
    synced: Instant,
    /// Thread that synchronises the file with the disk, so that trials do not wait for the disk.
    syncing: Option<JoinHandle<io::Result<()>>>,
}

impl Journal {
    pub(crate) fn new(dir: &Path, header: &Header) -> io::Result<Self> {
        let path = dir.join(JOURNAL);
        let mut journal = Self::with_file(File::create(&path)?, path);
        let header = framed(&Record::Header(Box::new(header.clone())), MAGIC.to_vec())?;
        let written = journal.file.write_all(&header);
        // Remove an incomplete journal, for example after a full disk. Otherwise, the next run would report its header
        // as damaged.
        if let Err(error) = written.and_then(|()| journal.file.sync_data()) {
            let _ = fs::remove_file(&journal.path);
            return Err(error);
        }
        Ok(journal)
    }

    /// Opens a journal to continue it. Removes the damaged bytes after the journal's valid part.
    pub(crate) fn resumed(dir: &Path, found: &JournalState) -> io::Result<Self> {
        let path = dir.join(JOURNAL);
        let mut file = OpenOptions::new().write(true).open(&path)?;
        file.set_len(found.valid_bytes)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Self::with_file(file, path))
    }

    fn with_file(file: File, path: PathBuf) -> Self {
        let now = Instant::now();
        Self {
            file,
            path,
            pending: Vec::new(),
            pending_bytes: 0,
            frame: Vec::new(),
            written: now,
            synced: now,
            syncing: None,
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a finished cell. The cell is written to the journal later, together with other cells.
    pub(crate) fn cell(&mut self, record: CellRecord) -> io::Result<()> {
        self.pending_bytes += record.rows.iter().map(String::len).sum::<usize>();
        self.pending.push(record);
        match self.pending_bytes >= MAX_PENDING || self.written.elapsed() >= INTERVAL {
            true => self.flush(),
            false => Ok(()),
        }
    }

    /// Adds rows of the table of trials for a cell that is not finished yet.
    pub(crate) fn trials(&mut self, trials: TrialRows) -> io::Result<()> {
        self.flush()?;
        self.frame(&Record::Trials(trials))
    }

    pub(crate) fn flush(&mut self) -> io::Result<()> {
        if self.pending.is_empty() {
            return Ok(());
        }
        let time = self.written.elapsed().as_millis() as u64;
        self.written = Instant::now();
        let pending = std::mem::take(&mut self.pending);
        self.pending_bytes = 0;
        self.frame(&Record::Cells(pending, time))?;
        self.sync()
    }

    /// Marks the journal as complete.
    pub(crate) fn end(&mut self) -> io::Result<()> {
        self.flush()?;
        self.frame(&Record::End)?;
        wait_for_sync(self.syncing.take())?;
        self.file.sync_data()
    }

    /// Starts to synchronise the journal with the disk, unless the last synchronisation started less than [`INTERVAL`]
    /// ago. Returns the result of the previous synchronisation.
    fn sync(&mut self) -> io::Result<()> {
        if self.synced.elapsed() < INTERVAL {
            return Ok(());
        }
        match self.syncing.take() {
            Some(syncing) if !syncing.is_finished() => {
                self.syncing = Some(syncing);
                return Ok(());
            }
            syncing => wait_for_sync(syncing)?,
        }
        let file = self.file.try_clone()?;
        self.syncing = Some(std::thread::Builder::new().spawn(move || file.sync_data())?);
        self.synced = Instant::now();
        Ok(())
    }

    fn frame(&mut self, record: &Record) -> io::Result<()> {
        self.frame.clear();
        self.frame = framed(record, std::mem::take(&mut self.frame))?;
        self.file.write_all(&self.frame)
    }
}

fn wait_for_sync(syncing: Option<JoinHandle<io::Result<()>>>) -> io::Result<()> {
    let ended = syncing.map(JoinHandle::join);
    let lost = |_| {
        Err(io::Error::other(
            "the thread that writes it to the disk ended early",
        ))
    };
    ended.map_or(Ok(()), |ended| ended.unwrap_or_else(lost))
}

/// Appends a record to `bytes`, as a frame with length and checksum.
fn framed(record: &Record, mut bytes: Vec<u8>) -> io::Result<Vec<u8>> {
    let start = bytes.len();
    bytes.extend([0; 8]);
    let mut bytes = postcard::to_extend(record, bytes).map_err(io::Error::other)?;
    let (head, body) = bytes[start..].split_at_mut(8);
    let length = u32::try_from(body.len()).map_err(io::Error::other)?;
    head[..4].copy_from_slice(&length.to_le_bytes());
    head[4..].copy_from_slice(&crc32fast::hash(body).to_le_bytes());
    Ok(bytes)
}

pub(crate) struct Reader {
    file: BufReader<File>,
    valid_bytes: u64,
    length: u64,
    waiting: std::vec::IntoIter<CellRecord>,
}

impl Reader {
    /// Opens the journal of a directory; `None` if the directory has no journal.
    pub(crate) fn open(dir: &Path) -> Result<Option<(Self, Header)>, Failure> {
        let path = dir.join(JOURNAL);
        let cannot = || format!("cannot read {}", path.display());
        match fs::metadata(&path) {
            Err(error)
                if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) =>
            {
                return Ok(None);
            }
            // Do not open a pipe, because reading it would wait for its writer.
            Ok(found) if !found.is_file() => return Err(no_journal(&path)),
            found => found.with_context(cannot).map_err(Failure::work)?,
        };
        let file = File::open(&path)
            .with_context(cannot)
            .map_err(Failure::work)?;
        let length = file.metadata().map_or(0, |found| found.len());
        let mut reader = Self {
            file: BufReader::with_capacity(1 << 18, file),
            valid_bytes: 0,
            length,
            waiting: Vec::new().into_iter(),
        };
        let mut magic = [0; MAGIC.len()];
        if reader.file.read_exact(&mut magic).is_err() {
            // A file that contains only a part of [`MAGIC`] comes from a run that was killed at its start. It counts as
            // no journal.
            return match MAGIC.starts_with(&fs::read(&path).unwrap_or_default()) {
                true => Ok(None),
                false => Err(no_journal(&path)),
            };
        }
        match (magic == *MAGIC, magic[..7] == MAGIC[..7]) {
            (true, _) => {}
            (false, true) => {
                return Err(Failure::usage(anyhow!(
                    "{} has version {} of its format; this palpate reads version {}",
                    path.display(),
                    magic[7],
                    MAGIC[7]
                )));
            }
            (false, false) => return Err(no_journal(&path)),
        }
        reader.valid_bytes = MAGIC.len() as u64;
        match reader.record() {
            Some(Record::Header(header)) => Ok(Some((reader, *header))),
            _ => Err(Failure::work(anyhow!(
                "{} is damaged at its beginning, so its run cannot be identified: --restart begins the run again",
                path.display()
            ))),
        }
    }

    fn record(&mut self) -> Option<Record> {
        let mut number = [0; 4];
        let mut next = || -> io::Result<u32> {
            self.file.read_exact(&mut number)?;
            Ok(u32::from_le_bytes(number))
        };
        let (length, checksum) = (next().ok()?, next().ok()?);
        if length > MAX_RECORD || self.valid_bytes + 8 + u64::from(length) > self.length {
            return None;
        }
        let mut bytes = vec![0; length as usize];
        self.file.read_exact(&mut bytes).ok()?;
        if crc32fast::hash(&bytes) != checksum {
            return None;
        }
        let record = postcard::from_bytes(&bytes).ok()?;
        self.valid_bytes += 8 + u64::from(length);
        Some(record)
    }

    pub(crate) fn item(&mut self) -> Option<JournalItem> {
        loop {
            if let Some(cell) = self.waiting.next() {
                return Some(JournalItem::Cell(cell));
            }
            match self.record()? {
                Record::Cells(cells, _) => self.waiting = cells.into_iter(),
                Record::Trials(trials) => return Some(JournalItem::Trials(trials)),
                Record::Header(_) | Record::End => return None,
            }
        }
    }
}

/// Rejects a directory that contains an entry with the journal's file name, if this entry is not a journal.
pub(crate) fn refuse_other(dir: &Path) -> Result<(), Failure> {
    let path = dir.join(JOURNAL);
    let Ok(found) = fs::symlink_metadata(&path) else {
        return Ok(());
    };
    let begins = |bytes: &[u8]| MAGIC[..7].starts_with(&bytes[..bytes.len().min(7)]);
    let is_journal = found.is_file() && {
        let mut start = Vec::new();
        let read = File::open(&path).and_then(|file| file.take(7).read_to_end(&mut start));
        read.is_ok() && begins(&start)
    };
    is_journal.then_some(()).ok_or_else(|| no_journal(&path))
}

fn no_journal(path: &Path) -> Failure {
    Failure::usage(anyhow!(
        "{} is not a journal of palpate: move it away, or give another directory",
        path.display()
    ))
}

/// Reads the journal of a directory to its end; `None` if the directory has no journal.
pub(crate) fn read(dir: &Path) -> Result<Option<JournalState>, Failure> {
    let Some((mut reader, header)) = Reader::open(dir)? else {
        return Ok(None);
    };
    let mut found = JournalState {
        warnings: header.warnings.clone(),
        header,
        tasks: 0,
        is_ended: false,
        totals: Totals::default(),
        time: Duration::ZERO,
        valid_bytes: reader.valid_bytes,
        is_torn: false,
    };
    while let Some(record) = reader.record() {
        match record {
            Record::Header(_) => break,
            Record::Cells(cells, ms) => {
                for cell in &cells {
                    found.totals.add(cell);
                    found.warnings.add(cell.cell as usize, &cell.warnings);
                    found.tasks += 1;
                }
                found.time += Duration::from_millis(ms);
            }
            // Do not count the rows of trials here, because their cell may be unfinished. They are counted when their
            // cell is finished.
            Record::Trials(_) => continue,
            Record::End => found.is_ended = true,
        }
        found.valid_bytes = reader.valid_bytes;
    }
    found.is_torn = reader.valid_bytes < reader.length;
    Ok(Some(found))
}
