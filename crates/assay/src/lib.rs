//! Test programs for palpate as a whole.
//!
//! [`tradeoff`] measures the error and the cost of each model, and [`auto_check`] checks that `auto` chooses a cheap
//! model that is accurate enough. [`answer_check`] checks the answers of `design` and `distinguish`, and [`intervals`]
//! the coverage of the intervals. The instruction counts of the [`workloads`] and the errors in [`accuracy`] must not
//! increase. [`peer_tasks`] measures the run time of palpate on tasks that other programs (its peers) can solve too.
//! True values come from independent computations: [`paraboloid_reference`] for presses, [`contact_reference`] for
//! rolls and round fingertips.

pub mod accuracy;
pub mod answer_check;
mod answer_scenes;
pub mod auto_check;
pub mod contact_reference;
pub mod csv_table;
pub mod intervals;
pub mod paraboloid_reference;
pub mod peer_tasks;
mod random_draws;
pub mod timing;
pub mod tradeoff;
pub mod workloads;
