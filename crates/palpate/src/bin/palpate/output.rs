//! Files and standard output, written whole or not at all.

use std::io::{ErrorKind, Write};
use std::path::Path;

use anyhow::{Context, Error, anyhow};
use serde::Serialize;
use tempfile::NamedTempFile;

use crate::failure::Failure;

/// Name of a run's config, beside its tables.
pub(crate) const CONFIG: &str = "run.toml";
/// Name of a run's config while tables of another config stand there.
pub(crate) const NEXT_CONFIG: &str = "next-run.toml";
/// The table without which there are no results.
const TABLE: &str = "cells.csv";

/// Prints a text and a newline; a closed pipe is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match writeln!(stdout, "{text}").and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::work(
            Error::new(error).context("cannot write to standard output"),
        )),
        _ => Ok(()),
    }
}

/// Makes `dir` if it is missing, and sees that files can be written there: before the work, not
/// after it.
pub(crate) fn make_directory(dir: &Path) -> Result<(), Failure> {
    if let Some(file) = dir.ancestors().find(|place| place.is_file()) {
        let (dir, file) = (dir.display(), file.display());
        return Err(Failure::work(anyhow!(
            "cannot make the directory {dir}: {file} is a file"
        )));
    }
    std::fs::create_dir_all(dir)
        .with_context(|| format!("cannot make the directory {}", dir.display()))
        .and_then(|()| {
            let probe = NamedTempFile::with_prefix_in(".palpate-", dir);
            probe
                .map(drop)
                .with_context(|| format!("cannot write into {}", dir.display()))
        })
        .map_err(Failure::work)
}

/// Writes the config of a run that begins into `dir`: beside no tables but its own. Where `dir` has those of another
/// config, or another config, they stay until the run is done, and this one's is [`NEXT_CONFIG`].
pub(crate) fn begin(dir: &Path, config: &str) -> Result<(), Failure> {
    let has_others = [TABLE, CONFIG].iter().any(|name| dir.join(name).exists());
    let known = std::fs::read(dir.join(CONFIG)).is_ok_and(|known| known == config.as_bytes());
    match (known, has_others) {
        (true, _) => Ok(()),
        (false, true) => write_files(dir, &[(NEXT_CONFIG, config)]),
        (false, false) => write_files(dir, &[(CONFIG, config)]),
    }
}

/// The run that began is over: its config has its name, or its tables could not be written.
pub(crate) fn end(dir: &Path) -> Result<(), Failure> {
    match std::fs::remove_file(dir.join(NEXT_CONFIG)) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Failure::work(
            Error::new(error).context(format!("cannot remove {NEXT_CONFIG}")),
        )),
        _ => Ok(()),
    }
}

/// Writes `files` (name and contents) into `dir`, made if missing.
///
/// All are written under temporary names first and renamed only when every byte is on disk, so that
/// a full disk leaves what was there before.
pub(crate) fn write_files<C: AsRef<[u8]>>(dir: &Path, files: &[(&str, C)]) -> Result<(), Failure> {
    make_directory(dir)?;
    let write = || -> Result<(), Error> {
        let cannot = |name: &str| format!("cannot write {}", dir.join(name).display());
        let mut written = Vec::new();
        for (name, contents) in files {
            let mut file =
                NamedTempFile::with_prefix_in(".palpate-", dir).with_context(|| cannot(name))?;
            file.as_file_mut()
                .write_all(contents.as_ref())
                .with_context(|| cannot(name))?;
            file.as_file().sync_all().with_context(|| cannot(name))?;
            written.push((name, file));
        }
        for (name, file) in written {
            set_readable(&file).with_context(|| cannot(name))?;
            file.persist(dir.join(name))
                .map_err(|error| error.error)
                .with_context(|| cannot(name))?;
        }
        Ok(())
    };
    write().map_err(Failure::work)
}

/// Writes one file, whose folder is made if missing, likewise.
pub(crate) fn write_file(path: &Path, contents: &str) -> Result<(), Failure> {
    let name = path.file_name().and_then(std::ffi::OsStr::to_str);
    let name = name.ok_or_else(|| Failure::work(anyhow!("{} names no file", path.display())))?;
    let dir = match path.parent() {
        Some(dir) if !dir.as_os_str().is_empty() => dir,
        _ => Path::new("."),
    };
    write_files(dir, &[(name, contents)]).map_err(|failure| {
        let (Failure::Usage(error) | Failure::Work(error)) = failure;
        Failure::Work(error.context(format!("cannot write {}", path.display())))
    })
}

/// Temporary files are private; results are not.
fn set_readable(file: &NamedTempFile) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file()
            .set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    let _ = file;
    Ok(())
}

/// An estimate as JSON, one value per line; zero has no sign.
pub(crate) fn json(estimate: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(estimate).map_err(Failure::work)?;
    let lines = text.lines().map(|line| {
        let (value, comma) = match line.strip_suffix(',') {
            Some(value) => (value, ","),
            None => (line, ""),
        };
        // A string would end in a quotation mark.
        match value.strip_suffix("-0.0") {
            Some(key) => format!("{key}0.0{comma}"),
            None => line.to_owned(),
        }
    });
    Ok(lines.collect::<Vec<_>>().join("\n"))
}

/// A picture as a PNG file.
pub(crate) fn png(picture: &image::RgbImage) -> Result<Vec<u8>, Failure> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, image::ImageFormat::Png)
        .context("cannot write a picture as PNG")
        .map_err(Failure::work)?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn zero_has_no_sign() {
        let estimate = BTreeMap::from([("a", vec![-0.0, 1.0, -0.0]), ("b", vec![-0.5])]);
        assert_eq!(
            json(&estimate).unwrap(),
            "{\n  \"a\": [\n    0.0,\n    1.0,\n    0.0\n  ],\n  \"b\": [\n    -0.5\n  ]\n}"
        );
        assert_eq!(
            json(&BTreeMap::from([("a", -0.0)])).unwrap(),
            "{\n  \"a\": 0.0\n}"
        );
        let words = "{\n  \"a\": \"of -0.0\"\n}";
        assert_eq!(json(&BTreeMap::from([("a", "of -0.0")])).unwrap(), words);
    }
}
