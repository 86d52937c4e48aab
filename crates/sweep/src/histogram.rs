//! A histogram over the bits of floating-point numbers: merging is integer addition, and bins are fine everywhere.

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

/// Counts of finite numbers in 128 bins per octave and sign; zero has its own bin.
///
/// A bin's representative is its middle, at most 0.4 % from any number in the bin. Subnormal numbers (below 2.3e-308)
/// count as zero. An octave takes memory once a number falls into it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Histogram {
    zeros: u64,
    /// Exponent bits of the first page.
    first: usize,
    pages: Vec<Option<Box<Page>>>,
}

impl Histogram {
    /// Counts finite numbers.
    pub(crate) fn add_all(&mut self, values: &[f64]) {
        values.iter().for_each(|&value| self.add(value));
    }

    #[inline]
    fn add(&mut self, value: f64) {
        let bits = value.to_bits();
        let octave = ((bits >> SIGNIFICAND_BITS) & EXPONENT_MASK) as usize;
        let sign = (bits >> 63 << BIN_BITS) as u8;
        let bin = sign | ((bits >> (SIGNIFICAND_BITS - BIN_BITS)) as u8 & (SIGN_BIN - 1));
        match self.pages.get_mut(octave.wrapping_sub(self.first)) {
            Some(Some(page)) => page[usize::from(bin)] += 1,
            _ => self.add_to_new_page(octave, bin),
        }
    }

    #[cold]
    fn add_to_new_page(&mut self, octave: usize, bin: u8) {
        if octave == 0 {
            self.zeros += 1;
        } else {
            let page = self.slot(octave).get_or_insert_with(|| Box::new([0; _]));
            page[usize::from(bin)] += 1;
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
    pub(crate) fn merge(&mut self, other: Histogram) {
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

    /// Quantile of probability `p` in [0, 1], linear between the order statistics 0 to n − 1 at `p (n − 1)`, each of
    /// which is at most 0.4 % off; `None` without numbers.
    pub(crate) fn quantile(&self, p: f64) -> Option<f64> {
        let count: u64 = self.ascending().map(|(_, count)| count).sum();
        let position = p * count.checked_sub(1)? as f64;
        let (rank, fraction) = (position.floor() as u64, position.fract());
        let mut bins = self.ascending();
        let mut seen = 0;
        while let Some((lower, count)) = bins.next() {
            seen += count;
            if seen > rank {
                let next = if seen > rank + 1 { None } else { bins.next() };
                let upper = next.map_or(lower, |(upper, _)| upper);
                return Some((1.0 - fraction) * lower + fraction * upper);
            }
        }
        None
    }

    /// Representative and count of every bin that holds something, in ascending order.
    fn ascending(&self) -> impl Iterator<Item = (f64, u64)> {
        let octaves = || {
            let numbered = self.pages.iter().enumerate();
            numbered.filter_map(|(index, page)| Some((self.first + index, page.as_deref()?)))
        };
        let negative = octaves()
            .rev()
            .flat_map(|(octave, page)| bins(octave, page, SIGN_BIN).rev());
        let positive = octaves().flat_map(|(octave, page)| bins(octave, page, 0));
        negative
            .chain([(0.0, self.zeros)])
            .chain(positive)
            .filter(|&(_, count)| count > 0)
    }
}

/// Representative and count of an octave's bins of one sign, by growing magnitude.
fn bins(octave: usize, page: &Page, sign: u8) -> impl DoubleEndedIterator<Item = (f64, u64)> {
    (0..SIGN_BIN)
        .map(move |bin| bin | sign)
        .map(move |bin| (representative(octave, bin), page[usize::from(bin)]))
}

/// The middle of a bin.
fn representative(octave: usize, bin: u8) -> f64 {
    let sign = u64::from(bin >> BIN_BITS) << 63;
    let middle = 2 * u64::from(bin & (SIGN_BIN - 1)) + 1;
    let significand = middle << (SIGNIFICAND_BITS - BIN_BITS - 1);
    f64::from_bits(sign | ((octave as u64) << SIGNIFICAND_BITS) | significand)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(values: &[f64]) -> Histogram {
        let mut histogram = Histogram::default();
        values.iter().for_each(|&value| histogram.add(value));
        histogram
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
        let histogram = of(&[1e-300, 1e300, 0.0, -1e300]);
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
