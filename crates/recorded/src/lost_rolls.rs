//! Rolls in which the shift of the contact was not measured. For such a lost reading, the drivers of some sensors write
//! zeros or a large number.

use std::f64::consts::PI;

use nalgebra::Vector2;
use palpate_ep1::{LeastSquares, ProbeReading, ReadingNoise};
use palpate_statistics::Number;
use palpate_study::config::LengthUnit;

use super::error::RecordedError;
use super::roll_options::RollOptions;
use super::roll_recording::RollRecording;
use super::roll_series::LeftOutProbe;
use super::single_direction::single_direction;

/// A measured contact shift of zero counts as a lost reading if the other rolls contradict it: they predict a shift
/// that is larger than this value times their root mean square residual.
const MIN_RESIDUALS: f64 = 8.0;
/// Relative tolerance in the test whether the shifts of the contacts are multiples of the pads' pitch. A tolerance is
/// needed because files contain rounded numbers.
const ROUNDING: f64 = 1e-6;
const MAX_SHARE: f64 = 0.2;

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
            _ => common_pitch(&sound),
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
}

/// Pitch of square pads, found from the components of the contact shifts. It is the smallest component that is not 0,
/// if all components are multiples of this component; otherwise 0.
fn common_pitch(readings: &[ProbeReading]) -> f64 {
    let shifts = readings.iter().map(|reading| reading.shift.abs());
    let lengths = shifts.flat_map(|shift| [shift.x, shift.y]);
    let lengths: Vec<f64> = lengths.filter(|length| *length > 0.0).collect();
    let pitch = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let is_multiple = |length: &f64| {
        let pitches = length / pitch;
        (pitches - pitches.round()).abs() <= ROUNDING * pitches
    };
    match lengths.iter().all(is_multiple) {
        true => pitch,
        false => 0.0,
    }
}
