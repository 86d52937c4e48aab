//! Simulates trials. In a trial, a sensor reads a true scene, and true values are estimated from the readings. This
//! crate also chooses the models that a scene needs.
//!
//! Only this crate compares the true values of a trial with its estimate. [`Scenes`] builds the [`Scene`] of a grid
//! point (cell) of a study. [`Scene::trial`] simulates a contact, reads it with a sensor, and estimates the curvature
//! from the reading. [`Trials`] is the interface of all kinds of scenes.

mod config_conversion;
mod glide;
mod ladder;
mod measured_sensor;
mod press;
mod principal_curvatures;
mod roll;
mod scene;
mod trace;

pub use glide::GlideScene;
pub use ladder::{Accuracy, Ladder, Rung};
pub use measured_sensor::MeasuredSensor;
pub use palpate_rolling::TOLERANCES;
pub use press::{PressFailure, PressFlaw, PressScene, SharedModels};
pub use roll::{Arch, RollScene};
pub use scene::{Need, Scene, SceneTrial, Scenes, Trials, map_table_of, quantities_of};

pub use trace::{CameraTrace, Trace, TraceError};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
