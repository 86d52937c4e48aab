//! A deterministic parallel runner of Monte Carlo simulations. It runs several trials of each cell.
//!
//! A [`Cell`] is one grid point of a study, that is, one combination of the swept values. Its [`Trial`] is a function
//! that records an [`Observation`] of each quantity. The function is called with the trial numbers 0, 1, 2 and so on.
//! [`Runner::run`] runs the trials of all cells and returns a [`Summary`] of every quantity in every cell. This crate
//! does not depend on the physics in a trial.
//!
//! Guarantees, for trials that depend only on their number:
//!
//! - The result is the same to the last bit for any number of threads. Trials run in blocks of 1024 trials, and
//!   the sums of a cell's blocks are added in the order of the blocks. All other results of a block are integers, or
//!   smallest and largest values. The order in which they are merged does not matter.
//! - Memory does not grow with the number of trials.
//! - No number in a result is NaN or infinite. An undefined statistic is `None`.
//!
//! ```
//! use palpate_sweep::{Cell, Observation, Record, RunOptions, Runner, Trial};
//!
//! /// Estimates 2 with an error of ±0.5.
//! struct Coin;
//!
//! impl Trial for Coin {
//!     fn quantities(&self) -> usize {
//!         1
//!     }
//!
//!     fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
//!         let error = if trial % 2 == 0 { 0.5 } else { -0.5 };
//!         let (estimate, truth, std) = (2.0 + error, 2.0, Some(0.5));
//!         record.observe(0, Observation { estimate, truth, std, interval_holds: None });
//!         Ok(())
//!     }
//! }
//!
//! let cells = [Cell { trials: 10_000, trial: &Coin }];
//! let statistics = Runner::new(&RunOptions::default())?.run(&cells, &|_finished| ());
//! let summary = statistics[0].quantities[0];
//! assert_eq!((summary.bias, summary.rms_error), (Some(0.0), Some(0.5)));
//! assert_eq!(summary.coverage95, Some(1.0));
//! # Ok::<(), palpate_sweep::NoThreads>(())
//! ```

mod batch_statistics;
mod cache;
mod cell;
mod certainty;
mod column;
mod histogram;
mod moments;
mod order;
mod partial_statistics;
mod queue;
mod runner;
mod simd_sums;
mod squares;
mod stream;
mod summary;
mod sums;
mod trial_record;

pub use batch_statistics::{Batches, Estimate, Growth};
pub use cache::Cache;
pub use cell::{Cell, StoppingRule, StoppingStatistic, Task, Trial};
pub use certainty::share_at_most;
pub use order::{Order, Repeats, TrialMeans, in_order, repeats};
pub use palpate_statistics::CERTAIN;
pub use queue::JOB;
pub use runner::{Clock, NoThreads, RunOptions, Runner, SweepError};
pub use stream::{Sweep, SweepOutput};
pub use summary::{CellStatistics, Failure, Summary, drop_undefined_moments};
pub use trial_record::{Observation, Observations, Record, TrialObservations};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
