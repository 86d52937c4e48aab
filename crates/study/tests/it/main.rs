//! Integration tests of studies.
#![allow(clippy::unwrap_used)]

mod config;
mod glossary;
mod labels;
mod number_text;
mod readings;
mod tables;
mod targets;
