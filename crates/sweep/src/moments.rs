//! Moments, that is, the mean and the standard deviation of finite numbers of any magnitude. The moments of several
//! parts can be merged.

/// Count, mean and sum of squared deviations of some finite numbers.
///
/// The mean and the deviations are computed from the differences from the first number. Otherwise a small scatter
/// around a large mean would be lost by rounding. The remaining rounding error grows at most in proportion to the count
/// of numbers. Very large or very small numbers are stored in units of a power of two, so that their squares neither
/// overflow nor underflow. Parts are merged by the formula of Chan, Golub and LeVeque (1983). A different order of
/// merging changes the last bits of the result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    count: u64,
    /// Exponent of the unit 2^exponent in which `origin`, `mean` and `squares` are stored.
    exponent: i32,
    /// The first of the summarised numbers. `mean` and `squares` describe the differences from this number.
    origin: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Moments of finite `values`. If there are no values, all numbers in the result are zero.
    pub(crate) fn of(values: &[f64]) -> Self {
        let Some(&first) = values.first() else {
            return Self::default();
        };
        let exponent = exponent(largest(values));
        let per_unit = power_of_two(-exponent);
        let origin = first * per_unit;
        let deviation = |value: f64| value * per_unit - origin;
        let sums = [
            sum(values, deviation),
            sum(values, |value| deviation(value) * deviation(value)),
        ];
        Self::about(origin, exponent, values.len() as u64, sums)
    }

    pub(crate) fn one(value: f64) -> Self {
        Self::of(&[value])
    }

    /// Moments of finite `values`. `sums` contains two sums over the values: the sum of the differences from the first
    /// value, and the sum of the squares of these differences. If the values are so large or so small that they need
    /// scaling, `sums` are ignored and computed again.
    pub(crate) fn with_sums(values: &[f64], sums: [f64; 2]) -> Self {
        match values.first() {
            Some(&first) if is_ordinary(sums[1]) => {
                Self::about(first, 0, values.len() as u64, sums)
            }
            _ => Self::of(values),
        }
    }

    fn about(origin: f64, exponent: i32, count: u64, [sum, squares]: [f64; 2]) -> Self {
        let mean = sum / count as f64;
        Self {
            count,
            exponent,
            origin,
            mean,
            squares: (squares - sum * mean).max(0.0),
        }
    }

    /// Moments of the absolute values of some numbers. `self` contains the moments of the numbers themselves, and
    /// `mean` is the mean of their absolute values.
    pub(crate) fn of_magnitudes(&self, mean: f64) -> Self {
        let (signed, mean) = (self.origin + self.mean, mean * power_of_two(-self.exponent));
        let excess = (signed - mean) * (signed + mean) * self.count as f64;
        Self {
            origin: 0.0,
            mean,
            squares: (self.squares + excess).max(0.0),
            ..*self
        }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let mut other = *other;
        let exponent = self.exponent.max(other.exponent);
        self.rescale(exponent);
        other.rescale(exponent);

        let count = self.count + other.count;
        let share = other.count as f64 / count as f64;
        let delta = (other.origin - self.origin) + (other.mean - self.mean);
        self.mean += delta * share;
        self.squares += other.squares + delta * delta * share * self.count as f64;
        self.count = count;
    }

    /// Changes the unit to 2^exponent, which must not be smaller than the current unit.
    fn rescale(&mut self, exponent: i32) {
        let factor = power_of_two(self.exponent - exponent);
        self.exponent = exponent;
        self.origin *= factor;
        self.mean *= factor;
        self.squares *= factor * factor;
    }

    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    pub(crate) fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.in_plain_units(self.origin + self.mean))
    }

    pub(crate) fn rms(&self) -> Option<f64> {
        let mean = self.origin + self.mean;
        let mean_square = self.squares / self.count as f64 + mean * mean;
        (self.count > 0).then(|| self.in_plain_units(mean_square.sqrt()))
    }

    /// Sample standard deviation, with the divisor count − 1; `None` for fewer than two numbers.
    pub(crate) fn std(&self) -> Option<f64> {
        let variance = self.squares / self.count.checked_sub(1)? as f64;
        (self.count > 1).then(|| self.in_plain_units(variance.sqrt()))
    }

    pub(crate) fn std_of_mean(&self) -> Option<f64> {
        Some(self.std()? / (self.count as f64).sqrt())
    }

    fn in_plain_units(&self, value: f64) -> f64 {
        value * power_of_two(self.exponent)
    }
}

/// Number of partial sums that are computed independently, so that the compiler can use vector instructions.
pub(crate) const LANES: usize = 8;
/// Largest absolute exponent of the unit 2^exponent. For exponents up to this limit, the unit is a normal (not
/// subnormal) float, and no square of a number in this unit overflows or underflows.
const MAX_EXPONENT: i32 = 1000;
/// Numbers with absolute values from 2^−200 to 2^200 need no scaling. The fourth powers of such numbers are normal
/// floats, and so are sums of up to 2^60 of these powers.
const ORDINARY: i32 = 200;

/// Sum of the function `term` over all values, computed in a fixed order.
pub(crate) fn sum(values: &[f64], term: impl Fn(f64) -> f64) -> f64 {
    let mut lanes = [0.0; LANES];
    for chunk in values.chunks(LANES) {
        for (lane, &x) in lanes.iter_mut().zip(chunk) {
            *lane += term(x);
        }
    }
    lanes.into_iter().sum()
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Exponent of the unit 2^exponent in which numbers up to `largest` are stored. It is 0 if `largest` is from 2^−200 to
/// 2^200.
pub(crate) fn exponent(largest: f64) -> i32 {
    let biased = (largest.abs().to_bits() >> 52) as i32;
    match biased - 1023 {
        exponent if exponent.abs() <= ORDINARY => 0,
        exponent => exponent.clamp(-MAX_EXPONENT, MAX_EXPONENT),
    }
}

/// Whether no scaling is needed: the sum of squares `squares` is far from the largest and the smallest floats, so it
/// has neither overflowed nor underflowed.
pub(crate) fn is_ordinary(squares: f64) -> bool {
    (1e-200..1e200).contains(&squares)
}

/// 2^exponent, for exponents up to 1023. A result that would be subnormal is replaced by 0.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023).max(0) as u64) << 52)
}
