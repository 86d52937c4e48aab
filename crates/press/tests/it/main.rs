//! Presses against golden values and closed forms.
#![allow(clippy::unwrap_used)]

mod any_number;
mod bonded_layer;
mod displacement_check;
mod forward_fit;
mod goodness;
mod half_space;
mod ideal;
mod image_fit;
mod refusals;
mod sensor;
mod shear;
