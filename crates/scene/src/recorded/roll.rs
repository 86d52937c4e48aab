//! Recorded rolls.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use nalgebra::Vector2;
use palpate_ep1::{Ep1Error, LeastSquares, Measured, ProbeReading, ReadingNoise};
use palpate_number::Number;
use palpate_sensing::{InvalidSensor, PadLayout, PadOffset, Pads};
use serde::Serialize;

use super::RecordedFile;
use super::Value;
use super::error::{RecordedError, explained};
use super::extra::Extras;
use super::fingers::parted;
use super::origin::{Origin, agreed_unit, finite, same_length};
use super::sheet::{Sheet, header};
use super::stated::FORMAT_VERSION;
use super::suspicion::of_roll;
use super::written::Written;
use palpate_study::config::{LengthUnit, RollEstimatorConfig};
use palpate_study::readings::{Column, Measure, ROLL_SERIES, ROLLS, columns_of};
use palpate_study::{Table, Unit};

/// Settings of an estimate that the readings do not state.
#[derive(Clone, Debug, PartialEq)]
pub struct RollOptions {
    /// The probe's radius, in the readings' length unit.
    pub probe_radius: f64,
    /// The estimator.
    pub estimator: RollEstimatorConfig,
    /// The unit of lengths, where the header does not state it.
    pub length_unit: Option<LengthUnit>,
    /// Noise and resolution of the readings, lengths in the same unit; standard deviations follow from the residuals
    /// where none is stated.
    pub noise: ReadingNoise,
}

impl RollOptions {
    /// Options with nothing known but the probe's radius.
    pub fn new(probe_radius: f64) -> Self {
        Self {
            probe_radius,
            estimator: RollEstimatorConfig::default(),
            length_unit: None,
            noise: ReadingNoise::default(),
        }
    }

    /// Noise of pads that start anywhere under the first contact, on a probe of this radius.
    ///
    /// # Errors
    /// [`InvalidSensor`] for a pitch that a study refuses too: beyond the radius, or below 1e-15 of it.
    pub fn noise_of_pads(probe_radius: f64, pitch: f64) -> Result<ReadingNoise, InvalidSensor> {
        let pads = Pads::new(
            probe_radius,
            pitch,
            PadLayout::Square,
            PadOffset::Random,
            FRAC_PI_2,
        )?;
        Ok(ReadingNoise {
            shift_std: pads.shift_std(),
            shift_resolution: pads.resolution(),
            ..ReadingNoise::default()
        })
    }

    /// Noise of a sensor without pads, with this standard deviation of each component of a shift.
    ///
    /// # Errors
    /// [`InvalidSensor`] for one beyond the probe's radius, as of a pitch.
    pub fn noise_of_shifts(
        probe_radius: f64,
        shift_std: f64,
    ) -> Result<ReadingNoise, InvalidSensor> {
        if !(0.0..=probe_radius).contains(&shift_std) {
            let radius = Number(probe_radius);
            return Err(InvalidSensor {
                parameter: "shift-std",
                value: shift_std,
                expected: format!("at least 0 and at most the probe's radius, {radius}"),
            });
        }
        Ok(ReadingNoise {
            shift_std,
            ..ReadingNoise::default()
        })
    }
}

/// Recorded readings of a roll.
#[derive(Clone, Debug, PartialEq)]
pub struct RollReadings {
    origin: Origin,
    /// The probes' numbers, as recorded.
    probes: Vec<u64>,
    /// Their readings.
    readings: Vec<ProbeReading>,
    /// The unit that the header states.
    unit: Option<LengthUnit>,
    /// The row of each probe.
    rows: Vec<usize>,
    /// Other fields of the file, row by row.
    extras: Extras,
    /// How the probes were told, where the file does not name them.
    note: Option<String>,
}

impl RollReadings {
    /// Readings of probes that turned by `rotations`, whose contacts moved by `shifts`; a third component of a rotation is
    /// the turn about the normal, which moves no contact. Lengths are in `unit`.
    ///
    /// ```
    /// use palpate_scene::recorded::{RollOptions, RollReadings, estimate_roll};
    ///
    /// // A probe of radius 10 that is turned by 0.3 on a ball of radius 20 rolls over 2.
    /// let rotations = [[0.0, -0.3], [0.3, 0.0]];
    /// let readings = RollReadings::new(&rotations, &[[2.0, 0.0], [0.0, 2.0]], None)?;
    /// let estimate = estimate_roll(&readings, &RollOptions::new(10.0))?;
    /// assert_eq!(serde_json::to_value(estimate)?["probes"], 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordedError::Array`] for a number that is not finite, and where there are not as many shifts as rotations.
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
            origin: Origin::Arrays,
            probes: (0..rotations.len() as u64).collect(),
            readings: pairs
                .map(|(turned, [u, v])| reading(turned[0], turned[1], *u, *v))
                .collect(),
            unit,
            rows: (0..rotations.len()).collect(),
            extras: Extras::default(),
            note: None,
        })
    }

    /// The unit of lengths that the header states.
    pub fn unit(&self) -> Option<LengthUnit> {
        self.unit
    }
}

/// A probe whose contact did not move.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnresolvedProbe {
    probe: u64,
    /// Bound below which the object's radius of curvature lies in the direction of that roll; `null` where the pads'
    /// pitch is not given or too coarse to say.
    radius_below: Option<f64>,
    unit: String,
    /// Other fields of the readings in the row that counts, by the names of their columns.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    columns: BTreeMap<String, String>,
}

/// Output of `estimate roll`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RollEstimate {
    /// Version of this format, [`FORMAT_VERSION`](super::FORMAT_VERSION).
    format_version: u32,
    method: &'static str,
    probes: usize,
    normal_curvature_u: Value,
    normal_curvature_v: Value,
    gaussian_curvature: Value,
    mean_curvature: Value,
    arc_length: Value,
    principal_curvature_min: Value,
    principal_curvature_max: Value,
    /// Direction of the largest curvature, from +u towards +v of the readings.
    principal_direction_max_deg: f64,
    /// How a relative error of the readings grows: 1 + 1/RCR; `null` where the object is flat.
    amplification_u: Option<f64>,
    amplification_v: Option<f64>,
    /// Root mean square of what the fit leaves of each component of a shift.
    residual_rms: Value,
    /// Origin of the standard deviations, in words.
    std_from: &'static str,
    unresolved_probes: Vec<UnresolvedProbe>,
    /// Doubts, in words.
    warnings: Vec<String>,
    #[serde(skip)]
    covariance: Option<[[f64; 3]; 3]>,
}

impl RollEstimate {
    /// Covariance of the normal curvatures along u and v and of the twist k_uv, 1/length²; `None` where nothing tells the
    /// noise.
    pub fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        self.covariance
    }
}

/// Reads recorded rolls: one row per probe, or a time series per probe, whose last row counts. Without a column `probe`,
/// each row is one, or each series, which a blank line or a time that does not rise ends.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
pub fn read_roll(path: &Path) -> Result<RollReadings, RecordedError> {
    parse_roll(RecordedFile::read(path)?)
}

/// Recorded rolls, as [`read_roll`] reads them.
///
/// # Errors
/// As [`read_roll`].
pub fn parse_roll(file: RecordedFile) -> Result<RollReadings, RecordedError> {
    let text = file.text()?;
    let table = Written::of(&file, &text)?;
    let is_series = is_series(&table)?;
    let all = if is_series {
        &ROLL_SERIES[..]
    } else {
        &ROLLS[..]
    };
    let header = header(&table, &columns_of("roll"))?;
    let [probe, others @ ..] = all else {
        return Err(file.error("has no columns"));
    };
    let names_probes = header.has(probe);
    let sheet = Sheet::read(&table, if names_probes { all } else { others })?;
    let (probes, note) = match names_probes {
        true => {
            let of_row =
                |(line, numbers): (usize, &[f64])| sheet.index(line, probe.name, numbers[0]);
            let probes: Result<Vec<u64>, _> = sheet.rows().map(of_row).collect();
            (probes?, None)
        }
        false => {
            let (probes, note) = counted(&sheet, is_series);
            (probes, Some(note))
        }
    };
    let rows = sheet
        .rows()
        .zip(&probes)
        .enumerate()
        .map(|(row, ((line, numbers), &probe))| Row {
            row,
            line,
            probe,
            numbers: if names_probes { &numbers[1..] } else { numbers },
        });
    let rows = if is_series {
        last_of_each(&sheet, rows)?
    } else {
        one_of_each(&sheet, rows)?
    };
    let (rows, probes, readings) = rows.into_iter().fold(
        (Vec::new(), Vec::new(), Vec::new()),
        |(mut rows, mut probes, mut readings), (row, probe, reading)| {
            rows.push(row);
            probes.push(probe);
            readings.push(reading);
            (rows, probes, readings)
        },
    );
    Ok(RollReadings {
        unit: sheet.unit,
        origin: Origin::File {
            name: sheet.file,
            lines: Vec::new(),
        },
        probes,
        readings,
        rows,
        extras: sheet.extras,
        note,
    })
}

/// Whether a table has time series; where it could be both, it must be told.
fn is_series(table: &Written<'_>) -> Result<bool, RecordedError> {
    let header = header(table, &columns_of("roll"))?;
    let has = |column: &Column| header.has(column);
    let is_told = |column: &Column| header.is_told(column);
    let (shifts, pads) = (&ROLLS[3..], &ROLL_SERIES[4..]);
    match (shifts.iter().all(has), pads.iter().all(has)) {
        (true, true) => match (shifts.iter().any(is_told), pads.iter().any(is_told)) {
            (shifts, pads) if shifts != pads => Ok(pads),
            _ => {
                let message = "there are both shift_u, shift_v and pad_u, pad_v; say by --columns which of them are meant, \
                               as in --columns 'shift_u=…,shift_v=…'";
                Err(table.file.fail(table.header_line, message))
            }
        },
        (true, false) => Ok(false),
        (false, true) => Ok(true),
        (false, false) => Ok(pads.iter().any(has) || has(&ROLL_SERIES[1])),
    }
}

/// Number of the probe of each row of a table that does not name them, and how it was told, in words.
fn counted(sheet: &Sheet, is_series: bool) -> (Vec<u64>, String) {
    let rows = sheet.lines.len();
    if !is_series {
        let note = format!("no column `probe`: each of the {rows} rows counts as a probe");
        return ((0..rows as u64).collect(), note);
    }
    let times: Vec<f64> = sheet.rows().map(|(_, numbers)| numbers[0]).collect();
    let is_start = |row: &usize| {
        let falls = *row > 0 && times[*row] <= times[*row - 1];
        falls || sheet.after_gaps.contains(row)
    };
    let starts: Vec<usize> = (0..rows).filter(is_start).collect();
    let (parts, count) = parted(rows, &starts);
    let note =
        format!("no column `probe`: {count} are told, by blank lines or by times that do not rise");
    (parts.into_iter().map(|part| part as u64).collect(), note)
}

/// A row of numbers behind that of its probe.
struct Row<'a> {
    row: usize,
    line: usize,
    probe: u64,
    numbers: &'a [f64],
}

/// Row, probe and reading.
type Taken = (usize, u64, ProbeReading);

fn reading(rotation_x: f64, rotation_y: f64, u: f64, v: f64) -> ProbeReading {
    ProbeReading {
        rotation: Vector2::new(rotation_x, rotation_y),
        shift: Vector2::new(u, v),
    }
}

fn one_of_each<'a>(
    sheet: &Sheet,
    rows: impl Iterator<Item = Row<'a>>,
) -> Result<Vec<Taken>, RecordedError> {
    let mut known = HashSet::new();
    let mut taken = Vec::new();
    for Row {
        row,
        line,
        probe,
        numbers,
    } in rows
    {
        let &[x, y, u, v] = numbers else {
            continue;
        };
        if !known.insert(probe) {
            return Err(sheet.fail(line, format!("probe {probe} stands twice")));
        }
        taken.push((row, probe, reading(x, y, u, v)));
    }
    Ok(taken)
}

fn last_of_each<'a>(
    sheet: &Sheet,
    rows: impl Iterator<Item = Row<'a>>,
) -> Result<Vec<Taken>, RecordedError> {
    let mut times: HashMap<u64, (usize, f64)> = HashMap::new();
    let mut taken = Vec::new();
    for Row {
        row,
        line,
        probe,
        numbers,
    } in rows
    {
        let &[t_s, x, y, u, v] = numbers else {
            continue;
        };
        let one = (row, probe, reading(x, y, u, v));
        match times.get_mut(&probe) {
            Some((_, before)) if t_s <= *before => {
                let message =
                    format!("column `t_s`: probe {probe} goes from {before} s back to {t_s} s");
                return Err(sheet.fail(line, message));
            }
            Some((place, before)) => {
                *before = t_s;
                taken[*place] = one;
            }
            None => {
                times.insert(probe, (taken.len(), t_s));
                taken.push(one);
            }
        }
    }
    Ok(taken)
}

/// Estimates the object's curvature from recorded rolls.
///
/// Standard deviations follow from the noise that is stated, else from the residuals, where
/// there are more readings than unknowns.
///
/// ```
/// use palpate_scene::recorded::{RecordedFile, RollOptions, estimate_roll, parse_roll};
///
/// // A probe of radius 10 that is turned by 0.3 on a ball of radius 20 rolls over 0.3 / (1/10 + 1/20) = 2.
/// let csv = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n0,0,-0.3,2,0\n1,0.3,0,0,2\n";
/// let readings = parse_roll(RecordedFile::new("readings.csv", csv.as_bytes().to_vec()))?;
/// let estimate = estimate_roll(&readings, &RollOptions::new(10.0))?;
/// let estimate = serde_json::to_value(estimate)?;
/// let curvature = estimate["mean_curvature"]["value"].as_f64().ok_or("no number")?;
/// assert!((curvature - 0.05).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RecordedError::Readings`] where the options contradict the file or the readings do not tell
/// the curvature.
pub fn estimate_roll(
    recorded: &RollReadings,
    options: &RollOptions,
) -> Result<RollEstimate, RecordedError> {
    let origin = &recorded.origin;
    let unit = agreed_unit(origin, recorded.unit, options.length_unit)?;
    let readings = &recorded.readings;
    let suspicion = of_roll(readings, options.probe_radius);
    let fail = |message: String| {
        let suspicion = suspicion.as_deref();
        origin.fail(suspicion.map_or(message.clone(), |more| format!("{message}; {more}")))
    };
    let half_way = PI * options.probe_radius;
    for (probe, reading) in recorded.probes.iter().zip(readings) {
        let shift = reading.shift.norm();
        if shift > half_way * (1.0 + 1e-9) {
            let unit = unit.as_str();
            return Err(fail(format!(
                "probe {probe}: a shift of {} {unit} passes half way round the probe ({} {unit})",
                Number(shift),
                Number(half_way)
            )));
        }
    }
    let refused = |error: Ep1Error| {
        let message = match error {
            Ep1Error::NotFinite { probe } => {
                format!(
                    "probe {}: the reading is not finite",
                    recorded.probes[probe]
                )
            }
            Ep1Error::Unresolved {
                radius_below: Some(_),
                ..
            } => {
                format!("{error} {}", unit.as_str())
            }
            _ => error.to_string(),
        };
        fail(explained(message, error.name()))
    };

    let RollEstimatorConfig::LeastSquares {} = options.estimator;
    let stated = options.noise;
    let fit = |noise| LeastSquares::fitted(options.probe_radius, noise, readings).map_err(refused);
    let (mut fitted, mut estimate) = fit(stated)?;
    let (residual, freedom) = estimate.residual(readings);
    let mut std_from = match stated {
        ReadingNoise {
            relative_rotation_std: 0.0,
            rotation_std_rad: 0.0,
            shift_resolution,
            ..
        } if shift_resolution > 0.0 => "the pads' pitch",
        _ => "the stated noise",
    };
    if !stated.is_stated() {
        std_from = "none: the residuals are zero and no pitch is given";
        if freedom > 0 && residual > 0.0 {
            std_from = "the residuals";
            (fitted, estimate) = fit(ReadingNoise {
                shift_std: residual,
                ..stated
            })?;
        }
    }

    let explained = expected(&stated, readings);
    let noise = (freedom > 0 && explained > 0.0 && residual > LARGE_RESIDUAL * explained).then(|| {
        format!(
            "the residuals are {} times what the noise that is given explains: standard deviations are too small",
            Number::rounded(residual / explained)
        )
    });
    let value =
        |measured: Measured, power: Unit| Value::new(measured.value, measured.std, power, unit);
    let bare = |value: f64, power: Unit| Value::new(value, None, power, unit);
    let principal = estimate.curvature.principal();
    Ok(RollEstimate {
        format_version: FORMAT_VERSION,
        method: "least-squares",
        probes: readings.len(),
        normal_curvature_u: value(estimate.normal_curvature_u, Unit::PerLength),
        normal_curvature_v: value(estimate.normal_curvature_v, Unit::PerLength),
        gaussian_curvature: value(estimate.gaussian_curvature, Unit::PerLengthSquared),
        mean_curvature: value(estimate.mean_curvature, Unit::PerLength),
        arc_length: bare(estimate.arc_length, Unit::Length),
        principal_curvature_min: bare(principal.k_min, Unit::PerLength),
        principal_curvature_max: bare(principal.k_max, Unit::PerLength),
        principal_direction_max_deg: principal.angle_of_max_rad.to_degrees() + 0.0,
        amplification_u: estimate.amplification(0.0),
        amplification_v: estimate.amplification(FRAC_PI_2),
        residual_rms: bare(residual, Unit::Length),
        std_from,
        unresolved_probes: unresolved(
            recorded,
            options.probe_radius,
            stated.shift_resolution,
            unit,
        ),
        warnings: suspicion
            .into_iter()
            .chain(noise)
            .chain(recorded.note.clone())
            .collect(),
        covariance: fitted.covariance(&estimate),
    })
}

/// Ratio of the residuals to what the stated noise explains past which they contradict each other. A roll of two probes
/// has but one equation to spare, and chance gives that three standard deviations once in 400.
const LARGE_RESIDUAL: f64 = 3.0;

/// Root mean square of the residuals of a shift's component that the stated noise explains, length.
fn expected(noise: &ReadingNoise, readings: &[ProbeReading]) -> f64 {
    let of_rotation = |reading: &ProbeReading| {
        let turned = reading.rotation.norm();
        let variance =
            noise.rotation_std_rad.powi(2) + (noise.relative_rotation_std * turned).powi(2);
        let per_radian = reading.shift.norm() / turned;
        if turned > 0.0 {
            variance * per_radian.powi(2)
        } else {
            0.0
        }
    };
    let mean = readings.iter().map(of_rotation).sum::<f64>() / readings.len().max(1) as f64;
    libm::hypot(noise.shift_std, mean.sqrt())
}

/// The probes that rolled without a shift, with what that says of the object.
fn unresolved(
    recorded: &RollReadings,
    probe_radius: f64,
    resolution: f64,
    unit: LengthUnit,
) -> Vec<UnresolvedProbe> {
    let still = |reading: &ProbeReading| {
        reading.shift == Vector2::zeros() && reading.rotation != Vector2::zeros()
    };
    recorded
        .probes
        .iter()
        .zip(&recorded.readings)
        .enumerate()
        .filter(|(_, (_, reading))| still(reading))
        .map(|(place, (&probe, reading))| {
            let radius = 1.0 / (reading.rotation.norm() / resolution - 1.0 / probe_radius);
            let radius_below =
                (resolution > 0.0 && radius > 0.0 && radius.is_finite()).then_some(radius);
            UnresolvedProbe {
                probe,
                radius_below,
                unit: unit.as_str().to_owned(),
                columns: recorded
                    .rows
                    .get(place)
                    .map_or_else(BTreeMap::new, |&row| recorded.extras.named(row)),
            }
        })
        .collect()
}

/// Readings as a table that [`read_roll`] accepts, one row per probe.
pub fn roll_readings_table(readings: &[ProbeReading], unit: LengthUnit) -> Table {
    let unit = unit.as_str();
    let mut table = Table::new(ROLLS.iter().map(|column| {
        if column.measure == Measure::Length {
            format!("{}_{unit}", column.name)
        } else {
            column.name.to_owned()
        }
    }));
    for (probe, reading) in readings.iter().enumerate() {
        let (rotation, shift) = (reading.rotation, reading.shift);
        table.push(probe, [rotation.x, rotation.y, shift.x, shift.y]);
    }
    table
}
