//! Presses against golden values and closed forms.
#![allow(clippy::unwrap_used)]

mod half_space;
