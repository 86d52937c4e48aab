//! Tests of the crate's public face.
#![allow(clippy::unwrap_used)]

mod any_number;
mod drawn_shapes;
mod misfit;
mod penalised;
mod refusals;
mod samples;
mod shapes;
mod tips;
