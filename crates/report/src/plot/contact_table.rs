//! Reads `trace.csv` and `readings.csv` of a glide: the true contacts of the fingers, and the readings.

use super::space::Vector;
use crate::records::Records;
use crate::{Files, ReportError};

/// Names of the columns that are read from `trace.csv`. The code refers to them by their index in this list.
const TRACE: [&str; 10] = [
    "finger", "x", "y", "z", "normal_x", "normal_y", "normal_z", "tip_x", "tip_y", "tip_z",
];
const READINGS: [&str; 4] = ["finger", "x", "y", "z"];

/// A reading counts as equal to the true contact if the distance between them is at most this share of the longest side
/// of a box around all contacts.
const RELATIVE_TOLERANCE: f64 = 1e-6;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    pub(crate) place: Vector,
    /// Unit normal; `None` if the normal in the table is the zero vector.
    pub(crate) normal: Option<Vector>,
    pub(crate) tip: Vector,
}

/// True contacts and readings of one finger. `readings` is empty if all readings equal the contacts.
#[derive(Debug, Clone)]
pub(crate) struct Finger {
    pub(crate) name: String,
    pub(crate) touches: Vec<Touch>,
    pub(crate) readings: Vec<Vector>,
}

#[derive(Debug)]
pub(crate) struct Contacts {
    pub(crate) unit: String,
    /// The fingers in order of appearance. There is at least one finger, and each finger has at least one contact.
    pub(crate) fingers: Vec<Finger>,
    /// Root-mean-square distance between readings and true contacts. `None` if all readings equal the contacts, or if
    /// the numbers of readings and contacts differ.
    pub(crate) off: Option<f64>,
    /// Whether the centre of at least one fingertip differs from its contact point, as for a fingertip with a radius
    /// above 0.
    pub(crate) tips_apart: bool,
}

impl Touch {
    /// End of a line of the length `length` that starts at the contact and is parallel to its normal. `None` if the
    /// contact has no normal.
    pub(crate) fn along_normal(&self, length: f64) -> Option<Vector> {
        let normal = self.normal?;
        Some([0, 1, 2].map(|k| self.place[k] + length * normal[k]))
    }
}

pub(crate) fn read(files: &Files) -> Result<Contacts, ReportError> {
    let table = Records::read(files, "trace.csv", &TRACE)?.filled()?;
    let touch = |row: usize| -> Result<Touch, ReportError> {
        Ok(Touch {
            place: vector(&table, row, 1)?,
            normal: unit(vector(&table, row, 4)?),
            tip: vector(&table, row, 7)?,
        })
    };
    let finger = |(name, rows): (&str, Vec<usize>)| -> Result<Finger, ReportError> {
        Ok(Finger {
            name: name.to_owned(),
            touches: rows
                .into_iter()
                .map(touch)
                .collect::<Result<_, ReportError>>()?,
            readings: Vec::new(),
        })
    };
    let fingers = table.by_text(0).into_iter().map(finger);
    let mut fingers = fingers.collect::<Result<Vec<Finger>, _>>()?;
    let size = size(&fingers);
    let touches = || fingers.iter().flat_map(|finger| &finger.touches);
    let tips_apart =
        touches().any(|touch| distance(touch.place, touch.tip) > RELATIVE_TOLERANCE * size);
    let off = match files.contain("readings.csv") {
        true => add_readings(files, &mut fingers, size)?,
        false => None,
    };
    Ok(Contacts {
        unit: table.unit(1).to_owned(),
        fingers,
        off,
        tips_apart,
    })
}

/// Adds the readings to their fingers. Returns the root-mean-square distance between readings and contacts. If all
/// readings equal the contacts, adds no readings and returns `None`.
fn add_readings(
    files: &Files,
    fingers: &mut [Finger],
    size: f64,
) -> Result<Option<f64>, ReportError> {
    let table = Records::read(files, "readings.csv", &READINGS)?.filled()?;
    let mut readings: Vec<Vec<Vector>> = vec![Vec::new(); fingers.len()];
    for row in 0..table.rows() {
        let at = fingers
            .iter()
            .position(|known| known.name == table.text(row, 0));
        let at = at.ok_or_else(|| table.bad(row, 0, "a finger of trace.csv"))?;
        readings[at].push(vector(&table, row, 1)?);
    }
    let paired = fingers
        .iter()
        .zip(&readings)
        .all(|(finger, read)| finger.touches.len() == read.len());
    let distances: Vec<f64> = fingers
        .iter()
        .zip(&readings)
        .flat_map(|(finger, read)| finger.touches.iter().zip(read))
        .map(|(touch, reading)| distance(touch.place, *reading))
        .collect();
    if paired
        && distances
            .iter()
            .all(|distance| *distance <= RELATIVE_TOLERANCE * size)
    {
        return Ok(None);
    }
    for (finger, readings) in fingers.iter_mut().zip(readings) {
        finger.readings = readings;
    }
    let mean = distances.iter().map(|d| d * d).sum::<f64>() / distances.len().max(1) as f64;
    Ok(paired.then(|| mean.sqrt()))
}

fn vector(table: &Records, row: usize, first: usize) -> Result<Vector, ReportError> {
    Ok([
        table.number(row, first)?,
        table.number(row, first + 1)?,
        table.number(row, first + 2)?,
    ])
}

fn unit(vector: Vector) -> Option<Vector> {
    let length = distance(vector, [0.0; 3]);
    (length > 0.0).then(|| vector.map(|part| part / length))
}

fn distance(a: Vector, b: Vector) -> f64 {
    libm::hypot(libm::hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2])
}

/// Length of the longest side of a box around all contacts.
fn size(fingers: &[Finger]) -> f64 {
    let side = |axis: usize| {
        let places = fingers
            .iter()
            .flat_map(|finger| &finger.touches)
            .map(|touch| touch.place[axis]);
        let ends = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
            (low.min(at), high.max(at))
        });
        ends.1 - ends.0
    };
    side(0).max(side(1)).max(side(2))
}
