//! Test programs for palpate as a whole.
//!
//! - [`tradeoff`] measures the error and the cost of each model.
//! - [`auto_check`] checks that the setting `model = auto` chooses a cheap model that is accurate enough.
//! - [`answer_check`] checks the answers of `palpate design` and `palpate distinguish`.
//! - [`intervals`] measures how often the stated intervals contain the true value.
//! - [`accuracy`] measures errors, and [`workloads`] counts instructions. These numbers must not increase from commit
//!   to commit.
//! - [`peer_tasks`] measures the run time of palpate on tasks that other programs (its peers) can solve too.
//!
//! The true values come from independent computations: [`paraboloid_reference`] for presses, [`contact_reference`] for
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
pub mod timing;
pub mod tradeoff;
pub mod workloads;
