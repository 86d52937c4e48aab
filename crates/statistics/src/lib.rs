//! Probability distributions, numbers in messages, and counters of computational work, for all crates of the workspace.

mod bad_setting;
mod distributions;
mod hue;
mod misfit;
mod number_format;
mod score_test;
mod selection;
pub mod work;

pub use bad_setting::BadSetting;
pub use distributions::{
    CERTAIN, HALF_WIDTHS, NORMAL_95, chi_squared_tail, normal_tail, ratio_tail, score_of_tail,
    student_half_width,
};
pub use hue::{hue_turns, saturated_hue};
pub use misfit::{GoodnessOfFit, Misfit, SIGNIFICANCE_LEVEL, StatedQuantity};
pub use number_format::Number;
pub use score_test::{Explained, LEFT};
pub use selection::evenly_spaced;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
