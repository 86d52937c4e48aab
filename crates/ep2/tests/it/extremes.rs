//! Entry points at their extremes, a row each.

mod classes;
mod contacts;
mod fits;
mod smoothing;
mod surfaces;
