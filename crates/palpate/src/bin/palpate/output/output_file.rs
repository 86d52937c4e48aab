//! Output of a command that goes to a file, a pipe, a device or standard output.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};

use super::locked_dir::make_directory;
use super::output_dir::{Guard, begins_as, protected};
use super::stage::{
    Contents, Draft, StagedFile, folder_of, holds, is_stream, remove_abandoned, unwritable,
};
use crate::failure::Failure;

/// A single output file of a command, which may also be a pipe, a device or standard output.
pub(crate) struct OutputFile {
    path: Option<PathBuf>,
    guard: Guard,
}

impl OutputFile {
    /// Output file at `path`. Error messages contain `option`, the command-line option that states this path. Rejects a
    /// path that cannot be written, and an existing file that is write-protected or an input of the command.
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

    pub(crate) fn print(&self, text: &str) -> Result<(), Failure> {
        if self.path.is_some() {
            return super::print(text);
        }
        super::print_note(text);
        Ok(())
    }

    /// Rejects an existing file that palpate did not write, before the work starts. `is_ours` decides whether palpate
    /// wrote a file.
    pub(crate) fn refuse_other(&self, is_ours: impl Fn(&Path) -> bool) -> Result<(), Failure> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let is_free = || is_stream(path) || holds(path, &[]) || is_ours(path);
        match fs::metadata(path).is_err() || self.guard.is_forced() || is_free() {
            true => Ok(()),
            false => Err(protected(path, "is not a file that palpate wrote")),
        }
    }

    /// Starts to write the file piece by piece. An existing file is replaced only after the last piece.
    pub(crate) fn begin(&self) -> Result<OutputWriter<'_>, Failure> {
        let place = match &self.path {
            None => Place::Standard(io::stdout()),
            Some(path) if is_stream(path) => {
                let file = OpenOptions::new().append(true).open(path);
                Place::Stream(file.with_context(|| cannot(path)).map_err(Failure::work)?)
            }
            Some(path) => {
                self.make_folder(path)?;
                Place::Draft(Box::new(Draft::new(path).map_err(Failure::work)?))
            }
        };
        Ok(OutputWriter { file: self, place })
    }

    /// Writes the whole file, and creates its directory if missing. Rejects an existing file that palpate did not
    /// write.
    pub(crate) fn write(&self, contents: &[u8]) -> Result<(), Failure> {
        let Some(path) = &self.path else {
            return super::write_stdout(contents);
        };
        if !is_stream(path) {
            let is_ours = holds(path, contents) || begins_as(path, contents);
            if fs::metadata(path).is_ok() && !self.guard.is_forced() && !is_ours {
                return Err(protected(path, "is not a file that palpate wrote"));
            }
            self.make_folder(path)?;
        }
        let staged = StagedFile::new(path, Contents::Bytes(contents));
        staged.and_then(StagedFile::persist).map_err(Failure::work)
    }

    /// Creates the directory of the file. Removes temporary files that ended processes left there.
    fn make_folder(&self, path: &Path) -> Result<(), Failure> {
        let dir = folder_of(path);
        make_directory(dir).map_err(|failure| {
            let (Failure::Usage(error) | Failure::Work(error) | Failure::Stopped(error, _)) =
                failure;
            Failure::Work(error.context(cannot(path)))
        })?;
        remove_abandoned(dir);
        Ok(())
    }
}

fn cannot(path: &Path) -> String {
    format!("cannot write {}", path.display())
}

pub(crate) struct OutputWriter<'s> {
    file: &'s OutputFile,
    place: Place,
}

enum Place {
    Standard(io::Stdout),
    Stream(File),
    Draft(Box<Draft>),
}

impl OutputWriter<'_> {
    /// Calls `put` with the writer of the file. It is not an error if the reader of a pipe closes the pipe early.
    fn put(&mut self, put: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let result = match &mut self.place {
            Place::Standard(stdout) => put(stdout),
            Place::Stream(file) => put(file),
            Place::Draft(draft) => put(draft),
        };
        result.or_else(|error| match error.kind() {
            ErrorKind::BrokenPipe => Ok(()),
            _ => Err(error),
        })
    }
}

impl Write for OutputWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.put(|sink| sink.write_all(bytes))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.put(|sink| sink.flush())
    }
}

impl OutputWriter<'_> {
    /// Gives the complete file its final name. Rejects an existing file that palpate did not write, as `is_ours`
    /// decides.
    pub(crate) fn end(mut self, is_ours: impl Fn(&Path) -> bool) -> Result<(), Failure> {
        let name = self.file.path.as_deref().unwrap_or(Path::new("-"));
        self.flush()
            .with_context(|| cannot(name))
            .map_err(Failure::work)?;
        let (Place::Draft(draft), Some(path)) = (self.place, &self.file.path) else {
            return Ok(());
        };
        let contents = Contents::Draft(*draft);
        let is_ours = |path: &Path| contents.are_in(path) || is_ours(path);
        self.file.refuse_other(is_ours)?;
        let staged = StagedFile::new(path, contents);
        staged.and_then(StagedFile::persist).map_err(Failure::work)
    }
}
