//! Decides which files of an output directory palpate may overwrite.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use same_file::is_same_file;

use super::manifest::{Entry, Manifest, StudyId, digest_of};
use super::names;
use super::stage::{Contents, holds, is_stream, unwritable};
use crate::failure::Failure;

/// Directory into which a command writes. The command overwrites only files that palpate wrote, except with `--force`.
pub(crate) struct OutputDir {
    pub(crate) dir: PathBuf,
    /// Manifest of the directory. If the directory has a run's config but no manifest, this is a new manifest. It lists
    /// the files in the directory that have the name of an output file of palpate.
    pub(crate) manifest: Option<Manifest>,
    guard: Guard,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Guard {
    inputs: Vec<PathBuf>,
    force: bool,
}

impl Guard {
    /// Creates the guard of a command, which protects files from being overwritten. The command reads the files
    /// `inputs`, and may overwrite them only with `force`.
    pub(crate) fn new<'a>(inputs: impl IntoIterator<Item = &'a PathBuf>, force: bool) -> Self {
        let inputs = inputs.into_iter().cloned().collect();
        Self { inputs, force }
    }

    pub(crate) fn is_forced(&self) -> bool {
        self.force
    }

    pub(crate) fn reads(&self, path: &Path) -> bool {
        // Compare only existing regular files. Opening a pipe would wait for its writer.
        let is_file = |path: &Path| fs::metadata(path).is_ok_and(|found| found.is_file());
        let is_same =
            |input: &PathBuf| is_file(input) && is_same_file(input, path).unwrap_or(false);
        is_file(path) && self.inputs.iter().any(is_same)
    }

    /// Rejects a file that is an input of the command or that is write-protected, unless `--force` is given.
    pub(crate) fn refuse(&self, path: &Path) -> Result<(), Failure> {
        if self.force {
            return Ok(());
        }
        if self.reads(path) {
            return Err(protected(path, "is an input of this command"));
        }
        if fs::metadata(path).is_ok_and(|found| found.permissions().readonly()) {
            return Err(protected(path, "is write-protected"));
        }
        Ok(())
    }
}

pub(crate) fn protected(path: &Path, why: &str) -> Failure {
    let path = path.display();
    Failure::usage(anyhow!(
        "{path} {why}, and would be replaced: write elsewhere, move it away, or give --force"
    ))
}

impl OutputDir {
    pub(crate) fn read(dir: &Path, guard: Guard) -> Result<Self, Failure> {
        let manifest = match Manifest::read(dir) {
            Err(_) if guard.force => None,
            manifest => manifest?,
        };
        Ok(Self {
            dir: dir.to_owned(),
            manifest: manifest.or_else(|| known_files(dir)),
            guard,
        })
    }

    /// Rejects the file `name` if palpate did not write it, or if it was edited later. Without a manifest, the first
    /// lines of the file must equal the first lines of the new contents.
    pub(crate) fn refuse(
        &self,
        name: &str,
        contents: Option<&Contents<'_>>,
    ) -> Result<(), Failure> {
        let path = self.dir.join(name);
        if let Some(why) = unwritable(&path) {
            let path = path.display();
            return Err(Failure::work(anyhow!("cannot write {path}: {why}")));
        }
        let is_harmless =
            contents.map_or_else(|| holds(&path, &[]), |contents| contents.are_in(&path));
        let is_open = is_stream(&path) && !self.guard.reads(&path);
        if self.guard.force || is_harmless || is_open || fs::metadata(&path).is_err() {
            return Ok(());
        }
        // The command may not overwrite its input files, except for the config. A run may read the config that an
        // earlier run wrote in this directory, and then write it again.
        if name != names::CONFIG {
            self.guard.refuse(&path)?;
        }
        // Without a manifest, a file that palpate wrote is recognised by its header. This is not done for tables of
        // readings, because readings that a user recorded may have the same header.
        let is_lone = self.manifest.is_none() && name != names::READINGS;
        match self.entry(name) {
            Some(entry) if entry.is_of(&path) => Ok(()),
            Some(_) => Err(protected(&path, "was changed since palpate wrote it")),
            None if is_lone
                && contents.is_some_and(|contents| begins_as(&path, contents.head())) =>
            {
                Ok(())
            }
            None => Err(protected(&path, "is not a file that palpate wrote")),
        }
    }

    fn entry(&self, name: &str) -> Option<&Entry> {
        self.manifest.as_ref()?.files.get(name)
    }

    /// Reason why palpate neither overwrites nor removes the file `name`.
    pub(crate) fn reason_to_keep(&self, name: &str) -> &'static str {
        match self.entry(name) {
            Some(_) => "was changed since palpate wrote it",
            None => "is not of this study",
        }
    }

    /// Whether the manifest lists the file and the file is unchanged since palpate wrote it.
    pub(crate) fn lists(&self, name: &str) -> bool {
        let entry = self.entry(name);
        entry.is_some_and(|entry| entry.is_of(&self.dir.join(name)))
    }

    /// Names of files that palpate did not write. Input files of the command are omitted.
    pub(crate) fn foreign(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.dir).into_iter().flatten().flatten();
        let files = entries.filter(|entry| entry.file_type().is_ok_and(|kind| !kind.is_dir()));
        let mut names: Vec<String> = files
            .filter(|entry| !self.guard.reads(&entry.path()))
            .filter_map(|entry| entry.file_name().into_string().ok())
            .filter(|name| !name.starts_with('.') && name != names::JOURNAL && !self.lists(name))
            .collect();
        names.sort();
        names
    }
}

/// Whether an existing file begins in the same way as the new contents: with the same table header, the same first
/// comment, or the same page title. The result is always false for pictures.
pub(crate) fn begins_as(path: &Path, contents: &[u8]) -> bool {
    let Some(head) = head_of(contents) else {
        return false;
    };
    let mut known = Vec::new();
    let read = fs::File::open(path).and_then(|file| {
        let mut start = file.take(head.len() as u64);
        start.read_to_end(&mut known)
    });
    read.is_ok() && known == head
}

/// The beginning of a file by which palpate recognises its own files: a table header, a comment or a page title. `None`
/// for pictures and other formats.
fn head_of(contents: &[u8]) -> Option<&[u8]> {
    const TITLE: &[u8] = b"</title>";
    let is = |start: &[u8]| contents.starts_with(start);
    if is(b"PAR1") {
        return None;
    }
    if is(b"<!DOCTYPE html>") {
        let mut places = contents.windows(TITLE.len());
        return Some(&contents[..places.position(|place| place == TITLE)?]);
    }
    let end = contents.iter().position(|&byte| byte == b'\n')?;
    let line = &contents[..=end];
    (is(b"#") || line.contains(&b',')).then_some(line)
}

/// Makes a manifest for a directory that has a run's config but no manifest. The manifest lists the files in the
/// directory that have the name of an output file of palpate.
fn known_files(dir: &Path) -> Option<Manifest> {
    let config = dir.join(names::CONFIG);
    if !names::is_run_config(&config) {
        return None;
    }
    let text = names::text_of(&config)?;
    let (name, known) = names::run_files(&config, &text);
    let study = StudyId::new(&name, &text);
    let files: BTreeMap<String, Entry> = known
        .into_iter()
        .filter_map(|name| {
            let path = dir.join(&name);
            let is_file = fs::symlink_metadata(&path).is_ok_and(|found| found.is_file())
                && matches_extension(&path)
                && (name != names::NEXT_CONFIG || names::is_run_config(&path));
            let sha256 = vec![digest_of(&path).ok().filter(|_| is_file)?];
            let study = Some(study.clone());
            Some((name, Entry { sha256, study }))
        })
        .collect();
    Some(Manifest::new(files))
}

/// Whether the first bytes of a file match its extension. For example, a CSV table must begin with a header of several
/// columns, and a picture with the magic bytes of its format.
fn matches_extension(path: &Path) -> bool {
    let mut start = Vec::new();
    let read = fs::File::open(path).and_then(|file| file.take(256).read_to_end(&mut start));
    let header = start.split(|&byte| byte == b'\n').next();
    read.is_ok()
        && match path.extension().and_then(std::ffi::OsStr::to_str) {
            Some("csv") => header.is_some_and(|header| header.contains(&b',')),
            Some("parquet") => start.starts_with(b"PAR1"),
            Some("png") => start.starts_with(b"\x89PNG"),
            Some("svg") => start.starts_with(b"<svg"),
            _ => true,
        }
}
