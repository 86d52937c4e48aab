//! Directory that a command writes into.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use anyhow::{Context, Error, anyhow};
use tempfile::NamedTempFile;

use super::format::Format;
use super::lock::Lock;
use super::manifest::{Entry, MANIFEST, Manifest, StudyId};
use super::names::{CELLS, CONFIG, NEXT_CONFIG, WARNINGS};
use super::owned::{Guard, Owned};
use super::stage::{Contents, Draft, Staged, is_stream, sweep};
use crate::failure::Failure;

/// Directory that this process alone writes into, with the manifest of what palpate wrote there.
pub(crate) struct Folder {
    owned: Owned,
    _lock: Lock,
}

/// Refuses an argument that should be a directory and is none.
pub(crate) fn refuse_no_directory(dir: &Path) -> Result<(), Failure> {
    match dir.is_dir() {
        true => Ok(()),
        false => Err(Failure::usage(anyhow!("{} is no directory", dir.display()))),
    }
}

/// Makes `dir` if it is missing, and sees that files can be written there: before the work, not
/// after it.
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

impl Folder {
    /// Takes hold of a directory, made if missing, and removes what dead processes left there.
    pub(crate) fn open(dir: &Path, guard: Guard) -> Result<Self, Failure> {
        make_directory(dir)?;
        let lock = Lock::of(dir)?;
        sweep(dir);
        let owned = Owned::read(dir, guard)?;
        Ok(Self { owned, _lock: lock })
    }

    /// Rights over the files that are there.
    pub(crate) fn owned(&self) -> &Owned {
        &self.owned
    }

    /// Draft of a file of the directory.
    pub(crate) fn draft(&self, name: &str) -> Result<Draft, Failure> {
        Draft::new(&self.owned.dir.join(name)).map_err(Failure::work)
    }

    /// Writes the config of a run that begins: beside no tables but its own. Where the directory has those of another
    /// config, or another config, they stay until the run is done, and this one's is [`NEXT_CONFIG`].
    pub(crate) fn begin(&mut self, config: &str, study: &StudyId) -> Result<(), Failure> {
        let dir = &self.owned.dir;
        let has_others = Format::found_in(dir).is_some() || dir.join(CONFIG).exists();
        let known = fs::read(dir.join(CONFIG)).is_ok_and(|known| known == config.as_bytes());
        let name = match (known, has_others) {
            (true, _) => return Ok(()),
            (false, true) => NEXT_CONFIG,
            (false, false) => CONFIG,
        };
        self.write(&[(name, config)], Some(study))
    }

    /// Ends the run that began: its config has its name, or its tables could not be written.
    pub(crate) fn end(&mut self) -> Result<(), Failure> {
        match fs::remove_file(self.owned.dir.join(NEXT_CONFIG)) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            Err(error) => {
                let error = Error::new(error).context(format!("cannot remove {NEXT_CONFIG}"));
                return Err(Failure::work(error));
            }
            Ok(()) => {}
        }
        if let Some(manifest) = &mut self.owned.manifest {
            manifest.files.remove(NEXT_CONFIG);
        }
        self.write::<&[u8]>(&[], None)
    }

    /// Writes files (name and contents) of a study, as [`Self::write`] does, and removes what palpate wrote of
    /// another study, or as tables of another format; gives a line for each file that stays beside them and is not palpate's.
    pub(crate) fn replace(
        &mut self,
        files: Vec<(&str, Contents<'_>)>,
        study: &StudyId,
    ) -> Result<Vec<String>, Failure> {
        let manifest = self.owned.manifest.as_ref();
        let entries = manifest.iter().flat_map(|manifest| &manifest.files);
        let cells = files.iter().find(|(name, _)| *name == CELLS);
        let cells = cells.map(|(_, contents)| contents.digest());
        let written: Vec<String> = files.iter().map(|(name, _)| (*name).to_owned()).collect();
        let is_written = |name: &str| written.iter().any(|written| written == name);
        let mut tables = Format::ALL.iter().flat_map(|format| format.tables());
        let mut is_replaced = |name: &str| name == WARNINGS || tables.any(|table| table == name);
        let stale: Vec<String> = entries
            .filter(|(name, entry)| {
                let of = entry.study.as_ref();
                let is_other = of.is_some_and(|of| !of.is_of(study, cells.as_ref()));
                (is_other || is_replaced(name)) && !is_written(name) && *name != NEXT_CONFIG
            })
            .map(|(name, _)| name.clone())
            .collect();
        let is_edited = |name: &String| {
            fs::symlink_metadata(self.owned.dir.join(name)).is_ok() && !self.owned.lists(name)
        };
        let is_another = manifest.is_some_and(|manifest| {
            let config = manifest.files.get(CONFIG);
            config.is_some_and(|config| config.study.as_ref() != Some(study))
        });
        let mut left: Vec<String> = match is_another {
            true => self.owned.foreign(),
            false => stale
                .iter()
                .filter(|name| is_edited(name))
                .cloned()
                .collect(),
        };
        left.retain(|name| !is_written(name));
        let line = |name: &String| {
            let path = self.owned.dir.join(name);
            format!(
                "{} {}, and stays",
                path.display(),
                self.owned.why_left(name)
            )
        };
        let lines = left.iter().map(line).collect();
        self.put(files, Some(study))?;
        for name in stale {
            let path = self.owned.dir.join(&name);
            let is_file = fs::symlink_metadata(&path).is_ok_and(|found| found.is_file());
            if is_file && self.owned.lists(&name) {
                fs::remove_file(&path)
                    .with_context(|| format!("cannot remove {}", path.display()))
                    .map_err(Failure::work)?;
            }
            if let Some(manifest) = &mut self.owned.manifest {
                manifest.files.remove(&name);
            }
        }
        self.write::<&[u8]>(&[], None)?;
        Ok(lines)
    }

    /// Writes files (name and contents) of a study.
    ///
    /// All are written under temporary names first and renamed only when every byte is on disk, so that
    /// a full disk leaves what was there before.
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
            self.owned.refuse(name, Some(contents))?;
        }
        let dir = &self.owned.dir;
        let is_listed = |name: &str| !is_stream(&dir.join(name));
        let digests: Vec<(String, String)> = files
            .iter()
            .filter(|(name, _)| is_listed(name))
            .map(|(name, contents)| ((*name).to_owned(), contents.digest()))
            .collect();
        let mut staged = Vec::new();
        for (name, contents) in files {
            staged.push(Staged::new(&dir.join(name), contents).map_err(Failure::work)?);
        }
        let manifest = self.owned.manifest.clone();
        let mut manifest = manifest.unwrap_or_else(|| Manifest::new([].into()));
        // A process that is killed while it renames leaves files of both contents.
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
            Staged::new(&place, Contents::Bytes(between.as_bytes())).map_err(Failure::work)?;
        let last = Staged::new(&place, Contents::Bytes(after.as_bytes())).map_err(Failure::work)?;
        let staged = [first].into_iter().chain(staged).chain([last]);
        for file in staged {
            file.persist().map_err(Failure::work)?;
        }
        self.owned.manifest = Some(manifest);
        Ok(())
    }
}
