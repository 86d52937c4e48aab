//! A single file that a command writes: a regular one, or a pipe or a device that is written into.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, anyhow};

use super::folder::make_directory;
use super::owned::{Guard, begins_as, refusal};
use super::stage::{Contents, Draft, Staged, folder_of, holds, is_stream, sweep, unwritable};
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

    /// Refuses, before the work, to replace a file that does not begin with this line.
    pub(crate) fn refuse_other(&self, head: &str) -> Result<(), Failure> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let head = head.as_bytes();
        let is_ours = is_stream(path) || holds(path, head) || begins_as(path, head);
        match fs::metadata(path).is_err() || self.guard.is_forced() || is_ours {
            true => Ok(()),
            false => Err(refusal(path, "is not a file that palpate wrote")),
        }
    }

    /// Begins the file, to be written piece by piece. One that is there is replaced when the last piece is.
    pub(crate) fn begin(&self) -> Result<Written<'_>, Failure> {
        let place = match &self.path {
            None => Place::Standard,
            Some(path) if is_stream(path) => {
                let file = OpenOptions::new().append(true).open(path);
                Place::Stream(file.with_context(|| cannot(path)).map_err(Failure::work)?)
            }
            Some(path) => {
                self.make_folder(path)?;
                Place::Draft(Box::new(Draft::new(path).map_err(Failure::work)?))
            }
        };
        Ok(Written {
            single: self,
            place,
        })
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
            self.make_folder(path)?;
        }
        let staged = Staged::new(path, Contents::Bytes(contents));
        staged.and_then(Staged::persist).map_err(Failure::work)
    }

    /// Makes the folder of the file, and removes what dead processes left there.
    fn make_folder(&self, path: &Path) -> Result<(), Failure> {
        let dir = folder_of(path);
        make_directory(dir).map_err(|failure| {
            let (Failure::Usage(error) | Failure::Work(error) | Failure::Stopped(error, _)) =
                failure;
            Failure::Work(error.context(cannot(path)))
        })?;
        sweep(dir);
        Ok(())
    }
}

fn cannot(path: &Path) -> String {
    format!("cannot write {}", path.display())
}

/// File that is being written.
pub(crate) struct Written<'s> {
    single: &'s Single,
    place: Place,
}

enum Place {
    Standard,
    Stream(File),
    Draft(Box<Draft>),
}

impl Written<'_> {
    /// Writes a piece; a reader that closes a pipe early is no error.
    pub(crate) fn write(&mut self, text: &str) -> Result<(), Failure> {
        let written = match &mut self.place {
            Place::Standard => return super::put(text.as_bytes()),
            Place::Stream(file) => file.write_all(text.as_bytes()),
            Place::Draft(draft) => draft.write_all(text.as_bytes()),
        };
        match written {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                let path = self.single.path.as_deref().unwrap_or(Path::new("-"));
                Err(Failure::work(Error::new(error).context(cannot(path))))
            }
            _ => Ok(()),
        }
    }

    /// Gives the file its name.
    pub(crate) fn end(self) -> Result<(), Failure> {
        let (Place::Draft(draft), Some(path)) = (self.place, &self.single.path) else {
            return Ok(());
        };
        let contents = Contents::Draft(*draft);
        let is_ours = contents.are_in(path) || begins_as(path, contents.head());
        if fs::metadata(path).is_ok() && !self.single.guard.is_forced() && !is_ours {
            return Err(refusal(path, "is not a file that palpate wrote"));
        }
        let staged = Staged::new(path, contents);
        staged.and_then(Staged::persist).map_err(Failure::work)
    }
}
