//! A roll: probes roll from a first contact, and the curvature of the object there is estimated by EP1.

mod linear_rolls;
mod motion_noise;
mod roll_plan;
mod roll_sensor;
mod roll_trace;
mod roll_trial;
mod sampled_rolls;

pub use pulp::Arch;
pub(crate) use roll_trial::ROLL_QUANTITIES;
pub use roll_trial::RollScene;
