//! Reading of files of bounded size.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Bytes of a MiB.
const MIB: u64 = 1 << 20;
/// Most that is read of a pipe or a device, whose size is not known before, MiB.
const MOST_OF_A_STREAM: u64 = 256;

/// Bytes of a file of at most `most_mib` MiB; of a pipe or a device, 256 MiB at most.
///
/// # Errors
/// Errors of the operating system; [`ErrorKind::FileTooLarge`].
pub fn read_limited(path: &Path, most_mib: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let known = file.metadata()?;
    let most_mib = match known.is_file() {
        true => most_mib,
        false => most_mib.min(MOST_OF_A_STREAM),
    };
    let limit = most_mib * MIB;
    let too_large = || {
        let message = format!("it is larger than {most_mib} MiB, the most that is read");
        io::Error::new(ErrorKind::FileTooLarge, message)
    };
    if known.is_file() && known.len() > limit {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes)?;
    match bytes.len() as u64 > limit {
        true => Err(too_large()),
        false => Ok(bytes),
    }
}
