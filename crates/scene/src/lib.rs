//! Simulated trials: from a true scene to sensor readings to an estimate, and the models that a scene needs.
//!
//! This is the only place where the truth of a trial and its estimate meet. [`Scenes`] builds the [`Scene`] of a cell of a
//! study, whose [`Scene::trial`] simulates a contact, reads it with a sensor and estimates from the reading; [`Trials`]
//! says what all kinds of scenes have.

mod glide;
mod kept;
mod ladder;
mod measured_sensor;
mod need;
mod pattern;
mod plan;
mod press;
mod roll;
mod scene;
mod trace;
mod trials;

pub use glide::GlideScene;
pub use ladder::{Ladder, Rung};
pub use measured_sensor::MeasuredSensor;
pub use need::Need;
pub use palpate_rolling::TOLERANCES;
pub use pattern::{CutPattern, marker_places};
pub use press::{JudgedCurvature, Parts, PressFailure, PressScene};
pub use roll::{Arch, RollScene, SideBySide};
pub use scene::{Scene, Scenes, quantities_of};
pub use trace::{SeenPress, Trace, TraceError};
pub use trials::{Outcome, Trials};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
