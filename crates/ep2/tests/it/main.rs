//! Tests of the crate's public face.
#![allow(clippy::unwrap_used)]

mod agreement;
mod any_number;
mod fitpack;
mod penalised;
mod refusals;
mod samples;
mod smoothing;
mod tips;
mod two_pass;
