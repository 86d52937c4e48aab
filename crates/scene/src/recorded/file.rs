//! Recorded files as bytes, with the names that messages give.

use std::path::Path;

use palpate_study::read_limited;

use super::RecordedError;

/// Largest recorded file that is read, MiB.
const MOST_MIB: u64 = 256;

/// A recorded file: its name, for messages, and its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedFile {
    pub(super) name: String,
    pub(super) bytes: Vec<u8>,
}

impl RecordedFile {
    /// A file that is at hand already.
    pub fn new(name: impl Into<String>, bytes: Vec<u8>) -> Self {
        let name = name.into();
        Self { name, bytes }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`RecordedError::File`] if there is none, or it cannot be read.
    pub fn read(path: &Path) -> Result<Self, RecordedError> {
        let name = path.display().to_string();
        let bytes = read_limited(path, MOST_MIB).map_err(|error| RecordedError::File {
            file: name.clone(),
            message: match error.kind() {
                std::io::ErrorKind::NotFound => "no such file".to_owned(),
                std::io::ErrorKind::IsADirectory => "is a directory, not a file".to_owned(),
                _ => format!("cannot be read: {error}"),
            },
        })?;
        Ok(Self { name, bytes })
    }

    /// Name of the file; drops its bytes.
    pub(super) fn into_name(self) -> String {
        self.name
    }

    pub(super) fn error(&self, message: impl Into<String>) -> RecordedError {
        RecordedError::File {
            file: self.name.clone(),
            message: message.into(),
        }
    }

    /// Its text; a byte order mark is dropped.
    pub(super) fn text(&self) -> Result<&str, RecordedError> {
        let text = std::str::from_utf8(&self.bytes).map_err(|_| self.error("is not UTF-8 text"))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim().is_empty() {
            return Err(self.error("is empty; a header and one row per reading are needed"));
        }
        Ok(text)
    }
}
