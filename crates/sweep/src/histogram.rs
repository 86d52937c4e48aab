//! A histogram whose bins are defined by the bits of floating-point numbers. The width of a bin, relative to the
//! numbers in it, is about the same at all magnitudes. Two histograms are merged by adding their counts, which are
//! integers.

use pulp::{Arch, Simd, WithSimd};

/// Binary logarithm of the number of bins per octave and sign. An octave is the range from one power of two to the
/// next.
const BIN_BITS: u32 = 7;
const SIGNIFICAND_BITS: u32 = f64::MANTISSA_DIGITS - 1;
/// Number of bins per octave, for positive and negative numbers together.
const PLACES: usize = 1 << (BIN_BITS + 1);
/// Largest number of values for which the histogram lists the bin of each value instead of counting the values per bin.
/// For few values, the list needs less time and memory.
const FEW: usize = 512;
/// Number of values whose bins are computed together with vector instructions.
const CHUNK: usize = 64;

/// Bin of a number: its exponent, the first bits of its significand and, in the last bit, its sign.
type Bin = u64;
/// Counts of the values in each bin of one octave. The index of a count consists of the last bits of its [`Bin`].
type Page = [u64; PLACES];

/// Counts of finite numbers, with 128 bins per sign and octave (range from one power of two to the next).
///
/// All numbers in a bin are represented by the middle of the bin, which differs from each of them by at most 0.4 %.
/// Zero and subnormal numbers (below 2.3e-308) are represented by 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Histogram {
    /// A list with the bin of each value. It is used for up to [`FEW`] values; for more values, the list is empty, and
    /// the counts per bin are stored instead.
    few: Vec<Bin>,
    /// Octave of the first entry in `pages`: the exponent bits of the floating-point numbers in this octave.
    first: usize,
    /// Counts per bin, with one page for each octave from the octave `first` on; `None` for an octave without values.
    pages: Vec<Option<Box<Page>>>,
}

#[inline(always)]
fn bin_of(value: f64) -> Bin {
    let bits = value.to_bits();
    (bits << 1) >> (SIGNIFICAND_BITS - BIN_BITS) & !1 | bits >> 63
}

fn representative(bin: Bin) -> f64 {
    if bin < PLACES as u64 {
        return 0.0;
    }
    f64::from_bits(bin << 63 | (bin | 1) << (SIGNIFICAND_BITS - BIN_BITS - 1))
}

impl Histogram {
    pub(crate) fn add(&mut self, values: &[f64]) {
        if self.is_listed() {
            if self.few.len() + values.len() <= FEW {
                self.few.extend(values.iter().map(|&value| bin_of(value)));
                return;
            }
            self.list_no_more();
        }
        Arch::new().dispatch(Count {
            histogram: self,
            values,
        });
    }

    fn is_listed(&self) -> bool {
        self.pages.is_empty()
    }

    /// Changes from the list of bins to counts per bin: counts the listed values, and empties the list.
    fn list_no_more(&mut self) {
        for bin in std::mem::take(&mut self.few) {
            self.count(bin);
        }
    }

    #[inline(always)]
    fn count(&mut self, bin: Bin) {
        let octave = bin as usize / PLACES;
        let page = match self.pages.get_mut(octave.wrapping_sub(self.first)) {
            Some(Some(page)) => page,
            _ => self.page(octave),
        };
        page[bin as usize % PLACES] += 1;
    }

    /// Page with the counts of an octave. A missing page is created.
    #[cold]
    fn page(&mut self, octave: usize) -> &mut Page {
        if self.is_listed() {
            self.first = octave;
        }
        let below = self.first.saturating_sub(octave);
        self.pages.splice(0..0, (0..below).map(|_| None));
        self.first -= below;
        let place = octave - self.first;
        if place >= self.pages.len() {
            self.pages.resize(place + 1, None);
        }
        self.pages[place].get_or_insert_with(|| Box::new([0; PLACES]))
    }

    /// Adds the counts of `other`. Counts are integers, so the order of merging does not matter.
    pub(crate) fn merge(&mut self, mut other: Self) {
        if self.is_listed() && self.few.is_empty() {
            *self = other;
            return;
        }
        if other.is_listed() && self.is_listed() && self.few.len() + other.few.len() <= FEW {
            self.few.append(&mut other.few);
            return;
        }
        self.list_no_more();
        other.few.into_iter().for_each(|bin| self.count(bin));
        for (octave, page) in (other.first..).zip(other.pages) {
            if let Some(page) = page {
                let counts = self.page(octave).iter_mut().zip(*page);
                counts.for_each(|(own, more)| *own += more);
            }
        }
    }

    /// Quantiles for probabilities p from 0 to 1; `None` without numbers. The n numbers are sorted and have the
    /// positions 0 to n − 1. A quantile is interpolated linearly at the position `p (n − 1)`, between the two numbers
    /// that are nearest to it. Each number is replaced by the middle of its bin, so it has a relative error of at most
    /// 0.4 %.
    pub(crate) fn quantiles<const N: usize>(&self, probabilities: [f64; N]) -> Option<[f64; N]> {
        let ranked = Ranked::new(self);
        let most = ranked.count().checked_sub(1)?;
        Some(probabilities.map(|p| {
            let position = p * most as f64;
            let rank = (position.floor() as u64).min(most);
            let [lower, upper] = [rank, most.min(rank + 1)].map(|rank| ranked.value(rank));
            let fraction = position.fract();
            (1.0 - fraction) * lower + fraction * upper
        }))
    }
}

struct Ranked<'a> {
    few: Vec<f64>,
    /// Halves of pages, in ascending order of the numbers that they count. A half contains the counts of the positive
    /// or of the negative numbers of one octave.
    halves: Vec<Half<'a>>,
}

struct Half<'a> {
    page: &'a Page,
    octave: usize,
    is_negative: bool,
    count: u64,
}

impl<'a> Ranked<'a> {
    fn new(histogram: &'a Histogram) -> Self {
        let few = histogram.few.iter().map(|&bin| representative(bin));
        let mut few: Vec<f64> = few.collect();
        few.sort_unstable_by(f64::total_cmp);
        let half = |is_negative: bool| {
            let octaves = (histogram.first..).zip(&histogram.pages);
            let pages = octaves.filter_map(|(octave, page)| Some((octave, page.as_deref()?)));
            pages.map(move |(octave, page)| Half {
                page,
                octave,
                is_negative,
                count: page
                    .as_chunks()
                    .0
                    .iter()
                    .map(|pair: &[u64; 2]| pair[usize::from(is_negative)])
                    .sum(),
            })
        };
        let mut halves: Vec<Half<'_>> = half(true).collect();
        halves.reverse();
        halves.extend(half(false));
        Self { few, halves }
    }

    fn count(&self) -> u64 {
        let in_pages: u64 = self.halves.iter().map(|half| half.count).sum();
        self.few.len() as u64 + in_pages
    }

    /// Middle of the bin that contains the number with this rank. The smallest number has the rank 0, the largest
    /// `count` − 1.
    fn value(&self, rank: u64) -> f64 {
        if let Some(&value) = self.few.get(rank as usize) {
            return value;
        }
        let mut left = rank;
        for half in &self.halves {
            if left >= half.count {
                left -= half.count;
                continue;
            }
            for place in 0..PLACES / 2 {
                let place = match half.is_negative {
                    true => PLACES - 1 - 2 * place,
                    false => 2 * place,
                };
                if left < half.page[place] {
                    return representative((half.octave * PLACES + place) as Bin);
                }
                left -= half.page[place];
            }
        }
        0.0
    }
}

/// The operation that adds `values` to the counts per bin of `histogram`. It is a struct, because the crate `pulp`
/// requires this for operations with vector instructions.
struct Count<'a> {
    histogram: &'a mut Histogram,
    values: &'a [f64],
}

impl WithSimd for Count<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (chunks, rest) = self.values.as_chunks::<CHUNK>();
        for chunk in chunks {
            let mut bins = [0; CHUNK];
            for (bin, &value) in bins.iter_mut().zip(chunk) {
                *bin = bin_of(value);
            }
            bins.into_iter().for_each(|bin| self.histogram.count(bin));
        }
        rest.iter()
            .for_each(|&value| self.histogram.count(bin_of(value)));
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use proptest::prelude::*;

    fn of(values: &[f64]) -> Histogram {
        let mut histogram = Histogram::default();
        histogram.add(values);
        histogram
    }

    /// A histogram that counts the values per bin, even if a list of their bins would suffice.
    fn in_pages(values: &[f64]) -> Histogram {
        let mut histogram = of(values);
        histogram.list_no_more();
        histogram
    }

    fn counts(histogram: &Histogram) -> BTreeMap<Bin, u64> {
        let mut counts = BTreeMap::new();
        for &bin in &histogram.few {
            *counts.entry(bin).or_default() += 1;
        }
        for (octave, page) in (histogram.first..).zip(&histogram.pages) {
            let page = page.iter().flat_map(|page| page.iter().enumerate());
            let held = page.filter(|(_, count)| **count > 0);
            counts.extend(held.map(|(place, count)| ((octave * PLACES + place) as Bin, *count)));
        }
        counts
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
    fn extremes_take_the_memory_of_their_octaves_only() {
        let histogram = in_pages(&[1e-300, 1e300, 0.0, -1e300]);
        assert_eq!(histogram.pages.iter().flatten().count(), 3);
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
            prop_assert_eq!(counts(&merged(merged(x.clone(), &y), &z)), counts(&together));
            prop_assert_eq!(counts(&merged(x.clone(), &merged(y.clone(), &z))), counts(&together));
            prop_assert_eq!(counts(&merged(z, &merged(y, &x))), counts(&together));
        }

        #[test]
        fn lists_are_pages(
            values in prop::collection::vec(finite(), 0..60),
            more in prop::collection::vec(finite(), 0..700),
            p in 0.0..=1.0,
        ) {
            let mut both = of(&values);
            both.add(&more);
            let paged = in_pages(&[values.clone(), more.clone()].concat());
            prop_assert_eq!(counts(&both), counts(&paged));
            prop_assert_eq!(both.quantile(p), paged.quantile(p));
            let merged = [merged(of(&values), &in_pages(&more)), merged(in_pages(&values), &of(&more))];
            prop_assert_eq!(counts(&merged[0]), counts(&merged[1]));
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
