//! Directory that a command writes into, locked against other processes.

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

/// Name of the file with the number of the process.
const LOCK_NAME: &str = ".palpate-lock";
/// Time to wait for another process, which may only write a few files.
const LOCK_TIMEOUT: Duration = Duration::from_secs(1);
const LOCK_PAUSE: Duration = Duration::from_millis(20);

/// Directory that this process alone writes into, with the manifest of what palpate wrote there.
pub(crate) struct LockedDir {
    output: OutputDir,
    _lock: Lock,
}

/// Rejects an argument that is not a directory.
pub(crate) fn refuse_no_directory(dir: &Path) -> Result<(), Failure> {
    match dir.is_dir() {
        true => Ok(()),
        false => Err(Failure::usage(anyhow!("{} is no directory", dir.display()))),
    }
}

/// Creates `dir` if it is missing, and checks before the work that files can be written there.
pub(crate) fn make_directory(dir: &Path) -> Result<(), Failure> {
    if dir == Path::new("-") {
        return Err(Failure::usage(anyhow!(
            "`-` is standard output, and this command writes a directory: `./-` is one of that name"
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
            "cannot make the directory {dir}: {link} is a symbolic link to {target}, and nothing is there"
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
    /// Locks a directory, which is created if missing, and removes temporary files of dead processes.
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

    /// The directory with its manifest.
    pub(crate) fn output(&self) -> &OutputDir {
        &self.output
    }

    /// Draft of a file in the directory.
    pub(crate) fn draft(&self, name: &str) -> Result<Draft, Failure> {
        Draft::new(&self.output.dir.join(name)).map_err(Failure::work)
    }

    /// Writes the config of a starting run. If the directory has tables or the config of another run, they stay until this
    /// run is done, and its config is [`NEXT_CONFIG`] until then.
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

    /// Removes [`NEXT_CONFIG`] at the end of a run.
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

    /// Writes files (name and contents) of a study, as [`Self::write`] does, and removes files of other studies and tables
    /// of other formats that palpate wrote. Returns a line for each file that stays because it is not palpate's.
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
            let path = self.output.dir.join(name);
            format!(
                "{} {}, and stays",
                path.display(),
                self.output.reason_to_keep(name)
            )
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

    /// Writes files (name and contents) of a study.
    ///
    /// All are written under temporary names first and renamed when every byte is on disk, so that a full disk leaves the
    /// old files.
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
        // A process that is killed during the renaming leaves old and new files.
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

/// Lock of a directory. It ends with the process.
pub(crate) struct Lock {
    /// The lock holds while this file is open.
    _file: File,
    path: PathBuf,
}

impl Lock {
    /// Whether a process holds a directory.
    pub(crate) fn is_held(dir: &Path) -> bool {
        let file = File::open(dir.join(LOCK_NAME));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }

    /// Locks a directory. The error names the process that holds it.
    fn new(dir: &Path) -> Result<Self, Failure> {
        let path = dir.join(LOCK_NAME);
        let shown = path.display();
        let is_other = |text: String| !text.bytes().all(|byte| byte.is_ascii_digit());
        if fs::symlink_metadata(&path).is_ok_and(|found| !found.is_file())
            || fs::read_to_string(&path).is_ok_and(is_other)
        {
            return Err(Failure::work(anyhow!(
                "{shown} is no lock of palpate: move it away"
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
                // Another process may have removed the file after this one opened it.
                Ok(()) if !is_named(&file, &path) => {}
                Err(TryLockError::WouldBlock) if start.elapsed() < LOCK_TIMEOUT => {
                    std::thread::sleep(LOCK_PAUSE);
                }
                Err(TryLockError::WouldBlock) => return Err(lock_error(dir, &path)),
                // Some file systems have no locks.
                Ok(()) | Err(TryLockError::Error(_)) => {
                    // On a full disk the lock holds without the number.
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
        // A remaining file blocks nobody.
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
        "{dir} is held by {process}, which writes there; wait until it is done"
    ))
}
