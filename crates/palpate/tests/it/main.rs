//! End-to-end tests of the command line.
#![allow(clippy::unwrap_used)]

mod allowance;
mod arguments;
mod camera_press;
mod check;
mod config_errors;
mod coverage;
mod design;
mod desk;
mod disk;
mod distinguish;
mod estimate;
mod estimate_glide;
mod estimate_press;
mod explain;
mod frames;
mod glide;
mod help;
#[cfg(unix)]
mod hostile;
mod journal;
mod like;
mod mistakes_in_readings;
#[cfg(feature = "parquet")]
mod parquet;
mod press;
mod published;
mod reading_warnings;
mod readings;
mod region;
mod report;
mod run;
mod sensitivity;
mod sensor;
mod shards;
mod swept_over;
mod tables;
mod trace;
