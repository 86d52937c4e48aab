//! Reads files of recorded presses.

use std::collections::BTreeMap;

use super::RecordedFile;
use super::error::RecordedError;
use super::press_report::Row;
use super::reading_table::{ExtraColumns, ReadingTable, header};
use super::source::{ReadingSource, copies, finite, same_length};
use super::text_table::TextTable;
use nalgebra::Point3;
use palpate_ep2::{Contact, DistinctContacts};
use palpate_study::config::LengthUnit;
use palpate_study::readings::{COLUMNS, Column, columns_of};

/// Consecutive rows belong to the same marker if their positions and displacements differ from those of the first of
/// these rows by at most this share of a reference length. The reference length is the extent of the middle half of all
/// positions, divided by the number of rows.
const MAX_PLACE_ERROR: f64 = 0.2;

/// Recorded readings of a press.
#[derive(Clone, Debug, PartialEq)]
pub struct PressRecording {
    pub(super) source: ReadingSource,
    /// Position of each marker on the skin: (x, y) is the point at the distance √(x² + y²) from the apex, in the
    /// direction (x, y).
    pub(super) places: Vec<[f64; 2]>,
    pub(super) normal: Vec<f64>,
    pub(super) tangential: Option<Vec<[f64; 2]>>,
    /// Unit of lengths that the header states; `None` if the header states none.
    pub unit: Option<LengthUnit>,
    /// Columns of the file that palpate does not use, one row per marker.
    pub(super) extras: ExtraColumns,
}

impl PressRecording {
    /// The readings of a press, from arrays. `positions` contains the positions of the markers on the skin, `normal`
    /// their inward displacements, and `tangential` their displacements along the skin (if measured). Lengths are in
    /// `unit`.
    ///
    /// ```
    /// use palpate_recorded::PressRecording;
    ///
    /// let readings = PressRecording::new(&[[0.0, 0.0], [1.0, 0.0]], &[0.5, f64::NAN], None, None);
    /// let error = readings.expect_err("no number").to_string();
    /// assert_eq!(error, "displacements[1]: must be finite, is NaN");
    /// ```
    ///
    /// # Errors
    /// [`RecordedError::Array`] if a number is not finite, or if there are more or fewer displacements than positions.
    pub fn new(
        positions: &[[f64; 2]],
        normal: &[f64],
        tangential: Option<&[[f64; 2]]>,
        unit: Option<LengthUnit>,
    ) -> Result<Self, RecordedError> {
        let all = ("positions", positions.len());
        finite("positions", positions)?;
        same_length(("displacements", normal.len()), all)?;
        finite("displacements", normal.as_chunks::<1>().0)?;
        if let Some(tangential) = tangential {
            same_length(("tangential", tangential.len()), all)?;
            finite("tangential", tangential)?;
        }
        Ok(Self {
            source: ReadingSource::arrays(),
            places: positions.to_vec(),
            normal: normal.to_vec(),
            tangential: tangential.map(<[_]>::to_vec),
            unit,
            extras: ExtraColumns::default(),
        })
    }

    /// The press with one reading per marker, and a warning about repeated markers; `None` if no marker is repeated.
    /// Equal rows, and consecutive rows with almost the same position and displacement, are replaced by their mean. If
    /// the noise is estimated, it is the noise of these means. So it does not matter whether the noise of the rows of one
    /// marker is independent.
    pub(super) fn without_copies(&self) -> Option<(Self, String)> {
        let along = self.tangential.as_deref();
        let marker = |marker: usize| {
            let ([x, y], normal) = (self.places[marker], self.normal[marker]);
            let [along_x, along_y] = along.map_or([0.0; 2], |along| along[marker]);
            [x, y, normal, along_x, along_y]
        };
        let count = self.places.len();
        if count < 2 {
            return None;
        }
        let contact = |(&[x, y], &normal): (&[f64; 2], &f64)| Contact {
            finger: 0,
            position: Point3::new(x, y, normal),
            normal: None,
            weight: 1.0,
        };
        let contacts: Vec<Contact> = self.places.iter().zip(&self.normal).map(contact).collect();
        // The median extent does not depend on lost readings.
        let extents = [0, 1].map(|axis| {
            let mut sorted: Vec<f64> = self.places.iter().map(|place| place[axis]).collect();
            sorted.sort_unstable_by(f64::total_cmp);
            sorted[3 * count / 4] - sorted[count / 4]
        });
        let limit = MAX_PLACE_ERROR * extents[0].max(extents[1]) / count as f64;
        let mut markers: Vec<Vec<usize>> = Vec::new();
        for (row, run) in DistinctContacts::within(&contacts, limit)
            .run_of_row
            .into_iter()
            .enumerate()
        {
            match markers.get_mut(run) {
                Some(rows) => rows.push(row),
                None => markers.push(vec![row]),
            }
        }
        let repeated = count - markers.len();
        if repeated == 0 {
            return None;
        }
        let exact = self.source.repeated("marker", (0..count).map(marker), 0.0);
        let are_exact = copies((0..count).map(marker)).len() == repeated;
        let text = exact.filter(|_| are_exact).unwrap_or_else(|| {
            format!(
                "{repeated} rows have almost the same numbers as an earlier row: such rows are replaced by their mean"
            )
        });
        let mean = |rows: &Vec<usize>| {
            let first = marker(rows[0]);
            let share = 1.0 / rows.len() as f64;
            let changes = |place: usize| {
                rows.iter()
                    .map(move |&row| marker(row)[place] - first[place])
            };
            [0, 1, 2, 3, 4].map(|place| first[place] + share * changes(place).sum::<f64>())
        };
        let means: Vec<[f64; 5]> = markers.iter().map(mean).collect();
        let firsts: Vec<usize> = markers.iter().map(|rows| rows[0]).collect();
        let press = Self {
            places: means.iter().map(|&[x, y, ..]| [x, y]).collect(),
            normal: means.iter().map(|mean| mean[2]).collect(),
            tangential: along.map(|_| means.iter().map(|&[.., x, y]| [x, y]).collect()),
            ..self.selected(&firsts)
        };
        Some((press, text))
    }

    /// The markers that have the most common normal displacement. If there are several, this number may stand for lost
    /// readings.
    pub(super) fn of_same_displacement(&self) -> Vec<usize> {
        let mut markers: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for (marker, normal) in self.normal.iter().enumerate() {
            let same = (normal + 0.0).to_bits();
            markers.entry(same).or_default().push(marker);
        }
        let most_common = markers.into_values().max_by_key(Vec::len);
        most_common.unwrap_or_default()
    }

    pub(super) fn marker(&self, marker: usize) -> Row {
        Row {
            row: self.source.row_number(marker),
            line: self.source.line(marker),
            columns: self.extras.named(marker),
        }
    }

    pub(super) fn selected(&self, markers: &[usize]) -> Self {
        let along = self.tangential.as_ref();
        Self {
            source: self.source.selected(markers),
            places: markers.iter().map(|&one| self.places[one]).collect(),
            normal: markers.iter().map(|&one| self.normal[one]).collect(),
            tangential: along.map(|along| markers.iter().map(|&one| along[one]).collect()),
            unit: self.unit,
            extras: self.extras.selected(markers),
        }
    }

    /// Whether displacements along the skin were measured.
    pub const fn has_tangential(&self) -> bool {
        self.tangential.is_some()
    }
}

/// Reads a recorded press, one row per marker. A row contains the position on the skin, the normal displacement and, if
/// it was measured, the displacement along the skin. If the markers are on a line through the apex, a row may instead
/// contain the signed position along the line and the normal displacement.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
impl TryFrom<RecordedFile> for PressRecording {
    type Error = RecordedError;

    fn try_from(file: RecordedFile) -> Result<Self, RecordedError> {
        let orders = [&COLUMNS.presses[..3], &COLUMNS.press_row, &COLUMNS.presses];
        let table = TextTable::of(&file, &orders)?;
        let header = header(&table, &columns_of("press"))?;
        let has = |column: &Column| header.has(column);
        let along_a_row = match (
            has(&COLUMNS.press_row[0]),
            COLUMNS.presses[..2].iter().all(has),
        ) {
            (true, true) => {
                let row = header.is_assigned(&COLUMNS.press_row[..1]);
                if row == header.is_assigned(&COLUMNS.presses[..2]) {
                    let names = header.pairs(&COLUMNS.press_row[..1], &COLUMNS.press_row[..1]);
                    let message = format!(
                        "there are both places x, y and radial_position; state which to read, as in setting `columns` '{names}'"
                    );
                    return Err(file.fail(table.header_line, message));
                }
                row
            }
            (along_a_row, _) => along_a_row,
        };
        let with_tangential = !along_a_row && COLUMNS.presses[3..].iter().any(has);
        let (columns, others) = match (along_a_row, with_tangential) {
            (true, _) => (&COLUMNS.press_row[..], &[][..]),
            (false, true) => (&COLUMNS.presses[..], &[][..]),
            (false, false) => COLUMNS.presses.split_at(3),
        };
        let sheet = ReadingTable::read(&table, columns, others, |_| true)?;
        let (mut places, mut normal, mut tangential) = (Vec::new(), Vec::new(), Vec::new());
        for (_, numbers) in sheet.rows() {
            match *numbers {
                [position, displacement] => {
                    places.push([position, 0.0]);
                    normal.push(displacement);
                }
                [x, y, displacement, ref along @ ..] => {
                    places.push([x, y]);
                    normal.push(displacement);
                    if let [along_x, along_y] = *along {
                        tangential.push([along_x, along_y]);
                    }
                }
                _ => {}
            }
        }
        Ok(PressRecording {
            unit: sheet.unit,
            source: sheet.source,
            extras: sheet.extras,
            places,
            normal,
            tangential: with_tangential.then_some(tangential),
        })
    }
}
