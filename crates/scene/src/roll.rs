//! A roll: probes roll from a first contact, and EP1 estimates the curvature there.

mod ladder;
mod linear;
mod noise;
mod plan;
mod rotation_sensor;
mod scene;
mod sensor;
mod trace;

pub use pulp::Arch;
pub use scene::{RollScene, SideBySide};
