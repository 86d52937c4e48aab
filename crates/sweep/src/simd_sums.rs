//! Sums over the observations of a quantity, computed with the widest vector instructions of the processor.
//!
//! On every processor, a sum is computed from the same [`LANES`] partial sums. Therefore, vectors of any width give the
//! same result to the last bit.

use palpate_statistics::HALF_WIDTHS;
use pulp::{Arch, Simd, WithSimd, bytemuck};

use crate::column::UNREPORTED;
use crate::moments::LANES;

/// Whether all observations are valid: all errors of the estimates are finite, and all standard deviations are finite
/// and at least 0. If the sum of very large valid numbers overflows, the result is `false` too. Therefore, if the
/// result is `false`, the caller must check each observation.
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
        // If one absolute error or one standard deviation is not finite, the sum that contains it is not finite. So
        // only the sums are tested.
        let (mut sums, mut lowest) = ([0.0; LANES], [0.0; LANES]);
        let (chunks, rest) = self.estimates.as_chunks::<LANES>();
        for chunk in chunks.iter().map(<[f64; LANES]>::as_slice).chain([rest]) {
            for (sum, estimate) in sums.iter_mut().zip(chunk) {
                *sum += (estimate - self.truth).abs();
            }
        }
        let (chunks, rest) = self.stds.as_chunks::<LANES>();
        for chunk in chunks.iter().map(<[f64; LANES]>::as_slice).chain([rest]) {
            for ((sum, lowest), &std) in sums.iter_mut().zip(&mut lowest).zip(chunk) {
                *sum += std;
                *lowest = if std < *lowest { std } else { *lowest };
            }
        }
        sums.into_iter().all(|sum| sum < f64::INFINITY) && lowest == [0.0; LANES]
    }
}

/// Observations of one quantity in some trials. All three slices have the same length. A standard deviation that was
/// not reported is [`UNREPORTED`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observed<'a> {
    pub(crate) estimates: &'a [f64],
    pub(crate) truths: &'a [f64],
    pub(crate) stds: &'a [f64],
}

/// Sums over the observations of one quantity. If squares of the observed numbers overflow or underflow, the sums of
/// squares are invalid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Totals {
    /// Smallest and largest true value.
    pub(crate) truths: [f64; 2],
    /// Smallest and largest error.
    pub(crate) errors: [f64; 2],
    /// Sum over the observations of the difference (estimate − first estimate), and sum of the squares of these
    /// differences.
    pub(crate) of_estimates: [f64; 2],
    /// Sum over the observations of the difference (error − first error), and sum of the squares of these differences.
    pub(crate) of_errors: [f64; 2],
    /// Sum over the observations of the difference (|error| − |first error|).
    pub(crate) of_magnitudes: f64,
    /// Sum over the observations of the difference (error² − first error²), and sum of the squares of these
    /// differences.
    pub(crate) of_squares: [f64; 2],
    /// Number of reported standard deviations. `stds` is the sum of these standard deviations.
    pub(crate) reported: u64,
    pub(crate) stds: f64,
    /// Number of observations whose 50, 80 and 95 % intervals contain the true value.
    pub(crate) covered: [u64; 3],
}

impl Totals {
    /// Computes the sums over the observations; `None` without observations. The errors of the observations are written
    /// to `errors`.
    pub(crate) fn of(observed: Observed<'_>, errors: &mut Vec<f64>) -> Option<Self> {
        errors.resize(observed.estimates.len(), 0.0);
        let first = [*observed.estimates.first()?, *observed.truths.first()?];
        Some(Arch::new().dispatch(TotalsOf {
            observed,
            first,
            errors,
        }))
    }
}

/// Whether an error is within the 50, 80 and 95 % intervals of an estimate with this standard deviation.
pub(crate) fn is_covered(error: f64, std: f64) -> [bool; 3] {
    HALF_WIDTHS.map(|half_width| error.abs() <= half_width * std)
}

struct TotalsOf<'a> {
    observed: Observed<'a>,
    first: [f64; 2],
    errors: &'a mut [f64],
}

const SUMS: usize = 12;

/// Partial sums from which [`Totals`] are computed. All methods must be inlined, because each vector instruction would
/// otherwise be a function call.
struct Parts<S: Simd> {
    simd: S,
    /// The first estimate, and below it the first error, its absolute value (`size`) and its square. The sums are sums
    /// of differences from these four numbers. Each number is repeated in all lanes of a vector.
    estimate: S::f64s,
    error: S::f64s,
    size: S::f64s,
    square: S::f64s,
    half_widths: [S::f64s; 3],
    sums: [[S::f64s; LANES]; SUMS],
    /// Smallest true values (index 0) and smallest errors (index 1) so far. `high` contains the largest true values and
    /// errors.
    low: [[S::f64s; LANES]; 2],
    high: [[S::f64s; LANES]; 2],
}

impl<S: Simd> Parts<S> {
    #[inline(always)]
    fn new(simd: S, [estimate, truth]: [f64; 2]) -> Self {
        let error = estimate - truth;
        let zero = simd.splat_f64s(0.0);
        let range = [
            [simd.splat_f64s(truth); LANES],
            [simd.splat_f64s(error); LANES],
        ];
        let [in50, in80, in95] = HALF_WIDTHS;
        Self {
            simd,
            estimate: simd.splat_f64s(estimate),
            error: simd.splat_f64s(error),
            size: simd.splat_f64s(error.abs()),
            square: simd.splat_f64s(error * error),
            half_widths: [
                simd.splat_f64s(in50),
                simd.splat_f64s(in80),
                simd.splat_f64s(in95),
            ],
            sums: [[zero; LANES]; SUMS],
            low: range,
            high: range,
        }
    }

    /// 1 if an error with the absolute value `size` is at most `half_width` standard deviations, otherwise 0.
    #[inline(always)]
    fn holds(&self, half_width: S::f64s, std: S::f64s, size: S::f64s) -> S::f64s {
        let simd = self.simd;
        let is_held = simd.less_than_or_equal_f64s(size, simd.mul_f64s(half_width, std));
        simd.select_f64s(is_held, simd.splat_f64s(1.0), simd.splat_f64s(0.0))
    }

    #[inline(always)]
    fn add(&mut self, observed: [&[f64; LANES]; 3], errors: &mut [f64; LANES]) {
        let simd = self.simd;
        let [estimates, truths, stds] = observed;
        let (estimates, _) = S::as_simd_f64s(estimates);
        let (truths, _) = S::as_simd_f64s(truths);
        let (stds, _) = S::as_simd_f64s(stds);
        let (errors, _) = S::as_mut_simd_f64s(errors);
        let (zero, one) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
        for part in 0..LANES / S::F64_LANES {
            let (truth, std) = (truths[part], stds[part]);
            let error = simd.sub_f64s(estimates[part], truth);
            errors[part] = error;
            let size = simd.abs_f64s(error);
            let of_estimate = simd.sub_f64s(estimates[part], self.estimate);
            let of_error = simd.sub_f64s(error, self.error);
            let of_square = simd.sub_f64s(simd.mul_f64s(error, error), self.square);
            let is_reported = simd.greater_than_or_equal_f64s(std, zero);
            let terms = [
                of_estimate,
                simd.mul_f64s(of_estimate, of_estimate),
                of_error,
                simd.mul_f64s(of_error, of_error),
                simd.sub_f64s(size, self.size),
                of_square,
                simd.mul_f64s(of_square, of_square),
                simd.select_f64s(is_reported, one, zero),
                simd.max_f64s(std, zero),
                self.holds(self.half_widths[0], std, size),
                self.holds(self.half_widths[1], std, size),
                self.holds(self.half_widths[2], std, size),
            ];
            for (sums, term) in self.sums.iter_mut().zip(&terms) {
                sums[part] = simd.add_f64s(sums[part], *term);
            }
            let ranges = self.low.iter_mut().zip(&mut self.high);
            for ((low, high), value) in ranges.zip(&[truth, error]) {
                low[part] = simd.min_f64s(low[part], *value);
                high[part] = simd.max_f64s(high[part], *value);
            }
        }
    }

    fn totals(&self) -> Totals {
        // Adding 0.0 converts −0 to 0.
        let range = |place: usize| {
            let fold = |lanes: &[S::f64s; LANES], of: fn(f64, f64) -> f64| {
                lanes_of::<S>(lanes).into_iter().reduce(of).unwrap_or(0.0) + 0.0
            };
            [
                fold(&self.low[place], f64::min),
                fold(&self.high[place], f64::max),
            ]
        };
        let total = |place: usize| lanes_of::<S>(&self.sums[place]).into_iter().sum::<f64>();
        Totals {
            truths: range(0),
            errors: range(1),
            of_estimates: [0, 1].map(total),
            of_errors: [2, 3].map(total),
            of_magnitudes: total(4),
            of_squares: [5, 6].map(total),
            reported: total(7) as u64,
            stds: total(8),
            covered: [9, 10, 11].map(|place| total(place) as u64),
        }
    }
}

impl WithSimd for TotalsOf<'_> {
    type Output = Totals;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Totals {
        let mut parts = Parts::new(simd, self.first);
        let (estimates, last_estimates) = self.observed.estimates.as_chunks::<LANES>();
        let (truths, last_truths) = self.observed.truths.as_chunks::<LANES>();
        let (stds, last_stds) = self.observed.stds.as_chunks::<LANES>();
        let (errors, last_errors) = self.errors.as_chunks_mut::<LANES>();
        for (((estimates, truths), stds), errors) in
            estimates.iter().zip(truths).zip(stds).zip(errors)
        {
            parts.add([estimates, truths, stds], errors);
        }
        if !last_errors.is_empty() {
            // Fill the unused entries of the last vectors with the first observation. The sums contain differences from
            // the first observation, so these entries add 0.
            let [estimate, truth] = self.first;
            let mut filled = [estimate, truth, UNREPORTED].map(|value| [value; LANES]);
            let last = [last_estimates, last_truths, last_stds];
            for (filled, last) in filled.iter_mut().zip(last) {
                filled[..last.len()].copy_from_slice(last);
            }
            let mut errors = [0.0; LANES];
            parts.add(filled.each_ref(), &mut errors);
            last_errors.copy_from_slice(&errors[..last_errors.len()]);
        }
        parts.totals()
    }
}

/// Copies the [`LANES`] numbers out of the vectors. If a vector of the processor has several lanes, fewer than
/// [`LANES`] vectors contain all numbers, and the last elements of `vectors` are unused.
#[inline(always)]
fn lanes_of<S: Simd>(vectors: &[S::f64s; LANES]) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(bytemuck::cast_slice(&vectors[..LANES / S::F64_LANES]));
    lanes
}
