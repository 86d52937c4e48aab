//! Report of a calibration as text: a summary and warnings.

use palpate_tracking::{
    Calibration, CalibrationError, LateralCalibration, Line, NormalCalibration, NormalFrom,
};

use super::source::COPIES;
use palpate_study::Warning;
use palpate_study::config::LengthUnit;

/// The result of [`calibrate`](super::calibrate): the calibration that was fitted to the points of all series, and the
/// straight lines that were fitted to each series alone.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationReport {
    /// The calibration that was fitted to the points of all series together.
    pub calibration: Calibration,
    /// Unit of all lengths of the calibration.
    pub length_unit: LengthUnit,
    /// For each measurement series: its name, and the straight lines that were fitted to its signal (hue or size of the
    /// markers) as a function of the normal displacement. Empty if there is only one series.
    pub(super) normal: Vec<(String, Result<Fitted, CalibrationError>)>,
    /// For each measurement series: its name, and the straight lines that were fitted to its signal (shift of the
    /// markers' centroids) as a function of the tangential displacement. Empty if there is only one series.
    pub(super) lateral: Vec<(String, Result<Fitted, CalibrationError>)>,
    /// Number of points that repeat an earlier point exactly; 0 if less than half of the points are repeated.
    pub(super) copies: usize,
}

/// Two straight lines (signal against displacement) that were fitted to the same points: without and with an intercept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fitted {
    /// Line without an intercept, so that the signal is 0 at rest. Displacements are computed from this line.
    through_rest: Line,
    /// Line with an intercept, as in Fig. 6 of the 2020 paper by Lin et al.; `None` if it could not be fitted.
    with_intercept: Option<Line>,
}

impl Fitted {
    pub(super) fn normal(part: &NormalCalibration) -> Self {
        Self {
            through_rest: part.line,
            with_intercept: part.with_intercept,
        }
    }

    pub(super) fn lateral(part: &LateralCalibration) -> Self {
        Self {
            through_rest: part.line,
            with_intercept: part.with_intercept,
        }
    }
}

/// Largest accepted rms residual of a calibration, relative to the largest displacement of its points. If the residual
/// is larger, there is a warning.
const MAX_RESIDUAL: f64 = 0.1;

/// Largest accepted increase of R² if the line is fitted with an intercept instead of through the origin. If the
/// increase is larger, there is a warning.
const MAX_GAIN_OF_INTERCEPT: f64 = 0.3;

/// Largest accepted relative difference between the slopes of the lines that are fitted to single series. If the
/// difference is larger, there is a warning.
const MAX_SPREAD: f64 = 0.2;

impl CalibrationReport {
    /// Lines of text that describe the calibration.
    pub fn summary(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(part) = self.calibration.normal_part.as_ref() {
            let words = Words {
                title: format!("normal displacement from {}", feature(part.from)),
                signal: match part.from {
                    NormalFrom::Hue => "turns/",
                    NormalFrom::Size => "1/",
                    NormalFrom::Both => "",
                },
                unit: self.length_unit,
            };
            lines.extend(words.lines(part.range, &Fitted::normal(part), &self.normal));
            if part.gains.len() > 1 {
                let slopes: Vec<f64> = part.gains.iter().map(|gain| gain.line.slope).collect();
                let [low, high] = ends(&slopes).map(|slope| figures(slope, 3));
                let used = if part.uses_gains { "used" } else { "not used" };
                lines.push(format!(
                    "  slopes of {} markers by themselves, {used}: {low} to {high}",
                    slopes.len()
                ));
            }
        }
        if let Some(part) = self.calibration.lateral_part.as_ref() {
            let unit = self.length_unit;
            let words = Words {
                title: "tangential displacement from the centroid".to_owned(),
                signal: "px/",
                unit,
            };
            lines.extend(words.lines(part.range, &Fitted::lateral(part), &self.lateral));
            if let Some(slope) = part.per_indentation {
                let unit = unit.as_str();
                let [low, high] = part.normal_range.map(|end| figures(end, 4));
                lines.push(format!(
                    "  with the normal displacement u from {low} to {high} {unit}, used: ({} + {} u) px/{unit}, residual {} {unit}",
                    figures(part.px_per_length, 4),
                    figures(slope, 3),
                    figures(part.residual_rms, 3),
                ));
            }
        }
        lines
    }

    /// Warnings about the data and the result of the calibration.
    pub fn warnings(&self) -> Vec<Warning> {
        let unit = self.length_unit.as_str();
        let normal = self.calibration.normal_part.as_ref();
        let lateral = self.calibration.lateral_part.as_ref();
        let normal = normal.map(|part| {
            let residual = part.line.residual_rms;
            (
                "normal",
                residual,
                Fitted::normal(part),
                part.range,
                &self.normal,
            )
        });
        let lateral = lateral.map(|part| {
            let fitted = Fitted::lateral(part);
            (
                "tangential",
                part.residual_rms,
                fitted,
                part.range,
                &self.lateral,
            )
        });
        let mut warnings = Vec::new();
        let mut warn = |code, text: String, numbers: &[_]| {
            warnings.push(Warning::new(code, text, numbers.iter().copied()));
        };
        if self.copies > 0 {
            let copies = self.copies;
            let text = format!("{copies} points repeat others to the last digit: {COPIES}");
            warn("repeated-rows", text, &[("copies", copies as f64)]);
        }
        for (what, residual, fitted, range, series) in normal.into_iter().chain(lateral) {
            let line = fitted.through_rest;
            let free = fitted.with_intercept.map(|line| line.r_squared);
            if let Some(free) = free.filter(|free| free - line.r_squared > MAX_GAIN_OF_INTERCEPT) {
                let line = line.r_squared;
                let text = format!(
                    "a line with an intercept fits the {what} points much better (R^2 {}) than a line through the origin (R^2 {}): are they changes from rest, and in the order of the displacements?",
                    figures(free, 3),
                    figures(line, 3)
                );
                let numbers = [("r_squared", line), ("r_squared_with_intercept", free)];
                warn("not-through-rest", text, &numbers);
            }
            let largest = range[0].abs().max(range[1].abs());
            let percent = 100.0 * residual / largest;
            if residual > MAX_RESIDUAL * largest {
                let text = format!(
                    "the {what} residual is {} {unit}, {percent:.0} % of the largest displacement",
                    figures(residual, 3)
                );
                let numbers = [("residual", residual), ("largest", largest)];
                warn("large-calibration-residual", text, &numbers);
            }
            let std = line.slope_std.unwrap_or(0.0);
            if line.slope.abs() < 2.0 * std {
                let text = format!(
                    "the {what} slope, {}, is not significantly different from 0: its standard error is {}",
                    figures(line.slope, 3),
                    figures(std, 2)
                );
                let numbers = [("slope", line.slope), ("slope_std", std)];
                warn("insignificant-slope", text, &numbers);
            }
            let slope = |(_, fitted): &(_, Result<Fitted, _>)| {
                Some(fitted.as_ref().ok()?.through_rest.slope)
            };
            let slopes: Vec<f64> = series.iter().filter_map(slope).collect();
            let [low, high] = ends(&slopes);
            let spread = (high - low) / (0.5 * (low + high)).abs();
            if spread > MAX_SPREAD {
                let percent = 100.0 * spread;
                let text = format!(
                    "the {what} slopes of the series differ by up to {percent:.0} %, so displacements that are computed from one series have a scale error"
                );
                warn("different-slopes", text, &[("relative_difference", spread)]);
            }
        }
        warnings
    }
}

const fn feature(from: NormalFrom) -> &'static str {
    match from {
        NormalFrom::Hue => "hue",
        NormalFrom::Size => "size",
        NormalFrom::Both => "hue and size",
    }
}

struct Words {
    title: String,
    /// Unit of the calibrated signal, followed by a slash, such as `turns/`; empty if the signal is a length.
    signal: &'static str,
    unit: LengthUnit,
}

impl Words {
    fn lines(
        &self,
        range: [f64; 2],
        all: &Fitted,
        series: &[(String, Result<Fitted, CalibrationError>)],
    ) -> Vec<String> {
        let [low, high] = range.map(|end| figures(end, 4));
        let unit = self.unit.as_str();
        let mut lines = vec![format!("{}, {low} to {high} {unit}:", self.title)];
        if let Some(line) = &all.with_intercept {
            lines.push(format!("  all: {}", self.line(line)));
        }
        for (name, fitted) in series {
            lines.push(match fitted {
                Err(error) => format!("  {name}: {error}"),
                Ok(fitted) => {
                    let line = fitted.with_intercept.unwrap_or(fitted.through_rest);
                    format!("  {name}: {}", self.line(&line))
                }
            });
        }
        let line = self.line(&all.through_rest);
        lines.push(format!("  through the origin, used: {line}"));
        lines
    }

    fn line(&self, line: &Line) -> String {
        let unit = self.unit.as_str();
        let per_length = match self.signal {
            "" => format!("{unit}/{unit}"),
            signal => format!("{signal}{unit}"),
        };
        let std = line
            .slope_std
            .map_or_else(String::new, |std| format!(" (std {})", figures(std, 2)));
        format!(
            "{} {per_length}{std}, R^2 {}, residual {} {unit} rms, {} points",
            figures(line.slope, 4),
            figures(line.r_squared, 3),
            figures(line.residual_rms, 3),
            line.count
        )
    }
}

fn ends(numbers: &[f64]) -> [f64; 2] {
    let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let high = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [low, high]
}

fn figures(number: f64, count: usize) -> String {
    let exponent = format!("{number:.*e}", count - 1);
    let rounded = exponent.parse().unwrap_or(number);
    if rounded != 0.0 && !(1e-5..1e7).contains(&f64::abs(rounded)) {
        return format!("{rounded:e}");
    }
    format!("{rounded}")
}
