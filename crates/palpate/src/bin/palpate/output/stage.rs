//! Contents under temporary names, locked by the process that writes them.

use std::fs::{self, File, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, anyhow};
use same_file::Handle;
use tempfile::NamedTempFile;

/// Begin of temporary names, after which six letters or digits follow.
const PREFIX: &str = ".palpate-";
const RANDOM: usize = 6;
/// Symbolic links that are followed one after another.
const MOST_LINKS: usize = 40;

/// Contents that are on disk and wait for their name.
pub(crate) struct Staged {
    file: NamedTempFile,
    /// Path as messages name it.
    shown: PathBuf,
    /// The file itself, to which links lead.
    target: PathBuf,
}

impl Staged {
    /// Writes contents beside the file at `path`, or beside that to which links lead from there.
    pub(crate) fn new(path: &Path, contents: &[u8]) -> Result<Self, Error> {
        let stage = || -> io::Result<Self> {
            let target = followed(path)?;
            let mut file = locked(folder_of(&target))?;
            file.as_file_mut().write_all(contents)?;
            file.as_file().sync_all()?;
            let known = fs::metadata(&target).ok().map(|found| found.permissions());
            set_readable(file.as_file(), known)?;
            Ok(Self {
                file,
                shown: path.to_owned(),
                target,
            })
        };
        stage().with_context(|| format!("cannot write {}", path.display()))
    }

    /// Gives the contents their name.
    pub(crate) fn persist(self) -> Result<(), Error> {
        let cannot = || format!("cannot write {}", self.shown.display());
        if fs::metadata(&self.target).is_ok_and(|found| !found.is_file()) {
            return Err(anyhow!("is no regular file")).with_context(cannot);
        }
        let persisted = self.file.persist(&self.target);
        persisted
            .map(drop)
            .map_err(|error| error.error)
            .with_context(|| format!("cannot write {}", self.shown.display()))
    }
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
