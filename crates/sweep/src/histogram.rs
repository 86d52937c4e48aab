//! A histogram over the bits of floating-point numbers: merging is integer addition, and bins are fine everywhere.

use std::collections::BTreeMap;

use pulp::{Arch, Simd, WithSimd};
use serde::{Deserialize, Serialize};

/// Bins per octave and sign, as a power of two.
const BIN_BITS: u32 = 7;
/// Explicit bits of a float's significand.
const SIGNIFICAND_BITS: u32 = f64::MANTISSA_DIGITS - 1;
/// Mask of a float's exponent bits, shifted down.
const EXPONENT_MASK: u64 = 0x7ff;

/// Counts of one octave by growing magnitude: of each bin first the positive numbers, then the negative ones.
type Page = [u64; 1 << (BIN_BITS + 1)];

/// Bins up to which they are listed one by one, which takes less time and memory than pages.
const FEW: usize = 512;

/// Most octaves that have pages side by side.
const MOST_NEAR: usize = 32;

/// Numbers whose places are found side by side.
const CHUNK: usize = 64;

/// Counts of finite numbers in 128 bins per octave and sign; zero has its own bin.
///
/// A bin's representative is its middle, at most 0.4 % from any number in the bin. Subnormal numbers (below 2.3e-308)
/// count as zero. Octaves take memory once numbers fall into them, or into octaves on both sides that are near.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(from = "Vec<(u32, u64)>", into = "Vec<(u32, u64)>")]
pub(crate) struct Histogram {
    /// Bin of each number, as long as there are few of them: then there are no pages and no zeros.
    few: Vec<Bin>,
    zeros: u64,
    /// Exponent bits of the first of the pages that are near.
    first: usize,
    /// Octaves that follow each other.
    near: Vec<Page>,
    /// Octaves that are too far from them, by exponent bits.
    far: BTreeMap<usize, Box<Page>>,
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
    fn place(self) -> (usize, usize) {
        let magnitude = self.0.abs_diff(Self::ZERO.0) as usize;
        let bin = magnitude % (1 << BIN_BITS);
        (
            magnitude >> BIN_BITS,
            2 * bin + usize::from(self < Self::ZERO),
        )
    }

    fn at(octave: usize, place: usize) -> Self {
        let magnitude = ((octave << BIN_BITS) + place / 2) as u32;
        match place % 2 {
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
        let mut values = values;
        if self.near.is_empty() {
            // The first numbers tell where most are.
            let (first, rest) = values.split_at(CHUNK.min(values.len()));
            self.count_each(first.iter().map(|&value| Bin::of(value)).collect());
            values = rest;
        }
        let left = Arch::new().dispatch(CountNear {
            start: (self.first << (BIN_BITS + 1)) as u64,
            counts: self.near.as_flattened_mut(),
            values,
        });
        self.count_each(left);
    }

    /// Whether there are no numbers.
    pub(crate) fn is_empty(&self) -> bool {
        self.is_listed() && self.few.is_empty()
    }

    fn is_listed(&self) -> bool {
        self.near.is_empty() && self.zeros == 0
    }

    /// Moves the listed bins to pages.
    fn spread(&mut self) {
        let few = std::mem::take(&mut self.few);
        self.count_each(few);
    }

    /// Counts a number of each bin, in pages.
    fn count_each(&mut self, bins: Vec<Bin>) {
        let octaves = bins.iter().map(|bin| bin.place().0);
        let octaves = octaves.filter(|&octave| octave > 0);
        if let Some((lowest, highest)) = octaves.clone().min().zip(octaves.max()) {
            self.bring_near(lowest, highest);
        }
        bins.into_iter().for_each(|bin| self.count(bin, 1));
    }

    /// Counts numbers of a bin, in pages.
    fn count(&mut self, bin: Bin, count: u64) {
        match bin.place() {
            (0, _) => self.zeros += count,
            (octave, place) => self.page(octave)[place] += count,
        }
    }

    /// The page of an octave.
    fn page(&mut self, octave: usize) -> &mut Page {
        if self.bring_near(octave, octave) {
            &mut self.near[octave - self.first]
        } else {
            self.far.entry(octave).or_insert_with(|| Box::new([0; _]))
        }
    }

    /// Makes pages for these octaves and those between them and the pages that are near, unless there are too many; tells
    /// whether the octaves are near.
    fn bring_near(&mut self, lowest: usize, highest: usize) -> bool {
        if self.near.is_empty() {
            self.first = lowest;
        }
        let (start, end) = (self.first, self.first + self.near.len());
        let (lowest, most) = (lowest.min(start), end.max(highest + 1));
        if (lowest, most) == (start, end) {
            return true;
        }
        if most - lowest > MOST_NEAR {
            return false;
        }
        let below = std::iter::repeat_n([0; _], start - lowest);
        self.near.splice(0..0, below).for_each(drop);
        self.near.resize(most - lowest, [0; _]);
        self.first = lowest;
        for (octave, page) in (lowest..).zip(&mut self.near) {
            if let Some(far) = self.far.remove(&octave) {
                *page = *far;
            }
        }
        true
    }

    /// Adds the counts of `other`; exact, so in any order.
    pub(crate) fn merge(&mut self, mut other: Histogram) {
        if self.is_empty() {
            *self = other;
            return;
        }
        if other.is_listed() {
            if self.is_listed() && self.few.len() + other.few.len() <= FEW {
                self.few.append(&mut other.few);
                return;
            }
            other.spread();
        }
        self.spread();
        self.zeros += other.zeros;
        if let Some(last) = other.near.len().checked_sub(1) {
            self.bring_near(other.first, other.first + last);
        }
        for (octave, page) in other.octaves() {
            for (own, more) in self.page(octave).iter_mut().zip(page) {
                *own += more;
            }
        }
    }

    /// Pages by their octaves, ascending.
    fn octaves(&self) -> Vec<(usize, &Page)> {
        let near = (self.first..).zip(&self.near);
        let far = self.far.iter().map(|(&octave, page)| (octave, &**page));
        let mut octaves: Vec<_> = near.chain(far).collect();
        octaves.sort_unstable_by_key(|&(octave, _)| octave);
        octaves
    }

    /// Quantiles of probabilities in [0, 1], linear between the order statistics 0 to n − 1 at `p (n − 1)`, each of
    /// which is at most 0.4 % off; `None` without numbers.
    pub(crate) fn quantiles<const N: usize>(&self, probabilities: [f64; N]) -> Option<[f64; N]> {
        let ranked = Ranked::new(self);
        let most = ranked.count.checked_sub(1)?;
        Some(probabilities.map(|p| {
            let position = p * most as f64;
            let rank = (position.floor() as u64).min(most);
            let [lower, upper] = [rank, most.min(rank + 1)].map(|rank| ranked.bin(rank));
            let fraction = position.fract();
            (1.0 - fraction) * lower.representative() + fraction * upper.representative()
        }))
    }

    /// Every bin that holds something, with its count, in ascending order.
    fn ascending(&self) -> Vec<(Bin, u64)> {
        if self.is_listed() {
            let mut few = self.few.clone();
            few.sort_unstable();
            let equal = few.chunk_by(|one, other| one == other);
            return equal.map(|bins| (bins[0], bins.len() as u64)).collect();
        }
        let octaves = self.octaves();
        let bins = octaves.iter().flat_map(|&(octave, page)| {
            let places = page.iter().enumerate();
            places.map(move |(place, &count)| (Bin::at(octave, place), count))
        });
        let zeros = (Bin::ZERO, self.zeros);
        let mut all: Vec<_> = bins
            .chain([zeros])
            .filter(|&(_, count)| count > 0)
            .collect();
        all.sort_unstable();
        all
    }
}

/// Numbers of a histogram in their order.
struct Ranked<'a> {
    count: u64,
    /// Listed bins, ascending.
    few: Vec<Bin>,
    zeros: u64,
    /// Pages by octaves, ascending, with the numbers of positive and of negative ones.
    octaves: Vec<(usize, &'a Page, [u64; 2])>,
}

impl<'a> Ranked<'a> {
    fn new(histogram: &'a Histogram) -> Self {
        let mut few = histogram.few.clone();
        few.sort_unstable();
        let zeros = histogram.zeros;
        let octaves: Vec<_> = histogram
            .octaves()
            .into_iter()
            .map(|(octave, page)| {
                let mut counts = [0; 2];
                for [positive, negative] in page.as_chunks().0 {
                    counts[0] += positive;
                    counts[1] += negative;
                }
                (octave, page, counts)
            })
            .collect();
        let in_pages: u64 = octaves.iter().flat_map(|(_, _, counts)| counts).sum();
        Self {
            count: few.len() as u64 + zeros + in_pages,
            few,
            zeros,
            octaves,
        }
    }

    /// Bin of the number of this rank, from 0 to `count` − 1.
    fn bin(&self, rank: u64) -> Bin {
        if let Some(&bin) = self.few.get(rank as usize) {
            return bin;
        }
        let mut left = rank;
        for &(octave, page, [_, negative]) in self.octaves.iter().rev() {
            if left >= negative {
                left -= negative;
                continue;
            }
            for place in (1..page.len()).step_by(2).rev() {
                if left < page[place] {
                    return Bin::at(octave, place);
                }
                left -= page[place];
            }
        }
        if left < self.zeros {
            return Bin::ZERO;
        }
        left -= self.zeros;
        for &(octave, page, [positive, _]) in &self.octaves {
            if left >= positive {
                left -= positive;
                continue;
            }
            for place in (0..page.len()).step_by(2) {
                if left < page[place] {
                    return Bin::at(octave, place);
                }
                left -= page[place];
            }
        }
        Bin::ZERO
    }
}

/// Counts numbers in pages that follow each other.
struct CountNear<'a> {
    values: &'a [f64],
    /// Place of the first count among those of all octaves.
    start: u64,
    counts: &'a mut [u64],
}

impl WithSimd for CountNear<'_> {
    /// Bins of the numbers that are in none of these pages.
    type Output = Vec<Bin>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<Bin> {
        let mut left = Vec::new();
        let (chunks, rest) = self.values.as_chunks::<CHUNK>();
        for chunk in chunks {
            let mut places = [0; CHUNK];
            for (place, value) in places.iter_mut().zip(chunk) {
                *place = place_of(*value).wrapping_sub(self.start);
            }
            let mut are_near = true;
            for place in places {
                match self.counts.get_mut(place as usize) {
                    Some(count) => *count += 1,
                    None => are_near = false,
                }
            }
            if !are_near {
                let most = self.counts.len();
                let pairs = places.iter().zip(chunk);
                let far = pairs.filter(|&(&place, _)| place as usize >= most);
                left.extend(far.map(|(_, &value)| Bin::of(value)));
            }
        }
        left.extend(rest.iter().map(|&value| Bin::of(value)));
        left
    }
}

/// Place of a number's count among those of the pages of all octaves.
#[inline(always)]
fn place_of(value: f64) -> u64 {
    let bits = value.to_bits();
    (bits << 1) >> (SIGNIFICAND_BITS - BIN_BITS) & !1 | bits >> 63
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
        histogram.count_each(values.iter().map(|&value| Bin::of(value)).collect());
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
        assert_eq!((histogram.near.len(), histogram.far.len()), (1, 1));
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
