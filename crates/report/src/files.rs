//! Access to the files of a study by name, in a folder or in memory.

use crate::ReportError;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// Largest size of a file that is read, MiB. The tables of the largest possible study are smaller.
const MOST_MIB: u64 = 4096;

/// Files of a study, accessed by name, in a folder or in memory. They are only read, never written.
///
/// ```
/// use palpate_report::Files;
///
/// let files = Files::in_memory([("trace.csv", "x,y\n1,2\n")]);
/// assert!(palpate_report::press_figures(&files).is_err());
/// ```
#[derive(Debug, Clone)]
pub struct Files {
    folder: PathBuf,
    texts: Option<BTreeMap<String, String>>,
}

impl Files {
    /// Files of a folder. Each file is read only when it is needed.
    pub fn in_folder(folder: impl AsRef<Path>) -> Self {
        Self {
            folder: folder.as_ref().to_owned(),
            texts: None,
        }
    }

    /// Files in memory, given as pairs of name and text.
    pub fn in_memory<N: Into<String>, T: Into<String>>(
        texts: impl IntoIterator<Item = (N, T)>,
    ) -> Self {
        let texts = texts.into_iter();
        Self {
            folder: PathBuf::new(),
            texts: Some(
                texts
                    .map(|(name, text)| (name.into(), text.into()))
                    .collect(),
            ),
        }
    }

    /// Whether there is a file with this name.
    pub(crate) fn contain(&self, name: &str) -> bool {
        match &self.texts {
            Some(texts) => texts.contains_key(name),
            None => self.path(name).exists(),
        }
    }

    /// Adds the files `others` (pairs of name and text) to files in memory, except those whose name exists already.
    /// Does nothing if the files are in a folder.
    pub(crate) fn or<const N: usize>(mut self, others: [(&str, &str); N]) -> Self {
        for (name, text) in others {
            if let Some(texts) = &mut self.texts {
                texts.entry(name.to_owned()).or_insert(text.to_owned());
            }
        }
        self
    }

    pub(crate) fn within(&self, name: &str) -> Self {
        Self::in_folder(self.path(name))
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    pub(crate) fn read(&self, name: &str) -> Result<String, ReportError> {
        let text = match &self.texts {
            Some(texts) => texts
                .get(name)
                .cloned()
                .ok_or(io::ErrorKind::NotFound.into()),
            None => palpate_study::read_limited(&self.path(name), MOST_MIB).and_then(|bytes| {
                let text = String::from_utf8(bytes);
                text.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
            }),
        };
        text.map_err(|source| ReportError::Io {
            path: self.path(name),
            source,
        })
    }
}
