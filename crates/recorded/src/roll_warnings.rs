//! Warnings about recorded rolls and their estimate.

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, DVector};
use palpate_ep1::{Misfit, ProbeReading, rounding_std};
use palpate_statistics::{Number, StatedQuantity, ratio_tail};
use palpate_study::Warning;
use palpate_study::config::LengthUnit;

use super::lost_rolls::common_step;
use super::misfit_warning::ReadingWords;
use super::roll_estimate::{FROM_STEPS, OF_RESIDUALS, RollEstimate};
use super::roll_recording::RollRecording;
use super::single_direction::DirectedCurvature;

/// Largest usual ratio of a probe's rotation to the rotation that causes the same shift on a plane; the ratio is 1 +
/// R_probe/R_object. A larger median causes a warning, because shifts in cm under a header with mm increase it tenfold.
const MAX_USUAL_TURN_RATIO: f64 = 12.0;
/// Ratio above which a single roll is implausible, because its rotation is probably in degrees.
const MAX_TURN_RATIO: f64 = 25.0;
/// Smallest accepted ratio of a probe's rotation to the rotation that causes the same shift on a plane. If the ratio is
/// smaller, there is a warning, because the rotations are probably in rad although the header states degrees. With
/// correct units, such a small ratio occurs only in a dish that is hardly wider than the probe.
const MIN_TURN_RATIO: f64 = 1.0 / 30.0;
/// Largest rotation of a probe on an edge so sharp that its ratio exceeds `MAX_TURN_RATIO`. Larger rotations with such
/// a ratio are rejected.
const MAX_SHARP_TURN_RAD: f64 = PI;
/// Readings are rejected if the median of their ratios is below this value. A smaller ratio would need a dish whose
/// radius is almost that of the probe.
const MIN_ACCEPTED_TURN_RATIO: f64 = 1.0 / 200.0;
/// Readings are rejected if the median ratio of the rotations is above this value. The ratio is a probe's rotation
/// divided by the rotation that causes the same shift on a plane. On a convex object it is at least 1; if the shifts
/// are in m and the radius is in mm, it is at least 1000.
const MAX_ACCEPTED_TURN_RATIO: f64 = 500.0;

/// Largest accepted quotient of the ratios in two directions; a larger quotient may be due to mixed units.
const MAX_DIRECTION_RATIO: f64 = 8.0;

/// If the root mean square residual is above this share of the shifts, the rotations are tested for a common rotation.
const MAX_MISFIT: f64 = 0.02;
/// Share of the shifts above which a common rotation is an error instead of a warning. A change of the object's
/// curvature along the rolls may have the effect of a smaller common rotation.
const REFUSED_MISFIT: f64 = 0.1;
/// Share of the shifts above which the axes of rotations and shifts may differ by a rotation about the normal. A smaller
/// share may be due to a sensor that is not exactly aligned.
const MAX_TWIST: f64 = 0.3;
/// The common rotation must reduce the sum of squared residuals to this share, and to this multiple of the share of the
/// misfit in the shifts.
const MAX_REST: f64 = 0.25;
const MAX_REST_RATIO: f64 = 25.0;
/// Significance level of the test for a common rotation.
const SIGNIFICANCE_LEVEL: f64 = 1e-4;
/// Error message for rotations that are not those since the start of each roll.
pub(super) const ORIENTATIONS: &str = "the rotations fit the shifts of the contacts only with other axes or another start: each row must state the rotation since the start of its roll, about the axes u and v; for orientations, record a time series with the start and the end of each roll (columns probe, time_s, an orientation, contact_u and contact_v)";

/// Significance level below which a fit of time series is reported as poor.
const MIN_P_VALUE: f64 = 0.005;

/// Smallest shift that agrees with the stated pitch of the pads, as a multiple of the pitch. A smaller shift causes a
/// warning. Neighbouring pads are hardly ever less than 0.8 pitches apart, so correct shifts exceed this limit.
const MIN_SHIFT: f64 = 0.5;
/// Shifts up to this size, relative to the pitch, count as 0, because they are rounding errors.
const ROUNDING: f64 = 1e-9;

impl RollEstimate {
    /// Warnings about contradictions between the readings and the model, and about likely mistakes in the readings.
    pub(crate) fn warnings(&self) -> Vec<Warning> {
        let readings = &self.recorded.farthest(self.series.is_none());
        let words = ReadingWords {
            reading: &|probe| format!("probe {}", self.recorded.probe(probe)),
            noise_of: "shifts",
            unit: self.unit.as_str(),
        };
        let units =
            self.recorded
                .units(self.series.is_none(), self.options.probe_radius, self.unit);
        let misfits = match &self.series {
            Some(_) if self.std_from == OF_RESIDUALS => Vec::new(),
            Some(_) => self
                .p_value()
                .filter(|p_value| *p_value < MIN_P_VALUE)
                .map_or_else(Vec::new, |p_value| vec![Misfit::PoorFit { p_value }]),
            None => self
                .estimate
                .misfits(self.options.noise, self.tested_readings()),
        };
        let left_out = self.left_out().into_iter();
        let left_out = left_out.map(|probe| Warning::new("left-out", probe.text(), []));
        let directed = self.single_direction.as_ref();
        Warning::of("units", units.map(|(text, _)| text))
            .into_iter()
            .chain(directed.map(DirectedCurvature::warning))
            .chain(Warning::of("left-out", self.lost_samples.clone()))
            .chain(left_out)
            .chain(misfits.iter().map(|misfit| words.warning(misfit)))
            .chain(self.bent_paths())
            .chain(Warning::of("units", self.turned_starts()))
            .chain(Warning::of("poor-fit", self.common_rotation()))
            .chain(Warning::of("flat-object", self.flatness()))
            .chain(Warning::of("units", self.mixed_units()))
            .chain(Warning::of("few-crossings", self.few_crossings()))
            .chain(Warning::of("changing-curvature", self.possible_change()))
            .chain(Warning::of(StatedQuantity::Pitch.code(), self.pitch()))
            .chain(Warning::of("units", self.rotation_noise(readings)))
            .chain(Warning::of("repeated-rows", self.repeated.clone()))
            .chain(Warning::of("unnamed-probes", self.recorded.note.clone()))
            .chain(self.recorded.source.notes.iter().cloned())
            .collect()
    }

    /// Warning about a time series without stated noise whose residuals contradict the noise model of the fit.
    fn bent_paths(&self) -> Option<Warning> {
        let p_value = self.p_value().filter(|_| self.std_from == OF_RESIDUALS)?;
        let shown = Number::rounded(p_value);
        let text = format!(
            "the shapes of the contact paths contradict the rotations (p-value {shown}), so the estimate uses mainly the lengths of the paths: are the rotations about the contact normal wrong or missing, or does the contact slip?"
        );
        (p_value < MIN_P_VALUE).then(|| Warning::new("poor-fit", text, [("p_value", p_value)]))
    }

    fn turned_starts(&self) -> Option<String> {
        let readings = self.recorded.series.as_ref()?;
        readings
            .turned_starts()
            .filter(|_| !readings.has_start_rotations)
    }

    fn common_rotation(&self) -> Option<String> {
        let is_row = self.recorded.series.is_none();
        let found = has_common_rotation(&self.recorded.readings, self.residual);
        found.filter(|_| is_row && self.single_direction.is_none())?;
        Some("the shifts fit the rotations much better if the same rotation is subtracted from all of them: does each row state the rotation since the start of its roll?".to_owned())
    }

    fn few_crossings(&self) -> Option<String> {
        let series = self.series.as_ref()?;
        series.estimate.has_few_crossings().then(|| {
            let range = match self.bounds() {
                Some(_) => ": use `bounds`, because the estimated curvatures are only the middle of a wide range",
                None => ", or the pads at an edge alternate: the estimated curvatures are only the middle of a wide range",
            };
            format!("the contacts cross few edges of pads{range}; roll further, in more directions, or with finer pads, or use method trajectory")
        })
    }

    fn possible_change(&self) -> Option<String> {
        let series = self.series.as_ref()?;
        series.estimate.may_change.then(|| "the readings do not show whether the curvature changes along the rolls; if it changes as on a paraboloid, the estimates are wrong by several half-widths of their intervals: use method trajectory, or roll less far with finer pads".to_owned())
    }

    /// Text of a warning if the object is so flat that rounding errors of the readings affect its estimated curvature;
    /// otherwise `None`.
    fn flatness(&self) -> Option<String> {
        let principal = self.estimate.curvature.principal();
        let sharper = principal.k_min.abs().max(principal.k_max.abs());
        let std = rounding_std(self.options.probe_radius, sharper);
        // Warn if the rounding error exceeds 1/1000 of the curvature.
        (sharper < 1e3 * std).then(|| {
            format!(
                "the object is too flat for double precision: the rounding error of a curvature is {} 1/{}, and the estimated normal curvatures are at most {}",
                Number::rounded(std),
                self.unit.as_str(),
                Number::rounded(sharper)
            )
        })
    }

    /// Text of a warning if the turn ratio in one direction is much larger than in another; otherwise `None`.
    fn mixed_units(&self) -> Option<String> {
        let principal = self.estimate.curvature.principal();
        let ratio = |curvature: f64| 1.0 + self.options.probe_radius * curvature;
        let (low, high) = (ratio(principal.k_min), ratio(principal.k_max));
        (self.single_direction.is_none() && high > MAX_DIRECTION_RATIO * low.max(1.0)).then(|| {
            let ratio = Number::rounded(high / low);
            format!(
                "for the same shift, the probe turned {ratio} times as far in one direction as in another: is the object a sharp edge, or do the two shifts, or the two rotations, have different units?"
            )
        })
    }

    fn pitch(&self) -> Option<String> {
        if self.std_from == FROM_STEPS {
            let step = Number::rounded(common_step(&self.recorded.readings));
            return Some(format!(
                "all shifts are multiples of {step} {unit}, so the intervals assume that the contacts are rounded to such steps: state the `pitch` of the pads or, for a sensor without pads, the noise of the shifts (`shift_std`)",
                unit = self.unit.as_str()
            ));
        }
        let resolution = self.options.noise.shift_resolution;
        let shifts = self.recorded.readings.iter();
        let shifts = shifts.map(|reading| reading.shift.norm());
        let moved = shifts.filter(|shift| *shift > ROUNDING * resolution);
        let shortest = moved.fold(f64::INFINITY, f64::min);
        (shortest < MIN_SHIFT * resolution && resolution.is_finite()).then(|| {
            let [shortest, resolution] = [shortest, resolution].map(Number::rounded);
            let unit = self.unit.as_str();
            format!(
                "a contact moved by {shortest} {unit}, less than the distance between two pads at a pitch of {resolution} {unit}: is the pitch correct, and are the shifts in {unit}?"
            )
        })
    }

    fn rotation_noise(&self, readings: &[ProbeReading]) -> Option<String> {
        let noise = self.options.noise.rotation_std_rad;
        let most = largest_rotation(readings);
        (noise > most).then(|| {
            let [noise, most] = [noise, most].map(Number::rounded);
            format!(
                "the noise of rotations is stated as {noise} rad, but no probe turned by more than {most} rad: is it in degrees?"
            )
        })
    }
}

fn largest_rotation(readings: &[ProbeReading]) -> f64 {
    let rotations = readings.iter().map(|reading| reading.rotation.norm());
    rotations.fold(0.0, f64::max)
}

impl RollRecording {
    /// Text about implausible rotations or shifts, which often have a wrong unit, and whether the readings must be
    /// rejected; `None` if the readings are plausible.
    pub(super) fn units(
        &self,
        is_of_ends: bool,
        probe_radius: f64,
        unit: LengthUnit,
    ) -> Option<(String, bool)> {
        let readings = &self.farthest(is_of_ends);
        let (most, shown) = (largest_rotation(readings), Number::rounded);
        if most == 0.0 {
            return Some((
                "all rotations from the start to the end of a roll are 0".to_owned(),
                false,
            ));
        }
        let ratio = |(place, reading): (usize, &ProbeReading)| {
            let (turn, shift) = (reading.rotation.norm(), reading.shift.norm());
            let ratio = turn * probe_radius / shift;
            (ratio > 0.0 && ratio.is_finite()).then_some((ratio, turn, place))
        };
        let ratios = readings.iter().enumerate().filter_map(ratio);
        // Nearly always, all ratios are usual. Then their median is not needed.
        let is_usual = |ratio: f64| (MIN_TURN_RATIO..=MAX_USUAL_TURN_RATIO).contains(&ratio);
        if most <= TAU && ratios.clone().all(|(ratio, ..)| is_usual(ratio)) {
            return None;
        }
        let mut ratios: Vec<_> = ratios.collect();
        ratios.sort_by(|one, other| one.0.total_cmp(&other.0));
        let median = ratios.get(ratios.len() / 2).map_or(1.0, |one| one.0);
        let mut wrong = ratios
            .iter()
            .filter(|(ratio, turn, _)| *ratio > MAX_TURN_RATIO && *turn > MAX_SHARP_TURN_RAD);
        Some(match wrong.next_back() {
            wrong if median > MAX_USUAL_TURN_RATIO => (
                format!(
                    "the probe turned {} times as far as on a plane: are the rotations in degrees or mrad, or the shifts in a larger unit than the radius? the columns are in rad and {}; to state other units, rename the columns in the header, such as to rotation_x_deg or contact_u_m, or use setting `columns` if the header states no units; setting `length_unit` states the unit of the radius",
                    shown(median),
                    unit.as_str()
                ),
                wrong.is_some() || median > MAX_ACCEPTED_TURN_RATIO,
            ),
            _ if median < MIN_TURN_RATIO => (
                format!(
                    "the contact moved {} times as far as on a plane: are the rotations in rad although the header states degrees, or the shifts in a smaller unit than the radius?",
                    shown(median.recip())
                ),
                median < MIN_ACCEPTED_TURN_RATIO,
            ),
            Some(&(ratio, turn, place)) => (
                format!(
                    "probe {} turned by {} rad, {} times as far as on a plane, unlike other probes: is its rotation in degrees or mrad? the columns are in rad",
                    self.probe(place),
                    shown(turn),
                    shown(ratio)
                ),
                true,
            ),
            None if most > TAU => (
                format!(
                    "a probe turned by {} rad, more than a whole turn: are the rotations in degrees? the columns are in rad",
                    shown(most)
                ),
                false,
            ),
            None => return None,
        })
    }
}

/// Tests whether the shifts agree with the rotations only after the same rotation is subtracted from all rotations.
/// `None` if they agree without it, or if there are too few rolls for this test. Otherwise, the result states whether
/// the readings must be rejected. `residual` is the root mean square of the residuals of the fit.
pub(super) fn has_common_rotation(readings: &[ProbeReading], residual: f64) -> Option<bool> {
    let rows = readings.len();
    let misfit = residual * residual * (2 * rows).saturating_sub(3) as f64;
    let total: f64 = readings.iter().map(|one| one.shift.norm_squared()).sum();
    let share = misfit / total;
    // The tested model is shift = A d + b, where d is the direction of rolling times the rotation, A is a symmetric
    // matrix, and b is the shift that a common rotation causes. Without a common rotation, b is 0. If the misfit is
    // large, A may also have an antisymmetric part (sixth term).
    let terms = if share > MAX_TWIST * MAX_TWIST { 6 } else { 5 };
    let freedom = (2 * rows).checked_sub(terms)?;
    if !(share > MAX_MISFIT * MAX_MISFIT && freedom > 0) {
        return None;
    }
    let scale = largest_rotation(readings);
    let model = DMatrix::from_fn(2 * rows, terms, |row, term| {
        let (x, y) = (-readings[row / 2].rotation.y, readings[row / 2].rotation.x);
        let both = [
            [x, 0.0],
            [y, x],
            [0.0, y],
            [scale, 0.0],
            [0.0, scale],
            [-y, x],
        ];
        both[term][row % 2]
    });
    let shifts = DVector::from_fn(2 * rows, |row, _| readings[row / 2].shift[row % 2]);
    let solved = model.clone().svd(true, true);
    let solved = solved.solve(&shifts, 1e-12 * scale).ok()?;
    let rest = (shifts - model * solved).norm_squared();
    let is_better = rest < MAX_REST.min(MAX_REST_RATIO * share) * misfit
        && ratio_tail(misfit - rest, terms - 3, rest, freedom) < SIGNIFICANCE_LEVEL;
    is_better.then_some(share > REFUSED_MISFIT * REFUSED_MISFIT)
}
