//! Estimates of trials beside their truths.

use crate::pass::are_sound;

/// Estimate of one quantity by one trial beside its true value, both in the quantity's unit.
///
/// ```
/// use palpate_sweep::{Cell, Observation, Record, RunOptions, Trial, run};
///
/// /// Claims intervals of its own: those of 95 % miss the truth in one trial of four, the narrower ones in two.
/// struct Intervals;
/// impl Trial for Intervals {
///     fn quantities(&self) -> usize { 1 }
///     fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
///         let interval_holds = Some([trial % 2 != 0, trial % 2 != 0, trial % 4 != 0]);
///         record.observe(0, Observation { estimate: 1.0, truth: 1.0, std: None, interval_holds });
///         Ok(())
///     }
/// }
/// let statistics = run(&[Cell { trials: 8, trial: &Intervals }], &RunOptions::default(), &|_| ())?;
/// let summary = statistics[0].quantities[0];
/// assert_eq!([summary.coverage50, summary.coverage80, summary.coverage95], [0.5, 0.5, 0.75].map(Some));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// The estimate.
    pub estimate: f64,
    /// The true value; may differ from one observation to the next.
    pub truth: f64,
    /// The standard deviation the estimator claims, at least 0; `None` where it claims none.
    pub std: Option<f64>,
    /// Whether the intervals of 50, 80 and 95 % that the estimator claims hold the truth; `None` where they are estimate
    /// ± 0.67, 1.28 and 1.96 std.
    pub interval_holds: Option<[bool; 3]>,
}

impl Observation {
    /// Whether the error is finite and the standard deviation, if any, is finite and at least 0.
    #[inline]
    pub(crate) fn is_sound(&self) -> bool {
        let sound_std = |std| (0.0..f64::INFINITY).contains(&std);
        (self.estimate - self.truth).is_finite() && self.std.is_none_or(sound_std)
    }
}

/// Observations of one quantity by trials that ran together, trial by trial; see [`Observation`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observations<'a> {
    /// The estimates, one per trial.
    pub estimates: &'a [f64],
    /// The true value in all of them.
    pub truth: f64,
    /// The standard deviations the estimator claims, one per trial; `None` where it claims none.
    pub stds: Option<&'a [f64]>,
}

impl Observations<'_> {
    /// Number of trials that are told in full.
    pub(crate) fn len(&self) -> usize {
        let stds = self.stds.map_or(usize::MAX, <[f64]>::len);
        self.estimates.len().min(stds)
    }

    /// Number of the first observations that are sound; at most `count`.
    pub(crate) fn sound(&self, count: usize) -> usize {
        let estimates = &self.estimates[..count];
        let stds = self.stds.map_or(&[][..], |stds| &stds[..count]);
        if are_sound(estimates, self.truth, stds) {
            return count;
        }
        let is_sound = |&place: &usize| {
            let observation = Observation {
                estimate: estimates[place],
                truth: self.truth,
                std: stds.get(place).copied(),
                interval_holds: None,
            };
            observation.is_sound()
        };
        (0..count).take_while(is_sound).count()
    }
}
