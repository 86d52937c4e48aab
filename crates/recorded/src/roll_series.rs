//! Estimates from rolls that were recorded as time series.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};
use palpate_ep1::{
    Ep1Error, Estimate, Exclusion, LeastSquares, PadCell, Places, ProbeReading, Quantity,
    RollSample, RollSeries, SeriesError, SeriesEstimate, SeriesMethod, SeriesNoise,
    estimate_series,
};
use palpate_statistics::Number;
use palpate_study::config::LengthUnit;
use serde::Serialize;

use super::error::explained;
use super::frame_pair::median;
use super::lost_rolls::step_of;
use super::roll_options::RollOptions;
use super::roll_recording::RollRecording;
use super::single_direction::single_direction;

/// Largest accepted distance of a pad from the lattice of the other pads, relative to the pitch. Small distances occur,
/// because numbers in files are rounded.
const MAX_PAD_ERROR: f64 = 0.02;

/// Centres of pads with at least this number of digits after the point count as exact, not as rounded.
const MAX_DIGITS: i32 = 7;
/// The pitch is at least this multiple of the last digit of rounded centres of pads.
const MIN_DIGITS_PER_PITCH: f64 = 5.0;

/// Largest usual rotation in the first sample of a roll, relative to the rotation of the whole roll.
const MAX_FIRST_TURN: f64 = 0.2;
/// If the p-value of an estimate is below this value, or if there is no estimate, least squares tests whether the contact
/// moved against the rolls, because the axes or signs of the rotations are wrong.
const MIN_P_VALUE: f64 = 0.005;

/// Settings of the methods for time series. Lengths are in the unit of the readings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeriesOptions {
    /// Contact point at the start of every roll, in the coordinates of the pads; `None` if it is unknown.
    pub start: Option<[f64; 2]>,
    /// Area that a pad covers; `None` for sensors without pads.
    pub pads: Option<PadCell>,
    /// Standard deviation of each component of a contact point; 0 if it is not stated.
    pub contact_std: f64,
    /// Noise of the probes' rotations in the samples of the time series.
    pub noise: SeriesNoise,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SeriesReadings {
    /// Whether the positions in the series are centres of pads. Otherwise they are contact points.
    pub(super) has_pads: bool,
    /// Whether the rotation from the first to the last sample contains the errors of both samples, because the rotation
    /// of the first sample was measured too.
    pub(super) has_start_rotations: bool,
    /// The time series of each probe.
    pub(super) rolls: Vec<RollSeries>,
}

impl SeriesReadings {
    /// The readings for least squares: rotation and shift of each probe from its first to its last sample.
    pub(super) fn ends(&self) -> Vec<ProbeReading> {
        // If all rolls have a single sample, each sample states the motion since the start of its roll. If some rolls
        // have more samples, a roll with a single sample has no measured motion.
        let are_single = self.rolls.iter().all(|roll| roll.samples.len() <= 1);
        let ends = |roll: &RollSeries| {
            let (first, last) = (roll.samples.first()?, roll.samples.last()?);
            let is_only = are_single && last.rotation != Vector3::zeros();
            // Pads at the origin, and a single row, state the motion since the start of the roll.
            let is_relative = self.has_pads && (is_only || first.place == Vector2::zeros());
            let start = f64::from(!is_relative);
            Some(ProbeReading {
                rotation: (last.rotation - first.rotation * start).xy(),
                shift: last.place - first.place * start,
            })
        };
        self.rolls.iter().filter_map(ends).collect()
    }

    /// Replaces the centres of the pads by the points of an exact lattice, if they equal these points within their
    /// rounding errors.
    pub(super) fn snap_to_lattice(&mut self, cell: &PadCell) {
        let samples = || self.rolls.iter().flat_map(|roll| &roll.samples);
        let Some(first) = samples().next().map(|one| one.place) else {
            return;
        };
        let mut last = None;
        let changed = samples().filter(|one| last.replace(one.place) != Some(one.place));
        let centres: Vec<Vector2<f64>> = changed.map(|one| one.place).collect();
        let is_multiple = |number: f64| (number - number.round()).abs() < 1e-6;
        let rounded = |scale: &f64| {
            centres
                .iter()
                .all(|at| at.iter().all(|one| is_multiple(one * scale)))
        };
        let mut scales = (0..MAX_DIGITS).map(|digits| 10_f64.powi(digits));
        let Some(scale) = scales.find(rounded) else {
            return;
        };
        // Rounding does not change a lattice whose pitch is a multiple of the last digit.
        if (is_multiple(cell.pitch * scale) && !cell.is_hexagonal)
            || cell.pitch * scale < MIN_DIGITS_PER_PITCH
        {
            return;
        }
        let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY].map(Vector2::repeat);
        let lattice = |place: &Vector2<f64>| {
            let at = lattice_place(&(place - first), cell).map(f64::round);
            let shape = match cell.is_hexagonal {
                true => Vector2::new(at.x + 0.5 * at.y, 0.5 * 3.0_f64.sqrt() * at.y),
                false => at,
            };
            shape * cell.pitch
        };
        for place in &centres {
            let offset = place - lattice(place);
            (low, high) = (low.inf(&offset), high.sup(&offset));
        }
        if (high - low).amax() <= (1.0 + 1e-6) / scale {
            let origin = (low + high) * 0.5;
            for sample in self.rolls.iter_mut().flat_map(|roll| &mut roll.samples) {
                sample.place = origin + lattice(&sample.place);
            }
        }
    }

    /// Question about rotation vectors that are far from 0 in the first samples of the rolls.
    pub(super) fn turned_starts(&self) -> Option<String> {
        let ends = |roll: &RollSeries| {
            Some([roll.samples.first()?, roll.farthest()?].map(|one| one.rotation))
        };
        let ends = || {
            self.rolls
                .iter()
                .filter(|roll| roll.samples.len() > 1)
                .filter_map(ends)
        };
        let first = median(ends().map(|[first, _]| first.norm()))?;
        let turned = median(ends().map(|[first, last]| (last - first).norm()))?;
        (first > MAX_FIRST_TURN * turned).then(|| {
            format!(
                "the rotations of the first samples are {} rad (median), not 0: does each rotation state the turn since the start of its roll?",
                Number::rounded(first)
            )
        })
    }
}

#[derive(Clone, Debug)]
pub(super) struct SeriesResult {
    pub(super) method: &'static str,
    pub(super) estimate: SeriesEstimate,
    /// The stated noise. If none is stated, and the positions are pads, it includes the rounding errors of rotations that
    /// are multiples of a large step.
    pub(super) noise: SeriesNoise,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct LeftOutProbe {
    pub(super) probe: u64,
    /// Number of the probe's row in the file, counted from 1; `None` for time series and for arrays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) row: Option<usize>,
    pub(super) reason: &'static str,
}

/// Curvatures for which bounds are reported, each with its key in the JSON.
pub(super) const QUANTITIES: [(&str, Quantity); 6] = [
    ("normal_curvature_u", Quantity::Normal { angle_rad: 0.0 }),
    (
        "normal_curvature_v",
        Quantity::Normal {
            angle_rad: std::f64::consts::FRAC_PI_2,
        },
    ),
    ("gaussian_curvature", Quantity::Gaussian),
    ("mean_curvature", Quantity::Mean),
    ("principal_curvature_min", Quantity::PrincipalMin),
    ("principal_curvature_max", Quantity::PrincipalMax),
];

/// The estimate by the chosen method for time series; `None` if the chosen method is least squares, or if only least
/// squares can estimate a curvature, because all rolls are in one direction.
///
/// # Errors
/// A message if the readings are no time series, or if they do not determine the curvature.
pub(super) fn estimate_of_series(
    recorded: &RollRecording,
    options: &RollOptions,
    unit: LengthUnit,
) -> Result<Option<SeriesResult>, String> {
    let readings = recorded.series.as_ref();
    let has_pads = readings.is_some_and(|readings| readings.has_pads);
    let (mut name, chosen_because) = options.estimator.method(readings.is_some());
    let method = match name {
        "pad-edge" => SeriesMethod::PadEdge,
        "trajectory" => SeriesMethod::Trajectory,
        _ => return Ok(None),
    };
    let readings = readings.ok_or_else(|| {
        format!(
            "setting `kind` {name} needs rolls as time series, with columns probe, time_s, rotation_x_rad, rotation_y_rad and pad_u, pad_v or contact_u, contact_v; these readings have one row per roll"
        )
    })?;
    let series = options.series;
    let places = match (has_pads, series.pads) {
        (true, Some(cell)) => Places::Pads(cell),
        (true, None) => {
            return Err(format!(
                "setting `kind` {name} needs setting `pitch` for readings with columns pad_u, pad_v"
            ));
        }
        (false, _) if method == SeriesMethod::PadEdge => {
            return Err(
                "setting `kind` pad-edge needs columns pad_u, pad_v; these readings have contact points, which setting `kind` trajectory uses"
                    .to_owned(),
            );
        }
        (false, _) => Places::Contacts {
            std: series.contact_std,
        },
    };
    if let Places::Pads(cell) = &places {
        all_on_lattice(recorded, readings, cell, unit)?;
    }
    for (roll, series) in readings.rolls.iter().enumerate() {
        let size = |sample: &RollSample| {
            let [x, y, z] = sample.rotation.into();
            libm::hypot(libm::hypot(x, y), z)
        };
        let is_far = |sample: &&RollSample| size(sample) > TAU;
        if let Some(sample) = series.samples.iter().find(is_far) {
            return Err(format!(
                "probe {} after {} s: the rotation is {} rad, more than a whole turn",
                recorded.probe(roll),
                Number(sample.time_s),
                Number::rounded(size(sample))
            ));
        }
        if let (Places::Pads(cell), Some(start)) = (&places, series.start)
            && let Some(first) = series.samples.first()
            && first.rotation == Vector3::zeros()
            && !cell.contains(&((start - first.place) * (1.0 - MAX_PAD_ERROR)))
        {
            let [[u, v], [pad_u, pad_v]] = [start, first.place].map(|at| at.map(Number).into());
            return Err(format!(
                "probe {}: the stated start ({u}, {v}) {unit} is not on the pad of the first sample, whose centre is ({pad_u}, {pad_v}) {unit}",
                recorded.probe(roll),
                unit = unit.as_str()
            ));
        }
    }
    let radius = options.probe_radius;
    let mut noise = series.noise;
    if has_pads && noise == SeriesNoise::default() {
        let samples = readings.rolls.iter().flat_map(|roll| &roll.samples);
        let step = step_of(samples.flat_map(|one| [one.rotation.x, one.rotation.y]));
        noise.rotation_std_rad = step / 12_f64.sqrt();
    }
    let fit = |method| {
        let found = estimate_series(method, radius, &places, &noise, &readings.rolls)?;
        match found.change {
            Some(p_value) => Err(SeriesError::ChangingCurvature { p_value }),
            None => Ok(found),
        }
    };
    let mut estimate = fit(method);
    // If the readings do not determine how the curvature changes along the roll, they may still bound the curvature
    // under the assumption that it is constant (method `pad-edge`).
    if estimate.is_err() && chosen_because.is_some() && has_pads {
        (name, estimate) = ("pad-edge", fit(SeriesMethod::PadEdge));
    }
    // Rolls in one direction determine only the curvature in this direction, which least squares estimates.
    let may_change =
        chosen_because.is_some() || matches!(estimate, Err(SeriesError::Undetermined { .. }));
    let single = |()| single_direction(&recorded.readings, radius, &options.noise).ok()?;
    if may_change.then_some(()).and_then(single).is_some() {
        return Ok(None);
    }
    let is_poor = |one: &SeriesEstimate| one.goodness.is_some_and(|one| one.p_value < MIN_P_VALUE);
    if estimate.as_ref().map_or(true, is_poor)
        && let Err(error @ Ep1Error::NotRolling { .. }) =
            LeastSquares::fitted(radius, options.noise, &recorded.readings)
    {
        let message = format!("{error}; check the signs and axes of the rotations");
        return Err(explained(message, error.into()));
    }
    let estimate = estimate.map_err(|error| {
        let refused = refused(recorded, readings, error);
        let turned = readings.turned_starts();
        turned.map_or(refused.clone(), |turned| format!("{turned} {refused}"))
    })?;
    Ok(Some(SeriesResult {
        method: name,
        estimate,
        noise,
    }))
}

fn refused(recorded: &RollRecording, readings: &SeriesReadings, error: SeriesError) -> String {
    let at = |roll: usize, sample: usize| {
        let series = readings.rolls.get(roll);
        let time_s = series.and_then(|series| series.samples.get(sample));
        let time_s = time_s.map_or(0.0, |sample| sample.time_s);
        format!("probe {} after {} s", recorded.probe(roll), Number(time_s))
    };
    let message = match error {
        SeriesError::NotFinite { roll, sample } => {
            format!("{}: a number is not finite", at(roll, sample))
        }
        SeriesError::OffProbe { roll, sample } => format!(
            "{}: the contact point or pad is more than half of the probe's circumference away from the origin of its coordinates",
            at(roll, sample)
        ),
        SeriesError::Contradiction { roll } => format!(
            "no constant curvature agrees with the rotations and pads of all probes: the curvature changes along the rolls (use method trajectory), the rotations have noise (state it, or a larger one if it is stated), or a probe is wrong, most likely probe {}",
            recorded.probe(roll)
        ),
        SeriesError::TooFewRolls { .. } => recorded.with_note(&error),
        _ => error.to_string(),
    };
    explained(message, error.into())
}

/// Converts the difference of two pads' centres to a difference of places in the lattice of the pads.
fn lattice_place(between: &Vector2<f64>, cell: &PadCell) -> Vector2<f64> {
    let pitches = between / cell.pitch;
    if !cell.is_hexagonal {
        return pitches;
    }
    // The rows of hexagonal pads lie along u. Neighbouring rows are √3/2 pitches apart along v, and are shifted by half a
    // pitch along u.
    let row = pitches.y / (0.5 * 3.0_f64.sqrt());
    Vector2::new(pitches.x - 0.5 * row.round(), row)
}

/// Checks that the distances between the active pads are possible in a lattice with the stated pitch.
fn all_on_lattice(
    recorded: &RollRecording,
    readings: &SeriesReadings,
    cell: &PadCell,
    unit: LengthUnit,
) -> Result<(), String> {
    let all = || readings.rolls.iter().flat_map(|roll| &roll.samples);
    let Some(first) = all().next() else {
        return Ok(());
    };
    let lattice = match cell.is_hexagonal {
        true => "hexagonal pads lie in rows along u",
        false => "square pads lie in rows along u and v",
    };
    let error_of = |place: &Vector2<f64>| {
        let at = lattice_place(&(place - first.place), cell);
        (at - at.map(f64::round)).amax()
    };
    for (roll, series) in readings.rolls.iter().enumerate() {
        // The active pad rarely changes. So check the place of a sample's pad only if it differs from that of the
        // previous sample.
        let mut last = first.place;
        for sample in &series.samples {
            if sample.place != last && error_of(&sample.place) > MAX_PAD_ERROR {
                let [u, v] = sample.place.map(Number).into();
                return Err(format!(
                    "probe {} after {} s: there is no pad at ({u}, {v}) {unit}: with a pitch of {} {unit}, counted from the pad of the first sample, {lattice}",
                    recorded.probe(roll),
                    Number(sample.time_s),
                    Number(cell.pitch),
                    unit = unit.as_str()
                ));
            }
            last = sample.place;
        }
    }
    Ok(())
}

impl SeriesResult {
    pub(super) fn estimate(&self) -> Estimate {
        self.estimate.estimate()
    }

    /// Whether the contact stayed on one pad during the roll with the index `roll`.
    pub(super) fn is_unresolved(&self, roll: usize) -> bool {
        let report = self.estimate.rolls.get(roll);
        report.is_some_and(|report| report.left_out == Some(Exclusion::NoCrossing))
    }

    /// Probes that the fit does not use. Probes whose contact stayed on one pad are not in this list.
    pub(super) fn left_out(&self, recorded: &RollRecording) -> Vec<LeftOutProbe> {
        let reports = self.estimate.rolls.iter().enumerate();
        let left_out = reports.filter_map(|(roll, report)| {
            let reason = match report.left_out? {
                Exclusion::NoCrossing => return None,
                Exclusion::TooFewSamples => "it has fewer than two samples",
                Exclusion::NoRotation => "it did not rotate",
                Exclusion::Inconsistent => "it contradicts the other probes",
            };
            Some(LeftOutProbe {
                probe: recorded.probe(roll),
                row: None,
                reason,
            })
        });
        left_out.collect()
    }
}

impl LeftOutProbe {
    pub(super) fn text(&self) -> String {
        let row = self
            .row
            .map_or_else(String::new, |row| format!(", row {row},"));
        format!("probe {}{row} is left out: {}", self.probe, self.reason)
    }
}
