//! Reads files and streams up to a maximum size.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

const MIB: u64 = 1 << 20;
/// Largest number of MiB that is read from a pipe or a device. This limit is needed because the size of a pipe or a
/// device is unknown before it is read.
const MAX_STREAM_MIB: u64 = 256;

/// Reads a file of at most `most_mib` MiB. If the path is a pipe or a device, at most 256 MiB are read.
///
/// # Errors
/// Errors of the operating system; [`ErrorKind::FileTooLarge`] if the file is larger than the limit.
pub fn read_limited(path: &Path, most_mib: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    let most_mib = match metadata.is_file() {
        true => most_mib,
        false => most_mib.min(MAX_STREAM_MIB),
    };
    if metadata.is_file() && metadata.len() > most_mib * MIB {
        return Err(too_large(most_mib));
    }
    read_all(file, most_mib)
}

/// Reads a stream of at most `most_mib` MiB.
///
/// # Errors
/// Errors of the stream; [`ErrorKind::FileTooLarge`] if the stream is longer than the limit.
pub fn read_all(stream: impl Read, most_mib: u64) -> io::Result<Vec<u8>> {
    let limit = most_mib * MIB;
    let mut bytes = Vec::new();
    stream.take(limit + 1).read_to_end(&mut bytes)?;
    match bytes.len() as u64 > limit {
        true => Err(too_large(most_mib)),
        false => Ok(bytes),
    }
}

fn too_large(most_mib: u64) -> io::Error {
    let message = format!("it is larger than the limit of {most_mib} MiB");
    io::Error::new(ErrorKind::FileTooLarge, message)
}
