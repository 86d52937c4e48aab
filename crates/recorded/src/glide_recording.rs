//! Reads files of recorded glides. If a contact causes an error in a fit, the error message gets the contact's row in
//! the file.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Ep2Error, ShapeError, SoundContacts, StrokeCurvature};

use super::RecordedFile;
use super::error::{RecordedError, explained};
use super::finger_assignment::assign_fingers;
use super::glide_warnings::{directions, narrow};
use super::heading::{bracketed, may_be_tip, tip_radius_factor};
use super::log_warnings::{across, listed};
use super::reading_table::{ExtraColumns, ReadingTable, header};
use super::source::{ReadingSource, finite, same_length};
use super::table_layout::numbered_quaternion;
use super::text_table::TextTable;
use palpate_statistics::Number;
use palpate_study::config::{LengthUnit, SettingError};
use palpate_study::readings::{COLUMNS, Column, Measure, quaternion_part, spelt};

/// Largest accepted relative difference between the stated radius of fingertips and the radius in a column.
const MAX_RADIUS_ERROR: f64 = 0.01;

/// Recorded readings of glides.
#[derive(Clone, Debug, PartialEq)]
pub struct GlideRecording {
    pub(super) source: ReadingSource,
    /// The contacts, in the order of the file.
    pub(super) contacts: Vec<Contact>,
    pub(super) fingers: usize,
    /// Unit of lengths that the header states; `None` if the header states none.
    pub unit: Option<LengthUnit>,
    /// Columns of the file that palpate does not use, one row per contact.
    pub(super) extras: ExtraColumns,
    /// Name of the column x, if the positions may be points of a fingertip according to this name.
    tip: Option<String>,
    /// Note on how the contacts were assigned to fingers; `None` if the file states each contact's finger.
    pub(super) note: Option<String>,
}

impl GlideRecording {
    /// Builds a recording of contacts at `points` with the outward `normals`, which may have any length. `fingers`
    /// contains the finger number of each contact. If `fingers` is `None`, all contacts belong to one finger. The
    /// contacts of a finger must be in the order of the finger's path. Lengths are in `unit`.
    ///
    /// ```
    /// use palpate_recorded::GlideRecording;
    ///
    /// let readings = GlideRecording::new(&[[0.0, 0.0, 1.0]], None, Some(&[7]), None)?;
    /// assert!(!readings.has_normals());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordedError::Array`] if a number is not finite, or if there are more or fewer points than normals or
    /// fingers.
    pub fn new(
        points: &[[f64; 3]],
        normals: Option<&[[f64; 3]]>,
        fingers: Option<&[u64]>,
        unit: Option<LengthUnit>,
    ) -> Result<Self, RecordedError> {
        let all = ("points", points.len());
        finite("points", points)?;
        if let Some(normals) = normals {
            same_length(("normals", normals.len()), all)?;
            finite("normals", normals)?;
        }
        if let Some(fingers) = fingers {
            same_length(("fingers", fingers.len()), all)?;
        }
        let mut indices = Fingers::default();
        let contact = |(place, point): (usize, &[f64; 3])| {
            let finger = indices.place(fingers.map_or(0, |fingers| fingers[place]));
            let normal = normals.map(|normals| Vector3::from(normals[place]));
            Contact::new(finger, Point3::from(*point), normal)
        };
        let contacts = points.iter().enumerate().map(contact).collect();
        Ok(Self {
            source: ReadingSource::arrays(),
            contacts,
            fingers: indices.0.len(),
            unit,
            extras: ExtraColumns::default(),
            tip: None,
            note: None,
        })
    }

    /// Whether the contacts have normals.
    pub fn has_normals(&self) -> bool {
        self.contacts.iter().any(|contact| contact.normal.is_some())
    }

    /// Returns an error if the file has a column with a radius of fingertips, because the positions may then be points
    /// of round fingertips instead of contacts.
    pub(super) fn check_contacts(&self) -> Result<(), RecordedError> {
        let mut radii = self.radii();
        let Some((name, radius)) = radii.next() else {
            return Ok(());
        };
        if let Some((other_name, other)) = radii.find(|(_, other)| is_other(*other, radius, 1e-9)) {
            return Err(self.source.fail(format!(
                "the radius of tips is {radius} in column `{name}` and {other} in column `{other_name}`, but setting `tip_radius` is one radius; write the contacts of other tips into another file"
            )));
        }
        let unit = self
            .unit
            .map_or(String::new(), |unit| format!(" {}", unit.as_str()));
        Err(self.source.fail(format!(
            "the radius of tips is {radius}{unit} in column `{name}`, so the positions may be those of round tips instead of contacts; state setting `tip_radius` {radius} for tips (setting `reports`: their lowest point or their centre), or 0 for contacts"
        )))
    }

    /// The positive radii in all columns for the radius of fingertips, each with the name of its column. The radii are
    /// in the recording's unit of length.
    fn radii(&self) -> impl Iterator<Item = (&str, Number)> {
        let columns = self.extras.names.iter().enumerate();
        let columns =
            columns.filter_map(|(place, name)| Some((place, name, tip_radius_factor(name)?)));
        columns.flat_map(move |(place, name, share)| {
            let (base, bracket) = bracketed(name);
            let base = spelt(base);
            let unit = bracket.or(base.rsplit('_').next());
            let unit = unit.and_then(|unit| Measure::Length.unit(unit));
            let factor = unit.zip(self.unit).and_then(|(unit, own)| unit.to(own));
            (0..self.contacts.len()).filter_map(move |row| {
                let radius = self.extras.row(row).swap_remove(place);
                let radius = radius.trim().replacen(',', ".", 1).parse::<f64>().ok()?;
                let radius = factor.unwrap_or(1.0) * share * radius;
                (radius > 0.0 && radius.is_finite()).then_some((name.as_str(), Number(radius)))
            })
        })
    }

    /// Text of a warning if the stated radius of the fingertips is not 0 and differs from the radius in a column of the
    /// file; otherwise `None`.
    pub(super) fn other_tip_radius(&self, stated: f64) -> Option<String> {
        let mut radii = self.radii().filter(|_| stated > 0.0);
        let (name, radius) =
            radii.find(|(_, one)| is_other(*one, Number(stated), MAX_RADIUS_ERROR))?;
        Some(format!(
            "setting `tip_radius` is {stated}, but the radius in column `{name}` is {radius}: which one is right?"
        ))
    }

    /// Text of a note for files whose positions may be points of fingertips instead of contacts, because of their name or
    /// because the file states orientations, which palpate does not read. `None` for other files.
    pub(super) fn possible_tips(&self) -> Option<String> {
        if let Some(name) = &self.tip {
            return Some(format!(
                "the positions (`{name}`) are read as contacts; if they are those of round tips, state setting `tip_radius`"
            ));
        }
        let names = &self.extras.names;
        let mut parts = names.iter();
        let part = parts.position(|name| quaternion_part(&spelt(name)).is_some());
        let first = part.or_else(|| Some(numbered_quaternion(names)?[0]))?;
        let name = &names[first];
        Some(format!(
            "orientations (`{name}`) are not used; if the positions are those of round tips instead of contacts, state setting `tip_radius`"
        ))
    }
}

fn is_other(one: Number, other: Number, tolerance: f64) -> bool {
    (one.0 / other.0 - 1.0).abs() > tolerance
}

/// Maps the number of a finger in the readings to its index. The indices follow the order in which the numbers first
/// appear.
#[derive(Default)]
struct Fingers(HashMap<u64, usize>);

impl Fingers {
    fn place(&mut self, number: u64) -> usize {
        let next = self.0.len();
        *self.0.entry(number).or_insert(next)
    }
}

/// Reads recorded contacts: one row per contact, with or without normals. The contacts of a finger must be in the order
/// of the finger's path. If the file has no column `finger`, blank lines or long steps separate the fingers.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
impl TryFrom<RecordedFile> for GlideRecording {
    type Error = RecordedError;

    fn try_from(file: RecordedFile) -> Result<Self, RecordedError> {
        let orders = [
            &COLUMNS.glides[1..4],
            &COLUMNS.glides[..4],
            &COLUMNS.glides[1..],
            &COLUMNS.glides,
        ];
        let table = TextTable::of(&file, &orders)?;
        let header = header(&table, &COLUMNS.glides)?;
        let [finger, places @ .., _, _, _] = &COLUMNS.glides;
        let names_fingers = header.has(finger);
        let with_normals = COLUMNS.glides[4..].iter().any(|column| header.has(column));
        let is_read = |column: &Column| match column {
            column if column == finger => names_fingers,
            column => places.contains(column) || with_normals,
        };
        let (columns, others): (Vec<Column>, Vec<Column>) =
            COLUMNS.glides.into_iter().partition(is_read);
        let sheet = ReadingTable::read(&table, &columns, &others, |_| true)?;
        let mut contacts = Vec::with_capacity(sheet.source.lines.len());
        // Finger numbers in the file may be arbitrary. Number the fingers anew, in the order in which they first appear.
        let mut indices = Fingers::default();
        for (line, numbers) in sheet.rows() {
            let (finger, numbers) = match names_fingers {
                true => {
                    let number = sheet.index(line, finger.name, numbers[0])?;
                    (indices.place(number), &numbers[1..])
                }
                false => (0, numbers),
            };
            let normal = with_normals.then(|| Vector3::from_column_slice(&numbers[3..6]));
            contacts.push(Contact::new(
                finger,
                Point3::from_slice(&numbers[..3]),
                normal,
            ));
        }
        let note = (!names_fingers).then(|| {
            let unit = sheet.unit.unwrap_or_default().as_str();
            let positions: Vec<_> = contacts.iter().map(|contact| contact.position).collect();
            let assigned = |places: &[Point3<f64>]| assign_fingers(places, &sheet.after_gaps, unit);
            let (fingers, note) = match assigned(&positions) {
                (found, _) if found.last() > Some(&0) => assigned(&with_outliers_moved(&contacts)),
                one => one,
            };
            for (contact, finger) in contacts.iter_mut().zip(fingers) {
                contact.finger = finger;
            }
            note
        });
        let fingers = contacts.iter().map(|contact| contact.finger).max();
        Ok(GlideRecording {
            contacts,
            fingers: fingers.map_or(0, |most| most + 1),
            source: sheet.source,
            unit: sheet.unit,
            extras: sheet.extras,
            tip: header
                .own_name(&places[0])
                .filter(|name| may_be_tip(name))
                .map(str::to_owned),
            note,
        })
    }
}

/// Returns the positions of the contacts for the search for steps between fingers. A gross outlier gets the position of
/// the previous contact. Otherwise the outlier would look like a step to another finger.
fn with_outliers_moved(contacts: &[Contact]) -> Vec<Point3<f64>> {
    let mut places: Vec<_> = contacts.iter().map(|contact| contact.position).collect();
    if let Ok(sound) = SoundContacts::new(contacts) {
        let first = sound.rows.first().map(|&row| places[row]);
        for outlier in sound.outliers {
            let before = outlier.contact.checked_sub(1).map(|row| places[row]);
            places[outlier.contact] = before.or(first).unwrap_or(places[outlier.contact]);
        }
    }
    places
}

pub(super) const ONE_FINGER: &str =
    "all contacts belong to one finger, so there is no distance between fingers";

/// Converts an error of a fit to an error about the recording. If a single contact caused the error, the new error
/// states the contact's line in the file.
pub(super) fn refused(recorded: &GlideRecording, error: &Ep2Error) -> RecordedError {
    let contact = match error {
        Ep2Error::NotFinite { contact }
        | Ep2Error::BadWeight { contact, .. }
        | Ep2Error::BadNormal { contact, .. }
        | Ep2Error::MissingNormal { contact }
        | Ep2Error::Folded { contact, .. } => Some(*contact),
        _ => None,
    };
    let message = remedied(error, recorded);
    let signs = match error {
        Ep2Error::Folded { .. } | Ep2Error::NoSide { .. } => directions(&recorded.contacts),
        _ => None,
    };
    let message = signs.map_or(message.clone(), |signs| format!("{message}; {signs}"));
    let message = explained(message, error.into());
    match contact {
        Some(contact) => recorded.source.fail_at(contact, message),
        None => recorded.source.fail(message),
    }
}

/// Replaces the index of a contact in an error of a fit by the contact's row in the recording. The two differ, because
/// the fit counts only the contacts that it uses. `rows` contains the rows of these contacts.
pub(super) fn of_row(error: Ep2Error, rows: &[usize]) -> Ep2Error {
    match error {
        Ep2Error::Folded { contact, angle_deg } => Ep2Error::Folded {
            contact: rows[contact],
            angle_deg,
        },
        error => error,
    }
}

pub(super) fn stroke_refused(
    recorded: &GlideRecording,
    error: &Ep2Error,
    stroke: &StrokeCurvature,
    unit: LengthUnit,
) -> RecordedError {
    let error_text = remedied(error, recorded);
    let message = format!("{}: {error_text}", across(stroke, unit).text);
    recorded.source.fail(explained(message, error.into()))
}

/// Converts the error of a shape fit to an error that states the rows of the readings.
pub(super) fn shape_refused(recorded: &GlideRecording, error: &ShapeError) -> RecordedError {
    match error {
        ShapeError::Contacts(error) => refused(recorded, error),
        ShapeError::TooManyOutliers { outliers, .. } => {
            let rows = listed(outliers.iter().map(|&row| recorded.source.row(row)));
            let message = format!("{error}: {rows}");
            recorded.source.fail(explained(message, error.into()))
        }
    }
}

/// Message of an error of a fit. If a setting can solve the problem, the message names this setting.
fn remedied(error: &Ep2Error, recorded: &GlideRecording) -> String {
    match error {
        Ep2Error::BadSetting(bad) if bad.setting == "unit_length" && bad.value == 0.0 => {
            format!("{ONE_FINGER}: two-pass needs setting `inter_finger_distance`")
        }
        Ep2Error::BadSetting(bad) if bad.setting == "unit_length" => {
            SettingError::of_number("inter_finger_distance", bad.value, bad.expected).to_string()
        }
        Ep2Error::Folded { angle_deg, .. } if *angle_deg > 90.0 => {
            format!("{error}: does its normal point inward?")
        }
        Ep2Error::NoSide { .. } => {
            let curve = match recorded.fingers {
                1 => "; contacts along one curve do not determine the surface beside the curve",
                _ => "",
            };
            let units = narrow(&recorded.contacts, &Vector3::z());
            let units = units.map_or(String::new(), |units| format!("; {units}"));
            format!("{error}; give another with setting `outward`{curve}{units}")
        }
        _ => error.to_string(),
    }
}
