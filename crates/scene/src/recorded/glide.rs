//! Recorded glides.

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Point3, Vector3};
use palpate_ep2::Contact;

use super::RecordedFile;
use super::error::RecordedError;
use super::extra::Extras;
use super::fingers::told_apart;
use super::sheet::{Sheet, header};
use super::written::Written;
use palpate_study::config::LengthUnit;
use palpate_study::readings::{Column, GLIDES};

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
    /// What else the file has of each contact.
    pub(super) extras: Extras,
    /// How the fingers were told, where the file does not name them.
    pub(super) note: Option<String>,
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
/// in the order in which it made them. Without a column `finger`, blank lines or long steps part the fingers.
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
    let table = Written::of(&file, &text)?;
    let header = header(&table, &GLIDES)?;
    let [finger, places @ .., _, _, _] = &GLIDES;
    let names_fingers = header.has(finger);
    let with_normals = GLIDES[4..].iter().any(|column| header.has(column));
    let columns: Vec<Column> = [finger]
        .into_iter()
        .filter(|_| names_fingers)
        .chain(places)
        .chain(GLIDES[4..].iter().filter(|_| with_normals))
        .copied()
        .collect();
    let sheet = Sheet::read(&table, &columns)?;
    let mut positions = Vec::new();
    // Fingers may have any numbers; contacts count them in the order in which they appear.
    let mut known: HashMap<u64, usize> = HashMap::new();
    let (mut fingers, mut normals) = (Vec::new(), Vec::new());
    for (line, numbers) in sheet.rows() {
        let numbers = match names_fingers {
            true => {
                let number = sheet.index(line, finger.name, numbers[0])?;
                let next = known.len();
                fingers.push(*known.entry(number).or_insert(next));
                &numbers[1..]
            }
            false => numbers,
        };
        positions.push(Point3::from_slice(&numbers[..3]));
        normals.push(with_normals.then(|| Vector3::from_column_slice(&numbers[3..6])));
    }
    let note = (!names_fingers).then(|| {
        let unit = sheet.unit.unwrap_or_default().as_str();
        let (found, note) = told_apart(&positions, &sheet.after_gaps, unit);
        fingers = found;
        note
    });
    let parts = fingers.iter().copied().zip(positions).zip(normals);
    let contacts = parts.map(|((finger, position), normal)| Contact::new(finger, position, normal));
    Ok(GlideReadings {
        contacts: contacts.collect(),
        fingers: fingers.iter().max().map_or(0, |most| most + 1),
        file: sheet.file,
        lines: sheet.lines,
        unit: sheet.unit,
        extras: sheet.extras,
        note,
    })
}
