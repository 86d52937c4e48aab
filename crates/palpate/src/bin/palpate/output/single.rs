//! A single file that a command writes: a regular one, or a pipe or a device that is written into.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::anyhow;

use super::folder::make_directory;
use super::owned::{Guard, begins_as, refusal};
use super::stage::{Contents, Staged, folder_of, holds, is_stream, sweep, unwritable};
use crate::failure::Failure;

/// Place that a command writes a single file to: standard output where it has no path.
pub(crate) struct Single {
    path: Option<PathBuf>,
    guard: Guard,
}

impl Single {
    /// Place that the argument of `option` names; refuses what cannot be written, or must not be replaced.
    pub(crate) fn new(option: &str, path: &Path, guard: Guard) -> Result<Self, Failure> {
        if path == Path::new("-") || path == Path::new("/dev/stdout") {
            return Ok(Self { path: None, guard });
        }
        let named = path.file_name().and_then(std::ffi::OsStr::to_str);
        let unnamed = || named.is_none().then_some("is not a file name");
        if let Some(why) = unwritable(path).or_else(unnamed) {
            let path = path.display();
            return Err(Failure::usage(anyhow!("{option} {path}: {why}")));
        }
        if !is_stream(path) || guard.reads(path) {
            guard.refuse(path)?;
        }
        let path = Some(path.to_owned());
        Ok(Self { path, guard })
    }

    /// Prints what a command says besides the file: on standard error where the file itself goes to standard output.
    pub(crate) fn print(&self, text: &str) -> Result<(), Failure> {
        if self.path.is_some() {
            return super::print(text);
        }
        eprintln!("{text}");
        Ok(())
    }

    /// Writes the file, whose folder is made if missing. A file that was there is replaced whole, if it is palpate's.
    pub(crate) fn write(&self, contents: &[u8]) -> Result<(), Failure> {
        let Some(path) = &self.path else {
            return super::put(contents);
        };
        if !is_stream(path) {
            let is_ours = holds(path, contents) || begins_as(path, contents);
            if fs::metadata(path).is_ok() && !self.guard.is_forced() && !is_ours {
                return Err(refusal(path, "is not a file that palpate wrote"));
            }
            let dir = folder_of(path);
            make_directory(dir).map_err(|failure| {
                let (Failure::Usage(error) | Failure::Work(error) | Failure::Stopped(error, _)) =
                    failure;
                Failure::Work(error.context(format!("cannot write {}", path.display())))
            })?;
            sweep(dir);
        }
        let staged = Staged::new(path, Contents::Bytes(contents));
        staged.and_then(Staged::persist).map_err(Failure::work)
    }
}
