//! Recorded files: the bytes of a file, and its name in messages.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use palpate_study::{read_all, read_limited};

use super::error::RecordedError;
use super::table_format::Form;

/// Largest size of a recorded file, MiB.
const MAX_MIB: u64 = 256;
/// If a table of delimited text is larger than this size (bytes), only its first lines are kept in memory, up to this
/// size. The other lines are read one by one.
const MAX_START: u64 = 64 << 20;
/// Longest line of a table that is read line by line, in bytes. A longer line is split, so its rows are then rejected.
const MAX_LINE: u64 = 1 << 20;

/// First bytes of files that are not text, with the name of the format.
const FORMATS: [(&[u8], &str); 19] = [
    (b"\x1f\x8b", "is compressed by gzip; decompress it"),
    (b"PAR1", "is a Parquet file; save its table as CSV"),
    (b"\x89HDF", "is an HDF5 file; save its table as CSV"),
    (b"\x80", "is a pickle of Python; save its table as CSV"),
    (b"MATLAB 5", "is a MATLAB file; save its table as CSV"),
    (
        b"\xd0\xcf\x11\xe0",
        "is an Excel file; save its table as CSV",
    ),
    (b"BZh", "is compressed by bzip2; decompress it"),
    (b"\xfd7zXZ", "is compressed by xz; decompress it"),
    (b"\x28\xb5\x2f\xfd", "is compressed by zstd; decompress it"),
    (b"7z\xbc\xaf", "is a 7z archive; unpack it"),
    (b"SQLite", "is a database; save one of its tables as CSV"),
    (b"#ROSBAG", "is a ROS bag; save one topic as CSV"),
    (b"\x89MCAP", "is an MCAP log; save one topic as CSV"),
    (b"header: \n", "is YAML; `rostopic echo -p` writes CSV"),
    (b"header:\n", "is YAML; `ros2 topic echo --csv` writes CSV"),
    (b"ply\n", "is a PLY cloud; save its points as CSV"),
    (b"# .PCD", "is a PCD cloud; save its points as CSV"),
    (b"<?xml", "is XML; save its table as CSV"),
    (b"<html", "is HTML; save its table as CSV"),
];

/// A recorded file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedFile {
    /// Name of the file in messages.
    pub name: String,
    /// Content of the file. In JSON, the tokens `NaN`, `Infinity` and `-Infinity` have been put in quotation marks,
    /// because JSON has no such numbers.
    pub bytes: Vec<u8>,
    /// Settings that describe the form of the file's table.
    pub form: Form,
    /// The file from which the lines after `bytes` are read; `None` if `bytes` is the whole file.
    rest: Option<PathBuf>,
}

impl RecordedFile {
    /// A recorded file whose bytes are already in memory.
    pub fn new(name: impl Into<String>, bytes: Vec<u8>) -> Self {
        Self {
            name: name.into(),
            bytes: without_nan(bytes),
            form: Form::default(),
            rest: None,
        }
    }

    /// Reads a file. Of a large table of delimited text, only the first lines are read into memory.
    ///
    /// # Errors
    /// [`RecordedError::File`] if the file does not exist or cannot be read.
    pub fn read(path: &Path) -> Result<Self, RecordedError> {
        let name = path.display().to_string();
        let mut file = Self::new(name.clone(), Vec::new());
        if let Some(start) = start_of_text(path) {
            (file.bytes, file.rest) = (start, Some(path.to_owned()));
            return Ok(file);
        }
        let bytes = read_limited(path, MAX_MIB).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => file.error("no such file"),
            std::io::ErrorKind::IsADirectory => file.error("is a directory, not a file"),
            _ => file.error(format!("cannot be read: {error}")),
        })?;
        Ok(Self::new(name, bytes))
    }

    /// Reads a stream, such as standard input, to its end. `name` is the name of the stream in messages.
    ///
    /// # Errors
    /// [`RecordedError::File`] if the stream cannot be read, or if it is larger than the limit for files.
    pub fn read_stream(name: &str, stream: impl Read) -> Result<Self, RecordedError> {
        let bytes = read_all(stream, MAX_MIB).map_err(|error| {
            Self::new(name, Vec::new()).error(format!("cannot be read: {error}"))
        })?;
        Ok(Self::new(name, bytes))
    }

    pub(super) fn error(&self, message: impl Into<String>) -> RecordedError {
        RecordedError::File {
            file: self.name.clone(),
            message: message.into(),
        }
    }

    pub(super) fn fail(&self, line: usize, message: impl Into<String>) -> RecordedError {
        RecordedError::line(&self.name, line, message)
    }

    /// The file's UTF-8 text, without the byte order mark. If the file is empty, the error message states the expected
    /// contents `needed`.
    pub(super) fn text(&self, needed: &str) -> Result<&str, RecordedError> {
        match self.rest {
            Some(_) => Err(self.error(format!("is larger than {} MiB; {needed}", MAX_START >> 20))),
            None => self.start(needed),
        }
    }

    /// The part of the text that is in memory, which is the whole text unless the file is large.
    pub(super) fn start(&self, needed: &str) -> Result<&str, RecordedError> {
        let bytes = self.bytes.as_slice();
        let mut formats = FORMATS.iter();
        if let Some((_, message)) = formats.find(|(magic, _)| bytes.starts_with(magic)) {
            return Err(self.error(*message));
        }
        if bytes.contains(&0) {
            return Err(
                self.error("has bytes 0, so it is UTF-16 text or no text; save it as UTF-8")
            );
        }
        let text = self.utf8(bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes), 1)?;
        if text.trim().is_empty() {
            return Err(self.error(format!("is empty; {needed}")));
        }
        Ok(text)
    }

    /// Calls `take` with each line after [`start`](Self::start), and with the number of the line. `line` is the number of
    /// the first of these lines. The lines end with `end`.
    pub(super) fn rest(
        &self,
        (mut line, end): (usize, char),
        mut take: impl FnMut(&str, usize) -> Result<(), RecordedError>,
    ) -> Result<(), RecordedError> {
        let Some(path) = &self.rest else {
            return Ok(());
        };
        let fail = |error: std::io::Error| self.error(format!("cannot be read: {error}"));
        let mut file = File::open(path).map_err(fail)?;
        file.seek(SeekFrom::Start(self.bytes.len() as u64))
            .map_err(fail)?;
        let (mut file, mut bytes) = (BufReader::new(file), Vec::new());
        loop {
            bytes.clear();
            let mut limited = (&mut file).take(MAX_LINE);
            if limited.read_until(end as u8, &mut bytes).map_err(fail)? == 0 {
                return Ok(());
            }
            take(self.utf8(&bytes, line)?.trim_end_matches(end), line)?;
            line += 1;
        }
    }

    /// The text `bytes`, which begins at the line `first`.
    fn utf8<'a>(&self, bytes: &'a [u8], first: usize) -> Result<&'a str, RecordedError> {
        std::str::from_utf8(bytes).map_err(|error| {
            let (before, rest) = bytes.split_at(error.valid_up_to());
            let line = before.iter().filter(|&&byte| byte == b'\n').count() + first;
            let byte = rest.first().copied().unwrap_or_default();
            self.error(format!(
                "is not UTF-8 text: byte 0x{byte:02x} in line {line}; save it as UTF-8"
            ))
        })
    }
}

/// Puts quotation marks around the tokens that Python writes into JSON for numbers that are not finite. JSON has no such
/// tokens. Rows with these texts are left out.
fn without_nan(bytes: Vec<u8>) -> Vec<u8> {
    if !is_json(&bytes) {
        return bytes;
    }
    let tokens: [&[u8]; 3] = [b"NaN", b"Infinity", b"-Infinity"];
    let (mut is_text, mut place, mut copied) = (false, 0, 0);
    let mut changed = Vec::new();
    while place < bytes.len() {
        match bytes[place] {
            b'\\' if is_text => place += 1,
            b'"' => is_text = !is_text,
            b'N' | b'I' | b'-' if !is_text => {
                let mut tokens = tokens.iter();
                if let Some(token) = tokens.find(|token| bytes[place..].starts_with(token)) {
                    changed.extend_from_slice(&bytes[copied..place]);
                    changed.extend([b"\"", *token, b"\""].concat());
                    place += token.len() - 1;
                    copied = place + 1;
                }
            }
            _ => {}
        }
        place += 1;
    }
    if changed.is_empty() {
        return bytes;
    }
    changed.extend_from_slice(&bytes[copied..]);
    changed
}

/// Whether the text begins like JSON, apart from comments.
fn is_json(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut start = start.trim_ascii_start();
    while start.starts_with(b"#") || start.starts_with(b"%") || start.starts_with(b"//") {
        let end = start.iter().position(|byte| *byte == b'\n');
        start = start[end.unwrap_or(start.len())..].trim_ascii_start();
    }
    start.starts_with(b"{") || start.starts_with(b"[")
}

/// The first lines of a large file of delimited text; `None` for other files.
fn start_of_text(path: &Path) -> Option<Vec<u8>> {
    let file = File::open(path).ok()?;
    let metadata = file.metadata().ok()?;
    if !metadata.is_file() || metadata.len() <= MAX_START {
        return None;
    }
    let mut bytes = Vec::new();
    file.take(MAX_START).read_to_end(&mut bytes).ok()?;
    let last = |end: u8| bytes.iter().rposition(|&byte| byte == end);
    let end = last(b'\n').or_else(|| last(b'\r'))? + 1;
    bytes.truncate(end);
    let is_text = !bytes.contains(&0) && !is_json(&bytes) && std::str::from_utf8(&bytes).is_ok();
    is_text.then_some(bytes)
}
