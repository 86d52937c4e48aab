//! A single file that a command writes: a regular one, or a pipe or a device that is written into.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};

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

    /// Refuses, before the work, to replace a file of which `is_ours` does not know that palpate wrote it.
    pub(crate) fn refuse_other(&self, is_ours: impl Fn(&Path) -> bool) -> Result<(), Failure> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let is_free = || is_stream(path) || holds(path, &[]) || is_ours(path);
        match fs::metadata(path).is_err() || self.guard.is_forced() || is_free() {
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

impl Write for Written<'_> {
    /// Writes a piece; a reader that closes a pipe early is no error.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = match &mut self.place {
            Place::Standard => io::stdout().write_all(bytes),
            Place::Stream(file) => file.write_all(bytes),
            Place::Draft(draft) => draft.write_all(bytes),
        };
        match written {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
            _ => Ok(bytes.len()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = match &mut self.place {
            Place::Standard => io::stdout().flush(),
            Place::Stream(file) => file.flush(),
            Place::Draft(draft) => draft.flush(),
        };
        match flushed {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
            _ => Ok(()),
        }
    }
}

impl Written<'_> {
    /// Gives the file its name, unless it would replace one of which `is_ours` does not know that palpate wrote it.
    pub(crate) fn end(mut self, is_ours: impl Fn(&Path) -> bool) -> Result<(), Failure> {
        let name = self.single.path.as_deref().unwrap_or(Path::new("-"));
        self.flush()
            .with_context(|| cannot(name))
            .map_err(Failure::work)?;
        let (Place::Draft(draft), Some(path)) = (self.place, &self.single.path) else {
            return Ok(());
        };
        let contents = Contents::Draft(*draft);
        let is_ours = |path: &Path| contents.are_in(path) || is_ours(path);
        self.single.refuse_other(is_ours)?;
        let staged = Staged::new(path, contents);
        staged.and_then(Staged::persist).map_err(Failure::work)
    }
}
