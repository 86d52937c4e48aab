//! A histogram over the bits of floating-point numbers: merging is integer addition, and bins are fine everywhere.

use serde::{Deserialize, Serialize};

/// Bins per octave and sign, as a power of two.
const BIN_BITS: u32 = 7;
/// Bit of a page's bin number that holds the sign.
const SIGN_BIN: u8 = 1 << BIN_BITS;
/// Explicit bits of a float's significand.
const SIGNIFICAND_BITS: u32 = f64::MANTISSA_DIGITS - 1;
/// Mask of a float's exponent bits, shifted down.
const EXPONENT_MASK: u64 = 0x7ff;

/// Counts of one octave: 128 positive bins, then 128 negative ones, each by growing magnitude.
type Page = [u64; 1 << (BIN_BITS + 1)];

/// Bins up to which they are listed one by one, which takes less time and memory than pages.
const FEW: usize = 512;

/// Counts of finite numbers in 128 bins per octave and sign; zero has its own bin.
///
/// A bin's representative is its middle, at most 0.4 % from any number in the bin. Subnormal numbers (below 2.3e-308)
/// count as zero. An octave takes memory once a number falls into it.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(from = "Vec<(u32, u64)>", into = "Vec<(u32, u64)>")]
pub(crate) struct Histogram {
    /// Bin of each number, as long as there are few of them: then there are no pages and no zeros.
    few: Vec<Bin>,
    zeros: u64,
    /// Exponent bits of the first page.
    first: usize,
    pages: Vec<Option<Box<Page>>>,
}

/// Bin of a number: its sign, exponent and the first bits of its significand, in the order of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Bin(u32);

impl Bin {
    const ZERO: Self = Self(1 << (32 - 1 - Self::UNUSED));
    /// Bits of 32 that a bin does not need.
    const UNUSED: u32 = 32 - (1 + 11 + BIN_BITS);

    fn of(value: f64) -> Self {
        let bits = value.to_bits();
        let magnitude = (bits & (u64::MAX >> 1)) >> (SIGNIFICAND_BITS - BIN_BITS);
        let magnitude = match magnitude >> BIN_BITS {
            0 => 0,
            _ => magnitude as u32,
        };
        match bits >> 63 {
            0 => Self(Self::ZERO.0 + magnitude),
            _ => Self(Self::ZERO.0 - magnitude),
        }
    }

    /// Octave (exponent bits) and place in its page; octave 0 is that of zero.
    fn place(self) -> (usize, u8) {
        let sign = if self < Self::ZERO { SIGN_BIN } else { 0 };
        let magnitude = self.0.abs_diff(Self::ZERO.0);
        let bin = (magnitude as u8 & (SIGN_BIN - 1)) | sign;
        ((magnitude >> BIN_BITS) as usize, bin)
    }

    fn at(octave: usize, bin: u8) -> Self {
        let magnitude = ((octave as u32) << BIN_BITS) | u32::from(bin & (SIGN_BIN - 1));
        match bin & SIGN_BIN {
            0 => Self(Self::ZERO.0 + magnitude),
            _ => Self(Self::ZERO.0 - magnitude),
        }
    }

    /// The middle of the bin.
    fn representative(self) -> f64 {
        if self == Self::ZERO {
            return 0.0;
        }
        let sign = u64::from(self < Self::ZERO) << 63;
        let magnitude = u64::from(self.0.abs_diff(Self::ZERO.0));
        let middle = 2 * magnitude + 1;
        f64::from_bits(sign | (middle << (SIGNIFICAND_BITS - BIN_BITS - 1)))
    }
}

impl Histogram {
    /// Counts finite numbers.
    pub(crate) fn add_all(&mut self, values: &[f64]) {
        if self.is_listed() {
            if self.few.len() + values.len() <= FEW {
                self.few.extend(values.iter().map(|&value| Bin::of(value)));
                return;
            }
            self.spread();
        }
        values.iter().for_each(|&value| self.add(value));
    }

    /// Whether there are no numbers.
    pub(crate) fn is_empty(&self) -> bool {
        self.is_listed() && self.few.is_empty()
    }

    fn is_listed(&self) -> bool {
        self.pages.is_empty() && self.zeros == 0
    }

    /// Moves the listed bins to pages.
    fn spread(&mut self) {
        for bin in std::mem::take(&mut self.few) {
            self.count(bin, 1);
        }
    }

    /// Counts numbers of a bin, in pages.
    fn count(&mut self, bin: Bin, count: u64) {
        match bin.place() {
            (0, _) => self.zeros += count,
            (octave, bin) => {
                let page = self.slot(octave).get_or_insert_with(|| Box::new([0; _]));
                page[usize::from(bin)] += count;
            }
        }
    }

    #[inline]
    fn add(&mut self, value: f64) {
        let bits = value.to_bits();
        let octave = ((bits >> SIGNIFICAND_BITS) & EXPONENT_MASK) as usize;
        let sign = (bits >> 63 << BIN_BITS) as u8;
        let bin = sign | ((bits >> (SIGNIFICAND_BITS - BIN_BITS)) as u8 & (SIGN_BIN - 1));
        match self.pages.get_mut(octave.wrapping_sub(self.first)) {
            Some(Some(page)) => page[usize::from(bin)] += 1,
            _ => self.count(Bin::of(value), 1),
        }
    }

    /// The place of an octave's page, made by extending the range of octaves if need be.
    fn slot(&mut self, octave: usize) -> &mut Option<Box<Page>> {
        if self.pages.is_empty() {
            self.first = octave;
        }
        if octave < self.first {
            let missing = self.first - octave;
            self.pages
                .splice(0..0, std::iter::repeat_n(None, missing))
                .for_each(drop);
            self.first = octave;
        }
        let index = octave - self.first;
        if index >= self.pages.len() {
            self.pages.resize(index + 1, None);
        }
        &mut self.pages[index]
    }

    /// Adds the counts of `other`; exact, so in any order.
    pub(crate) fn merge(&mut self, mut other: Histogram) {
        if other.is_listed() {
            if self.is_listed() && self.few.len() + other.few.len() <= FEW {
                self.few.append(&mut other.few);
                return;
            }
            other.spread();
        }
        self.spread();
        self.zeros += other.zeros;
        for (index, page) in other.pages.into_iter().enumerate() {
            let Some(page) = page else { continue };
            match self.slot(other.first + index) {
                Some(own) => own
                    .iter_mut()
                    .zip(*page)
                    .for_each(|(own, more)| *own += more),
                empty => *empty = Some(page),
            }
        }
    }

    /// Quantiles of probabilities in [0, 1], linear between the order statistics 0 to n − 1 at `p (n − 1)`, each of
    /// which is at most 0.4 % off; `None` without numbers.
    pub(crate) fn quantiles<const N: usize>(&self, probabilities: [f64; N]) -> Option<[f64; N]> {
        if self.is_listed() {
            let mut few = self.few.clone();
            few.sort_unstable();
            let most = few.len().checked_sub(1)?;
            return Some(probabilities.map(|p| {
                let position = p * most as f64;
                let rank = (position.floor() as usize).min(most);
                let [lower, upper] =
                    [rank, most.min(rank + 1)].map(|rank| few[rank].representative());
                (1.0 - position.fract()) * lower + position.fract() * upper
            }));
        }
        let bins = self.ascending();
        let count: u64 = bins.iter().map(|(_, count)| count).sum();
        let most = count.checked_sub(1)? as f64;
        let quantile = |p: f64| {
            let position = p * most;
            let (rank, fraction) = (position.floor() as u64, position.fract());
            let mut seen = 0;
            let place = bins.iter().position(|(_, count)| {
                seen += count;
                seen > rank
            })?;
            let lower = bins[place].0.representative();
            let next = if seen > rank + 1 {
                None
            } else {
                bins.get(place + 1)
            };
            let upper = next.map_or(lower, |(bin, _)| bin.representative());
            Some((1.0 - fraction) * lower + fraction * upper)
        };
        let found = probabilities.map(quantile);
        found
            .iter()
            .all(Option::is_some)
            .then(|| found.map(Option::unwrap_or_default))
    }

    /// Every bin that holds something, with its count, in ascending order.
    fn ascending(&self) -> Vec<(Bin, u64)> {
        if self.is_listed() {
            let mut few = self.few.clone();
            few.sort_unstable();
            let equal = few.chunk_by(|one, other| one == other);
            return equal.map(|bins| (bins[0], bins.len() as u64)).collect();
        }
        let pages = self.pages.iter().enumerate();
        let octaves: Vec<(usize, &Page)> = pages
            .filter_map(|(index, page)| Some((self.first + index, page.as_deref()?)))
            .collect();
        let of_sign = |sign: u8| {
            let bins = move |&(octave, page): &(usize, &Page)| {
                let counts =
                    page[usize::from(sign)..usize::from(sign | (SIGN_BIN - 1)) + 1].to_vec();
                let bins = (sign..=sign | (SIGN_BIN - 1)).map(move |bin| Bin::at(octave, bin));
                bins.zip(counts).filter(|&(_, count)| count > 0)
            };
            octaves.iter().flat_map(bins).collect::<Vec<_>>()
        };
        let mut all = of_sign(SIGN_BIN);
        all.reverse();
        all.extend((self.zeros > 0).then_some((Bin::ZERO, self.zeros)));
        all.extend(of_sign(0));
        all
    }
}

/// Equality of the counts, however they are kept.
impl PartialEq for Histogram {
    fn eq(&self, other: &Self) -> bool {
        self.ascending() == other.ascending()
    }
}

/// Counts by the numbers of their bins, ascending.
impl From<Histogram> for Vec<(u32, u64)> {
    fn from(histogram: Histogram) -> Self {
        let bins = histogram.ascending().into_iter();
        bins.map(|(bin, count)| (bin.0, count)).collect()
    }
}

/// Histogram of counts by bins; of a number that is no bin's, the nearest counts.
impl From<Vec<(u32, u64)>> for Histogram {
    fn from(bins: Vec<(u32, u64)>) -> Self {
        let mut histogram = Self::default();
        let total = bins.iter().map(|(_, count)| count);
        let is_few = total.fold(0, |sum: u64, &one| sum.saturating_add(one)) <= FEW as u64;
        let largest = ((EXPONENT_MASK as u32) << BIN_BITS) - 1;
        for (bin, count) in bins {
            let bin = Bin(bin.clamp(Bin::ZERO.0 - largest, Bin::ZERO.0 + largest));
            match is_few {
                true => histogram
                    .few
                    .extend(std::iter::repeat_n(bin, count as usize)),
                false => histogram.count(bin, count),
            }
        }
        histogram
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(values: &[f64]) -> Histogram {
        let mut histogram = Histogram::default();
        histogram.add_all(values);
        histogram
    }

    /// Histogram in pages, however few the numbers are.
    fn in_pages(values: &[f64]) -> Histogram {
        let mut histogram = Histogram::default();
        values.iter().for_each(|&value| histogram.add(value));
        histogram
    }

    impl Histogram {
        fn quantile(&self, p: f64) -> Option<f64> {
            self.quantiles([p]).map(|[quantile]| quantile)
        }
    }

    fn merged(mut left: Histogram, right: &Histogram) -> Histogram {
        left.merge(right.clone());
        left
    }

    /// Linear between order statistics, from all the numbers.
    fn exact_quantile(values: &[f64], p: f64) -> f64 {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let position = p * (sorted.len() - 1) as f64;
        let lower = sorted[position.floor() as usize];
        let upper = sorted[position.ceil() as usize];
        (1.0 - position.fract()) * lower + position.fract() * upper
    }

    fn finite() -> impl Strategy<Value = f64> {
        use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, ZERO};
        POSITIVE | NEGATIVE | NORMAL | ZERO
    }

    #[test]
    fn a_single_number_is_found_within_its_bin() {
        for value in [
            1.0,
            -1.0,
            1.999_999,
            1e300,
            -1e300,
            1e-300,
            f64::MAX,
            f64::MIN,
            0.1,
        ] {
            let found = of(&[value]).quantile(0.5).unwrap();
            assert!(
                ((found - value) / value).abs() <= 1.0 / 256.0,
                "{value}: {found}"
            );
        }
    }

    #[test]
    fn zeros_and_subnormals_are_zero() {
        for value in [0.0, -0.0, 5e-324, -5e-324, 2.2e-308] {
            assert_eq!(of(&[value]).quantile(0.5), Some(0.0));
        }
    }

    #[test]
    fn nothing_has_no_quantile() {
        assert_eq!(Histogram::default().quantile(0.5), None);
    }

    #[test]
    fn extremes_take_the_memory_of_their_octaves_only() {
        let histogram = in_pages(&[1e-300, 1e300, 0.0, -1e300]);
        assert_eq!(histogram.pages.iter().flatten().count(), 2);
        assert!(histogram.quantile(0.0).unwrap() < -0.99e300);
        assert!(histogram.quantile(1.0).unwrap() > 0.99e300);
    }

    proptest! {
        #[test]
        fn merging_is_counting_together_in_any_grouping(
            a in prop::collection::vec(finite(), 0..40),
            b in prop::collection::vec(finite(), 0..40),
            c in prop::collection::vec(finite(), 0..40),
        ) {
            let (x, y, z) = (of(&a), of(&b), of(&c));
            let together = of(&[a, b, c].concat());
            prop_assert_eq!(&merged(merged(x.clone(), &y), &z), &together);
            prop_assert_eq!(&merged(x.clone(), &merged(y.clone(), &z)), &together);
            prop_assert_eq!(&merged(z, &merged(y, &x)), &together);
        }

        #[test]
        fn lists_and_pages_tell_the_same_and_read_back(
            values in prop::collection::vec(finite(), 0..60),
            more in prop::collection::vec(finite(), 0..700),
            p in 0.0..=1.0,
        ) {
            let all = [values.clone(), more.clone()].concat();
            let mut both = of(&values);
            both.add_all(&more);
            let paged = in_pages(&all);
            prop_assert_eq!(&both, &paged);
            prop_assert_eq!(both.quantile(p), paged.quantile(p));
            let written: Vec<(u32, u64)> = both.clone().into();
            prop_assert_eq!(&Histogram::from(written), &paged);
            prop_assert_eq!(merged(of(&values), &in_pages(&more)), merged(in_pages(&values), &of(&more)));
        }

        #[test]
        fn quantiles_of_one_sign_are_within_one_percent(
            values in prop::collection::vec(1e-9..1e9, 1..200),
            negative: bool,
            p in 0.0..=1.0,
        ) {
            let sign = if negative { -1.0 } else { 1.0 };
            let values: Vec<f64> = values.iter().map(|value| sign * value).collect();
            let exact = exact_quantile(&values, p);
            let found = of(&values).quantile(p).unwrap();
            prop_assert!(((found - exact) / exact).abs() < 0.01, "{} {}", found, exact);
        }

        #[test]
        fn extreme_quantiles_are_finite_and_between_the_ends(
            values in prop::collection::vec(finite(), 1..50),
            p in 0.0..=1.0,
        ) {
            let found = of(&values).quantile(p).unwrap();
            let slack = |end: f64| end.abs() / 250.0 + f64::MIN_POSITIVE;
            let (low, high) = (exact_quantile(&values, 0.0), exact_quantile(&values, 1.0));
            prop_assert!(found.is_finite());
            prop_assert!(found >= low - slack(low) && found <= high + slack(high));
        }
    }
}
