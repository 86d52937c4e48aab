//! Tails of distributions against closed forms.

mod extremes;
