//! Recorded readings of rolls: one reading per roll, or a time series per roll.

use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt::Display;

use nalgebra::{Vector2, Vector3};
use palpate_ep1::{ProbeReading, RollSample, RollSeries};
use palpate_study::config::LengthUnit;

use super::error::RecordedError;
use super::reading_table::ExtraColumns;
use super::roll_series::SeriesReadings;
use super::source::{ReadingSource, copies, finite, same_length};

/// Largest number of rolls for which repeated rolls are found by comparing all pairs. For more rolls, a hash table is
/// faster.
const MAX_COMPARED: usize = 32;
/// Consecutive rolls are merged as copies if each differs from the first roll of its group by at most this multiple of
/// the root-mean-square residual of all rolls. In addition, the largest such difference must be at most this multiple
/// of the smallest difference between two successive groups.
const MAX_COPY_DISTANCE: f64 = 0.2;

/// Recorded readings of rolls.
#[derive(Clone, Debug, PartialEq)]
pub struct RollRecording {
    pub(super) source: ReadingSource,
    /// Numbers of the probes in a file; empty for arrays, whose probes are numbered from 0.
    pub(super) probes: Vec<u64>,
    pub(super) readings: Vec<ProbeReading>,
    /// Unit of lengths that the header states; `None` if the header states none.
    pub unit: Option<LengthUnit>,
    /// Index of each probe's row in the file.
    pub(super) rows: Vec<usize>,
    /// Columns of the file that palpate does not use, row by row.
    pub(super) extras: ExtraColumns,
    /// Note on how the rows were assigned to probes; `None` if the file states the probe of each row.
    pub(super) note: Option<String>,
    /// All samples of each roll, for time series; `None` if each probe has only one row.
    pub(super) series: Option<SeriesReadings>,
}

impl RollRecording {
    /// Builds a recording of rolls, one reading per probe. `rotations` contains the rotation vector of each probe
    /// (rad), and `shifts` the shift of its contact. A rotation may have a third component about the normal, which does
    /// not move the contact. Lengths are in `unit`.
    ///
    /// ```
    /// use palpate_recorded::{RollOptions, RollRecording, estimate_roll};
    ///
    /// // A probe of radius 10 that is turned by 0.3 on a ball of radius 20 rolls over 2.
    /// let rotations = [[0.0, -0.3], [0.3, 0.0]];
    /// let readings = RollRecording::new(&rotations, &[[2.0, 0.0], [0.0, 2.0]], None)?;
    /// let estimate = estimate_roll(readings, &RollOptions::new(10.0))?;
    /// assert_eq!(serde_json::to_value(estimate)?["probes"], 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordedError::Array`] if a number is not finite, or if there are more or fewer shifts than rotations.
    pub fn new<const D: usize>(
        rotations: &[[f64; D]],
        shifts: &[[f64; 2]],
        unit: Option<LengthUnit>,
    ) -> Result<Self, RecordedError> {
        const { assert!(D == 2 || D == 3) };
        same_length(("shifts", shifts.len()), ("rotations", rotations.len()))?;
        finite("rotations", rotations)?;
        finite("shifts", shifts)?;
        let pairs = rotations.iter().zip(shifts);
        Ok(Self {
            source: ReadingSource::arrays(),
            probes: Vec::new(),
            readings: pairs
                .map(|(turned, [u, v])| reading(turned[0], turned[1], *u, *v))
                .collect(),
            unit,
            rows: Vec::new(),
            extras: ExtraColumns::default(),
            note: None,
            series: None,
        })
    }

    /// Builds a recording of rolls as time series, one row per sample: time (s), rotation vector of the probe since the
    /// start of its roll, and position of the contact. A new roll starts where the time does not increase. If
    /// `has_pads`, the positions are centres of active pads.
    ///
    /// # Errors
    /// The errors of [`RollRecording::new`].
    pub fn of_series<const D: usize>(
        times_s: &[f64],
        rotations: &[[f64; D]],
        places: &[[f64; 2]],
        has_pads: bool,
        unit: Option<LengthUnit>,
    ) -> Result<Self, RecordedError> {
        same_length(("times", times_s.len()), ("rotations", rotations.len()))?;
        let times: Vec<[f64; 1]> = times_s.iter().map(|&time| [time]).collect();
        finite("times", &times)?;
        let all = Self::new(rotations, places, unit)?;
        let mut rolls: Vec<RollSeries> = Vec::new();
        let mut start = 0.0;
        for (row, (&time, rotation)) in times_s.iter().zip(rotations).enumerate() {
            if row == 0 || time <= times_s[row - 1] {
                rolls.push(RollSeries {
                    has_spin: D == 3,
                    ..RollSeries::default()
                });
                start = time;
            }
            let turn = rotation.get(2).copied().unwrap_or_default();
            let turned = Vector3::new(rotation[0], rotation[1], turn);
            let sample = sample(time - start, turned, places[row]);
            if let Some(roll) = rolls.last_mut() {
                roll.samples.push(sample);
            }
        }
        let starts_rotated = |roll: &RollSeries| roll.samples[0].rotation != Vector3::zeros();
        let series = SeriesReadings {
            has_pads,
            has_start_rotations: !has_pads && rolls.iter().any(starts_rotated),
            rolls,
        };
        Ok(Self {
            readings: series.ends(),
            series: Some(series),
            ..all
        })
    }

    /// Leaves out rolls that repeat an earlier roll, if at least half of all rolls are repetitions. Returns a warning;
    /// `None` if no roll was left out. If some rolls have equal rotations but different shifts, no roll is left out:
    /// the equal readings may then come from a coarse sensor.
    pub(super) fn leave_out_copies(&mut self) -> Option<String> {
        let readings = &self.readings;
        let is_repeated = |(place, one)| readings[..place].contains(one);
        // If there are only a few rolls, compare each roll with all others, because building a hash table would take
        // longer than the estimate.
        if readings.len() <= MAX_COMPARED && !readings.iter().enumerate().any(is_repeated) {
            return None;
        }
        let mut shifts = HashMap::new();
        let repeats = |reading: &ProbeReading| {
            let bits = |numbers: Vector2<f64>| numbers.map(|number| (number + 0.0).to_bits());
            let first = shifts.entry(bits(reading.rotation));
            *first.or_insert(reading.shift) == reading.shift
        };
        if !readings.iter().all(repeats) {
            return None;
        }
        let rolls = readings.iter().map(|reading| {
            let ([x, y], [u, v]) = (reading.rotation.into(), reading.shift.into());
            [x, y, u, v]
        });
        self.leave_out_repeated(rolls.collect(), 0.5)
    }

    /// Merges consecutive rolls that differ much less than their noise, because a recorder wrote the same roll several
    /// times with small changes. `residual` is the root-mean-square residual of all rolls. Returns the merged rolls and
    /// a warning. `None` if fewer than half of the rolls are copies, or if the rolls change so evenly that copies cannot
    /// be told from slow changes. Equal rolls may come from a coarse sensor, so they are not merged.
    pub(super) fn without_near_copies(
        &self,
        residual: f64,
        probe_radius: f64,
    ) -> Option<(Self, String)> {
        let rolls = &self.readings;
        let difference = |one: usize, other: usize| {
            let (one, other) = (&rolls[one], &rolls[other]);
            let turned = (one.rotation - other.rotation).norm() * probe_radius;
            turned.max((one.shift - other.shift).norm())
        };
        let limit = MAX_COPY_DISTANCE * residual;
        let is_near = |roll: &usize| difference(roll - 1, *roll) <= 2.0 * limit;
        if 2 * (1..rolls.len()).filter(is_near).count() < rolls.len() {
            return None;
        }
        let (mut firsts, mut within, mut between) = (Vec::new(), 0.0_f64, f64::INFINITY);
        for roll in 0..rolls.len() {
            match firsts.last() {
                Some(&first)
                    if difference(first, roll) <= limit && rolls[roll - 1] != rolls[roll] =>
                {
                    within = within.max(difference(first, roll));
                }
                Some(_) => {
                    between = between.min(difference(roll - 1, roll));
                    firsts.push(roll);
                }
                None => firsts.push(roll),
            }
        }
        let count = rolls.len() - firsts.len();
        if firsts.len() < 2 || count < firsts.len() || within > MAX_COPY_DISTANCE * between {
            return None;
        }
        let mut merged = self.clone();
        merged.keep(&firsts);
        let ends = firsts[1..].iter().copied().chain([rolls.len()]);
        for ((mean, &first), end) in merged.readings.iter_mut().zip(&firsts).zip(ends) {
            let (group, share) = (&rolls[first..end], 1.0 / (end - first) as f64);
            mean.rotation = group.iter().map(|one| one.rotation * share).sum();
            mean.shift = group.iter().map(|one| one.shift * share).sum();
        }
        let text = format!(
            "{count} rows differ from the row before them by at most a fifth of the noise: they are copies of one roll, so their mean counts once"
        );
        Some((merged, text))
    }

    /// Leaves out time series that repeat an earlier time series. Returns a warning; `None` if none was left out.
    pub(super) fn leave_out_copied_series(&mut self) -> Option<String> {
        // Equal time series have equal sums. Different rolls that are not all zero have different sums in practice.
        let sums = |roll: &RollSeries| {
            let samples = roll.samples.iter().zip(1..);
            samples.fold([0.0; 5], |[time, x, y, u, v], (sample, number)| {
                let weight = f64::from(number);
                let ([turned_x, turned_y, _], [at_u, at_v]) =
                    (sample.rotation.into(), sample.place.into());
                [
                    time + sample.time_s,
                    x + turned_x,
                    y + turned_y,
                    u + weight * at_u,
                    v + weight * at_v,
                ]
            })
        };
        let series = self.series.as_ref()?;
        self.leave_out_repeated(series.rolls.iter().map(sums).collect(), 0.0)
    }

    /// Leaves out each roll whose numbers in `rolls` equal those of an earlier roll, and returns a warning. No roll is
    /// left out, and the result is `None`, in three cases: no roll is repeated, the repeated rolls are less than the
    /// fraction `share` of all rolls, or only one roll would remain.
    fn leave_out_repeated<const N: usize>(
        &mut self,
        rolls: Vec<[f64; N]>,
        share: f64,
    ) -> Option<String> {
        let row = |&row: &usize| self.source.row_number(row) - 1;
        self.source.rows = self.rows.iter().map(row).collect();
        let text = self.source.repeated("roll", rolls.iter().copied(), share)?;
        let mut copied = copies(rolls.iter().copied()).into_iter().peekable();
        let kept = (0..rolls.len()).filter(|roll| copied.next_if_eq(roll).is_none());
        let kept: Vec<usize> = kept.collect();
        (kept.len() > 1).then(|| {
            self.keep(&kept);
            text
        })
    }

    pub(super) fn keep(&mut self, rolls: &[usize]) {
        self.probes = rolls.iter().map(|&roll| self.probe(roll)).collect();
        self.readings = rolls.iter().map(|&roll| self.readings[roll]).collect();
        let rows = rolls
            .iter()
            .filter_map(|&roll| self.rows.get(roll).copied());
        self.rows = rows.collect();
        if let Some(series) = &mut self.series {
            let rolls = rolls
                .iter()
                .map(|&roll| std::mem::take(&mut series.rolls[roll]));
            series.rolls = rolls.collect();
        }
    }

    /// The reading of each roll where the probe is turned furthest. For least squares (`is_of_ends`), it is the reading
    /// at the end of the roll.
    pub(super) fn farthest(&self, is_of_ends: bool) -> Cow<'_, [ProbeReading]> {
        let Some(series) = self.series.as_ref().filter(|_| !is_of_ends) else {
            return Cow::Borrowed(&self.readings);
        };
        let farthest = |roll: &RollSeries| {
            let RollSample {
                rotation, place, ..
            } = roll.farthest()?;
            let moved = place - roll.samples[0].place;
            Some(reading(rotation.x, rotation.y, moved.x, moved.y))
        };
        series.rolls.iter().filter_map(farthest).collect()
    }

    /// The text of an error about too few rolls. If the file does not name the rolls, the text states how they were
    /// separated.
    pub(super) fn with_note(&self, error: &dyn Display) -> String {
        let note = self.note.as_ref();
        note.map_or(error.to_string(), |note| format!("{error}; {note}"))
    }

    /// Number of the probe to which a reading belongs, as the file states it; for arrays, the index of the probe.
    pub(super) fn probe(&self, reading: usize) -> u64 {
        self.probes.get(reading).copied().unwrap_or(reading as u64)
    }
}

pub(super) fn sample(time_s: f64, rotation: Vector3<f64>, place: [f64; 2]) -> RollSample {
    RollSample {
        time_s,
        rotation,
        place: Vector2::from(place),
    }
}

pub(super) fn reading(rotation_x: f64, rotation_y: f64, u: f64, v: f64) -> ProbeReading {
    ProbeReading {
        rotation: Vector2::new(rotation_x, rotation_y),
        shift: Vector2::new(u, v),
    }
}
