//! Estimates the effective radius of a contact from a load curve, which is the force as a function of the indentation.
//!
//! By Hertz, the force is F = 4/3 E* √R δ^(3/2), with the effective modulus E*, the effective radius R and the
//! indentation δ. The effective modulus is E* = E/(1 − ν²), with Young's modulus E and Poisson's ratio ν of the soft
//! body. If the modulus is not given, a load curve determines only the product E*√R.

use std::collections::HashSet;

use palpate_estimators::large_contact_warning;
use palpate_statistics::{GoodnessOfFit, NORMAL_95, Number, student_half_width};
use palpate_study::config::{LengthUnit, SettingError};
use palpate_study::readings::{Column, Measure};
use palpate_study::{Unit, Warning};
use serde::Serialize;

use super::RecordedFile;
use super::error::RecordedError;
use super::reading_table::{ReadingTable, header};
use super::source::{ReadingSource, copies};
use super::text_table::TextTable;
use super::value::{FORMAT_VERSION, Value, finite};

/// Columns of a load curve: the forces and indentations of a press.
const LOADS: [Column; 2] = [
    Column {
        name: "indentation",
        measure: Measure::Length,
    },
    Column {
        name: "force_n",
        measure: Measure::Force,
    },
];

/// Lower limit of the forces' standard deviation, relative to the largest force. A smaller standard deviation would be
/// below the rounding errors.
const LEAST_NOISE: f64 = 1e-10;

/// Confidence level of the test whether the force grows with the power 3/2 of the indentation. It is the probability
/// that readings of a Hertzian contact pass the test. If the readings fail the test, there is a warning.
const LEVEL: f64 = 0.995;

/// Maximum number of steps of the fit of the exponent.
const MAX_STEPS: usize = 100;

/// A recorded load curve: the forces that were measured at several indentations.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCurve {
    source: ReadingSource,
    /// Indentation (in the unit of lengths) and force (N) of each reading.
    readings: Vec<[f64; 2]>,
    unit: Option<LengthUnit>,
}

/// Settings of an estimate from a load curve.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadOptions {
    /// Young's modulus of the soft body, kPa. If it is not given, only the product E*√R of effective modulus and root
    /// of the effective radius is estimated.
    pub modulus_kpa: Option<f64>,
    /// Standard deviation of the given Young's modulus, kPa; `None` if it is not stated.
    pub modulus_std_kpa: Option<f64>,
    /// Poisson's ratio of the soft body.
    pub poisson: f64,
    /// Radius of the sensor, in the unit of lengths; infinite for a flat pad. If it is not given, the curvature of the
    /// object is not estimated.
    pub sensor_radius: Option<f64>,
    /// Standard deviation of the noise of each force, N. By default, it is estimated from the residuals.
    pub force_std_n: Option<f64>,
    /// Unit of lengths, used if the header does not state it.
    pub length_unit: Option<LengthUnit>,
}

impl LoadOptions {
    /// Checks that each setting is in its range, and that no setting is given without an effect.
    ///
    /// # Errors
    /// [`SettingError`] that names the setting.
    pub fn check(&self) -> Result<(), SettingError> {
        let settings = [
            ("modulus_kpa", self.modulus_kpa),
            ("force_std_n", self.force_std_n),
            ("modulus_std_kpa", self.modulus_std_kpa),
            ("sensor_radius", self.sensor_radius),
        ];
        for (index, (key, value)) in settings.into_iter().enumerate() {
            let Some(value) = value else { continue };
            let is_flat = key == "sensor_radius" && value == f64::INFINITY;
            if !(value > 0.0 && value.is_finite() || is_flat) {
                return Err(SettingError::of_number(key, value, "finite and > 0"));
            }
            if index >= 2 && self.modulus_kpa.is_none() {
                let reason = "has an effect only with setting `modulus_kpa`";
                return Err(SettingError::new(key, reason));
            }
        }
        match self.poisson {
            0.0..=0.5 => Ok(()),
            poisson => Err(SettingError::of_number("poisson", poisson, "from 0 to 0.5")),
        }
    }
}

/// Result of an estimate from a load curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadEstimate {
    format_version: u32,
    readings: usize,
    length_unit: &'static str,
    /// The product E*√R of the effective modulus E* and the square root of the effective radius R.
    stiffness: Value,
    /// Effective radius R; `None` if Young's modulus is not given.
    effective_radius: Option<Value>,
    /// Curvature of the object: 1/R minus the curvature of the sensor, where R is the effective radius. `None` if
    /// Young's modulus or the radius of the sensor is not given.
    object_curvature: Option<Value>,
    /// Exponent n of the power law F ∝ δⁿ that fits the forces F best, where δ is the indentation. It is 3/2 for a
    /// Hertzian contact.
    exponent: Value,
    /// Standard deviation of the noise of each force, N. It is stated by the user or estimated from the residuals.
    force_std_n: f64,
    /// p-value of the goodness of fit; `None` if the noise of the forces is not stated.
    p_value: Option<f64>,
    warnings: Vec<Warning>,
}

/// Reads a load curve. Each row is one reading, with the indentation and the force. Copies of earlier rows are left
/// out.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
impl TryFrom<RecordedFile> for LoadCurve {
    type Error = RecordedError;

    fn try_from(file: RecordedFile) -> Result<Self, RecordedError> {
        let table = TextTable::of(&file, &[&LOADS])?;
        header(&table, &LOADS)?;
        let mut sheet = ReadingTable::read(&table, &LOADS, &[], |_| false)?;
        let rows: Vec<_> = sheet.rows().map(|(_, row)| [row[0], row[1]]).collect();
        let repeated = sheet.source.repeated("reading", rows.iter().copied(), 0.0);
        let repeated = Warning::of("repeated-rows", repeated);
        sheet.source.notes.extend(repeated);
        let copied = copies(rows.iter().copied());
        let distinct = (0..rows.len()).filter(|row| copied.binary_search(row).is_err());
        Ok(LoadCurve {
            readings: distinct.map(|row| rows[row]).collect(),
            unit: sheet.unit,
            source: sheet.source,
        })
    }
}

/// Estimates the effective radius from a load curve. The estimate assumes that the indentations are exact and that all
/// forces have errors of equal size.
///
/// # Errors
/// [`RecordedError::Readings`] if a setting is out of its range, if the unit of lengths is not stated, or if the
/// readings do not determine a radius.
pub fn estimate_force(
    curve: &LoadCurve,
    options: &LoadOptions,
) -> Result<LoadEstimate, RecordedError> {
    let source = &curve.source;
    let fail = |message: String| Err(source.fail(message));
    options
        .check()
        .map_err(|error| source.fail(error.to_string()))?;
    let unit = source.unit(curve.unit, options.length_unit)?;
    let Some(metres) = unit.to(LengthUnit::M) else {
        return fail("the unit of the indentation is not stated; name the column indentation_mm, or give setting `length_unit`".to_owned());
    };
    let largest =
        |number: fn(&[f64; 2]) -> f64| curve.readings.iter().map(number).fold(0.0, f64::max);
    let [deepest, strongest] = [largest(|row| row[0]), largest(|row| row[1].abs())];
    let count = curve.readings.len();
    let pressed = curve.readings.iter().filter(|row| row[0] > 0.0);
    let pressed: HashSet<u64> = pressed.map(|row| row[0].to_bits()).collect();
    if pressed.len() < 3 {
        return fail(format!(
            "has {} different indentations above 0; at least 3 are needed",
            pressed.len()
        ));
    }
    // Divide the indentation δ and the force F by their largest values. Then the Hertz law is F = q u with u = δ^(3/2),
    // where q is the scaled stiffness (`slope`). Before the bodies touch, u is 0.
    let scaled = curve.readings.iter().map(|[indentation, force]| {
        let depth = (indentation / deepest).max(0.0);
        [depth * depth.sqrt(), depth, force / strongest]
    });
    let scaled: Vec<[f64; 3]> = scaled.collect();
    let sum = |term: &dyn Fn(&[f64; 3]) -> f64| scaled.iter().map(term).sum::<f64>();
    let information = sum(&|[load, ..]| load * load);
    let slope = sum(&|[load, _, force]| load * force) / information;
    if !(strongest > 0.0 && slope > 0.0) {
        let message = "the force does not increase with the indentation; a force that presses the bodies together must be positive";
        return fail(message.to_owned());
    }
    let left = sum(&|[load, _, force]| (force - slope * load).powi(2));
    let found = (left / (count - 1) as f64).sqrt().max(LEAST_NOISE);
    let stated = options.force_std_n;
    let stated = stated.map(|std| (std / strongest).max(LEAST_NOISE));
    let std = stated.unwrap_or(found);
    let half_width = |probability: f64, unknowns: usize| match stated {
        Some(_) => student_half_width(probability, 1_000_000),
        None => student_half_width(probability, count - unknowns),
    };
    let slope_std = std / information.sqrt();

    // Fit the exponent n of the law F = q δ^n by Gauss–Newton steps. A step uses the derivative of q δ^n with respect
    // to n, without its part that is proportional to δ^n, because this part changes only q. `step` returns the sum of
    // squared residuals, the change of the exponent and its standard deviation.
    let step = |exponent: f64| {
        let rows = scaled.iter().map(|[_, depth, force]| {
            let load = libm::pow(*depth, exponent);
            let log = if load > 0.0 {
                load * libm::log(*depth)
            } else {
                0.0
            };
            [load, log, *force]
        });
        let rows: Vec<[f64; 3]> = rows.collect();
        let sum = |term: &dyn Fn(&[f64; 3]) -> f64| rows.iter().map(term).sum::<f64>();
        let information = sum(&|[load, ..]| load * load);
        let slope = sum(&|[load, _, force]| load * force) / information;
        let along = sum(&|[load, log, _]| log * load) / information;
        let beside = |[load, log, _]: &[f64; 3]| log - along * load;
        let of_exponent = sum(&|row| beside(row).powi(2));
        let change = sum(&|row| beside(row) * (row[2] - slope * row[0])) / of_exponent;
        let left = sum(&|[load, _, force]| (force - slope * load).powi(2));
        let rest = (left - change * change * of_exponent).max(0.0);
        let rest = (rest / (count - 2) as f64).sqrt().max(LEAST_NOISE);
        let std = stated.unwrap_or(rest) / of_exponent.sqrt() / slope;
        (left, change / slope, std)
    };
    let hertz = step(1.5);
    let (mut exponent, mut best) = (1.5, hertz);
    let mut change = hertz.1;
    for _ in 0..MAX_STEPS {
        let next = exponent + change.clamp(-0.5 * exponent, exponent);
        let tried = step(next);
        if tried.0 < best.0 && tried.2 > 0.0 && tried.2.is_finite() {
            (exponent, best, change) = (next, tried, tried.1);
        } else {
            change *= 0.5;
        }
        if change.abs() < 1e-12 {
            break;
        }
    }
    let exponent_std = best.2;

    // `per_kpa` converts F/δ^(3/2), in N per length^(3/2), to the stiffness in kPa √length. It contains the factor 4/3
    // of the Hertz law.
    let per_kpa = 4.0 / 3.0 * 1e3 * metres * metres;
    let scale = strongest / per_kpa / deepest / deepest.sqrt();
    let [value, value_std] = [slope, slope_std].map(|one| one * scale);
    let stiffness = Value {
        unit: format!("kPa {}^0.5", unit.as_str()).into(),
        ..Value::within(value, Some(value_std), half_width(0.95, 1), Unit::One, unit)
    };
    let share = half_width(0.95, 1) * slope_std / slope;
    let radius = options.modulus_kpa.map(|modulus| {
        let root = slope * (scale / modulus) * (1.0 - options.poisson * options.poisson);
        let of_modulus = options.modulus_std_kpa.unwrap_or(0.0) / modulus;
        let (low, high) = quotient(share, NORMAL_95 * of_modulus);
        let square = |factor: f64| (factor * root) * (factor * root);
        Value {
            interval95: Some([finite(square(low)), high.map(square).and_then(finite)]),
            std: finite(2.0 * square(1.0) * libm::hypot(slope_std / slope, of_modulus)),
            ..Value::bare(square(1.0), unit.as_str())
        }
    });
    let lengths = radius
        .iter()
        .map(|radius| radius.std.map(|std| [radius.number(), std]));
    let numbers = [
        Some([stiffness.number(), value_std]),
        Some([exponent_std, exponent]),
    ];
    let is_sound = |pair: Option<[f64; 2]>| {
        pair.is_some_and(|pair| pair[0] > 0.0 && pair.into_iter().all(f64::is_finite))
    };
    if !numbers.into_iter().chain(lengths).all(is_sound) {
        return fail("the numbers are too large or too small for an estimate".to_owned());
    }
    let curvature = radius.as_ref().zip(options.sensor_radius);
    let curvature = curvature.map(|(radius, sensor)| {
        let less = |end: Option<f64>| finite(end.map_or(0.0, f64::recip) - sensor.recip());
        let [low, high] = radius.interval95.unwrap_or_default();
        Value {
            std: radius
                .std
                .and_then(|std| finite(std / radius.number() / radius.number())),
            interval95: Some([less(high), less(low)]),
            ..Value::bare(
                radius.number().recip() - sensor.recip(),
                Unit::PerLength.of(unit),
            )
        }
    });
    let mut warnings = source.notes.clone();
    if hertz.1.abs() > half_width(LEVEL, 2) * hertz.2 {
        let [power, std] = [exponent, exponent_std].map(Number::rounded);
        let text = format!(
            "the force grows with the power {power} of the indentation (standard deviation {std}), not 1.5: is the indentation 0 at first touch, and the body a thick half-space?"
        );
        warnings.push(Warning::new("other-body", text, [("exponent", exponent)]));
    }
    let goodness = stated.map(|std| GoodnessOfFit::new(left / (std * std), count - 1));
    if let Some(poor) = goodness.filter(GoodnessOfFit::is_poor) {
        let p_value = poor.p_value;
        let text = format!(
            "the residuals are larger than the stated noise explains (p-value {})",
            Number::rounded(p_value)
        );
        warnings.push(Warning::new("poor-fit", text, [("p_value", p_value)]));
    }
    if let Some((radius, sensor)) = radius.as_ref().zip(options.sensor_radius) {
        let contact = (radius.number() * deepest).sqrt();
        let relative = radius.number().recip();
        warnings.extend(large_contact_warning(relative, contact, sensor, false));
    }
    let exponent_std = Some(exponent_std);
    let exponent = Value::within(exponent, exponent_std, half_width(0.95, 2), Unit::One, unit);
    Ok(LoadEstimate {
        format_version: FORMAT_VERSION,
        readings: count,
        length_unit: unit.as_str(),
        stiffness,
        effective_radius: radius,
        object_curvature: curvature,
        exponent,
        force_std_n: std * strongest,
        p_value: goodness.map(|goodness| goodness.p_value),
        warnings,
    })
}

/// Ends of the 95 % interval of a quotient, divided by the quotient (Fieller's theorem). `above` and `below` are the
/// half-widths of the intervals of the numerator and of the denominator, each relative to its value. The upper end is
/// `None` if the denominator may be 0.
fn quotient(above: f64, below: f64) -> (f64, Option<f64>) {
    let [numerator, denominator] = [above, below].map(|share| 1.0 - share * share);
    let root = (1.0 - numerator * denominator).max(0.0).sqrt();
    let low = (numerator / (1.0 + root)).max(0.0);
    (low, (below < 1.0).then(|| (1.0 + root) / denominator))
}
