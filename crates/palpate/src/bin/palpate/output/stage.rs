//! Contents under temporary names, locked by the process that writes them.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, BufWriter, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, anyhow};
use same_file::Handle;
use sha2::{Digest, Sha256};
use tempfile::NamedTempFile;

use super::manifest::{digest, digest_of, hexadecimal};

/// Begin of temporary names, after which six letters or digits follow.
const PREFIX: &str = ".palpate-";
const RANDOM: usize = 6;
/// Symbolic links that are followed one after another.
const MOST_LINKS: usize = 40;

/// Contents of a file that is to be written.
pub(crate) enum Contents<'a> {
    /// Bytes in memory.
    Bytes(&'a [u8]),
    /// Bytes that are on disk already.
    Draft(Draft),
}

/// Contents that are written beside the file that they are for, piece by piece.
pub(crate) struct Draft {
    file: BufWriter<NamedTempFile>,
    sha256: Sha256,
    length: u64,
    /// First bytes.
    head: Vec<u8>,
}

/// Bytes by which the kind of a file is known.
const HEAD: usize = 1 << 16;

impl Draft {
    /// Draft beside the file at `path`, or beside that to which links lead from there.
    pub(crate) fn new(path: &Path) -> Result<Self, Error> {
        let file = followed(path).and_then(|target| locked(folder_of(&target)));
        let file = file.with_context(|| format!("cannot write {}", path.display()))?;
        Ok(Self {
            file: BufWriter::with_capacity(1 << 18, file),
            sha256: Sha256::new(),
            length: 0,
            head: Vec::new(),
        })
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write_all(bytes)?;
        self.sha256.update(bytes);
        self.length += bytes.len() as u64;
        let missing = HEAD.saturating_sub(self.head.len()).min(bytes.len());
        self.head.extend_from_slice(&bytes[..missing]);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Contents<'_> {
    /// First bytes, by which the kind of the file is known.
    pub(crate) fn head(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Draft(draft) => &draft.head,
        }
    }

    /// SHA-256.
    pub(crate) fn digest(&self) -> String {
        match self {
            Self::Bytes(bytes) => digest(bytes),
            Self::Draft(draft) => hexadecimal(draft.sha256.clone().finalize().as_slice()),
        }
    }

    /// Whether a file holds exactly these contents, or nothing that could be lost.
    pub(crate) fn are_in(&self, path: &Path) -> bool {
        match self {
            Self::Bytes(bytes) => holds(path, bytes),
            Self::Draft(draft) => {
                let length = fs::metadata(path).map_or(0, |found| found.len());
                let is_same = || digest_of(path).is_ok_and(|known| known == self.digest());
                length == 0 || length == draft.length && is_same()
            }
        }
    }
}

/// Whether a file holds exactly these contents, or nothing that could be lost.
pub(crate) fn holds(path: &Path, contents: &[u8]) -> bool {
    let length = fs::metadata(path).map_or(0, |found| found.len());
    length == 0
        || length == contents.len() as u64 && fs::read(path).is_ok_and(|known| known == contents)
}

/// Contents that wait for their place.
pub(crate) struct Staged<'a> {
    /// Path as messages name it.
    shown: PathBuf,
    place: Place<'a>,
}

enum Place<'a> {
    /// Contents on disk, and the file itself, to which links lead.
    File(NamedTempFile, PathBuf),
    /// Pipe, device or open file, and what is written into it.
    Stream(Contents<'a>),
}

impl<'a> Staged<'a> {
    /// Writes contents beside the file at `path`, or beside that to which links lead from there; a stream waits.
    pub(crate) fn new(path: &Path, contents: Contents<'a>) -> Result<Self, Error> {
        let shown = path.to_owned();
        if is_stream(path) {
            let place = Place::Stream(contents);
            return Ok(Self { shown, place });
        }
        let stage = move || -> io::Result<Place<'a>> {
            let target = followed(path)?;
            let file = match contents {
                Contents::Bytes(bytes) => {
                    let mut file = locked(folder_of(&target))?;
                    file.as_file_mut().write_all(bytes)?;
                    file
                }
                Contents::Draft(draft) => draft.file.into_inner()?,
            };
            file.as_file().sync_all()?;
            let known = fs::metadata(&target).ok().map(|found| found.permissions());
            set_readable(file.as_file(), known)?;
            Ok(Place::File(file, target))
        };
        let place = stage().with_context(|| format!("cannot write {}", path.display()))?;
        Ok(Self { shown, place })
    }

    /// Gives the contents their name, or writes them into the stream; a reader that closes a pipe early is no error.
    pub(crate) fn persist(self) -> Result<(), Error> {
        let Self { shown, place } = self;
        let cannot = || format!("cannot write {}", shown.display());
        match place {
            Place::File(_, target) if fs::metadata(&target).is_ok_and(|found| !found.is_file()) => {
                Err(anyhow!("is no regular file")).with_context(cannot)
            }
            Place::File(file, target) => {
                let persisted = file.persist(&target).map_err(|error| error.error);
                persisted.map(drop).with_context(cannot)
            }
            Place::Stream(contents) => {
                // What an open file holds stays.
                let file = OpenOptions::new().append(true).open(&shown);
                let write = |mut file: File| match contents {
                    Contents::Bytes(bytes) => file.write_all(bytes),
                    Contents::Draft(draft) => {
                        let mut draft = draft.file.into_inner()?;
                        draft.rewind()?;
                        io::copy(&mut draft, &mut file).map(drop)
                    }
                };
                match file.and_then(write) {
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
                    wrote => wrote.with_context(cannot),
                }
            }
        }
    }
}

/// Whether a path leads to a pipe, a device or an open file, which is written into and keeps its name.
pub(crate) fn is_stream(path: &Path) -> bool {
    let is_descriptor = |folder: &Path| {
        folder == Path::new("/dev/fd") || folder.starts_with("/proc") && folder.ends_with("fd")
    };
    let is_open = path == Path::new("/dev/stderr") || path.parent().is_some_and(is_descriptor);
    fs::metadata(path).is_ok_and(|found| !found.is_dir() && (is_open || !found.is_file()))
}

/// Why nothing is written to a path, if it is one of a directory or of a disk.
pub(crate) fn unwritable(path: &Path) -> Option<&'static str> {
    let found = fs::metadata(path).ok()?;
    if found.is_dir() {
        return Some("is a directory");
    }
    is_disk(&found).then_some("is a disk")
}

#[cfg(unix)]
fn is_disk(found: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    found.file_type().is_block_device()
}

#[cfg(not(unix))]
fn is_disk(_: &fs::Metadata) -> bool {
    false
}

/// Folder in which a file lies.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Removes temporary files that no process has locked any more.
pub(crate) fn sweep(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let is_temporary = entry.file_name().to_str().is_some_and(|name| {
            name.strip_prefix(PREFIX).is_some_and(|random| {
                random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
            })
        });
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if !is_temporary || !is_file {
            continue;
        }
        if let Ok(file) = File::open(entry.path())
            && file.try_lock().is_ok()
        {
            // Whether another process was quicker is no matter.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether an open file still has this name.
pub(crate) fn is_named(file: &File, path: &Path) -> bool {
    let open = file.try_clone().and_then(Handle::from_file);
    matches!((open, Handle::from_path(path)), (Ok(open), Ok(named)) if open == named)
}

/// Temporary file that no sweep removes while this process lives.
fn locked(folder: &Path) -> io::Result<NamedTempFile> {
    loop {
        let file = tempfile::Builder::new()
            .prefix(PREFIX)
            .rand_bytes(RANDOM)
            .tempfile_in(folder)?;
        // Where there are no locks, nothing is swept up.
        let is_locked = file.as_file().lock().is_ok();
        if !is_locked || is_named(file.as_file(), file.path()) {
            return Ok(file);
        }
    }
}

/// File to which symbolic links lead from a path; it need not be there.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            Ok(link) => path = folder_of(&path).join(link),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Temporary files are private; results are not, unless they replace what is.
#[cfg(unix)]
fn set_readable(file: &File, known: Option<Permissions>) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(known.unwrap_or(Permissions::from_mode(0o644)))
}

#[cfg(not(unix))]
fn set_readable(_: &File, _: Option<Permissions>) -> io::Result<()> {
    Ok(())
}
