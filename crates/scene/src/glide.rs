//! A glide: fingers slide over a patch, and the curvature of the patch is estimated by EP2.

mod fingertip_sensor;
mod glide_plan;
mod glide_tables;
mod glide_trial;

pub(crate) use glide_trial::GLIDE_QUANTITIES;
pub use glide_trial::GlideScene;
