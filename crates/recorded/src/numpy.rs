//! Tables in files of NumPy. A `.npy` file contains an array, and an `.npz` file contains several arrays, which are
//! columns of the table.

use std::borrow::Cow;
use std::io::{Cursor, Read as _};

use csv::StringRecord;
use zip::ZipArchive;
use zip::result::ZipError;

use super::error::RecordedError;
use super::file::RecordedFile;
use super::heading::{Heading, tip_radius_factor};
use super::json_table::MAX_FINGERS;
use super::text_table::{Record, RowResult};

const MAGIC: &[u8] = b"\x93NUMPY";
const MAX_COLUMNS: usize = 1_000;

/// Type of the elements of a NumPy array: letter, size in bytes and byte order.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scalar {
    letter: char,
    size: usize,
    is_big_endian: bool,
}

impl Scalar {
    /// Type with the NumPy name `name`, such as `<f8`. `None` if the type is neither a number nor text.
    fn of(name: &str) -> Option<Self> {
        let order = name.chars().next()?;
        let name = name.trim_start_matches(['<', '>', '|', '=']);
        let letter = name.chars().next()?;
        let digits = name[letter.len_utf8()..].split('[').next()?;
        let count: usize = digits.parse().ok()?;
        let size = match (letter, count) {
            ('f', 4 | 8) | ('i' | 'u', 1 | 2 | 4 | 8) | ('b', 1) | ('M' | 'm', 8) => count,
            ('S' | 'V', 1..=1000) => count,
            ('U', 1..=1000) => 4 * count,
            _ => return None,
        };
        let is_big_endian = order == '>';
        Some(Self {
            letter,
            size,
            is_big_endian,
        })
    }

    fn text(self, bytes: &[u8]) -> String {
        let mut word = [0; 8];
        let used = self.size.min(8);
        word[..used].copy_from_slice(&bytes[..used]);
        if self.is_big_endian {
            word[..used].reverse();
        }
        let whole = u64::from_le_bytes(word);
        let unused = 64 - 8 * used as u32;
        match (self.letter, self.size) {
            ('f', 4) => number_text(f64::from(f32::from_bits(whole as u32))),
            ('f', _) => number_text(f64::from_bits(whole)),
            ('u' | 'b', _) => whole.to_string(),
            ('i' | 'm' | 'M', _) => ((whole << unused) as i64 >> unused).to_string(),
            ('U', _) => {
                let letters = bytes.as_chunks::<4>().0.iter().map(|bytes| {
                    let code = match self.is_big_endian {
                        true => u32::from_be_bytes(*bytes),
                        false => u32::from_le_bytes(*bytes),
                    };
                    char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
                });
                letters.take_while(|letter| *letter != '\0').collect()
            }
            _ => {
                let text = String::from_utf8_lossy(bytes);
                text.trim_end_matches('\0').to_owned()
            }
        }
    }
}

/// Text of a number from which exactly the same number can be read. Very large and very small numbers have an exponent.
fn number_text(number: f64) -> String {
    let size = number.abs();
    match size == 0.0 || (1e-5..1e15).contains(&size) || !size.is_finite() {
        true => number.to_string(),
        false => format!("{number:e}"),
    }
}

/// A column: elements of one of the arrays, at equal distances in memory.
struct ArrayColumn {
    array: usize,
    scalar: Scalar,
    start: usize,
    stride: usize,
}

pub(super) struct NumpyTable<'a> {
    arrays: Vec<Cow<'a, [u8]>>,
    columns: Vec<ArrayColumn>,
    pub(super) rows: usize,
}

struct Array<'a> {
    /// Name, type and number of elements of each field of a structured array. A plain array has one field without a
    /// name.
    fields: Vec<(String, Scalar, usize)>,
    is_fortran: bool,
    shape: Vec<usize>,
    data: Cow<'a, [u8]>,
}

impl<'a> NumpyTable<'a> {
    /// The table of a `.npy` or `.npz` file, with the names of its columns. The list of names is empty for an array
    /// without names. `None` if the first bytes show another file format.
    pub(super) fn of(file: &'a RecordedFile) -> Option<Result<(Self, Vec<String>), RecordedError>> {
        let bytes = file.bytes.as_slice();
        let table = match () {
            () if bytes.starts_with(MAGIC) => {
                Array::of(Cow::Borrowed(bytes)).and_then(Self::single)
            }
            () if bytes.starts_with(b"PK") => Self::archive(bytes),
            () => return None,
        };
        Some(table.map_err(|message| file.error(message)))
    }

    fn single(mut array: Array<'a>) -> Result<(Self, Vec<String>), String> {
        if array.shape.ends_with(&[4, 4]) && array.shape.len() == 3 && !array.is_fortran {
            array.shape = vec![array.shape[0], 16];
        }
        let dimensions = array.shape.len();
        let is_plain = array.fields.len() == 1 && array.fields[0].0.is_empty();
        if dimensions != if is_plain { 2 } else { 1 } {
            return Err(format!(
                "is an array of shape {}; one row per reading is needed, such as shape (30, 3)",
                array.shape_text()
            ));
        }
        let mut table = Self::empty(array.shape[0]);
        let names = table.add("", array)?;
        Ok((table, if is_plain { Vec::new() } else { names }))
    }

    /// The table of an `.npz` file. Its columns are the columns of all arrays in the file. Single numbers in the file
    /// are ignored, except the radius of a tip, which is a column with the same number in all rows.
    fn archive(bytes: &'a [u8]) -> Result<(Self, Vec<String>), String> {
        let (mut arrays, mut radii, mut is_numpy) = (Vec::new(), Vec::new(), false);
        for (name, member) in members(bytes)? {
            if name.starts_with("xl/") {
                return Err("is an Excel file; save its table as CSV".to_owned());
            }
            let Some(name) = name.strip_suffix(".npy") else {
                continue;
            };
            is_numpy = true;
            let array = Array::of(Cow::Owned(member))
                .map_err(|message| format!("array `{name}` {message}"))?;
            if array.shape.iter().any(|&length| length != 1) {
                arrays.push((name.to_owned(), array));
            } else if let ([(field, scalar, 1)], true) =
                (&array.fields[..], tip_radius_factor(name).is_some())
                && field.is_empty()
            {
                radii.push((name.to_owned(), *scalar, array.data));
            }
        }
        // Vectors, quaternions and rotation matrices have at most 9 elements. So an array with longer rows is a map (a
        // grid of values). If the file contains several maps of equal size, each map becomes a single column.
        let (first, is_map) = match arrays.first() {
            Some((_, array)) => (
                array.shape.clone(),
                array.shape[1..].iter().any(|&one| one > 9),
            ),
            None => (Vec::new(), false),
        };
        if arrays.len() > 1 && is_map && arrays.iter().all(|(_, array)| array.shape == first) {
            let is_fortran = arrays[0].1.is_fortran;
            if let Some((other, _)) = arrays.iter().find(|(_, one)| one.is_fortran != is_fortran) {
                return Err(format!(
                    "stores the maps `{}` and `{other}` in different orders (C and Fortran); apply np.ascontiguousarray before saving them",
                    arrays[0].0
                ));
            }
            let count = first.iter().product();
            arrays
                .iter_mut()
                .for_each(|(_, array)| array.shape = vec![count]);
        }
        match arrays.len() {
            0 if radii.is_empty() && !is_numpy => {
                Err("is a zip archive without arrays of NumPy; unpack it".to_owned())
            }
            0 => Err("has no array of more than one number".to_owned()),
            1 if radii.is_empty() => arrays
                .pop()
                .map_or(Err(String::new()), |(_, array)| Self::single(array)),
            _ => {
                ambiguous(&arrays)?;
                let mut table = Self::empty(arrays[0].1.shape[0]);
                let mut names = Vec::new();
                let first = arrays[0].0.clone();
                for (name, array) in arrays {
                    let [own, other] = [array.shape[0], table.rows];
                    if own != other {
                        return Err(format!(
                            "has columns of different lengths: array `{first}` has {other} rows, array `{name}` has {own}; save arrays of other lengths into another file"
                        ));
                    }
                    names.extend(table.add(&name, array)?);
                }
                for (name, scalar, data) in radii {
                    table.columns.push(ArrayColumn {
                        array: table.arrays.len(),
                        scalar,
                        start: 0,
                        stride: 0,
                    });
                    table.arrays.push(data);
                    names.push(name);
                }
                // NumPy names arrays without a name `arr_0`, `arr_1` and so on.
                let is_number = |rest: &str| rest.starts_with(|one: char| one.is_ascii_digit());
                let mut numbers = names.iter().map(|name| name.strip_prefix("arr_"));
                if numbers.all(|number| number.is_some_and(is_number)) {
                    names.clear();
                }
                Ok((table, names))
            }
        }
    }

    const fn empty(rows: usize) -> Self {
        Self {
            arrays: Vec::new(),
            columns: Vec::new(),
            rows,
        }
    }

    /// Adds the columns of an array, and returns their names. For example, `position.0` is the first column of the
    /// array `position`.
    fn add(&mut self, name: &str, array: Array<'a>) -> Result<Vec<String>, String> {
        let within = &array.shape[1..];
        let count: usize = within.iter().product();
        let fields = array.fields.iter();
        let [item, columns] = fields.fold([0, 0], |[size, columns], (_, scalar, repeats)| {
            [size + scalar.size * repeats, columns + repeats]
        });
        let mut names = Vec::new();
        if count * columns > MAX_COLUMNS {
            return Err(format!(
                "is an array of shape {}; at most {MAX_COLUMNS} columns are read",
                array.shape_text()
            ));
        }
        let stride = if array.is_fortran { 1 } else { count };
        for element in 0..count {
            // The indices of this element in all dimensions after the first. The last index varies fastest.
            let (mut steps, mut place, mut step) = (count, 0, self.rows);
            let mut suffix = String::new();
            for length in within {
                steps /= length;
                let index = element / steps % length;
                suffix += &format!(".{index}");
                place += index * step;
                step *= length;
            }
            let place = if array.is_fortran { place } else { element };
            let mut start = place * item;
            for (field, scalar, repeats) in &array.fields {
                // NumPy aligns fields by unused bytes, which are fields of the type V without a name.
                if scalar.letter == 'V' {
                    start += scalar.size * repeats;
                    continue;
                }
                for repeat in 0..*repeats {
                    let of_list = Some(format!(".{repeat}")).filter(|_| *repeats > 1);
                    let of_list = of_list.unwrap_or_default();
                    names.push(format!("{name}{field}{suffix}{of_list}"));
                    self.columns.push(ArrayColumn {
                        array: self.arrays.len(),
                        scalar: *scalar,
                        start,
                        stride: stride * item,
                    });
                    start += scalar.size;
                }
            }
        }
        self.arrays.push(array.data);
        Ok(names)
    }

    pub(super) const fn columns(&self) -> usize {
        self.columns.len()
    }

    /// Calls `take` with every row. The row's number is used as its line number.
    pub(super) fn rows(&self, mut take: impl FnMut(Record<'_>) -> RowResult) -> RowResult {
        let mut fields = StringRecord::new();
        for row in 0..self.rows {
            fields.clear();
            for column in &self.columns {
                let start = column.start + row * column.stride;
                let bytes = &self.arrays[column.array][start..start + column.scalar.size];
                fields.push_field(&column.scalar.text(bytes));
            }
            take(Record {
                line: row + 1,
                is_after_gap: false,
                fields: &fields,
            })?;
        }
        Ok(())
    }
}

impl<'a> Array<'a> {
    /// Parses the header of a `.npy` file: a Python dictionary with the keys `descr`, `fortran_order` and `shape`.
    fn of(bytes: Cow<'a, [u8]>) -> Result<Self, String> {
        let damaged = || "is not a valid .npy array: its header is damaged".to_owned();
        let start = match bytes.get(6) {
            Some(1) => 10,
            Some(2 | 3) => 12,
            _ => return Err(damaged()),
        };
        let length = bytes.get(8..start).ok_or_else(damaged)?.iter().rev();
        let length = length.fold(0, |length, &byte| length << 8 | usize::from(byte));
        let header = bytes.get(start..start + length).ok_or_else(damaged)?;
        let header = std::str::from_utf8(header).map_err(|_| damaged())?;
        let after = |key: &str| Some(header.split_once(key)?.1.trim_start());
        let shape = after("'shape':").and_then(|rest| rest.strip_prefix('('));
        let shape = shape
            .and_then(|rest| rest.split_once(')'))
            .ok_or_else(damaged)?
            .0;
        let lengths = shape
            .split(',')
            .map(str::trim)
            .filter(|length| !length.is_empty());
        let shape: Vec<usize> = lengths
            .map(|length| length.parse().map_err(|_| damaged()))
            .collect::<Result<_, _>>()?;
        let is_fortran = after("'fortran_order':").is_some_and(|rest| rest.starts_with("True"));
        let fields = fields(after("'descr':").ok_or_else(damaged)?)?;
        let item = fields
            .iter()
            .try_fold(0_usize, |sum, (_, scalar, repeats)| {
                sum.checked_add(scalar.size.checked_mul(*repeats)?)
            });
        let needed = shape
            .iter()
            .try_fold(item.ok_or_else(damaged)?, |size, &length| {
                size.checked_mul(length)
            });
        let held = bytes.len() - start - length;
        let array = Self {
            fields,
            is_fortran,
            shape,
            data: match bytes {
                Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[start + length..]),
                Cow::Owned(mut bytes) => Cow::Owned(bytes.split_off(start + length)),
            },
        };
        match needed {
            Some(needed) if needed == held => Ok(array),
            _ => Err(format!(
                "is not a valid .npy array: shape {} does not fit {held} bytes of data",
                array.shape_text()
            )),
        }
    }

    fn shape_text(&self) -> String {
        let lengths: Vec<String> = self.shape.iter().map(usize::to_string).collect();
        format!("({})", lengths.join(", "))
    }
}

/// Returns an error for arrays whose columns are ambiguous. There are two cases: an array with several series, whose
/// first or second axis may be the time; and a grid with two separate arrays for the coordinates along its axes.
fn ambiguous(arrays: &[(String, Array<'_>)]) -> Result<(), String> {
    let lines = arrays.iter().filter(|(_, array)| array.shape.len() == 1);
    let lines: Vec<_> = lines.map(|(name, array)| (name, array.shape[0])).collect();
    let has_time = lines.iter().any(|(name, _)| Heading::of(name).is_time());
    for (name, array) in arrays {
        let shape = array.shape_text();
        match array.shape[..] {
            [first, second, parts, ..] if second > MAX_FINGERS && second != parts && !has_time => {
                let rows = first * second;
                return Err(format!(
                    "has the array `{name}` of shape {shape}, whose first or second axis may be the time; reshape all arrays to {rows} rows, and add an array `finger` or `probe` with one number per row"
                ));
            }
            [_, second]
                if second > 9
                    && lines.len() == 2
                    && lines.iter().all(|(_, length)| array.shape.contains(length)) =>
            {
                return Err(format!(
                    "has the grid `{name}` of shape {shape} and the coordinates along its axes; write each coordinate as a grid of this shape too, as numpy.meshgrid returns it"
                ));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Fields of an array type. `text` is the type as Python writes it: `'<f8'`, or `[('x', '<f8'), ('position', '<f8',
/// (3,))]`.
fn fields(text: &str) -> Result<Vec<(String, Scalar, usize)>, String> {
    let scalar = |name: &str| {
        Scalar::of(name).ok_or_else(|| {
            format!(
                "has elements of type `{name}`; numbers of at most 64 bits are needed: convert them by .astype(float)"
            )
        })
    };
    if let Some(name) = text.strip_prefix('\'') {
        let name = name.split('\'').next().unwrap_or_default();
        let scalar = scalar(name)?;
        return match scalar.letter {
            'V' => Err("has elements without a type; save numbers".to_owned()),
            _ => Ok(vec![(String::new(), scalar, 1)]),
        };
    }
    let list = text
        .strip_prefix('[')
        .and_then(|rest| rest.split_once("],"));
    let mut fields = Vec::new();
    // Split the list of fields at quotation marks. The parts with odd indices are the names and the types of the
    // fields.
    let parts: Vec<&str> = list.map_or("", |(list, _)| list).split('\'').collect();
    for part in parts.get(1..).unwrap_or_default().chunks(4) {
        if let [name, between, ..] = part
            && between.contains('[')
        {
            return Err(format!(
                "has the field `{name}`, which has fields of its own; save each of them as an array by np.savez"
            ));
        }
        let [name, _, kind, after] = part else {
            return Err("is not a valid .npy array: its type is damaged".to_owned());
        };
        let shape = after.trim_start_matches(',').trim_start().strip_prefix('(');
        let shape = shape.and_then(|rest| rest.split_once(')'));
        let lengths = shape.map_or("", |(shape, _)| shape).split(',');
        let lengths = lengths.filter_map(|length| length.trim().parse::<usize>().ok());
        fields.push((
            (*name).to_owned(),
            scalar(kind)?,
            lengths.fold(1, usize::saturating_mul),
        ));
    }
    match fields.is_empty() {
        true => Err("is not a valid .npy array: its type is damaged".to_owned()),
        false => Ok(fields),
    }
}

/// Largest total size of the files in an archive, MiB.
const MAX_MIB: u64 = 256;

/// Returns the name and the contents of all files in an archive, in the order of the archive.
fn members(bytes: &[u8]) -> Result<Vec<(String, Vec<u8>)>, String> {
    let in_words = |error: ZipError| match error {
        ZipError::Io(_) | ZipError::InvalidArchive(_) => {
            "is not a valid zip archive: it is truncated or damaged".to_owned()
        }
        other => format!("is a zip archive that palpate does not read ({other}); use np.savez"),
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(in_words)?;
    let mut left = MAX_MIB << 20;
    let mut members = Vec::new();
    for index in 0..archive.len() {
        let member = archive.by_index(index).map_err(in_words)?;
        let name = member.name().to_owned();
        let mut contents = Vec::new();
        let size = member.take(left + 1).read_to_end(&mut contents);
        let size = size.map_err(|_| format!("is not a valid zip archive: `{name}` is damaged"))?;
        left = left
            .checked_sub(size as u64)
            .ok_or_else(|| format!("unpacks to more than {MAX_MIB} MiB"))?;
        members.push((name, contents));
    }
    Ok(members)
}
