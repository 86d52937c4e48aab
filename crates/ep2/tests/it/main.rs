//! Tests of the crate's public interface.
#![allow(clippy::unwrap_used)]

mod any_number;
mod classes;
mod drawn_shapes;
mod logs;
mod misfit;
mod penalised;
mod refusals;
mod samples;
mod shapes;
mod tips;
