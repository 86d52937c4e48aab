//! Whole scenes of extreme settings, and recorded readings of extreme numbers.

mod files;
mod fingertip;
mod ladder;
mod recorded;
mod refused;
mod trials;
