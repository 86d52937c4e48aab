//! Entry points at their extremes, a row each.

mod asked;
mod exact;
