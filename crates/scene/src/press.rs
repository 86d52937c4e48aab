//! A press: a soft spherical sensor touches an object once, and the object's curvature is estimated from how the markers
//! under its skin move.

mod camera;
mod departed;
mod failure;
mod judged;
mod ladder;
mod looks;
mod parts;
mod plan;
mod pressed;
mod profile;
mod readings;
mod scene;
mod seen;
mod soft_body;
mod trace;
mod words;

pub use failure::PressFailure;
pub use judged::JudgedCurvature;
pub use parts::Parts;
pub use scene::PressScene;
