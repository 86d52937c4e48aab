//! Rolls, and samples of rolls, in which the place of the contact was not measured. For such a lost reading, the
//! drivers of some sensors write zeros or another fixed number.

use std::f64::consts::PI;

use nalgebra::Vector2;
use palpate_ep1::{LeastSquares, ProbeReading, ReadingNoise, RollSample, RollSeries};
use palpate_statistics::Number;
use palpate_study::Warning;
use palpate_study::config::LengthUnit;

use super::error::RecordedError;
use super::log_warnings::listed;
use super::roll_options::RollOptions;
use super::roll_recording::RollRecording;
use super::roll_series::{LeftOutProbe, SeriesReadings};
use super::single_direction::single_direction;

/// A measured contact shift of zero counts as a lost reading if the other rolls contradict it: they predict a shift
/// that is larger than this value times their root mean square residual.
const MIN_RESIDUALS: f64 = 8.0;
/// Tolerance, relative to the longest shift, in the search for a common step of all shifts. A tolerance is needed because
/// files contain rounded numbers.
const ROUNDING: f64 = 1e-6;
/// Least common step of all shifts, relative to the longest shift.
const MIN_STEP_SHARE: f64 = 1e-3;
const MAX_SHARE: f64 = 0.2;
/// A contact counts as lost if its distance from the contacts before and after it exceeds this multiple of the longest
/// step from one sample to the next, for each sampling period between them.
const MAX_STEPS: f64 = 3.0;
/// In this test, the longest step counts as at least this fraction of the probe's radius.
const MIN_STEP: f64 = 0.01;
/// Smallest number of intervals between two changes of a reading, in all rolls together, from which the update interval of
/// the sensor is estimated.
const MIN_INTERVALS: usize = 12;
/// A reading is held if several rows repeat it until the sensor's next update. A rotation or a contact counts as held if at
/// least this share of its runs of equal values have the median length ± 1 row.
const MIN_HELD_SHARE: f64 = 0.9;
/// Active pads count as held only if the median number of rows between two changes is at least this multiple of the
/// number of rows of a held reading. At a smaller ratio, the intervals between changes may be equal because the contact
/// crosses the pads at a constant speed.
const MIN_HELD_RATIO: usize = 3;
/// A single sample on another pad counts as stale only if at least this number of samples before and after it are on
/// one pad.
const MIN_AROUND: usize = 10;

#[derive(Clone, Copy, PartialEq)]
enum Loss {
    /// The shift of the contact is longer than half of the probe's circumference.
    Far,
    /// The shift of the contact is zero, but the other rolls show that the contact moved.
    Zero,
}

impl RollRecording {
    /// Leaves out rolls in which the reading of the contact's shift was lost, and returns these rolls.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if more than a fifth of the rolls would be left out.
    pub(super) fn leave_out_lost(
        &mut self,
        options: &RollOptions,
        unit: LengthUnit,
    ) -> Result<Vec<LeftOutProbe>, RecordedError> {
        let half_way = PI * options.probe_radius * (1.0 + 1e-9);
        let loss = |reading: &ProbeReading| match reading.shift {
            shift if shift.norm_squared() > half_way * half_way => Some(Loss::Far),
            shift if shift == Vector2::zeros() && reading.rotation != Vector2::zeros() => {
                Some(Loss::Zero)
            }
            _ => None,
        };
        if !self.readings.iter().any(|reading| loss(reading).is_some()) {
            return Ok(Vec::new());
        }
        let mut losses: Vec<Option<Loss>> = self.readings.iter().map(loss).collect();
        if !self.accept_zeros(&mut losses, options) {
            let zeros = losses.iter_mut().filter(|loss| **loss == Some(Loss::Zero));
            zeros.for_each(|loss| *loss = None);
        }
        let lost = losses.iter().enumerate();
        let lost = lost.filter_map(|(roll, loss)| Some((roll, (*loss)?)));
        let lost: Vec<(usize, Loss)> = lost.collect();
        if let Some(&(first, loss)) = lost.first()
            && lost.len() as f64 > MAX_SHARE * self.readings.len() as f64
        {
            return Err(self.too_many_lost(first, loss, lost.len(), options, unit));
        }
        let left_out = lost.iter().map(|&(roll, loss)| LeftOutProbe {
            probe: self.probe(roll),
            row: self.rows.get(roll).map(|&row| self.source.row_number(row)),
            reason: match loss {
                Loss::Far => {
                    "lost reading (the contact's shift is longer than half of the probe's circumference)"
                }
                Loss::Zero => {
                    "lost reading (the contact's shift is 0, but other rolls show that the contact moved)"
                }
            },
        });
        let left_out = left_out.collect();
        let kept = (0..losses.len()).filter(|&roll| losses[roll].is_none());
        self.keep(&kept.collect::<Vec<_>>());
        Ok(left_out)
    }

    /// Removes from `losses` each shift of zero that the other rolls do not contradict: they predict a shift that is at
    /// most as large as the pads' pitch, or not clearly larger than the noise. Returns false if the other rolls do not
    /// predict shifts.
    fn accept_zeros(&self, losses: &mut [Option<Loss>], options: &RollOptions) -> bool {
        let sound = self.readings.iter().zip(losses.iter());
        let sound = sound.filter(|(_, loss)| loss.is_none());
        let sound: Vec<ProbeReading> = sound.map(|(reading, _)| *reading).collect();
        let radius = options.probe_radius;
        let exact = ReadingNoise::default();
        let single = |rolls: &[ProbeReading]| single_direction(rolls, radius, &exact).ok()?;
        let fitted = single(&self.readings).and_then(|_| single(&sound));
        let fitted = fitted.map_or_else(|| sound.clone(), |(_, fitted, _)| fitted);
        let Ok(estimate) = LeastSquares::of(radius, exact, &fitted) else {
            return false;
        };
        let residual = estimate.residual(&fitted[..sound.len()]).0;
        let noise = options.noise.shift_std.max(residual);
        let hidden = match options.noise.shift_resolution {
            stated if stated > 0.0 => stated,
            _ => common_step(&sound),
        };
        let hidden = (hidden * (1.0 + ROUNDING)).max(MIN_RESIDUALS * noise);
        for (reading, loss) in self.readings.iter().zip(losses) {
            let is_possible = estimate.shift(&reading.rotation).amax() <= hidden;
            loss.take_if(|loss| *loss == Loss::Zero && is_possible);
        }
        true
    }

    fn too_many_lost(
        &self,
        roll: usize,
        loss: Loss,
        count: usize,
        options: &RollOptions,
        unit: LengthUnit,
    ) -> RecordedError {
        let (probe, name) = (self.probe(roll), unit.as_str());
        let text = match loss {
            Loss::Far => {
                let shift = self.readings[roll].shift;
                let [shift, half] =
                    [libm::hypot(shift.x, shift.y), PI * options.probe_radius].map(Number);
                format!(
                    "probe {probe}: a shift of {shift} {name} is longer than half of the probe's circumference ({half} {name})"
                )
            }
            Loss::Zero => format!(
                "the shift of probe {probe} is 0, but other rolls show that the contact moved; {count} of {} rolls have such lost readings: leave them out, or state the pitch of the pads",
                self.readings.len()
            ),
        };
        let units = self.units(true, options.probe_radius, unit);
        self.source
            .fail(units.map_or(text.clone(), |(more, _)| format!("{text}; {more}")))
    }

    /// Leaves out samples that repeat earlier readings, with warnings. If a sensor updates its readings less often than
    /// rows are written, the rows between two updates repeat held readings. A single sample may also be on a
    /// wrong pad, for example an old one.
    pub(super) fn leave_out_repeated_samples(&mut self) {
        let Some(mut series) = self.series.take() else {
            return;
        };
        let total: usize = series.rolls.iter().map(|roll| roll.samples.len()).sum();
        let held = fresh_samples(&series).map(|(fresh, rows)| {
            let count: usize = fresh.iter().map(Vec::len).sum();
            for (roll, fresh) in series.rolls.iter_mut().zip(fresh) {
                roll.samples = fresh.into_iter().map(|at| roll.samples[at]).collect();
            }
            format!(
                "the sensor updates its readings only every {rows} rows; {} of {total} samples repeat earlier readings and are left out",
                total - count
            )
        });
        let mut stale = Vec::new();
        let rolls = series.rolls.iter_mut().enumerate();
        for (roll, one) in rolls.filter(|_| series.has_pads) {
            for at in stale_samples(&one.samples).into_iter().rev() {
                let time_s = Number::rounded(one.samples.remove(at).time_s);
                stale.push(format!("probe {} after {time_s} s", self.probe(roll)));
            }
        }
        let stale = (!stale.is_empty()).then(|| {
            let stale = listed(stale.into_iter());
            format!(
                "left out, because the samples before and after are all on one other pad: {stale}"
            )
        });
        if held.is_some() || stale.is_some() {
            self.readings = series.ends();
        }
        let texts = held.into_iter().chain(stale);
        let warnings = texts.map(|text| Warning::new("left-out", text, []));
        self.source.notes.extend(warnings);
        self.series = Some(series);
    }

    /// Leaves out the samples of time series in which the contact was lost, and returns a warning text; `None` if no
    /// sample was lost.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if more than a fifth of the samples would be left out.
    pub(super) fn leave_out_lost_samples(
        &mut self,
        options: &RollOptions,
        unit: LengthUnit,
    ) -> Result<Option<String>, RecordedError> {
        let (radius, Some(series)) = (options.probe_radius, &self.series) else {
            return Ok(None);
        };
        // A sensor may write one value, such as 0, in both coordinates of a lost contact. Only contact points are
        // searched for such values, because (0, 0) may be the centre of an active pad.
        let contacts = series.rolls.iter().filter(|_| !series.has_pads);
        let values = contacts.flat_map(|roll| lost_values(roll, MIN_STEP * radius));
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let is_value = |at: f64| values.binary_search_by(|one| one.total_cmp(&at)).is_ok();
        let is_lost = |RollSample { place, .. }: &RollSample| {
            place.norm() > PI * radius * (1.0 + 1e-9) || (place.x == place.y && is_value(place.x))
        };
        let mut samples = series.rolls.iter().flat_map(|roll| &roll.samples);
        if !samples.any(is_lost) {
            return Ok(None);
        }
        let (mut kept, mut lost, mut total) = (series.clone(), Vec::new(), 0);
        for (roll, kept) in kept.rolls.iter_mut().enumerate() {
            total += kept.samples.len();
            let samples = kept.samples.extract_if(.., |one| is_lost(one));
            lost.extend(samples.map(|one| (self.probe(roll), one)));
        }
        let at = |(probe, sample): &(u64, RollSample)| {
            format!("probe {probe} after {} s", Number::rounded(sample.time_s))
        };
        let [u, v] = lost[0].1.place.map(Number).into();
        let count = format!("{} of {total} samples", lost.len());
        if lost.len() as f64 > MAX_SHARE * total as f64 {
            let units = self.units(false, radius, unit);
            let units = units.map_or_else(String::new, |(more, _)| format!("; {more}"));
            return Err(self.source.fail(format!(
                "{}: the contact ({u}, {v}) is far from the contacts before and after it, or more than half of the probe's circumference from the origin; {count} have such lost contacts: leave these samples out{units}",
                at(&lost[0])
            )));
        }
        let text = format!(
            "{count} are left out because their contacts were lost, the first one at ({u}, {v}): {}",
            listed(lost.iter().map(at))
        );
        let rolls = (0..kept.rolls.len()).filter(|&roll| !kept.rolls[roll].samples.is_empty());
        let rolls: Vec<usize> = rolls.collect();
        self.series = Some(kept);
        self.keep(&rolls);
        self.readings = self.series.iter().flat_map(SeriesReadings::ends).collect();
        Ok(Some(text))
    }
}

/// For each roll, the indices of the samples with new readings, and the number of rows for which readings are held.
/// `None` if no readings are held.
fn fresh_samples(series: &SeriesReadings) -> Option<(Vec<Vec<usize>>, usize)> {
    let changes = |is_new: fn(&RollSample, &RollSample) -> bool| -> Vec<Vec<usize>> {
        let new = |roll: &RollSeries| {
            let pairs = roll.samples.windows(2).zip(1..);
            let new = pairs.filter(|(pair, _)| is_new(&pair[0], &pair[1]));
            new.map(|(_, at)| at).collect()
        };
        series.rolls.iter().map(new).collect()
    };
    let turned = changes(|one, other| one.rotation != other.rotation);
    let moved = changes(|one, other| one.place != other.place);
    let samples = || series.rolls.iter().flat_map(|roll| &roll.samples);
    // Readings that are multiples of a large step repeat because of this step.
    let angles = samples().flat_map(|one| [one.rotation.x, one.rotation.y]);
    let places = samples().flat_map(|one| [one.place.x, one.place.y]);
    let turned_hold = hold_of(&turned, false).filter(|_| step_of(angles) == 0.0);
    let moved_hold = hold_of(&moved, series.has_pads);
    let moved_hold = moved_hold.filter(|_| series.has_pads || step_of(places) == 0.0);
    let rows = turned_hold.max(moved_hold)?;
    let fresh = |roll: usize, [turned_hold, moved_hold]: [Option<usize>; 2]| -> Vec<usize> {
        let samples = &series.rolls[roll].samples;
        let (turned, moved) = (&turned[roll], &moved[roll]);
        let is_new = |at: &usize| *at == 0 || turned.binary_search(at).is_ok();
        let is_moved = |at: &usize, hold: usize| match series.has_pads {
            true => at % hold == moved.first().map_or(0, |first| first % hold),
            false => *at == 0 || moved.binary_search(at).is_ok(),
        };
        let all = 0..samples.len();
        let all = all.filter(|at| turned_hold.is_none() || is_new(at));
        all.filter(|at| moved_hold.is_none_or(|hold| is_moved(at, hold)))
            .collect()
    };
    // The rotations and the places may be updated in different rows.
    let total = samples().count();
    let choices = [
        [turned_hold, moved_hold],
        [None, moved_hold],
        [turned_hold, None],
    ];
    let mut choices = choices.into_iter().map(|holds| -> Vec<Vec<usize>> {
        let rolls = 0..series.rolls.len();
        rolls.map(|roll| fresh(roll, holds)).collect()
    });
    let found =
        choices.find(|fresh| fresh.iter().map(Vec::len).sum::<usize>() * rows * 2 > total)?;
    Some((found, rows))
}

/// Number of rows for which a reading is held. `changes` contains the rows of each roll in which the reading changed. Active
/// pads change rarely, so all intervals between their changes must be multiples of this number. `None` if the reading is
/// updated in each row, or irregularly.
fn hold_of(changes: &[Vec<usize>], is_pad: bool) -> Option<usize> {
    let pairs = changes.iter().flat_map(|rows| rows.windows(2));
    let mut lengths: Vec<usize> = pairs.map(|pair| pair[1] - pair[0]).collect();
    lengths.sort_unstable();
    let count = lengths.len();
    let usual = *lengths.get(count / 2)?;
    let divisor = |mut one: usize, mut other: usize| {
        while other > 0 {
            (one, other) = (other, one % other);
        }
        one
    };
    let steady = lengths.iter().filter(|length| length.abs_diff(usual) <= 1);
    let is_steady = steady.count() as f64 >= MIN_HELD_SHARE * count as f64;
    let (hold, is_sure) = match is_pad {
        true => {
            let hold = lengths.into_iter().fold(0, divisor);
            (hold, usual >= MIN_HELD_RATIO * hold)
        }
        false => (usual, is_steady),
    };
    (hold > 1 && count >= MIN_INTERVALS && is_sure).then_some(hold)
}

/// Indices of single samples on another pad than the samples before and after them, which are all on one pad. Samples are
/// not in the result if pads alternate at an edge, or if the probe turns back.
fn stale_samples(samples: &[RollSample]) -> Vec<usize> {
    let runs: Vec<_> = samples
        .chunk_by(|one, next| one.place == next.place)
        .collect();
    let (mut stale, mut at) = (Vec::new(), 0);
    for (index, three) in runs.windows(3).enumerate() {
        at += three[0].len();
        let (before, own, after) = (three[0][three[0].len() - 1], three[1][0], three[2][0]);
        let is_long = three[0].len().min(three[2].len()) >= MIN_AROUND;
        let is_single = three[1].len() == 1 && before.place == after.place && is_long;
        // Other short runs on the same pad show that pads alternate at an edge.
        let is_short = |run: &[RollSample]| run[0].place == own.place && run.len() < MIN_AROUND;
        let near = [index.checked_sub(1), Some(index + 3)]
            .into_iter()
            .flatten();
        let alternates = near.filter_map(|at| runs.get(at)).any(|run| is_short(run));
        let turned = (own.rotation - before.rotation).dot(&(after.rotation - own.rotation));
        if is_single && !alternates && turned > 0.0 {
            stale.push(at);
        }
    }
    stale
}

/// Values that a sensor wrote for lost contacts in `roll`. Both coordinates of such a contact have this value, and the
/// contact is far from the contacts before and after it. A contact that is at most [`MAX_STEPS`] times `min_step` from
/// them is never far.
fn lost_values(roll: &RollSeries, min_step: f64) -> Vec<f64> {
    let samples = &roll.samples;
    let is_doubtful = |at: &usize| samples[*at].place.x == samples[*at].place.y;
    let (doubtful, sound): (Vec<usize>, Vec<usize>) = (0..samples.len()).partition(is_doubtful);
    let Some(last) = samples.last().filter(|_| !doubtful.is_empty()) else {
        return Vec::new();
    };
    let period = (last.time_s - samples[0].time_s) / (samples.len() - 1) as f64;
    let distance = |one: usize, other: usize| (samples[one].place - samples[other].place).norm();
    let steps = sound.windows(2).filter(|pair| pair[1] == pair[0] + 1);
    let steps = steps.map(|pair| distance(pair[0], pair[1]));
    let longest = steps.fold(min_step, f64::max);
    let is_jump = |one: usize, other: usize| {
        let periods = (samples[one].time_s - samples[other].time_s).abs() / period;
        distance(one, other) > MAX_STEPS * longest * periods.max(one.abs_diff(other) as f64)
    };
    let is_lost = |at: &usize| {
        let next = sound.partition_point(|sound| sound < at);
        let near = &sound[next.saturating_sub(1)..sound.len().min(next + 1)];
        !near.is_empty() && near.iter().all(|other| is_jump(*at, *other))
    };
    let lost = doubtful.into_iter().filter(is_lost);
    lost.map(|at| samples[at].place.x).collect()
}

/// Largest length of which the components of all contact shifts are multiples. It may be the pitch of square pads, or a
/// multiple of the pitch. Returns 0 if there is no such length that is longer than 1/1000 of the longest component,
/// because shorter lengths may be due to the number of digits.
pub(super) fn common_step(readings: &[ProbeReading]) -> f64 {
    step_of(readings.iter().flat_map(|one| [one.shift.x, one.shift.y]))
}

/// Like [`common_step`], for any numbers.
pub(super) fn step_of(numbers: impl Iterator<Item = f64>) -> f64 {
    let lengths: Vec<f64> = numbers.map(f64::abs).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let least = MIN_STEP_SHARE * longest;
    // Euclid's algorithm for the greatest common divisor, with a tolerance.
    let step = lengths.into_iter().fold(longest, |mut step, mut length| {
        while length > ROUNDING * longest && step > least {
            (step, length) = (length, step % length);
            length = length.min(step - length);
        }
        step
    });
    if step > least { step } else { 0.0 }
}
