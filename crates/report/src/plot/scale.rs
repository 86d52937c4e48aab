//! From values to places along an axis, and where the ticks stand.

use palpate_study::number;

/// The spacing of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spacing {
    Linear,
    Log,
}

/// A labelled tick.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// An axis: its range and what divides it. Ticks lie inside the range.
#[derive(Debug, Clone)]
pub(crate) struct Scale {
    spacing: Spacing,
    min: f64,
    max: f64,
    categories: Vec<String>,
}

/// Values beyond this, or closer to zero than its inverse, are not drawn.
pub(crate) const LARGEST: f64 = 1e300;

impl Spacing {
    /// Reason for which `value` has no place on such an axis, if it has none.
    pub(crate) fn refusal(self, value: f64) -> Option<&'static str> {
        match self {
            _ if !value.is_finite() || value.abs() > LARGEST => Some("beyond 1 × 10³⁰⁰"),
            Self::Log if value == 0.0 => Some("exactly 0, which a log axis cannot show"),
            Self::Log if value < 0.0 => Some("negative, which a log axis cannot show"),
            Self::Log if value < 1.0 / LARGEST => Some("too close to 0 for a log axis"),
            _ => None,
        }
    }
}

impl Spacing {
    /// The number nearest to `value` that has a place on such an axis.
    pub(crate) fn nearest(self, value: f64) -> f64 {
        let least = match self {
            Self::Linear => -LARGEST,
            Self::Log => 1.0 / LARGEST,
        };
        value.clamp(least, LARGEST)
    }
}

impl Scale {
    /// An axis that holds all `values` (which must be drawable) with a margin.
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
            min,
            max,
            categories: Vec::new(),
        }
    }

    /// A linear axis from `min` to `max`, which must be drawable and apart.
    pub(crate) fn exactly(min: f64, max: f64) -> Self {
        Self {
            spacing: Spacing::Linear,
            min,
            max,
            categories: Vec::new(),
        }
    }

    /// The lower and the upper end of a linear axis.
    pub(crate) fn ends(&self) -> (f64, f64) {
        (self.min, self.max)
    }

    /// An axis of named places: the first at 0, the next at 1, …
    pub(crate) fn of_categories(categories: Vec<String>) -> Self {
        let max = categories.len() as f64 - 0.5;
        Self {
            spacing: Spacing::Linear,
            min: -0.5,
            max,
            categories,
        }
    }

    /// The names along the axis; empty for numbers.
    pub(crate) fn categories(&self) -> &[String] {
        &self.categories
    }

    /// Place of `value` along the axis: 0 at the lower end, 1 at the upper.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let value = if self.spacing == Spacing::Log {
            libm::log10(value)
        } else {
            value
        };
        (value - self.min) / (self.max - self.min)
    }

    /// About as many labelled ticks as asked for, at least one, at round values.
    pub(crate) fn ticks(&self, about: usize) -> Vec<Tick> {
        if !self.categories.is_empty() {
            let tick = |(at, label): (usize, &String)| Tick {
                at: at as f64,
                label: label.clone(),
            };
            return self.categories.iter().enumerate().map(tick).collect();
        }
        match self.spacing {
            Spacing::Linear => self.linear_ticks(about),
            Spacing::Log => self.log_ticks(about),
        }
    }

    /// Places of unlabelled grid lines between the ticks.
    pub(crate) fn minor(&self, about: usize) -> Vec<f64> {
        if !self.categories.is_empty() {
            return Vec::new();
        }
        match self.spacing {
            Spacing::Linear => self.multiples(round_step(
                (self.max - self.min) / (4 * about.max(1)) as f64,
            )),
            Spacing::Log if self.max - self.min > 8.0 => Vec::new(),
            Spacing::Log => self
                .decades()
                .flat_map(|ten| (2..10).map(move |k| f64::from(k) * ten))
                .filter(|v| self.holds(*v))
                .collect(),
        }
    }

    fn holds(&self, value: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.place(value))
    }

    fn decades(&self) -> impl Iterator<Item = f64> + use<> {
        (self.min.floor() as i32..=self.max.ceil() as i32).map(power)
    }

    fn log_ticks(&self, about: usize) -> Vec<Tick> {
        let exponents: Vec<i32> = (self.min.ceil() as i32..=self.max.floor() as i32).collect();
        if exponents.len() >= 3.min(about) {
            let step = exponents.len().div_ceil(about.max(1)) as i32;
            let big = exponents.iter().any(|e| !(-3..=4).contains(e));
            let label = |e: i32| {
                if big {
                    format!("10{}", number::superscript(e))
                } else {
                    number::rounded(power(e))
                }
            };
            return exponents
                .into_iter()
                .filter(|e| e.rem_euclid(step) == 0)
                .map(|e| Tick {
                    at: power(e),
                    label: label(e),
                })
                .collect();
        }
        // Less than three decades: divide them, as finely as there is room for.
        let choices: [&[i32]; 3] = [&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 2, 5], &[1, 3]];
        let tick = |value: f64| Tick {
            at: value,
            label: number::significant(value, 3),
        };
        for digits in choices {
            let values: Vec<f64> = self
                .decades()
                .flat_map(|ten| digits.iter().map(move |k| f64::from(*k) * ten))
                .filter(|v| self.holds(*v))
                .collect();
            if (2..=about.max(3)).contains(&values.len()) {
                return values.into_iter().map(tick).collect();
            }
        }
        if exponents.is_empty() || self.max - self.min < 0.5 {
            let narrow = Self {
                spacing: Spacing::Linear,
                min: libm::pow(10f64, self.min),
                max: libm::pow(10f64, self.max),
                categories: Vec::new(),
            };
            return narrow.linear_ticks(about);
        }
        exponents.into_iter().map(|e| tick(power(e))).collect()
    }

    fn linear_ticks(&self, about: usize) -> Vec<Tick> {
        let step = round_step((self.max - self.min) / about.max(1) as f64);
        let decimals = usize::try_from(-libm::log10(step).floor() as i32).unwrap_or(0);
        let label = |value: f64| {
            if decimals > 5 || value.abs() >= 1e6 {
                number::rounded(value)
            } else {
                format!("{value:.decimals$}").replace('-', "−")
            }
        };
        self.multiples(step)
            .into_iter()
            .map(|at| Tick {
                at,
                label: label(at),
            })
            .collect()
    }

    fn multiples(&self, step: f64) -> Vec<f64> {
        let first = (self.min / step - 1e-9).ceil();
        let last = (self.max / step + 1e-9).floor();
        // `+ 0.0` turns a negative zero into zero.
        (0..=200)
            .map(|k| first + f64::from(k))
            .take_while(|k| *k <= last)
            .map(|k| k * step + 0.0)
            .collect()
    }
}

/// Ten to a whole power, as the decimal literal would be.
fn power(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::MAX)
}

/// The 1, 2 or 5 times a power of ten that is nearest to `width` in ratio.
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
    // A range that nearly reaches zero starts there.
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

    fn labels(scale: &Scale, about: usize) -> Vec<String> {
        scale
            .ticks(about)
            .into_iter()
            .map(|tick| tick.label)
            .collect()
    }

    #[test]
    fn log_ticks_are_plain_then_powers() {
        let log = |values: &[f64]| Scale::around(Spacing::Log, values.iter().copied());
        assert_eq!(labels(&log(&[0.1, 100.0]), 6), ["0.1", "1", "10", "100"]);
        assert_eq!(
            labels(&log(&[1e-6, 1e-3]), 6),
            ["10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³"]
        );
        assert_eq!(labels(&log(&[1.0, 8.0]), 5), ["1", "2", "5"]);
        assert_eq!(labels(&log(&[5.0, 5.0]), 5), ["2", "5", "10"]);
        assert!(labels(&log(&[1.001, 1.002]), 5).len() >= 2);
        assert!(labels(&log(&[1e-300, 1e300]), 6).len() <= 8);
    }

    #[test]
    fn linear_ticks_have_the_decimals_of_their_step() {
        let linear = |values: &[f64]| Scale::around(Spacing::Linear, values.iter().copied());
        assert_eq!(
            labels(&linear(&[0.0, 1.0]), 5),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels(&linear(&[-40.0, 60.0]), 5),
            ["−40", "−20", "0", "20", "40", "60"]
        );
    }

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
            let scale = Scale::around(Spacing::Linear, [a, b].into_iter());
            let ticks = scale.ticks(5);
            assert!((1..=12).contains(&ticks.len()), "{a} {b}: {ticks:?}");
            assert!(
                ticks.iter().all(|tick| scale.holds(tick.at)),
                "{a} {b}: {ticks:?}"
            );
            assert!((0.0..=1.0).contains(&scale.place(a)));
            assert!(scale.minor(5).len() < 100);
        }
        assert!(
            !Scale::around(Spacing::Log, std::iter::empty())
                .ticks(5)
                .is_empty()
        );
    }

    #[test]
    fn what_a_log_axis_cannot_show_is_refused() {
        assert!(
            Spacing::Log
                .refusal(0.0)
                .is_some_and(|why| why.contains("exactly 0"))
        );
        assert!(
            Spacing::Log
                .refusal(-1.0)
                .is_some_and(|why| why.contains("negative"))
        );
        assert!(Spacing::Log.refusal(1e-9).is_none());
        assert!(Spacing::Linear.refusal(0.0).is_none());
        assert!(Spacing::Linear.refusal(f64::NAN).is_some());
    }
}
