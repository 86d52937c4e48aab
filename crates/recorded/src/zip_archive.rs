//! Reads the files in a zip archive. Each file is stored without compression or compressed by deflate, as `np.savez`
//! and `np.savez_compressed` write them.

use std::borrow::Cow;

use miniz_oxide::inflate::decompress_to_vec_with_limit;

/// Largest total size of the files in an archive, MiB.
const MAX_MIB: usize = 256;
/// Size of the record at the end of an archive, bytes. A comment may follow this record.
const END: usize = 22;
/// Largest size of the comment at the end of an archive, bytes.
const MAX_COMMENT: usize = 65_535;

/// Name and contents of a file in an archive.
pub(super) type Member<'a> = (String, Cow<'a, [u8]>);

/// Returns all files of an archive, in the order of the archive.
pub(super) fn members(bytes: &[u8]) -> Result<Vec<Member<'_>>, String> {
    let truncated = || "is not a valid zip archive: it is truncated".to_owned();
    let last = bytes.len().checked_sub(END).ok_or_else(truncated)?;
    let mut ends = (last.saturating_sub(MAX_COMMENT)..=last).rev();
    let end = ends.find(|&at| bytes[at..].starts_with(b"PK\x05\x06"));
    let end = &bytes[end.ok_or_else(truncated)?..];
    let count = number(end, 10, 2).ok_or_else(truncated)?;
    let mut at = number(end, 16, 4).ok_or_else(truncated)?;
    let (mut members, mut total) = (Vec::new(), 0_usize);
    for _ in 0..count {
        let entry = bytes.get(at..).ok_or_else(truncated)?;
        let field = |at, size| number(entry, at, size).ok_or_else(truncated);
        let [name_length, extra, comment] = [field(28, 2)?, field(30, 2)?, field(32, 2)?];
        let name = entry.get(46..46 + name_length).ok_or_else(truncated)?;
        let name = String::from_utf8_lossy(name).into_owned();
        let [packed, size] = [field(20, 4)?, field(24, 4)?];
        total = total.saturating_add(size);
        if total > MAX_MIB << 20 {
            return Err(format!("unpacks to more than {MAX_MIB} MiB"));
        }
        let local = bytes.get(field(42, 4)?..).ok_or_else(truncated)?;
        let [name_length, extra_length] = [26, 28].map(|at| number(local, at, 2));
        let start = name_length
            .zip(extra_length)
            .map(|(name, extra)| 30 + name + extra);
        let data = start
            .and_then(|start| local.get(start..start + packed))
            .ok_or_else(truncated)?;
        let contents = match field(10, 2)? {
            0 => Some(Cow::Borrowed(data)),
            8 => decompress_to_vec_with_limit(data, size)
                .ok()
                .map(Cow::Owned),
            method => {
                return Err(format!(
                    "packs `{name}` by method {method}; use np.savez or np.savez_compressed"
                ));
            }
        };
        let checksum = field(16, 4)?;
        let is_sound = |contents: &Cow<'_, [u8]>| crc32fast::hash(contents) as usize == checksum;
        let contents = contents.filter(is_sound);
        let contents =
            contents.ok_or_else(|| format!("is not a valid zip archive: `{name}` is damaged"))?;
        members.push((name, contents));
        at +=
            46 + [extra, comment].iter().sum::<usize>() + number(entry, 28, 2).unwrap_or_default();
    }
    Ok(members)
}

/// A number of `size` bytes; the first byte is the lowest (little-endian).
fn number(bytes: &[u8], at: usize, size: usize) -> Option<usize> {
    let bytes = bytes.get(at..at + size)?.iter().rev();
    Some(bytes.fold(0, |number, &byte| number << 8 | usize::from(byte)))
}
