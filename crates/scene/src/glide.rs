//! A glide: fingers slide over a patch. The curvature of the patch is estimated from their contacts.

mod fingertip_sensor;
mod glide_plan;
mod glide_trial;

pub use glide_trial::GlideScene;
