//! A glide: fingers slide over a patch, and EP2 estimates its curvature.

mod ladder;
mod map;
mod method;
mod plan;
mod scene;
mod sensor;
mod trace;

pub(crate) use method::AnyMethod;
pub use scene::GlideScene;
