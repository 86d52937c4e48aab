//! Integration tests of marker tracking.
#![allow(clippy::unwrap_used)]

mod any_number;
mod calibration;
mod field;
mod finder;
mod matching;

use palpate_testkit as frames;
