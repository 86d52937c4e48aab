//! Entry points at their extremes, a row each.

mod made;
mod noise;
mod pads;
