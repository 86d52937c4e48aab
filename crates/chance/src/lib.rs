//! How likely chance alone is: tails of distributions, and the goodness of a fit.

mod goodness;
mod normal;
mod score;
mod share;
mod tails;

pub use goodness::{DOUBTED, DOUBTED_BY_ALL, GoodnessOfFit};
pub use normal::{CERTAIN, HALF_WIDTHS, NORMAL_95, normal_tail, score_of_tail};
pub use score::{Explained, LEFT, doubted, least_likely};
pub use share::Share;
pub use tails::{chi_squared_tail, ratio_tail, student_half_width};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
