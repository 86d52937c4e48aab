//! Files appear whole or not at all: written under a temporary name, then renamed.

use crate::ReportError;
use std::fs;
use std::path::{Path, PathBuf};

/// The whole of a text file.
pub(crate) fn read(path: &Path) -> Result<String, ReportError> {
    fs::read_to_string(path).map_err(|source| ReportError::Io {
        path: path.to_owned(),
        source,
    })
}

/// Writes `bytes` to `path`, replacing what was there.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    replace(path, |temporary| {
        fs::write(temporary, bytes).map_err(|source| ReportError::Io {
            path: path.to_owned(),
            source,
        })
    })
}

/// Lets `produce` write a temporary file in the folder of `path`, with the same extension, then renames it to
/// `path`. If anything fails, the temporary file is removed and `path` is as it was.
pub(crate) fn replace(
    path: &Path,
    produce: impl FnOnce(&Path) -> Result<(), ReportError>,
) -> Result<(), ReportError> {
    let temporary = temporary_name(path);
    let done = produce(&temporary).and_then(|()| {
        fs::rename(&temporary, path).map_err(|source| ReportError::Io {
            path: path.to_owned(),
            source,
        })
    });
    if done.is_err() {
        // The first error is the one to report; a file that was never made cannot be removed.
        let _ = fs::remove_file(&temporary);
    }
    done
}

fn temporary_name(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".partial-{}-{name}", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_other() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.txt");
        write(&path, b"old").unwrap();
        let failed = replace(&path, |temporary| {
            fs::write(temporary, b"half").unwrap();
            Err(ReportError::EmptyTable { path: path.clone() })
        });
        assert!(failed.is_err());
        assert_eq!(read(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_an_error_that_names_the_file() {
        let error = write(Path::new("/nonexistent-folder/x.svg"), b"").unwrap_err();
        assert!(
            error.to_string().contains("/nonexistent-folder/x.svg"),
            "{error}"
        );
    }
}
