//! Tests of presses, with golden values and exact formulas.
#![allow(clippy::unwrap_used)]

mod any_number;
mod displacement_check;
mod elliptic_contact;
mod elliptic_fit;
mod flat_pad;
mod forward_fit;
mod goodness;
mod half_space;
mod ideal;
mod image_fit;
mod refusals;
mod sensor;
