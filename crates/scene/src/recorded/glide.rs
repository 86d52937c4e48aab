//! Recorded glides.

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Point3, Vector3};
use palpate_ep2::Contact;

use super::RecordedFile;
use super::sheet::{Column, RecordedError, Sheet, header};
use palpate_study::config::LengthUnit;

/// One row per contact; the normals may be missing.
const COLUMNS: [Column; 7] = [
    Column::plain("finger"),
    Column::length("x"),
    Column::length("y"),
    Column::length("z"),
    Column::plain("normal_x"),
    Column::plain("normal_y"),
    Column::plain("normal_z"),
];

/// Recorded readings of a glide.
#[derive(Clone, Debug, PartialEq)]
pub struct GlideReadings {
    /// The file, for messages.
    pub(super) file: String,
    /// The line of each contact.
    pub(super) lines: Vec<usize>,
    /// The contacts, in the order of the file.
    pub(super) contacts: Vec<Contact>,
    /// How many fingers there are.
    pub(super) fingers: usize,
    /// The unit that the header states.
    pub(super) unit: Option<LengthUnit>,
}

impl GlideReadings {
    /// Whether the contacts have normals.
    pub fn has_normals(&self) -> bool {
        self.contacts.iter().any(|contact| contact.normal.is_some())
    }

    /// The unit of lengths that the header states.
    pub fn unit(&self) -> Option<LengthUnit> {
        self.unit
    }
}

/// Reads recorded contacts: one row each, with normals or without; the contacts of a finger stand
/// in the order in which it made them.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
pub fn read_glide(path: &Path) -> Result<GlideReadings, RecordedError> {
    parse_glide(RecordedFile::read(path)?)
}

/// Recorded contacts, as [`read_glide`] reads them.
///
/// # Errors
/// As [`read_glide`].
pub fn parse_glide(file: RecordedFile) -> Result<GlideReadings, RecordedError> {
    let text = file.text()?;
    let with_normals = header(text).iter().any(|name| name.starts_with("normal"));
    let columns = if with_normals {
        &COLUMNS[..]
    } else {
        &COLUMNS[..4]
    };
    let sheet = Sheet::parse(&file.name, text, columns)?;
    let file = file.into_name();
    let unit = sheet.unit;
    // Fingers may have any numbers; contacts count them in the order in which they appear.
    let mut fingers: HashMap<u64, usize> = HashMap::new();
    let (mut lines, mut contacts) = (Vec::new(), Vec::new());
    for (line, numbers) in sheet.rows() {
        let number = sheet.index(line, "finger", numbers[0])?;
        let next = fingers.len();
        let finger = *fingers.entry(number).or_insert(next);
        let position = Point3::from_slice(&numbers[1..4]);
        let normal = with_normals.then(|| Vector3::from_column_slice(&numbers[4..7]));
        lines.push(line);
        contacts.push(Contact::new(finger, position, normal));
    }
    Ok(GlideReadings {
        file,
        lines,
        contacts,
        fingers: fingers.len(),
        unit,
    })
}
