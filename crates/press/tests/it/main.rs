//! Presses against golden values and closed forms.
#![allow(clippy::unwrap_used)]

mod bonded_layer;
mod half_space;
