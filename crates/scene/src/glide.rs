//! A glide: fingers slide over a patch. The method EP2 estimates the curvature of the patch.

mod fingertip_sensor;
mod glide_plan;
mod glide_tables;
mod glide_trial;

pub use glide_trial::GlideScene;
