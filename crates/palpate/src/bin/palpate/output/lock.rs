//! Lock of a directory, which dies with the process that holds it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};

use super::stage::is_named;
use crate::failure::Failure;

/// Name of the file that holds the number of the process.
const NAME: &str = ".palpate-lock";
/// Time for which another process may write a few files.
const PATIENCE: Duration = Duration::from_secs(1);
const PAUSE: Duration = Duration::from_millis(20);

/// Lock of a directory.
pub(crate) struct Lock {
    /// Locked while it is open.
    _file: File,
    path: PathBuf,
}

impl Lock {
    /// Whether a process holds a directory.
    pub(crate) fn is_held(dir: &Path) -> bool {
        let file = File::open(dir.join(NAME));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }

    /// Locks a directory, or says who holds it.
    pub(crate) fn of(dir: &Path) -> Result<Self, Failure> {
        let path = dir.join(NAME);
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
                // Another process may have removed it after it was opened here.
                Ok(()) if !is_named(&file, &path) => {}
                Err(TryLockError::WouldBlock) if start.elapsed() < PATIENCE => {
                    std::thread::sleep(PAUSE);
                }
                Err(TryLockError::WouldBlock) => return Err(held(dir, &path)),
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
        // One that stays holds nobody up.
        let _ = fs::remove_file(&self.path);
    }
}

fn held(dir: &Path, lock: &Path) -> Failure {
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
