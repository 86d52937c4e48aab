//! An output directory that is locked, so that no other palpate process writes into it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Error, anyhow};
use tempfile::NamedTempFile;

use super::manifest::{Entry, MANIFEST, Manifest, StudyId};
use super::names::{CELLS, CONFIG, Format, NEXT_CONFIG, WARNINGS};
use super::output_dir::{Guard, OutputDir};
use super::stage::{Contents, Draft, StagedFile, is_named, is_stream, remove_abandoned};
use crate::failure::Failure;

/// Name of the lock file. The file contains the process number of the lock's owner.
const LOCK_NAME: &str = ".palpate-lock";
/// Longest time to wait for the lock of another process, which may be about to finish.
const LOCK_TIMEOUT: Duration = Duration::from_secs(1);
const LOCK_PAUSE: Duration = Duration::from_millis(20);

/// Output directory that is locked by this process, with the manifest of the files that palpate wrote there.
pub(crate) struct LockedDir {
    output: OutputDir,
    _lock: Lock,
}

pub(crate) fn refuse_no_directory(dir: &Path) -> Result<(), Failure> {
    match dir.is_dir() {
        true => Ok(()),
        false => Err(Failure::usage(anyhow!("{} is no directory", dir.display()))),
    }
}

/// Creates `dir` if it is missing, and checks that files can be written there. Commands call this before the work
/// starts.
pub(crate) fn make_directory(dir: &Path) -> Result<(), Failure> {
    if dir == Path::new("-") {
        return Err(Failure::usage(anyhow!(
            "`-` is standard output, but this command writes a directory: use `./-` for a directory with this name"
        )));
    }
    let is_file = |place: &&Path| fs::metadata(place).is_ok_and(|found| !found.is_dir());
    if let Some(file) = dir.ancestors().find(is_file) {
        let (dir, file) = (dir.display(), file.display());
        return Err(Failure::work(anyhow!(
            "cannot make the directory {dir}: {file} is a file"
        )));
    }
    let leads_nowhere =
        |place: &&Path| fs::read_link(place).is_ok() && fs::metadata(place).is_err();
    if let Some(link) = dir.ancestors().find(leads_nowhere) {
        let target = fs::read_link(link).unwrap_or_default();
        let (dir, link, target) = (dir.display(), link.display(), target.display());
        return Err(Failure::work(anyhow!(
            "cannot make the directory {dir}: {link} is a symbolic link to {target}, which does not exist"
        )));
    }
    fs::create_dir_all(dir)
        .with_context(|| format!("cannot make the directory {}", dir.display()))
        .and_then(|()| {
            let probe = NamedTempFile::with_prefix_in(".palpate-", dir);
            probe
                .map(drop)
                .with_context(|| format!("cannot write into {}", dir.display()))
        })
        .map_err(Failure::work)
}

impl LockedDir {
    pub(crate) fn open(dir: &Path, guard: Guard) -> Result<Self, Failure> {
        make_directory(dir)?;
        let lock = Lock::new(dir)?;
        remove_abandoned(dir);
        let output = OutputDir::read(dir, guard)?;
        Ok(Self {
            output,
            _lock: lock,
        })
    }

    pub(crate) fn output(&self) -> &OutputDir {
        &self.output
    }

    /// Starts a temporary file, which later becomes the file `name` of the directory.
    pub(crate) fn draft(&self, name: &str) -> Result<Draft, Failure> {
        Draft::new(&self.output.dir.join(name)).map_err(Failure::work)
    }

    /// Writes the config at the start of a run. If the directory has the tables or the config of an earlier run, these
    /// files stay until the new run is finished. Until then, the new config has the file name [`NEXT_CONFIG`].
    pub(crate) fn begin(&mut self, config: &str, study: &StudyId) -> Result<(), Failure> {
        let dir = &self.output.dir;
        let has_others = Format::found_in(dir).is_some() || dir.join(CONFIG).exists();
        let known = fs::read(dir.join(CONFIG)).is_ok_and(|known| known == config.as_bytes());
        let name = match (known, has_others) {
            (true, _) => return Ok(()),
            (false, true) => NEXT_CONFIG,
            (false, false) => CONFIG,
        };
        self.write(&[(name, config)], Some(study))
    }

    pub(crate) fn end(&mut self) -> Result<(), Failure> {
        match fs::remove_file(self.output.dir.join(NEXT_CONFIG)) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            Err(error) => {
                let error = Error::new(error).context(format!("cannot remove {NEXT_CONFIG}"));
                return Err(Failure::work(error));
            }
            Ok(()) => {}
        }
        if let Some(manifest) = &mut self.output.manifest {
            manifest.files.remove(NEXT_CONFIG);
        }
        self.write::<&[u8]>(&[], None)
    }

    /// Writes files of a study, each given by name and contents, as [`Self::write`] does. Also removes outdated files
    /// that palpate wrote: files of other studies, tables in the other format (CSV or Parquet), and warnings of an
    /// earlier run. Returns one line of text for each file that was not removed because a user wrote or edited the
    /// file.
    pub(crate) fn replace(
        &mut self,
        files: Vec<(&str, Contents<'_>)>,
        study: &StudyId,
    ) -> Result<Vec<String>, Failure> {
        let manifest = self.output.manifest.as_ref();
        let entries = manifest.iter().flat_map(|manifest| &manifest.files);
        let cells = files.iter().find(|(name, _)| *name == CELLS);
        let cells = cells.map(|(_, contents)| contents.digest());
        let written: Vec<String> = files.iter().map(|(name, _)| (*name).to_owned()).collect();
        let is_written = |name: &str| written.iter().any(|written| written == name);
        let mut tables = Format::ALL.iter().flat_map(|format| format.tables());
        let mut is_replaced =
            |name: &str| WARNINGS.contains(&name) || tables.any(|table| table == name);
        let stale: Vec<String> = entries
            .filter(|(name, entry)| {
                let of = entry.study.as_ref();
                let is_other = of.is_some_and(|of| !of.is_of(study, cells.as_ref()));
                (is_other || is_replaced(name)) && !is_written(name) && *name != NEXT_CONFIG
            })
            .map(|(name, _)| name.clone())
            .collect();
        let is_edited = |name: &String| {
            fs::symlink_metadata(self.output.dir.join(name)).is_ok() && !self.output.lists(name)
        };
        let is_another = manifest.is_some_and(|manifest| {
            let config = manifest.files.get(CONFIG);
            config.is_some_and(|config| config.study.as_ref() != Some(study))
        });
        let mut remaining: Vec<String> = match is_another {
            true => self.output.foreign(),
            false => stale
                .iter()
                .filter(|name| is_edited(name))
                .cloned()
                .collect(),
        };
        remaining.retain(|name| !is_written(name));
        let line = |name: &String| {
            let (path, why) = (self.output.dir.join(name), self.output.reason_to_keep(name));
            format!("{} {why}, and stays", path.display())
        };
        let lines = remaining.iter().map(line).collect();
        self.put(files, Some(study))?;
        for name in stale {
            let path = self.output.dir.join(&name);
            let is_file = fs::symlink_metadata(&path).is_ok_and(|found| found.is_file());
            if is_file && self.output.lists(&name) {
                fs::remove_file(&path)
                    .with_context(|| format!("cannot remove {}", path.display()))
                    .map_err(Failure::work)?;
            }
            if let Some(manifest) = &mut self.output.manifest {
                manifest.files.remove(&name);
            }
        }
        self.write::<&[u8]>(&[], None)?;
        Ok(lines)
    }

    /// Writes files of a study, each given by name and contents.
    ///
    /// All files are first written under temporary names. They get their final names after every byte is on disk, so a
    /// full disk does not destroy the old files.
    pub(crate) fn write<C: AsRef<[u8]>>(
        &mut self,
        files: &[(&str, C)],
        study: Option<&StudyId>,
    ) -> Result<(), Failure> {
        let mut all: Vec<(&str, Contents<'_>)> = Vec::new();
        for (name, bytes) in files {
            all.push((name, Contents::Bytes(bytes.as_ref())));
        }
        self.put(all, study)
    }

    fn put(
        &mut self,
        files: Vec<(&str, Contents<'_>)>,
        study: Option<&StudyId>,
    ) -> Result<(), Failure> {
        for (name, contents) in &files {
            self.output.refuse(name, Some(contents))?;
        }
        let dir = &self.output.dir;
        let is_listed = |name: &str| !is_stream(&dir.join(name));
        let digests: Vec<(String, String)> = files
            .iter()
            .filter(|(name, _)| is_listed(name))
            .map(|(name, contents)| ((*name).to_owned(), contents.digest()))
            .collect();
        let mut staged = Vec::new();
        for (name, contents) in files {
            staged.push(StagedFile::new(&dir.join(name), contents).map_err(Failure::work)?);
        }
        let manifest = self.output.manifest.clone();
        let mut manifest = manifest.unwrap_or_else(|| Manifest::new([].into()));
        // First write a manifest that lists the old and the new contents of each file. If the process is killed while
        // it renames the files, this manifest matches every file, old or new.
        let mut between = manifest.clone();
        for (name, digest) in digests {
            let study = study.cloned();
            let entry = |sha256| Entry { sha256, study };
            let known = between.files.get(&name).map(|known| known.sha256.clone());
            let both = known
                .into_iter()
                .flatten()
                .chain([digest.clone()])
                .collect();
            between.files.insert(name.clone(), entry.clone()(both));
            manifest.files.insert(name, entry(vec![digest]));
        }
        let (between, after) = (between.to_toml()?, manifest.to_toml()?);
        let place = dir.join(MANIFEST);
        let first =
            StagedFile::new(&place, Contents::Bytes(between.as_bytes())).map_err(Failure::work)?;
        let last =
            StagedFile::new(&place, Contents::Bytes(after.as_bytes())).map_err(Failure::work)?;
        let staged = [first].into_iter().chain(staged).chain([last]);
        for file in staged {
            file.persist().map_err(Failure::work)?;
        }
        self.output.manifest = Some(manifest);
        Ok(())
    }
}

/// Lock of a directory. The operating system releases the lock when the process ends.
pub(crate) struct Lock {
    /// The lock file. The directory is locked while this file is open.
    _file: File,
    path: PathBuf,
}

impl Lock {
    pub(crate) fn is_held(dir: &Path) -> bool {
        let file = File::open(dir.join(LOCK_NAME));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }

    /// Locks a directory. If another process holds the lock, the error states the number of that process.
    fn new(dir: &Path) -> Result<Self, Failure> {
        let path = dir.join(LOCK_NAME);
        let shown = path.display();
        let is_other = |text: String| !text.bytes().all(|byte| byte.is_ascii_digit());
        if fs::symlink_metadata(&path).is_ok_and(|found| !found.is_file())
            || fs::read_to_string(&path).is_ok_and(is_other)
        {
            return Err(Failure::work(anyhow!(
                "{shown} is not a lock file of palpate: move it away"
            )));
        }
        let start = Instant::now();
        loop {
            let mut options = OpenOptions::new();
            options.read(true).write(true).create(true).truncate(false);
            let mut file = options
                .open(&path)
                .with_context(|| format!("cannot write into {}", dir.display()))
                .map_err(Failure::work)?;
            match file.try_lock() {
                // Another process may have removed the file after this process opened it, so try again.
                Ok(()) if !is_named(&file, &path) => {}
                Err(TryLockError::WouldBlock) if start.elapsed() < LOCK_TIMEOUT => {
                    std::thread::sleep(LOCK_PAUSE);
                }
                Err(TryLockError::WouldBlock) => return Err(lock_error(dir, &path)),
                // Some file systems do not support locks, so work without a lock.
                Ok(()) | Err(TryLockError::Error(_)) => {
                    // If the disk is full, the number of the process cannot be written, but the lock still works.
                    let _ = file
                        .set_len(0)
                        .and_then(|()| write!(file, "{}", std::process::id()));
                    return Ok(Self { _file: file, path });
                }
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Ignore an error, because a remaining lock file does not block other processes.
        let _ = fs::remove_file(&self.path);
    }
}

fn lock_error(dir: &Path, lock: &Path) -> Failure {
    let process = fs::read_to_string(lock).unwrap_or_default();
    let process = match process.trim() {
        "" => "another process".to_owned(),
        number => format!("process {number}"),
    };
    let dir = dir.display();
    Failure::work(anyhow!(
        "{dir} is locked by {process}, which writes there; wait until it is done"
    ))
}
