//! A glide: fingers slide over a patch, and EP2 estimates its curvature.

mod ladder;
mod map;
mod plan;
mod scene;
mod sensor;
mod trace;

pub use scene::GlideScene;
