//! Simulated trials: from a true scene to sensor readings to an estimate, and the models that a scene needs.
//!
//! Only this crate compares the true values of a trial with its estimate. [`Scenes`] builds the [`Scene`] of a cell
//! of a study. [`Scene::trial`] simulates a contact, reads it with a sensor and estimates from the reading.
//! [`Trials`] is the interface of all kinds of scenes. [`recorded`] estimates from recorded sensor readings.

mod glide;
mod kept;
mod ladder;
mod map;
mod marker_sphere;
mod measured_sensor;
mod need;
mod pattern;
mod plan;
mod press;
pub mod recorded;
mod roll;
mod scene;
mod trace;
mod tracks;
mod trials;

pub use glide::GlideScene;
pub use ladder::{Ladder, Rung};
pub use map::MapTable;
pub use measured_sensor::MeasuredSensor;
pub use need::{Need, Warning};
pub use palpate_rolling::TOLERANCES;
pub use pattern::{CutPattern, marker_places};
pub use plan::PlanError;
pub use press::{JudgedCurvature, Parts, PictureLaw, PressFailure, PressScene};
pub use roll::{Arch, RollScene, SideBySide};
pub use scene::{Scene, Scenes, quantities_of};
pub use trace::{SeenPress, Trace, TraceError};
pub use trials::{Outcome, Trials};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
