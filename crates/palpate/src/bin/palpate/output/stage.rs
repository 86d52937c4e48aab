//! Writes files under temporary names until they are complete. The process holds a lock on each temporary file.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, BufWriter, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, anyhow};
use same_file::Handle;
use sha2::{Digest, Sha256};
use tempfile::NamedTempFile;

use super::manifest::{digest, digest_of, hexadecimal};

/// Prefix of temporary file names; six random letters or digits follow.
const PREFIX: &str = ".palpate-";
const RANDOM: usize = 6;
const MAX_LINKS: usize = 40;

pub(crate) enum Contents<'a> {
    Bytes(&'a [u8]),
    Draft(Draft),
}

/// Temporary file for new contents that are written piece by piece. The temporary file is in the same directory as the
/// final file.
pub(crate) struct Draft {
    file: BufWriter<NamedTempFile>,
    sha256: Sha256,
    length: u64,
    /// First bytes of the file, up to [`HEAD_BYTES`].
    head: Vec<u8>,
}

/// Number of bytes at the beginning of the file that a draft keeps in memory. These bytes show the kind of the file.
const HEAD_BYTES: usize = 1 << 16;

impl Draft {
    /// Starts a draft for the file at `path`, in the same directory. If `path` is a symbolic link, the draft is in the
    /// directory of the link's target.
    pub(crate) fn new(path: &Path) -> Result<Self, Error> {
        let file = link_target(path).and_then(|target| locked_file(folder_of(&target)));
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
        let missing = HEAD_BYTES.saturating_sub(self.head.len()).min(bytes.len());
        self.head.extend_from_slice(&bytes[..missing]);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Contents<'_> {
    pub(crate) fn head(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Draft(draft) => &draft.head,
        }
    }

    pub(crate) fn digest(&self) -> String {
        match self {
            Self::Bytes(bytes) => digest(bytes),
            Self::Draft(draft) => hexadecimal(draft.sha256.clone().finalize().as_slice()),
        }
    }

    /// Whether the file at `path` may be replaced without loss: it has exactly these contents, is empty, or is
    /// missing.
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

pub(crate) fn holds(path: &Path, contents: &[u8]) -> bool {
    let length = fs::metadata(path).map_or(0, |found| found.len());
    length == 0
        || length == contents.len() as u64 && fs::read(path).is_ok_and(|known| known == contents)
}

pub(crate) struct StagedFile<'a> {
    shown: PathBuf,
    place: Place<'a>,
}

enum Place<'a> {
    /// Temporary file, and the path of the final file with all symbolic links resolved.
    File(NamedTempFile, PathBuf),
    /// Contents that will be written directly into a pipe, a device or an open file.
    Stream(Contents<'a>),
}

impl<'a> StagedFile<'a> {
    /// Writes the contents to a temporary file in the directory of `path`. If `path` is a symbolic link, the directory
    /// of its target is used. If `path` is a pipe or a device, [`Self::persist`] writes the contents later.
    pub(crate) fn new(path: &Path, contents: Contents<'a>) -> Result<Self, Error> {
        let shown = path.to_owned();
        if is_stream(path) {
            let place = Place::Stream(contents);
            return Ok(Self { shown, place });
        }
        let stage = move || -> io::Result<Place<'a>> {
            let target = link_target(path)?;
            let file = match contents {
                Contents::Bytes(bytes) => {
                    let mut file = locked_file(folder_of(&target))?;
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

    /// Renames the file to its final name, or writes into the pipe or device. It is not an error if the reader of a
    /// pipe closes the pipe early.
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
                // Append, because the stream may be a file to which an earlier command has already written.
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

/// Whether a path names a pipe, a device or an open file. Palpate writes into such a path instead of replacing it.
pub(crate) fn is_stream(path: &Path) -> bool {
    let is_descriptor = |folder: &Path| {
        folder == Path::new("/dev/fd") || folder.starts_with("/proc") && folder.ends_with("fd")
    };
    let is_open = path == Path::new("/dev/stderr") || path.parent().is_some_and(is_descriptor);
    fs::metadata(path).is_ok_and(|found| !found.is_dir() && (is_open || !found.is_file()))
}

/// Reason why a path cannot be written: it is a directory or a block device.
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

pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Removes temporary files that ended processes left in a directory. No process holds the lock of such a file.
pub(crate) fn remove_abandoned(folder: &Path) {
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
            // Ignore an error, because another process may already have removed the file.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether `path` still names the open file `file`. Another process may have renamed or removed this file.
pub(crate) fn is_named(file: &File, path: &Path) -> bool {
    let open = file.try_clone().and_then(Handle::from_file);
    matches!((open, Handle::from_path(path)), (Ok(open), Ok(named)) if open == named)
}

/// Creates a temporary file and locks it. The lock shows other processes that the file is still in use.
fn locked_file(folder: &Path) -> io::Result<NamedTempFile> {
    loop {
        let file = tempfile::Builder::new()
            .prefix(PREFIX)
            .rand_bytes(RANDOM)
            .tempfile_in(folder)?;
        // Only a lock shows that a temporary file is still in use. On a file system without locks, no process removes
        // abandoned files, so the file does not need a lock there.
        let is_locked = file.as_file().lock().is_ok();
        if !is_locked || is_named(file.as_file(), file.path()) {
            return Ok(file);
        }
    }
}

/// The path to which the symbolic links at `path` lead. The file at the end of the links need not exist.
fn link_target(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(link) => path = folder_of(&path).join(link),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Gives a new file the permissions `known` of the file that it replaces. Without an old file, the new file becomes
/// readable for all users. A temporary file, as created by `tempfile`, is readable only for its owner.
#[cfg(unix)]
fn set_readable(file: &File, known: Option<Permissions>) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(known.unwrap_or(Permissions::from_mode(0o644)))
}

#[cfg(not(unix))]
fn set_readable(_: &File, _: Option<Permissions>) -> io::Result<()> {
    Ok(())
}
