//! Reads recorded rolls from a table: one row for each roll, or a time series for each roll.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use nalgebra::{Vector2, Vector3};
use palpate_ep1::{RollSample, RollSeries};
use palpate_statistics::Number;
use palpate_study::Warning;
use palpate_study::readings::{COLUMNS, Column, columns_of};

use super::RecordedFile;
use super::error::RecordedError;
use super::finger_assignment::parted;
use super::header::Header;
use super::reading_table::{ReadingTable, header};
use super::roll_rotation::{
    RotationForm, RotationFrame, SCALAR_FIRST, SCALAR_LAST, Turned, between, is_rolling,
    scalar_names, unwrapped,
};
use super::roll_series::SeriesReadings;
use super::roll_warnings::ORIENTATIONS;
use super::table_format::Form;
use super::table_layout::without_names;
use super::text_table::TextTable;

use super::roll_recording::{RollRecording, reading, sample};

/// Reads recorded rolls: one row per probe, or a time series per probe. In a time series, the columns
/// `pad_u,pad_v` or `contact_u,contact_v` state positions, so the first row is subtracted from the last row. The
/// rotation may be a vector, a unit quaternion, a matrix, or an axis with an angle. In a time series, the columns
/// `start_u,start_v` may state where the contact lies at the start of the roll. If there is no column `probe`, each
/// row or series counts as a probe. A new series starts after a blank line or where the time does not increase.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
impl TryFrom<RecordedFile> for RollRecording {
    type Error = RecordedError;

    fn try_from(file: RecordedFile) -> Result<Self, RecordedError> {
        let (recording, _) = read_rolls(&file)?;
        Ok(recording)
    }
}

/// The rolls of a file, and whether the shifts are consistent with a probe that rolls by the stated rotations.
fn read_rolls(file: &RecordedFile) -> Result<(RollRecording, bool), RecordedError> {
    let table = TextTable::of(file, &[&COLUMNS.rolls[1..], &columns_of("roll")])
        .map_err(|error| without_header(file).unwrap_or(error))?;
    let header = header(&table, &columns_of("roll"))?;
    let fail = |message: String| Err(file.fail(table.header_line, message));
    let kind = match Kind::of(&header) {
        Ok(kind) => kind,
        Err(message) => return fail(message),
    };
    let has = |column: &Column| header.has(column);
    let names_probes = has(&COLUMNS.rolls[0]);
    let form = RotationForm::of(&header);
    let as_series = |why: String| {
        let names = header.pairs(&COLUMNS.rolls[3..], &COLUMNS.contacts);
        format!("{why}; if each roll is a time series, write setting `columns` '{names}'")
    };
    if kind == Kind::Rows
        && form != RotationForm::Vector
        && !names_probes
        && !header.is_assigned(&COLUMNS.rolls[3..])
        && let Some(time) = header.time()
    {
        let names = header.pairs(&COLUMNS.rolls[3..], &COLUMNS.rolls[3..]);
        return fail(as_series(format!(
            "column `{time}`: the rows may be a time series; if each row is a roll, write setting `columns` '{names}'"
        )));
    }
    let (time, contacts) = match kind {
        Kind::Rows => (&[][..], &COLUMNS.rolls[3..]),
        Kind::Pads => (&COLUMNS.roll_series[1..2], &COLUMNS.roll_series[4..]),
        Kind::Contacts => (&COLUMNS.roll_series[1..2], &COLUMNS.contacts[..]),
    };
    let tip = &COLUMNS.glides[1..4];
    // Columns with the names x, y, z and w are a quaternion. Without w, x, y and z are a position.
    let is_quaternion =
        has(&tip[0]) && header.own_name(&tip[0]) == header.own_name(&COLUMNS.quaternion[0]);
    let has_tip = tip.iter().all(has) || header.offers(tip);
    if has_tip && !is_quaternion && !header.offers(contacts) {
        return fail(
            "the file has positions, as of a fingertip, but no contacts on the probe; an estimate from a glide with setting `tip_radius`, and setting `reports` centre, needs only the positions of the tip's centre".to_owned(),
        );
    }
    let probe = &COLUMNS.rolls[..usize::from(names_probes)];
    let starts = match kind != Kind::Rows && COLUMNS.roll_starts.iter().any(has) {
        true => &COLUMNS.roll_starts[..],
        false => &[],
    };
    let columns = [probe, time, form.columns(), contacts, starts].concat();
    let may = &COLUMNS.rolls[..usize::from(!names_probes)];
    // A sample may be left out if the sample before and the sample after it belong to the same roll, and if they are on the
    // same pad.
    let fixed = columns.len() - starts.len() - if kind == Kind::Pads { 2 } else { 0 };
    let is_spare = |[before, own, after]: [&[f64]; 3]| {
        let is_equal =
            |one: &[f64]| one[..probe.len()] == own[..probe.len()] && one[fixed..] == own[fixed..];
        let [earlier, time, later] = [before, own, after].map(|row| row[probe.len()]);
        kind != Kind::Rows && earlier < time && time < later && is_equal(before) && is_equal(after)
    };
    let mut sheet = ReadingTable::read(&table, &columns, may, is_spare)?;
    if names_probes || kind != Kind::Rows {
        sheet.leave_out_copies(names_probes);
    }
    if kind != Kind::Rows
        && let Some(hint) = header.unread(may, &[])
    {
        return fail(format!("no column `probe` separates the rolls; {hint}"));
    }
    let (first, last) = (probe.len(), columns.len() - starts.len());
    let (probes, counted) = match names_probes {
        true => {
            let rows = sheet.rows();
            let index = rows.map(|(line, numbers)| sheet.index(line, probe[0].name, numbers[0]));
            (index.collect::<Result<Vec<u64>, _>>()?, None)
        }
        false => {
            let (probes, note) = count_probes(&sheet, kind != Kind::Rows);
            (probes, Some(note))
        }
    };
    let mut rolls: Vec<Roll> = Vec::new();
    let mut equal_times = 0;
    // For each probe: the index of its roll, and the time of its last row.
    let mut earlier: HashMap<u64, (usize, f64)> = HashMap::new();
    for (row, ((line, numbers), &probe)) in sheet.rows().zip(&probes).enumerate() {
        let numbers = &numbers[first..last];
        let (time, numbers) = numbers.split_at(time.len());
        let t_s = time.first().copied().unwrap_or_default();
        match earlier.entry(probe) {
            Entry::Vacant(entry) => {
                entry.insert((rolls.len(), t_s));
                let (start, end) = ((line, numbers), (line, numbers));
                rolls.push(Roll {
                    probe,
                    row,
                    start_s: t_s,
                    start,
                    end,
                });
            }
            Entry::Occupied(mut entry) => {
                let (place, before) = *entry.get();
                if kind == Kind::Rows {
                    let twice = format!("probe {probe} occurs twice");
                    return Err(sheet.fail(
                        line,
                        match header.time() {
                            Some(_) => as_series(twice),
                            None => twice,
                        },
                    ));
                }
                equal_times += usize::from(t_s == before);
                if t_s < before {
                    let (name, t_s) = (header.time().unwrap_or("t_s"), Number(t_s));
                    let before = Number(before);
                    return Err(sheet.fail(
                        line,
                        format!(
                            "column `{name}`: the times of probe {probe} must increase, but {t_s} s follows {before} s"
                        ),
                    ));
                }
                entry.insert((place, t_s));
                (rolls[place].row, rolls[place].end) = (row, (line, numbers));
            }
        }
    }
    let read = |form: RotationForm, order: [usize; 4], frame: RotationFrame| {
        let relative = |roll: &Roll<'_>| roll.relative(kind, form, order, frame);
        let fail = |(line, message): (usize, String)| sheet.fail(line, message);
        rolls
            .iter()
            .map(|roll| relative(roll).map_err(fail))
            .collect::<Result<Vec<_>, _>>()
    };
    let mut notes = sheet.source.notes.clone();
    if equal_times > 0 {
        let text = format!(
            "rows with the same time as the row before, although their readings differ: {equal_times}; the order of the rows is used, and rows with equal times are spread evenly until the next time"
        );
        notes.push(Warning::new("time-order", text, []));
    }
    let mut note = |text: String| notes.push(Warning::new("assumed-columns", text, []));
    // A file does not state the frame of reference of its orientations. If the user does not state it either, try two
    // frames for time series: the probe's frame and the world's frame.
    let frames = match file.form.rotation_frame {
        Some(stated) => vec![stated],
        None if kind == Kind::Rows => vec![RotationFrame::Probe],
        None => vec![RotationFrame::Probe, RotationFrame::World],
    };
    let frame_of = |order| {
        let fits = |frame: &&RotationFrame| {
            read(form, order, **frame).is_ok_and(|rolls| is_rolling(&rolls))
        };
        frames.iter().find(fits).copied()
    };
    let mut order = SCALAR_LAST;
    if form == RotationForm::Quaternion {
        let [last, first] = [SCALAR_LAST, SCALAR_FIRST].map(|order| frame_of(order).is_some());
        let numbered = table.numbered_quaternion();
        let own = || {
            COLUMNS
                .quaternion
                .map(|column| header.own_name(&column).unwrap_or_default())
        };
        let names = numbered.map_or_else(own, |names| names.each_ref().map(String::as_str));
        let setting = |order| scalar_names(order, names);
        match (numbered.is_some(), last, first) {
            // Do not propose another order of the quaternion for a single roll. It may contain several rolls that the
            // file does not separate, so the order cannot be tested. A single roll is rejected later.
            (false, ..) if rolls.len() < 2 => {}
            (false, true, _) | (false, _, false) => {}
            (false, false, true) => {
                return fail(format!(
                    "the rotations do not fit the shifts of the contacts, unless the first component of the quaternion is its scalar part; write setting `columns` '{}'",
                    setting(SCALAR_FIRST)
                ));
            }
            (true, last, first) if last != first => {
                order = if last { SCALAR_LAST } else { SCALAR_FIRST };
                note(format!(
                    "the order of the quaternion's components was found from the rolls; it is that of setting `columns` '{}'",
                    setting(order)
                ));
            }
            _ => {
                return fail(format!(
                    "the scalar part of the quaternion may be its first or its last component; write setting `columns` '{}' or '{}'",
                    setting(SCALAR_FIRST),
                    setting(SCALAR_LAST)
                ));
            }
        }
    }
    let found = frame_of(order);
    let frame = found.unwrap_or(frames[0]);
    let turned = read(form, order, frame)?;
    if kind == Kind::Rows && !form.is_vector() && found.is_none() && rolls.len() > 1 {
        return fail(ORIENTATIONS.to_owned());
    }
    if let [_, other] = frames[..] {
        let world = read(form, order, other)?;
        let mut pairs = turned.iter().zip(&world);
        if frame == other {
            note("the rotations fit the shifts of the contacts only if they are relative to the frame of the orientations; setting `rotation_frame` world states this frame".to_owned());
        } else if pairs.any(|(probe, world)| {
            (probe.0 - world.0).xy().norm() > MAX_FRAME_DIFFERENCE * probe.0.norm()
        }) {
            note("rotations are relative to the probe's frame at the start of each roll, and u and v at the first contact are the x and y axes of this frame; setting `rotation_frame` world reads them relative to the frame of the orientations".to_owned());
        }
    }
    let series = match kind {
        Kind::Rows => None,
        Kind::Pads | Kind::Contacts => {
            let empty = RollSeries {
                has_spin: form != RotationForm::Vector,
                ..RollSeries::default()
            };
            let mut samples = vec![empty; rolls.len()];
            for ((line, numbers), probe) in sheet.rows().zip(&probes) {
                let place = earlier.get(probe).map_or(0, |(place, _)| *place);
                if let [u, v] = numbers[last..] {
                    let (start, roll) = (Vector2::new(u, v), &mut samples[place]);
                    if *roll.start.get_or_insert(start) != start {
                        let message = format!(
                            "columns `start_u`, `start_v`: the start of probe {probe} must be the same in all of its rows"
                        );
                        return Err(sheet.fail(line, message));
                    }
                }
                let (times, end) = numbers[first..last].split_at(time.len());
                let roll = Roll {
                    end: (line, end),
                    ..rolls[place]
                };
                let relative = roll.relative(kind, form, order, frame);
                let (mut turned, _) =
                    relative.map_err(|(line, message)| sheet.fail(line, message))?;
                if let Some(earlier) = samples[place].samples.last()
                    && (kind == Kind::Contacts || !form.is_vector())
                {
                    turned = unwrapped(turned, &earlier.rotation);
                }
                let contact = [end[end.len() - 2], end[end.len() - 1]];
                let since = times[0] - rolls[place].start_s;
                samples[place].samples.push(sample(since, turned, contact));
            }
            if equal_times > 0 {
                for (roll, series) in rolls.iter().zip(&mut samples) {
                    if !spread_times(&mut series.samples) {
                        let message =
                            format!("all rows of probe {} have the same time", roll.probe);
                        return Err(sheet.fail(roll.end.0, message));
                    }
                }
            }
            let starts_rotated = |roll: &Roll<'_>| {
                let start = Roll {
                    end: roll.start,
                    ..*roll
                };
                let start = start.relative(Kind::Rows, form, order, frame);
                start.is_ok_and(|(turned, _)| turned != Vector3::zeros())
            };
            Some(SeriesReadings {
                has_pads: kind == Kind::Pads,
                has_start_rotations: (kind == Kind::Contacts || !form.is_vector())
                    && rolls.iter().any(starts_rotated),
                rolls: samples,
            })
        }
    };
    let rows = turned.iter();
    let rows = rows.map(|(turned, [u, v])| reading(turned.x, turned.y, *u, *v));
    let readings = series
        .as_ref()
        .map_or_else(|| rows.collect(), SeriesReadings::ends);
    let mut recording = RollRecording {
        unit: sheet.unit,
        probes: rolls.iter().map(|roll| roll.probe).collect(),
        readings,
        rows: rolls.iter().map(|roll| roll.row).collect(),
        note: counted,
        series,
        ..RollRecording::new::<2>(&[], &[], None)?
    };
    recording.source.name.clone_from(&sheet.source.name);
    recording.source.notes = notes;
    recording.source.rows = sheet.source.rows;
    recording.extras = sheet.extras;
    Ok((recording, found.is_some()))
}

/// Spreads successive samples with equal times evenly until the next time. Returns false if all times are equal.
fn spread_times(samples: &mut [RollSample]) -> bool {
    let (mut start, mut interval) = (0, 0.0);
    while let Some(first) = samples.get(start).map(|one| one.time_s) {
        let count = samples[start..]
            .iter()
            .take_while(|one| one.time_s == first)
            .count();
        if let Some(next) = samples.get(start + count) {
            interval = (next.time_s - first) / count as f64;
        } else if interval == 0.0 && count > 1 {
            return false;
        }
        for (at, sample) in samples[start..start + count].iter_mut().enumerate() {
            sample.time_s += interval * at as f64;
        }
        start += count;
    }
    true
}

/// Error for a table without a header. The message proposes values of the setting `columns` with which the table
/// contains plausible rolls. `None` for other tables.
fn without_header(file: &RecordedFile) -> Option<RecordedError> {
    let table = TextTable::of(file, &[]).ok()?;
    let mut names = table.header.iter().enumerate();
    if !file.form.columns.is_empty() || !names.all(|(place, name)| *name == place.to_string()) {
        return None;
    }
    let count = table.header.len();
    let is_read = |layout: &Vec<&str>| {
        let numbers = (0..).map(|place: usize| place.to_string());
        let columns = layout.iter().map(|&name| name.to_owned()).zip(numbers);
        let form = Form {
            columns: columns.collect(),
            ..file.form.clone()
        };
        let mut file = file.clone();
        file.form = form;
        read_rolls(&file).is_ok_and(|(rolls, is_rolling)| {
            let mut shifts = rolls.readings.iter().map(|reading| reading.shift);
            is_rolling && shifts.any(|shift| shift != Vector2::zeros())
        })
    };
    let mut layouts = layouts(count);
    layouts.retain(is_read);
    let message = without_names(count, &layouts);
    Some(file.fail(table.header_line, message))
}

/// Usual orders of the columns in a table of rolls. Each order is a list of `count` column names.
fn layouts(count: usize) -> Vec<Vec<&'static str>> {
    let names =
        |columns: &[Column]| -> Vec<&str> { columns.iter().map(|column| column.name).collect() };
    let scalar_first = vec!["qw", "qx", "qy", "qz"];
    let forms = RotationForm::ALL.map(|form| names(form.columns()));
    let kinds = [
        (&[][..], &COLUMNS.rolls[3..]),
        (&COLUMNS.roll_series[1..2], &COLUMNS.contacts[..]),
    ];
    let mut layouts = Vec::new();
    for (time, contacts) in kinds {
        for probe in [&[][..], &COLUMNS.rolls[..1]] {
            for form in forms.iter().chain([&scalar_first]) {
                let names = [names(probe), names(time), form.clone(), names(contacts)].concat();
                layouts.push(names);
            }
        }
    }
    layouts.retain(|names| names.len() == count);
    layouts
}

/// The choice between the probe's frame and the world's frame matters if the rotations in both frames differ by more
/// than this value (relative). In this case, a note names the frame that was used.
const MAX_FRAME_DIFFERENCE: f64 = 0.02;

/// First and last row of a roll, each with its line number.
#[derive(Clone, Copy)]
struct Roll<'a> {
    probe: u64,
    row: usize,
    start_s: f64,
    start: (usize, &'a [f64]),
    end: (usize, &'a [f64]),
}

impl Roll<'_> {
    /// Rotation and shift from the start to the end of the roll. The error consists of the line number of a wrong row
    /// and a message.
    fn relative(
        &self,
        kind: Kind,
        form: RotationForm,
        order: [usize; 4],
        frame: RotationFrame,
    ) -> Result<Turned, (usize, String)> {
        let rotation = |(line, numbers): (usize, &[f64])| {
            let numbers = &numbers[..numbers.len() - 2];
            let ordered = order.map(|place| numbers.get(place).copied().unwrap_or_default());
            let numbers = if form == RotationForm::Quaternion {
                &ordered
            } else {
                numbers
            };
            form.rotation(numbers).map_err(|message| (line, message))
        };
        let place = |numbers: &[f64]| [numbers[numbers.len() - 2], numbers[numbers.len() - 1]];
        let (end, start) = (place(self.end.1), place(self.start.1));
        let is_vector = form.is_vector();
        let turned = match self.end.1 {
            // A rotation vector that is already relative to the start of the roll is not converted, because the
            // conversion would cause rounding errors.
            [x, y, _, _] if is_vector && kind != Kind::Contacts => Vector3::new(*x, *y, 0.0),
            [x, y, z, ..] if is_vector && kind != Kind::Contacts => Vector3::new(*x, *y, *z),
            // A quaternion cannot store a rotation of more than half a turn. It stores the shorter rotation about the
            // opposite axis. If the shift is against the rolling direction of the whole rotation, the probe has turned
            // by the shorter rotation.
            [x, y, z, angle, _, _] if kind == Kind::Rows && form == RotationForm::AxisAngle => {
                let shortest = rotation(self.end)?.scaled_axis();
                let axis = Vector3::new(*x, *y, *z);
                let whole = axis * (angle / axis.norm().max(0.5));
                let along = whole.x * end[1] - whole.y * end[0];
                if along < 0.0 { shortest } else { whole }
            }
            _ if kind == Kind::Rows => rotation(self.end)?.scaled_axis(),
            _ => between(&rotation(self.start)?, &rotation(self.end)?, frame),
        };
        Ok((
            turned,
            match kind {
                Kind::Rows => end,
                Kind::Pads if std::ptr::eq(self.start.1, self.end.1) => end,
                Kind::Pads | Kind::Contacts => [end[0] - start[0], end[1] - start[1]],
            },
        ))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A table with one row per probe.
    Rows,
    /// A time series per probe. Its columns contain the centre of the active pad.
    Pads,
    /// A time series per probe. Its columns contain the position of the contact.
    Contacts,
}

impl Kind {
    /// Kind of a table, recognised by its columns for the contact. If the table has the columns of several kinds, the
    /// user must choose by the setting `columns`.
    fn of(header: &Header<'_>) -> Result<Self, String> {
        let has = |column: &Column| header.has(column);
        let kinds = [
            (Self::Rows, &COLUMNS.rolls[3..]),
            (Self::Pads, &COLUMNS.roll_series[4..]),
            (Self::Contacts, &COLUMNS.contacts[..]),
        ];
        let any = |columns: &[Column]| columns.iter().any(has);
        let mut whole = kinds.to_vec();
        whole.retain(|(_, columns)| columns.iter().all(has));
        if let [_, _, ..] = whole[..] {
            whole.retain(|(_, columns)| header.is_assigned(columns));
            if whole.len() != 1 {
                let columns = if any(&COLUMNS.rolls[3..]) {
                    &COLUMNS.rolls[3..]
                } else {
                    &COLUMNS.contacts[..]
                };
                let names = header.pairs(columns, columns);
                return Err(format!(
                    "there are several of shift_u, shift_v; pad_u, pad_v; and contact_u, contact_v; state which to read, as in setting `columns` '{names}'"
                ));
            }
        }
        if let [(kind, _)] = whole[..] {
            return Ok(kind);
        }
        Ok(match () {
            () if any(&COLUMNS.roll_series[4..]) => Self::Pads,
            () if any(&COLUMNS.rolls[3..]) => Self::Rows,
            () if any(&COLUMNS.contacts) || header.time().is_some() => Self::Contacts,
            () => Self::Rows,
        })
    }
}

/// Number of the probe of each row, for a table without a column `probe`. `is_series` states whether the table contains
/// time series. Also returns a note on how the probes were determined.
fn count_probes(sheet: &ReadingTable, is_series: bool) -> (Vec<u64>, String) {
    let rows = sheet.source.lines.len();
    if !is_series {
        let note = format!("no column `probe`: each of the {rows} rows counts as a probe");
        return ((0..rows as u64).collect(), note);
    }
    let times: Vec<f64> = sheet.rows().map(|(_, numbers)| numbers[0]).collect();
    let is_start = |row: &usize| {
        let falls = *row > 0 && times[*row] <= times[*row - 1];
        falls || sheet.after_gaps.binary_search(row).is_ok()
    };
    let starts: Vec<usize> = (0..rows).filter(is_start).collect();
    let (parts, count) = parted(rows, &starts);
    let note = format!(
        "no column `probe`: blank lines, or times that do not increase, separate {count} probes"
    );
    (parts.into_iter().map(|part| part as u64).collect(), note)
}
