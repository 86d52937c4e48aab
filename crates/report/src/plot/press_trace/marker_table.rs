//! Reads `trace.csv` and `readings.csv` of a press: the true displacements of the markers, and the readings.

use crate::records::Records;
use crate::{Files, ReportError, phrases};
use palpate_study::label::spoken_unit;
use palpate_study::number;

/// Names of the columns that are read from `trace.csv`. The code refers to them by their index in this list.
const TRACE: [&str; 6] = [
    "x",
    "y",
    "radial_position",
    "normal_displacement",
    "tangential_x",
    "tangential_y",
];
/// Names of the columns that are read from `readings.csv`. The last two columns may be missing from the file.
const READINGS: [&str; 5] = [
    "x",
    "y",
    "normal_displacement",
    "tangential_x",
    "tangential_y",
];
/// A reading and a marker are at the same position if their coordinates differ by less than this share of the largest
/// coordinate of all markers.
const RELATIVE_TOLERANCE: f64 = 1e-6;

/// Displacement of a marker, in the length unit of the tables.
#[derive(Debug, Clone, Copy)]
pub(super) struct Displacement {
    /// Component along the normal, positive inwards.
    pub(super) normal: f64,
    /// Components along both axes of the skin at the marker; `None` if they were not measured.
    pub(super) tangential: Option<[f64; 2]>,
}

#[derive(Debug, Clone)]
pub(super) struct Marker {
    /// Coordinates (x, y) of the marker along the skin before the press, in the length unit of the tables.
    pub(super) place: [f64; 2],
    /// Distance of the marker from the contact along the skin, in the length unit of the tables.
    pub(super) radial: f64,
    pub(super) truth: Displacement,
    /// Measured displacement; `None` if there is no reading of this marker.
    pub(super) reading: Option<Displacement>,
}

#[derive(Debug)]
pub(super) struct Trace {
    pub(super) unit: String,
    /// The markers in the order of `trace.csv`. There is at least one.
    pub(super) markers: Vec<Marker>,
    pub(super) reads_tangential: bool,
}

pub(super) fn read(files: &Files) -> Result<Trace, ReportError> {
    let trace = Records::read(files, "trace.csv", &TRACE)?.filled()?;
    one_unit(&trace, trace.unit(0), TRACE.len())?;
    let mut markers = (0..trace.rows())
        .map(|row| {
            Ok(Marker {
                place: pair(&trace, row, 0)?,
                radial: trace.number(row, 2)?,
                truth: Displacement {
                    normal: trace.number(row, 3)?,
                    tangential: Some(pair(&trace, row, 4)?),
                },
                reading: None,
            })
        })
        .collect::<Result<Vec<Marker>, ReportError>>()?;

    let read = |columns: usize| Records::read(files, "readings.csv", &READINGS[..columns]);
    let reads_tangential = read(3)?.find(READINGS[3]).is_some();
    let columns = if reads_tangential { 5 } else { 3 };
    let readings = read(columns)?;
    one_unit(&readings, trace.unit(0), columns)?;
    add_readings(&readings, reads_tangential, &mut markers)?;
    Ok(Trace {
        unit: trace.unit(0).to_owned(),
        markers,
        reads_tangential,
    })
}

/// Returns an error if the unit of one of the first `columns` columns of a table is not `unit`.
fn one_unit(table: &Records, unit: &str, columns: usize) -> Result<(), ReportError> {
    let other = (0..columns).find(|column| table.unit(*column) != unit);
    other.map_or(Ok(()), |column| Err(table.in_another_unit(column, unit)))
}

fn pair(table: &Records, row: usize, first: usize) -> Result<[f64; 2], ReportError> {
    Ok([table.number(row, first)?, table.number(row, first + 1)?])
}

/// Assigns each reading to the marker at the same position. Each marker gets at most one reading.
fn add_readings(
    table: &Records,
    with_tangential: bool,
    markers: &mut [Marker],
) -> Result<(), ReportError> {
    let coordinates = markers.iter().flat_map(|marker| marker.place);
    let near = RELATIVE_TOLERANCE * coordinates.map(f64::abs).fold(0.0, f64::max);
    let mut by_x: Vec<usize> = (0..markers.len()).collect();
    by_x.sort_by(|a, b| markers[*a].place[0].total_cmp(&markers[*b].place[0]));
    for row in 0..table.rows() {
        let [x, y] = pair(table, row, 0)?;
        let first = by_x.partition_point(|marker| markers[*marker].place[0] < x - near);
        let found = by_x[first..]
            .iter()
            .take_while(|marker| markers[**marker].place[0] <= x + near)
            .find(|marker| {
                let Marker { place, reading, .. } = &markers[**marker];
                reading.is_none() && (place[1] - y).abs() <= near
            });
        let marker = *found
            .ok_or_else(|| table.bad(row, 0, "a place in trace.csv that has no other reading"))?;
        markers[marker].reading = Some(Displacement {
            normal: table.number(row, 2)?,
            tangential: with_tangential.then(|| pair(table, row, 3)).transpose()?,
        });
    }
    Ok(())
}

impl Trace {
    pub(super) fn lost(&self) -> usize {
        let lost = |marker: &&Marker| marker.reading.is_none();
        self.markers.iter().filter(lost).count()
    }

    /// Root-mean-square errors of the readings: the error of the normal displacement, and the error of the displacement
    /// along the skin. An error is `None` if no marker has a reading of this displacement.
    pub(super) fn off(&self) -> (Option<f64>, Option<f64>) {
        let read = || {
            let markers = self.markers.iter();
            markers.filter_map(|marker| Some((marker.truth, marker.reading?)))
        };
        let normal = read().map(|(truth, reading)| reading.normal - truth.normal);
        let tangential = read().filter_map(|(truth, reading)| {
            let ([x, y], [read_x, read_y]) = (truth.tangential?, reading.tangential?);
            Some(libm::hypot(read_x - x, read_y - y))
        });
        (rms(normal), rms(tangential))
    }

    pub(super) fn subtitle(&self) -> String {
        let count = self.markers.len();
        let mut markers = format!("{count} marker{}", if count == 1 { "" } else { "s" });
        if self.lost() > 0 {
            markers += &format!(", {} without a reading", self.lost());
        }
        let (normal, tangential) = self.off();
        let text = |off: Option<f64>, of: &str| Some(format!("{} {of}", self.length(off?, 3)));
        let off = [text(normal, "inward"), text(tangential, "along the skin")];
        let off: Vec<String> = off.into_iter().flatten().collect();
        if !off.is_empty() {
            markers += &format!("; rms error {}", off.join(", "));
        }
        phrases::sentence(&[], &markers)
    }

    /// A length as text with `digits` significant digits and its unit.
    pub(super) fn length(&self, length: f64, digits: usize) -> String {
        let text = format!(
            "{} {}",
            number::significant(length, digits),
            spoken_unit(&self.unit)
        );
        text.trim_end().to_owned()
    }
}

fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    let squares: f64 = values.iter().map(|value| value * value).sum();
    (!values.is_empty()).then(|| (squares / values.len() as f64).sqrt())
}
