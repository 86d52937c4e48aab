//! A single file that a command writes: a regular one, or a pipe or a device that is written into.

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, anyhow};

use super::folder::make_directory;
use super::owned::{Guard, begins_as, holds, refusal};
use super::stage::{Staged, folder_of, sweep};
use crate::failure::Failure;

/// Place that a command writes a single file to.
pub(crate) struct Single {
    place: Place,
    guard: Guard,
}

enum Place {
    Stdout,
    /// Pipe or device.
    Stream(PathBuf),
    File(PathBuf),
}

/// Roots of the paths that are written into even where a regular file stands behind them.
const STREAMS: [&str; 3] = ["/dev", "/proc", "/sys"];

impl Single {
    /// Place that the argument of `option` names; refuses what cannot be written, or must not be replaced.
    pub(crate) fn new(option: &str, path: &Path, guard: Guard) -> Result<Self, Failure> {
        let shown = path.display();
        if path == Path::new("-") || path == Path::new("/dev/stdout") {
            let place = Place::Stdout;
            return Ok(Self { place, guard });
        }
        let found = fs::metadata(path).ok();
        let is_dir = found.as_ref().is_some_and(fs::Metadata::is_dir);
        if path.file_name().and_then(std::ffi::OsStr::to_str).is_none() || is_dir {
            return Err(Failure::usage(anyhow!(
                "{option} {shown}: is not a file name"
            )));
        }
        let is_file = found.as_ref().is_none_or(fs::Metadata::is_file);
        let is_stream = STREAMS.iter().any(|root| path.starts_with(root));
        let path = path.to_owned();
        let place = match (is_file, is_stream && found.is_some()) {
            (true, false) => {
                guard.refuse(&path)?;
                Place::File(path)
            }
            _ if found.is_some_and(|found| is_block_device(&found)) => {
                return Err(Failure::usage(anyhow!("{option} {shown}: is a disk")));
            }
            _ => Place::Stream(path),
        };
        Ok(Self { place, guard })
    }

    /// Prints what a command says besides the file: on standard error where the file itself goes to standard output.
    pub(crate) fn print(&self, text: &str) -> Result<(), Failure> {
        match self.place {
            Place::Stdout => eprintln!("{text}"),
            _ => super::print(text)?,
        }
        Ok(())
    }

    /// Writes the file, whose folder is made if missing. A file that was there is replaced whole, if it is palpate's.
    pub(crate) fn write(&self, contents: &[u8]) -> Result<(), Failure> {
        let cannot = |path: &Path| format!("cannot write {}", path.display());
        let wrote = match &self.place {
            Place::Stdout => {
                let mut stdout = std::io::stdout().lock();
                let wrote = stdout.write_all(contents).and_then(|()| stdout.flush());
                unless_closed(wrote).context("cannot write to standard output")
            }
            Place::Stream(path) => {
                let file = OpenOptions::new().write(true).open(path);
                unless_closed(file.and_then(|mut file| file.write_all(contents)))
                    .with_context(|| cannot(path))
            }
            Place::File(path) => {
                let is_there = fs::metadata(path).is_ok();
                let is_ours = || holds(path, contents) || begins_as(path, contents);
                if is_there && !self.guard.is_forced() && !is_ours() {
                    return Err(refusal(path, "is not a file that palpate wrote"));
                }
                let dir = folder_of(path);
                make_directory(dir).map_err(|failure| {
                    let (Failure::Usage(error) | Failure::Work(error)) = failure;
                    Failure::Work(error.context(cannot(path)))
                })?;
                sweep(dir);
                Staged::new(path, contents).and_then(Staged::persist)
            }
        };
        wrote.map_err(Failure::work)
    }
}

/// A reader that closes a pipe early is no error.
fn unless_closed(wrote: std::io::Result<()>) -> Result<(), Error> {
    match wrote {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

#[cfg(unix)]
fn is_block_device(found: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    found.file_type().is_block_device()
}

#[cfg(not(unix))]
fn is_block_device(_: &fs::Metadata) -> bool {
    false
}
