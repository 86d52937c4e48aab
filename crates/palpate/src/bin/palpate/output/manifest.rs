//! Manifest of an output directory: the list of files that palpate wrote there.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Component, Path};

use anyhow::{Context, anyhow};
use palpate_study::read_limited;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::names::{CELLS, MAX_MIB};
use crate::failure::Failure;

pub(crate) const MANIFEST: &str = ".palpate.toml";
const VERSION: u32 = 1;

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    version: u32,
    #[serde(default)]
    pub(crate) files: BTreeMap<String, Entry>,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Entry {
    /// SHA-256 of the file's contents. While the file is being replaced, the list has two values: old and new.
    pub(crate) sha256: Vec<String>,
    /// Study to which the file belongs; `None` if camera frames were tracked without a study.
    #[serde(flatten)]
    pub(crate) study: Option<StudyId>,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct StudyId {
    study: String,
    /// SHA-256 of the study's config, as text of `run.toml`.
    config: String,
    /// SHA-256 of `cells.csv`, if the file is a figure or score that was made from it; `None` for all other files.
    #[serde(skip_serializing_if = "Option::is_none")]
    cells: Option<String>,
}

impl StudyId {
    /// Identity of the study with this name, whose `run.toml` contains the text `config`.
    pub(crate) fn new(name: &str, config: &str) -> Self {
        Self {
            study: name.to_owned(),
            config: digest(config.as_bytes()),
            cells: None,
        }
    }

    /// Metadata of a table, as pairs of key and value: the name of the study, and the SHA-256 of the study's config.
    pub(crate) fn about(&self) -> [(&'static str, String); 2] {
        [
            ("study", self.study.clone()),
            ("config_sha256", self.config.clone()),
        ]
    }

    /// Adds the SHA-256 of the `cells.csv` in the directory `dir`, if this file can be read.
    pub(crate) fn with_cells_in(self, dir: &Path) -> Self {
        let cells = digest_of(&dir.join(CELLS)).ok();
        Self { cells, ..self }
    }

    /// Whether a file with this identity belongs to the study `other`. `cells` is the SHA-256 of that study's
    /// `cells.csv`.
    pub(crate) fn is_of(&self, other: &Self, cells: Option<&String>) -> bool {
        let is_same = (&self.study, &self.config) == (&other.study, &other.config);
        is_same && (self.cells.is_none() || self.cells.as_ref() == cells)
    }
}

impl Manifest {
    pub(crate) fn new(files: BTreeMap<String, Entry>) -> Self {
        let version = VERSION;
        Self { version, files }
    }

    pub(crate) fn read(dir: &Path) -> Result<Option<Self>, Failure> {
        let path = dir.join(MANIFEST);
        let fault = |what: String| {
            let path = path.display();
            Failure::usage(anyhow!(
                "{path} {what}, so palpate cannot recognise its own files beside it: choose another directory, or use --force"
            ))
        };
        // Never open a pipe, because reading it would wait for its writer. Only files and directories are read.
        if fs::metadata(&path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            return Err(fault("is no manifest of palpate".to_owned()));
        }
        let text = match read_limited(&path, MAX_MIB) {
            Ok(bytes) => String::from_utf8(bytes).unwrap_or_default(),
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
                ) =>
            {
                return Ok(None);
            }
            Err(error) => {
                let error = Err(error).with_context(|| format!("cannot read {}", path.display()));
                return error.map_err(Failure::work);
            }
        };
        let table: toml::Table =
            toml::from_str(&text).map_err(|_| fault("is no manifest of palpate".to_owned()))?;
        match table.get("version").and_then(toml::Value::as_integer) {
            Some(version) if version == i64::from(VERSION) => {}
            Some(version) => {
                return Err(fault(format!(
                    "has version {version}; this palpate reads version {VERSION}"
                )));
            }
            None => return Err(fault("is no manifest of palpate".to_owned())),
        }
        let manifest: Self =
            toml::from_str(&text).map_err(|_| fault("is no manifest of palpate".to_owned()))?;
        match manifest.files.keys().find(|name| !is_plain(name)) {
            Some(name) => Err(fault(format!("names `{name}`, which is not beside it"))),
            None => Ok(Some(manifest)),
        }
    }

    pub(crate) fn to_toml(&self) -> Result<String, Failure> {
        let body = toml::to_string(self).map_err(Failure::work)?;
        Ok(format!(
            "# Files that palpate wrote here. A file that differs from its SHA-256 was changed later.\n{body}"
        ))
    }
}

impl Entry {
    /// Whether the file at `path` has the contents that palpate wrote.
    pub(crate) fn is_of(&self, path: &Path) -> bool {
        // If a pipe has this name, do not read it, because reading it would wait for its writer.
        let is_file = fs::metadata(path).is_ok_and(|found| found.is_file());
        is_file && digest_of(path).is_ok_and(|digest| self.sha256.contains(&digest))
    }
}

pub(crate) fn digest(bytes: &[u8]) -> String {
    hexadecimal(Sha256::digest(bytes).as_slice())
}

pub(crate) fn digest_of(path: &Path) -> io::Result<String> {
    let mut hash = Sha256::new();
    io::copy(&mut File::open(path)?, &mut hash)?;
    Ok(hexadecimal(hash.finalize().as_slice()))
}

pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Whether a name is only a file name, without directories.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!((parts.next(), parts.next()), (Some(Component::Normal(only)), None) if only == name)
}
