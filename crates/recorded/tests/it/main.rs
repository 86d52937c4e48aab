//! Integration tests.
#![allow(clippy::unwrap_used)]

mod arrays;
mod camera_rest;
mod pictured;
mod readings;
mod recorded;
mod stated;
