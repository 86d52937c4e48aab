//! Reading of files of bounded size.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Bytes of a MiB.
const MIB: u64 = 1 << 20;

/// Bytes of a file of at most `most_mib` MiB; of a pipe or a device no more is read.
///
/// # Errors
/// Those of the operating system; [`ErrorKind::FileTooLarge`].
pub fn read_limited(path: &Path, most_mib: u64) -> io::Result<Vec<u8>> {
    let limit = most_mib * MIB;
    let too_large = || {
        let message = format!("it is larger than {most_mib} MiB, the most that is read");
        io::Error::new(ErrorKind::FileTooLarge, message)
    };
    let file = File::open(path)?;
    let known = file.metadata()?;
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
