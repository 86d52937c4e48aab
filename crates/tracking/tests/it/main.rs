//! Tests of the crate's public interface.
#![allow(clippy::unwrap_used)]

mod any_number;
mod calibration;
mod field;
mod finder;
mod matching;

use palpate_testkit as frames;
