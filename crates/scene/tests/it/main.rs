//! Integration tests of simulated scenes and their trials.
#![allow(clippy::unwrap_used)]

mod camera;
mod elliptic_press;
mod extremes;
mod fingertip;
mod glide;
mod image_press;
mod ladder;
mod marker_errors;
mod names;
mod press;
mod press_settings;
mod principal_curvatures;
mod roll;
