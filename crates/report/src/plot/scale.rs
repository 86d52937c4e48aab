//! Scales of axes: the position of a value along an axis, and the ticks of the axis.

use super::lettering::{width, wrap};
use super::sheet::TEXT;
use palpate_study::number;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// Spacing of the values along an axis: linear or logarithmic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spacing {
    Linear,
    Log,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// An axis with its range, its ticks and its grid lines. The plotters library uses this type as a coordinate.
#[derive(Debug, Clone)]
pub(crate) struct Scale {
    spacing: Spacing,
    /// Lower end of the range. On a logarithmic axis, `min` and `max` are the decimal logarithms of the ends.
    min: f64,
    max: f64,
    /// Names at the positions 0, 1, … of the axis; empty for an axis with numbers.
    names: Vec<String>,
    about: usize,
    has_minor: bool,
}

/// Largest magnitude that can be drawn on an axis. On a logarithmic axis, the inverse of this number is the smallest
/// magnitude.
const LARGEST: f64 = 1e300;
/// Smallest gap between two tick labels along the x axis, in drawing units (1/3 px).
const BETWEEN_NUMBERS: i32 = 24;

impl Spacing {
    pub(crate) fn log(is_log: bool) -> Self {
        if is_log { Self::Log } else { Self::Linear }
    }

    /// Reason why `value` cannot be drawn on an axis with this spacing; `None` if it can be drawn.
    pub(crate) fn refusal(self, value: f64) -> Option<&'static str> {
        match self {
            _ if !value.is_finite() || value.abs() > LARGEST => Some("beyond 1 × 10³⁰⁰"),
            Self::Log if value == 0.0 => Some("exactly 0, which a log axis cannot show"),
            Self::Log if value < 0.0 => Some("negative, which a log axis cannot show"),
            Self::Log if value < 1.0 / LARGEST => Some("too close to 0 for a log axis"),
            _ => None,
        }
    }

    /// The number nearest to `value` that can be drawn on an axis with this spacing.
    pub(crate) fn nearest(self, value: f64) -> f64 {
        let least = match self {
            Self::Linear => -LARGEST,
            Self::Log => 1.0 / LARGEST,
        };
        value.clamp(least, LARGEST)
    }
}

impl Scale {
    /// An axis that covers all `values`, with a margin. Each value must be finite and drawable on the axis.
    pub(crate) fn around(spacing: Spacing, values: impl Iterator<Item = f64>) -> Self {
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values {
            min = min.min(value);
            max = max.max(value);
        }
        if min > max {
            (min, max) = (1.0, 1.0);
        }
        let (min, max) = match spacing {
            Spacing::Linear => linear_range(min, max),
            Spacing::Log => {
                let (low, high) = (libm::log10(min), libm::log10(max));
                let margin = if high - low < 1e-9 {
                    0.5
                } else {
                    0.05 * (high - low)
                };
                (low - margin, high + margin)
            }
        };
        Self {
            spacing,
            ..Self::exactly(min, max)
        }
    }

    /// A linear axis whose ends are exactly `min` and `max`. The two numbers must differ.
    pub(crate) fn exactly(min: f64, max: f64) -> Self {
        Self {
            spacing: Spacing::Linear,
            min,
            max,
            names: Vec::new(),
            about: 6,
            has_minor: true,
        }
    }

    /// An axis with names instead of numbers. The first name is at 0, the next at 1, and so on.
    pub(crate) fn of_names(names: Vec<String>) -> Self {
        let end = names.len() as f64 - 0.5;
        Self {
            names,
            ..Self::exactly(-0.5, end)
        }
    }

    pub(crate) fn reversed(self) -> Self {
        Self {
            min: self.max,
            max: self.min,
            ..self
        }
    }

    pub(crate) fn with_ticks(self, about: usize) -> Self {
        Self { about, ..self }
    }

    pub(crate) fn without_minor(self) -> Self {
        Self {
            has_minor: false,
            ..self
        }
    }

    pub(crate) fn is_named(&self) -> bool {
        !self.names.is_empty()
    }

    /// Adapts the axis to a panel of the width `panel`. An axis of numbers gets as many ticks as possible without
    /// overlapping labels. An axis of names keeps all its names, but wraps long names. `gap` is the smallest distance
    /// between neighbouring names. Lengths are in drawing units (1/3 px).
    pub(crate) fn fitted(mut self, panel: i32, gap: i32) -> Self {
        if !self.names.is_empty() {
            let slot = panel / self.names.len() as i32 - gap;
            for name in &mut self.names {
                *name = wrap(name, TEXT, slot).join("\n");
            }
            return self;
        }
        let fits = |axis: &Self| {
            let mut end = i32::MIN / 2;
            axis.ticks().iter().all(|tick| {
                let half = width(&tick.label, TEXT) / 2;
                let middle = axis.map(&tick.at, (0, panel));
                let free = middle - half >= end + BETWEEN_NUMBERS;
                end = middle + half;
                free
            })
        };
        let mut choices = (3..=self.about)
            .rev()
            .map(|about| self.clone().with_ticks(about));
        choices.find(fits).unwrap_or(self.clone().with_ticks(2))
    }

    pub(crate) fn ends(&self) -> (f64, f64) {
        (self.min, self.max)
    }

    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    pub(crate) fn widest(&self) -> i32 {
        let ticks = self.ticks();
        let widths = ticks.iter().map(|tick| width(&tick.label, TEXT));
        widths.max().unwrap_or(0)
    }

    /// Largest number of lines of text in a tick label.
    pub(crate) fn lines(&self) -> i32 {
        let lines = self.names.iter().map(|name| name.lines().count() as i32);
        lines.max().unwrap_or(1)
    }

    /// Position of `value` along the axis: 0 at the lower end, 1 at the upper end.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let value = match self.spacing {
            Spacing::Log => libm::log10(value),
            Spacing::Linear => value,
        };
        (value - self.min) / (self.max - self.min)
    }

    /// The value at a position along the axis: 0 at the lower end, 1 at the upper end.
    pub(crate) fn value(&self, place: f64) -> f64 {
        let value = self.min + place * (self.max - self.min);
        match self.spacing {
            Spacing::Log => libm::pow(10.0, value),
            Spacing::Linear => value,
        }
    }

    /// Ticks at round values, with labels. There are about `self.about` ticks, but at least one. An axis of names has
    /// a tick at each name.
    pub(crate) fn ticks(&self) -> Vec<Tick> {
        if !self.names.is_empty() {
            let tick = |(at, label): (usize, &String)| Tick {
                at: at as f64,
                label: label.clone(),
            };
            return self.names.iter().enumerate().map(tick).collect();
        }
        match self.spacing {
            Spacing::Linear => self.linear_ticks(),
            Spacing::Log => self.log_ticks(),
        }
    }

    fn minor(&self) -> Vec<f64> {
        match self.spacing {
            _ if !self.has_minor || !self.names.is_empty() => Vec::new(),
            Spacing::Linear => {
                self.multiples(round_step((self.max - self.min) / (4 * self.about) as f64))
            }
            Spacing::Log if self.max - self.min > 8.0 => Vec::new(),
            Spacing::Log => self.digits(&[2, 3, 4, 5, 6, 7, 8, 9]),
        }
    }

    /// All numbers within the range of the axis that are the product of a number in `digits` and a power of ten.
    fn digits(&self, digits: &[i32]) -> Vec<f64> {
        let decades = self.min.floor() as i32..=self.max.ceil() as i32;
        let values = decades.flat_map(|e| digits.iter().map(move |k| f64::from(*k) * power(e)));
        values.filter(|v| self.holds(*v)).collect()
    }

    fn holds(&self, value: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.place(value))
    }

    fn log_ticks(&self) -> Vec<Tick> {
        let about = self.about;
        let exponents: Vec<i32> = (self.min.ceil() as i32..=self.max.floor() as i32).collect();
        if exponents.len() >= 3.min(about) {
            let step = exponents.len().div_ceil(about) as i32;
            let big = exponents.iter().any(|e| !(-3..=4).contains(e));
            let tick = |e: &i32| Tick {
                at: power(*e),
                label: match big {
                    true => format!("10{}", number::superscript(*e)),
                    false => number::rounded(power(*e)),
                },
            };
            let shown = exponents.iter().filter(|e| e.rem_euclid(step) == 0);
            return shown.map(tick).collect();
        }
        // An axis of less than three decades gets ticks at the products of these digits and powers of ten. The lists of
        // digits are sorted from the finest to the coarsest ticks. Use the first list that gives a suitable number of
        // ticks.
        let choices: [&[i32]; 3] = [&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 2, 5], &[1, 3]];
        let mut choices = choices.map(|digits| self.digits(digits)).into_iter();
        let found = choices.find(|values| (2..=about.max(3)).contains(&values.len()));
        if found.is_none() && (exponents.is_empty() || self.max - self.min < 0.5) {
            return Self::exactly(self.value(0.0), self.value(1.0))
                .with_ticks(about)
                .linear_ticks();
        }
        let values = found.unwrap_or(exponents.into_iter().map(power).collect());
        let has_powers = values.iter().any(|at| !(1e-4..1e6).contains(at));
        let label = |at: f64| {
            let exponent = (libm::log10(at) + 1e-9).floor() as i32;
            match libm::round(at / power(exponent)) {
                _ if !has_powers => number::significant(at, 3),
                1.0 => format!("10{}", number::superscript(exponent)),
                digit => format!("{digit} × 10{}", number::superscript(exponent)),
            }
        };
        let tick = |at: f64| Tick {
            at,
            label: label(at),
        };
        values.into_iter().map(tick).collect()
    }

    fn linear_ticks(&self) -> Vec<Tick> {
        let step = round_step((self.max - self.min) / self.about as f64);
        let decimals = usize::try_from(-libm::log10(step).floor() as i32).unwrap_or(0);
        let tick = |at: f64| Tick {
            at,
            label: match decimals > 5 || at.abs() >= 1e6 {
                true => number::rounded(at),
                false => format!("{at:.decimals$}").replace('-', "−"),
            },
        };
        self.multiples(step).into_iter().map(tick).collect()
    }

    fn multiples(&self, step: f64) -> Vec<f64> {
        let first = (self.min / step - 1e-9).ceil();
        let last = (self.max / step + 1e-9).floor();
        // Adding 0.0 converts a negative zero to zero.
        (0..=200)
            .map(|k| first + f64::from(k))
            .take_while(|k| *k <= last)
            .map(|k| k * step + 0.0)
            .collect()
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (start, end): (i32, i32)) -> i32 {
        // Limit positions far outside of the axis, because the plotters library uses `i32` pixels.
        let place = self.place(*value).clamp(-9.0, 9.0);
        start + (place * f64::from(end - start)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match hint.weight().allow_light_points() {
            true => self.minor(),
            false => self.ticks().into_iter().map(|tick| tick.at).collect(),
        }
    }

    fn range(&self) -> Range<f64> {
        self.value(0.0)..self.value(1.0)
    }
}

impl ValueFormatter<f64> for Scale {
    fn format_ext(&self, value: &f64) -> String {
        let mut ticks = self.ticks().into_iter();
        let tick = ticks.find(|tick| tick.at == *value);
        tick.map_or(String::new(), |tick| tick.label)
    }
}

/// A power of ten. It is parsed from its decimal literal, so it is the nearest double.
fn power(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::MAX)
}

/// The number of the form 1 × 10ⁿ, 2 × 10ⁿ or 5 × 10ⁿ whose ratio to `width` is nearest to 1.
pub(crate) fn round_step(width: f64) -> f64 {
    let ten = libm::pow(10f64, libm::log10(width).floor());
    let ratio = width / ten;
    let factor = [(1.0, 1.41), (2.0, 3.16), (5.0, 7.07)]
        .into_iter()
        .find(|(_, below)| ratio < *below);
    factor.map_or(10.0, |(factor, _)| factor) * ten
}

fn linear_range(min: f64, max: f64) -> (f64, f64) {
    let size = min.abs().max(max.abs());
    if max - min <= 1e-6 * size || size < 1.0 / LARGEST {
        let margin = if size < 1.0 / LARGEST {
            1.0
        } else {
            0.1 * size
        };
        return (min - margin, max + margin);
    }
    let margin = 0.05 * (max - min);
    // If all values are at least 0 and the smallest value is less than 0.4 of the largest, the range starts just below
    // zero, so that it contains zero.
    let low = if min >= 0.0 && min < 0.4 * max {
        -0.3 * margin
    } else {
        min - margin
    };
    let high = if max <= 0.0 && max > 0.4 * min {
        0.3 * margin
    } else {
        max + margin
    };
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extreme_ranges_have_a_few_ticks_inside() {
        let pairs = [
            (0.0, 0.0),
            (1e-310, 2e-310),
            (-1e300, 1e300),
            (1e15, 1e15 + 1.0),
            (5.0, 5.0),
            (-3.0, -3.0),
        ];
        for (a, b) in pairs {
            let axis = Scale::around(Spacing::Linear, [a, b].into_iter()).with_ticks(5);
            let ticks = axis.ticks();
            assert!((1..=12).contains(&ticks.len()), "{a} {b}: {ticks:?}");
            let holds = ticks.iter().all(|tick| axis.holds(tick.at));
            assert!(holds && axis.holds(a), "{a} {b}: {ticks:?}");
            assert!(axis.minor().len() < 100);
        }
        let nothing = Scale::around(Spacing::Log, std::iter::empty());
        assert!(!nothing.ticks().is_empty());
    }
}
