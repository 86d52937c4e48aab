//! Agreement of recorded rolls with their estimate.

use std::collections::HashMap;
use std::sync::OnceLock;

use nalgebra::Vector2;
use palpate_ep1::{Agreement, Doubt, Estimate, LeastSquares, PadStart, ProbeReading, ReadingNoise};
use palpate_statistics::{GoodnessOfFit, Number};
use palpate_study::config::LengthUnit;
use serde::{Serialize, Serializer};

use super::duplicate_rows::repeated;
use super::input_checks::{of_flatness, of_pitch, of_rotation_noise, of_small_residuals};
use super::misfit::{Misfit, poor_fit};
use super::roll_recording::{RollOptions, RollRecording};
use palpate_study::Warning;

/// Agreement of readings with their estimate, computed when first serialized: it takes longer than the estimate.
#[derive(Clone, Debug)]
pub(super) struct RollMisfit {
    estimated: Estimated,
    told: OnceLock<Told>,
}

/// Readings with their estimate.
#[derive(Clone, Debug, PartialEq)]
struct Estimated {
    /// Numbers of the probes, as recorded.
    probes: Vec<u64>,
    readings: Vec<ProbeReading>,
    probe_radius: f64,
    noise: ReadingNoise,
    /// The fit with `noise`, and its estimate.
    fit: LeastSquares,
    estimate: Estimate,
    unit: LengthUnit,
    /// Root mean square of the residuals, length.
    residual: f64,
    suspicion: Option<String>,
    copies: Option<String>,
    note: Option<String>,
}

/// Agreement as it is serialized.
#[derive(Clone, Debug, Serialize)]
struct Told {
    /// Goodness-of-fit p-value by the stated noise; `null` if no noise is stated.
    p_value: Option<f64>,
    /// Contradictions between the readings and the model, each with its p-value, and likely mistakes in the readings.
    warnings: Vec<Warning>,
}

impl PartialEq for RollMisfit {
    fn eq(&self, other: &Self) -> bool {
        self.estimated == other.estimated
    }
}

impl Serialize for RollMisfit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.told
            .get_or_init(|| self.estimated.told())
            .serialize(serializer)
    }
}

impl RollMisfit {
    pub(super) fn new(
        recorded: &RollRecording,
        options: &RollOptions,
        unit: LengthUnit,
        (fit, estimate): (LeastSquares, Estimate),
        suspicion: Option<String>,
    ) -> Self {
        let (residual, _) = estimate.residual(&recorded.readings);
        let estimated = Estimated {
            probes: recorded.probes.clone(),
            readings: recorded.readings.clone(),
            probe_radius: options.probe_radius,
            noise: options.noise,
            fit,
            estimate,
            unit,
            residual,
            suspicion,
            copies: copies(recorded, &options.noise),
            note: recorded.note.clone(),
        };
        Self {
            estimated,
            told: OnceLock::new(),
        }
    }
}

/// Warns if at least half of the rolls repeat earlier rolls. There is no warning if rolls by equal rotations have
/// different shifts: then coarse sensors may cause the repetitions.
fn copies(recorded: &RollRecording, noise: &ReadingNoise) -> Option<String> {
    let mut shifts = HashMap::new();
    let repeats = |reading: &ProbeReading| {
        let bits = |numbers: Vector2<f64>| numbers.map(|number| (number + 0.0).to_bits());
        let first = shifts.entry(bits(reading.rotation));
        *first.or_insert(reading.shift) == reading.shift
    };
    if noise.pad_start != PadStart::PerRoll || !recorded.readings.iter().all(repeats) {
        return None;
    }
    let rolls = recorded.readings.iter().map(|reading| {
        let ([x, y], [u, v]) = (reading.rotation.into(), reading.shift.into());
        [x, y, u, v]
    });
    repeated(&recorded.origin, "roll", rolls, 0.5)
}

impl Estimated {
    fn told(&self) -> Told {
        let Self {
            readings,
            noise,
            unit,
            ..
        } = self;
        let flat = of_flatness(&self.estimate, self.probe_radius, *unit);
        let Agreement { goodness, doubts } = self.fit.agreement(&self.estimate, readings);
        let p_value = goodness.map(|goodness| goodness.p_value);
        let small =
            goodness.and_then(|goodness| of_small_residuals(self.residual, goodness, noise, *unit));
        let contradictions = doubts.iter().map(|doubt| self.warning(*doubt, goodness));
        let pitch = of_pitch(readings, noise.shift_resolution, *unit);
        let rotations = of_rotation_noise(readings, noise);
        let warnings = Warning::of("unit-or-sign", self.suspicion.clone())
            .into_iter()
            .chain(contradictions)
            .chain(poor_fit(p_value, !doubts.is_empty()))
            .chain(Warning::of("small-residuals", small))
            .chain(Warning::of("flat-object", flat))
            .chain(Warning::of("stated-pitch", pitch))
            .chain(Warning::of("rotation-noise", rotations))
            .chain(Warning::of("repeated-rows", self.copies.clone()))
            .chain(Warning::of("unnamed-probes", self.note.clone()))
            .collect();
        Told { p_value, warnings }
    }

    fn warning(&self, doubt: Doubt, goodness: Option<GoodnessOfFit>) -> Warning {
        let warning = doubt.warning();
        let text = match (doubt, goodness) {
            (Doubt::LargeResiduals { .. }, Some(goodness)) if goodness.chi_squared.is_finite() => {
                let ratio = (goodness.chi_squared / goodness.freedom.max(1) as f64).sqrt();
                format!(
                    "the residuals are {} times what the noise that is given explains: standard deviations are too small",
                    Number::rounded(ratio)
                )
            }
            (Doubt::SlippedProbe { probe, .. }, _) => {
                let probe = self.probes[probe];
                format!("probe {probe} contradicts the others")
            }
            _ => return warning,
        };
        Warning { text, ..warning }
    }
}
