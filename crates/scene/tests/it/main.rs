//! Integration tests.
#![allow(clippy::unwrap_used)]

mod arrays;
mod camera;
mod camera_rest;
mod extremes;
mod fingertip;
mod glide;
mod image_press;
mod ladder;
mod marker_errors;
mod names;
mod pictured;
mod press;
mod readings;
mod recorded;
mod roll;
mod stated;
mod suspicion;
