//! Probability distributions, numbers in messages, and counters of computational work, for all crates of the workspace.

mod bad_setting;
mod hue;
mod misfit;
mod normal;
mod number_format;
mod score_test;
mod selection;
mod tails;
pub mod work;

pub use bad_setting::BadSetting;

pub use hue::{hue_turns, saturated_hue};
pub use misfit::{GoodnessOfFit, Misfit, SIGNIFICANCE_LEVEL, StatedQuantity};
pub use normal::{CERTAIN, HALF_WIDTHS, NORMAL_95, normal_tail, score_of_tail};
pub use number_format::Number;
pub use score_test::{Explained, LEFT};
pub use selection::evenly_spaced;
pub use tails::{chi_squared_tail, ratio_tail, student_half_width};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
