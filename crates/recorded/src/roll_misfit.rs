//! Warnings about recorded rolls and their estimate.

use std::collections::HashMap;

use nalgebra::Vector2;
use palpate_ep1::{PadStart, ProbeReading};
use palpate_statistics::StatedQuantity;
use palpate_study::Warning;

use super::duplicate_rows::repeated;
use super::input_checks::{of_flatness, of_pitch, of_roll, of_rotation_noise};
use super::misfit_warning::ReadingWords;
use super::roll_estimate::RollEstimate;
use super::roll_recording::RollRecording;

impl RollEstimate {
    /// Contradictions between the readings and the model, and likely mistakes in the readings.
    pub fn warnings(&self) -> Vec<Warning> {
        let Self {
            recorded,
            options,
            unit,
            estimate,
            ..
        } = self;
        let (readings, noise) = (&recorded.readings, &options.noise);
        let words = ReadingWords {
            reading: &|probe| format!("probe {}", recorded.probe(probe)),
            noise_of: "shifts",
            unit: unit.as_str(),
        };
        let units = of_roll(readings, options.probe_radius, *unit);
        let misfits = estimate.misfits(*noise, readings);
        let flat = of_flatness(estimate, options.probe_radius, *unit);
        let pitch = of_pitch(readings, noise.shift_resolution, *unit);
        let rotations = of_rotation_noise(readings, noise);
        Warning::of("units", units)
            .into_iter()
            .chain(misfits.iter().map(|misfit| words.warning(misfit)))
            .chain(Warning::of("flat-object", flat))
            .chain(Warning::of(StatedQuantity::Pitch.code(), pitch))
            .chain(Warning::of("units", rotations))
            .chain(Warning::of("repeated-rows", self.copies()))
            .chain(Warning::of("unnamed-probes", recorded.note.clone()))
            .collect()
    }

    /// Warns if at least half of the rolls repeat earlier rolls. There is no warning if rolls by equal rotations have
    /// different shifts: then coarse sensors may cause the repetitions.
    fn copies(&self) -> Option<String> {
        let RollRecording {
            readings, origin, ..
        } = &self.recorded;
        let mut shifts = HashMap::new();
        let repeats = |reading: &ProbeReading| {
            let bits = |numbers: Vector2<f64>| numbers.map(|number| (number + 0.0).to_bits());
            let first = shifts.entry(bits(reading.rotation));
            *first.or_insert(reading.shift) == reading.shift
        };
        if self.options.noise.pad_start != PadStart::PerRoll || !readings.iter().all(repeats) {
            return None;
        }
        let rolls = readings.iter().map(|reading| {
            let ([x, y], [u, v]) = (reading.rotation.into(), reading.shift.into());
            [x, y, u, v]
        });
        repeated(origin, "roll", rolls, 0.5)
    }
}
