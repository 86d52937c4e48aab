//! End-to-end tests of the command line.
#![allow(clippy::unwrap_used)]

mod allowance;
mod camera_press;
mod camera_rest;
mod check;
mod design;
mod desk;
mod disk;
mod distinguish;
mod estimate;
mod estimate_glide_refused;
mod estimate_press_refused;
mod estimate_refused;
mod explain;
mod foreign;
mod frames;
mod glide;
mod help;
#[cfg(unix)]
mod hostile;
mod journal;
mod like;
mod objects;
mod own_data;
mod own_data_written;
#[cfg(feature = "parquet")]
mod parquet;
mod press;
mod published;
mod refused;
mod region;
mod report;
mod run;
mod sensor;
mod shards;
mod stated;
mod swept_over;
mod trace;
