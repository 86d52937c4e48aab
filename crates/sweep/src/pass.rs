//! Passes over the observations of a quantity, with the widest vectors that the processor has.
//!
//! Sums are made of [`LANES`] partial sums, whatever the vectors are, so that every processor adds up the same bits.

use palpate_chance::HALF_WIDTHS;
use pulp::{Arch, Simd, WithSimd, bytemuck};

use crate::scale::LANES;

/// Whether all errors of estimates are finite, and standard deviations finite and at least 0. May deny it where the
/// sum of some of them is beyond the floats.
pub(crate) fn are_sound(estimates: &[f64], truth: f64, stds: &[f64]) -> bool {
    Arch::new().dispatch(AreSound {
        estimates,
        truth,
        stds,
    })
}

struct AreSound<'a> {
    estimates: &'a [f64],
    truth: f64,
    stds: &'a [f64],
}

impl WithSimd for AreSound<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        // A sum is finite only if all its terms are.
        let mut sums = [0.0; LANES];
        let (chunks, rest) = self.estimates.as_chunks::<LANES>();
        for chunk in chunks {
            for (sum, estimate) in sums.iter_mut().zip(chunk) {
                *sum += (estimate - self.truth).abs();
            }
        }
        for (sum, estimate) in sums.iter_mut().zip(rest) {
            *sum += (estimate - self.truth).abs();
        }
        let mut lowest = [0.0; LANES];
        let (chunks, rest) = self.stds.as_chunks::<LANES>();
        for chunk in chunks {
            for ((sum, lowest), &std) in sums.iter_mut().zip(&mut lowest).zip(chunk) {
                *sum += std;
                *lowest = if std < *lowest { std } else { *lowest };
            }
        }
        for ((sum, lowest), &std) in sums.iter_mut().zip(&mut lowest).zip(rest) {
            *sum += std;
            *lowest = if std < *lowest { std } else { *lowest };
        }
        sums.into_iter().all(|sum| sum < f64::INFINITY) && lowest == [0.0; LANES]
    }
}

/// Fills `errors` with the differences of estimates to the truth.
pub(crate) fn fill_errors(errors: &mut Vec<f64>, estimates: &[f64], truth: f64) {
    errors.resize(estimates.len(), 0.0);
    Arch::new().dispatch(FillErrors {
        errors,
        estimates,
        truth,
    });
}

struct FillErrors<'a> {
    errors: &'a mut [f64],
    estimates: &'a [f64],
    truth: f64,
}

impl WithSimd for FillErrors<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (error, estimate) in self.errors.iter_mut().zip(self.estimates) {
            *error = estimate - self.truth;
        }
    }
}

/// Sums of numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Totals {
    pub(crate) min: f64,
    pub(crate) max: f64,
    /// Sum of the magnitudes.
    pub(crate) magnitudes: f64,
    /// Sum of the differences to the first.
    pub(crate) differences: f64,
    /// Sum of the squared differences to the mean.
    pub(crate) squares: f64,
    /// Sums of the differences of the squares to that of the first, and of their squares.
    pub(crate) of_squares: [f64; 2],
}

impl Totals {
    /// Totals of finite `values`, the first of which is `first`. Sums are of use unless the largest magnitude is so large
    /// or small that its square leaves the floats.
    pub(crate) fn of(values: &[f64], first: f64) -> Self {
        Arch::new().dispatch(TotalsOf { values, first })
    }
}

struct TotalsOf<'a> {
    values: &'a [f64],
    first: f64,
}

impl WithSimd for TotalsOf<'_> {
    type Output = Totals;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Totals {
        let Self { values, first } = self;
        let (chunks, rest) = values.as_chunks::<LANES>();
        let (vectors, _) = S::as_simd_f64s(chunks.as_flattened());
        let groups = vectors.chunks_exact(LANES / S::F64_LANES);
        let firsts = simd.splat_f64s(first);

        let (mut min, mut max) = ([firsts; LANES], [firsts; LANES]);
        let mut magnitudes = [simd.splat_f64s(0.0); LANES];
        let mut differences = magnitudes;
        for group in groups.clone() {
            for (part, &value) in group.iter().enumerate() {
                let (low, high) = (min[part], max[part]);
                min[part] = simd.select_f64s(simd.less_than_f64s(value, low), value, low);
                max[part] = simd.select_f64s(simd.less_than_f64s(high, value), value, high);
                magnitudes[part] = simd.add_f64s(magnitudes[part], simd.abs_f64s(value));
                let difference = simd.sub_f64s(value, firsts);
                differences[part] = simd.add_f64s(differences[part], difference);
            }
        }
        let (mut min, mut max) = (lanes::<S>(&min), lanes::<S>(&max));
        let mut magnitudes = lanes::<S>(&magnitudes);
        let mut differences = lanes::<S>(&differences);
        for (lane, &value) in rest.iter().enumerate() {
            min[lane] = if value < min[lane] { value } else { min[lane] };
            max[lane] = if value > max[lane] { value } else { max[lane] };
            magnitudes[lane] += value.abs();
            differences[lane] += value - first;
        }

        let differences: f64 = differences.into_iter().sum();
        let mean = differences / values.len() as f64;
        let means = simd.splat_f64s(mean);
        let first_square = simd.splat_f64s(first * first);
        let mut squares = [simd.splat_f64s(0.0); LANES];
        let (mut beyond, mut fourths) = (squares, squares);
        for group in groups {
            for (part, &value) in group.iter().enumerate() {
                let deviation = simd.sub_f64s(simd.sub_f64s(value, firsts), means);
                let square = simd.mul_f64s(deviation, deviation);
                squares[part] = simd.add_f64s(squares[part], square);
                let excess = simd.sub_f64s(simd.mul_f64s(value, value), first_square);
                beyond[part] = simd.add_f64s(beyond[part], excess);
                fourths[part] = simd.add_f64s(fourths[part], simd.mul_f64s(excess, excess));
            }
        }
        let mut squares = lanes::<S>(&squares);
        let (mut beyond, mut fourths) = (lanes::<S>(&beyond), lanes::<S>(&fourths));
        for (lane, &value) in rest.iter().enumerate() {
            let deviation = (value - first) - mean;
            squares[lane] += deviation * deviation;
            let excess = value * value - first * first;
            beyond[lane] += excess;
            fourths[lane] += excess * excess;
        }
        Totals {
            min: min.into_iter().fold(first, f64::min),
            max: max.into_iter().fold(first, f64::max),
            magnitudes: magnitudes.into_iter().sum(),
            differences,
            squares: squares.into_iter().sum(),
            of_squares: [beyond, fourths].map(|lanes| lanes.into_iter().sum()),
        }
    }
}

/// Lanes of the vectors that [`LANES`] numbers take.
#[inline(always)]
fn lanes<S: Simd>(vectors: &[S::f64s; LANES]) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(bytemuck::cast_slice(&vectors[..LANES / S::F64_LANES]));
    lanes
}

/// Sums of standard deviations beside the errors that they are of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StdTotals {
    /// Lowest of them; 0 if none is negative.
    pub(crate) lowest: f64,
    /// Largest of them; 0 if none is positive.
    pub(crate) largest: f64,
    pub(crate) sum: f64,
    /// Numbers of errors that the intervals of 50, 80 and 95 % hold.
    pub(crate) covered: [u64; 3],
}

impl StdTotals {
    /// Totals of `stds`, which may be fewer than the errors.
    pub(crate) fn of(stds: &[f64], errors: &[f64]) -> Self {
        Arch::new().dispatch(StdTotalsOf { stds, errors })
    }
}

struct StdTotalsOf<'a> {
    stds: &'a [f64],
    errors: &'a [f64],
}

/// Whether the intervals of 50, 80 and 95 % of a standard deviation hold an error.
#[inline(always)]
pub(crate) fn is_covered(error: f64, std: f64) -> [bool; 3] {
    HALF_WIDTHS.map(|half_width| error.abs() <= half_width * std)
}

impl WithSimd for StdTotalsOf<'_> {
    type Output = StdTotals;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> StdTotals {
        let (stds, last_stds) = self.stds.as_chunks::<LANES>();
        let (errors, last_errors) = self.errors[..self.stds.len()].as_chunks::<LANES>();
        let group = LANES / S::F64_LANES;
        let (stds, _) = S::as_simd_f64s(stds.as_flattened());
        let (errors, _) = S::as_simd_f64s(errors.as_flattened());
        let (zero, one) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
        let half_widths = HALF_WIDTHS.map(|half_width| simd.splat_f64s(half_width));

        let mut lowest = [zero; LANES];
        let (mut largest, mut sums, mut covered) = (lowest, lowest, [lowest; 3]);
        for (stds, errors) in stds.chunks_exact(group).zip(errors.chunks_exact(group)) {
            for (part, (&std, &error)) in stds.iter().zip(errors).enumerate() {
                let (low, high) = (lowest[part], largest[part]);
                lowest[part] = simd.select_f64s(simd.less_than_f64s(std, low), std, low);
                largest[part] = simd.select_f64s(simd.less_than_f64s(high, std), std, high);
                sums[part] = simd.add_f64s(sums[part], std);
                let size = simd.abs_f64s(error);
                for (covered, &half_width) in covered.iter_mut().zip(&half_widths) {
                    let bound = simd.mul_f64s(half_width, std);
                    let is_covered = simd.less_than_or_equal_f64s(size, bound);
                    let count = simd.select_f64s(is_covered, one, zero);
                    covered[part] = simd.add_f64s(covered[part], count);
                }
            }
        }
        let (mut lowest, mut largest) = (lanes::<S>(&lowest), lanes::<S>(&largest));
        let (mut sums, mut covered) = (lanes::<S>(&sums), covered.map(|them| lanes::<S>(&them)));
        for (lane, (&std, &error)) in last_stds.iter().zip(last_errors).enumerate() {
            lowest[lane] = if std < lowest[lane] {
                std
            } else {
                lowest[lane]
            };
            largest[lane] = if std > largest[lane] {
                std
            } else {
                largest[lane]
            };
            sums[lane] += std;
            for (covered, is_covered) in covered.iter_mut().zip(is_covered(error, std)) {
                covered[lane] += f64::from(is_covered);
            }
        }
        StdTotals {
            lowest: lowest.into_iter().fold(0.0, f64::min),
            largest: largest.into_iter().fold(0.0, f64::max),
            sum: sums.into_iter().sum(),
            covered: covered.map(|lanes| lanes.into_iter().sum::<f64>() as u64),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every set of instructions that this processor has.
    fn arches() -> Vec<Arch> {
        let mut arches = vec![Arch::Scalar, Arch::new()];
        #[cfg(target_arch = "x86_64")]
        arches.extend(pulp::x86::V3::try_new().map(Arch::V3));
        arches
    }

    fn errors(count: usize) -> Vec<f64> {
        let step = |i: usize| (i as u64 * 5).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11;
        let uniform = |i: usize| step(i) as f64 / (1u64 << 53) as f64;
        (0..count).map(|i| uniform(i) - 0.3).collect()
    }

    #[test]
    fn every_processor_adds_up_the_same_bits() {
        for count in [1, 7, 8, 9, 64, 1000, 1024] {
            let errors = errors(count);
            let stds: Vec<f64> = errors.iter().map(|error| 0.5 + error).collect();
            let told = |arch: Arch| {
                let (values, stds) = (&errors[..], &stds[..]);
                let first = values[0];
                let totals = arch.dispatch(TotalsOf { values, first });
                let of_stds = arch.dispatch(StdTotalsOf {
                    stds,
                    errors: values,
                });
                let mut filled = vec![0.0; count];
                arch.dispatch(FillErrors {
                    errors: &mut filled,
                    estimates: values,
                    truth: 0.1,
                });
                format!("{totals:?} {of_stds:?} {filled:?}")
            };
            for arch in arches() {
                assert_eq!(told(arch), told(Arch::Scalar), "{arch:?}");
            }
        }
    }

    #[test]
    fn one_number_that_is_not_sound_is_found() {
        let estimates = errors(37);
        let stds: Vec<f64> = estimates.iter().map(|error| error.abs()).collect();
        assert!(are_sound(&estimates, 2.0, &stds) && are_sound(&estimates, 2.0, &[]));
        assert!(are_sound(&[], f64::NAN, &[]));
        for place in 0..37 {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut estimates = estimates.clone();
                estimates[place] = bad;
                assert!(!are_sound(&estimates, 2.0, &stds));
            }
            for bad in [f64::NAN, f64::INFINITY, -1e-300] {
                let mut stds = stds.clone();
                stds[place] = bad;
                assert!(!are_sound(&estimates, 2.0, &stds));
            }
        }
    }

    #[test]
    fn a_standard_deviation_covers_what_it_should() {
        let stds = vec![1.0; 21];
        let errors: Vec<f64> = (0..21).map(|i| f64::from(i) - 10.0).collect();
        let totals = StdTotals::of(&stds, &errors);
        // 0; −1, 0 and 1; the same.
        assert_eq!((totals.covered, totals.sum), ([1, 3, 3], 21.0));
        assert_eq!((totals.lowest, totals.largest), (0.0, 1.0));
        assert_eq!(StdTotals::of(&stds[..10], &errors).covered, [0, 1, 1]);
    }
}
